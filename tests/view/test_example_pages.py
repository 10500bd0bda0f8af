"""The pages of the examples say what the library says now."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

from vincula.mechanism.catalog.registry import MODULES, entry

pytest.importorskip("matplotlib")

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


@pytest.fixture(scope="module")
def maker(root: Path) -> ModuleType:
    """The script that writes the pages, as a module."""
    spec = importlib.util.spec_from_file_location("make_examples", root / "docs" / "make_examples.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def words_and_numbers(line: str) -> tuple[str, list[float]]:
    return NUMBER.sub("#", line), [float(found) for found in NUMBER.findall(line)]


def agree(committed: str, current: str) -> list[str]:
    """Lines that differ in words, or in numbers by more than their last printed digit."""
    old, new = committed.splitlines(), current.splitlines()
    wrong = [f"{len(old)} lines, now {len(new)}"] if len(old) != len(new) else []
    for one, other in zip(old, new, strict=False):
        (words, numbers), (now, values) = words_and_numbers(one), words_and_numbers(other)
        if words != now or values != pytest.approx(numbers, rel=2e-3, abs=1e-9):
            wrong.append(f"{one!r} is now {other!r}")
    return wrong


@pytest.mark.parametrize("name", MODULES)
def test_a_page_is_current(root: Path, maker: ModuleType, name: str) -> None:
    committed = (root / "docs" / "examples" / f"{name}.md").read_text(encoding="utf-8")
    assert not agree(committed, maker.page(entry(name))), "run: python docs/make_examples.py"


def test_the_index_is_current_and_nothing_is_left_over(root: Path, maker: ModuleType) -> None:
    pages = root / "docs" / "examples"
    assert (pages / "README.md").read_text(encoding="utf-8") == maker.index()
    assert {path.stem for path in pages.glob("*.md")} == {*MODULES, "README"}


def test_every_figure_that_a_page_shows_is_there(root: Path) -> None:
    shown = set()
    for path in [root / "README.md", *(root / "docs").rglob("*.md")]:
        for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
            figure = (path.parent / target).resolve()
            assert figure.is_file()
            assert figure.read_text(encoding="utf-8").startswith("<?xml")
            shown.add(figure)
    assert shown == set((root / "docs" / "figures").glob("*.svg"))


def test_pages_tell_the_paper_s_efficiencies(root: Path) -> None:
    text = (root / "docs" / "examples" / "five-bar.md").read_text(encoding="utf-8")
    assert "| kinematic (KME) | 9.736, 0.5135 |" in text
    assert "| passive force (PFME) | inf, 1.947, 0.1027 |" in text


def test_a_page_that_lies_is_noticed() -> None:
    assert agree("a = 1.234, x\n", "a = 1.2339, x\n") == []
    assert agree("a = 1.234, x\n", "a = 1.334, x\n")
    assert agree("a = 1.234, x\n", "a = 1.234, y\n")
    assert agree("a\nb\n", "a\n")
