"""The closure equations at many states at once: the rows of `ClosureProblem`, stacked.

numpy spends more on a call than on a small matrix, and a map closes thousands of states that are alike.
The equations are those of the problem, in its order and units; only the loop over states is inside.
"""

from __future__ import annotations

import numpy as np

from vincula.maps.stacked_rows import (
    Fixed,
    Frames,
    Stack,
    gaps_of,
    logarithms,
    moment_arms,
    moved_by,
    placed,
    products,
    quaternions,
    rows_of,
    twists_of_axes,
)
from vincula.mechanism.closure_problem import Block, ClosureProblem
from vincula.mechanism.closure_values import unwound
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import JointType, screws, values_between
from vincula.mechanism.parts import GROUND, Joint
from vincula.spatial.poses import Pose


class StackedProblem:
    """Closure equations over n states.

    Args:
        problem: The equations.
    """

    def __init__(self, problem: ClosureProblem) -> None:
        self.problem = problem
        self.mechanism = problem.mechanism
        where = problem.variables
        self._kinds = {joint.name: (kind, values) for joint, kind, values in where.joints}
        self._screws = {
            joint.name: screws(kind, joint.lead, joint.second_axis)
            for joint, kind, _ in where.joints
            if kind.axes
        }
        in_tree = [joint for joint, _, _ in problem.steps]
        parts = [*in_tree, *where.joint.values(), *(block.part for block in problem.blocks)]
        self._first = {part.name: Fixed.of(part.frame_on_first) for part in parts}
        self._second = {part.name: Fixed.of(part.frame_on_second) for part in parts}
        self._beyond = [(joint, forward, Fixed.of(beyond)) for joint, forward, beyond in problem.steps]

    def moved(self, states: Stack, steps: Stack) -> Stack:
        """States after steps in scaled rates, both with n rows."""
        where = self.problem.variables
        scaled = steps * where.column_scale
        result = states.copy()
        values, columns = where.scalar_places
        result[:, values] += scaled[:, columns]
        for value, column in where.ball_places:
            turn = quaternions(scaled[:, column : column + 3])
            result[:, value : value + 4] = products(states[:, value : value + 4], turn)
        return result

    def steps_between(self, states: Stack, others: Stack) -> Stack:
        """Steps from states to others; balls by the shorter way."""
        where = self.problem.variables
        steps = np.zeros((len(states), where.columns))
        values, columns = where.scalar_places
        steps[:, columns] = others[:, values] - states[:, values]
        for value, column in where.ball_places:
            back = states[:, value : value + 4] * np.array([1.0, -1.0, -1.0, -1.0])
            steps[:, column : column + 3] = logarithms(products(back, others[:, value : value + 4]))
        return steps / where.column_scale

    def scalar_values(self, states: Stack) -> Stack:
        """n x rates values; zero for rates of balls."""
        values, columns = self.problem.variables.scalar_places
        found = np.zeros((len(states), self.problem.columns))
        found[:, columns] = states[:, values]
        return found

    def gaps(self, states: Stack) -> Stack:
        """n x rows scaled residuals."""
        poses, frames = self._poses(states)
        gaps = np.zeros((len(states), self.problem.rows))
        for block in self.problem.blocks:
            gaps[:, block.rows] = gaps_of(block.selection, *self._ends(block, poses, frames))
        self._scalar_gaps(states, gaps)
        return gaps * self.problem.row_scale

    def equations(self, states: Stack) -> tuple[Stack, Stack]:
        """n x rows scaled residuals and their n x rows x columns Jacobians."""
        problem, mechanism = self.problem, self.mechanism
        poses, frames = self._poses(states)
        s = mechanism.space.translations
        twists = np.zeros((len(states), mechanism.space.dimension, problem.columns))
        for name, axes in self._screws.items():
            columns = problem.variables.columns_of[name]
            twists[:, :, columns] = twists_of_axes(axes, *frames[name], problem.centre)
        gaps = np.zeros((len(states), problem.rows))
        jacobian = np.zeros((len(states), problem.rows, problem.columns))
        for block in problem.blocks:
            first, second = self._ends(block, poses, frames)
            gaps[:, block.rows] = gaps_of(block.selection, first, second)
            rows = rows_of(block.selection, first, second)
            rows[:, :, s:] += rows[:, :, :s] @ moment_arms(second[1] - problem.centre)
            jacobian[:, block.rows, block.columns] = (rows @ twists[:, :, block.columns]) * block.signs
            if block.own is not None:
                jacobian[:, block.rows, block.own] = -(rows @ twists[:, :, block.own])
        self._scalar_gaps(states, gaps)
        self._scalar_rows(states, jacobian)
        scaled = problem.row_scale[:, None] * jacobian * problem.variables.column_scale
        return gaps * problem.row_scale, scaled

    def configurations(self, states: Stack, near: Configuration) -> Stack:
        """n x numbers: the configurations of states, flat; see `ClosureProblem.configuration`."""
        problem, columns = self.problem, []
        poses = self._poses(states)[0] if problem.dependent else {}
        unknown = {joint.name: place for joint, _, place in problem.variables.joints}
        dependent = {joint.name: joint for joint in problem.dependent}
        for name, value in near.items():
            if name in unknown:
                columns.append(states[:, unknown[name]])
                continue
            found = np.tile(value, (len(states), 1))
            if name in dependent:
                joint = dependent[name]
                kind = self.mechanism.type_of(joint)
                first = placed(poses[joint.first], Fixed.of(joint.frame_on_first))
                second = placed(poses[joint.second], Fixed.of(joint.frame_on_second))
                for row, *ends in zip(found, *first, *second, strict=True):
                    both = Pose(ends[0], ends[1]), Pose(ends[2], ends[3])
                    row[:] = unwound(kind, values_between(kind, *both, joint.second_axis), value)
            columns.append(found)
        return np.concatenate(columns, axis=1) if columns else np.zeros((len(states), 0))

    def _poses(self, states: Stack) -> tuple[dict[str, Frames], dict[str, tuple[Frames, Frames]]]:
        """Poses of all bodies; for joints that are unknowns frame A and where their values put B."""
        count, s = len(states), self.mechanism.space.translations
        ground = np.broadcast_to(np.eye(s), (count, s, s)), np.zeros((count, s))
        poses: dict[str, Frames] = {GROUND: ground}
        frames: dict[str, tuple[Frames, Frames]] = {}
        left = dict(self._kinds)
        for joint, forward, beyond in self._beyond:
            found = left.pop(joint.name, None)
            here, there = (joint.first, joint.second) if forward else (joint.second, joint.first)
            near = placed(poses[here], (self._first if forward else self._second)[joint.name])
            far = near if found is None else self._moved(joint, found, states, near, forward)
            frames[joint.name] = (near, far) if forward else (far, near)
            poses[there] = placed(far, beyond)
        for name, found in left.items():
            joint = self.problem.variables.joint[name]
            first = placed(poses[joint.first], self._first[joint.name])
            frames[name] = first, self._moved(joint, found, states, first, True)
        return poses, frames

    def _moved(
        self, joint: Joint, found: tuple[JointType, slice], states: Stack, near: Frames, forward: bool
    ) -> Frames:
        """The far frame of a joint at its values."""
        kind, place = found
        if not kind.values:
            return near
        return moved_by(near, kind, states[:, place], joint.lead, joint.second_axis, forward)

    def _ends(
        self, block: Block, poses: dict[str, Frames], frames: dict[str, tuple[Frames, Frames]]
    ) -> tuple[Frames, Frames]:
        second = placed(poses[block.part.second], self._second[block.name])
        if block.own is not None:
            return frames[block.name][1], second
        return placed(poses[block.part.first], self._first[block.name]), second

    def _scalar_gaps(self, states: Stack, gaps: Stack) -> None:
        """Gaps of couplings and motors over several axes, state by state: few mechanisms have any."""
        if self.problem.couplings or self.problem.drives:
            for state, row in zip(states, gaps, strict=True):
                self.problem.scalar_gaps(state, row)

    def _scalar_rows(self, states: Stack, jacobian: Stack) -> None:
        if self.problem.couplings or self.problem.drives:
            for state, rows in zip(states, jacobian, strict=True):
                self.problem.scalar_rows(state, rows)
