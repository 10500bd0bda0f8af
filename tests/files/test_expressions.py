"""Expressions: the values of Python's own arithmetic, digits carried to first order, nothing evaluated."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import vincula as vc
from vincula.files.expressions import ExpressionError, Measured, evaluate
from vincula.files.problems import shown, suggestion
from vincula.files.tree import number

PARAMETERS = {"l": Measured(2.0), "r_1": Measured(0.5), "x": Measured(1.2346, 5e-5)}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("$l", 2.0),
        ("-$l/2", -1.0),
        ("$l - 1 - 1", 0.0),
        ("$l/2/2", 0.5),
        ("2+3*$l", 8.0),
        ("(2+3)*$l", 10.0),
        ("--$l", 2.0),
        ("$l*-1", -2.0),
        ("sin(pi/6)", math.sin(math.pi / 6)),
        ("sqrt($l)*cos(0)", math.sqrt(2)),
        ("tan(pi/4)", math.tan(math.pi / 4)),
        ("1.5e-3*$r_1", 7.5e-4),
        (".5*$l", 1.0),
    ],
)
def test_values(text: str, value: float) -> None:
    assert evaluate(text, PARAMETERS) == Measured(value)


REFUSED = (
    "", "$", "$l$l", "1 2", "2**3", "$l^2", "pi()", "sin 1", "sin()", "l", "$y", "1/0", "0/0*$l", "sqrt(-1)",
    "tan($l", "1e400", "1e308*10", "__import__('os')", "$l.real", "$l;1", "010", "1_0", "0x1", "٣",
    "lambda: 1",
    "(" * 70 + "1" + ")" * 70, "1" + "+1" * 600,
)  # fmt: skip


@pytest.mark.parametrize("text", REFUSED)
def test_refusals(text: str) -> None:
    with pytest.raises(ExpressionError) as refused:
        evaluate(text, PARAMETERS)
    assert str(refused.value).isprintable()


def test_digits_are_carried_to_first_order() -> None:
    step = 5e-5
    for text, slope in (
        ("2*$x", 2.0),
        ("$x*$x", 2 * 1.2346),
        ("1/$x", 1 / 1.2346**2),
        ("sin($x)", math.cos(1.2346)),
        ("cos($x)", math.sin(1.2346)),
        ("tan($x)", 1 + math.tan(1.2346) ** 2),
        ("sqrt($x)", 0.5 / math.sqrt(1.2346)),
        ("$x-$x/2", 1.5),  # errors add up: the worst case, not the exact one
    ):
        assert evaluate(text, PARAMETERS).half_unit == pytest.approx(slope * step, rel=1e-12)
    assert evaluate("0.12345*$l", PARAMETERS).half_unit == pytest.approx(1e-5)


def trees() -> st.SearchStrategy[str]:
    leaves = st.sampled_from(["1.5", "2", "0.25", "$l", "$r_1", "pi"])
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from(["+", "-", "*"]), inner).map(
                lambda t: f"({t[0]} {t[1]} {t[2]})"
            ),
            inner.map(lambda t: f"-{t}"),
            inner.map(lambda t: f"sin({t})"),
        ),
        max_leaves=12,
    )


@given(trees())
def test_as_python_computes(text: str) -> None:
    python = text.replace("$l", "2.0").replace("$r_1", "0.5")
    expected = eval(python, {"__builtins__": {}}, {"pi": math.pi, "sin": math.sin})
    assert evaluate(text, PARAMETERS).value == expected


@given(st.text(max_size=40))
def test_any_text_has_a_value_or_a_reason(text: str) -> None:
    value, reason = 0.0, ""
    try:
        value = evaluate(text, PARAMETERS).value
    except vc.ModelError as error:
        reason = str(error)
    assert math.isfinite(value)
    assert reason.isprintable()


@pytest.mark.parametrize(
    "text", ["1", "-1", "+1", "0", "1.", ".5", "-1.5e-3", "1e5", "1E+05", "00.5", "1e400"]
)
def test_numbers(text: str) -> None:
    found = number(text)
    assert (found is None) == (text == "00.5")
    assert found is None or float(found) == float(text)


@given(st.text(max_size=80))
def test_shown_texts_are_printable(text: str) -> None:
    assert shown(text).isprintable()
    assert len(shown("x" * 1000)) < 70
    suggestion(text, ["joints", "bodies"])
