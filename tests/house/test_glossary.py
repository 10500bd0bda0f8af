"""Every code name in the glossary exists, so that the table cannot drift from the code."""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path
from typing import Any

from tests.house.source import ROOT

PAGE = ROOT / "docs" / "glossary.md"


def code_names(page: Path) -> list[str]:
    """Dotted names in backticks in the last column of every table row."""
    names = []
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("|"):
            last = line.strip().strip("|").split("|")[-1]
            names += re.findall(r"`(vincula\.[\w.]+)`", last)
    return names


def exists(dotted: str) -> bool:
    """Whether a dotted name leads to a module, a definition, a field or a parameter."""
    parts = dotted.split(".")
    value: Any = importlib.import_module(parts[0])
    for at, part in enumerate(parts[1:], start=2):
        if inspect.ismodule(value) and not hasattr(value, part):
            try:
                value = importlib.import_module(".".join(parts[:at]))
            except ModuleNotFoundError:
                return False
        elif hasattr(value, part):
            value = getattr(value, part)
        else:
            fields = getattr(value, "__dataclass_fields__", {})
            return at == len(parts) and (part in fields or part in _parameters(value))
    return True


def _parameters(value: Any) -> set[str]:
    return set(inspect.signature(value).parameters) if inspect.isroutine(value) else set()


def test_every_name_in_the_glossary_exists() -> None:
    names = code_names(PAGE)
    assert len(names) >= 30
    assert not [name for name in names if not exists(name)]


def test_a_name_that_does_not_exist_is_noticed() -> None:
    assert exists("vincula.LinearModel.grasp")
    assert exists("vincula.LinearModel.from_matrices.length")
    assert not exists("vincula.LinearModel.grip")
    assert not exists("vincula.modell.LinearModel")
