"""Assembly modes: all ways to put a mechanism together at given motor positions, from many starts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ClosureError, ModelError, listing
from vincula.mechanism.closed import ClosedConfiguration
from vincula.mechanism.closure import close
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import MotorValues
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.parts import ContactPart, Joint
from vincula.mechanism.residuals import axis_values
from vincula.numerics.rank import negligible

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

SAME: Final = 1e-6
"""Configurations whose joint points agree to this times L are one assembly mode."""
NUDGE: Final = 1e-4
"""Size of the displacements by which free motions are looked at [rad, or lengths L]."""


def assembly_modes(
    mechanism: Mechanism,
    motors: MotorValues | None = None,
    *,
    starts: int = 100,
    seed: int = 0,
    limits: bool = False,
) -> tuple[ClosedConfiguration, ...]:
    """All assembly modes found from random starts; see `Mechanism.assembly_modes`."""
    held = motors if motors is not None else motors_at(mechanism, mechanism.home)
    rng = np.random.default_rng(seed)
    found: list[tuple[Vector, ClosedConfiguration]] = []
    for k in range(starts):
        near = mechanism.home if k == 0 else _anywhere(mechanism, rng)
        try:
            q = close(mechanism, near, motors=held, limits=limits, attempts=1)
        except ClosureError:
            continue
        points = joint_points(mechanism, q)
        if any(np.abs(points - other).max(initial=0.0) < SAME * mechanism.length for other, _ in found):
            continue
        _refuse_continuum(mechanism, q)
        found.append((points, q))
    return tuple(q for _, q in found)


def joint_points(mechanism: Mechanism, q: Configuration) -> Vector:
    """Positions of all joint and contact points and of the reference point, ground axes [m].

    A leg that spins about the line through its two balls leaves them where they are, so spinning
    legs do not multiply the modes.
    """
    poses = mechanism.body_poses(q)
    parts: tuple[Joint | ContactPart, ...] = (*mechanism.joints, *mechanism.contacts)
    points = [part_frames(part, poses)[0].position for part in parts if part.type != "free"]
    if mechanism.reference is not None:
        points.append(poses[mechanism.reference.body].apply(mechanism.reference.origin))
    return np.concatenate(points) if points else np.zeros(0)


def motors_at(
    mechanism: Mechanism, q: Configuration, names: Iterable[str] | None = None
) -> dict[str, float | Vector]:
    """Where axes and motors over several axes stand at a configuration [rad, m].

    An axis of a ball has no value of its own: its whole joint is given.

    Args:
        mechanism: The mechanism.
        q: The configuration.
        names: Axes and drives; the active ones by default.
    """
    values = axis_values(mechanism, q)
    held: dict[str, float | Vector] = {}
    drives = {drive.name: drive for drive in mechanism.drives}
    for name in mechanism.active if names is None else names:
        if name in drives:
            held[name] = sum(c * values[axis] for axis, c in drives[name].drives.items())
        elif name in values:
            held[name] = values[name]
        elif name.rpartition(".")[0] in q:
            joint = name.rpartition(".")[0]
            held[joint] = q[joint]
    return held


def _anywhere(mechanism: Mechanism, rng: np.random.Generator) -> Configuration:
    """Random angles and orientations; lengths near home."""
    values: dict[str, Vector] = {}
    for joint in mechanism.all_joints:
        if joint.closure:
            continue
        value = np.array(joint.home, dtype=float)
        index = 0
        for step in mechanism.type_of(joint).steps:
            if step == "S":
                value[index : index + 4] = rng.normal(size=4)
                index += 4
                continue
            far = mechanism.length if step[0] == "T" else np.pi
            value[index] += rng.uniform(-far, far)
            index += 1
        values[joint.name] = value
    return mechanism.configuration(values)


def _refuse_continuum(mechanism: Mechanism, q: ClosedConfiguration) -> None:
    """Assembly modes are single configurations.

    Raises:
        ModelError: What is held leaves a motion of the joint points, so there is a continuum.
    """
    for displaced in q.nudged(NUDGE):
        far = float(np.abs(joint_points(mechanism, displaced) - joint_points(mechanism, q)).max(initial=0.0))
        if not negligible(far, mechanism.length * NUDGE, 10.0 * NUDGE):
            raise ModelError(
                f"holding {listing(q.held)} leaves {q.free_motions} motion"
                f"{'s' if q.free_motions > 1 else ''} free, so the closed configurations are a continuum "
                "without separate assembly modes: hold as many motors as the mechanism has freedoms"
            )
