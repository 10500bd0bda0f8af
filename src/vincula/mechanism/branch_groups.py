"""Groups of loops and joints that have nothing to do with the others: what every sign of a branch is about.

They follow from the structure alone, so they are the same at every configuration: whole loops and joints
belong together wherever an entry between them can differ from zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Side = Literal["assembly", "working"]
"""What is locked: the motors (assembly), or the reference member (working)."""
SIDES: Final[tuple[Side, ...]] = ("assembly", "working")


@dataclass(frozen=True, slots=True)
class Group:
    """One group of loops and joints.

    Attributes:
        label: The member's name, or its motors; the first joint where it has neither.
        rows: Its rows of [J_a J_p -G^T].
        columns: Its columns.
    """

    label: str
    rows: tuple[int, ...]
    columns: tuple[int, ...]


def branch_groups(mechanism: Mechanism) -> dict[Side, tuple[Group, ...]]:
    """The groups with the motors locked and with the reference member locked, in the order of the joints.

    Args:
        mechanism: A mechanism with a reference member.
    """
    layout = mechanism.layout
    motors, joints = len(layout.active), len(layout.columns)
    order = [*layout.active, *layout.passive]
    touched = _touched(mechanism)[:, [*order, *range(joints, joints + mechanism.space.dimension)]]
    owners = [layout.columns[k].joint for k in order] + [""] * mechanism.space.dimension
    sources = [row.source for row in layout.rows]
    reference = mechanism.reference
    member = reference.body if reference else "member"
    axes = [layout.columns[k].name for k in layout.active]

    def found(columns: range) -> tuple[Group, ...]:
        groups = _joined(touched, sources, owners, columns)
        labels: list[str] = []
        for _, own in groups:
            driven = "+".join(axes[k] for k in own if k < motors)
            label = member if "" in {owners[k] for k in own} else driven or owners[own[0]]
            labels.append(_unlike(label, labels))
        return tuple(Group(label, *group) for label, group in zip(labels, groups, strict=True))

    return {"assembly": found(range(motors, touched.shape[1])), "working": found(range(joints))}


def _unlike(label: str, taken: Iterable[str]) -> str:
    """The label, told apart from a joint or body of the same name."""
    while label in taken:
        label += "_"
    return label


def _touched(mechanism: Mechanism) -> NDArray[np.bool_]:
    """Entries of [J G^T] that can differ from zero, columns in the order of the layout."""
    layout, geometric = mechanism.layout, len(mechanism.layout.signs)
    joints, index = len(layout.columns), layout.index
    touched = np.zeros((len(layout.rows), joints + mechanism.space.dimension), dtype=bool)
    touched[:geometric, :joints] = layout.signs != 0.0
    touched[:geometric, joints:] = (layout.carried != 0.0)[:, None]
    touched[geometric:, :joints] = layout.constant != 0.0
    for k, coupling in layout.polynomials:
        touched[geometric + k, [index[axis] for axis in coupling.axes if axis in index]] = True
    return touched


def _joined(
    touched: NDArray[np.bool_], sources: list[str], owners: list[str], columns: range
) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Rows and columns of every group that has rows: loops that share a joint."""
    group = {owner: k for k, owner in enumerate(dict.fromkeys(owners[c] for c in columns))}
    reached: dict[str, set[str]] = {}
    for row, column in np.argwhere(touched):
        if column in columns:
            reached.setdefault(sources[row], set()).add(owners[column])
    for members in reached.values():
        merged = {group[owner] for owner in members}
        group = {owner: min(merged) if g in merged else g for owner, g in group.items()}
    found = []
    for label in sorted(set(group.values())):
        own = tuple(c for c in columns if group[owners[c]] == label)
        rows = tuple(
            k for k, source in enumerate(sources) if label in {group[o] for o in reached.get(source, ())}
        )
        if rows:
            found.append((rows, own))
    return found
