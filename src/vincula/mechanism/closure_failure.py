"""Why a loop does not close: lengths that cannot meet, and the message that says so."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ClosureError, listing
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import motion
from vincula.mechanism.loops import Loop, independent_loops
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.mechanism.residuals import LoopResidual
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_CENTRED: Final = ("revolute", "spherical", "universal", "hard-finger", "soft-finger")
"""Joints and contacts in which one point belongs to both bodies."""
_RIGID: Final = ("fixed", "complete")
_ASKED: Final = "the pose asked for"


@dataclass(frozen=True, slots=True)
class LengthConflict:
    """A loop whose longest side is longer than all others together.

    Attributes:
        loop: The joint or contact that closes the loop.
        sides: Length [m] of every side, from joint to joint.
        longest: The longest side.
        short: By how much the others are too short together [m].
    """

    loop: str
    sides: Mapping[str, float]
    longest: str
    short: float

    def __str__(self) -> str:
        others = [f"{name} {size:.6g} m" for name, size in self.sides.items() if name != self.longest]
        return (
            f"Lengths that cannot meet: {self.longest} is {self.sides[self.longest]:.6g} m, more than the "
            f"other sides of its loop together ({listing(others, 6)}), which are {self.short:.4g} m too short"
        )


def length_conflicts(
    mechanism: Mechanism,
    q: Configuration,
    held: Collection[str],
    pose: Pose | None = None,
    point: Vector | None = None,
) -> tuple[LengthConflict, ...]:
    """Loops that no configuration can close because one side is too long.

    Args:
        mechanism: The mechanism.
        q: Where held joints stand.
        held: Names of joints whose values are held; they and fixed joints join bodies to one side.
        pose: Pose of the reference member if it is asked for.
        point: Position of the reference point if that alone is asked for [m].
    """
    if mechanism.reference is not None and (pose is not None or point is not None):
        s = mechanism.space.translations
        kind = "fixed" if pose is not None else "revolute" if s == 2 else "spherical"
        target = pose if pose is not None else Pose(np.eye(s), np.asarray(point))
        on_body = Pose(np.eye(s), np.asarray(mechanism.reference.origin))
        there = Joint(_ASKED, kind, GROUND, mechanism.reference.body, target, on_body, closure=True)
        mechanism = replace(mechanism, joints=(*mechanism.joints, there))
    parts: dict[str, Joint | ContactPart] = {joint.name: joint for joint in mechanism.all_joints}
    parts.update({contact.name: contact for contact in mechanism.contacts})
    found = []
    for loop in independent_loops(mechanism):
        sides = _sides(mechanism, loop, parts, q, held)
        if not sides:
            continue
        longest = max(sides, key=lambda name: sides[name])
        short = 2.0 * sides[longest] - sum(sides.values())
        if short > 1e-9 * sides[longest]:
            found.append(LengthConflict(loop.closed_by, sides, longest, short))
    return tuple(sorted(found, key=lambda conflict: -conflict.short))


def _sides(
    mechanism: Mechanism,
    loop: Loop,
    parts: Mapping[str, Joint | ContactPart],
    q: Configuration,
    held: Collection[str],
) -> dict[str, float]:
    """Lengths between consecutive joint centres, rigid joints passed over; empty where one can slide."""
    chain = [parts[name] for name in loop.parts]
    rigid = [part.type in _RIGID or part.name in held for part in chain]
    if not all(stiff or part.type in _CENTRED for part, stiff in zip(chain, rigid, strict=True)):
        return {}
    turning = [k for k, stiff in enumerate(rigid) if not stiff]
    sides: dict[str, float] = {}
    for one, two in zip(turning, [*turning[1:], turning[0] + len(chain)] if turning else [], strict=True):
        point = _end(chain[one], loop.bodies[one], leaving=True).position
        frame = Pose(np.eye(len(point)), -point)
        for k in range(one + 1, two):
            frame = frame @ _crossing(mechanism, chain[k % len(chain)], loop.bodies[k % len(chain)], q)
        end = _end(chain[two % len(chain)], loop.bodies[two % len(chain)], leaving=False).position
        name = f"{chain[one].name} to {chain[two % len(chain)].name}"
        sides[name] = float(np.linalg.norm(frame.apply(end)))
    return sides


def _end(part: Joint | ContactPart, entered_from: str, *, leaving: bool) -> Pose:
    """Frame of a part on the body that the walk comes from, or (leaving) goes to."""
    on_first = (part.first == entered_from) != leaving
    return part.frame_on_first if on_first else part.frame_on_second


def _crossing(mechanism: Mechanism, part: Joint | ContactPart, body: str, q: Configuration) -> Pose:
    """Pose of the next body in the one that the walk comes from, across a rigid or held part."""
    moved = Pose.identity(mechanism.space.translations)
    if isinstance(part, Joint) and part.name in q:
        moved = motion(mechanism.type_of(part), q[part.name], part.lead, part.second_axis)
    across = part.frame_on_first @ moved @ part.frame_on_second.inverse()
    return across if part.first == body else across.inverse()


def cannot_close(
    mechanism: Mechanism,
    best: Configuration,
    missed: tuple[LoopResidual, ...],
    *,
    conflicts: tuple[LengthConflict, ...],
    attempts: int,
    hints: tuple[str, ...],
) -> ClosureError:
    """The refusal: which loop, how far it stays open, why, and what would help.

    Args:
        mechanism: The mechanism.
        best: The configuration that comes nearest to closing.
        missed: By how much it misses the values and the pose asked for.
        conflicts: Loops whose lengths cannot meet.
        attempts: Number of starts that were tried.
        hints: Further sentences.
    """
    residuals = (*mechanism.residuals(best), *missed)
    worst = max(residuals, key=lambda r: r.gap)
    tried = f"{attempts} starts" if attempts > 1 else "one start"
    reasons = [str(conflict) for conflict in conflicts[:2]] or [
        f"No closed configuration was found from {tried}, and no simple length explains it"
    ]
    text = ". ".join([f"cannot close: {worst} at best", *reasons, *hints])
    return ClosureError(
        text,
        loop=worst.name,
        gap=worst.gap,
        best=best,
        residuals=residuals,
        lengths=conflicts,
        attempts=attempts,
    )


def named_values(names: Collection[str], values: Mapping[str, Vector]) -> str:
    """`o1 = 0.31, o5 = -0.2` for messages."""
    shown = [f"{name} = {np.array2string(np.atleast_1d(values[name]), precision=6)[1:-1]}" for name in names]
    return listing([text.replace("  ", " ") for text in shown], 6)
