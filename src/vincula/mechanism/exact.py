"""J_a, J_p and G^T of a drawn mechanism with the numbers as they were written, for exact ranks.

Frames have unnormalised axes here, the reference point is the ground's origin, and the member moves in
ground axes: all of that multiplies rows or columns by invertible matrices, which keeps every rank.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.parts import ContactPart, Joint
from vincula.mechanism.written import ExactVector
from vincula.numerics.exact_blocks import ExactBlocks
from vincula.numerics.surds import ONE, ZERO, NotExactError, Surd, exactly

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.written import Written
    from vincula.model import LinearModel

ExactFrame = tuple[tuple[ExactVector, ...], ExactVector]
"""Axes (perpendicular, of any length) and origin, in ground axes."""


def exact_blocks(mechanism: Mechanism, q: Configuration, _model: LinearModel | None = None) -> ExactBlocks:
    """The blocks of a mechanism at its drawn configuration.

    Args:
        mechanism: The mechanism.
        q: The configuration.
        _model: Its linear model, of which nothing is needed.

    Raises:
        NotExactError: Another configuration, or a number that is not known exactly; says which.
    """
    return _Exact(mechanism, q).blocks()


class _Exact:
    def __init__(self, mechanism: Mechanism, q: Configuration) -> None:
        self.mechanism, self.layout = mechanism, mechanism.layout
        self.planar = mechanism.space.translations == 2
        self._refuse_moved(q)
        size = mechanism.space.translations
        unit = tuple(tuple(ONE if i == k else ZERO for i in range(size)) for k in range(size))
        frames: dict[int, ExactFrame] = {0: (unit, (ZERO,) * size)}
        for joint in mechanism.all_joints:
            index = self.layout.frames.of_joint[joint.name]
            frames[index] = frames[index + 1] = self._joint_frame(joint)
        for contact in mechanism.contacts:
            index = self.layout.frames.of_contact[contact.name]
            frames[index] = frames[index + 1] = self._contact_frame(contact)
        self.frames, self._ground = frames, frames[0]

    def _refuse_moved(self, q: Configuration) -> None:
        for joint in self.mechanism.all_joints:
            zero = self.mechanism.type_of(joint).zero
            if joint.closure or not np.array_equal(q[joint.name], zero):
                raise NotExactError(f"joint {joint.name!r} is not where it was drawn")
        if self.layout.polynomials:
            raise NotExactError(f"coupling {self.layout.polynomials[0][1].name!r} is a polynomial")

    def blocks(self) -> ExactBlocks:
        """The blocks, rows in the order of the model."""
        layout = self.layout
        twists = [self._twist(k) for k in range(len(layout.columns))]
        rows = [self._row(k) for k in range(len(layout.signs))]
        columns = [*layout.active, *layout.passive]
        n_a = len(layout.active)
        jacobian: list[list[Surd]] = []
        member: list[list[Surd]] = []
        for k, row in enumerate(rows):
            signs = layout.signs[k]
            jacobian.append([_times(signs[c], _dot(row, twists[c])) if signs[c] else ZERO for c in columns])
            member.append([_times(layout.carried[k], entry) for entry in row])
        for constant in layout.constant:
            jacobian.append([exactly(float(constant[c])) for c in columns])
            member.append([ZERO] * self.mechanism.space.dimension)
        return ExactBlocks(
            [row[:n_a] for row in jacobian],
            [row[n_a:] for row in jacobian],
            member,
            "the mechanism as drawn, every number as it is written",
        )

    def _twist(self, k: int) -> ExactVector:
        """Twist of a column at the ground's origin: see `jacobians.screw_matrix`."""
        column = self.layout.columns[k]
        joint = self.mechanism.joint.get(column.joint)
        if joint is None:
            return (ZERO,) * self.mechanism.space.dimension  # a drive: its row is a constant
        kind = self.mechanism.type_of(joint)
        place = kind.axis_names(joint.name).index(column.name)
        axes, centre = self.frames[self.layout.frames.of_joint[joint.name]]
        step = [s for s in kind.steps for _ in range(3 if s == "S" else 1)][place]
        if self.planar:
            return _planar_twist(axes, centre, step)
        if step[0] == "T":
            return (*axes["xyz".index(step[1])], ZERO, ZERO, ZERO)
        axis = axes[2]
        if step == "S":
            axis = axes[place - kind.axes.index("wx")] if "wx" in kind.axes else axes[place]
        elif step == "R2":
            axis = self._second_axis(joint)
        along = axis if step == "H" and joint.lead else None
        if along is not None:
            raise NotExactError(f"the lead of screw {joint.name!r} is divided by 2 pi")
        return (*_cross(centre, axis), *axis)

    def _second_axis(self, joint: Joint) -> ExactVector:
        return _written(joint).axes[1]

    def _row(self, k: int) -> ExactVector:
        """A blocked direction on twists at the ground's origin: see `jacobians.blocked_matrix`."""
        rows = self.layout.blocked
        axes, _ = self.frames[int(rows.frame[k])]
        # A declared cut point only mixes complete rows: the ground's origin serves as well.
        _, point = self.frames.get(int(rows.point[k]), self._ground)
        push = _mixed(axes, rows.push[k])
        if self.planar:
            turn = exactly(float(rows.turn[k][0]))
            return (*push, point[0] * push[1] - point[1] * push[0] + turn)
        across = {row: other for row, other, _ in rows.across}
        if k in across:
            about = _cross(axes[2], self._across(across[k]))
        elif rows.push[k].any() and rows.turn[k].any():
            raise NotExactError("the lead of a screw is divided by 2 pi")
        else:
            about = _mixed(axes, rows.turn[k])
        arm = _cross(point, push)
        return (*push, *(a + b for a, b in zip(arm, about, strict=True)))

    def _across(self, frame: int) -> ExactVector:
        """The axis carried by the second side: the second of a universal joint, x of a line contact."""
        for joint in self.mechanism.all_joints:
            if self.layout.frames.of_joint[joint.name] + 1 == frame:
                return self._second_axis(joint)
        return self.frames[frame][0][0]

    def _joint_frame(self, joint: Joint) -> ExactFrame:
        size = self.mechanism.space.translations
        if joint.type == "fixed" or joint in self.mechanism.implicit_joints:
            return self.frames_of_ground(size), (ZERO,) * size
        drawn = _written(joint)
        point = drawn.point or (ZERO,) * size
        if joint.type in ("spherical", "fixed", "free"):
            return self.frames_of_ground(size), point
        axes = drawn.axes
        if self.planar:
            return (
                _planar_frame(axes[0]) if joint.type == "prismatic" else self.frames_of_ground(size)
            ), point
        return _frame_with_z(axes[0]), point

    def _contact_frame(self, contact: ContactPart) -> ExactFrame:
        drawn = _written(contact)
        point = drawn.point
        if point is None:
            raise NotExactError(f"contact {contact.name!r} has no point")
        if self.planar:
            x, y = drawn.axes[0]
            return ((y, -x), (x, y)), point
        return _frame_with_z(*drawn.axes), point

    @staticmethod
    def frames_of_ground(size: int) -> tuple[ExactVector, ...]:
        """The axes of the ground."""
        return tuple(tuple(ONE if i == k else ZERO for i in range(size)) for k in range(size))


def _written(part: Joint | ContactPart) -> Written:
    if part.written is None:
        raise NotExactError(f"the place of {part.name!r} comes from a file that does not give it exactly")
    return part.written


def _planar_frame(x: ExactVector) -> tuple[ExactVector, ...]:
    return (x, (-x[1], x[0]))


def _planar_twist(axes: Sequence[ExactVector], centre: ExactVector, step: str) -> ExactVector:
    if step[0] == "T":
        return (*axes["xyz".index(step[1])], ZERO)
    return (centre[1], -centre[0], ONE)


def _frame_with_z(z: ExactVector, x: ExactVector | None = None) -> tuple[ExactVector, ...]:
    """Perpendicular axes with z, and x as nearly as that allows."""
    if x is None:
        smallest = min(range(3), key=lambda k: abs(float(z[k])))
        x = tuple(ONE if k == smallest else ZERO for k in range(3))
    y = _cross(z, x)
    return (_cross(y, z), y, z)


def _cross(one: ExactVector, two: ExactVector) -> ExactVector:
    (a, b, c), (x, y, z) = one, two
    return (b * z - c * y, c * x - a * z, a * y - b * x)


def _dot(one: Sequence[Surd], two: Sequence[Surd]) -> Surd:
    total = ZERO
    for a, b in zip(one, two, strict=True):
        if a and b:
            total = total + a * b
    return total


def _times(sign: float, value: Surd) -> Surd:
    return ZERO if sign == 0.0 else value if sign > 0.0 else -value


def _mixed(axes: Sequence[ExactVector], weights: Matrix) -> ExactVector:
    """The sum of axes with weights 0, 1 or -1."""
    result = [ZERO] * len(axes[0])
    for axis, weight in zip(axes, weights.tolist(), strict=True):
        if weight:
            result = [a + _times(weight, b) for a, b in zip(result, axis, strict=True)]
    return tuple(result)
