"""A plain Newton iteration that closes loops to a chosen tolerance, for the rank table.

It is deliberately not the library's own closure: it works on finite differences of the gaps and
stops as soon as the residual is below the tolerance, as a user's own script would.
"""

from __future__ import annotations

import numpy as np

from vincula.mechanism.blocked import blocked_directions
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.poses import rotation_vector
from vincula.spatial.selectors import contact_components


class LoopProblem:
    """Unknowns: values of the passive tree joints.  Residuals: gaps of loops and contacts."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.tree = [joint for joint, _ in mechanism.tree]
        held = {axis.split(".")[0] for axis in mechanism.active}
        self.free = [j for j in self.tree if j.name not in held]
        self.loops = [j for j in mechanism.all_joints if j not in self.tree]
        self.size = sum(len(mechanism.type_of(j).axes) for j in self.free)
        self.scale = mechanism.length

    def moved(self, q: dict[str, np.ndarray], step: np.ndarray) -> dict[str, np.ndarray]:
        """Values after a step; translations in units of the characteristic length."""
        result, index = dict(q), 0
        for joint in self.free:
            kind = self.mechanism.type_of(joint)
            part = step[index : index + len(kind.axes)] * np.where(kind.linear, self.scale, 1.0)
            index += len(kind.axes)
            old = q[joint.name]
            if kind.scalar_values:
                result[joint.name] = old + part
                continue
            turn, shift = part[-3:], part[:-3]
            half = np.concatenate([[1.0], 0.5 * turn])
            new = product(old[-4:], half / np.linalg.norm(half))
            result[joint.name] = np.concatenate([old[:-4] + shift, new])
        return result

    def residual(self, q: dict[str, np.ndarray]) -> np.ndarray:
        """Gaps, lengths in units of the characteristic length."""
        poses = self.mechanism.body_poses(Configuration(q))
        gaps: list[float] = []
        for joint in self.loops:
            first, second = part_frames(joint, poses)
            kind = self.mechanism.type_of(joint)
            blocked = blocked_directions(kind, first, second, joint.lead, joint.second_axis)
            gaps.extend(
                g / self.scale if lin else g for g, lin in zip(blocked.gaps, blocked.linear, strict=True)
            )
        for contact in self.mechanism.contacts:
            first, second = part_frames(contact, poses)
            offset = first.rotation.T @ (second.position - first.position) / self.scale
            turn = rotation_vector(first.rotation.T @ second.rotation)
            both = np.concatenate([offset, turn])
            gaps.extend(both[list(contact_components(contact.type, self.mechanism.space))])
        return np.array(gaps)

    def jacobian(self, q: dict[str, np.ndarray]) -> np.ndarray:
        """Central differences."""
        columns = []
        for k in range(self.size):
            step = np.zeros(self.size)
            step[k] = 1e-6
            columns.append((self.residual(self.moved(q, step)) - self.residual(self.moved(q, -step))) / 2e-6)
        return np.array(columns).T

    def consistent(self, q: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The same, with the values of the joints outside the tree read off."""
        from vincula.mechanism.joint_types import values_between

        poses = self.mechanism.body_poses(Configuration(q))
        result = dict(q)
        for joint in self.loops:
            first, second = part_frames(joint, poses)
            result[joint.name] = values_between(
                self.mechanism.type_of(joint), first, second, joint.second_axis
            )
        return result


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quaternion product (w, x, y, z)."""
    w, v = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[w], v])


def close_by_newton(mechanism: Mechanism, rng: np.random.Generator, tolerance: float) -> Configuration | None:
    """A configuration closed to `tolerance` [m], from a random start near home; None if none is found."""
    problem = LoopProblem(mechanism)
    q = {name: np.array(value) for name, value in mechanism.home.items()}
    q = problem.moved(q, rng.normal(0.0, 0.03, problem.size))
    for _ in range(60):
        residual = problem.residual(q)
        if np.linalg.norm(residual) * problem.scale < tolerance:
            closed = Configuration(problem.consistent(q))
            worst = max((r.gap for r in mechanism.residuals(closed)), default=0.0)
            return closed if worst <= 1e-8 * mechanism.length else None
        step = np.linalg.lstsq(problem.jacobian(q), -residual, rcond=3e-8)[0]
        size = np.linalg.norm(step)
        q = problem.moved(q, step * min(1.0, 0.3 / size) if size > 0 else step)
    return None
