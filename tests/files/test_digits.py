"""Half a unit of the last typed digit."""

from __future__ import annotations

import pytest

from vincula.files.digits import half_unit, is_number

ROUNDED = {
    "1.5708": 5e-5,
    "-1.57080": 5e-6,
    "+.70711": 5e-6,
    "0.02645": 5e-6,
    "1.2345e-3": 5e-8,
    "1.2345E+2": 5e-3,
    "0.7071067811865476": 5e-17,
    "1.0000": 5e-5,
}
EXACT = ("1", "-2.", "1.57", "0.0061", "0.001", "0.0000", "26.45", "1e-5", "12345.678", "1.2345e-400")


@pytest.mark.parametrize("text", ROUNDED)
def test_rounded_numbers(text: str) -> None:
    assert half_unit(text) == pytest.approx(ROUNDED[text], rel=1e-12)


@pytest.mark.parametrize("text", EXACT)
def test_numbers_taken_as_exact(text: str) -> None:
    assert half_unit(text) == 0.0


def test_millimetres_and_metres() -> None:
    assert half_unit("30.6011") * 1e-3 == pytest.approx(half_unit("0.0306011"), rel=1e-12)
    assert half_unit("6.1") == half_unit("0.0061") == 0.0


@pytest.mark.parametrize("text", ["1", "+1.5", "-.5", "5.", "1e5", "1E-5", "010"])
def test_numbers(text: str) -> None:
    assert is_number(text)


@pytest.mark.parametrize(
    "text", ["", ".", "1,5", "0x10", "1_000", "nan", "inf", "1e", "e5", "١", "12:30", "1 2", "--1"]
)
def test_no_numbers(text: str) -> None:
    assert not is_number(text)


def test_directions_need_no_significant_digits() -> None:
    # A length of 0.00001 may be meant exactly; beside 1.0000 it is a rounded direction.
    assert half_unit("0.00001") == 0.0
    assert half_unit("0.00001", length=False) == pytest.approx(5e-6, rel=1e-12)
    assert half_unit("0.0000", length=False) == pytest.approx(5e-5, rel=1e-12)
    assert half_unit("1.57", length=False) == 0.0
