"""Bad native files: each refused with the right class, element and line, by its golden message."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.conftest import ROOT

import vincula as vc
from vincula.files.limits import Limits

FOLDER = ROOT / "tests" / "files" / "bad" / "native"
FILES = sorted(path.name for path in FOLDER.iterdir() if path.suffix in (".yaml", ".json"))
UNSUPPORTED: set[str] = set()

JOINT = "  - {name: o1, type: revolute, bodies: [ground, crank], at: [0, 0]}\n"
HEAD = "vincula: 1\nspace: planar\n"


def told(error: vc.FileError) -> str:
    """The message without the list of formats, which grows."""
    return re.sub(r"that can be read: .*", "that can be read: ...", f"{error}\n")


@pytest.mark.parametrize("name", FILES)
def test_golden_message(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FOLDER)
    monkeypatch.setitem(sys.modules, "xacro", None)  # with the extra a xacro is no bad file
    with pytest.raises(vc.FileError) as refused:
        vc.load(name)
    golden = (FOLDER / f"{name}.expected.txt").read_text(encoding="utf-8")
    assert told(refused.value) == golden
    assert isinstance(refused.value, vc.UnsupportedFeatureError) == (name in UNSUPPORTED)


def test_every_golden_message_has_its_file() -> None:
    assert sorted(path.name.removesuffix(".expected.txt") for path in FOLDER.glob("*.txt")) == FILES


def test_messages_name_file_line_and_column() -> None:
    """But for files of which nothing can be read, every line of a message has a place."""
    nowhere = {"mesh.yaml", "web-page.yaml", "xacro.yaml"}
    for name in set(FILES) - nowhere:
        text = (FOLDER / f"{name}.expected.txt").read_text(encoding="utf-8").rstrip("\n")
        last = text.splitlines()[-1]
        assert last.startswith(f"{name}:"), name
        line, column = last.removeprefix(f"{name}:").split(":")[:2]
        assert int(line) >= 1, name
        assert int(column) >= 1, name


def nested(depth: int, bracket: str) -> str:
    return "vincula: 1\na: " + bracket * depth


HOSTILE: dict[str, tuple[str, str]] = {
    "brackets": (nested(100_000, "["), "nested deeper than 64"),
    "braces": (nested(100_000, "{"), "expected a plain text as key"),
    "dashes": ("- " * 100_000, "nested deeper than 64"),
    "question marks": ("? " * 100_000, "expected a plain text as key"),
    "JSON brackets": ('{"vincula": 1, "a": ' + "[" * 100_000, "nested deeper than 64"),
    "million digits": (HEAD + "parameters: {l: " + "1" * 1_000_000 + "}", "at most 65536 characters"),
    "JSON million digits": ('{"vincula": 1, "a": ' + "1" * 1_000_000 + "}", "at most 400 characters"),
    "long key": ('{"' + "k" * 1_000_000 + '": 1}', "expected the key `vincula: 1`"),
    "many values": (
        HEAD + "parameters: {" + "".join(f"a{k}: 1, " for k in range(15_000)) + "}",
        "20000 values",
    ),
    "JSON many values": ('{"a": [' + "1," * 250_000 + "1]}", "more than 200000 values"),
    "many aliases": (HEAD + "a: &a 1\nb: [" + "*a, " * 2_000 + "]", "more than 1000 aliases"),
    "YAML too large": (HEAD + "#" * (1 << 20), "bytes, at most 1048576"),
    "JSON too large": ('{"a": "' + "x" * (8 << 20) + '"}', "bytes, at most 8388608"),
    "long name": (HEAD + "name: " + "n" * 1_000, "at most 256 characters"),
    "long expression": (HEAD + "parameters: {l: $k" + "+1" * 1_000 + "}", "longer than 1000"),
    "deep expression": (
        HEAD + 'parameters: {l: "' + "(" * 400 + "pi" + ")" * 400 + '"}',
        "inside each other",
    ),
    "many bodies": (
        HEAD
        + "joints:\n"
        + "".join(JOINT.replace("o1", f"o{k}").replace("crank", f"b{k}") for k in range(1_200)),
        "got 1200 bodies, expected at most 1000",
    ),
    "large escape": ('vincula: 1\nname: "\\UFFFFFFFF"', "not YAML"),
    "huge directive": ("%YAML " + "9" * 5_000 + ".1\n---\na: 1", "not YAML|YAML 1.2"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_are_refused_quickly(kind: str, tmp_path: Path) -> None:
    text, expected = HOSTILE[kind]
    path = tmp_path / "hostile.txt"
    path.write_text(text, encoding="utf-8")
    limits = Limits(bodies=1_000) if kind == "many bodies" else Limits()
    start = time.process_time()
    with pytest.raises(vc.FileError, match=expected):
        vc.load(path, limits=limits)
    assert time.process_time() - start < 3.0


def test_at_most_fifty_problems_are_told(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(HEAD + "joints:\n" + "".join(f"  - {{name: j{k}}}\n" for k in range(80)))
    with pytest.raises(vc.FileError) as refused:
        vc.load(path)
    assert len(refused.value.problems) == 50
    lines = str(refused.value).splitlines()
    assert lines[0].endswith("more than 50 problems")
    assert lines[-1] == "(the first 50 are shown)"


def test_time_is_limited(tmp_path: Path) -> None:
    path = tmp_path / "slow.yaml"
    path.write_text(HEAD + "joints:\n" + "".join(JOINT.replace("o1", f"o{k}") for k in range(200)))
    with pytest.raises(vc.FileError, match="reading took more than 0 s"):
        vc.load(path, limits=Limits(seconds=0.0))


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux")
def test_memory_stays_small(tmp_path: Path) -> None:
    """The largest tree that the limits allow costs less than 256 MB; measured in a process of its own."""
    path = tmp_path / "large.json"
    path.write_text(json.dumps({"vincula": 1, "space": "planar", "a": [{"k": 1} for _ in range(66_000)]}))
    # VmHWM, not getrusage: the latter starts at the size of the process that started this one.
    code = (
        "import re, sys, vincula\n"
        "try:\n    vincula.load(sys.argv[1])\n"
        "except vincula.FileError:\n"
        "    print(int(re.search(r'VmHWM:\\s+(\\d+)', open('/proc/self/status').read())[1]) // 1024)\n"
    )
    run = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
    assert int(run.stdout) < 256


def special_directory(folder: Path) -> Path:
    return folder


def special_fifo(folder: Path) -> Path:
    os.mkfifo(folder / "pipe.yaml")
    return folder / "pipe.yaml"


def special_device(folder: Path) -> Path:
    return Path("/dev/zero")


def special_missing(folder: Path) -> Path:
    return folder / "missing.yaml"


def special_link_to_itself(folder: Path) -> Path:
    (folder / "loop.yaml").symlink_to(folder / "loop.yaml")
    return folder / "loop.yaml"


@pytest.mark.skipif(sys.platform == "win32", reason="FIFOs and devices are those of Unix")
@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (special_directory, "got a directory"),
        (special_fifo, "got a FIFO"),
        (special_device, "got a device"),
        (special_missing, "there is no such file"),
        (special_link_to_itself, "cannot be opened"),
    ],
)
def test_what_is_no_regular_file(make: Callable[[Path], Path], expected: str, tmp_path: Path) -> None:
    with pytest.raises(vc.FileError, match=expected):
        vc.load(make(tmp_path))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="needs a user without all rights")
def test_no_permission(tmp_path: Path) -> None:
    path = tmp_path / "secret.yaml"
    path.write_text(HEAD)
    path.chmod(0)
    with pytest.raises(vc.FileError, match="no permission"):
        vc.load(path)


@pytest.mark.parametrize(
    "path", ["http://example.org/a.yaml", "file:///etc/passwd", "a\0b.yaml", "a\nb.yaml"]
)
def test_paths_that_are_no_local_files(path: str) -> None:
    with pytest.raises(vc.FileError) as refused:
        vc.load(path)
    assert str(refused.value).isprintable()
