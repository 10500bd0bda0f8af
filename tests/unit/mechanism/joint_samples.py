"""Random joints of every type, and finite-difference twists to hold formulas against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from vincula.arrays import Matrix, Vector
from vincula.mechanism.joint_types import JointType, joint_type, motion
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL, Space

SPATIAL_TYPES = (
    "revolute", "prismatic", "screw", "cylindrical", "universal", "spherical", "planar", "fixed", "free",
)  # fmt: skip
PLANAR_TYPES = ("revolute", "prismatic", "fixed", "free")
ALL_TYPES = [(SPATIAL, name) for name in SPATIAL_TYPES] + [(PLANAR, name) for name in PLANAR_TYPES]
IDS = [f"{space.name}-{name}" for space, name in ALL_TYPES]


@dataclass(frozen=True)
class Sample:
    """A joint at random values, its frame A at a random place."""

    kind: JointType
    first: Pose
    values: Vector
    lead: float
    second_axis: Vector

    @property
    def second(self) -> Pose:
        return self.first @ self.motion(self.values)

    def motion(self, values: Vector) -> Pose:
        return motion(self.kind, values, self.lead, self.second_axis)


def random_pose(rng: np.random.Generator, space: Space) -> Pose:
    if space is PLANAR:
        return Pose.from_angle(float(rng.uniform(-3, 3)), rng.normal(size=2))
    return Pose.at(rng.normal(size=3), Rotation.random(random_state=rng).as_matrix())


def sample(rng: np.random.Generator, space: Space, name: str) -> Sample:
    """Random frame and values; angles inside (-pi, pi), second axes well apart from the first."""
    kind = joint_type(name, space)
    values = rng.uniform(-2.5, 2.5, kind.values)
    if not kind.scalar_values:
        values[-4:] /= np.linalg.norm(values[-4:])
        values[-4:] *= np.sign(values[-4]) or 1.0
    angle = rng.uniform(0.4, np.pi - 0.4)
    axis = np.array([np.sin(angle), 0.0, np.cos(angle)])
    return Sample(kind, random_pose(rng, space), values, float(rng.uniform(0.1, 0.6)), axis)


def moved_values(kind: JointType, values: Vector, rates: Vector, time: float) -> Vector:
    """Values after a time at constant rates; a ball's rates are angular velocities in frame B."""
    result = values.copy()
    value = rate = 0
    for step in kind.steps:
        if step == "S":
            turn = Rotation.from_rotvec(time * rates[rate : rate + 3])
            w, x, y, z = values[value : value + 4]
            x, y, z, w = (Rotation.from_quat([x, y, z, w]) * turn).as_quat()
            result[value : value + 4] = [w, x, y, z]
            value, rate = value + 4, rate + 3
        else:
            result[value] += time * rates[rate]
            value, rate = value + 1, rate + 1
    return result


def twist_between(before: Pose, after: Pose, at: Pose, point: Vector, time: float) -> Vector:
    """Twist at `point` of a frame that goes from one pose to another in `time`, being at `at` midway."""
    linear = (after.position - before.position) / time
    turned = after.rotation @ before.rotation.T
    if len(point) == 2:
        omega = np.array([np.arctan2(turned[1, 0], turned[0, 0])]) / time
        arm = point - at.position
        return np.concatenate([linear + omega[0] * np.array([-arm[1], arm[0]]), omega])
    omega = Rotation.from_matrix(turned).as_rotvec() / time
    return np.concatenate([linear + np.cross(omega, point - at.position), omega])


def differenced_twists(joint: Sample, point: Vector, step: float = 1e-5) -> Matrix:
    """d x axes twists of frame B against frame A by central differences of the motion."""
    columns = []
    for k in range(len(joint.kind.axes)):
        rates = np.eye(len(joint.kind.axes))[k]
        before, after = (
            joint.first @ joint.motion(moved_values(joint.kind, joint.values, rates, sign * step))
            for sign in (-1, 1)
        )
        columns.append(twist_between(before, after, joint.second, point, 2 * step))
    d = 3 if joint.kind.planar else 6
    return np.column_stack(columns) if columns else np.zeros((d, 0))
