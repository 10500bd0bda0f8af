"""How every run ends: exit codes, messages on stderr, no traceback unless asked for."""

from __future__ import annotations

import subprocess
import sys

import click
import pytest
from click.testing import CliRunner

import vincula
from vincula.cli.exits import exit_code
from vincula.cli.main import COMMANDS, cli, finished
from vincula.errors import (
    ClosureError,
    DuplicateNameError,
    FileError,
    MissingExtraError,
    MissingReferenceError,
    MixedUnitsError,
    ModelError,
    NonFiniteError,
    TopologyError,
    UnknownNameError,
    UnsupportedFeatureError,
    VinculaError,
    WeightError,
)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (ClosureError("open", loop="o3", gap=0.1), 1),
        (ModelError("no"), 1),
        (TopologyError("no"), 1),
        (NonFiniteError("J"), 1),
        (FileError("bad"), 2),
        (UnsupportedFeatureError("bad"), 2),
        (MissingExtraError("matplotlib", "plot", "drawing"), 2),
        (UnknownNameError("body", "x", ["y"]), 2),
        (DuplicateNameError("joint", "x"), 2),
        (MissingReferenceError(["a"]), 2),
        (MixedUnitsError("no"), 2),
        (WeightError("no"), 2),
    ],
)
def test_exit_codes_of_errors(error: VinculaError, code: int, capsys: pytest.CaptureFixture[str]) -> None:
    def fail() -> None:
        raise error

    assert exit_code(error) == code
    assert finished(fail, debug=False) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert err == f"error: {error}\n"
    finished(fail, debug=True)
    assert "Traceback" in capsys.readouterr().err


def test_interruption_and_success(capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    assert finished(interrupt, debug=False) == 130
    assert capsys.readouterr().err == "interrupted\n"
    assert finished(lambda: None, debug=False) == 0
    assert finished(lambda: 3, debug=False) == 3


def test_bad_usage_is_two(capsys: pytest.CaptureFixture[str]) -> None:
    def misuse() -> None:
        raise click.UsageError("no such option")

    assert finished(misuse, debug=False) == 2
    assert "no such option" in capsys.readouterr().err


def test_help_lists_the_commands_in_the_order_of_work() -> None:
    result = CliRunner().invoke(cli, ["--help"])
    assert result.exit_code == 0
    listed = result.output.split("Commands:")[1]
    places = [listed.index(f"  {name} ") for name in COMMANDS]
    assert places == sorted(places)
    assert "..." not in listed
    assert CliRunner().invoke(cli, ["-h"]).output == result.output


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_and_the_shared_options(command: str) -> None:
    found = cli.get_command(click.Context(cli), command)
    below = list(found.commands) if isinstance(found, click.Group) else []
    for words in [[command, name] for name in below] or [[command]]:
        result = CliRunner().invoke(cli, [*words, "--help"])
        assert result.exit_code == 0
        assert "--debug" in result.output
        assert "--json" in result.output
        assert result.output.count("\n\n") >= 2


def test_version() -> None:
    result = CliRunner().invoke(cli, ["--version"])
    assert result.output == f"vincula {vincula.__version__}\n"


def test_unknown_command_suggests_one() -> None:
    result = CliRunner().invoke(cli, ["analyse", "x"])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "did you mean 'analyze'?" in result.stderr
    assert "commands: inspect" in CliRunner().invoke(cli, ["zzz"]).stderr


def test_no_command_shows_the_help() -> None:
    result = CliRunner().invoke(cli, [])
    assert "Commands:" in result.output


def test_an_unforeseen_error_is_one_line(tmp_path) -> None:
    code = (
        "import vincula.cli.main as m, vincula.cli.examples as e\n"
        "e.examples_command.callback = lambda **_: 1 / 0\n"
        "m.main()\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, "examples"], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert run.returncode == 70
    assert run.stdout == ""
    assert run.stderr.splitlines()[0] == "internal error: ZeroDivisionError: division by zero"
    assert "Traceback" not in run.stderr
    debug = subprocess.run(
        [sys.executable, "-c", code, "examples", "--debug"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert "Traceback" in debug.stderr


def test_a_closed_pipe_ends_quietly(tmp_path) -> None:
    command = f"{sys.executable} -c 'from vincula.cli.main import main; main()' examples --json | head -1"
    run = subprocess.run(command, shell=True, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert run.stdout == "{\n"
    assert run.stderr == ""
