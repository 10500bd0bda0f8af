"""The list of examples, and how to get one by name."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

from vincula.errors import UnknownNameError

if TYPE_CHECKING:
    from vincula.mechanism.catalog.entry import Entry
    from vincula.mechanism.mechanism import Mechanism

MODULES: Final = {
    "five-bar": "five_bar",
    "stewart": "stewart",
    "stewart-spherical": "stewart_spherical",
    "four-bar-2a": "four_bar_2a",
    "four-bar-2c": "four_bar_2c",
    "slider-crank": "slider_crank",
    "3rrr": "three_rrr",
    "delta": "delta",
    "serial-2r": "serial_2r",
    "serial-7r": "serial_7r",
    "two-arms": "two_arms",
    "two-finger-grasp": "two_finger_grasp",
    "three-finger-grasp": "three_finger_grasp",
    "quadruped": "quadruped",
    "mixed": "mixed",
    "telescope": "telescope",
}
"""File of every example, by name; only the one asked for is imported."""


def entry(name: str) -> Entry:
    """What there is to know about one example.

    Raises:
        UnknownNameError: No such example.
    """
    if name not in MODULES:
        raise UnknownNameError("example", name, MODULES)
    found: Entry = import_module(f"{__package__}.{MODULES[name]}").ENTRY
    return found


def examples() -> tuple[Entry, ...]:
    """All examples: names, titles, descriptions, parameters, references."""
    return tuple(entry(name) for name in MODULES)


def example(name: str, **parameters: float | str) -> Mechanism:
    """A known mechanism from the catalog.

    Args:
        name: Name of the example; `examples()` lists them.
        **parameters: Dimensions to change: numbers in m and rad, or texts with a unit (`"1deg"`).

    Raises:
        UnknownNameError: No such example or parameter.
        ModelError: A value that cannot be used.
    """
    return entry(name).mechanism(parameters)
