"""A design problem: variables, configurations, objectives, constraints; and what a design is worth."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.arrays import Matrix, Vector
from vincula.design.constraints import Constraint, Relation
from vincula.design.judged import OWN, Judged
from vincula.design.lanes import COUNTED, Lanes
from vincula.design.measures import Measure
from vincula.design.variables import DesignSpace, DesignVariable, Tie
from vincula.errors import DuplicateNameError, ModelError, UnknownNameError
from vincula.kernels.compiled import CompiledMechanism, PathName, compile_mechanism
from vincula.kernels.inputs import Given
from vincula.kernels.quantities import CLASS_CODES
from vincula.kernels.variants import Builder, defaults_of, parameters_of
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.design.front import Front
    from vincula.design.landscape import Landscape
    from vincula.design.log import Log
    from vincula.design.optimum import Optimum
    from vincula.mechanism.mechanism import Mechanism

PROBES: Final = 8
"""Designs looked at to learn what is usual: how many motions the member has unless it is singular."""


class DesignProblem:
    """What may change in a mechanism, where it is judged, by what, and what it must keep.

    Args:
        build: Makes the mechanism from parameters: a function whose arguments have defaults, or
            `vincula.builder(file)`.
        variables: What the design chooses.
        objectives: One measure, or several for a front of compromises.
        constraints: What a design must keep.
        ties: Parameters as functions of the variables (symmetry, sums, half a width): from the values
            of the variables by name to a number.
        configurations: (places, numbers): where every design is judged; None for home.
        given: What they are: `configuration`, `motors` or `reference`, as for `CompiledMechanism.evaluate`.
        start: Where closing starts; None for home.
        weights: Weights of all measures that have none of their own; None for those of the mechanism.
        reach: Least share of the configurations that must be reached, 0 to 1.
        name: Name of the problem.
        path: How batches are computed, as for `CompiledMechanism.evaluate`.

    Raises:
        ModelError: No variable or objective, crossed bounds, a variable without effect, and the like.
        UnknownNameError: A parameter or quantity that does not exist.
    """

    def __init__(
        self,
        build: Builder,
        variables: Sequence[DesignVariable],
        objectives: Measure | Sequence[Measure],
        *,
        constraints: Sequence[Constraint] = (),
        ties: Mapping[str, Tie] | None = None,
        configurations: ArrayLike | None = None,
        given: Given = "configuration",
        start: ArrayLike | Mapping[str, Any] | None = None,
        weights: Weights | None = None,
        reach: float = 1.0,
        name: str = "design",
        path: PathName = "auto",
    ) -> None:
        self.build, self.name, self.weights, self.path = build, name, weights, path
        self.objectives = (objectives,) if isinstance(objectives, Measure) else tuple(objectives)
        self.constraints = tuple(constraints)
        known = None if parameters_of(build) is None else _declared(build)
        self.space = DesignSpace(variables, ties or {}, known)
        unused = self.space.unused()
        if unused and not any(isinstance(c, Relation) for c in self.constraints):
            raise UnknownNameError("parameter of the mechanism, and no tie uses a variable that", unused[0],
                                   known or self.space.ties)  # fmt: skip
        self.given, self.start = given, start
        self.configurations = (
            None if configurations is None else np.atleast_2d(np.asarray(configurations, float))
        )
        if not 0.0 <= reach <= 1.0:
            raise ModelError(f"reach is {reach}: give a share of the configurations, 0 to 1")
        self.reach = float(reach)
        self._refuse_bad_names()
        self._compiled: list[tuple[Weights | None, CompiledMechanism]] = []
        judges: list[Measure | Constraint] = [*self.objectives, *self.constraints]
        for one in judges:
            one.check(self.compiled_for(_weights_of(one)))

    def _refuse_bad_names(self) -> None:
        if not self.objectives:
            raise ModelError("no objectives: say what a design is judged by")
        for kind, names in (
            ("objective", [objective.name for objective in self.objectives]),
            ("constraint", list(self.names_of_constraints)),
        ):
            for name in names:
                if names.count(name) > 1:
                    raise DuplicateNameError(kind, name)

    @property
    def names_of_constraints(self) -> tuple[str, ...]:
        """Names of the columns of `Judged.broken`."""
        return (*OWN, *(constraint.name for constraint in self.constraints))

    @property
    def signs(self) -> Vector:
        """+1 for objectives of which smaller is better, else -1."""
        return np.array([1.0 if o.better == "smaller" else -1.0 for o in self.objectives])

    @property
    def places(self) -> int:
        """How many configurations every design is judged at."""
        return 1 if self.configurations is None else len(self.configurations)

    @property
    def compiled(self) -> CompiledMechanism:
        """The compiled mechanism with the weights of the problem."""
        return self.compiled_for(None)

    def compiled_for(self, weights: Weights | None) -> CompiledMechanism:
        """The compiled mechanism with the weights of a measure; None for those of the problem."""
        for known, compiled in self._compiled:
            if known is weights:
                return compiled
        made = compile_mechanism(self.build, weights=weights or self.weights)
        self._compiled.append((weights, made))
        return made

    def mechanism(self, design: ArrayLike) -> Mechanism:
        """The mechanism of one design.

        Raises:
            ModelError: It cannot be built.
        """
        row = self.space.refuse_outside(np.asarray(design, dtype=float)[None, :])
        values = {name: float(v[0]) for name, v in self.space.parameters(row).items()}
        return self.compiled.variants.at(values)

    @cached_property
    def usual(self) -> dict[str, int]:
        """Summary counts and number of finite efficiencies of a design that is not singular."""
        low, high = self.space.low, self.space.high
        random = np.random.default_rng(0).random((PROBES - 1, len(low)))
        probes = np.vstack([self.space.start, low + random * (high - low)])
        usual = {"coordinated": 0, "indeterminacy": -1, "freedom": 0}
        found = self._found(None, probes, (*COUNTED, "kinematic.classes"), everywhere=False)
        there = found.reached
        for name, best in (("coordinated", np.max), ("indeterminacy", np.min)):
            if there.any():
                usual[name] = int(best(found[name][there]))
        finite = (found["kinematic.classes"] == CLASS_CODES["finite"]).sum(axis=-1)
        usual["freedom"] = int(finite[there].max()) if there.any() else 0
        usual["indeterminacy"] = max(usual["indeterminacy"], 0)
        return usual

    def judge(self, designs: ArrayLike) -> Judged:
        """What designs are worth.

        Args:
            designs: One row a design, one column a variable.

        Raises:
            ModelError: Designs of another size or that are not finite.
        """
        table = self.space.refuse_outside(np.asarray(designs, dtype=float))
        names = self.names_of_constraints
        objectives = np.full((len(table), len(self.objectives)), np.nan)
        broken = np.zeros((len(table), len(names)))
        doubtful = np.zeros(len(table), dtype=bool)
        self._relations(table, broken)
        alive = np.flatnonzero(~(broken > 0.0).any(axis=1))
        if len(alive):
            self._evaluate(table, alive, objectives, broken, doubtful)
        return Judged(table, objectives, broken, self.signs, doubtful)

    def _relations(self, table: Matrix, broken: Matrix) -> None:
        columns = self.space.columns(table)
        for k, constraint in enumerate(self.constraints):
            if isinstance(constraint, Relation):
                broken[:, len(OWN) + k] = constraint.of_variables(columns)
        for values in self.space.parameters(table).values():
            broken[:, 0] = np.maximum(broken[:, 0], ~np.isfinite(values))

    def _evaluate(self, table: Matrix, alive: Any, objectives: Matrix, broken: Matrix, doubtful: Any) -> None:
        """Objectives and constraints of the designs whose variables are allowed."""
        used: list[Measure | Constraint] = [*self.objectives]
        used += [c for c in self.constraints if not isinstance(c, Relation)]
        groups: dict[int, list[Any]] = {}
        for one in used:
            groups.setdefault(id(_weights_of(one)), []).append(one)
        first = True
        for group in groups.values():
            needed = dict.fromkeys(q for one in group for q in one.quantities)
            lanes = self._found(_weights_of(group[0]), table[alive], (*needed, *COUNTED))
            if first:
                self._closure(lanes, alive, broken)
                doubtful[alive] = lanes.doubtful.any(axis=1)
                first = False
            for one in group:
                if isinstance(one, Measure):
                    objectives[alive, self.objectives.index(one)] = one.of(lanes)
                else:
                    amounts = np.where(lanes.reached.any(axis=1), one.broken(lanes), 0.0)
                    broken[alive, len(OWN) + self.constraints.index(one)] = amounts
        lost = ~np.isfinite(objectives[alive]).all(axis=1) & (broken[alive, 1:3] == 0.0).all(axis=1)
        broken[alive, OWN.index("no finite cost")] = lost

    def _closure(self, lanes: Lanes, alive: Any, broken: Matrix) -> None:
        failed = lanes.failed.mean(axis=1)
        share = lanes.reached.mean(axis=1)
        missing = np.maximum(self.reach - share, 0.0)
        nothing = ~lanes.reached.any(axis=1)
        missing = np.where(nothing, np.maximum(missing, 1.0), missing)
        broken[alive, OWN.index("cannot be built")] = np.where(failed == 1.0, missing, 0.0)
        broken[alive, OWN.index("does not close")] = np.where(failed == 1.0, 0.0, missing)

    def _found(
        self, weights: Weights | None, designs: Matrix, quantities: Sequence[str], *, everywhere: bool = True
    ) -> Lanes:
        compiled = self.compiled_for(weights)
        parameters = {name: values[:, None] for name, values in self.space.parameters(designs).items()}
        places = self.configurations
        if places is not None and not everywhere:
            places = places[:1]
        usual = self.usual if everywhere else {"freedom": 0}
        found = compiled.evaluate(
            places,
            dict.fromkeys(quantities),
            given=self.given,
            start=self.start,
            parameters=parameters,
            path=self.path,
            alike=True,
        )
        return Lanes(compiled, found, parameters, usual["freedom"], usual)

    def looked_at(
        self,
        measure: Measure,
        designs: Matrix,
        places: NDArray[np.intp] | None = None,
        seen: Lanes | None = None,
    ) -> Lanes:
        """What a measure is computed from: at all configurations, or by the reference path at some.

        Args:
            measure: The measure.
            designs: One row a design.
            places: For every design the configurations to look at again; None for all, as in a search.
            seen: What was found at all of them.
        """
        quantities = dict.fromkeys((*measure.quantities, *COUNTED, "configuration"))
        if places is None or seen is None:
            return self._found(measure.weights, designs, tuple(quantities))
        compiled = self.compiled_for(measure.weights)
        parameters = {name: values[:, None] for name, values in self.space.parameters(designs).items()}
        at = np.take_along_axis(seen["configuration"], places[:, :, None], axis=1)
        found = compiled.evaluate(at, quantities, parameters=parameters, path="reference")
        return Lanes(compiled, found, parameters, self.usual["freedom"], self.usual)

    def by_reference(self) -> DesignProblem:
        """The same problem, every batch computed one by one by the reference path."""
        return DesignProblem(
            self.build,
            self.space.variables,
            self.objectives,
            constraints=self.constraints,
            ties=self.space.ties,
            configurations=self.configurations,
            given=self.given,
            start=self.start,
            weights=self.weights,
            reach=self.reach,
            name=self.name,
            path="reference",
        )

    def fingerprint(self) -> str:
        """What tells this problem from others: a log of one problem is never used for another."""
        space = self.space
        probe = np.vstack([space.start, 0.75 * space.low + 0.25 * space.high])
        parts = [
            repr(space.variables), repr(self.objectives), repr([w.weights for w in self.objectives]),
            repr([(type(c).__name__, c.name) for c in self.constraints]), repr(self.weights),
            repr([(n, np.round(v, 12).tolist()) for n, v in space.parameters(probe).items()]),
            repr(None if self.configurations is None else self.configurations.tolist()), self.given,
            repr(self.start), repr(self.reach), _digits(self.judge(probe).objectives),
        ]  # fmt: skip
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def optimize(self, **how: Any) -> Optimum:
        """The best design of one objective: see `vincula.design.optimum.optimize`."""
        from vincula.design.optimum import optimize

        return optimize(self, **how)

    def scan(self, *names: str, **how: Any) -> Landscape:
        """All designs of a grid over one or two variables: see `vincula.design.landscape.scan`."""
        from vincula.design.landscape import scan

        return scan(self, names, **how)

    def front(self, **how: Any) -> Front:
        """The best compromises of several objectives: see `vincula.design.front.front`."""
        from vincula.design.front import front

        return front(self, **how)

    def log(self, path: str) -> Log:
        """The log of this problem in a file, begun or gone on with: see `vincula.design.log`."""
        from vincula.design.log import Log

        return Log(path, self)


def _declared(build: Builder) -> dict[str, float]:
    """All parameters of a builder with their defaults; NaN where there is none."""
    defaults = defaults_of(build)
    return {name: defaults.get(name, float("nan")) for name in parameters_of(build) or ()}


def _digits(values: Matrix) -> str:
    """Numbers with the digits that every machine agrees on."""
    return " ".join(f"{value:.7g}" for value in values.ravel())


def _weights_of(one: Measure | Constraint) -> Weights | None:
    if isinstance(one, Measure):
        return one.weights
    measure = getattr(one, "measure", None)
    return measure.weights if isinstance(measure, Measure) else None
