"""The program as a process: pure stdout, exit codes, signals, and nothing imported that is not used."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

MAIN = "from vincula.cli.main import main; main()"


def program(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", MAIN, *words],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | environment,
    )


def test_json_alone_on_stdout() -> None:
    result = program("analyze", "example:five-bar", "--tolerance", "0.2,5deg", "--json", "--strict")
    assert result.returncode == 3
    assert json.loads(result.stdout)["rank"]["status"] == "doubtful"
    assert result.stderr.startswith("warning: ")


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["analyze", "example:five-bar"], 0),
        (["analyze", "example:five-bar", "--at", "o1=0.3"], 1),
        (["analyze", "nosuch.yaml"], 2),
        (["analyze", "example:five-bar", "--active", "o9"], 2),
        (["nosuch"], 2),
    ],
)
def test_exit_codes_without_traceback(words: list[str], code: int) -> None:
    result = program(*words)
    assert result.returncode == code
    assert "Traceback" not in result.stderr
    assert bool(result.stdout) == (code == 0)
    assert bool(result.stderr) == (code != 0)


def test_debug_shows_where() -> None:
    result = program("analyze", "example:five-bar", "--at", "o1=0.3", "--debug")
    assert result.returncode == 1
    assert "Traceback" in result.stderr
    assert result.stderr.rstrip().splitlines()[-1].startswith("error: ")


def test_warnings_turned_into_errors_by_the_user_change_nothing() -> None:
    result = program(
        "analyze", "example:five-bar", "--tolerance", "0.2,5deg", "--json", PYTHONWARNINGS="error"
    )
    assert result.returncode == 0
    assert json.loads(result.stdout)["warnings"]


def test_a_terminal_without_lines_or_colour() -> None:
    result = program(
        "compare", "example:five-bar", "--active", "all", PYTHONIOENCODING="ascii", PYTHONUTF8="0"
    )
    assert result.returncode == 0
    assert result.stdout.isascii()
    assert "\x1b" not in result.stdout


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_interruption(tmp_path: Path) -> None:
    slow = (
        # A shell starts background jobs with interrupts ignored, and children inherit that.
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import vincula.cli.examples as e, time, sys\n"
        "e.examples_command.callback = lambda **_: (print('ready', flush=True), time.sleep(30))\n" + MAIN
    )
    with subprocess.Popen(
        [sys.executable, "-c", slow, "examples"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        error = process.stderr.read()
        assert process.wait(10) == 130
    assert "interrupted" in error
    assert "Traceback" not in error


@pytest.mark.parametrize(
    ("words", "absent"),
    [
        (["--help"], ("numpy", "scipy", "rich", "vincula.mechanism")),
        (["analyze", "example:five-bar", "--json"], ("rich", "pydantic", "ruamel", "matplotlib", "mujoco")),
        (["analyze", "example:five-bar"], ("pydantic", "ruamel", "matplotlib", "mujoco", "scipy.optimize")),
        (["examples"], ("scipy", "pydantic")),
    ],
)
def test_nothing_is_imported_that_is_not_used(words: list[str], absent: tuple[str, ...]) -> None:
    code = (
        "import atexit, sys\n"
        "atexit.register(lambda: print(*sys.modules, sep='\\n', file=sys.stderr))\n" + MAIN
    )
    result = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
    loaded = set(result.stderr.splitlines())
    assert "click" in loaded
    assert not loaded & set(absent)
