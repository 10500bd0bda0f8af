"""Which choices of motors are admissible: candidates, forbidden and required axes, numbers, costs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from vincula.errors import ModelError, UnknownNameError, listing
from vincula.mechanism.names import free_axes

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.model import LinearModel

Sizes = int | range | Iterable[int]
"""How many motors: a number, or several."""
Names = Iterable[str] | str
"""Names of joints, joint axes or motors, as a list or as a text with commas."""


@dataclass(frozen=True, slots=True)
class Admissible:
    """The choices of motors that may be made.

    Attributes:
        candidates: Names of the axes (and of motors that drive several axes) that may carry a motor.
        required: Those that every choice has.
        sizes: Numbers of motors, ascending.
        cost: Cost by candidate.
    """

    candidates: tuple[str, ...]
    required: tuple[str, ...]
    sizes: tuple[int, ...]
    cost: Mapping[str, float]

    @staticmethod
    def of_mechanism(
        mechanism: Mechanism,
        motors: Sizes,
        forbid: Names = (),
        require: Names = (),
        cost: Mapping[str, float] | None = None,
    ) -> Admissible:
        """Choices among every unlocked joint axis that is not part of a free joint, and the file's drives.

        Args:
            mechanism: The mechanism; its own motors do not matter.
            motors: Numbers of motors.
            forbid: Joints, axes or motors that get none.
            require: Joints, axes or motors that every choice has; axes of a free joint only if named here.
            cost: Cost of a motor by joint, axis or motor name; 1 for the others.

        Raises:
            UnknownNameError: A name that does not exist.
            ModelError: No motors, more than there are joint axes, a name forbidden and required, a bad cost.
        """
        refused = mechanism.resolve_motors(forbid)
        wanted = mechanism.resolve_motors(require)
        locked = [name for name in wanted if name in mechanism.lock]
        if locked:
            raise ModelError(f"{listing(locked)}: required as motor and locked at once")
        drives = (drive.name for drive in mechanism.drives)
        everything = dict.fromkeys([*free_axes(mechanism), *drives, *wanted])
        costs: dict[str, float] = {}
        for name, value in (cost or {}).items():
            costs |= dict.fromkeys(mechanism.resolve_motors((name,)), value)
        return _checked(tuple(everything), motors, refused, wanted, costs)

    @staticmethod
    def of_model(
        model: LinearModel,
        motors: Sizes,
        forbid: Names = (),
        require: Names = (),
        cost: Mapping[str, float] | None = None,
    ) -> Admissible:
        """Choices among all columns of a model; arguments and errors as for `of_mechanism`."""
        refused, wanted = _columns(model, forbid), _columns(model, require)
        costs: dict[str, float] = {}
        for name, value in (cost or {}).items():
            costs |= dict.fromkeys(_columns(model, (name,)), value)
        return _checked(tuple(column.name for column in model.columns), motors, refused, wanted, costs)

    @property
    def free(self) -> tuple[str, ...]:
        """Candidates that a choice may have or not."""
        return tuple(name for name in self.candidates if name not in self.required)

    @property
    def count(self) -> int:
        """Number of admissible choices."""
        return sum(math.comb(len(self.free), size - len(self.required)) for size in self.sizes)

    def of_size(self, size: int) -> Iterator[tuple[str, ...]]:
        """Every choice of that many motors, in the order of the candidates."""
        for chosen in combinations(self.free, size - len(self.required)):
            yield self.ordered(chosen)

    def ordered(self, chosen: Iterable[str]) -> tuple[str, ...]:
        """The required motors and these, in the order of the candidates."""
        wanted = {*chosen, *self.required}
        return tuple(name for name in self.candidates if name in wanted)

    def cost_of(self, choice: Iterable[str]) -> float:
        """What the motors of a choice cost together."""
        return math.fsum(self.cost[name] for name in choice)


def _columns(model: LinearModel, names: Names) -> tuple[str, ...]:
    """Columns of a model by their own names or those of their joints."""
    found: dict[str, None] = {}
    for name in [part.strip() for part in names.split(",")] if isinstance(names, str) else names:
        own = [column.name for column in model.columns if name in (column.name, column.joint)]
        if not own:
            raise UnknownNameError("joint axis or motor", name, [column.name for column in model.columns])
        found |= dict.fromkeys([name] if name in own else own)
    return tuple(found)


def _checked(
    everything: Sequence[str],
    motors: Sizes,
    forbidden: Sequence[str],
    required: Sequence[str],
    costs: Mapping[str, float],
) -> Admissible:
    both = [name for name in required if name in forbidden]
    if both:
        raise ModelError(f"{listing(both)}: forbidden and required at once; drop it from one of the two")
    candidates = tuple(name for name in everything if name not in forbidden)
    sizes = _sizes(motors)
    if sizes[-1] > len(candidates):
        left = f" after {listing(forbidden)} {'is' if len(forbidden) == 1 else 'are'} forbidden"
        raise ModelError(
            f"{sizes[-1]} motors, and only {len(candidates)} joint axes that can carry one"
            f"{left if forbidden else ''}: {listing(candidates)}"
        )
    if sizes[0] < len(required):
        raise ModelError(
            f"{sizes[0]} motor{'' if sizes[0] == 1 else 's'}, and {len(required)} are required "
            f"({listing(required)}): ask for more motors or require fewer"
        )
    return Admissible(candidates, tuple(required), sizes, {n: _cost(n, costs) for n in candidates})


def _sizes(motors: Sizes) -> tuple[int, ...]:
    numbers = [motors] if isinstance(motors, int) or not isinstance(motors, Iterable) else list(motors)
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise ModelError(f"motors is {number!r}: give a whole number of motors, 1 or more")
    if not numbers:
        raise ModelError("motors is empty: give a whole number of motors, 1 or more")
    return tuple(sorted(set(numbers)))


def _cost(name: str, costs: Mapping[str, float]) -> float:
    value = costs.get(name, 1.0)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < math.inf:
        raise ModelError(f"cost of {name!r} is {value!r}: give a finite number, 0 or more")
    return float(value)
