"""What the README and the pages show runs, block after block, as a reader would type it.

A block that needs something the checkout does not hold (a user's own file) opens with
```python no-run.  An ```output block is what the blocks before it print.  A file that the page shows,
```xml file or ```yaml file with its name in a comment on the first line, is there for both.
"""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest
from tests.house.source import ROOT

import vincula

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]
BLOCK = re.compile(r"^```(?P<info>[^\n]*)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path, language: str) -> list[tuple[int, str]]:
    """First line and text of every block of a language that is meant to run."""
    text = page.read_text(encoding="utf-8")
    return [
        (text.count("\n", 0, found.start()) + 2, found["code"])
        for found in BLOCK.finditer(text)
        if found["info"].split() == [language]
    ]


def write_files(page: Path, folder: Path) -> None:
    """The files that a page shows, under the names in their first lines."""
    for language in ("xml", "yaml"):
        for found in BLOCK.finditer(page.read_text(encoding="utf-8")):
            if found["info"].split() == [language, "file"]:
                name = found["code"].split("\n", 1)[0].strip("<!-># ")
                (folder / name).write_text(found["code"], encoding="utf-8")


def name_of(page: Path) -> str:
    """Path of a page below the checkout, for test names."""
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_python_blocks_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_files(page, tmp_path)
    names: dict[str, object] = {"__name__": "page"}
    for line, code in blocks(page, "python"):
        exec(compile("\n" * (line - 1) + code, str(page), "exec"), names)
    printed = capsys.readouterr().out
    for line, text in blocks(page, "output"):
        assert text in printed, f"line {line}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = [
        line.removeprefix("$ ")
        for _, code in blocks(page, "console")
        for line in code.splitlines()
        if line.startswith("$ vincula")
    ]
    if not commands:
        return
    from click.testing import CliRunner

    from vincula.cli.main import cli

    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "COLUMNS", "120")
    write_files(page, tmp_path)
    for command in commands:
        result = CliRunner().invoke(cli, shlex.split(command, comments=True)[1:], catch_exceptions=False)
        assert result.exit_code == 0, f"{command}\n{result.output}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_model_files_load(page: Path, tmp_path: Path) -> None:
    """A yaml block begins with its file name; later ones may build on earlier ones."""
    for line, text in blocks(page, "yaml"):
        file = tmp_path / text.split("\n", 1)[0].removeprefix("# ")
        file.write_text(text, encoding="utf-8")
        mechanism = vincula.load(file)
        if mechanism.reference is not None:
            vincula.analyze(mechanism.linearize(), vincula.Weights())
        assert mechanism.bodies, f"line {line}"


def test_blocks_are_found() -> None:
    assert blocks(ROOT / "README.md", "python")
