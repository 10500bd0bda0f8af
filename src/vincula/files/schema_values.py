"""The values of a native file as pydantic reads them: numbers with their digits, names, places.

Numbers keep how they were typed, may be expressions in the file's parameters, and are refused with a
reason when they are no plain decimal numbers.  The context of a validation is a `Context`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Final

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationInfo,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError

from vincula.files.expressions import ExpressionError, Measured, evaluate, is_expression
from vincula.files.limits import DEFAULT_LIMITS, LARGEST_NUMBER, Limits
from vincula.files.names import name_problem
from vincula.files.problems import shown
from vincula.traced import holds_traced

_LONGEST_TEXT: Final = 2_000


@dataclass(frozen=True, slots=True)
class Context:
    """What values are checked against.

    Attributes:
        parameters: Values of the parameters that expressions may use.
        translations: Coordinates of a point: 2 in the plane, 3 in space, None while unknown.
        limits: Limits of the file.
    """

    parameters: Mapping[str, Measured] = field(default_factory=dict)
    translations: int | None = None
    limits: Limits = DEFAULT_LIMITS


def refusal(got: str, expected: str) -> PydanticCustomError:
    """An error of ours in pydantic's clothes; read back by `schema_problems`."""
    # Braces of the file's own text must not be taken for placeholders, hence the context.
    context = {"got": got, "expected": expected}
    return PydanticCustomError("vincula", "got {got}, expected {expected}", context)


def _context(info: ValidationInfo) -> Context:
    return info.context if isinstance(info.context, Context) else Context()


def read_number(value: Any, info: ValidationInfo) -> Measured:
    """A number from a number or an expression."""
    context = _context(info)
    if isinstance(value, str) and is_expression(value):
        try:
            result = evaluate(value, context.parameters)
        except ExpressionError as error:
            raise refusal(f"{shown(value)} ({error.reason})", "an expression with a finite value") from None
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        result = Measured(
            float(value), getattr(value, "half_unit", 0.0), getattr(value, "angular_half_unit", 0.0)
        )
    elif holds_traced(value):
        result = Measured(value, computed=True)
    else:
        raise refusal(shown(value), number_hint(value))
    if not abs(result.value) <= LARGEST_NUMBER:
        raise refusal(shown(value), f"a number of at most {LARGEST_NUMBER:g} in size")
    return result


_HINTS: Final = (
    (r"[-+]?0[0-9]+(\.[0-9]*)?", "a number without leading zeros (programs disagree about octal)"),
    (r"[-+]?0[xXoObB][0-9a-fA-F]+", "a decimal number"),
    (r"[-+]?[0-9]+(_[0-9]+)+(\.[0-9]*)?", "a number without underscores"),
    (r"[-+]?[0-9]+,[0-9]+", "a number with a decimal point, not a comma"),
    (r"[0-9]+(:[0-9]+)+(\.[0-9]*)?", "a number; sexagesimal numbers are not read"),
    (r"[-+]?\.?(inf|infinity|nan)", "a finite number"),
    (r"[-+]?[0-9.]+([eE][-+]?[0-9]+)?\s*(m|mm|cm|in|rad|deg)", "a number; units stand in `units`"),
    (r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?", "a number without quotes"),
)


def number_hint(value: Any) -> str:
    """What was expected instead of something that is no number, as precisely as can be said."""
    if isinstance(value, str):
        for pattern, expected in _HINTS:
            if re.fullmatch(pattern, value, re.ASCII | re.IGNORECASE):
                return expected
        if value and any(c.isdigit() and not c.isascii() for c in value):
            return "a number in the digits 0 to 9"
    return "a number"


def read_name(value: Any, info: ValidationInfo) -> str:
    """A printable, non-empty name."""
    if not isinstance(value, str):
        raise refusal(shown(value), "a name; put it in quotes if it looks like a number")
    expected = name_problem(value, _context(info).limits)
    if expected:
        raise refusal(shown(value), expected)
    return value


def read_text(value: Any, info: ValidationInfo) -> str:
    """A sentence: printable, of a few lines at most."""
    if not isinstance(value, str):
        raise refusal(shown(value), "a text")
    if len(value) > _LONGEST_TEXT or not value.isprintable():
        raise refusal(shown(value), f"a printable text of at most {_LONGEST_TEXT} characters")
    return value


def _right_count(values: list[Measured], info: ValidationInfo) -> list[Measured]:
    count = _context(info).translations
    if count is not None and len(values) != count:
        where = "in the plane" if count == 2 else "in space"
        raise refusal(f"{len(values)} numbers", f"{count} {where}")
    return values


_NUMBER_SCHEMA: Final = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "description": "an expression in parameters, such as $l/2 or 2*pi/3"},
    ]
}

Number = Annotated[Measured, PlainValidator(read_number), WithJsonSchema(_NUMBER_SCHEMA)]
"""A finite number, or an expression with a finite value."""

Name = Annotated[str, PlainValidator(read_name), WithJsonSchema({"type": "string", "minLength": 1})]
"""A printable, non-empty name."""

Text = Annotated[str, PlainValidator(read_text), WithJsonSchema({"type": "string"})]
"""A printable sentence."""

Vector = Annotated[list[Number], Field(min_length=2, max_length=3), AfterValidator(_right_count)]
"""Coordinates: two in the plane, three in space."""


class Strict(BaseModel):
    """A table whose keys are all known."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class PlacedVector(Strict):
    """Coordinates in the axes of a body or named frame."""

    frame: Name = Field(alias="in")
    xyz: Vector


def _form(value: Any) -> str:
    return "table" if isinstance(value, dict) else "list"


Placed = Annotated[
    Annotated[Vector, Tag("list")] | Annotated[PlacedVector, Tag("table")],
    Discriminator(_form),
]
"""A position or direction: coordinates in ground axes, or `{in: BODY or frame, xyz: [...]}`."""


def mentions_traced(entry: object) -> bool:
    """Whether there are traced numbers anywhere in an entry."""
    if isinstance(entry, BaseModel):
        return any(mentions_traced(part) for part in vars(entry).values())
    if isinstance(entry, Mapping):
        return any(mentions_traced(part) for part in entry.values())
    if isinstance(entry, (list, tuple)):
        return any(mentions_traced(part) for part in entry)
    return isinstance(entry, Measured) and holds_traced((entry.value, entry.half_unit))
