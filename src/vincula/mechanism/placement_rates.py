"""How the numbers of a mechanism change with its dimensions: frames in their bodies, leads, axes, couplings.

These rates do not depend on the configuration; what they do to matrices at one is said by `redrawn`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.errors import ModelError, listing
from vincula.mechanism.many_frames import Stack, lifted_frames, lifted_vectors
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Stencil = Sequence[tuple[float, "Mechanism"]]
"""Mechanisms beside one another, with weights: the sum of weights x numbers is the rate of the numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """What a layout's geometry is made of, or its rates by one dimension.

    Attributes:
        rotation: k x s x s, frames of `layout.frames` in their bodies.
        position: k x s [m].
        origin: Reference point in the member [m].
        lead: Advance of every joint a turn, in the order of `all_joints` [m].
        second_axis: Second axis of every joint, joints x 3.
    """

    rotation: Stack
    position: Matrix
    origin: Vector
    lead: Vector
    second_axis: Matrix

    @staticmethod
    def of(mechanism: Mechanism) -> Numbers:
        """The numbers of a mechanism with a reference member."""
        table, reference = mechanism.layout.frames, mechanism.reference
        joints = mechanism.all_joints
        return Numbers(
            table.rotation,
            table.position,
            np.zeros(mechanism.space.translations) if reference is None else reference.origin,
            np.array([joint.lead for joint in joints], dtype=float),
            np.array([joint.second_axis for joint in joints], dtype=float).reshape(-1, 3),
        )

    @staticmethod
    def rates(stencil: Stencil) -> Numbers:
        """Rates of the numbers, from mechanisms beside one another."""
        found = [(weight, Numbers.of(mechanism)) for weight, mechanism in stencil]
        return Numbers(*(sum(w * getattr(n, name) for w, n in found) for name in Numbers.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class PlacementRates:
    """Rates by p dimensions, frames as small motions in the axes of their bodies, lifted into space.

    Attributes:
        turn: p x k x 3 angular velocities of the frames [rad by unit of the dimension].
        shift: p x k x 3 velocities of their origins [m].
        origin: p x 3 velocities of the reference point in the member [m].
        lead: p x joints.
        second_axis: p x joints x 3.
        scalars: For every dimension the stencil with which couplings and drives change; empty for most.
    """

    turn: Stack
    shift: Stack
    origin: Matrix
    lead: Matrix
    second_axis: Stack
    scalars: tuple[Stencil, ...]

    @staticmethod
    def of(
        mechanism: Mechanism, names: Sequence[str], rates: Sequence[Numbers], stencils: Sequence[Stencil]
    ) -> PlacementRates:
        """Rates as small motions.

        Args:
            mechanism: The mechanism.
            names: Names of the dimensions.
            rates: Rates of its numbers by every dimension.
            stencils: For every dimension mechanisms beside this one; empty where nothing but these
                numbers changes.

        Raises:
            ModelError: A dimension changes the lead of a screw that closes a loop without a value.
        """
        turns, shifts = [], []
        rotation, _ = lifted_frames(mechanism.layout.frames.rotation, mechanism.layout.frames.position)
        for rate in rates:
            turned, shift = lifted_frames(rate.rotation, rate.position)
            if rate.position.shape[1] == 2:
                turned[:, 2, 2] = 0.0
            spin = turned @ np.swapaxes(rotation, 1, 2)
            skew = 0.5 * (spin - np.swapaxes(spin, 1, 2))
            turns.append(np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1))
            shifts.append(shift)
        of_type = {kind: np.array([j.type == kind for j in mechanism.all_joints], dtype=bool)
                   for kind in ("screw", "universal")}  # fmt: skip
        found = PlacementRates(
            np.array(turns),
            np.array(shifts),
            np.array([lifted_vectors(rate.origin) for rate in rates]),
            np.array([rate.lead * of_type["screw"] for rate in rates]),
            np.array([rate.second_axis * of_type["universal"][:, None] for rate in rates]),
            tuple(stencil if _scalars_change(mechanism, stencil) else () for stencil in stencils),
        )
        _refuse_leads(mechanism, names, found)
        return found


def _refuse_leads(mechanism: Mechanism, names: Sequence[str], rates: PlacementRates) -> None:
    """Refuse leads of screws without a value: how far such a screw is turned is not known."""
    contacts = {cut.joint.name for cut in mechanism.reduction.cuts if cut.kind == "contact"}
    for k, joint in enumerate(mechanism.all_joints):
        if joint.closure or joint.name in contacts:
            by = [name for name, lead in zip(names, rates.lead[:, k], strict=True) if lead != 0.0]
            if by:
                raise ModelError(
                    f"{listing(by)} changes the lead of screw {joint.name!r}, which closes a loop without a "
                    "value: how far it is turned is not known, so there is no derivative"
                )


def _scalars_change(mechanism: Mechanism, stencil: Stencil) -> bool:
    """Whether couplings or drives differ along a stencil."""
    own = _scalars(mechanism)
    return any(_scalars(other) != own for _, other in stencil)


def _scalars(mechanism: Mechanism) -> list[Any]:
    """All numbers of couplings and drives."""
    home = axis_values(mechanism, mechanism.home)
    found: list[Any] = [
        (dict(c.rates), dict(c.driver), tuple(c.polynomial),
         {axis: c.references.get(axis, home.get(axis)) for axis in c.axes})
        for c in mechanism.couplings
    ]  # fmt: skip
    return [*found, *(dict(drive.drives) for drive in mechanism.drives)]
