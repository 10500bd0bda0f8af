"""xacro files: expanded in a process of their own, then read as what they expand to.

A xacro file holds Python expressions.  The process that evaluates them gets no environment, may read
files of the model's own folder and of the packages that it names, write none, open no connection and
start no process, and is stopped when it takes too much time or memory.  This keeps accidents and simple
malice out; a file from somebody whom one does not trust at all is better not expanded.
"""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.packages import Packages
from vincula.files.source import Source, decode

MEMORY: Final = 512 << 20
"""Memory of the process [bytes]."""

EXPANDED: Final = "expanded from xacro"
_SCRIPT: Final = Path(__file__).with_name("xacro_child.py")
_STARTING: Final = 10.0
"""Time for starting the process [s]."""


def expand(
    source: Source,
    settings: Mapping[str, float | str],
    limits: Limits = DEFAULT_LIMITS,
    packages: Packages | None = None,
) -> tuple[Source, tuple[str, ...]]:
    """The text that a xacro file expands to, and the names of its arguments.

    Args:
        source: The xacro file.
        settings: Values of arguments (`<xacro:arg>`).
        limits: How much time it may take and how much it may expand to.
        packages: Where `$(find NAME)` looks; by default the packages of the environment.

    Raises:
        FileError: The extra is not installed, or xacro refuses the file; its message is passed on.
    """
    paths = _installed()
    if paths is None:
        raise FileError(
            f"{source.file}: got an unexpanded xacro; expand it first: xacro FILE > robot.urdf; or have it "
            "expanded: python -m pip install 'vincula[xacro]'"
        )
    if source.path is None:
        raise FileError(f"{source.file}: a xacro that is in no file cannot be expanded")
    job = {
        "file": str(source.path.absolute()),
        "settings": {name: str(value) for name, value in settings.items()},
        "paths": paths,
        "packages": [str(folder.absolute()) for folder in (packages or Packages.of()).folders],
        "seconds": limits.seconds,
        "memory": MEMORY,
        "bytes": limits.xml_bytes,
        "includes": limits.includes,
    }
    answer = _asked(job, source, limits)
    if "error" in answer:
        raise FileError(f"{source.file}: xacro: {answer['error']}")
    text = str(answer["text"])
    label = f"{source.file} ({EXPANDED})"
    return replace(decode(text.encode(), label), path=source.path), tuple(answer["arguments"])


def _installed() -> list[str] | None:
    """Folders in which the process finds xacro and yaml; None when xacro is not installed."""
    try:
        modules = [importlib.import_module(name) for name in ("xacro", "yaml")]
    except ImportError:
        return None
    return list(dict.fromkeys(str(Path(str(module.__file__)).parents[1]) for module in modules))


def _asked(job: Mapping[str, Any], source: Source, limits: Limits) -> dict[str, Any]:
    try:
        # -I: no environment variables, no user folder; the script imports nothing of this package.
        done = subprocess.run(  # noqa: S603  (our own interpreter on our own script)
            [sys.executable, "-I", str(_SCRIPT)],
            input=json.dumps(job).encode(),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={},
            timeout=_STARTING + 2.0 * limits.seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise FileError(f"{source.file}: expanding the xacro took more than {limits.seconds:g} s") from None
    except OSError as error:
        raise FileError(f"{source.file}: xacro cannot be started ({error.strerror})") from error
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        answer = None
    if not isinstance(answer, dict):
        raise FileError(
            f"{source.file}: expanding the xacro took more than {limits.seconds:g} s or {MEMORY >> 20} MiB"
        )
    return answer
