"""Running the command line inside the test process."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from click.testing import CliRunner, Result

from vincula.cli.main import cli

Run = Callable[..., Result]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Run:
    """`run("analyze", "example:five-bar", code=0)`: the result, its exit code checked."""
    monkeypatch.setenv("COLUMNS", "120")

    def invoke(*words: str, code: int = 0) -> Result:
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == code, f"{words}: {result.output}\n{result.exception!r}"
        assert "Traceback" not in result.output
        return result

    return invoke


@pytest.fixture
def run_json(run: Run) -> Callable[..., dict[str, Any]]:
    """The same with `--json`: the one object on stdout."""

    def invoke(*words: str, code: int = 0) -> dict[str, Any]:
        value = json.loads(run(*words, "--json", code=code).stdout)
        assert isinstance(value, dict)
        assert value["schema"].startswith("vincula/")
        return value

    return invoke
