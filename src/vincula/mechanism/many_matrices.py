"""J and G of many configurations at once: what `jacobians` does for one, an axis in front.

Screws and rows are kept as vectors in space with the arms that carry them to the reference point: their
derivatives (`virtual_work`) need the parts, not the products.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from vincula.arrays import Matrix, Vector
from vincula.mechanism.layout import Layout
from vincula.mechanism.many_frames import (
    ManyFrames,
    Stack,
    crossed,
    lifted_vectors,
    many_frames,
)
from vincula.mechanism.parts import Coupling
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_IN_PLANE: Final = [0, 1, 5]
"""Components of a twist in space that a mechanism in the plane has."""


class ManyMatrices:
    """Screws, blocked directions and matrices of a mechanism at N configurations, in ground axes.

    Everything is in space; twists are (linear velocity of the reference point, angular velocity).

    Args:
        mechanism: The mechanism, with a reference member.
        values: N x coordinates, one configuration a row; every quaternion of any length.

    Attributes:
        frames: All frames.
        slide: N x columns x 3, velocity along the axis for a unit of the rate.
        turn: N x columns x 3, angular velocity for a unit of the rate.
        arm: N x columns x 3, from the axis to the reference point [m].
        screws: N x columns x 6 twists.
        push: N x rows x 3, directions in which velocity is blocked.
        about: N x rows x 3, directions about which turning is blocked.
        lever: N x rows x 3, from the reference point to where the row holds [m].
        blocked: N x rows x 6, blocked directions as rows on twists.
    """

    def __init__(self, mechanism: Mechanism, values: Matrix) -> None:
        self.mechanism, self.layout = mechanism, mechanism.layout
        self.frames: ManyFrames = many_frames(mechanism, values)
        self._values = values
        self._place_screws()
        self._place_rows()

    def _place_screws(self) -> None:
        screws, frames = self.layout.screws, self.frames
        rotation = frames.rotation[:, screws.frame]
        axis = (rotation @ lifted_vectors(screws.axis)[:, :, None])[..., 0]
        self.slide = screws.slide[:, None] * axis
        flat = screws.axis.shape[1] == 2
        self.turn = screws.turn[:, None] * (rotation[..., 2] if flat else axis)
        self.arm = frames.origin[:, None] - frames.position[:, screws.centre]
        self.screws = np.concatenate([self.slide + crossed(self.turn, self.arm), self.turn], axis=-1)

    def _place_rows(self) -> None:
        rows, frames = self.layout.blocked, self.frames
        rotation = frames.rotation[:, rows.frame]
        self.push = (rotation @ lifted_vectors(rows.push)[:, :, None])[..., 0]
        flat = rows.push.shape[1] == 2
        about = np.concatenate([np.zeros_like(rows.push), rows.turn], axis=1) if flat else rows.turn
        self.about = (rotation @ about[:, :, None])[..., 0]
        for k, other, axis in rows.across:
            across = crossed(rotation[:, k, :, 2], (frames.rotation[:, other] @ axis[:, None])[..., 0])
            self.about[:, k] = across / np.linalg.norm(across, axis=-1, keepdims=True)
        self.lever = frames.position[:, rows.point] - frames.origin[:, None]
        self.blocked = np.concatenate([self.push, crossed(self.lever, self.push) + self.about], axis=-1)

    @property
    def lanes(self) -> int:
        """Number of configurations."""
        return len(self._values)

    @property
    def components(self) -> slice | list[int]:
        """Which components of a twist in space a twist of this mechanism has."""
        return _IN_PLANE if self.layout.screws.axis.shape[1] == 2 else slice(None)

    @property
    def in_member_axes(self) -> bool:
        """Whether twists are told in the axes of the reference member."""
        reference = self.mechanism.reference
        return reference is not None and reference.axes == "body"

    def matrices(self) -> Stack:
        """[J_a J_p -G^T] of every configuration, N x m x (n_a + n_p + d), in m, rad, s."""
        layout, m = self.layout, len(self.layout.rows)
        n = len(layout.columns)
        geometric = len(layout.signs)
        order = np.concatenate([layout.active, layout.passive])
        member = layout.carried[:, None] * self.blocked
        if self.in_member_axes:
            turn = self.frames.member
            member = np.concatenate([member[..., :3] @ turn, member[..., 3:] @ turn], axis=-1)
        twist = member[..., self.components]
        found = np.zeros((self.lanes, m, n + twist.shape[-1]))
        jacobian = (self.blocked @ np.swapaxes(self.screws, 1, 2)) * layout.signs
        found[:, :geometric, :n] = jacobian[:, :, order]
        found[:, geometric:, :n] = self.constant()[:, :, order]
        found[:, :geometric, n:] = -twist
        return found

    def constant(self) -> Stack:
        """Rows of couplings and drives, N x rows x columns."""
        return self.scalar_rows(self.mechanism)[0]

    def scalar_rows(self, variant: Mechanism) -> tuple[Stack, Stack]:
        """Rows of the couplings and drives of a variant, and their gaps apart from motor values.

        Args:
            variant: A mechanism of the same structure.

        Returns:
            N x rows x columns, and N x rows [m or rad].
        """
        layout, values, index = variant.layout, self.axis_values, self.layout.index
        home = axis_values(variant, variant.home)
        rows = np.array(np.broadcast_to(layout.constant, (self.lanes, *layout.constant.shape)))
        gaps = np.zeros(rows.shape[:2])
        for k, coupling in enumerate(variant.couplings):
            if not set(coupling.axes) <= set(values):
                continue  # axes without values of their own: nothing that could be compared
            inner = _total(coupling, coupling.driver, values, home, self.lanes)
            polynomial = list(coupling.polynomial) or [0.0]
            gaps[:, k] = _total(coupling, coupling.rates, values, home, self.lanes)
            gaps[:, k] -= polyval(inner, polynomial)
            if coupling.driver:
                slope = polyval(inner, polyder(polynomial))
                for axis, coefficient in coupling.rates.items():
                    if axis in index:
                        rows[:, k, index[axis]] += coefficient
                for axis, coefficient in coupling.driver.items():
                    if axis in index:
                        rows[:, k, index[axis]] -= slope * coefficient
        moving = [drive for drive in variant.drives if drive.name in variant.active]
        for k, drive in enumerate(moving, start=len(variant.couplings)):
            for axis, coefficient in drive.drives.items():
                gaps[:, k] += coefficient * values[axis]
        return rows, gaps

    def bent(self, coupling: Coupling) -> Vector:
        """Second derivative of the polynomial of a coupling at every configuration."""
        home = axis_values(self.mechanism, self.mechanism.home)
        inner = _total(coupling, coupling.driver, self.axis_values, home, self.lanes)
        return np.asarray(polyval(inner, polyder(list(coupling.polynomial) or [0.0], 2)))

    @property
    def axis_values(self) -> Mapping[str, Vector]:
        """Value of every axis that has a scalar value of its own, N numbers each."""
        found: dict[str, Vector] = {}
        start = 0
        for name, home in self.mechanism.home.items():
            kind = self.mechanism.type_of(self.mechanism.joint[name])
            if kind.scalar_values:
                for k, axis in enumerate(kind.axis_names(name)):
                    found[axis] = self._values[:, start + k]
            start += len(home)
        return found

    def in_ground_axes(self, twists: Stack) -> Stack:
        """Twists of the member, N x ... x d, as they are in space and in ground axes, N x ... x 6."""
        wide = np.zeros((*twists.shape[:-1], 6))
        wide[..., self.components] = twists
        return turned(self.frames.member, wide) if self.in_member_axes else wide

    def in_own_axes(self, wrenches: Stack) -> Stack:
        """Wrenches on the member in ground axes, N x ... x 6, in the axes of twists, N x ... x d."""
        if self.in_member_axes:
            wrenches = turned(np.swapaxes(self.frames.member, 1, 2), wrenches)
        return np.asarray(wrenches[..., self.components])


def _total(
    coupling: Coupling,
    terms: Mapping[str, float],
    values: Mapping[str, Vector],
    home: Mapping[str, float],
    lanes: int,
) -> Vector:
    """Sum of c (q - reference) over some axes."""
    zero = np.zeros(lanes)
    return sum((c * (values[a] - coupling.references.get(a, home[a])) for a, c in terms.items()), zero)


def turned(rotation: Stack, screws: Stack) -> Stack:
    """Both halves of N x ... x 6 numbers turned by N rotations."""
    middle = (1,) * (screws.ndim - 2)
    turn = rotation.reshape(len(rotation), *middle, 3, 3)
    halves = [(turn @ part[..., None])[..., 0] for part in (screws[..., :3], screws[..., 3:])]
    return np.concatenate(halves, axis=-1)


def ordered(layout: Layout) -> Vector:
    """Columns of the layout in the order (active, passive)."""
    return np.concatenate([layout.active, layout.passive])
