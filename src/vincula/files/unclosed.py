"""Frames that look like the two ends of a loop which nothing closes: told, because an open tree is no robot.

CAD exporters draw both ends of a loop and leave the closing to another file or program: `closing_arm_1`
and `closing_arm_2` (onshape-to-robot), `closedloop1_A` and `closedloop1_B`, `fermeture1_A` and
`fermeture1_B` (the robots with Gepetto side files).  Whether they coincide as points, axes or frames is not
in the names, so nothing is closed by them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_END: Final = re.compile(
    r"(?P<loop>.*(?:closing|closed|closure|loop|fermeture).*?)(?P<end>[-_.]?[AB12])", re.IGNORECASE
)
_OTHER: Final = {"A": "B", "a": "b", "1": "2"}
_MOST_NAMED: Final = 3


def unclosed_ends(draft: RobotDraft) -> list[tuple[str, str]]:
    """Pairs of frames (or links) whose names are those of the two ends of one loop, and that no loop joins.

    Args:
        draft: What was read, side files included.
    """
    bodies = {link: link for link in draft.links} | {frame.name: frame.body for frame in draft.frames}
    joined = {frozenset((joint.parent, joint.child)) for joint in draft.joints}
    found = []
    for name in bodies:
        match = _END.fullmatch(name)
        end = match["end"] if match else ""
        if match is None or end[-1:] not in _OTHER:
            continue
        other = f"{match['loop']}{end[:-1]}{_OTHER[end[-1]]}"
        if other in bodies and _apart(name, other, bodies) and not joined & _pairs(name, other, bodies):
            found.append((name, other))
    return found


def note_unclosed_ends(draft: RobotDraft, how: str) -> None:
    """Add a note to the draft that names the pairs, if there are any.

    Args:
        draft: What was read.
        how: What closes a loop between two frames in this format; `{}` is the first pair.
    """
    found = unclosed_ends(draft)
    if not found:
        return
    named = "; ".join(f"{a} and {b}" for a, b in found[:_MOST_NAMED])
    rest = f"; {len(found) - _MOST_NAMED} more pairs" if len(found) > _MOST_NAMED else ""
    draft.notes.append(
        f"these frames look like the ends of loops that nothing closes: {named}{rest}. "
        f"{how.format(', '.join(found[0]))}"
    )


def _apart(name: str, other: str, bodies: Mapping[str, str]) -> bool:
    """Whether two frames are not on one body, which could not be a loop."""
    return bodies[name] != bodies[other]


def _pairs(name: str, other: str, bodies: Mapping[str, str]) -> set[frozenset[str]]:
    """What a joint may connect to join the two: the frames as links, or the links that carry them."""
    return {frozenset((name, other)), frozenset((bodies[name], bodies[other]))}
