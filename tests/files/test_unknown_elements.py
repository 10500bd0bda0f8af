"""Elements that nobody knows: harmless ones are ignored and counted, those that may be a loop are refused."""

from __future__ import annotations

import random
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.files.conventions import four_bar

import vincula as vc
from vincula.files.load import load_with_report
from vincula.files.xmltree import without_hyphens

TEXTS = {
    "robot.urdf": f'<robot name="linkage">{four_bar.TREE}</robot>',
    "model.sdf": four_bar.SDF_GRAPH,
}
HARMLESS = ("colour", "author", "remark", "vendor_data", "shape_hint")
SUSPICIOUS = ("my_loop", "closure", "joint_pair", "gearing", "weld_to", "rolling_contact", "linkage")


def with_extra(text: str, tag: str, chance: random.Random, *, inside: str) -> str:
    """The text with an unknown element in one of the elements of a tag."""
    root = ElementTree.fromstring(text)
    around = chance.choice([element for element in root.iter() if element.tag == inside])
    extra = ElementTree.Element(tag, {"name": f"extra{chance.randrange(100)}", "value": "3"})
    around.insert(chance.randint(0, len(around)), extra)
    return ElementTree.tostring(root, encoding="unicode")


@pytest.mark.parametrize("name", TEXTS)
def test_harmless_ones_are_ignored_and_counted(name: str, tmp_path: Path) -> None:
    chance = random.Random(name)
    path = tmp_path / name
    path.write_text(TEXTS[name], encoding="utf-8")
    mechanism, report = load_with_report(path)
    before = sum(count["total"] for count in report.counts().values())
    for inside in ("robot", "link", "joint") if name == "robot.urdf" else ("model", "link", "joint", "axis"):
        for tag in HARMLESS:
            path.write_text(with_extra(TEXTS[name], tag, chance, inside=inside), encoding="utf-8")
            same, longer = load_with_report(path)
            counts = longer.counts()
            assert counts[tag] == {"total": 1, "used": 0, "ignored": 1, "repaired": 0}
            assert sum(count["total"] for count in counts.values()) == before + 1
            assert [joint.name for joint in same.joints] == [joint.name for joint in mechanism.joints]


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("tag", SUSPICIOUS)
def test_possible_loops_are_refused(name: str, tag: str, tmp_path: Path) -> None:
    chance = random.Random(tag)
    for inside in ("robot" if name == "robot.urdf" else "model", "link", "joint"):
        path = tmp_path / name
        path.write_text(with_extra(TEXTS[name], tag, chance, inside=inside), encoding="utf-8")
        with pytest.raises(vc.FileError, match=rf"{path.name}:\d+:\d+: .*{tag}"):
            vc.load(path)


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("tag", ["axs", "jiont", "lnk", "posse", "orgin", "limmit"])
def test_slips_of_the_pen_are_refused(name: str, tag: str, tmp_path: Path) -> None:
    """An axis that is read as its default because its tag is misspelt would be a wrong mechanism."""
    path = tmp_path / name
    path.write_text(with_extra(TEXTS[name], tag, random.Random(tag), inside="joint"), encoding="utf-8")
    with pytest.raises(vc.FileError, match=rf"<{tag}> is not understood in <joint>: .*slip of the pen"):
        vc.load(path)


def test_namespaces_of_vendors_are_ignored(tmp_path: Path) -> None:
    """SDF allows elements of other namespaces everywhere."""
    path = tmp_path / "model.sdf"
    for around in ("<model ", "<link ", "<joint ", "<axis>"):
        at = TEXTS["model.sdf"].index(">", TEXTS["model.sdf"].index(around)) + 1
        text = (
            TEXTS["model.sdf"][:at]
            + '<gz:style gz:colour="red"><gz:shade/></gz:style>'
            + TEXTS["model.sdf"][at:]
        )
        path.write_text(text.replace("<sdf ", '<sdf xmlns:gz="g" ', 1), encoding="utf-8")
        assert load_with_report(path)[1].counts()["gz:style"]["ignored"] == 1


WORLD = """
<sdf version="1.9"><world name="w">
  <light name="sun" type="directional"/> <physics name="p" type="ode"/> <gravity>0 0 -9.8</gravity>
  <model name="floor"><static>true</static><link name="f"/></model>
  {}
</world></sdf>
"""


def test_the_one_model_of_a_world_that_moves_is_read(tmp_path: Path) -> None:
    text = TEXTS["model.sdf"]
    alone = load_with_report(_written(tmp_path / "model.sdf", text))[0]
    inside = WORLD.format(text[text.index("<model") : text.index("</sdf>")])
    mechanism, report = load_with_report(_written(tmp_path / "world.sdf", inside))
    assert [joint.name for joint in mechanism.joints] == [joint.name for joint in alone.joints]
    told = {entry.kind: entry.detail for entry in report.entries if entry.fate == "ignored"}
    assert told["model"] == "it is static: a part of the surroundings"
    assert {"light", "physics", "gravity"} <= told.keys()


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_counts_of_every_shared_model_add_up(models: Path) -> None:
    """Used, ignored and repaired make the total of every kind, and nothing has no fate."""
    paths = [p for p in sorted(models.glob("*/*")) if p.suffix in (".urdf", ".sdf")]
    paths += [
        models / "unitree_go1_mink" / "go1_nomesh.xml",
        models / "leap_hand_mink" / "right_hand_nomesh.xml",
    ]
    assert len(paths) > 8
    for path in paths:
        report = load_with_report(path)[1]
        for kind, count in report.counts().items():
            assert count["total"] == count["used"] + count["ignored"] + count["repaired"] > 0, (path, kind)
        assert sum(e.count for e in report.entries) == sum(c["total"] for c in report.counts().values())
        assert all(e.detail for e in report.entries if e.fate != "used"), path
        if path.suffix == ".xml":
            continue
        text = without_hyphens(path.read_text(encoding="utf-8"))[0].replace("drake:", "drake_")
        root = ElementTree.fromstring(text)
        tags = [element.tag for element in (root if root.tag == "robot" else root.iter())]
        for tag in ("link", "joint"):
            told = sum(e.count for e in report.entries if e.kind == tag and e.fate == "used")
            assert told == tags.count(tag), (path, tag)
