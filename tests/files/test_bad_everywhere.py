"""The bad inputs that every reader meets, given to every reader: class, place, time, memory of refusals.

Cases that mean something in one format only are files in `bad/`, with their messages.
"""

from __future__ import annotations

import gzip
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.conftest import ROOT
from tests.files.conventions import four_bar

import vincula as vc
from vincula.files.configuration import read_configuration
from vincula.files.weights import read_weights

URDF = f'<robot name="linkage">{four_bar.TREE}</robot>'
GOOD = {
    "m.yaml": four_bar.NATIVE,
    "m.json": '{"vincula": 1, "space": "planar", "joints": [{"name": "o1", "type": "revolute", '
    '"bodies": ["ground", "crank"], "at": [0, 0]}]}',
    "m.xml": '<mujoco><worldbody><body name="b"><joint name="j"/></body></worldbody></mujoco>',
    "m.urdf": URDF,
    "m.sdf": four_bar.SDF_GRAPH,
    "robot.yaml": "closed_loop: [[coupler, rocker]]\ntype: [3d]\nname_mot: [o1]\n",
    "linkage.srdf": '<robot name="linkage"><passive_joint name="o2"/></robot>',
    "q.yaml": "o1: 0.3\no5: -0.1\n",
    "q.json": '{"o1": 0.3}',
    "w.yaml": "twist: [1, 1, 1]\nrate: {o1: 2}\n",
    "w.json": '{"twist": [1, 1, 1]}',
}
"""A good file of every kind; its name decides who reads it."""


def read(path: Path) -> None:
    """Give a file to the reader that its name belongs to."""
    if path.name.startswith("q."):
        read_configuration(str(path), vc.load("example:five-bar"))
    elif path.name.startswith("w."):
        read_weights(str(path), vc.load("example:five-bar"))
    elif path.name in ("robot.yaml", "linkage.srdf"):
        urdf = path.with_name("beside.urdf")
        urdf.write_text(URDF, encoding="utf-8")
        vc.load(urdf, beside=[path])
    else:
        vc.load(path)


def is_xml(name: str) -> bool:
    return Path(name).suffix in (".xml", ".urdf", ".sdf", ".srdf")


def deep(name: str, good: str) -> bytes:
    if is_xml(name):
        return (good[: good.index(">") + 1] + "<a>" * 100_000).encode()
    return (("closed_loop: " if name == "robot.yaml" else '{"a": ') + "[" * 100_000).encode()


def long_value(name: str, good: str) -> bytes:
    """Fifty megabytes in one attribute or text."""
    return good.encode().replace(b'"', b'"' + b"x" * (50 << 20), 1) + b"#" + b"x" * (50 << 20)


def many_digits(name: str, good: str) -> bytes:
    number = "1" * 1_000_000
    if is_xml(name):
        return good.replace(">", f' pos="{number} 0 0">', 1).encode()
    if name == "robot.yaml":
        return f"{good}\nextra: {number}\n".encode()
    return (
        good.rstrip().rstrip("}") + f', "o1": {number}}}' if name.endswith("json") else f"o1: {number}"
    ).encode()


def documents(name: str, good: str) -> bytes:
    """Two documents, or two roots."""
    return (
        f"{good}\n{good}".encode()
        if is_xml(name) or name.endswith("json")
        else f"{good}\n---\n{good}".encode()
    )


def twice(name: str, good: str) -> bytes:
    """Two equal keys or attributes."""
    if is_xml(name):
        return good.replace(">", ' zzz="1" zzz="2">', 1).encode()
    if name.endswith("json"):
        return good.replace("{", '{"o1": 1, "o1": 1, ', 1).encode()
    return f"{good}\nzzz: 1\nzzz: 2\n".encode()


def entities(name: str, good: str) -> bytes:
    if is_xml(name):
        laughs = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
        return f'<!DOCTYPE r [<!ENTITY l0 "lol">{laughs}]>{good}'.encode()
    if name.endswith("json"):
        return good.encode().replace(b"{", b'{"a": &a [*a], ', 1)
    laughs = "".join(f"l{k}: &l{k} [{', '.join([f'*l{k - 1}'] * 9)}]\n" for k in range(1, 9))
    return f"l0: &l0 [lol]\n{laughs}{good}".encode()


CASES: dict[str, tuple[Callable[[str, str], bytes], str]] = {
    "empty": (lambda _name, _good: b"", r":1:1: .*empty"),
    "blanks only": (lambda _name, _good: b" \n\n ", r":1:1: .*empty"),
    "comments only": (
        lambda name, _good: b"<!-- nothing -->" if is_xml(name) else b"# nothing\n",
        "comments|no element|no mapping|Gepetto|expected|got",
    ),
    "binary": (lambda _name, good: b"\x7fELF\x02\x01" + good.encode(), r":1:1: .*a program"),
    "UTF-16": (lambda _name, good: good.encode("utf-16"), r":1:1: .*UTF-16"),
    "UTF-16 without mark": (lambda _name, good: good.encode("utf-16-le"), r":1:1: .*UTF-16"),
    "bad UTF-8": (
        lambda _name, good: good.encode()[:9] + b"\xff" + good.encode()[9:],
        r":\d+:\d+: byte 0xff",
    ),
    "NUL": (lambda _name, good: good.encode()[:9] + b"\0" + good.encode()[9:], "NUL byte"),
    "control character": (lambda _name, good: good.encode() + b"\x1b[31m", r":\d+:\d+: .*U\+001B"),
    "gzip": (lambda _name, good: gzip.compress(good.encode()), r":1:1: .*gzip"),
    "pickle": (lambda _name, _good: b"\x80\x04\x95\x00", r":1:1: .*pickle"),
    "truncated": (
        lambda name, good: good.encode()[: int(len(good) * 0.6)] + (b"" if is_xml(name) else b" ["),
        ":",
    ),
    "too large": (lambda _name, good: good.encode() + b"\n" * (9 << 20), "bytes, at most"),
    "fifty megabytes in one value": (long_value, "bytes, at most"),
    "a hundred thousand deep": (deep, "nested|deep|expected a plain text"),
    "a million digits": (many_digits, "characters|deep|not|expected"),
    "two documents": (documents, r":\d+:\d+: "),
    "twice": (twice, r":\d+:\d+: "),
    "billion laughs": (entities, "document types|more than|expected"),
}


@pytest.mark.parametrize("name", GOOD)
def test_good_files_are_read(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(GOOD[name], encoding="utf-8")
    read(tmp_path / name)
    (tmp_path / name).write_bytes(GOOD[name].replace("\n", "\r\n").encode())
    read(tmp_path / name)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("name", GOOD)
def test_every_case_for_every_reader(name: str, case: str, tmp_path: Path) -> None:
    if name == "m.xml":
        pytest.importorskip("mujoco")
    make, expected = CASES[case]
    path = tmp_path / name
    path.write_bytes(make(name, GOOD[name]))
    start = time.process_time()
    with pytest.raises(vc.FileError, match=expected) as refused:
        read(path)
    assert time.process_time() - start < 3.0  # one second, and room for a busy machine
    text = str(refused.value)
    assert name in text
    assert text.replace("\n", "").isprintable()
    assert len(text) < 10_000


@pytest.mark.skipif(sys.platform == "win32", reason="FIFOs and devices are those of Unix")
@pytest.mark.parametrize("name", GOOD)
def test_what_is_no_regular_file(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    for make, expected in (
        (path.mkdir, "a directory"),
        (lambda: os.mkfifo(path), "a FIFO"),
        (lambda: path.symlink_to("/dev/zero"), "a device"),
        (lambda: path.symlink_to(path), "cannot be opened"),
        (lambda: None, "no such file"),
    ):
        make()
        with pytest.raises(vc.FileError, match=expected):
            read(path)
        if path.is_dir():
            path.rmdir()
        elif path.is_symlink() or path.exists():
            path.unlink()


MEASURE = """
import re, sys, vincula as vc
from pathlib import Path
from tests.files import test_bad_everywhere as table

def high():
    return int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])

folder = Path(sys.argv[1])
for name, good in table.GOOD.items():  # what is imported for reading costs memory once
    (folder / name).write_text(good)
    table.read(folder / name)
before = high()
for path in sorted(folder.glob("*/*")):
    try:
        table.read(path)
    except vc.FileError:
        continue
    raise SystemExit(f"{path} was read")
print((high() - before) // 1024)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux")
def test_none_of_them_takes_much_memory(tmp_path: Path) -> None:
    """All of them one after the other raise the peak of a process by less than 256 MB."""
    pytest.importorskip("mujoco")
    for case, (make, _) in CASES.items():
        folder = tmp_path / case.replace(" ", "-")
        folder.mkdir()
        for name, good in GOOD.items():
            (folder / name).write_bytes(make(name, good))
    run = subprocess.run(
        [sys.executable, "-c", MEASURE, str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT}"},
    )
    assert run.returncode == 0, run.stderr + run.stdout
    assert int(run.stdout) < 256


@pytest.mark.skipif(sys.platform == "win32", reason="FIFOs and folders are those of Unix")
def test_a_folder_in_place_of_the_output_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out.yaml").mkdir()
    code = "from vincula.cli.main import main; main()"
    run = subprocess.run(
        [sys.executable, "-c", code, "convert", "example:five-bar", str(tmp_path / "out.yaml")],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    assert run.returncode == 2, run.stderr
    assert "Traceback" not in run.stderr
    assert "out.yaml" in run.stderr
