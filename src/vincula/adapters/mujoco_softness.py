"""Loops of a simulation are soft and stand open a little: close them where they stand.

The rows of a loop depend on the gap only to first order, so moving the loop's frame on its second body
onto the one on its first changes them by no more than the gap, which is passed on as uncertainty.
"""

from __future__ import annotations

from dataclasses import replace

from vincula.errors import ClosureError
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Coupling, Joint
from vincula.mechanism.residuals import CLOSED, axis_values


def closed_where_it_stands(mechanism: Mechanism, softness: float) -> tuple[Mechanism, float, str]:
    """The mechanism with every open loop and coupling moved so that it is closed at home.

    Args:
        mechanism: A mechanism at home where a simulation stands.
        softness: How far a loop may be open, times the characteristic length.

    Returns:
        The mechanism, the largest gap [m] and a note about it; the mechanism itself and an empty note
        when everything is closed.

    Raises:
        ClosureError: A loop is open by more.
    """
    residuals = mechanism.residuals()
    worst = max(residuals, key=lambda r: r.gap, default=None)
    if worst is None or worst.gap <= CLOSED * mechanism.length:
        return mechanism, worst.gap if worst is not None else 0.0, ""
    if not worst.gap <= softness * mechanism.length:
        raise ClosureError(
            f"{worst} in the simulation, more than the {softness:g} x {mechanism.length:g} m that count as "
            "soft: step the simulation until it has settled, or allow more softness",
            loop=worst.name,
            gap=worst.gap,
            residuals=residuals,
        )
    poses = mechanism.body_poses()

    def moved(joint: Joint) -> Joint:
        first, _ = part_frames(joint, poses)
        return replace(joint, frame_on_second=poses[joint.second].inverse() @ first)

    note = f"simulated loops are soft: {worst}; the gap counts as uncertainty"
    closed = replace(
        mechanism,
        joints=tuple(moved(joint) if joint.closure else joint for joint in mechanism.joints),
        couplings=_met(mechanism),
    )
    return closed, worst.gap, note


def _met(mechanism: Mechanism) -> tuple[Coupling, ...]:
    """The couplings with the constant of their polynomial such that they hold at home."""
    if not mechanism.couplings:
        return ()
    values = axis_values(mechanism, mechanism.home)

    def met(coupling: Coupling) -> Coupling:
        polynomial = [*coupling.polynomial] or [0.0]
        polynomial[0] += coupling.residual(values, values)
        return replace(coupling, polynomial=tuple(polynomial))

    return tuple(met(coupling) for coupling in mechanism.couplings)
