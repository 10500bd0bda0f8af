"""The page "the paper's numbers and ours" holds every number of the reference file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from tests.house.source import ROOT


def numbers(value: Any) -> Iterator[float]:
    """Every number in a nested value, `inf` written as text left out."""
    if isinstance(value, dict):
        for inner in value.values():
            yield from numbers(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from numbers(inner)
    elif isinstance(value, (int, float)):
        yield float(value)


def test_every_reference_number_is_on_the_page(paper: dict[str, Any]) -> None:
    text = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    shown = {float(found) for found in re.findall(r"-?\d+(?:\.\d+)?", text)}
    expected = list(numbers(paper["five_bar"]["zero_torque_wrench_printed"]))
    for name, design in paper["five_bar"].items():
        if name.startswith("motors"):
            expected += numbers({key: value for key, value in design.items() if key != "active"})
    stewart = paper["stewart"]
    expected += numbers([stewart["check"], stewart["printed_efficiencies"], stewart["printed_inverse_cost"]])
    assert len(expected) > 60
    assert not [value for value in expected if value not in shown]
