# ruff: noqa: PTH112, PTH118, PTH119, PTH120, SLF001  (paths come as texts; parts of xacro are replaced)
"""The process that expands a xacro file; run as a script, it imports nothing of this package.

A job comes as JSON on standard input, `text` and `arguments` or `error` go out as JSON.  Before the
file is looked at, the process gives up what it does not need: time, memory, writing, connections, other
processes, and files outside the allowed folders.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import sys
from collections.abc import Callable
from typing import Any, Final, TextIO

_FORBIDDEN: Final = (
    "socket.", "subprocess.", "os.system", "os.exec", "os.spawn", "os.posix_spawn", "os.fork", "os.remove",
    "os.rename", "os.mkdir", "os.rmdir", "os.chmod", "os.chown", "os.link", "os.symlink", "os.truncate",
    "os.putenv", "os.unsetenv", "os.kill", "os.chdir", "ctypes.", "shutil.", "tempfile.", "pty.", "urllib.",
    "ftplib.", "http.", "smtplib.", "webbrowser.", "winreg.", "mmap.", "signal.", "sys.addaudithook",
    "pickle.", "marshal.", "code.__new__",
)  # fmt: skip
_LISTING: Final = ("os.listdir", "os.scandir", "glob.glob")
_ALWAYS: Final = ("encodings",)
_ABOVE: Final = 8


class ForbiddenError(Exception):
    """The file asks for something that is not allowed."""


class Guard:
    """An audit hook that lets the process read below some folders and nothing else.

    Args:
        folders: The folders.
    """

    def __init__(self, folders: list[str]) -> None:
        self._folders = [os.path.realpath(folder) for folder in folders]

    def allow(self, folder: str) -> None:
        """Allow one more folder."""
        self._folders.append(os.path.realpath(folder))

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Refuse an event that is not allowed."""
        if event == "open":
            path, mode, flags = arguments
            writes = isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC)
            if writes or (isinstance(mode, str) and set(mode) & set("wax+")):
                raise ForbiddenError("writing files is not allowed")
            if not isinstance(path, int):
                self._below(os.fspath(path))
        elif event == "import":
            if arguments[0] not in sys.modules and arguments[0].split(".")[0] not in _ALWAYS:
                raise ForbiddenError(f"importing {arguments[0]} is not allowed")
        elif event in _LISTING:
            target = os.fspath(arguments[0] or ".")
            self._below(os.path.dirname(target) if event == "glob.glob" else target)
        elif event.startswith(_FORBIDDEN):
            raise ForbiddenError(f"{event} is not allowed")

    def _below(self, path: str | bytes) -> None:
        real = os.path.realpath(os.fsdecode(path))
        if not any(real == folder or real.startswith(folder + os.sep) for folder in self._folders):
            raise ForbiddenError(
                f"{os.fsdecode(path)} lies outside the model's folder and the packages that are named"
            )


def main() -> None:
    """Expand the file of the job on standard input."""
    job = json.load(sys.stdin)
    sys.path += job["paths"]
    import xml.dom.expatbuilder  # all imports now: later they are forbidden
    import xml.dom.minidom

    xacro: Any = importlib.import_module("xacro")
    substitutions: Any = importlib.import_module("xacro.substitution_args")
    importlib.import_module("yaml")

    _limit(job)
    guard = Guard([os.path.dirname(job["file"])])
    xacro.xml.dom.minidom.parse = _parser(job, xml.dom.minidom.parseString)
    substitutions._eval_find = substitutions._eval_dict["find"] = _finder(job, guard)
    output, sys.stdout, sys.stderr = sys.stdout, io.StringIO(), io.StringIO()
    # Whatever the file's expressions raise ends the process, and this is its last word.
    sys.excepthook = lambda _kind, error, _trace: _answer(output, {"error": _in_words(error)})
    sys.addaudithook(guard)
    document, names = _expanded(xacro, job)
    text = document.toxml()
    if len(text.encode()) > job["bytes"]:
        _answer(output, {"error": f"the file expands to more than {job['bytes']} bytes"})
    else:
        _answer(output, {"text": text, "arguments": names})


def _answer(output: TextIO, answer: dict[str, Any]) -> None:
    json.dump(answer, output)
    output.flush()


def _in_words(error: BaseException) -> str:
    if isinstance(error, MemoryError):
        return "the file needs too much memory"
    if isinstance(error, RecursionError):
        return "the file calls itself without end"
    return " ".join(str(error).split())[:500] or type(error).__name__


def _expanded(xacro: Any, job: dict[str, Any]) -> tuple[Any, list[str]]:
    xacro.init_stacks(job["file"])
    document = xacro.parse(None, job["file"])
    mappings = Arguments(job["settings"])
    xacro.process_doc(document, mappings=mappings)
    return document, sorted(mappings.asked)


class Arguments(dict[str, str]):
    """Values of arguments; remembers the names that the file asked for."""

    def __init__(self, values: dict[str, str]) -> None:
        super().__init__(values)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


def _limit(job: dict[str, Any]) -> None:
    """Limits of the system on time and memory, where it has them."""
    try:
        import resource
    except ImportError:
        return
    seconds = max(1, int(job["seconds"]) + 1)
    for kind, value in (
        (resource.RLIMIT_CPU, seconds + 2),
        (resource.RLIMIT_AS, job["memory"]),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        _, most = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if most == resource.RLIM_INFINITY else min(value, most), most))


def _parser(job: dict[str, Any], parse: Callable[[bytes], Any]) -> Callable[[Any], Any]:
    """The reading of one XML file: no larger than allowed, without document types, not too many."""
    left = [job["includes"] + 1]

    def read(stream: Any) -> Any:
        left[0] -= 1
        if left[0] < 0:
            raise ForbiddenError(f"more than {job['includes']} files are included")
        data = stream.read(job["bytes"] + 1)
        data = data.encode() if isinstance(data, str) else data
        if len(data) > job["bytes"]:
            raise ForbiddenError(f"an included file has more than {job['bytes']} bytes")
        if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
            raise ForbiddenError("document types and entities are refused")
        return parse(data)

    return read


def _finder(job: dict[str, Any], guard: Guard) -> Callable[[str], str]:
    """`$(find NAME)`: the packages that were named, then the one that the file lies in."""

    def find(name: str) -> str:
        if os.sep not in name and name not in ("", ".", ".."):
            above = [os.path.dirname(job["file"])]
            for _ in range(_ABOVE):
                above.append(os.path.dirname(above[-1]))
            candidates = [os.path.join(folder, name) for folder in job["packages"]]
            candidates += [f for f in (*job["packages"], *above) if os.path.basename(f) == name]
            for candidate in candidates:
                if os.path.isdir(candidate):
                    guard.allow(candidate)
                    return candidate
        raise ForbiddenError(f"there is no package {name!r}; --package-dir names its folder")

    return find


if __name__ == "__main__":
    main()
