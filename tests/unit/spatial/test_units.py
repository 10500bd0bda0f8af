"""Quantities with units: every unit, every way of writing a number, and what is no quantity."""

from __future__ import annotations

import math

import pytest

from vincula.errors import ModelError, NonFiniteError
from vincula.spatial.units import quantity


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("2", "length", 2.0),
        ("2m", "length", 2.0),
        (" 20 mm ", "length", 0.02),
        ("-1.5cm", "length", -0.015),
        ("1in", "length", 0.0254),
        ("90deg", "angle", math.pi / 2),
        ("+.5rad", "angle", 0.5),
        ("1e-5", "length", 1e-5),
        ("1E3mm", "length", 1.0),
        ("3.", "number", 3.0),
        (0.25, "angle", 0.25),
        (3, "length", 3.0),
    ],
)  # fmt: skip
def test_quantities(text: str | float, dimension: str, value: float) -> None:
    assert quantity(text, dimension) == pytest.approx(value, rel=1e-15)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "dimension", "message"),
    [
        ("", "length", r"x is '': give a number, with a unit if wanted"),
        ("m", "length", "give a number"),
        ("1,5", "length", "give a number"),
        ("1_000", "length", "give a number"),
        ("0x10", "length", "give a number, with a unit|the unit 'x' is not"),
        ("١٢", "length", "give a number"),
        ("nan", "length", "give a number"),
        ("1 2", "length", "give a number"),
        ("1km", "length", "the unit 'km' is not one of m, mm, cm, in"),
        ("1mm", "angle", "the unit 'mm' is not one of rad, deg"),
        ("1m", "number", r"the unit 'm' is not one of \(none\)"),
        (True, "number", "x is True: give a number, or a text like '1.5'"),
    ],
)  # fmt: skip
def test_what_is_no_quantity(text: str | float, dimension: str, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        quantity(text, dimension, "x")  # type: ignore[arg-type]


@pytest.mark.parametrize("value", ["1e400", float("nan"), float("-inf")])
def test_only_finite_ones(value: str | float) -> None:
    with pytest.raises(NonFiniteError, match="height is"):
        quantity(value, "length", "height")
