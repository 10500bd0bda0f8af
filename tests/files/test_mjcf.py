"""What an MJCF file becomes: names, motors, couplings, keyframes, frames, limits, digits, the report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.files.mjcf import load_mjcf
from vincula.files.report import LoadReport
from vincula.files.source import decode
from vincula.mechanism.mechanism import Mechanism

pytest.importorskip("mujoco")


def read(text: str) -> tuple[Mechanism, LoadReport]:
    return load_mjcf(decode(text.encode(), "text.xml"))


def model(tree: str, sections: str = "") -> str:
    return f"<mujoco><worldbody>{tree}</worldbody>{sections}</mujoco>"


TWO = '<body name="a"><joint name="j"/><body name="b"><joint name="k" type="slide"/></body></body>'
BALL = '<body name="a"><joint name="s" type="ball"/></body>'


def test_what_has_no_name_is_called_by_kind_and_index() -> None:
    robot, _ = read(
        model(
            '<body><joint/><body name="x"><joint name="jnt0"/><body/></body></body>',
            '<actuator><motor joint="jnt0"/></actuator><keyframe><key qpos="0 0"/></keyframe>',
        )
    )
    assert [b.name for b in robot.bodies] == ["body1", "x", "body3"]
    assert [j.name for j in robot.joints] == ["jnt0_", "jnt0", "body3.fixed"]
    assert dict(robot.motors) == {"actuator0": "jnt0"}
    assert list(robot.keyframes) == ["key0"]


def test_a_body_called_ground_is_told_from_the_fixed_one() -> None:
    robot, report = read(model('<body name="ground"><joint name="j"/></body>'))
    assert [b.name for b in robot.bodies] == ["body1"]
    assert report.counts()["body"]["repaired"] == 1


def test_several_joints_of_a_body_are_a_chain() -> None:
    robot, _ = read(model('<body name="b"><joint name="j"/><joint name="k"/><joint name="l"/></body>'))
    assert [b.name for b in robot.bodies] == ["b:j", "b:k", "b"]
    assert [(j.first, j.second) for j in robot.joints] == [("ground", "b:j"), ("b:j", "b:k"), ("b:k", "b")]


def test_motors_on_joints() -> None:
    robot, report = read(
        model(
            TWO,
            '<actuator><position name="one" joint="j" gear="50"/><velocity name="two" joint="j"/>'
            '<motor name="three" jointinparent="k"/></actuator>',
        )
    )
    assert robot.active == ("j", "k")
    assert dict(robot.motors) == {"one": "j", "two": "j", "three": "k"}
    assert robot.with_active("two").active == ("j",)
    assert report.counts()["motor"] == {"total": 3, "used": 3, "ignored": 0, "repaired": 0}
    details = {e.name: e.detail for e in report.entries if e.kind == "motor"}
    assert "gear 50 is not used" in details["one"]
    assert "one motor with another actuator" in details["two"]


def test_motors_on_balls_and_free_bodies() -> None:
    free = '<body name="f"><freejoint name="fly"/></body>'
    robot, report = read(
        model(
            BALL + free,
            '<actuator><motor name="x" joint="s"/><motor name="mix" joint="s" gear="0 3 4 0 0 0"/>'
            '<motor name="z" joint="fly" gear="0 0 -2 0 0 0"/><motor name="p" jointinparent="s"/>'
            '<motor name="up" jointinparent="fly" gear="0 0 1 0 0 0"/></actuator>',
        )
    )
    assert dict(robot.motors) == {"x": "s.x", "mix": "mix", "z": "fly.vz", "up": "fly.vz"}
    assert [(d.name, dict(d.drives)) for d in robot.drives] == [("mix", {"s.y": 0.6, "s.z": 0.8})]
    assert [e.name for e in report.entries if e.kind == "motor" and e.fate == "ignored"] == ["p"]


def test_motors_on_tendons_are_drives() -> None:
    robot, report = read(
        model(
            TWO,
            '<tendon><fixed name="t"><joint joint="j" coef="2"/><joint joint="k" coef="-.5"/></fixed>'
            '<fixed name="u"><joint joint="j" coef="1"/></fixed></tendon>'
            '<actuator><motor name="j" tendon="t"/><motor name="again" tendon="t"/></actuator>',
        )
    )
    assert [(d.name, dict(d.drives)) for d in robot.drives] == [("j_", {"j": 2.0, "k": -0.5})]
    assert robot.active == ("j_",)
    assert dict(robot.motors) == {"j": "j_", "again": "j_"}
    assert report.counts()["tendon"] == {"total": 2, "used": 1, "ignored": 1, "repaired": 0}


def test_what_is_no_motor_is_told() -> None:
    robot, report = read(
        '<mujoco><option actuatorgroupdisable="2"/><worldbody>'
        + TWO.replace("</body></body>", '<site name="s"/></body></body>')
        + '<site name="t" pos="1 0 0"/></worldbody><tendon><spatial name="rope"><site site="s"/>'
        '<site site="t"/></spatial></tendon><actuator><motor name="rope" tendon="rope"/>'
        '<motor name="site" site="s"/><adhesion name="body" body="b" ctrlrange="0 1"/>'
        '<motor name="off" joint="j" group="2"/></actuator></mujoco>'
    )
    assert robot.active == ()
    assert {e.name for e in report.entries if e.kind == "motor" and e.fate == "ignored"} == {
        "rope", "site", "body", "off",
    }  # fmt: skip


def test_couplings() -> None:
    robot, _ = read(
        model(
            '<body name="a"><joint name="j" ref="90"/><body name="b"><joint name="k"/></body></body>',
            '<equality><joint name="gear" joint1="k" joint2="j" polycoef=".1 2 3 0 0"/>'
            '<joint joint1="j"/></equality>',
        )
    )
    gear, held = robot.couplings
    assert (gear.name, dict(gear.rates), dict(gear.driver)) == ("gear", {"k": 1.0}, {"j": 1.0})
    assert tuple(gear.polynomial) == (0.1, 2.0, 3.0, 0.0, 0.0)
    assert dict(gear.references) == {"k": 0.0, "j": pytest.approx(np.pi / 2)}
    assert (held.name, dict(held.rates), dict(held.driver)) == ("coupling:j", {"j": 1.0}, {})


def test_loops_have_names_and_inactive_ones_are_told() -> None:
    loops = (
        '<connect body1="a" body2="b" anchor="0 0 0"/><connect body1="a" body2="b" anchor="1 0 0"/>'
        '<weld name="w" body1="b" active="false"/><joint joint1="j" active="false"/>'
    )
    robot, report = read(model(TWO, f"<equality>{loops}</equality>"))
    closures = [j for j in robot.joints if j.closure]
    assert [j.name for j in closures] == ["connect:a-b", "connect:a-b_"]
    assert [(j.type, j.cut) for j in closures] == [("spherical", "contact")] * 2
    assert not robot.couplings
    assert report.counts()["equality"] == {"total": 4, "used": 2, "ignored": 2, "repaired": 0}
    disabled = f'<option><flag equality="disable"/></option><equality>{loops}</equality>'
    robot, report = read(model(TWO, disabled))
    assert not [j for j in robot.joints if j.closure]
    assert report.counts()["equality"]["ignored"] == 4


def test_keyframes_are_configurations() -> None:
    robot, _ = read(
        model(
            BALL + '<body name="f" pos="0 0 1"><freejoint name="fly"/></body>',
            '<keyframe><key name="away" qpos="2 0 0 0  1 2 3 0 1 0 0"/></keyframe>',
        )
    )
    q = robot.configuration(robot.keyframes["away"])
    assert np.array_equal(q["s"], [1, 0, 0, 0])
    assert np.array_equal(q["fly"], [1, 2, 3, 0, 1, 0, 0])
    assert np.array_equal(robot.home["fly"], [0, 0, 1, 1, 0, 0, 0])
    assert robot.joint["fly"].first == "ground"


def test_sites_are_frames_and_reference_points() -> None:
    robot, report = read(
        model(TWO.replace("</body></body>", '<site name="tip" pos="0 0 .1"/></body></body>'))
    )
    assert [(f.name, f.body) for f in robot.frames] == [("tip", "b")]
    assert np.array_equal(robot.with_reference("b", frame="tip").reference.origin, [0, 0, 0.1])  # type: ignore[union-attr]
    assert report.counts()["site"]["used"] == 1


def test_limits() -> None:
    robot, _ = read(
        model(
            '<body name="a"><joint name="j" range="-90 45"/>'
            '<body name="b"><joint name="k" actuatorfrcrange="-3 2"/>'
            '<body name="c"><joint name="l"/></body></body></body>',
            '<actuator><motor joint="j" forcerange="-2 3" gear="-10"/><motor joint="k"/></actuator>',
        )
    )
    j, k, free = (robot.joint[name].limits for name in "jkl")
    assert j[0].lower == pytest.approx(-np.pi / 2)
    assert j[0].upper == pytest.approx(np.pi / 4)
    assert (j[0].effort, k[0].effort, k[0].lower) == (30.0, 3.0, None)
    assert free == ()


def test_springs_are_told() -> None:
    _, report = read(model('<body name="a"><joint name="j" stiffness="2"/></body>'))
    assert any("springs" in note and "j" in note for note in report.notes)


def test_the_report_accounts_for_every_element(models: Path) -> None:
    from vincula.files.mjcf_document import read_document
    from vincula.files.source import open_source

    path = models / "aloha_mink" / "aloha_nomesh.xml"
    report = load_mjcf(path)[1]
    counts = report.counts()
    written: dict[str, int] = {}
    for element in read_document(open_source(path)).root.walk():
        written[element.tag] = written.get(element.tag, 0) + 1
    inside_defaults = {"geom": 3}
    for tag in (
        "body",
        "site",
        "geom",
        "inertial",
        "camera",
        "light",
        "default",
        "material",
        "exclude",
        "option",
    ):
        assert counts[tag]["total"] == written[tag] - inside_defaults.get(tag, 0) - (tag == "site"), tag
    assert counts["include"]["used"] == 2
    assert counts["motor"]["used"] == 14
    for kind, count in counts.items():
        assert count["total"] == count["used"] + count["ignored"] + count["repaired"], kind
    for entry in report.entries:
        assert entry.fate != "ignored" or entry.detail


def test_typed_digits() -> None:
    def digits(tree: str, compiler: str = "") -> tuple[float, float]:
        robot, _ = read(f"<mujoco><compiler {compiler}/><worldbody>{tree}</worldbody></mujoco>")
        return robot.precision.digits_length, robot.precision.digits_angle

    joint = '<joint name="j"/>'
    assert digits(f'<body pos="0.5 1.25 0.0061">{joint}</body>') == (0.0, 0.0)
    assert digits(f'<body pos="0.70711 0 0">{joint}</body>') == (pytest.approx(5e-6), 0.0)
    assert digits(f'<body euler="0 0 1.5708">{joint}</body>', 'angle="radian"') == (0.0, pytest.approx(5e-5))
    turned = digits(f'<body euler="0 0 12.3456">{joint}</body>')
    assert turned == (0.0, pytest.approx(np.radians(5e-5)))
    assert digits(f'<body quat="0.7071 0 0 0.7071">{joint}</body>')[1] == pytest.approx(1e-4, rel=1e-3)
    assert digits('<body><joint name="j" axis="0 0 2" pos="0 0.12345 0"/></body>')[0] == pytest.approx(5e-6)
    assert digits('<body pos="0.12345 0 0"><freejoint/></body>') == (0.0, 0.0)
    assert digits(f'<body>{joint}<site pos="0.12345 0 0"/></body>') == (0.0, 0.0)


def test_includes_and_attached_models(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "leg.xml").write_text(
        "<x>" + TWO + '<include file="toe.xml"/></x>', encoding="utf-8"
    )
    (tmp_path / "parts" / "toe.xml").write_text('<x><body name="toe"/></x>', encoding="utf-8")
    (tmp_path / "parts" / "arm.xml").write_text(model(BALL), encoding="utf-8")
    path = tmp_path / "robot.xml"
    path.write_text(
        '<mujoco model="walker"><asset><model name="arm" file="parts/arm.xml"/></asset><worldbody>'
        '<include file="parts/leg.xml"/><frame pos="0 0 1">'
        '<attach model="arm" body="a" prefix="left_"/></frame></worldbody></mujoco>',
        encoding="utf-8",
    )
    robot, report = load_mjcf(path)
    assert robot.name == "walker"
    assert [b.name for b in robot.bodies] == ["a", "b", "toe", "left_a"]
    assert report.counts()["include"]["used"] == 2
    assert report.counts()["attach"]["used"] == 1
    path.write_text(model(TWO), encoding="utf-8")
    assert load_mjcf(path)[0].name == "robot"


def test_sites_and_tendons_may_have_materials() -> None:
    text = model(
        TWO.replace("</body></body>", '<site name="s" material="red"/></body></body><site name="t"/>'),
        '<tendon><spatial name="rope" material="red"><site site="s"/><site site="t"/></spatial></tendon>'
        '<default><site material="red"/></default><asset><material name="red"/></asset>',
    )
    assert [f.name for f in read(text)[0].frames] == ["t", "s"]


def test_compiler_switches_that_would_change_the_bodies_are_told() -> None:
    text = model('<body name="a"><joint/><body name="b"/></body>', '<compiler fusestatic="true"/>')
    robot, report = read(text)
    assert "b" in robot.body
    assert any("fusestatic" in note for note in report.notes)


def test_mujoco_leaves_no_log_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.xml").write_text(
        model(TWO + '<body name="c"><joint name="free" type="free" range="0 1"/></body>'), encoding="utf-8"
    )
    load_mjcf("m.xml")
    with pytest.raises(vc.FileError):
        read(model('<body name="a"><joint name="j" axs="0"/></body>'))
    assert sorted(p.name for p in Path().iterdir()) == ["m.xml"]
    assert capfd.readouterr() == ("", "")


def test_legal_extremes() -> None:
    for tree, sections in (("", ""), (TWO, ""), ('<body name="a"/>', "")):
        robot, _ = read(model(tree, sections))
        assert robot.active == ()
    assert read("\ufeff" + model(TWO).replace("><", ">\r\n<"))[0].joints


def test_mujoco_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(vc.MissingExtraError, match=r"vincula\[mujoco\]"):
        read(model(TWO))
