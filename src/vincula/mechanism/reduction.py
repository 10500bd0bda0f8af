"""From any graph to two trees and a list of cuts: the two-root rule.

The graph has two roots, the ground (at rest) and the reference member (moving with twist u).  Every
other body hangs, through joints, from the ground where a path of joints leads there without passing
the member, otherwise from the member.  Every joint outside this forest, and every contact, gives
constraint rows.  The reduction is structure only; numbers come with a configuration.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from vincula.errors import TopologyError
from vincula.mechanism.parts import GROUND, ContactPart, Cut, Joint

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Path = tuple[tuple[str, int], ...]
"""Joints on the way from a root to a body: (joint name, +1 if walked from first to second)."""


@dataclass(frozen=True, slots=True)
class CutJoint:
    """A joint outside the forest.

    Attributes:
        joint: The joint.
        kind: kept or contact.
        role: member cut (between the two trees) or loop cut (inside one).
        limb_body: Body on the limb side (of a loop cut the first body).
        limb_sign: +1 when the limb body is the joint's first body.
    """

    joint: Joint
    kind: Literal["kept", "contact"]
    role: Literal["member cut", "loop cut"]
    limb_body: str
    limb_sign: int

    @property
    def other_body(self) -> str:
        """The body on the other side, which is cut: it carries the cut point."""
        return self.joint.second if self.limb_sign > 0 else self.joint.first


@dataclass(frozen=True, slots=True)
class Reduction:
    """The opened graph.

    Attributes:
        paths: For every body, the joints from its root.
        carried: For every body, True when it hangs from the reference member.
        cuts: Joints outside the forest.
        contacts: Contacts.
        unused: Names of unactuated free joints between the roots, which give neither rows nor columns.
        clusters: Bodies that move as one, by representative.
        notes: What the reader of a result should know about the reduction.
    """

    paths: dict[str, Path]
    carried: dict[str, bool]
    cuts: tuple[CutJoint, ...]
    contacts: tuple[ContactPart, ...]
    unused: frozenset[str]
    clusters: dict[str, tuple[str, ...]]
    notes: tuple[str, ...]


def reduce_graph(mechanism: Mechanism) -> Reduction:
    """The two-root reduction of a mechanism with a reference member.

    Raises:
        TopologyError: A cut that is impossible, or a member that cannot be separated.
    """
    reference = mechanism.reference
    if reference is None:
        raise TopologyError("a reduction needs a reference member")
    cluster = _clusters(mechanism)
    ground, member = cluster[GROUND], cluster[reference.body]
    if ground == member:
        raise TopologyError(
            f"the reference member {reference.body!r} is fixed to the ground: it cannot move; "
            "choose another body"
        )
    skipped = {j.name for j in mechanism.all_joints if _between_roots(mechanism, j, cluster, ground, member)}
    joints = [
        j for j in mechanism.all_joints if cluster[j.first] != cluster[j.second] and j.name not in skipped
    ]
    forest = _Forest(mechanism, joints, cluster, ground, member)
    tree = forest.tree
    rigid_loops = [
        j for j in mechanism.all_joints if cluster[j.first] == cluster[j.second] and not merges(mechanism, j)
    ]
    cuts = [_cut(mechanism, j, forest, member) for j in (*joints, *rigid_loops) if j.name not in tree]
    _check_cuts(reference.cuts, [c.joint.name for c in cuts], mechanism)
    bodies = [GROUND, *mechanism.body]
    groups: dict[str, list[str]] = {}
    for name in bodies:
        groups.setdefault(cluster[name], []).append(name)
    return Reduction(
        paths={name: forest.path[cluster[name]] for name in bodies},
        carried={name: forest.root[cluster[name]] == member for name in bodies},
        cuts=tuple(cuts),
        contacts=mechanism.contacts,
        unused=frozenset(skipped),
        clusters={name: tuple(members) for name, members in groups.items()},
        notes=tuple(_notes(mechanism, skipped)),
    )


def _notes(mechanism: Mechanism, skipped: set[str]) -> Iterable[str]:
    for joint in mechanism.implicit_joints:
        if joint.name not in skipped:
            yield (
                f"{joint.second} is held by contacts or closures only: it got a passive free joint "
                "to the ground"
            )
    for joint in mechanism.joints:
        if joint.name in skipped:
            yield (
                f"free joint {joint.name} between ground and reference member is unactuated: "
                "it constrains nothing"
            )


def merges(mechanism: Mechanism, joint: Joint) -> bool:
    """Whether a joint makes its two bodies one: fixed, not a closure, not asked to be cut."""
    cuts = mechanism.reference.cuts if mechanism.reference else {}
    return joint.type == "fixed" and not joint.closure and joint.name not in cuts and joint.cut is None


def _clusters(mechanism: Mechanism) -> dict[str, str]:
    """Representative of the rigid group of every body."""
    parent = {name: name for name in (GROUND, *mechanism.body)}

    def root(name: str) -> str:
        while parent[name] != name:
            name = parent[name]
        return name

    for joint in mechanism.joints:
        if merges(mechanism, joint):
            one, two = root(joint.first), root(joint.second)
            keep, drop = (two, one) if two == GROUND else (one, two)
            parent[drop] = keep
    return {name: root(name) for name in parent}


def _is_coupled(mechanism: Mechanism, joint: Joint) -> bool:
    """Whether an axis of the joint carries a motor or is in a coupling or drive."""
    used = set(mechanism.active)
    for coupling in mechanism.couplings:
        used.update(coupling.axes)
    for drive in mechanism.drives:
        used.update(drive.drives)
    return bool(used.intersection(mechanism.type_of(joint).axis_names(joint.name)))


def _is_locked(mechanism: Mechanism, joint: Joint) -> bool:
    return bool(set(mechanism.lock).intersection(mechanism.type_of(joint).axis_names(joint.name)))


def _between_roots(
    mechanism: Mechanism, joint: Joint, cluster: dict[str, str], ground: str, member: str
) -> bool:
    if joint.type != "free" or {cluster[joint.first], cluster[joint.second]} != {ground, member}:
        return False
    return not _is_coupled(mechanism, joint) and not _is_locked(mechanism, joint)


class _Forest:
    """The spanning forest with its two roots: ordinary joints, then closures, then declared cuts."""

    def __init__(
        self, mechanism: Mechanism, joints: list[Joint], cluster: dict[str, str], ground: str, member: str
    ) -> None:
        cuts = mechanism.reference.cuts if mechanism.reference else {}
        self.cluster, self.member = cluster, member
        self.tree: set[str] = set()
        self.path: dict[str, Path] = {ground: (), member: ()}
        self.root: dict[str, str] = {ground: ground, member: member}
        usable = [j for j in joints if not (j.closure and j.cut == "contact")]
        ordinary = [j for j in usable if not j.closure and j.name not in cuts]
        closures = [j for j in usable if j.closure and j.name not in cuts]
        declared = [j for j in usable if j.name in cuts]
        stages = [ordinary, ordinary + closures, ordinary + closures + declared]
        for stage in stages:
            self._grow(ground, [j for j in stage if not self._at_member(j)])
        for stage in stages:
            self._grow(member, stage)
        lost = [b.name for b in mechanism.bodies if cluster[b.name] not in self.root]
        if lost:
            raise TopologyError(
                f"{', '.join(map(repr, lost))} hang from neither the ground nor the reference member"
            )

    def _at_member(self, joint: Joint) -> bool:
        return self.member in (self.cluster[joint.first], self.cluster[joint.second])

    def _grow(self, root: str, joints: list[Joint]) -> None:
        """Breadth first from everything that already hangs from `root`."""
        neighbours: dict[str, list[tuple[Joint, int, str]]] = {}
        for joint in joints:
            one, two = self.cluster[joint.first], self.cluster[joint.second]
            neighbours.setdefault(one, []).append((joint, 1, two))
            neighbours.setdefault(two, []).append((joint, -1, one))
        queue = [name for name, its_root in self.root.items() if its_root == root]
        for name in queue:
            for joint, sign, other in neighbours.get(name, ()):
                if other not in self.root:
                    self.root[other] = root
                    self.path[other] = (*self.path[name], (joint.name, sign))
                    self.tree.add(joint.name)
                    queue.append(other)


def _cut(mechanism: Mechanism, joint: Joint, forest: _Forest, member: str) -> CutJoint:
    asked = mechanism.reference.cuts.get(joint.name) if mechanism.reference else None
    kind = _cut_kind(mechanism, joint, asked)
    root_first = forest.root[forest.cluster[joint.first]]
    root_second = forest.root[forest.cluster[joint.second]]
    role: Literal["member cut", "loop cut"] = "loop cut" if root_first == root_second else "member cut"
    limb_first = role == "loop cut" or root_first != member
    return CutJoint(joint, kind, role, joint.first if limb_first else joint.second, 1 if limb_first else -1)


def _cut_kind(mechanism: Mechanism, joint: Joint, asked: Cut | None) -> Literal["kept", "contact"]:
    possible = not _is_coupled(mechanism, joint) and not _is_locked(mechanism, joint)
    if asked is None:
        return "contact" if joint.cut == "contact" and possible else "kept"
    if asked.kind == "contact":
        if not possible:
            raise TopologyError(
                f"joint {joint.name!r} cannot be cut as a contact: an axis of it is active, locked or "
                "coupled; use kind: kept"
            )
        if asked.at is not None and mechanism.type_of(joint).axes:
            raise TopologyError(
                f"joint {joint.name!r}: a joint cut as a contact is cut at its centre; leave `at` out"
            )
    return asked.kind


def _check_cuts(asked: Iterable[str], made: list[str], mechanism: Mechanism) -> None:
    for name in asked:
        if name not in made:
            raise TopologyError(
                f"joint {name!r} is not cut in this reduction, so `cuts` cannot say how; cut are: "
                + (", ".join(made) or "none")
            )
