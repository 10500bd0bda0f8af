"""Everything at once: `analyze(model)`, its words and its JSON object."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from vincula.analysis.diagnosis import verdicts
from vincula.analysis.doubt import doubt_messages, mixed_units_message
from vincula.analysis.ellipsoid import Convention, Ellipsoid, Kind, Viewpoint
from vincula.analysis.equilibrium import ForceBlocks, force_blocks
from vincula.analysis.maps import LinearMap, torque_from_wrench, twist_from_rates
from vincula.analysis.mobility import MotionBlocks, motion_blocks
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights, task_quantity
from vincula.errors import FileError, MixedUnitsWarning, RankAmbiguityWarning
from vincula.model import LinearModel
from vincula.numerics.evidence import NearestSingular
from vincula.numerics.ledger import MatrixName, RankLedger
from vincula.numerics.metric import Metric, identity_metric
from vincula.weights import Quantity, Weights


@dataclass(frozen=True, eq=False)
class Analysis:
    """Motions, forces, ellipsoids and doubts of one model, computed when asked for.

    Attributes:
        model: The mechanism at one configuration.
        weights: The weights used.
        viewpoint: efficiency or accuracy.
        convention: invariant or printed.
    """

    model: LinearModel
    weights: Weights
    viewpoint: Viewpoint = "efficiency"
    convention: Convention = "invariant"

    @property
    def ledger(self) -> RankLedger:
        """The ranks everything rests on."""
        return self.model.ledger

    @cached_property
    def verdicts(self) -> tuple[str, ...]:
        """What the mechanism can do, in words."""
        return tuple(verdicts(self.model))

    @cached_property
    def motions(self) -> MotionBlocks:
        """The blocks of (2)-(5)."""
        return motion_blocks(self.model)

    @cached_property
    def forces(self) -> ForceBlocks:
        """The blocks of (19)."""
        return force_blocks(self.model, self._definite("wrench"), self._definite("torque"))

    @cached_property
    def kinematic(self) -> Ellipsoid:
        """Eqs. (8)-(13)."""
        return self._ellipsoid("kinematic")

    @cached_property
    def active_force(self) -> Ellipsoid:
        """Eq. (20)."""
        return self._ellipsoid("active force")

    @cached_property
    def passive_force(self) -> Ellipsoid:
        """Eq. (21)."""
        return self._ellipsoid("passive force")

    @cached_property
    def internal_force(self) -> Ellipsoid:
        """Eqs. (22)-(23)."""
        return self._ellipsoid("internal force")

    @cached_property
    def dual_force(self) -> Ellipsoid:
        """Eq. (24)."""
        return self._ellipsoid("dual force")

    @property
    def ellipsoids(self) -> tuple[Ellipsoid, ...]:
        """All five."""
        return self.kinematic, self.active_force, self.passive_force, self.internal_force, self.dual_force

    @cached_property
    def twist_from_rates(self) -> LinearMap:
        """u = T q_a."""
        return twist_from_rates(self.model, self._definite("twist"), self._definite("rate"))

    @cached_property
    def torque_from_wrench(self) -> LinearMap:
        """The torques that balance a wrench: tau = S w."""
        return torque_from_wrench(self.model, self._definite("wrench"), self._definite("torque"))

    @cached_property
    def nearest_singular(self) -> NearestSingular | None:
        """The singular configuration nearest to a doubtful one, if the model comes from a mechanism."""
        doubtful = tuple(name for name in self.ledger.names if self._open(name))
        find = self.model.nearest
        return None if find is None or not doubtful else find(doubtful)

    def _open(self, name: MatrixName) -> bool:
        decision = self.ledger.decision(name)
        return decision.rank_min != decision.rank_max

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Doubtful ranks and mixed units, in words."""
        return tuple(message for message, _ in self.classified_warnings)

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of the command line (schema vincula/analysis/1)."""
        from vincula.analysis.report import as_object

        return as_object(self)

    def save(self, path: str | Path) -> None:
        """Write the JSON object to a file.

        Raises:
            FileError: The file cannot be written.
        """
        text = json.dumps(self.to_dict(), indent=2, allow_nan=False, ensure_ascii=False)
        try:
            Path(path).write_text(text + "\n", encoding="utf-8")
        except OSError as error:
            raise FileError(f"{path}: the analysis cannot be written ({error.strerror})") from None

    def __str__(self) -> str:
        from vincula.analysis.report import as_text

        return as_text(self)

    def _ellipsoid(self, kind: Kind) -> Ellipsoid:
        return ellipsoid_of_kind(kind, self.model, self.weights, self.viewpoint, self.convention)

    def _definite(self, quantity: Quantity) -> Metric:
        """The metric of a quantity, or the identity where the weight ignores something."""
        metric = self.weights.metric(quantity, self.model)
        return metric if metric.definite else identity_metric(metric.size)

    @cached_property
    def classified_warnings(self) -> tuple[tuple[str, type[UserWarning]], ...]:
        """The warnings, each with its class."""
        kinds: tuple[Kind, ...] = ("kinematic", "passive force", "internal force")
        mixed = (mixed_units_message(self.model, self.weights, task_quantity(kind)) for kind in kinds)
        return (
            *((message, RankAmbiguityWarning) for message in doubt_messages(self.model)),
            *((message, MixedUnitsWarning) for message in mixed if message),
        )


def analyze(
    model: LinearModel,
    weights: Weights | None = None,
    *,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
    exact: bool = False,
    assume_singular: bool = False,
) -> Analysis:
    """Everything the theory page says about a mechanism at one configuration.

    Args:
        model: The mechanism at one configuration.
        weights: The five weights; the model's own, else the identity in m, rad, N, N m.
        viewpoint: efficiency or accuracy.
        convention: printed gives the force numbers of the paper.
        exact: Prove the ranks, from exact numbers where the model knows them, else from below.
        assume_singular: Take doubtful singular values as zero; the result says so.

    Raises:
        WeightError: A weight that does not fit the model.
        ModelError: Unknown viewpoint or convention.
        MissingExtraError: `exact` without python-flint.

    Warns:
        RankAmbiguityWarning: A rank is not decided.
        MixedUnitsWarning: Metres and radians are added with weights that nobody chose.
    """
    if exact:
        from vincula.analysis.certificates import certified

        model = certified(model)
    if assume_singular:
        model = replace(model, evidence=replace(model.evidence, assume_singular=True))
    found = Analysis(model, resolved_weights(model, weights), viewpoint, convention)
    model.ledger.counts  # noqa: B018  all eight ranks: doubts are known from here on
    found.ellipsoids  # noqa: B018  refuses unfitting weights now, not at first use
    for message, category in found.classified_warnings:
        warnings.warn(message, category, stacklevel=2)
    return found
