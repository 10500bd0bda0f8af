"""A seeded search among choices of motors, where there are too many to look at every one.

From random choices of every size, motors are moved one at a time to joints without one as long as the choice
gets better; then again from another random choice, until so many different choices have been looked at.  The
best one of all need not be among them: whoever reports the result says that it was a search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import comb
from typing import Final

import numpy as np

from vincula.design.admissible import Admissible

Choice = tuple[str, ...]
Place = tuple[float, ...]
"""Key of a choice; smaller is better."""
STALE: Final = 1000
"""Random choices in a row that were all seen before, after which a size counts as looked through."""


def searched(admissible: Admissible, place: Callable[[Choice], Place], budget: int, seed: int) -> None:
    """Look at up to `budget` choices, those of few motors first where there are few of them.

    Args:
        admissible: The choices.
        place: Looks at a choice and gives its key.
        budget: Number of different choices to look at.
        seed: Seed of the random choices; the same seed looks at the same choices.
    """
    walk = _Walk(admissible, place, np.random.default_rng(seed))
    sizes = sorted(admissible.sizes, key=lambda size: _choices(admissible, size))
    for position, size in enumerate(sizes):
        share = (budget - len(walk.seen)) // (len(sizes) - position)
        if _choices(admissible, size) <= share:
            for choice in admissible.of_size(size):
                walk.look(choice)
        else:
            walk.climb(size, len(walk.seen) + share)


def _choices(admissible: Admissible, size: int) -> int:
    return comb(len(admissible.free), size - len(admissible.required))


@dataclass(eq=False)
class _Walk:
    """The choices seen so far."""

    admissible: Admissible
    place: Callable[[Choice], Place]
    random: np.random.Generator
    seen: dict[Choice, Place] = field(default_factory=dict)

    def look(self, choice: Choice) -> Place:
        """The key of a choice, asked for once."""
        if choice not in self.seen:
            self.seen[choice] = self.place(choice)
        return self.seen[choice]

    def climb(self, size: int, limit: int) -> None:
        """Climb from random choices until `limit` choices have been seen."""
        free = self.admissible.free
        count = size - len(self.admissible.required)
        stale = 0
        while len(self.seen) < limit and stale < STALE:
            chosen = {free[k] for k in self.random.choice(len(free), size=count, replace=False)}
            start = self.admissible.ordered(chosen)
            if start in self.seen:
                stale += 1
                continue
            stale, best = 0, self.look(start)
            better = True
            while better and len(self.seen) < limit:
                better, chosen, best = self._step(chosen, best, limit)

    def _step(self, chosen: set[str], best: Place, limit: int) -> tuple[bool, set[str], Place]:
        """The first exchange of one motor that makes a choice better, in random order."""
        idle = [name for name in self.admissible.free if name not in chosen]
        pairs = [(out, into) for out in sorted(chosen) for into in idle]
        for k in self.random.permutation(len(pairs)):
            out, into = pairs[k]
            other = (chosen - {out}) | {into}
            key = self.look(self.admissible.ordered(other))
            if key < best:
                return True, other, key
            if len(self.seen) >= limit:
                break
        return False, chosen, best
