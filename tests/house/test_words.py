"""Nothing in the project depends on, or speaks of, one particular machine; nothing is left half done."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from tests.house.source import ROOT

# Written with a gap so that this file does not match itself.
PATTERNS = {
    "a path of one machine": re.compile(r"(?<![\w.~])/(?:work|home|root|Users|opt)/[\w.]"),
    "a package registry host": re.compile(r"(?i)\b(?:pypi|pythonhosted|npmjs|anaconda)\.(?:org|com)\b"),
    "unfinished work": re.compile("TO" r"DO\b|FIX" r"ME\b|\bXX" r"X\b|NotImplemented" "Error"),
}


def tracked() -> list[Path]:
    """Files that git tracks; every source, test and page where there is no git."""
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return [
            path for folder in ("src", "tests", "docs", "benchmarks") for path in (ROOT / folder).rglob("*.*")
        ]
    return [ROOT / name for name in listed.stdout.split("\0") if name]


@pytest.mark.parametrize("what", PATTERNS)
def test_words(what: str) -> None:
    found = []
    for path in tracked():
        if path == Path(__file__).resolve() or not path.is_file():
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), start=1):
            if PATTERNS[what].search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}")
    assert not found


def test_the_version_is_told_once_and_the_same() -> None:
    import vincula

    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {vincula.__version__}\n" in citation
    assert f"## [{vincula.__version__}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_recipes_name_files_and_names_that_exist() -> None:
    """CONTRIBUTING says `room/file.py` and, after it, names that are in that file."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    paths = re.findall(r"`([\w/]+\.py)`", text)
    assert len(paths) > 15
    for path in paths:
        assert any((ROOT / start / path).is_file() for start in ("src/vincula", "src", ".")), path
    source = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py"))
    names = re.findall(r"`(_?[A-Z]\w+|_\w+)`", text)
    assert not [name for name in names if not re.search(rf"\b{name}\b", source) and name != "VINCULA_SHARED"]
