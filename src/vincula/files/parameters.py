"""Parameters of a native file: declared numbers that `--set` and `vincula.load` may change."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from vincula.errors import ModelError
from vincula.files.digits import half_unit, is_number
from vincula.files.expressions import ExpressionError, Measured, evaluate, is_expression
from vincula.files.problems import shown
from vincula.files.schema_values import number_hint
from vincula.files.tree import Document, Leaf, Table
from vincula.files.units import Units
from vincula.spatial.units import quantity
from vincula.traced import holds_traced

_USABLE: Final = re.compile("[A-Za-z_][A-Za-z0-9_]*")

Settings = Mapping[str, float | str]
"""New values by parameter name: numbers in the units of the file, or texts with a unit (`1deg`)."""


def declared(document: Document) -> tuple[str, ...]:
    """Names of the parameters that a file declares."""
    table = document.node(["parameters"])
    return tuple(table.entries) if isinstance(table, Table) else ()


def parameter_values(document: Document, settings: Settings, units: Units) -> dict[str, Measured]:
    """Values of all parameters, in the units of the file.

    A parameter may be an expression in those declared before it.  What cannot be read is added to
    the problems of the document and stands for 1, so that one mistake is told once.

    Raises:
        ModelError: A setting that is no number.
    """
    table = document.node(["parameters"])
    values: dict[str, Measured] = {}
    for name, node in table.entries.items() if isinstance(table, Table) else ():
        if not _USABLE.fullmatch(name):
            place = document.place(["parameters", name], at_key=True)
            document.problems.add(
                place, got=shown(name), expected="letters, digits and _ in the name of a parameter"
            )
        if name in settings:
            values[name] = setting(settings[name], units, f"parameter {name!r}", values)
            continue
        values[name] = Measured(1.0)
        given = node.value if isinstance(node, Leaf) else None
        if isinstance(given, str) and is_expression(given):
            others = {other: value for other, value in values.items() if other != name}
            try:
                values[name] = evaluate(given, others)
            except ExpressionError as error:
                document.problems.add(
                    document.place(["parameters", name]),
                    got=f"{shown(given)} ({error.reason})",
                    expected="an expression in parameters declared before it",
                )
        elif isinstance(given, (int, float)) and not isinstance(given, bool):
            values[name] = Measured(float(given), getattr(given, "half_unit", 0.0))
    return values


def setting(given: float | str, units: Units, what: str, known: Mapping[str, Measured]) -> Measured:
    """A number from outside of the file, in the units of the file.

    Args:
        given: A number, a text with or without a unit, or an expression.
        units: Units of the file.
        what: What it is, for messages.
        known: Parameters that an expression may use.

    Raises:
        ModelError: None of these.
    """
    if holds_traced(given):
        number: Any = given
        return Measured(number, computed=True)
    if not isinstance(given, str):
        return Measured(quantity(given, "number", what))
    text = given.strip()
    if is_number(text):
        return Measured(quantity(text, "number", what), half_unit(text))
    if is_expression(text):
        return evaluate(text, known)
    dimension = "angle" if text.endswith(("rad", "deg")) else "length"
    linear = dimension == "length"
    try:
        value = quantity(text, "length" if linear else "angle", what)
    except ModelError as error:
        hint = number_hint(text)
        raise ModelError(
            f"{error}" if hint == "a number" else f"{what} is {text!r}: expected {hint}"
        ) from None
    return Measured(value / units.size(linear))
