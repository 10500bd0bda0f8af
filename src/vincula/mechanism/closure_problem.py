"""The equations of closure: unknown joint values, gaps of loops, contacts and couplings, Jacobian.

Unknowns are the values of the kinematic tree's joints, of the joints outside it that must keep values
of their own (motors, couplings, limits, screws), of motors that drive several axes, and on request
the pose of the reference member.  Steps are taken in joint rates (SO(3) for balls), scaled by the
characteristic length, so that one number measures both turns and displacements.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_rows import (
    Selection,
    contact_selection,
    gap_rows,
    joint_selection,
    whole_pose,
)
from vincula.mechanism.closure_unknowns import joints_of_axes, member_joint, scalar_couplings
from vincula.mechanism.closure_values import Mask, Variables, unwound
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import axis_twists, motion, values_between
from vincula.mechanism.kinematics import part_frames, reference_position
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.mechanism.residuals import axis_linear, axis_values
from vincula.spatial.poses import Pose
from vincula.spatial.twists import moment_arm

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Rows of one loop or contact: B against A, or B against where a joint's own values put it."""

    name: str
    part: Joint | ContactPart
    selection: Selection
    rows: slice
    columns: Vector
    signs: Vector
    own: slice | None


@dataclass(frozen=True, slots=True, eq=False)
class Equations:
    """Values and derivatives of the closure equations at one state, in scaled units.

    Attributes:
        gaps: Residuals, metres / L and radians.
        jacobian: rows x columns, unknowns in metres / L and radians.
        decomposed: Singular value decompositions of blocks of columns, kept by who asks for them.
    """

    gaps: Vector
    jacobian: Matrix
    decomposed: dict[bytes, tuple[Matrix, Vector, Matrix]] = field(default_factory=dict)


class ClosureProblem:
    """The closure equations of a mechanism.

    Args:
        mechanism: The mechanism.
        kept: Joints outside the kinematic tree whose values must be unknowns (those of couplings and
            screws always are).
        drives: Motors over several axes whose values must be unknowns.
        member: Whether the pose of the reference member is an unknown.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        kept: Iterable[str] = (),
        drives: Iterable[str] = (),
        *,
        member: bool = False,
    ) -> None:
        self.mechanism, self.length = mechanism, mechanism.length
        self.centre = reference_position(mechanism, {b.name: b.pose for b in mechanism.bodies})
        tree = {joint.name for joint, _ in mechanism.tree}
        self.couplings = scalar_couplings(mechanism)
        self.drives = [d for d in mechanism.drives if d.name in set(drives)]
        wanted = {*kept, *joints_of_axes(mechanism, self.couplings, self.drives)}
        outside = [j for j in mechanism.all_joints if j.name not in tree]
        own = [j for j in outside if j.type != "fixed" and (j.name in wanted or j.type == "screw")]
        self.dependent = [j for j in outside if not j.closure and j not in own]
        if member:
            own.append(member_joint(mechanism))
        in_tree = [joint for joint, _ in mechanism.tree]
        self.variables = Variables(mechanism, [*in_tree, *own], self.drives)
        self._home = axis_values(mechanism, mechanism.home)
        self._paths = self._body_paths()
        self.blocks: list[Block] = []
        self._sources: list[str] = []
        for joint in outside:
            if joint in own:
                self._add_block(joint, whole_pose(mechanism.space.translations), own=True)
            else:
                self._add_block(joint, joint_selection(mechanism.type_of(joint), joint.second_axis))
        for contact in mechanism.contacts:
            self._add_block(contact, contact_selection(contact.type, mechanism.space))
        if member:
            self._add_block(own[-1], whole_pose(mechanism.space.translations), own=True)
        self._sources += [c.name for c in self.couplings] + [d.name for d in self.drives]
        self.linear_rows = self._linear_rows()
        self.row_scale = np.where(self.linear_rows, 1.0 / self.length, 1.0)

    @property
    def columns(self) -> int:
        """Number of unknown rates."""
        return self.variables.columns

    @property
    def rows(self) -> int:
        """Number of equations."""
        return len(self._sources)

    @property
    def sources(self) -> tuple[str, ...]:
        """For every row the loop, contact, coupling or motor that gives it."""
        return tuple(self._sources)

    def _add_block(self, part: Joint | ContactPart, selection: Selection, own: bool = False) -> None:
        start = len(self._sources)
        self._sources += [part.name] * selection.count
        signs: dict[int, int] = {}
        for body, side in ((part.second, 1), (part.first, -1)):
            for column, sign in self._paths[body]:
                signs[column] = signs.get(column, 0) + side * sign
        used = [column for column, sign in signs.items() if sign]
        self.blocks.append(
            Block(
                part.name,
                part,
                selection,
                slice(start, start + selection.count),
                np.array(used, dtype=int),
                np.array([signs[column] for column in used], dtype=float),
                self.variables.columns_of[part.name] if own else None,
            )
        )

    def _body_paths(self) -> dict[str, tuple[tuple[int, int], ...]]:
        """For every body the columns on its way from the ground, with signs."""
        paths: dict[str, tuple[tuple[int, int], ...]] = {GROUND: ()}
        for joint, forward in self.mechanism.tree:
            here, there = (joint.first, joint.second) if forward else (joint.second, joint.first)
            columns = self.variables.columns_of[joint.name]
            sign = 1 if forward else -1
            paths[there] = paths[here] + tuple((k, sign) for k in range(columns.start, columns.stop))
        return paths

    def _linear_rows(self) -> Mask:
        """For every row, whether its gap is in metres."""
        flags = np.zeros(self.rows, dtype=bool)
        for block in self.blocks:
            start = block.rows.start
            flags[start : start + len(block.selection.linear)] = True
        linear = axis_linear(self.mechanism)
        row = self.rows - len(self.couplings) - len(self.drives)
        for scalar in (*(c.rates for c in self.couplings), *(d.drives for d in self.drives)):
            flags[row] = any(linear[axis] for axis in scalar)
            row += 1
        return flags

    def start(self, q: Configuration) -> Vector:
        """The state of a configuration; the member's pose and the values of closures are the tree's."""
        known = dict(q)
        for drive in self.drives:
            values = axis_values(self.mechanism, q)
            known[drive.name] = np.array([sum(c * values[a] for a, c in drive.drives.items())])
        measured = [joint for joint, _, _ in self.variables.joints if joint.name not in known]
        if measured:
            poses = self.mechanism.body_poses(q)
            for joint in measured:
                known[joint.name] = self._values_there(joint, poses)
        return self.variables.gathered(known)

    def _values_there(self, joint: Joint, poses: Mapping[str, Pose]) -> Vector:
        """Values of a joint from where its bodies are."""
        first, second = part_frames(joint, poses)
        return values_between(self.mechanism.type_of(joint), first, second, joint.second_axis)

    def poses(self, state: Vector) -> tuple[dict[str, Pose], dict[str, tuple[Pose, Pose]]]:
        """Poses of all bodies, and for every joint that is an unknown frame A and where its values put B."""
        moved = {
            joint.name: motion(kind, state[values], joint.lead, joint.second_axis)
            for joint, kind, values in self.variables.joints
            if kind.values
        }
        poses = {GROUND: Pose.identity(self.mechanism.space.translations)}
        frames: dict[str, tuple[Pose, Pose]] = {}
        for joint, forward, beyond in self.steps:
            step = moved.pop(joint.name, None)
            if forward:
                first = poses[joint.first] @ joint.frame_on_first
                second = first if step is None else first @ step
                poses[joint.second] = second @ beyond
            else:
                second = poses[joint.second] @ joint.frame_on_second
                first = second if step is None else second @ step.inverse()
                poses[joint.first] = first @ beyond
            frames[joint.name] = first, second
        for name, motion_of_own in moved.items():
            joint = self.variables.joint[name]
            first = poses[joint.first] @ joint.frame_on_first
            frames[name] = first, first @ motion_of_own
        return poses, frames

    @cached_property
    def steps(self) -> list[tuple[Joint, bool, Pose]]:
        """Tree joints with the constant pose of the next body in the far frame of the joint."""
        return [
            (joint, forward, (joint.frame_on_second if forward else joint.frame_on_first).inverse())
            for joint, forward in self.mechanism.tree
        ]

    def gaps(self, state: Vector) -> Vector:
        """Residuals alone, scaled."""
        poses, frames = self.poses(state)
        gaps = np.zeros(self.rows)
        for block in self.blocks:
            gaps[block.rows] = gap_rows(block.selection, *self._ends(block, poses, frames))[0]
        self.scalar_gaps(state, gaps)
        return gaps * self.row_scale

    def equations(self, state: Vector) -> Equations:
        """Residuals and their Jacobian, scaled."""
        poses, frames = self.poses(state)
        twists = self._twists(frames)
        gaps = np.zeros(self.rows)
        jacobian = np.zeros((self.rows, self.columns))
        s = self.mechanism.space.translations
        for block in self.blocks:
            first, second = self._ends(block, poses, frames)
            gaps[block.rows], rows = gap_rows(block.selection, first, second)
            rows[:, s:] += rows[:, :s] @ moment_arm(second.position - self.centre)
            jacobian[block.rows, block.columns] = (rows @ twists[:, block.columns]) * block.signs
            if block.own is not None:
                jacobian[block.rows, block.own] = -(rows @ twists[:, block.own])
        self.scalar_gaps(state, gaps)
        self.scalar_rows(state, jacobian)
        scaled = self.row_scale[:, None] * jacobian * self.variables.column_scale
        return Equations(gaps * self.row_scale, scaled)

    def _ends(
        self, block: Block, poses: Mapping[str, Pose], frames: Mapping[str, tuple[Pose, Pose]]
    ) -> tuple[Pose, Pose]:
        second = poses[block.part.second] @ block.part.frame_on_second
        if block.own is not None:
            return frames[block.name][1], second
        return poses[block.part.first] @ block.part.frame_on_first, second

    def rates_outside(self, state: Vector) -> dict[str, Matrix]:
        """Rates of the joints that close loops without being unknowns, for rates of the unknowns.

        Args:
            state: A closed state.

        Returns:
            By joint name, axes x columns in scaled units.
        """
        poses, frames = self.poses(state)
        twists = self._twists(frames)
        s = self.mechanism.space.translations
        found: dict[str, Matrix] = {}
        for block in self.blocks:
            joint = block.part
            if block.own is not None or not isinstance(joint, Joint) or joint.type == "fixed":
                continue
            kind = self.mechanism.type_of(joint)
            ends = self._ends(block, poses, frames)
            axes = axis_twists(kind, *ends, joint.lead, joint.second_axis, self.centre)
            relative = np.zeros((len(axes), self.columns))
            relative[:, block.columns] = twists[:, block.columns] * block.signs
            relative *= self.variables.column_scale
            for matrix in (axes, relative):
                matrix[:s] /= self.length
            axes = axes * np.where(kind.linear, self.length, 1.0)
            found[joint.name] = np.asarray(np.linalg.lstsq(axes, relative, rcond=None)[0])
        return found

    def _twists(self, frames: Mapping[str, tuple[Pose, Pose]]) -> Matrix:
        """d x columns: twist at the centre, in ground axes, of every unknown axis."""
        twists = np.zeros((self.mechanism.space.dimension, self.columns))
        for joint, kind, _ in self.variables.joints:
            if kind.axes:
                twists[:, self.variables.columns_of[joint.name]] = axis_twists(
                    kind, *frames[joint.name], joint.lead, joint.second_axis, self.centre
                )
        return twists

    def scalar_gaps(self, state: Vector, gaps: Vector) -> None:
        """Write the residuals of couplings and drives into all residuals, unscaled."""
        if not (self.couplings or self.drives):
            return
        values = self.variables.axis_values(state)
        row = self.rows - len(self.couplings) - len(self.drives)
        for coupling in self.couplings:
            gaps[row] = coupling.residual(values, self._home)
            row += 1
        for drive in self.drives:
            gaps[row] = sum(c * values[a] for a, c in drive.drives.items()) - values[drive.name]
            row += 1

    def scalar_rows(self, state: Vector, jacobian: Matrix) -> None:
        """Write the rows of couplings and drives into the Jacobian, unscaled."""
        if not (self.couplings or self.drives):
            return
        values = self.variables.axis_values(state)
        column = self.variables.column
        row = self.rows - len(self.couplings) - len(self.drives)
        for coupling in self.couplings:
            for axis, coefficient in coupling.coefficients(values, self._home).items():
                jacobian[row, column[axis]] = coefficient
            row += 1
        for drive in self.drives:
            for axis, coefficient in {**drive.drives, drive.name: -1.0}.items():
                jacobian[row, column[axis]] = coefficient
            row += 1

    def configuration(self, state: Vector, near: Configuration) -> Configuration:
        """The configuration of a state: values of joints outside the tree from where their bodies are.

        Angles of those joints are unwound to the turn nearest to `near`.
        """
        values = {name: np.array(value) for name, value in near.items()}
        for joint, _, where in self.variables.joints:
            if joint.name in values:
                values[joint.name] = state[where].copy()
        if self.dependent:
            poses, _ = self.poses(state)
            for joint in self.dependent:
                found = self._values_there(joint, poses)
                values[joint.name] = unwound(self.mechanism.type_of(joint), found, near[joint.name])
        return Configuration(values)
