"""Bad MJCF files: each refused with the right class, element and line, by its golden message."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import pytest
from tests.conftest import ROOT

import vincula as vc
from vincula.files.mjcf import load_mjcf

pytest.importorskip("mujoco")

FOLDER = ROOT / "tests" / "files" / "bad" / "mjcf"
FILES = sorted(path.stem for path in FOLDER.glob("*.xml"))
UNSUPPORTED = {"plugin", "soft-body", "soft-equality", "tendon-through-space"}


def told(error: vc.FileError) -> str:
    """The message without the words that are MuJoCo's own, which change between its versions."""
    return re.sub(r"MuJoCo: [^;\n]*", "MuJoCo: ...", str(error)) + "\n"


@pytest.mark.parametrize("name", FILES)
def test_golden_message(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FOLDER)
    before = sorted(Path().iterdir())
    with pytest.raises(vc.FileError) as refused:
        load_mjcf(f"{name}.xml")
    assert told(refused.value) == (FOLDER / f"{name}.expected.txt").read_text(encoding="utf-8")
    assert isinstance(refused.value, vc.UnsupportedFeatureError) == (name in UNSUPPORTED)
    assert sorted(Path().iterdir()) == before


def test_every_golden_message_has_its_file() -> None:
    assert sorted(path.name.removesuffix(".expected.txt") for path in FOLDER.glob("*.txt")) == FILES


def world(inside: str) -> str:
    return f"<mujoco><worldbody>{inside}</worldbody></mujoco>"


HOSTILE = {
    "large": ("<!-- " + "x" * (8 << 20) + " --><mujoco/>", "bytes, at most"),
    "deep": ("<mujoco>" + "<body>" * 100_000, "nested more than 64 deep"),
    "many elements": ("<mujoco>" + "<a/>" * 250_000 + "</mujoco>", "more than 200000 elements"),
    "long attribute": (f'<mujoco model="{"x" * 7_000_000}"/>', "more than 65536 characters"),
    "million digits": (world(f'<body pos="{"1" * 1_000_000} 0 0"/>'), "more than 65536 characters"),
    "many attributes": (
        "<mujoco " + " ".join(f'a{k}="1"' for k in range(1000)) + "/>",
        "more than 256 attributes",
    ),
    "copies of copies": (
        world('<replicate count="99999999">' * 50 + "<body/>" + "</replicate>" * 50),
        "with all copies",
    ),
    "endless chain": (world('<body><composite type="cable" count="9999999 1 1"/></body>'), "with all copies"),
    "endless count": (
        world(f'<replicate count="{"9" * 5000}"><body/></replicate>'),
        "expected finite numbers",
    ),
    "many bodies": (world("<body/>" * 2_001), "2001 bodies"),
    "long name": (world(f'<body name="{"n" * 300}"/>'), "at most 256 characters"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_are_refused_quickly(kind: str, tmp_path: Path) -> None:
    text, expected = HOSTILE[kind]
    path = tmp_path / "hostile.xml"
    path.write_text(text, encoding="utf-8")
    start = time.process_time()
    with pytest.raises(vc.FileError, match=expected):
        load_mjcf(path)
    assert time.process_time() - start < 2.0


def test_folders_fifos_devices_and_absent_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo.xml")
    for path, expected in (
        (tmp_path, "a directory"),
        (tmp_path / "fifo.xml", "a FIFO"),
        (Path("/dev/zero"), "a device"),
        (tmp_path / "absent.xml", "no such file"),
    ):
        with pytest.raises(vc.FileError, match=expected):
            load_mjcf(path)


def test_links_out_of_the_folder_are_not_followed(tmp_path: Path) -> None:
    (tmp_path / "secret.xml").write_text("<x><body/></x>", encoding="utf-8")
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "part.xml").symlink_to(tmp_path / "secret.xml")
    (folder / "loop.xml").symlink_to(folder / "loop.xml")
    path = folder / "robot.xml"
    path.write_text('<mujoco><worldbody><include file="part.xml"/></worldbody></mujoco>', encoding="utf-8")
    with pytest.raises(vc.FileError, match="outside the folder"):
        load_mjcf(path)
    assert len(load_mjcf(path, roots=[tmp_path])[0].bodies) == 1
    path.write_text('<mujoco><worldbody><include file="loop.xml"/></worldbody></mujoco>', encoding="utf-8")
    with pytest.raises(vc.FileError, match=r"robot\.xml:1:20: .*loop\.xml"):
        load_mjcf(path)


def test_meshes_are_never_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "mesh.stl")
    path = tmp_path / "robot.xml"
    for file in ("mesh.stl", "../../../../etc/passwd", "file:///etc/passwd", "http://example.com/a.stl"):
        asset = f'<mesh name="m" file="{file}"/><texture name="t" type="2d" file="{file}"/>'
        body = '<body name="b"><joint/><geom type="mesh" mesh="m"/></body>'
        text = world(body).replace("<worldbody>", f"<asset>{asset}</asset><worldbody>")
        path.write_text(text, encoding="utf-8")
        report = load_mjcf(path)[1]
        assert report.counts()["mesh"] == {"total": 1, "used": 0, "ignored": 1, "repaired": 0}


def test_two_includes_that_include_each_other(tmp_path: Path) -> None:
    for one, two in (("a", "b"), ("b", "a")):
        (tmp_path / f"{one}.xml").write_text(f'<x><include file="{two}.xml"/></x>', encoding="utf-8")
    (tmp_path / "m.xml").write_text('<mujoco><include file="a.xml"/></mujoco>', encoding="utf-8")
    with pytest.raises(vc.FileError, match=r"b\.xml:1:4: .*included twice"):
        load_mjcf(tmp_path / "m.xml")


def test_too_many_includes(tmp_path: Path) -> None:
    for k in range(40):
        (tmp_path / f"{k}.xml").write_text("<x><site/></x>", encoding="utf-8")
    words = "".join(f'<include file="{k}.xml"/>' for k in range(40))
    (tmp_path / "m.xml").write_text(f"<mujoco><worldbody>{words}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(vc.FileError, match="more than 32 included files"):
        load_mjcf(tmp_path / "m.xml")


def test_an_error_in_an_included_file_is_told_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("part.xml").write_text(
        '<x>\n  <body name="b">\n    <joint axs="1 0 0"/>\n  </body>\n</x>', encoding="utf-8"
    )
    Path("m.xml").write_text(
        '<mujoco><worldbody>\n<include file="part.xml"/></worldbody></mujoco>', encoding="utf-8"
    )
    with pytest.raises(
        vc.FileError, match=r"^part\.xml:3:5: mujoco/worldbody/body\[@name='b'\]/joint: .*'axis'\?$"
    ):
        load_mjcf("m.xml")


def test_an_error_in_an_attached_model_is_told_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    child = world('\n<body name="b">\n<joint name="j" range="1 -1" limited="true"/></body>')
    Path("child.xml").write_text(child, encoding="utf-8")
    asset = '<asset><model name="c" file="child.xml"/></asset><worldbody>'
    text = world('<attach model="c" body="b" prefix="p_"/>').replace("<worldbody>", asset)
    Path("m.xml").write_text(text, encoding="utf-8")
    with pytest.raises(vc.FileError, match=r"^child\.xml:3:1: "):
        load_mjcf("m.xml")
