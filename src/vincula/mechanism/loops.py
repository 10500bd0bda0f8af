"""The independent loops of a mechanism, as people list them: from body to body and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vincula.mechanism.parts import GROUND, ContactPart, Joint

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Step = tuple[str, str]
"""A joint or contact that was walked, and the body it leads to."""


@dataclass(frozen=True, slots=True)
class Loop:
    """One independent loop.

    Attributes:
        closed_by: The joint or contact that closes it: the one outside the spanning tree.
        bodies: Bodies in the order of the walk; the first is the one nearest to the ground, and the
            walk returns to it.
        parts: Joints and contacts, `parts[i]` leading from `bodies[i]` to the next.
    """

    closed_by: str
    bodies: tuple[str, ...]
    parts: tuple[str, ...]


def independent_loops(mechanism: Mechanism) -> tuple[Loop, ...]:
    """A fundamental set of loops: one for every joint or contact outside a spanning tree.

    Free joints constrain nothing and close no loop, so they are left out; joints come before
    closures and contacts in the tree, so that those are what closes a loop.
    """
    edges = _edges(mechanism)
    way = _spanning_ways([body.name for body in mechanism.bodies], edges)
    walked = {name for steps in way.values() for name, _ in steps}
    order = {edge.name: place for place, edge in enumerate(edges)}
    return tuple(
        _loop(edge, way[edge.first], way[edge.second], order) for edge in edges if edge.name not in walked
    )


def _edges(mechanism: Mechanism) -> list[Joint | ContactPart]:
    joints = [joint for joint in mechanism.joints if joint.type != "free"]
    return [
        *(joint for joint in joints if not joint.closure),
        *(joint for joint in joints if joint.closure),
        *mechanism.contacts,
    ]


def _spanning_ways(bodies: list[str], edges: list[Joint | ContactPart]) -> dict[str, tuple[Step, ...]]:
    """For every body the steps from the root of its component, beginning with the root itself."""
    way: dict[str, tuple[Step, ...]] = {}
    tree_joints: list[Joint | ContactPart] = [
        edge for edge in edges if isinstance(edge, Joint) and not edge.closure
    ]
    for root in [GROUND, *bodies]:
        if root in way:
            continue
        way[root] = (("", root),)
        reached = [root]
        for usable in (tree_joints, edges):
            _grow(way, reached, usable)
    return way


def _grow(way: dict[str, tuple[Step, ...]], reached: list[str], edges: list[Joint | ContactPart]) -> None:
    neighbours: dict[str, list[tuple[str, str]]] = {}
    for edge in edges:
        neighbours.setdefault(edge.first, []).append((edge.name, edge.second))
        neighbours.setdefault(edge.second, []).append((edge.name, edge.first))
    for body in reached:  # grows while it is walked: breadth first
        for name, other in neighbours.get(body, ()):
            if other not in way:
                way[other] = (*way[body], (name, other))
                reached.append(other)


def _loop(
    edge: Joint | ContactPart, first: tuple[Step, ...], second: tuple[Step, ...], order: Mapping[str, int]
) -> Loop:
    """The loop that an edge closes, walked so that the part declared earlier comes first."""
    common = 0
    for one, two in zip(first, second, strict=False):
        if one != two:
            break
        common += 1
    out, back = first[common:], second[common:]
    root = first[common - 1][1]
    bodies = (root, *(body for _, body in out), *(body for _, body in reversed(back)))
    parts = (*(name for name, _ in out), edge.name, *(name for name, _ in reversed(back)))
    if order[parts[0]] > order[parts[-1]]:
        bodies, parts = (root, *reversed(bodies[1:])), parts[::-1]
    return Loop(edge.name, bodies, parts)
