"""`vincula.place`: which joints should get the motors; every admissible choice judged and ranked.

One linearisation a configuration; a choice of motors then only sorts the columns of the Jacobian into active
and passive ones.  Choices are ranked by the rule of `compare`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.analysis.doubt import mixed_units_message
from vincula.analysis.indices import Part
from vincula.analysis.ranking import CRITERIA
from vincula.design.admissible import Admissible, Names, Sizes
from vincula.design.choice_search import searched
from vincula.design.configurations import Looked, Values, looked_at, looked_at_sweep
from vincula.design.motor_choice import Judge, MotorChoice
from vincula.design.pareto import pareto_front
from vincula.errors import ModelError, UnknownNameError, listing
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel
from vincula.numerics.blas import one_blas_thread
from vincula.weights import UNIT, Weights

if TYPE_CHECKING:
    from vincula.sweep.sweep import Sweep

EVERY: Final = 2**16
"""Most choices that are all looked at; beyond them a search looks at some."""
BUDGET: Final = 2**13
"""Choices that a search looks at when nothing is said."""
SHOWN: Final = ("kinematic", "active-force", "passive-force")
"""Criteria that every choice is judged by, whatever it is ranked by."""
LESS_IS_BETTER: Final = ("cost", "motors")
"""Criteria of a Pareto front of which less is better; of all others more is."""
BESIDE: Final = ("active-force", "kinematic")
"""What stands on the Pareto front beside the number that choices are ranked by, when nothing is said."""

Tell = Callable[[int, int], None]
"""Called with the number of choices looked at, and how many there will be at most."""


@dataclass(frozen=True, eq=False)
class Placement:
    """Choices of motors for one mechanism, ranked.

    Attributes:
        admissible: Candidates, required motors, numbers of motors, costs.
        choices: The choices looked at, best first.
        looked: The configurations, the models there, and the points that were left out.
        rank_by: What they are ranked by.
        on: Components that an index looks at.
        front_criteria: Criteria of the Pareto front.
        front: The choices that control the member everywhere and that no other such choice beats in all
            of these criteria at once, in the order of the ranking.
        limit: All candidates at once, admissible or not: what no choice among them can surpass.
        seed: Seed of the search; None where every admissible choice was looked at.
        warnings: What the reader of the numbers must know.
    """

    admissible: Admissible
    choices: tuple[MotorChoice, ...]
    looked: Looked
    rank_by: str
    on: Part
    front_criteria: tuple[str, ...]
    front: tuple[MotorChoice, ...]
    limit: MotorChoice
    seed: int | None
    warnings: tuple[str, ...]

    @property
    def best(self) -> MotorChoice | None:
        """The first in the ranking, if it controls the member at every configuration."""
        first = self.choices[0]
        return first if first.controls else None

    @property
    def exhaustive(self) -> bool:
        """Whether every admissible choice was looked at."""
        return self.seed is None

    @property
    def controlling(self) -> tuple[MotorChoice, ...]:
        """The choices that control the member at every configuration, best first."""
        return tuple(choice for choice in self.choices if choice.controls)

    @property
    def fewest(self) -> int:
        """Number of motors below which no choice can control the member: its independent motions.

        A locked motor takes away one motion at most.
        """
        return max(counts.coordinated + counts.indeterminacy for counts in self.limit.counts)

    @property
    def explanation(self) -> tuple[str, ...]:
        """Why the best choice is the best, in words; or that no choice controls the member."""
        from vincula.design.placement_words import explanation

        return explanation(self)

    def choice(self, motors: Names) -> MotorChoice:
        """The choice of these motors.

        Args:
            motors: Names of axes or motors, in any order.

        Raises:
            UnknownNameError: No choice of these motors was looked at.
        """
        names = [name.strip() for name in motors.split(",")] if isinstance(motors, str) else list(motors)
        for choice in self.choices:
            if set(choice.motors) == set(names):
                return choice
        raise UnknownNameError("choice", ", ".join(names), [", ".join(c.motors) for c in self.choices])

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of `vincula place --json` (schema vincula/placement/1)."""
        from vincula.design.placement_report import as_object

        return as_object(self)

    def __str__(self) -> str:
        from vincula.design.placement_report import as_text

        return as_text(self)


def place(
    source: Mechanism | LinearModel | Sequence[LinearModel],
    motors: Sizes,
    *,
    at: Values | Sequence[Values] | None = None,
    over: Sweep | None = None,
    rank_by: str = "kinematic",
    on: Part = "all",
    forbid: Names = (),
    require: Names = (),
    cost: Mapping[str, float] | None = None,
    weights: Weights | None = None,
    front: Sequence[str] | None = None,
    seed: int = 0,
    budget: int = BUDGET,
    progress: Tell | None = None,
) -> Placement:
    """Every admissible choice of motors, judged and ranked.

    A choice controls the mechanism when its reference member does not move with all motors locked (no
    indeterminacy), at every configuration.  Choices that do come first, the one with the largest worst
    value of `rank_by` on top; then those that leave it the fewest motions: the ranking of `vincula compare`.

    Args:
        source: A mechanism with a reference member, a linear model, or the same mechanism's models at several
            configurations.
        motors: How many motors: a number or several (`range(1, 6)`).
        at: For a mechanism: the configuration, or several; home by default.
        over: For a mechanism: a sweep, every closed point of which is a configuration.
        rank_by: One of `vincula.analysis.ranking.CRITERIA`.
        on: For the indices: translation, rotation or all components.
        forbid: Joints, axes or motors that get none.
        require: Joints, axes or motors that every choice has.
        cost: Cost of a motor by joint, axis or motor name; 1 for the others.
        weights: Weights; by default those of the mechanism.  Rates and torques by name, so that they fit
            every choice.
        front: Criteria of the Pareto front: those of `rank_by`, and `cost` and `motors` of which less is
            better; None for `rank_by`, the active force (or else the kinematic) index and `cost`.
        seed: Seed of the search, where there are more than 65536 choices.
        budget: Choices that such a search looks at.
        progress: Called with what is done.

    Returns:
        The ranking, with words for what fails.

    Raises:
        ModelError: No motors, more motors than joint axes, a name forbidden and required, a bad cost.
        UnknownNameError: A name that does not exist.
        ClosureError: A loop is open.
        SweepError: A sweep of another mechanism or over parameters, or no point that closes.
        MissingReferenceError: No reference member is named.
        MixedUnitsError: An index over metres and radians with weights that nobody chose.
    """
    criteria = _criteria(rank_by, front)
    chosen = _default_front(rank_by) if front is None else tuple(front)
    if isinstance(source, Mechanism):
        admissible = Admissible.of_mechanism(source, motors, forbid, require, cost)
        looked = _looked(source, admissible, weights, at, over)
    else:
        looked = _given(source, at, over)
        admissible = Admissible.of_model(looked.models[0], motors, forbid, require, cost)
    judge = Judge(looked.models, None if isinstance(source, Mechanism) else weights, rank_by, criteria, on)
    return _ranked(admissible, looked, judge, chosen, seed, _budget(budget), progress)


def _ranked(
    admissible: Admissible,
    looked: Looked,
    judge: Judge,
    front: tuple[str, ...],
    seed: int,
    budget: int,
    progress: Tell | None,
) -> Placement:
    """The ranking of admissible choices on models that are there already."""
    found: list[MotorChoice] = []
    count = admissible.count
    exhaustive = count <= EVERY
    total = count if exhaustive else min(budget, count)

    def look(motors: tuple[str, ...]) -> tuple[float, ...]:
        choice = judge.judged(motors, admissible.cost_of(motors))
        found.append(choice)
        if progress is not None:
            progress(len(found), total)
        return choice.place

    with one_blas_thread():
        limit = judge.judged(admissible.candidates, admissible.cost_of(admissible.candidates))
        if exhaustive:
            for size in admissible.sizes:
                for motors in admissible.of_size(size):
                    look(motors)
        else:
            searched(admissible, look, total, seed)
    ranked = tuple(sorted(found, key=lambda choice: choice.place))
    used = judge.weights or looked.models[0].weights or UNIT
    mixed = mixed_units_message(looked.models[0], used, "twist")
    return Placement(
        admissible, ranked, looked, judge.rank_by, judge.on, front, _front(ranked, front), limit,
        None if exhaustive else seed, (mixed,) if mixed else (),
    )  # fmt: skip


def _looked(
    mechanism: Mechanism,
    admissible: Admissible,
    weights: Weights | None,
    at: Values | Sequence[Values] | None,
    over: Sweep | None,
) -> Looked:
    if at is not None and over is not None:
        raise ModelError("at and over are both given: judge at configurations, or over the points of a sweep")
    if weights is not None:
        mechanism = mechanism.with_weights(weights)
    # Joints that may carry a motor keep their columns whatever the reduction would do with passive ones.
    ready = mechanism.with_active(admissible.candidates)
    return looked_at(ready, at) if over is None else looked_at_sweep(ready, over)


def _given(source: LinearModel | Sequence[LinearModel], at: object, over: object) -> Looked:
    if at is not None or over is not None:
        raise ModelError("a linear model is at one configuration already: leave at and over out")
    models = (source,) if isinstance(source, LinearModel) else tuple(source)
    if not models or not all(isinstance(model, LinearModel) for model in models):
        raise ModelError("place needs a Mechanism, a LinearModel or a list of linear models")
    names = {frozenset(column.name for column in model.columns) for model in models}
    if len(names) > 1:
        raise ModelError("the linear models have different joint axes: give the same mechanism's models")
    return Looked(models, tuple(Configuration({}) for _ in models))


def _default_front(rank_by: str) -> tuple[str, ...]:
    return rank_by, next(name for name in BESIDE if name != rank_by), "cost"


def _criteria(rank_by: str, front: Sequence[str] | None) -> tuple[str, ...]:
    """Everything to compute."""
    if rank_by not in CRITERIA:
        raise UnknownNameError("criterion", rank_by, CRITERIA)
    if front is None:
        front = ()
    elif isinstance(front, str) or not front:
        known = listing([*CRITERIA, *LESS_IS_BETTER])
        raise ModelError(f"front is {front!r}: give a list of criteria ({known})")
    for name in front:
        if name not in CRITERIA and name not in LESS_IS_BETTER:
            raise UnknownNameError("criterion", name, [*CRITERIA, *LESS_IS_BETTER])
    return tuple(dict.fromkeys([*SHOWN, rank_by, *(name for name in front if name in CRITERIA)]))


def _budget(budget: int) -> int:
    if isinstance(budget, bool) or not isinstance(budget, int) or budget < 1:
        raise ModelError(f"budget is {budget!r}: give a whole number of choices, 1 or more")
    return budget


def _front(ranked: Sequence[MotorChoice], criteria: Sequence[str]) -> tuple[MotorChoice, ...]:
    able = [choice for choice in ranked if choice.controls]
    if not able:
        return ()
    values = np.array([[_value(choice, name) for name in criteria] for choice in able])
    return tuple(choice for choice, is_on in zip(able, pareto_front(values), strict=True) if is_on)


def _value(choice: MotorChoice, criterion: str) -> float:
    """A number of which more is better; NaN where there is none."""
    if criterion == "cost":
        return -choice.cost
    if criterion == "motors":
        return -float(len(choice.motors))
    worst = choice.indices[criterion].worst
    return float("nan") if worst is None else worst
