"""One choice of motors, judged at every configuration: what it controls, how well, and why it fails."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from vincula.analysis.diagnosis import indeterminate_motions, verdicts
from vincula.analysis.indices import Part
from vincula.analysis.ranking import CRITERIA, criterion_value, indeterminate_words, place_in_ranking
from vincula.analysis.result import Analysis
from vincula.analysis.wording import components, number
from vincula.design.resplit import weights_of_choice, with_motors
from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts
from vincula.weights import UNIT, Weights

MOST_WHERE = 6
"""Configurations that a reason names by number."""


@dataclass(frozen=True, slots=True)
class OverConfigurations:
    """One number at every configuration.

    Attributes:
        worst: The smallest; None where some configuration has no such number.
        mean: The arithmetic mean; None likewise.
        at: Configuration of the smallest, from 0; where there is none, the first without the number.
    """

    worst: float | None
    mean: float | None
    at: int

    @staticmethod
    def of(values: Sequence[float]) -> OverConfigurations:
        """Worst and mean of the values at all configurations; NaN where there is none."""
        missing = [k for k, value in enumerate(values) if math.isnan(value)]
        if missing:
            return OverConfigurations(None, None, missing[0])
        at = min(range(len(values)), key=values.__getitem__)
        return OverConfigurations(values[at], math.fsum(values) / len(values), at)


@dataclass(frozen=True, slots=True, eq=False)
class Judge:
    """What all choices of motors are judged by.

    Attributes:
        models: The mechanism at every configuration, candidates being columns.
        weights: Weights; rates and torques by name for any candidate.
        rank_by: What choices are ranked by, one of `CRITERIA`.
        criteria: Everything that is computed, `rank_by` among it.
        on: Components that an index looks at.
    """

    models: tuple[LinearModel, ...]
    weights: Weights | None
    rank_by: str
    criteria: tuple[str, ...]
    on: Part

    def model(self, motors: Sequence[str], configuration: int) -> LinearModel:
        """The linear model of a choice at one configuration."""
        first = self.models[0]
        chosen = weights_of_choice(self.weights or first.weights, first.columns, motors)
        return with_motors(self.models[configuration], motors).with_weights(chosen)

    def analyses(self, motors: Sequence[str]) -> list[Analysis]:
        """The analyses of a choice, one a configuration, computed when asked for."""
        models = [self.model(motors, k) for k in range(len(self.models))]
        return [Analysis(model, model.weights or UNIT) for model in models]

    def judged(self, motors: tuple[str, ...], cost: float) -> MotorChoice:
        """A choice, looked at in every configuration."""
        counts, doubtful = [], []
        values: dict[str, list[float]] = {name: [] for name in self.criteria}
        for k, analysis in enumerate(self.analyses(motors)):
            counts.append(analysis.ledger.summary)
            for name in self.criteria:
                values[name].append(criterion_value(analysis, name, self.on))
            if analysis.ledger.status == "doubtful":
                doubtful.append(k)
        indices = {name: OverConfigurations.of(found) for name, found in values.items()}
        return MotorChoice(motors, cost, tuple(counts), indices, tuple(doubtful), self)


@dataclass(frozen=True, eq=False)
class MotorChoice:
    """One choice of motors.

    Attributes:
        motors: Axes (or motors that drive several) that carry a motor.
        cost: What these motors cost together.
        counts: Summary counts at every configuration.
        indices: Worst and mean over the configurations, by criterion.
        doubtful_at: Configurations where a rank is not decided.
        judge: What it was judged by.
    """

    motors: tuple[str, ...]
    cost: float
    counts: tuple[SummaryCounts, ...]
    indices: Mapping[str, OverConfigurations]
    doubtful_at: tuple[int, ...]
    judge: Judge = field(repr=False)

    @property
    def fails_at(self) -> tuple[int, ...]:
        """Configurations where the member moves with all motors locked."""
        return tuple(k for k, counts in enumerate(self.counts) if counts.indeterminacy)

    @property
    def controls(self) -> bool:
        """Whether locked motors hold the member at every configuration: no indeterminacy."""
        return not self.fails_at

    @property
    def index(self) -> float | None:
        """Worst value of what choices are ranked by."""
        return self.indices[self.judge.rank_by].worst

    @property
    def mean(self) -> float | None:
        """Mean value of what choices are ranked by."""
        return self.indices[self.judge.rank_by].mean

    def largest(self, count: str) -> int:
        """The largest of one of the summary counts over the configurations.

        Args:
            count: `indeterminacy`, `redundancy`, `internal_torques` or another of `SummaryCounts`.
        """
        return max(int(getattr(counts, count)) for counts in self.counts)

    @property
    def place(self) -> tuple[int, int, float]:
        """Sorting key in the ranking of `compare`: smaller is better."""
        return place_in_ranking(self.index, self.largest("indeterminacy"))

    @property
    def reason(self) -> str:
        """Why it stands behind the others; empty for a choice that is ranked by its number."""
        if self.fails_at:
            return indeterminate_words(self.largest("indeterminacy")) + self._where(self.fails_at)
        if self.index is None:
            at = (self.indices[self.judge.rank_by].at,)
            return f"it has no {CRITERIA[self.judge.rank_by]}{self._where(at)}"
        return ""

    @cached_property
    def why(self) -> tuple[str, ...]:
        """Why it does not control the member, in words: which motions are left, which joints take part.

        At the first configuration where it leaves the most; empty for a choice that controls the member.
        """
        if not self.fails_at:
            return ()
        return tuple(indeterminate_motions(self.model(self._loosest)))

    @property
    def _loosest(self) -> int:
        """The first configuration where the member is left the most motions."""
        return max(self.fails_at, key=lambda k: self.counts[k].indeterminacy)

    @cached_property
    def explanation(self) -> tuple[str, ...]:
        """What the choice can do where it is worst, in words: verdicts, and its weakest direction."""
        found = self.indices[self.judge.rank_by]
        at = self._loosest if self.fails_at else found.at
        analysis = self.analyze(at)
        said = tuple(verdicts(analysis.model))
        weakest = _weakest(analysis, self.judge.rank_by)
        return (*said, weakest + self._where((at,)) + ".") if weakest else said

    def model(self, configuration: int = 0) -> LinearModel:
        """The linear model with these motors.

        Args:
            configuration: Number of the configuration, from 0.
        """
        return self.judge.model(self.motors, configuration)

    def analyze(self, configuration: int = 0) -> Analysis:
        """The analysis with these motors.

        Args:
            configuration: Number of the configuration, from 0.
        """
        model = self.model(configuration)
        return Analysis(model, model.weights or UNIT)

    def _where(self, places: Sequence[int]) -> str:
        """Which configurations; nothing where there is one only."""
        total = len(self.counts)
        if total == 1:
            return ""
        if len(places) == total:
            return f" at all {total} configurations"
        shown = ", ".join(str(k + 1) for k in places[:MOST_WHERE])
        more = ", ..." if len(places) > MOST_WHERE else ""
        return f" at {len(places)} of {total} configurations (number {shown}{more})"


def _weakest(analysis: Analysis, criterion: str) -> str:
    """The direction of the smallest finite efficiency; empty where there is none."""
    force = criterion.endswith("-force")
    ellipsoid = getattr(analysis, criterion.replace("-", "_")) if force else analysis.kinematic
    finite = [k for k, kind in enumerate(ellipsoid.classes) if kind == "finite"]
    if not finite:
        return ""
    k = finite[-1]
    task, motor = ellipsoid.task_directions[k], ellipsoid.motor_directions[k]
    by = "" if motor is None else f" by motors {components(motor, ellipsoid.motors)}"
    what = "Weakest direction" if force else "Slowest direction"
    words = "nothing" if task is None else components(task, ellipsoid.components)
    size = number(float(ellipsoid.efficiencies[k]))
    return f"{what} of the {ellipsoid.kind} ellipsoid: {words}{by}, efficiency {size}"
