"""One batch computed two ways, in lanes and one by one, and what is to be the same."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

import vincula as vc
from vincula.arrays import Matrix
from vincula.kernels.quantities import KINDS

COMPARED = (
    "counts",
    "summary",
    "bounds",
    "singularity.distance",
    *(
        f"{kind}.{part}"
        for kind in KINDS
        for part in ("efficiencies", "classes", "task_directions", "motor_directions")
    ),
    *(f"{kind}.{index}:translation" for kind in KINDS for index in ("isotropy", "inverse_condition_number")),
)
WELL = 1e-10
"""Relative difference allowed where the problem is well conditioned; elsewhere the reported bound is."""
APART = 1e-3
"""Directions are compared where neighbouring efficiencies differ by this much, relatively."""


@dataclass
class Comparison:
    """What was different.

    Attributes:
        lanes: Number of configurations.
        status: Configurations with another status.
        integers: Configurations with another count or class.
        values: Efficiencies that differ by more than they may.
        largest: Largest relative difference of a kinematic efficiency among those known to 1e-7.
        turned: Largest difference of a direction that is well determined.
        indices: Largest difference of an index that is well determined.
        distances: Largest difference of a distance to a singularity.
        special: Configurations that are doubtful or differ in their counts from the most.
        notes: Examples of differences.
    """

    lanes: int
    status: int = 0
    integers: int = 0
    values: int = 0
    largest: float = 0.0
    turned: float = 0.0
    indices: float = 0.0
    distances: float = 0.0
    special: int = 0
    notes: list[str] = field(default_factory=list)

    @property
    def same(self) -> bool:
        """Whether nothing is different beyond what may be."""
        near = self.turned < 1e-7 and self.indices < 1e-7 and self.distances < 1e-13
        return near and not (self.status or self.integers or self.values)


def compared(
    compiled: vc.CompiledMechanism, lanes: Matrix, quantities: tuple[str, ...] = COMPARED
) -> Comparison:
    """The default path against the reference path."""
    fast, slow = (compiled.evaluate(lanes, quantities, path=path) for path in ("auto", "reference"))
    found = Comparison(len(lanes))
    found.status = int((fast.status != slow.status).sum())
    for lane in np.flatnonzero(fast.status != slow.status)[:3]:
        found.notes.append(
            f"lane {lane}: status {fast.status[lane]} for {slow.status[lane]}, {slow.reason(lane)[:200]}"
        )
    wrong = np.zeros(len(lanes), dtype=bool)
    for name in quantities:
        if fast[name].dtype.kind in "iu":
            wrong |= (fast[name] != slow[name]).reshape(len(lanes), -1).any(axis=1)
    found.integers = int(wrong.sum())
    found.notes += [f"lane {lane}: other integers" for lane in np.flatnonzero(wrong)[:3]]
    usual = np.unique(slow["summary"], axis=0, return_counts=True)
    most = usual[0][usual[1].argmax()] if len(lanes) else 0
    found.special = int(((slow.status != 0) | (slow["summary"] != most).any(axis=1)).sum())
    for kind in KINDS:
        if f"{kind}.efficiencies" in quantities:
            _compare_values(found, kind, fast, slow)
        if f"{kind}.task_directions" in quantities:
            _compare_directions(found, kind, fast, slow)
    _compare_indices(found, fast, slow)
    if "singularity.distance" in quantities:
        one, two = fast["singularity.distance"], slow["singularity.distance"]
        assert (np.isfinite(one) == np.isfinite(two)).all()
        here = np.isfinite(one)
        found.distances = float(np.abs(one[here] - two[here]).max(initial=0.0))
    return found


def _compare_values(found: Comparison, kind: str, fast: vc.Evaluation, slow: vc.Evaluation) -> None:
    one, two = fast[f"{kind}.efficiencies"], slow[f"{kind}.efficiencies"]
    finite = np.isfinite(one) & np.isfinite(two)
    same = (one == two) | (np.isnan(one) & np.isnan(two))
    with np.errstate(all="ignore"):
        relative = np.where(finite & ~same, np.abs(one - two) / np.maximum(np.abs(two), 1e-300), 0.0)
        doubt = doubt_of(fast, slow)
    allowed = np.maximum(WELL, 2.0 * doubt)[:, None]
    bad = ~same & (~finite | (relative > allowed))
    found.values += int(bad.sum())
    for lane, entry in np.argwhere(bad)[:2]:
        found.notes.append(
            f"lane {lane}: {kind} {entry} is {one[lane, entry]:.17g}, one by one {two[lane, entry]:.17g}, "
            f"allowed {allowed[lane, 0]:.1e}"
        )
    sure = (doubt < 1e3 * WELL)[:, None] & finite
    if kind == "kinematic" and sure.any():
        found.largest = max(found.largest, float(relative[sure].max()))


def doubt_of(fast: vc.Evaluation, slow: vc.Evaluation) -> np.ndarray:
    """Largest relative bound of a kinematic efficiency, by lane."""
    with np.errstate(all="ignore"):
        share = fast["bounds"] / slow["kinematic.efficiencies"]
    return np.nanmax(np.where(np.isfinite(slow["kinematic.efficiencies"]), share, 0.0), axis=1, initial=0.0)


def _compare_directions(found: Comparison, kind: str, fast: vc.Evaluation, slow: vc.Evaluation) -> None:
    values = np.sqrt(slow[f"{kind}.efficiencies"])
    finite = np.where(np.isfinite(values) & (values > 0.0), values, np.nan)
    with np.errstate(all="ignore"):
        steps = np.abs(np.diff(finite, axis=1)) / np.nanmax(finite, axis=1, initial=0.0, keepdims=True)
        apart = (np.isnan(steps) | (steps > APART)).all(axis=1)
    apart &= doubt_of(fast, slow) < 1e-9
    for side in ("task_directions", "motor_directions"):
        one, two = fast[f"{kind}.{side}"][apart], slow[f"{kind}.{side}"][apart]
        if one.size:
            assert (np.isnan(one) == np.isnan(two)).all()
            # Signs go by the largest component; where two are equal they may be taken either way.
            flips = np.sign(np.nansum(one * two, axis=2, keepdims=True))
            found.turned = max(found.turned, float(np.nanmax(np.abs(one * flips - two), initial=0.0)))


def _compare_indices(found: Comparison, fast: vc.Evaluation, slow: vc.Evaluation) -> None:
    """Indices from 0 to 1; what is zero, infinite or nothing must be so in both."""
    sure = doubt_of(fast, slow) < 1e-9
    for name in fast:
        if ":" in name:
            one, two = fast[name][sure], slow[name][sure]
            assert (np.isnan(one) == np.isnan(two)).all(), name
            assert ((one == 0.0) == (two == 0.0)).all(), name
            found.indices = max(found.indices, float(np.nanmax(np.abs(one - two), initial=0.0)))
