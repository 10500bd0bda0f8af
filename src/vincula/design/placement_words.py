"""What a ranking of motor choices says, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.analysis.ranking import CRITERIA
from vincula.analysis.wording import count_of, number
from vincula.errors import listing

if TYPE_CHECKING:
    from vincula.design.motor_choice import MotorChoice
    from vincula.design.placement import Placement

EQUALS: Final = 3
"""Choices as good as the first that are named."""


def explanation(placement: Placement) -> tuple[str, ...]:
    """Why the best choice is the best; where no choice controls the member, why, and which comes nearest."""
    first = placement.choices[0]
    if not first.controls:
        return (*_why_none(placement), _nearest(placement), *first.explanation)
    said = [_lead(placement, first)]
    needed = _needed(placement)
    if needed:
        said.append(f"Every choice that controls the member has a motor on {listing(needed)}.")
    return (*said, *first.explanation)


def how_looked(placement: Placement) -> str:
    """How many choices there are, and whether all of them were looked at."""
    count = len(placement.choices)
    if placement.exhaustive:
        return f"All {count_of(count, 'admissible choice')}" if count > 1 else "The only admissible choice"
    return (
        f"A search with seed {placement.seed} looked at {count} of {placement.admissible.count} admissible "
        "choices: the best of all need not be among them"
    )


def _lead(placement: Placement, first: MotorChoice) -> str:
    criterion, names = CRITERIA[placement.rank_by], listing(first.motors)
    worst = " at its worst configuration" if len(first.counts) > 1 else ""
    if first.index is None:
        return f"{names} holds the member, but {first.reason}."
    lead = f"{names}: first by {criterion}{worst}, {number(first.index)}{_equals(placement)}"
    others = placement.choices[1 + len(_as_good(placement)) :]
    rivals = [choice for choice in others[:1] if choice.controls and choice.index is not None]
    if not rivals:
        return f"{lead}; no other choice controls the member and has this number."
    return f"{lead}; next comes {listing(rivals[0].motors)} with {number(rivals[0].index or 0.0)}."


def _as_good(placement: Placement) -> list[MotorChoice]:
    """Choices that only their order in the list puts behind the first: mirror images, mostly."""
    place = placement.choices[0].place
    return [choice for choice in placement.choices[1:] if choice.place == place]


def _equals(placement: Placement) -> str:
    equal = _as_good(placement)
    if not equal:
        return ""
    named = "; ".join(", ".join(choice.motors) for choice in equal[:EQUALS])
    more = f" and {len(equal) - EQUALS} more" if len(equal) > EQUALS else ""
    return f" ({count_of(len(equal), 'other choice')} with the same number: {named}{more})"


def _why_none(placement: Placement) -> tuple[str, ...]:
    """Why no choice controls the member, as far as it can be told from all candidates together."""
    member, limit, fewest = repr(placement.looked.models[0].reference), placement.limit, placement.fewest
    looked = "admissible choice" if placement.exhaustive else "choice looked at"
    everything = f"motors on all {len(limit.motors)} candidates"
    none = f"No {looked} controls the member."
    if not limit.controls:
        ways = count_of(limit.largest("indeterminacy"), "way")
        return (f"{none} None can: even {everything} leave {member} loose in {ways}.", *limit.why)
    largest = placement.admissible.sizes[-1]
    if largest < fewest:
        motions, motors = count_of(fewest, "independent motion"), count_of(largest, "motor")
        words = (
            f"{none} {member} has {motions}, and a locked motor takes away one at most: {motors} cannot be "
            f"enough. Ask for {fewest} or more; {everything} hold it."
        )
        return (words,)
    return (f"{none} There are enough motors ({fewest} could do), and {everything} hold it: ask for more.",)


def _nearest(placement: Placement) -> str:
    first = placement.choices[0]
    value = "" if first.index is None else f", {CRITERIA[placement.rank_by]} {number(first.index)}"
    return f"Nearest comes {listing(first.motors)}: {first.reason}{value}{_equals(placement)}."


def _needed(placement: Placement) -> list[str]:
    """Joints without which no choice controls the member, beside those that were required anyway."""
    able = placement.controlling
    if not placement.exhaustive or len(able) < 2 or len(placement.choices) == len(able):
        return []
    common = set.intersection(*(set(choice.motors) for choice in able))
    return [name for name in placement.admissible.free if name in common]
