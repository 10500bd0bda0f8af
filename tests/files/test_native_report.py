"""The load report of native files: counts, and notes on what is legal and odd."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR, write

from vincula.files.load import load_with_report

NOTES = {
    "no motors": (FIVE_BAR.replace("motors: [o1, o5]", ""), "no motor is named"),
    "all motors": (FIVE_BAR.replace("motors: [o1, o5]", "motors: [o1, o2, o3, o4, o5]"), ""),
    "no reference": (FIVE_BAR[: FIVE_BAR.index("reference:")], "candidates: crank, coupler, link, rocker"),
    "slip of the pen": (
        FIVE_BAR.replace("[crank, coupler]", "[cranc, coupler]"),
        "'cranc' is named once only",
    ),
    "millimetres among metres": (FIVE_BAR.replace("at: [0, 0]", "at: [1000, 0]"), "o3 is .* in another unit"),
    "coincident joints": (
        FIVE_BAR.replace(
            "motors:", "  - {name: o6, type: revolute, bodies: [link, coupler], at: [0, 0]}\nmotors:"
        ),
        "joints o3 and o6 connect the same bodies at the same place",
    ),
    "axis not unit": (
        """
vincula: 1
space: spatial
joints: [{name: a, type: revolute, bodies: [ground, b], at: [0, 0, 0], axis: [0, 0.5, 0.8]}]
""",
        "an axis of length 0.94",
    ),
}


@pytest.mark.parametrize("kind", NOTES)
def test_what_is_legal_and_odd_is_noted(kind: str, tmp_path: Path) -> None:
    text, expected = NOTES[kind]
    _, report = load_with_report(write(tmp_path, text))
    notes = "\n".join(report.notes)
    assert re.search(expected, notes) if expected else not notes


def test_the_report_counts_every_element(tmp_path: Path) -> None:
    mechanism, report = load_with_report(write(tmp_path, ALL_JOINTS))
    counts = report.counts()
    assert counts["joint"] == {"total": 10, "used": 10, "ignored": 0, "repaired": 0}
    assert {kind: count["total"] for kind, count in counts.items()} == {
        "body": 2,
        "frame": 1,
        "joint": 10,
        "contact": 2,
        "motor": 4,
        "setting": 2,
        "lock": 1,
        "reference": 1,
    }
    assert json.loads(json.dumps(report.to_dict()))["units"] == {"length": "m", "angle": "rad"}
    assert str(report).startswith(str(tmp_path))
    assert mechanism.name == "model"
