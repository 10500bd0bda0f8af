"""Derivatives of a quantity at configurations that have the same ranks and list the same classes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.distance_sensitivity import EQUAL_VALUES, NOTHING_TO_LOSE
from vincula.analysis.ellipsoid import Class, Ellipsoid, Kind
from vincula.analysis.index_sensitivity import (
    EQUAL,
    EQUAL_AXES,
    NO_FINITE,
    SYMMETRIC,
    fixed,
    index_slopes,
    no_shadow,
)
from vincula.analysis.indices import components_of_part
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights
from vincula.analysis.sensitivity import CLUSTER
from vincula.arrays import Matrix
from vincula.kernels.dimensions import Dimensions
from vincula.kernels.evaluation import OK
from vincula.kernels.gradients_one_by_one import DISTANCE, SMOOTH
from vincula.kernels.index_formulas import INDEX_OF_AXES
from vincula.kernels.many_sensitivities import ManyAxes, ManySensitivities
from vincula.kernels.many_tangents import ManyTangents
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.quantities import CLASS_CODES, KINDS, WATCHED, Quantity
from vincula.mechanism.many_frames import Stack
from vincula.mechanism.many_matrices import ManyMatrices
from vincula.mechanism.virtual_work import FrameForces
from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts

if TYPE_CHECKING:
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.mechanism.mechanism import Mechanism

CLEARLY_REACHED: Final = 1e-5
"""Shortest semi-axis of a shadow over the longest of the set, where the shadow is clearly not flat."""
_CLASSES: Final[dict[int, Class]] = {code: name for name, code in CLASS_CODES.items()}
_WORDS: Final = {kind: word for word, kind in KINDS.items()}

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What is known of a group of configurations.

    Attributes:
        values: The quantity, N x entries.
        slopes: Its derivatives, N x entries x names.
        smooth: Which exist.
        reasons: Why one does not, by configuration and entry.
        certain: Configurations of which all this may be believed; the others are to be looked at.
    """

    values: Stack
    slopes: Stack
    smooth: NDArray[np.bool_]
    reasons: dict[tuple[int, ...], str]
    certain: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Question:
    """A quantity with what it is made from.

    Attributes:
        asked: The quantity.
        kind: Its ellipsoid.
        source: The ellipsoid whose pairs of directions are evaluated: forces under reciprocal weights have
            those of motions.
        model: The linear model without numbers.
        probe: The ellipsoid of that, for its weights and components.
        ranks: General ranks of the watched matrices, where distances from singularities are asked for.
    """

    asked: Quantity
    kind: Kind
    source: Kind
    model: LinearModel
    probe: Ellipsoid
    ranks: tuple[int, ...] = ()

    @staticmethod
    def of(compiled: CompiledMechanism, mechanism: Mechanism, asked: Quantity) -> Question:
        """The question for one mechanism."""
        kind: Kind = asked.kind or "kinematic"
        model = model_without_numbers(mechanism)
        weights = resolved_weights(model, compiled.weights)
        shared = weights.dual and kind != "internal force"
        probe = ellipsoid_of_kind(kind, model, weights)
        ranks = compiled.general_ranks if asked.part == DISTANCE else ()
        return Question(asked, kind, "kinematic" if shared else kind, model, probe, ranks)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """What has to be evaluated."""
        if self.asked.part == DISTANCE:
            return ("summary", "kinematic.classes")
        own, source = _WORDS[self.kind], _WORDS[self.source]
        parts = ("classes", "efficiencies", "task_directions", "motor_directions")
        found = ["summary", f"{own}.classes", f"{own}.efficiencies", *(f"{source}.{part}" for part in parts)]
        return tuple(dict.fromkeys(found))

    def groups(self, arrays: Arrays) -> Iterator[NDArray[np.intp]]:
        """Configurations that are certain, by ranks and classes."""
        certain = np.flatnonzero(arrays["status"] == OK)
        if not len(certain):
            return
        columns = ["summary", f"{_WORDS[self.kind]}.classes", f"{_WORDS[self.source]}.classes"]
        keys = np.hstack([np.asarray(arrays[name][certain], dtype=np.int64) for name in columns])
        _, which = np.unique(keys, axis=0, return_inverse=True)
        for place in range(int(which.max()) + 1):
            yield certain[which.ravel() == place]

    def classes(self, arrays: Arrays) -> tuple[Class, ...]:
        """Classes that the ellipsoid lists in a group."""
        codes = arrays[f"{_WORDS[self.kind]}.classes"][0]
        return tuple(_CLASSES[int(code)] for code in codes if int(code) in _CLASSES)

    def pairs(self, arrays: Arrays) -> ManyAxes:
        """Finite efficiencies of a group with their pairs, largest first."""
        source = _WORDS[self.source]
        finite = np.flatnonzero(arrays[f"{source}.classes"][0] == CLASS_CODES["finite"])
        squares = np.ascontiguousarray(arrays[f"{source}.efficiencies"][:, finite])
        tasks = np.ascontiguousarray(arrays[f"{source}.task_directions"][:, finite])
        motors = np.ascontiguousarray(arrays[f"{source}.motor_directions"][:, finite])
        if self.source != self.kind:
            # The same angles with sines and cosines swapped, tau.q_a + w.u = 0: `spectrum.dual_spectrum`.
            squares = 1.0 / squares[:, ::-1]
            reciprocal = self.probe.task_weight.inverse, self.probe.motor_weight.inverse
            tasks, motors = (
                np.ascontiguousarray(side[:, ::-1]) @ (inverse @ inverse.T)
                for side, inverse in zip((tasks, -motors), reciprocal, strict=True)
            )
        everything = np.ones(tasks.shape[-1])
        return ManyAxes(self.kind, squares, tasks * np.sqrt(squares)[..., None], motors, everything)


class ManyDerivatives:
    """Derivatives of one quantity of one mechanism.

    Args:
        mechanism: The mechanism.
        question: The quantity.
        wrt: `motors`, `joints`, or names of parameters.
        dimensions: How the mechanism changes with parameters, where these are asked for.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        question: Question,
        wrt: str | Sequence[str],
        dimensions: Dimensions | None,
    ) -> None:
        self._mechanism, self._question, self._wrt = mechanism, question, wrt
        self._dimensions = dimensions

    def of(self, values: Matrix, arrays: Arrays) -> Part | None:
        """The derivatives of a group; None where it is one for the path for one configuration.

        Args:
            values: N x coordinates.
            arrays: What was evaluated there.
        """
        counts = SummaryCounts(*(int(count) for count in arrays["summary"][0]))
        if not self._regular(counts):
            return None
        if self._question.asked.part == DISTANCE:
            return self._of_distance(values, counts)
        classes = self._question.classes(arrays)
        pairs = self._question.pairs(arrays)
        many = ManyMatrices(self._mechanism, values)
        found = ManySensitivities(many, self._question.model, counts)
        if self._question.asked.part in SMOOTH:
            return self._of_index(found, pairs, classes)
        return self._of_efficiencies(found, pairs, classes, arrays)

    def _regular(self, counts: SummaryCounts) -> bool:
        """Whether the directions that are asked for exist, as far as counts say it."""
        if min(counts.as_dict().values()) < 0 or counts.mobility == 0:
            return False
        if self._wrt == "joints":
            return True
        motors = len(self._question.model.motors)
        if self._question.asked.part == DISTANCE and counts.passive_redundancy:
            return False
        driven = counts.mobility - counts.passive_redundancy
        return counts.indeterminacy == 0 < motors and (driven == motors or self._wrt != "motors")

    def _of_efficiencies(
        self, found: ManySensitivities, pairs: ManyAxes, classes: tuple[Class, ...], arrays: Arrays
    ) -> Part:
        part, lanes = self._question.asked.part, len(pairs.squares)
        finite = [k for k, name in enumerate(classes) if name == "finite"]
        listed = arrays[f"{_WORDS[self._question.kind]}.efficiencies"]
        alone = _alone(pairs.squares)
        if part == "efficiencies":
            chosen, places = list(range(len(finite))), finite
            values = np.array(listed)
            words = {(k,): fixed(name) for k, name in enumerate(classes) if name != "finite"}
        else:
            chosen = ([len(finite) - 1] if part == "smallest" else [0])[: len(finite)]
            places = [0][: len(chosen)]
            values = listed[:, finite][:, chosen] if finite else np.full((lanes, 1), np.nan)
            words = {} if finite else {(0,): NO_FINITE}
        slopes, certain = self._along(found, _chosen(pairs, chosen))
        wide = np.full((*values.shape, slopes.shape[-1]), np.nan)
        smooth = np.zeros(values.shape, dtype=bool)
        for k, place in zip(chosen, places, strict=True):
            single = alone[:, k]
            wide[single, place], smooth[single, place] = slopes[single, chosen.index(k)], True
        reasons: dict[tuple[int, ...], str] = {
            (lane, *entry): text for entry, text in words.items() for lane in range(lanes)
        }
        for k, place in zip(chosen, places, strict=True):
            reasons.update({(int(lane), place): EQUAL for lane in np.flatnonzero(~alone[:, k])})
        return _entries(Part(values, wide, smooth, reasons, certain), part)

    def _of_index(self, found: ManySensitivities, pairs: ManyAxes, classes: tuple[Class, ...]) -> Part | None:
        """Derivatives of an index; None where its value has to be looked at."""
        question, lanes = self._question, len(pairs.squares)
        factor = question.probe.task_weight.factor
        chosen = components_of_part(question.probe, question.asked.on)
        seen = factor[:, chosen]
        count = min(seen.shape)
        if (
            no_shadow(question.probe, classes, found.counts.structural_wrenches)
            or pairs.squares.shape[1] < count
        ):
            return None
        cast = seen @ np.swapaxes(pairs.tasks[..., chosen], 1, 2)
        _, lengths, right = np.linalg.svd(cast, full_matrices=False)
        longest = np.sqrt(pairs.squares.max(axis=1))
        clear = lengths[:, count - 1] > CLEARLY_REACHED * np.maximum(lengths[:, 0], longest)
        # Whatever stands for the others is not believed.
        lengths, basis = np.where(clear[:, None], lengths[:, :count], 1.0), right[:, :count]
        mask = np.zeros(pairs.tasks.shape[-1])
        mask[chosen] = 1.0
        squares = lengths**2
        axes = ManyAxes(question.kind, squares, basis @ pairs.tasks, basis @ pairs.motors, mask)
        values = INDEX_OF_AXES[question.asked.part](lengths)
        part = index_slopes(SMOOTH[question.asked.part], squares, values)
        single = np.ones(lanes, dtype=bool)
        if SMOOTH[question.asked.part] not in SYMMETRIC:
            apart = np.abs(squares[:, :, None] - squares[:, None]) > 2.0 * CLUSTER * squares[:, None]
            others = apart.sum(axis=1) == count - 1
            single = (others | (part == 0.0)).all(axis=1)
        along, certain = self._along(found, axes)
        slopes = (part[:, None] @ along)[:, 0]
        slopes[~single] = np.nan
        reasons: dict[tuple[int, ...], str] = {(int(lane),): EQUAL_AXES for lane in np.flatnonzero(~single)}
        return Part(values, slopes, single, reasons, certain & clear)

    def _of_distance(self, values: Matrix, counts: SummaryCounts) -> Part | None:
        """Derivatives of distances from singularities; None where a rank is not the usual one."""
        found = ManySensitivities(ManyMatrices(self._mechanism, values), self._question.model, counts)
        ranks = self._question.ranks
        if ranks != found.watched_ranks or not any(ranks):
            return None
        distances, forces, motions, alone = found.distances(WATCHED, ranks)
        along, certain = self._by_everything(found, found.forces_of(forces, motions))
        some = [k for k, rank in enumerate(ranks) if rank > 0]
        slopes = np.full((*distances.shape, along.shape[-1]), np.nan)
        slopes[:, some] = -(along[:, : len(some)] + along[:, len(some) :])
        smooth = np.zeros(distances.shape, dtype=bool)
        smooth[:, some] = alone
        slopes[~smooth] = np.nan
        reasons: dict[tuple[int, ...], str] = {
            (int(lane), int(k)): EQUAL_VALUES if ranks[k] > 0 else NOTHING_TO_LOSE
            for lane, k in np.argwhere(~smooth)
        }
        return Part(distances, slopes, smooth, reasons, certain)

    def _by_everything(self, found: ManySensitivities, felt: FrameForces) -> tuple[Stack, NDArray[np.bool_]]:
        """Rates of y^T A k by everything that is asked for, and where they are certain."""
        tangents = ManyTangents(found)
        if self._dimensions is not None:
            return tangents.by_dimensions(felt, self._dimensions.placements)
        return tangents.by_motors(felt) if self._wrt == "motors" else tangents.by_joints(felt)

    def _along(self, found: ManySensitivities, axes: ManyAxes) -> tuple[Stack, NDArray[np.bool_]]:
        """Derivatives of semi-axes by everything that is asked for, and where they are certain."""
        probe = self._question.probe
        forces, motions, load = found.dyads(axes, probe.task_weight, probe.motor_weight)
        along, certain = self._by_everything(found, found.forces_of(forces, motions))
        slopes = -along[:, : axes.squares.shape[1]]
        if load is not None:
            slopes = slopes - along[:, axes.squares.shape[1] :]
        rates = [] if self._dimensions is None else self._dimensions.metric_rates(self._question.kind)
        if rates:
            task, motor = (np.array([pair[side] for pair in rates]) for side in (0, 1))
            slopes = slopes + axes.by_weights(task, motor, load)
        return slopes, certain


def _alone(squares: Stack) -> NDArray[np.bool_]:
    """Whether every efficiency is apart from the others: `sensitivity.alone`."""
    angle = np.arctan(np.sqrt(squares))
    near = CLUSTER * np.minimum(angle, np.pi / 2 - angle)
    close = np.abs(angle[:, None, :] - angle[:, :, None]) <= near[:, :, None]
    return np.asarray(close.sum(axis=2) == 1)


def _chosen(pairs: ManyAxes, places: Sequence[int]) -> ManyAxes:
    """Some of the semi-axes."""
    if list(places) == list(range(pairs.squares.shape[1])):
        return pairs
    squares, tasks, motors = (side[:, list(places)] for side in (pairs.squares, pairs.tasks, pairs.motors))
    return replace(pairs, squares=squares, tasks=tasks, motors=motors)


def _entries(part: Part, name: str) -> Part:
    """A list of efficiencies as it is; one of them without the axis of entries."""
    if name == "efficiencies":
        return part
    reasons: dict[tuple[int, ...], str] = {(lane,): words for (lane, *_), words in part.reasons.items()}
    return Part(part.values[:, 0], part.slopes[:, 0], part.smooth[:, 0], reasons, part.certain)
