"""The page on the command line names every JSON key, exit code and criterion, and no other."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

from vincula.design.linkages import five_bar

COMMANDS = {
    "analyze": ["analyze", "example:five-bar"],
    "compare": ["compare", "example:five-bar", "--active", "all"],
    "place": ["place", "example:five-bar", "--motors", "2"],
    "close": ["close", "example:five-bar"],
    "follow": ["follow", "example:five-bar", "--to", "o1=-0.1"],
    "inspect": ["inspect", "example:five-bar"],
}


@pytest.fixture(scope="module")
def page(root: Path) -> str:
    return (root / "docs" / "command-line.md").read_text(encoding="utf-8")


def table(page: str, title: str) -> list[list[str]]:
    """Cells of the rows of the table below a title."""
    lines = page[page.index(title) :].splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("|"))
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


@pytest.mark.parametrize("command", COMMANDS)
def test_top_level_keys(run_json, page: str, command: str) -> None:
    found = run_json(*COMMANDS[command])
    assert f"(`{found['schema']}`)" in page
    documented = {
        key for cells in table(page, f"**`{command}`**") for key in re.findall(r"`(\w+)`", cells[0])
    }
    assert documented == set(found) - {"schema"}


def test_keys_of_designs(page: str) -> None:
    """Of the three kinds together; one design each is enough."""
    import vincula as vc
    from vincula.design.measures import Index

    small = {
        "path": "reference",
        "weights": vc.Weights(twist=[1.0, 1.0, 0.0]),
        "variables": [vc.DesignVariable("near", 0.2, 0.3)],
    }
    even, fast = Index(quantity="kinematic.condition:translation"), Index(quantity="kinematic.smallest")
    one = vc.DesignProblem(five_bar, objectives=even, **small)
    found = [one.optimize(population=5, generations=1, polish=False), one.scan("near", counts=2)]
    if importlib.util.find_spec("pymoo") is not None:
        two = vc.DesignProblem(five_bar, objectives=[even, fast], **small)
        found.append(two.front(population=4, generations=1))
    documented = {key for cells in table(page, "**`design`**") for key in re.findall(r"`(\w+)`", cells[0])}
    keys = {key for one in found for key in one.to_dict()} - {"schema"}
    assert keys <= documented
    if len(found) == 3:
        assert keys == documented


def test_keys_of_the_short_objects(run_json, page: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for command, words in {
        "examples": ["examples", "five-bar"],
        "plot": ["plot", "example:five-bar", "-o", str(tmp_path / "x.svg")],
        "convert": ["convert", "example:five-bar", str(tmp_path / "x.yaml")],
    }.items():
        found = run_json(*words)
        line = next(
            line for line in page.splitlines() if line.startswith(f"**`{command}`** (`{found['schema']}`)")
        )
        assert set(found) - {"schema"} <= set(re.findall(r"`(\w+)`", line))


def test_exit_codes(page: str) -> None:
    from vincula.cli import exits

    documented = {int(cells[0]) for cells in table(page, "## Exit codes")}
    assert documented == {
        value for name, value in vars(exits).items() if name.isupper() and isinstance(value, int)
    }


def test_criteria(page: str) -> None:
    from vincula.analysis.ranking import CRITERIA

    (row,) = (cells for cells in table(page, "## What FILE") if cells[0].startswith("`--rank-by"))
    assert set(CRITERIA) <= set(re.findall(r"`([\w-]+)`", row[1]))
