"""The keys of a sweep file, version 1, for pydantic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal

from pydantic import Discriminator, Field, PlainValidator, Tag, ValidationInfo, WithJsonSchema

from vincula.files.expressions import ExpressionError, evaluate, is_expression
from vincula.files.problems import shown
from vincula.files.schema_values import Name, Strict, Text, number_hint, refusal
from vincula.spatial.units import UNITS

LARGEST: Final = 1e30
"""Numbers above this are refused: their squares would overflow in every formula."""
_UNITS: Final = ("m", "mm", "cm", "in", "rad", "deg")


@dataclass(frozen=True, slots=True)
class Amount:
    """A number of a sweep file, until it is known what it is a number of.

    Attributes:
        value: The number; of an expression its value.
        unit: Its unit, empty where it is in the units of the model file.
    """

    value: float
    unit: str = ""

    def inside(self, what: Literal["m", "rad", "1", ""]) -> float | None:
        """The number in metres or radians; None when its unit does not belong there."""
        if not self.unit:
            return self.value
        size = UNITS["length" if what == "m" else "angle"].get(self.unit) if what in ("m", "rad") else None
        return None if size is None else self.value * size


def read_amount(value: Any, info: ValidationInfo) -> Amount:
    """A number, a number with a unit (`30deg`, `20 mm`) or an expression (`pi/6`)."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        result = Amount(float(value))
    elif isinstance(value, str) and is_expression(value):
        try:
            result = Amount(evaluate(value, {}).value)
        except ExpressionError as error:
            raise refusal(f"{shown(value)} ({error.reason})", "an expression with a finite value") from None
    elif isinstance(value, str) and (found := _with_unit(value)) is not None:
        result = found
    else:
        raise refusal(shown(value), _hint(value))
    if not abs(result.value) <= LARGEST:
        raise refusal(shown(value), f"a number of at most {LARGEST:g} in size")
    return result


def _hint(value: Any) -> str:
    hint = number_hint(value)
    return "a number, with a unit if wanted (0.5, 20mm, 30deg, pi/6)" if hint == "a number" else hint


def _with_unit(text: str) -> Amount | None:
    from vincula.files.tree import number

    for unit in sorted(_UNITS, key=len, reverse=True):
        if text.endswith(unit):
            found = number(text.removesuffix(unit).strip())
            return None if found is None else Amount(float(found), unit)
    return None


def read_whole(value: Any, info: ValidationInfo) -> int:
    """A whole number, 0 or more; `1e6` is one too."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value // 1 or value < 0:
        raise refusal(shown(value), "a whole number")
    if value > 1e15:
        raise refusal(shown(value), "a number of at most 1e15")
    return int(value)


def read_setting(value: Any) -> float | str:
    """A value for a parameter of the model, as `--set` takes it."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= LARGEST:
        raise refusal(shown(value), _hint(value))
    return float(value)


_AMOUNT: Final = {"anyOf": [{"type": "number"}, {"type": "string", "description": "30deg, 20mm, pi/6"}]}
Quantity = Annotated[Amount, PlainValidator(read_amount), WithJsonSchema(_AMOUNT)]
"""A number, with a unit if wanted."""
Whole = Annotated[int, PlainValidator(read_whole), WithJsonSchema({"type": "integer", "minimum": 0})]
"""A whole number."""
Setting = Annotated[
    float | str,
    PlainValidator(read_setting),
    WithJsonSchema(_AMOUNT),
]
"""A value for a parameter of the model."""


class RangeEntry(Strict):
    """Values of one variable: from, to, and their number or the step between them."""

    from_: Quantity = Field(alias="from")
    to: Quantity
    points: Whole | None = None
    step: Quantity | None = None


def _form(value: Any) -> str:
    return "table" if isinstance(value, dict) else "list"


Axis = Annotated[
    Annotated[list[Quantity], Field(min_length=1), Tag("list")] | Annotated[RangeEntry, Tag("table")],
    Discriminator(_form),
]
"""Values of one variable of a grid: a list, or a range."""

Bounds = Annotated[list[Quantity], Field(min_length=2, max_length=2)]
"""Lowest and highest value."""


class PathEntry(Strict):
    """Straight lines through waypoints."""

    through: Annotated[list[dict[Name, Quantity]], Field(min_length=2)]
    points: Whole


class RandomEntry(Strict):
    """Independent points over ranges."""

    ranges: Annotated[dict[Name, Bounds], Field(min_length=1)]
    points: Whole
    seed: Whole = 0


class LowDiscrepancyEntry(RandomEntry):
    """Points that fill ranges evenly."""

    sequence: Literal["sobol", "halton"] = "sobol"


Names = Annotated[
    Annotated[Text, Tag("text")] | Annotated[list[Text], Tag("list")],
    Discriminator(lambda value: "list" if isinstance(value, list) else "text"),
]
"""Names as one text with commas, or as a list."""


class SweepEntry(Strict):
    """A sweep file, version 1."""

    sweep: Literal[1]
    model: Text
    set: dict[Name, Setting] = Field(default_factory=dict)
    loops: list[Text] = Field(default_factory=list)
    active: Names | None = None
    lock: Names | None = None
    reference: Text | None = None
    axes: Literal["ground", "body"] | None = None
    ground: Text | None = None
    weights: Text | None = None
    tolerance: Text | None = None
    at: Text | None = None
    given: Literal["motors", "reference", "configuration"] | None = None
    grid: Annotated[dict[Name, Axis], Field(min_length=1)] | None = None
    path: PathEntry | None = None
    random: RandomEntry | None = None
    low_discrepancy: LowDiscrepancyEntry | None = Field(default=None, alias="low-discrepancy")
    table: Text | None = None
    quantities: Annotated[list[Text], Field(min_length=1)]
    chunk: Whole | Annotated[list[Whole], Field(min_length=1)] | None = None
    output: Text | None = None
    name: Name | None = None
