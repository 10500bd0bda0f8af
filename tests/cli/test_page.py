"""Numbers, vectors and tables as a terminal shows them."""

from __future__ import annotations

import math

import pytest

from vincula.cli.page import Column, Page, Table, combination, number, plural, point


@pytest.mark.parametrize(
    ("value", "text"),
    [(9.736466, "9.7365"), (0.0, "0"), (-0.0, "0"), (math.inf, "inf"), (-math.inf, "-inf"), (1e-20, "1e-20")],
)
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text


def test_undefined_is_a_dash() -> None:
    assert number(math.nan) == "-"


def test_vectors_are_sums_over_their_components() -> None:
    assert combination([0.0, 0.8944, -0.4472], ["fx", "fy", "mz"]) == "0.894 fy - 0.447 mz"
    assert combination([-1.0, 2e-5, 0.5], ["a", "b", "c"]) == "-1 a + 0.5 c"
    assert combination([0.0, 0.0], ["a", "b"]) == "0"
    assert combination([], []) == "0"


def test_long_sums_break_between_terms_only() -> None:
    text = combination([0.123, -0.456, 0.789], ["alpha", "beta", "gamma"], width=14)
    assert text.splitlines() == ["0.123 alpha", "- 0.456 beta", "+ 0.789 gamma"]


def test_very_long_sums_are_counted() -> None:
    assert combination([1.0] * 20, [f"q{i}" for i in range(20)], most=2) == "1 q0 + 1 q1 ... (18 more)"


def test_points_and_counts() -> None:
    assert point([-0.5, 0.0]) == "(-0.5, 0)"
    assert [plural(n, "loop") for n in (0, 1, 2)] == ["no loops", "1 loop", "2 loops"]


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    def show(page: Page, width: int = 60) -> str:
        monkeypatch.setenv("COLUMNS", str(width))
        page.show()
        return capsys.readouterr().out

    return show


def test_sentences_wrap_under_their_mark(shown) -> None:
    page = Page()
    page.sentence("one two three four", "note:")
    assert shown(page, 20) == "  note: one two\n        three four\n"


def test_the_first_table_that_fits_is_taken(shown) -> None:
    wide = Table([Column("a" * 50)], [["x"]])
    narrow = Table([Column("b")], [["x"]])
    page = Page()
    page.table(wide, narrow)
    assert "a" * 50 in shown(page, 60)
    assert "a" not in shown(page, 40)


def test_names_are_not_taken_for_markup_or_emoji(shown) -> None:
    page = Page()
    page.heading("[red]robot[/red]", ":smile:")
    page.facts([("label", "[b]x[/b]"), ("left out", "")])
    page.table(Table([Column("[i]h[/i]")], [["[u]cell[/u]"]]))
    text = shown(page)
    for part in ("[red]robot[/red]", ":smile:", "[b]x[/b]", "[i]h[/i]", "[u]cell[/u]"):
        assert part in text
    assert "left out" not in text


def test_no_blanks_at_line_ends_and_no_colour_in_a_pipe(shown) -> None:
    page = Page()
    page.heading("Title", "note")
    page.table(Table([Column("a"), Column("b", fold=True)], [["1", "word " * 30]]))
    text = shown(page, 40)
    assert all(line == line.rstrip() for line in text.splitlines())
    assert "\x1b" not in text
    assert max(map(len, text.splitlines())) <= 40
