"""What a batch can be asked for: names, sizes, units, and what stands where there is nothing.

The size of every quantity is fixed by the mechanism alone, never by the data: an ellipsoid has at most
as many entries as its relation has dimensions, and what is not there is NaN (or `NO_COUNT`, `NO_CLASS`).
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final, get_args

import numpy as np

from vincula.analysis.ellipsoid import Class, Kind
from vincula.analysis.indices import Part
from vincula.errors import UnknownNameError, listing
from vincula.mechanism.branch_groups import SIDES, Side, branch_groups
from vincula.mechanism.mechanism import Mechanism
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.numerics.ledger import MatrixName

KINDS: Final[dict[str, Kind]] = {kind.replace(" ", "_"): kind for kind in get_args(Kind)}
"""Names of the five ellipsoids in quantities."""
CLASS_CODES: Final[dict[Class, int]] = {"zero": 0, "finite": 1, "infinite": 2, "undefined": 3}
"""What the numbers of `<ellipsoid>.classes` mean."""
NO_CLASS: Final = -1
"""In `<ellipsoid>.classes`: no such entry."""
NO_COUNT: Final = int(np.iinfo(np.int16).min)
"""In integers: nothing is known here (an open or failed configuration)."""
COUNTS: Final = tuple(TwelveCounts.__dataclass_fields__)
"""Names of the twelve counts, in order."""
SUMMARY: Final = tuple(SummaryCounts.__dataclass_fields__)
"""Names of the summary counts, in order."""
WATCHED: Final[tuple[MatrixName, ...]] = ("passive", "active+passive", "passive+member", "all")
"""The matrices whose ranks the summary counts rest on."""
INDICES: Final = {
    "yoshikawa_volume": "product of the semi-axes",
    "condition": "longest over shortest semi-axis",
    "condition_number": "longest over shortest semi-axis",
    "inverse_condition_number": "shortest over longest semi-axis",
    "isotropy": "geometric over arithmetic mean of the squared semi-axes",
    "smallest_singular_value": "shortest semi-axis",
}
"""Indices of an ellipsoid (see `vincula.analysis.indices`), each on `:translation`, `:rotation` or `:all`."""


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """One thing that a batch can be asked for.

    Attributes:
        name: Its name, `kinematic.efficiencies`.
        meaning: What it is, in words.
        part: What is read off: the word after the dot, or the whole name.
        kind: The ellipsoid it belongs to; None for the others.
        on: Components that an index is taken over.
        dims: Names of the axes behind the batch.
        labels: For every one of these axes the names along it; empty where they are only numbered.
        shape: Lengths of these axes.
        dtype: Type of its numbers.
        fill: What stands where there is nothing.
        unit: Unit of its numbers; empty where they are pure or depend on the weights.
    """

    name: str
    meaning: str
    part: str
    kind: Kind | None = None
    on: Part = "all"
    dims: tuple[str, ...] = ()
    labels: tuple[tuple[str, ...], ...] = ()
    shape: tuple[int, ...] = ()
    dtype: Any = np.float64
    fill: float = float("nan")
    unit: str = ""

    def empty(self, lanes: int) -> np.ndarray[Any, Any]:
        """An array for that many configurations with nothing in it yet."""
        return np.full((lanes, *self.shape), self.fill, dtype=self.dtype)


def coordinates(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the numbers of one configuration, in order: joints, for several values with the value.

    A universal or cylindrical joint gives `joint.1`; a ball, and the orientation of a free joint, gives
    `joint.qw joint.qx joint.qy joint.qz`.
    """
    names: list[str] = []
    for joint, values in mechanism.home.items():
        parts = _VALUE_NAMES.get((mechanism.joint[joint].type, len(values)))
        if len(values) == 1:
            names.append(joint)
        else:
            names += [f"{joint}.{part}" for part in parts or range(1, len(values) + 1)]
    return tuple(names)


_QUATERNION: Final = ("qw", "qx", "qy", "qz")
_VALUE_NAMES: Final[dict[tuple[str, int], tuple[str, ...]]] = {
    ("spherical", 4): _QUATERNION,
    ("free", 7): ("x", "y", "z", *_QUATERNION),
    ("free", 3): ("x", "y", "rotation"),
    ("planar", 3): ("x", "y", "rotation"),
    ("cylindrical", 2): ("rotation", "translation"),
}


def quaternion_places(mechanism: Mechanism) -> tuple[int, ...]:
    """Where in one configuration quaternions begin."""
    places, start = [], 0
    for values in mechanism.home.values():
        if len(values) in (4, 7):
            places.append(start + len(values) - 4)
        start += len(values)
    return tuple(places)


def pose_components(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the numbers of a pose of the reference member, in order [m, rad]."""
    return (
        ("x", "y", "angle") if mechanism.space.translations == 2 else ("x", "y", "z", "qw", "qx", "qy", "qz")
    )


def available(mechanism: Mechanism) -> dict[str, Quantity]:
    """Every quantity of a mechanism by name; indices on parts are written `kinematic.condition:rotation`.

    Raises:
        MissingReferenceError: No reference member is named.
    """
    found = [Quantity("status", "0 ok, 1 doubtful, 2 open, 3 no closure, 4 failed", "status",
                      dtype=np.uint8, fill=4.0)]  # fmt: skip
    for word, kind in KINDS.items():
        found += _of_ellipsoid(mechanism, word, kind)
    found += _of_counts()
    found += _of_closure(mechanism)
    found += _of_branches(mechanism)
    return {quantity.name: quantity for quantity in found}


def chosen(known: Mapping[str, Quantity], names: Iterable[str]) -> tuple[Quantity, ...]:
    """The quantities asked for, `status` first, each once.

    Raises:
        UnknownNameError: A name that is no quantity.
    """
    found = {"status": known["status"]}
    for name in names:
        if name not in known:
            close = difflib.get_close_matches(str(name), known, n=3)
            raise UnknownNameError("quantity", str(name), [*close, *(k for k in known if k not in close)])
        found[name] = known[name]
    return tuple(found.values())


def in_words(quantity: str) -> str:
    """A quantity as a reader says it, in two lines: what it is, and of which ellipsoid and components."""
    head, _, on = quantity.partition(":")
    kind, _, index = head.rpartition(".")
    of = ", ".join(part.replace("_", " ") for part in (kind, on) if part)
    return f"{index.replace('_', ' ')}\n{of}" if of else index.replace("_", " ")


def width(mechanism: Mechanism, kind: Kind) -> int:
    """Most entries that an ellipsoid of this mechanism can list at any configuration."""
    layout, d = mechanism.layout, mechanism.space.dimension
    motors, rows = len(layout.active), len(layout.rows)
    most: dict[Kind, int] = {
        "kinematic": motors + d,
        "active force": motors,
        "passive force": d,
        "internal force": rows,
        "dual force": min(motors, d),
    }
    return most[kind]


def _of_ellipsoid(mechanism: Mechanism, word: str, kind: Kind) -> list[Quantity]:
    layout, space = mechanism.layout, mechanism.space
    count = width(mechanism, kind)
    motors = tuple(layout.columns[k].name for k in layout.active)
    if kind == "internal force":
        components = tuple(row.name for row in layout.rows)
    else:
        components = space.twist_components if kind == "kinematic" else space.wrench_components
    task, entry = (
        {"kinematic": "twist", "internal force": "contact force"}.get(kind, "wrench"),
        f"{word} entry",
    )
    codes = listing(f"{code} {name}" for name, code in CLASS_CODES.items())

    def one_each(part: str, meaning: str, dim: str = "", names: tuple[str, ...] = (), **how: Any) -> Quantity:
        dims, labels, shape = ((dim,), (names,), (len(names),)) if dim else ((), (), ())
        return Quantity(f"{word}.{part}", meaning, part, kind, dims=(entry, *dims), labels=((), *labels),
                        shape=(count, *shape), **how)  # fmt: skip

    unit = "of length one in the metric"
    found = [
        one_each("efficiencies", f"efficiencies of the {kind} ellipsoid"),
        one_each("classes", f"{NO_CLASS} none, {codes}", dtype=np.int8, fill=NO_CLASS),
        one_each("task_directions", f"{task} of every efficiency, {unit}", task, components),
        one_each("motor_directions", f"motors of every efficiency, {unit}", "motor", motors),
        Quantity(f"{word}.smallest", f"smallest finite efficiency of the {kind} ellipsoid", "smallest", kind),
        Quantity(f"{word}.largest", f"largest finite efficiency of the {kind} ellipsoid", "largest", kind),
    ]
    for index, meaning in INDICES.items():
        name = f"{word}.{index}"
        found.append(Quantity(name, f"{meaning} of the {kind} ellipsoid", index, kind))
        for part in get_args(Part):
            words = f"{meaning} of the {kind} ellipsoid, {part}"
            found.append(Quantity(f"{name}:{part}", words, index, kind, on=part))
    return found


def _of_counts() -> list[Quantity]:
    integers: dict[str, Any] = {"dtype": np.int16, "fill": NO_COUNT}
    found = [
        Quantity("counts", "the twelve counts", "counts", dims=("count",), labels=(COUNTS,),
                 shape=(len(COUNTS),), **integers),
        Quantity("summary", "the summary counts", "summary", dims=("summary count",), labels=(SUMMARY,),
                 shape=(len(SUMMARY),), **integers),
    ]  # fmt: skip
    return found + [Quantity(name, name.replace("_", " "), name, **integers) for name in SUMMARY]


def _of_closure(mechanism: Mechanism) -> list[Quantity]:
    places, pose = coordinates(mechanism), pose_components(mechanism)
    entries = width(mechanism, "kinematic")
    return [
        Quantity("closure.residual", "largest gap of a loop, contact or coupling", "closure.residual",
                 unit="m"),
        Quantity("closure.iterations", "Jacobians evaluated to close the loops", "closure.iterations",
                 dtype=np.int32, fill=-1),
        Quantity("reference.pose", "reference point and axes of the reference member in ground axes [m, rad]",
                 "reference.pose", dims=("pose",), labels=(pose,), shape=(len(pose),)),
        Quantity("configuration", "joint values [m, rad]", "configuration", dims=("coordinate",),
                 labels=(places,), shape=(len(places),)),
        Quantity("singularity.distance", "smallest singular value not always zero, over the largest of all",
                 "singularity.distance", dims=("matrix",), labels=(WATCHED,), shape=(len(WATCHED),)),
        Quantity("bounds", "how far every kinematic efficiency may be off within the uncertainties", "bounds",
                 "kinematic", dims=("kinematic entry",), labels=((),), shape=(entries,)),
    ]  # fmt: skip


SIDE_OF: Final[dict[str, Side]] = {f"branch.{side}": side for side in SIDES}
"""What is locked, by quantity."""


def _of_branches(mechanism: Mechanism) -> list[Quantity]:
    groups = branch_groups(mechanism)
    zero = {"assembly": "the member is free with the motors locked", "working": "motors lose authority"}
    found = []
    for name, side in SIDE_OF.items():
        words = f"signed measure of every group of loops, + as at home, 0 where {zero[side]}"
        dim, names = f"{side} group", tuple(group.label for group in groups[side])
        found.append(Quantity(name, words, name, dims=(dim,), labels=(names,), shape=(len(names),)))
    return found
