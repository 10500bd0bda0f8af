"""Roll, pitch and yaw of many orientations at once: turns about the fixed x, y and z axes, in this order."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Matrix, Vector


def from_roll_pitch_yaw(roll: Vector, pitch: Vector, yaw: Vector) -> Matrix:
    """Unit quaternions (w, x, y, z) of R = Rz(yaw) Ry(pitch) Rx(roll), one row an orientation.

    Args:
        roll: Turns about x [rad].
        pitch: Turns about y [rad].
        yaw: Turns about z [rad].
    """
    cr, sr = np.cos(0.5 * roll), np.sin(0.5 * roll)
    cp, sp = np.cos(0.5 * pitch), np.sin(0.5 * pitch)
    cy, sy = np.cos(0.5 * yaw), np.sin(0.5 * yaw)
    return np.stack(
        [
            cy * cp * cr + sy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
        ],
        axis=-1,
    )


def roll_pitch_yaw(quaternion: Vector) -> Vector:
    """Roll, pitch and yaw [rad] of a unit quaternion (w, x, y, z); roll 0 where pitch is a right angle."""
    w, x, y, z = (float(value) for value in quaternion)
    sine = min(1.0, max(-1.0, 2.0 * (w * y - x * z)))
    if abs(sine) > 1.0 - 1e-14:
        turn = 2.0 * np.arctan2(z, w) if sine < 0.0 else -2.0 * np.arctan2(-z, w)
        return np.array([0.0, np.copysign(0.5 * np.pi, sine), turn])
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.array([roll, np.arcsin(sine), yaw])
