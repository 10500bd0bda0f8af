"""Motions, axes and gaps of joints at many states at once: `joint_types` and `closure_rows`, stacked.

A stack of frames is a pair of rotations (n x s x s) and positions (n x s).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_rows import Selection
from vincula.mechanism.joint_types import JointType, Screw
from vincula.spatial.poses import Pose
from vincula.spatial.twists import cross_rows

Stack = NDArray[np.float64]
"""Numbers with the states along the first dimension."""
Frames = tuple[Stack, Stack]
"""Rotations and positions of one frame at many states."""
HALF_TURN: Final = math.pi
"""Stands for an orientation gap beyond -0.9 in its cosine: far from closed, whatever its axis."""
_CONJUGATE: Final = np.array([1.0, -1.0, -1.0, -1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Fixed:
    """A constant pose; None for a rotation or a displacement that changes nothing."""

    rotation: Matrix | None
    position: Vector | None

    @staticmethod
    def of(pose: Pose) -> Fixed:
        """The parts of a pose that are not exactly nothing."""
        idle = np.array_equal(pose.rotation, np.eye(len(pose.position)))
        return Fixed(None if idle else pose.rotation, pose.position if pose.position.any() else None)


def placed(frames: Frames, inner: Fixed) -> Frames:
    """The frames after one constant pose."""
    rotation, position = frames
    if inner.position is not None:
        position = rotation @ inner.position + position
    return rotation if inner.rotation is None else rotation @ inner.rotation, position


def moved_by(
    frames: Frames, kind: JointType, values: Stack, lead: float, second_axis: Vector, forward: bool
) -> Frames:
    """Frame B from frame A at n x values of a joint, or A from B; see `joint_types.motion`."""
    rotation, position = frames
    index, way = (0, 1.0) if forward else (values.shape[1], -1.0)
    for step in kind.steps if forward else kind.steps[::-1]:
        size = 4 if step == "S" else 1
        part = values[:, index : index + size] if forward else values[:, index - size : index]
        index += size if forward else -size
        if step == "S":
            rotation = rotation @ _from_quaternions(part if forward else part * _CONJUGATE)
            continue
        value = way * part[:, 0]
        if step[0] == "T":
            position = position + rotation[:, :, "xyz".index(step[1])] * value[:, None]
            continue
        if step == "H":
            position = position + rotation[:, :, 2] * (lead / (2 * math.pi) * value[:, None])
        rotation = rotation @ _about(second_axis, value) if step == "R2" else _turned_about_z(rotation, value)
    return rotation, position


def twists_of_axes(screws: Sequence[Screw], first: Frames, second: Frames, point: Vector) -> Stack:
    """n x d x axes twists at `point` of the second body relative to the first; see `axis_twists`."""
    arm = point - second[1]
    count, s = arm.shape
    twists = np.zeros((count, 3 if s == 2 else 6, len(screws)))
    for k, screw in enumerate(screws):
        axis = (second if screw.on_second else first)[0] @ screw.axis
        if s == 2:
            twists[:, 0, k] = screw.slide * axis[:, 0] - screw.turn * arm[:, 1]
            twists[:, 1, k] = screw.slide * axis[:, 1] + screw.turn * arm[:, 0]
            twists[:, 2, k] = screw.turn
        else:
            twists[:, :3, k] = screw.slide * axis + screw.turn * cross_rows(axis, arm)
            twists[:, 3:, k] = screw.turn * axis
    return twists


def moment_arms(offsets: Stack) -> Stack:
    """n x s x turns matrices B with B @ omega = omega x offset."""
    if offsets.shape[1] == 2:
        return np.stack([-offsets[:, 1], offsets[:, 0]], axis=1)[:, :, None]
    return -_crossing(offsets)


def gaps_of(selection: Selection, first: Frames, second: Frames) -> Stack:
    """n x rows gaps between frames A and B [m, rad]."""
    far = len(selection.linear)
    gaps = np.empty((len(first[1]), selection.count))
    back = first[0].swapaxes(1, 2)
    if far:
        gaps[:, :far] = (back @ (second[1] - first[1])[..., None])[:, list(selection.linear), 0]
    if selection.angular:
        gaps[:, far:] = _errors(selection, back @ second[0])[:, list(selection.angular)]
    return gaps


def rows_of(selection: Selection, first: Frames, second: Frames) -> Stack:
    """n x rows x d derivatives of the gaps by the twist of B relative to A at the origin of B."""
    s = selection.translations
    back = first[0].swapaxes(1, 2)
    far = len(selection.linear)
    rows = np.zeros((len(back), selection.count, s + (1 if s == 2 else 3)))
    if far:
        rows[:, :far, :s] = back[:, list(selection.linear)]
    if selection.angular:
        angular = list(selection.angular)
        if s == 2:
            rows[:, far:, s:] = 1.0
        else:
            rows[:, far:, s:] = _rates(selection, back @ second[0])[:, angular] @ back
    return rows


def quaternions(turns: Stack) -> Stack:
    """Unit quaternions w x y z of n x 3 rotation vectors."""
    angle = np.linalg.norm(turns, axis=1)
    # sin(a / 2) / a, which numpy knows as sinc, is right at zero too.
    factor = 0.5 * np.sinc(0.5 * angle / math.pi)
    return np.column_stack([np.cos(0.5 * angle), factor[:, None] * turns])


def products(one: Stack, two: Stack) -> Stack:
    """Products of quaternions, brought to length one."""
    a, v = one[:, :1], one[:, 1:]
    b, w = two[:, :1], two[:, 1:]
    real = a * b - np.sum(v * w, axis=1, keepdims=True)
    product = np.concatenate([real, a * w + b * v + cross_rows(v, w)], axis=1)
    return np.asarray(product / np.linalg.norm(product, axis=1, keepdims=True))


def logarithms(turns: Stack) -> Stack:
    """Rotation vectors of unit quaternions, at most half a turn."""
    turns = np.where(turns[:, :1] < 0.0, -turns, turns)
    sine = np.linalg.norm(turns[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, turns[:, 0])
    factor = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0.0)
    return np.asarray(turns[:, 1:] * factor[:, None])


def _turned_about_z(rotation: Stack, angle: Vector) -> Stack:
    """Rotations turned about their own z, in the plane and in space."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = rotation[:, :, 0], rotation[:, :, 1]
    result = rotation.copy()
    result[:, :, 0] = c * x + s * y
    result[:, :, 1] = c * y - s * x
    return result


def _about(axis: Vector, angle: Vector) -> Stack:
    """Rotations by angles about one constant axis: I + sin X + (1 - cos) X^2."""
    cross = _crossing(axis[None, :])
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    return np.eye(3) + sine * cross + rest * (cross @ cross)


def _from_quaternions(quaternions: Stack) -> Stack:
    """Rotations of quaternions w x y z: I + 2 w V + 2 V^2 over the squared length."""
    cross = _crossing(quaternions[:, 1:])
    factor = (2.0 / np.sum(quaternions * quaternions, axis=1))[:, None, None]
    return np.asarray(np.eye(3) + factor * (quaternions[:, :1, None] * cross + cross @ cross))


def _crossing(vectors: Stack) -> Stack:
    """n x 3 x 3 matrices X with X @ b = a x b."""
    result = np.zeros((len(vectors), 3, 3))
    x, y, z = vectors.T
    result[:, 0, 1], result[:, 0, 2], result[:, 1, 2] = -z, y, -x
    result[:, 1, 0], result[:, 2, 0], result[:, 2, 1] = z, -y, x
    return result


def _errors(selection: Selection, relative: Stack) -> Stack:
    """Orientation errors of relative rotations; see `closure_rows`."""
    if selection.translations == 2:
        return np.arctan2(relative[:, 1, 0], relative[:, 0, 0])[:, None]
    if selection.turning == "tilt":
        axis = relative[:, :, 2]
        sine = np.hypot(axis[:, 0], axis[:, 1])
        angle = np.arctan2(sine, axis[:, 2])
        scale = np.divide(angle, sine, out=np.ones_like(sine), where=sine > 0.0)
        scale = np.where((sine == 0.0) & (angle > 1.0), HALF_TURN, scale)
        along = np.stack([-axis[:, 1], axis[:, 0]], axis=1) * scale[:, None]
        along[sine == 0.0, 0] = angle[sine == 0.0]
        return along
    if selection.turning == "between axes":
        drawn = selection.second_axis
        axis = relative @ drawn
        angle = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])
        return (angle - math.atan2(math.hypot(drawn[0], drawn[1]), drawn[2]))[:, None]
    return _rotation_vectors(relative)


def _rotation_vectors(relative: Stack) -> Stack:
    skew = 0.5 * (relative - relative.swapaxes(1, 2))
    vector = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    cosine = 0.5 * (np.trace(relative, axis1=1, axis2=2) - 1.0)
    sine = np.linalg.norm(vector, axis=1)
    factor = np.divide(np.arctan2(sine, cosine), sine, out=np.ones_like(sine), where=sine > 0.0)
    vector = np.asarray(vector * factor[:, None])
    vector[cosine <= -0.9] = HALF_TURN
    return vector


def _rates(selection: Selection, relative: Stack) -> Stack:
    """Rates of the orientation errors for an angular velocity in A's axes, n x errors x 3."""
    count = len(relative)
    if selection.turning == "tilt":
        return _tilt_rates(relative[:, :, 2])
    if selection.turning == "between axes":
        axis = relative @ selection.second_axis
        across = np.stack([-axis[:, 1], axis[:, 0], np.zeros(count)], axis=1)
        size = np.hypot(axis[:, 0], axis[:, 1])
        across[size == 0.0] = (1.0, 0.0, 0.0)
        return (across / np.where(size == 0.0, 1.0, size)[:, None])[:, None, :]
    error = _rotation_vectors(relative)
    angle = np.linalg.norm(error, axis=1)
    half = 0.5 * np.where(angle < 1e-4, 1.0, angle)
    factor = np.where(angle < 1e-4, 1.0 / 12.0, (1.0 - half / np.tan(half)) / (4.0 * half * half))
    cross = _crossing(error)
    return np.asarray(np.eye(3) - 0.5 * cross + factor[:, None, None] * (cross @ cross))


def _tilt_rates(axis: Stack) -> Stack:
    sine = np.hypot(axis[:, 0], axis[:, 1])
    angle = np.arctan2(sine, axis[:, 2])
    safe = np.where(sine == 0.0, 1.0, sine)
    turn = np.stack([-axis[:, 1], axis[:, 0], np.zeros(len(axis))], axis=1) / safe[:, None]
    beside = np.stack([-turn[:, 1], turn[:, 0]], axis=1) * (angle / safe)[:, None]
    rates = turn[:, :2, None] * turn[:, None, :] + beside[:, :, None] * cross_rows(axis, turn)[:, None, :]
    rates[sine == 0.0] = np.eye(3)[:2]
    return rates
