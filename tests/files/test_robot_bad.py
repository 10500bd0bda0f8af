"""Bad URDF and SDF files: each refused with the right class, element and line, by its golden message."""

from __future__ import annotations

import re
import sys
import time
from pathlib import Path

import pytest
from tests.conftest import ROOT

import vincula as vc
from vincula.files.load import load_with_report

FOLDER = ROOT / "tests" / "files" / "bad"
FILES = sorted(
    f"{kind}/{path.name}" for kind in ("urdf", "sdf") for path in (FOLDER / kind).glob(f"*.{kind}")
)
UNSUPPORTED = {
    "urdf/unknown-drake-constraint.urdf", "urdf/unknown-drake-joint.urdf", "urdf/unknown-transmission.urdf",
    "sdf/drake-curve.sdf", "sdf/drake-tendon.sdf", "sdf/gearbox.sdf", "sdf/include.sdf",
    "sdf/joint-between-models.sdf", "sdf/nested-model.sdf", "sdf/two-models.sdf", "sdf/world.sdf",
}  # fmt: skip
NOWHERE = {
    "urdf/namespace.urdf", "urdf/wrong-root.urdf", "urdf/unexpanded-xacro.urdf", "urdf/no-links.urdf",
    "urdf/no-root.urdf", "sdf/no-links.sdf", "sdf/template.sdf",
}  # fmt: skip


def told(error: vc.FileError) -> str:
    """The message without the list of formats, which grows."""
    return re.sub(r"that can be read: .*", "that can be read: ...", f"{error}\n")


def golden(name: str) -> str:
    text = (FOLDER / name).with_suffix(".expected.txt").read_text(encoding="utf-8")
    return re.sub(r"that can be read: .*", "that can be read: ...", text)


@pytest.mark.parametrize("name", FILES)
def test_golden_message(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir((FOLDER / name).parent)
    monkeypatch.setitem(sys.modules, "xacro", None)  # with the extra a xacro is no bad file
    start = time.process_time()
    with pytest.raises(vc.FileError) as refused:
        vc.load(Path(name).name)
    assert time.process_time() - start < 1.0
    assert told(refused.value) == golden(name)
    assert isinstance(refused.value, vc.UnsupportedFeatureError) == (name in UNSUPPORTED)


@pytest.mark.parametrize("name", FILES)
def test_messages_name_file_line_and_column(name: str) -> None:
    """But for files of which nothing can be read, or which lack something as a whole."""
    last = golden(name).rstrip("\n").splitlines()[-1]
    file = Path(name).name
    assert re.match(rf"{re.escape(file)}:[1-9]\d*:[1-9]\d*: ", last) or name in NOWHERE


def test_every_golden_message_has_its_file() -> None:
    for kind in ("urdf", "sdf"):
        texts = {path.name.removesuffix(".expected.txt") for path in (FOLDER / kind).glob("*.txt")}
        assert texts == {path.stem for path in (FOLDER / kind).glob(f"*.{kind}")}


HOSTILE = {
    "deep": ("<robot>" + "<link>" * 100_000, "nested more than 64 deep"),
    "many elements": ("<robot>" + "<link/>" * 250_000 + "</robot>", "more than 200000 elements"),
    "long attribute": (f'<robot name="{"x" * 7_000_000}"/>', "more than 65536 characters"),
    "million digits": (
        "<robot><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/>"
        "<child link='b'/><origin xyz='{} 0 0'/></joint></robot>".format("1" * 60_000),
        "expected a finite number",
    ),
    "many links": (
        "<robot>" + "".join(f'<link name="l{k}"/>' for k in range(5_000)) + "</robot>",
        "more than 2000 links|connected to nothing",
    ),
    "long chain of frames": (
        '<sdf version="1.9"><model name="m"><link name="a"/>'
        + "".join(f'<frame name="f{k}"><pose relative_to="f{k + 1}"/></frame>' for k in range(4_000))
        + "</model></sdf>",
        "more than 50 problems",
    ),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_are_refused_quickly(kind: str, tmp_path: Path) -> None:
    text, expected = HOSTILE[kind]
    path = tmp_path / "hostile.xml"
    path.write_text(text, encoding="utf-8")
    start = time.process_time()
    with pytest.raises(vc.FileError, match=expected):
        vc.load(path)
    assert time.process_time() - start < 3.0


def test_line_ends_of_windows_are_no_problem(tmp_path: Path) -> None:
    text = '<robot name="r">\n<link name="a"/>\n<link name="b"/>\n<joint name="j" type="fixed">\n'
    text += '<parent link="a"/>\n<child link="b"/>\n</joint>\n</robot>\n'
    path = tmp_path / "r.txt"
    path.write_bytes(text.replace("\n", "\r\n").encode())
    assert [body.name for body in vc.load(path).bodies] == ["b"]


def test_meshes_are_never_opened(tmp_path: Path) -> None:
    for file in (
        "../../../../etc/passwd",
        "file:///etc/passwd",
        "package://x/../../y",
        "http://example.org/a",
    ):
        path = tmp_path / "r.urdf"
        shape = f'<visual><geometry><mesh filename="{file}"/></geometry></visual>'
        path.write_text(f'<robot name="r"><link name="a">{shape}</link></robot>', encoding="utf-8")
        assert load_with_report(path)[1].counts()["visual"]["ignored"] == 1
