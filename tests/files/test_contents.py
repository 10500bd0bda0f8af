"""Everything in a file has a fate: used, ignored or repaired; counted here with other parsers."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from ruamel.yaml import YAML
from tests.files.conventions import five_bar, four_bar
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR

from vincula.files.load import load_with_report
from vincula.files.xmltree import without_hyphens

FILES = Path(__file__).parent
NO_MODELS = ("keyframe_no_act.xml", "keyframe_ctrl.xml", "filtered_cartesian", "joint_position_actuators")


def in_xml(path: Path) -> tuple[int, int]:
    """Elements and attributes of a file and of what it includes; namespaces are no attributes there."""
    text = without_hyphens(path.read_text(encoding="utf-8"))[0]
    text = re.sub(r"<(/?)([a-z]+):", r"<\1\2_", text)
    text = re.sub(r" ([a-z]+):([\w:]+=)", r" \1_\2", text)
    elements = list(ElementTree.fromstring(text).iter())
    here = len(elements), sum(len(element.attrib) for element in elements)
    inside = [in_xml(path.parent / e.attrib["file"]) for e in elements if e.tag == "include"]
    return here[0] + sum(e for e, _ in inside), here[1] + sum(a for _, a in inside)


def in_tree(value: Any) -> int:
    """Values of a plain tree; an empty list or table is one."""
    inside = list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else []
    return sum(map(in_tree, inside)) if inside else 1


def in_yaml(path: Path) -> int:
    text = path.read_text(encoding="utf-8")
    return in_tree(json.loads(text) if path.suffix == ".json" else YAML(typ="safe").load(text))


def beside(path: Path) -> Iterator[Path]:
    """Side files that are read with a URDF file."""
    if path.suffix == ".urdf":
        found = (path.with_suffix(".yaml"), path.parent / "robot.yaml")
        yield from [file for file in found if file.is_file()][:1]


def check(path: Path) -> None:
    """Compare the report of a file with what is in it."""
    report = load_with_report(path)[1]
    contents = report.to_dict()["contents"]
    for kind, count in contents.items():
        assert count["total"] == count["used"] + count["ignored"] + count["repaired"], (path, kind)
        assert min(count.values()) >= 0, (path, kind)
    xml = path.suffix in (".urdf", ".sdf", ".xml")
    elements, attributes = in_xml(path) if xml else (0, 0)
    values = sum(map(in_yaml, [*beside(path), *([] if xml else [path])]))
    told = {kind: count["total"] for kind, count in contents.items()}
    assert told.get("elements", 0) == elements, path
    assert told.get("attributes", 0) == attributes, path
    assert told.get("values", 0) == values, path
    assert all(entry.detail for entry in report.entries if entry.fate != "used"), path


def test_of_every_shared_model(models: Path) -> None:
    paths = [p for p in sorted(models.glob("*/*")) if p.suffix in (".urdf", ".sdf", ".xml")]
    paths = [p for p in paths if not p.name.startswith(NO_MODELS)]
    assert len(paths) > 12
    for path in paths:
        check(path)


def test_of_every_mjcf_fixture() -> None:
    for path in sorted((FILES / "mjcf").glob("*.xml")):
        check(path)


def test_of_every_native_fixture(tmp_path: Path) -> None:
    paths = sorted((FILES / "legal" / "native").glob("*"))
    texts = {"five-bar.yaml": FIVE_BAR, "all.yaml": ALL_JOINTS, "four-bar.yaml": four_bar.NATIVE_SPATIAL}
    for name, text in texts.items():
        paths.append(tmp_path / name)
        paths[-1].write_text(text, encoding="utf-8")
    for path in paths:
        if path.suffix in (".yaml", ".json") and "\nbase:" not in path.read_text(encoding="utf-8"):
            check(path)


@pytest.mark.parametrize("linkage", [four_bar, five_bar])
def test_of_every_convention(linkage: Any, tmp_path: Path) -> None:
    head = '<robot name="linkage" xmlns:drake="d">'
    for number, text in enumerate(linkage.URDF.values()):
        path = tmp_path / f"linkage{number}.urdf"
        path.write_text(f"{head}{linkage.TREE}{text}</robot>", encoding="utf-8")
        check(path)
    texts = [text for name, text in vars(linkage).items() if name.startswith("SDF") and isinstance(text, str)]
    for number, text in enumerate(texts):
        path = tmp_path / f"linkage{number}.sdf"
        path.write_text(text, encoding="utf-8")
        check(path)


COUNTED = """
<robot name="arm" version="1.0">
  <link name="a" vendor="x"><visual><geometry><box size="1 1 1"/></geometry></visual></link> <link name="b"/>
  <joint name="j" type="fixed">
    <parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="1 0 0"/>
  </joint>
  <colour rgba="1 0 0 1"/>
</robot>
"""


def test_the_fates_are_right(tmp_path: Path) -> None:
    """Counted by hand: an axis of a fixed joint, a picture, a colour and two attributes are ignored."""
    path = tmp_path / "arm.urdf"
    path.write_text(COUNTED, encoding="utf-8")
    report = load_with_report(path)[1]
    contents = report.to_dict()["contents"]
    assert contents["elements"] == {"total": 12, "used": 7, "ignored": 5, "repaired": 0}
    assert contents["attributes"] == {"total": 13, "used": 8, "ignored": 5, "repaired": 0}
    ignored = {(e.kind, e.name) for e in report.entries if e.fate == "ignored"}
    assert ignored == {
        ("visual", "a"), ("axis", "j"), ("colour", ""), ("attribute", "robot/@version"),
        ("attribute", "link/@vendor"),
    }  # fmt: skip


def test_a_joint_that_a_side_file_retypes_is_repaired(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(COUNTED.replace("fixed", "revolute"), encoding="utf-8")
    (tmp_path / "arm.yaml").write_text(
        "name_mot: []\njoint_name: [j]\njoint_type: [SPHERICAL]\nLidmot: [0, 1]\n", encoding="utf-8"
    )
    report = load_with_report(path)[1]
    contents = report.to_dict()["contents"]
    assert contents["elements"] == {"total": 12, "used": 7, "ignored": 4, "repaired": 1}
    assert contents["values"] == {"total": 5, "used": 3, "ignored": 2, "repaired": 0}
    assert report.counts()["joint"] == {"total": 1, "used": 0, "ignored": 0, "repaired": 1}
