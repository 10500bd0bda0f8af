"""What an example of the catalog is: its name, its words, its parameters, and how it is built."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from vincula.errors import UnknownNameError
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.units import quantity

Builder = Callable[..., Mechanism]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A dimension of an example that may be changed.

    Attributes:
        name: Its name.
        default: Its default as a person would write it, with the unit: `1deg`, `2m`.
        dimension: `length` or `angle`.
        meaning: What it is.
    """

    name: str
    default: str
    dimension: Literal["length", "angle"]
    meaning: str

    @property
    def unit(self) -> str:
        """Unit of a value without one: m or rad."""
        return "m" if self.dimension == "length" else "rad"

    @property
    def value(self) -> float:
        """The default in m or rad."""
        return quantity(self.default, self.dimension, self.name)


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One example.

    Attributes:
        name: Name, as in `example:NAME`.
        title: A line.
        description: What it is, how it is held and driven, and what is worth seeing.
        parameters: What may be changed.
        reference: Where it comes from.
        build: Makes it; keyword arguments are the parameters in m and rad.
    """

    name: str
    title: str
    description: str
    reference: str
    build: Builder
    parameters: tuple[Parameter, ...] = ()

    def mechanism(self, values: Mapping[str, float | str]) -> Mechanism:
        """The example with some parameters at other values (numbers in m, rad; or texts with a unit).

        Raises:
            UnknownNameError: A parameter that it does not have.
            ModelError: A value that is no number, has a wrong unit, or cannot be built.
        """
        known = {parameter.name: parameter for parameter in self.parameters}
        for name in values:
            if name not in known:
                raise UnknownNameError(f"parameter of example {self.name!r}", name, known)
        numbers = {
            name: quantity(values.get(name, parameter.default), parameter.dimension, f"parameter {name!r}")
            for name, parameter in known.items()
        }
        return self.build(**numbers)
