"""What every writer of robot files gives: a text, what it could not hold, and how numbers look in it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import UnsupportedFeatureError, listing
from vincula.files.names import name_problem
from vincula.files.problems import shown
from vincula.mechanism.parts import GROUND
from vincula.mechanism.spatial_twin import spatial_twin
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

MISFIT: Final = 1e-9
"""A loop is drawn closed when it is closed up to this times the characteristic length."""


@dataclass
class Written:
    """A mechanism as the text of a robot file.

    Attributes:
        text: The file.
        lost: What the format cannot hold.
        changed: What is held in another form, or has to be said with every command.
        beside: Texts of side files, by what their name ends in after the stem (`.yaml`).
        format: The format, for messages.
    """

    text: str
    lost: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)
    beside: Mapping[str, str] = field(default_factory=dict)
    format: str = "file of this format"

    def refuse_losses(self) -> None:
        """Refuse to go on if something is lost.

        Raises:
            UnsupportedFeatureError: The list of what the format cannot hold.
        """
        if self.lost:
            raise UnsupportedFeatureError(
                f"{self.format} cannot hold everything here:\n" + "\n".join(self.lost), self.lost
            )


def in_space(mechanism: Mechanism) -> tuple[Mechanism, list[str]]:
    """A mechanism for a format that is spatial, and what that loses of a planar one."""
    if mechanism.space is not PLANAR:
        return mechanism, []
    plane = (
        "the plane: joints of its twin in space also hold it against motions out of the plane, and loops "
        "carry forces that the drawing does not have"
    )
    lost = [plane]
    lost += [
        f"contact {contact.name!r}: the format has no contacts between bodies"
        for contact in mechanism.contacts
    ]
    return spatial_twin(mechanism), lost


def number(value: float) -> str:
    """A number that reads back to the same double; no negative zero."""
    return repr(float(value) + 0.0)


def numbers(vector: Iterable[float]) -> str:
    """Numbers that read back to the same doubles."""
    return " ".join(map(number, vector))


def roll_pitch_yaw(pose: Pose) -> Vector:
    """Angles r, p, y with R = Rz(y) Ry(p) Rx(r) [rad], exact to rounding also where pitch is 90 degrees.

    Yaw is arbitrary there; the roll that belongs to it is read from what is left of the rotation.
    """
    rotation = pose.rotation
    pitch = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    across = -math.sin(yaw) * rotation[0] + math.cos(yaw) * rotation[1]
    return np.array([math.atan2(-across[2], across[1]), pitch, yaw])


def bad_names(mechanism: Mechanism, reserved: Iterable[str] = ()) -> list[str]:
    """Names that a robot file should not or cannot hold, one sentence a name."""
    parts = (mechanism.bodies, mechanism.joints, mechanism.frames, mechanism.couplings, mechanism.drives)
    names = [
        mechanism.name,
        *mechanism.motors,
        *mechanism.keyframes,
        *(p.name for part in parts for p in part),
    ]
    found = []
    for name in dict.fromkeys(names):
        expected = name_problem(name)
        if expected:
            found.append(f"the name {shown(name)}: expected {expected}")
    found += [
        f"the body name {shown(b.name)} means the ground there"
        for b in mechanism.bodies
        if b.name in reserved
    ]
    return found


def free_name(wanted: str, taken: set[str]) -> str:
    """A name that is not taken: the one wanted, or that with underscores; it is taken then."""
    while wanted in taken:
        wanted += "_"
    taken.add(wanted)
    return wanted


def reference_frame(mechanism: Mechanism, taken: set[str]) -> tuple[str, str, Pose] | None:
    """Name, body and pose of a frame at the reference point; None without a reference member."""
    reference = mechanism.reference
    if reference is None:
        return None
    same = [
        frame.name
        for frame in mechanism.frames
        if frame.body == reference.body and np.array_equal(frame.pose.position, reference.origin)
    ]
    pose = Pose.at(reference.origin)
    return (same[0] if same else free_name("reference", taken)), reference.body, pose


def said_with_commands(mechanism: Mechanism, point: str = "") -> list[str]:
    """What no robot file holds and every command has to be told, one sentence a thing.

    Args:
        mechanism: The mechanism.
        point: Name of the frame at the reference point.
    """
    found = []
    reference = mechanism.reference
    if reference is not None:
        where = f"{reference.body}@{point}" if point else reference.body
        axes = " --axes body" if reference.axes == "body" and reference.body != GROUND else ""
        found.append(f"the reference member is not in the file: say --reference {where}{axes}")
    if mechanism.weights is not None:
        found.append("the weights are not in the file")
    if any(limit.rate is not None for joint in mechanism.joints for limit in joint.limits):
        found.append("limits of speed are not in the file")
    return found


def open_parts(mechanism: Mechanism) -> list[str]:
    """Loops that are open at the home configuration, one sentence a loop."""
    tight = MISFIT * mechanism.length
    return [
        f"{residual} at the home configuration: it has no one place to be drawn at"
        for residual in mechanism.residuals()
        if residual.gap > tight and residual.kind == "loop"
    ]


def lost_locks(mechanism: Mechanism) -> list[str]:
    """The locks, which no robot file knows."""
    return [f"locks: {listing(mechanism.lock)}"] if mechanism.lock else []
