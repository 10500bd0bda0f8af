"""Constraint models of Pinocchio as loop joints of the mechanism graph."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final

from vincula.adapters.pinocchio_joints import pose_of
from vincula.errors import UnsupportedFeatureError
from vincula.mechanism.parts import Joint

_KINDS: Final = {
    "CONTACT_3D": "spherical",
    "CONTACT_6D": "fixed",
    "PointAnchorConstraintModel": "spherical",
    "FrameAnchorConstraintModel": "fixed",
}
"""What stands for a constraint: three rows hold a point, six a frame."""


def loops(constraints: Iterable[Any], bodies: Sequence[str], taken: Iterable[str]) -> list[Joint]:
    """A loop joint for every constraint; it stands for its rows only, as in Pinocchio.

    Args:
        constraints: Constraint models: rigid ones of type 3D or 6D, point or frame anchors.
        bodies: Name of the body of every joint index.
        taken: Names of the joints.

    Raises:
        UnsupportedFeatureError: Another kind of constraint (contact, friction, limit).
    """
    names = set(taken)
    found: list[Joint] = []
    for index, given in enumerate(constraints):
        constraint = given.extract() if hasattr(given, "extract") else given
        kind = _kind(constraint)
        if kind not in _KINDS:
            raise UnsupportedFeatureError(
                f"constraint {index} is a {kind}: supported are rigid constraints of type CONTACT_3D or "
                "CONTACT_6D, and point or frame anchors"
            )
        first, second = bodies[int(constraint.joint1_id)], bodies[int(constraint.joint2_id)]
        name = str(constraint.name) or f"loop:{first}-{second}"
        while name in names:
            name += "_"
        names.add(name)
        found.append(
            Joint(
                name,
                _KINDS[kind],
                first,
                second,
                pose_of(constraint.joint1_placement),
                pose_of(constraint.joint2_placement),
                closure=True,
                cut="contact",
            )
        )
    return found


def _kind(constraint: Any) -> str:
    """The type of a rigid constraint, the class of any other."""
    kind = getattr(constraint, "type", None)
    return type(constraint).__name__ if kind is None else str(kind)
