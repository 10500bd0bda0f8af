"""Damaged URDF and SDF files end in one of our errors, never in another exception or a standstill."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from tests.files.conventions import five_bar, four_bar
from tests.files.conventions.test_conventions import urdf

import vincula as vc
from vincula.files.sdf import load_sdf
from vincula.files.source import decode
from vincula.files.urdf import load_urdf

WORDS = (
    "nan", "-1", "1e300", "1e-300", "0", "", "<", ">", "<joint/>", "</joint>", "inf", "world", "__model__",
    "fixed", "ball", "universal", "screw", "planar", "floating", "base", "rocker", "o1", "1 2 3", "0 0 0",
    "é",
    "1 2 3 4 5 6 7", "99999999999", "name=", "&lt;", "<!-- -- -->", "<mimic joint='o1'/>", "1.6", "9",
)  # fmt: skip

TEXTS = {
    "URDF": [
        urdf(four_bar.TREE + "".join(four_bar.URDF.values())),
        *(urdf(four_bar.TREE + loop) for loop in four_bar.URDF.values()),
        *(urdf(five_bar.TREE + loop) for loop in five_bar.URDF.values()),
        urdf(four_bar.CONSTRUCTED["Drake distance"]),
    ],
    "SDF": [
        four_bar.SDF_GRAPH,
        four_bar.SDF_BALL.replace("<sdf", '<sdf xmlns:drake="d"'),
        five_bar.SDF,
    ],
}


def damaged(text: str, chance: random.Random) -> str:
    """A text with one value, piece or line exchanged, lost or doubled."""
    kind = chance.randrange(5)
    if kind == 0:
        at = chance.randrange(len(text))
        return text[:at] + chance.choice(WORDS) + text[at:]
    if kind == 1:
        value = chance.choice(list(re.finditer(r'"[^"]*"', text)))
        return f'{text[: value.start()]}"{chance.choice(WORDS).replace("<", "")}"{text[value.end() :]}'
    if kind == 2:
        value = chance.choice(list(re.finditer(r">[^<>]+<", text)))
        return f"{text[: value.start()]}>{chance.choice(WORDS).replace('<', '')}<{text[value.end() :]}"
    lines = text.splitlines()
    at = chance.randrange(len(lines))
    if kind == 3:
        return "\n".join(lines[:at] + lines[at + 1 :])
    lines.insert(chance.randrange(len(lines)), lines[at])
    return "\n".join(lines)


@pytest.mark.parametrize("kind", TEXTS)
def test_damaged_files_end_in_our_errors(kind: str) -> None:
    chance = random.Random(7)
    loaded = 0
    for _ in range(600):
        text = chance.choice(TEXTS[kind])
        for _ in range(chance.randrange(1, 4)):
            text = damaged(text, chance)
        try:
            source = decode(text.encode(), "robot.xml", Path("nowhere/robot.xml"))
            mechanism, _ = (load_urdf if kind == "URDF" else load_sdf)(source)
            mechanism.residuals()
            loaded += 1
        except vc.VinculaError:
            continue
        except Exception as error:
            raise AssertionError(f"{type(error).__name__}: {error}\n{text}") from error
    assert loaded > 50
