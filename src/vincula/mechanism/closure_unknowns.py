"""What becomes an unknown of closure besides the kinematic tree: coupled joints, the member's pose."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from vincula.errors import MissingReferenceError
from vincula.mechanism.parts import GROUND, Coupling, Drive, Joint
from vincula.mechanism.residuals import axis_values
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

MEMBER: Final = "(pose of the reference member)"
"""Name of the unknown that stands for the pose of the reference member."""


def scalar_couplings(mechanism: Mechanism) -> list[Coupling]:
    """Couplings between axes that have scalar values; others constrain rates only."""
    scalar = axis_values(mechanism, mechanism.home)
    return [c for c in mechanism.couplings if all(axis in scalar for axis in c.axes)]


def joints_of_axes(mechanism: Mechanism, couplings: Iterable[Coupling], drives: Iterable[Drive]) -> set[str]:
    """Joints with an axis in a coupling or drive."""
    joint_of = {
        axis: joint.name
        for joint in mechanism.all_joints
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    }
    axes = [axis for c in couplings for axis in c.axes] + [axis for d in drives for axis in d.drives]
    return {joint_of[axis] for axis in axes}


def member_joint(mechanism: Mechanism) -> Joint:
    """A free joint from the ground to the reference point: its values are the member's pose.

    Raises:
        MissingReferenceError: No reference member is named.
    """
    reference = mechanism.reference
    if reference is None:
        raise MissingReferenceError(body.name for body in mechanism.bodies)
    identity = Pose.identity(mechanism.space.translations)
    return Joint(MEMBER, "free", GROUND, reference.body, identity, Pose.at(reference.origin))
