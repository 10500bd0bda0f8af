"""What a ranking of motor choices says, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vincula.analysis.ranking import CRITERIA
from vincula.analysis.wording import count_of, number
from vincula.errors import listing

if TYPE_CHECKING:
    from vincula.design.placement import Placement


def explanation(placement: Placement) -> tuple[str, ...]:
    """Why the best choice is the best; where no choice controls the member, which comes nearest."""
    first = placement.choices[0]
    names = listing(first.motors)
    if not first.controls:
        looked = "admissible choice" if placement.exhaustive else "choice looked at"
        return (
            f"No {looked} controls the member. Nearest, by the ranking, comes {names}: {first.reason}.",
            *first.why,
        )
    said = [_lead(placement, names)]
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


def _lead(placement: Placement, names: str) -> str:
    first, criterion = placement.choices[0], CRITERIA[placement.rank_by]
    worst = " at its worst configuration" if len(first.counts) > 1 else ""
    if first.index is None:
        return f"{names} holds the member, but {first.reason}."
    lead = f"{names}: first by {criterion}{worst}, {number(first.index)}"
    rivals = [choice for choice in placement.choices[1:2] if choice.controls and choice.index is not None]
    if not rivals:
        return f"{lead}; no other choice controls the member and has this number."
    second = rivals[0]
    return f"{lead}; next comes {listing(second.motors)} with {number(second.index or 0.0)}."


def _needed(placement: Placement) -> list[str]:
    """Joints without which no choice controls the member, beside those that were required anyway."""
    able = placement.controlling
    if not placement.exhaustive or len(able) < 2 or len(placement.choices) == len(able):
        return []
    common = set.intersection(*(set(choice.motors) for choice in able))
    return [name for name in placement.admissible.free if name in common]
