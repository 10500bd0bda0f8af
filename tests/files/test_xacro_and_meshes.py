"""xacro files are expanded in a guarded process; paths of meshes are looked up and never opened."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

import vincula as vc
from vincula.files.load import load_with_report
from vincula.files.packages import Packages

HEAD = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
ARM = (
    HEAD
    + """
  <xacro:arg name="reach" default="1.5"/>
  <xacro:property name="half" value="${0.5 * $(arg reach)}"/>
  <xacro:macro name="piece" params="k parent">
    <link name="l${k}"/>
    <joint name="j${k}" type="continuous"><parent link="${parent}"/><child link="l${k}"/>
      <origin xyz="${half} 0 ${sin(pi/6)}"/><axis xyz="0 0 1"/></joint>
  </xacro:macro>
  <link name="base"/> <xacro:piece k="1" parent="base"/> <xacro:piece k="2" parent="l1"/>
</robot>"""
)


def written(folder: Path, text: str, name: str = "arm.urdf.xacro") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def xacro() -> None:
    pytest.importorskip("xacro")


@pytest.mark.parametrize("comment", ["${15 * deg}", "$(find arm)", "<xacro:piece k='1'/>"])
def test_what_xacro_has_expanded_is_read_as_it_is(
    comment: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It keeps the namespace, and the comments of the macros; without the extra it must be read too."""
    monkeypatch.setitem(sys.modules, "xacro", None)
    text = f'{HEAD}<link name="base"/><!-- upper="{comment}" -->\n<!-- made from arm.xacro --></robot>'
    robot, report = load_with_report(written(tmp_path, text, "arm.urdf"))
    assert robot.bodies == ()
    assert report.notes == []


@pytest.mark.usefixtures("xacro")
def test_a_xacro_is_expanded_and_read(tmp_path: Path) -> None:
    robot, report = load_with_report(written(tmp_path, ARM))
    assert robot.body["l2"].pose.position == pytest.approx([1.5, 0.0, 1.0], abs=1e-15)
    assert any("expanded from xacro" in note for note in report.notes)
    assert report.format == "URDF"
    longer = vc.load(written(tmp_path, ARM), {"reach": 3})
    assert longer.body["l1"].pose.position[0] == 1.5
    with pytest.raises(vc.UnknownNameError, match="reach"):
        vc.load(written(tmp_path, ARM), {"rech": 3})


def test_without_the_extra_a_xacro_is_refused_with_advice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xacro", None)
    with pytest.raises(vc.FileError, match=r"xacro FILE > robot.urdf.*vincula\[xacro\]"):
        vc.load(written(tmp_path, ARM))


@pytest.mark.usefixtures("xacro")
def test_includes_from_the_folder_and_from_packages(tmp_path: Path) -> None:
    macros = ARM.split("\n  <link")[0].replace("</robot>", "") + "\n</robot>"
    use = '\n  <link name="base"/> <xacro:piece k="1" parent="base"/></robot>'
    written(tmp_path / "arms" / "urdf", macros, "macros.xacro")
    beside = written(tmp_path / "arms" / "urdf", HEAD + '<xacro:include filename="macros.xacro"/>' + use)
    own = HEAD + '<xacro:include filename="$(find arms)/urdf/macros.xacro"/>' + use
    within = written(tmp_path / "arms" / "robots", own)
    elsewhere = written(tmp_path / "other", own)
    for path in (beside, within):
        assert "l1" in vc.load(path).body
    assert "l1" in vc.load(elsewhere, package_dirs=[tmp_path]).body
    assert "l1" in vc.load(elsewhere, package_dirs=[tmp_path / "arms"]).body
    with pytest.raises(vc.FileError, match="no package 'arms'"):
        vc.load(elsewhere)


ATTACKS = {
    "file outside": ('<xacro:include filename="../secret.xacro"/>', "outside"),
    "absolute file": ('<xacro:include filename="/etc/hostname"/>', "outside"),
    "yaml outside": ("<link name=\"${xacro.load_yaml('../secret.xacro')}\"/>", "outside"),
    "builtins": ('<link name="${().__class__.__bases__}"/>', "__"),
    "environment": ('<link name="$(env HOME)"/>', "HOME"),
    "endless macro": ('<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>', ""),
    "large": ("<link name=\"${'a' * 3000000000}\"/>", ""),
    "long": ('<link name="${len([0 for a in range(10**9)])}"/>', ""),
    "entities": ('<xacro:include filename="laughs.xacro"/>', "document types"),
    "missing file": ('<xacro:include filename="nothing.xacro"/>', "nothing.xacro"),
}


@pytest.mark.usefixtures("xacro")
@pytest.mark.parametrize("attack", ATTACKS)
def test_what_a_xacro_may_not_do(attack: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "somewhere")
    inside, message = ATTACKS[attack]
    written(tmp_path, HEAD + "<link name='secret'/></robot>", "secret.xacro")
    written(tmp_path / "robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot>&a;</robot>', "laughs.xacro")
    path = written(tmp_path / "robot", f"{HEAD}{inside}</robot>")
    start = time.monotonic()
    with pytest.raises(vc.FileError) as refused:
        vc.load(path)
    assert time.monotonic() - start < 15
    assert message in str(refused.value)
    assert "Traceback" not in str(refused.value)


@pytest.mark.usefixtures("xacro")
def test_a_guarded_process_cannot_reach_out(tmp_path: Path) -> None:
    """The guard itself, without xacro between: what an expression that escapes would try."""
    import subprocess

    from vincula.files import xacro_child

    folder = str(Path(xacro_child.__file__).parent)
    for attempt in (
        "open('/etc/hostname')",
        f"open({str(tmp_path / 'new')!r}, 'w')",
        "__import__('subprocess').run(['true'])",
        "__import__('socket').socket()",
        "os.system('true')",
        "os.listdir('/')",
        "os.fork()",
    ):
        script = (
            f"import sys, os, socket, subprocess; sys.path.append({folder!r})\n"
            "from xacro_child import Guard\n"
            f"sys.addaudithook(Guard([{str(tmp_path)!r}]))\n"
            f"try:\n    {attempt}\nexcept BaseException as e:\n    print(type(e).__name__)\n"
        )
        done = subprocess.run(
            [sys.executable, "-I", "-c", script], capture_output=True, text=True, check=False
        )
        assert done.stdout.strip() == "ForbiddenError", (attempt, done)
    assert not (tmp_path / "new").exists()


# Meshes -------------------------------------------------------------------------------------------

MESHES = """<robot name="r"><link name="a"/><link name="b"><visual><geometry>{}</geometry></visual></link>
  <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"""


def fates(path: Path, **how: object) -> dict[str, str]:
    _, report = load_with_report(path, **how)  # type: ignore[arg-type]
    return {entry.name: entry.detail for entry in report.entries if entry.kind == "mesh"}


def test_meshes_are_found_missed_or_refused_and_never_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    arms = tmp_path / "arms"
    (arms / "meshes").mkdir(parents=True)
    (arms / "meshes" / "a.stl").write_bytes(b"")
    (arms / "meshes" / "out.stl").symlink_to("/etc/hostname")
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "b.stl").write_bytes(b"")
    expected = {
        "package://arms/meshes/a.stl": "found",
        "package://arms/meshes/b.stl": "not found",
        "package://legs/meshes/a.stl": "no package",
        "package://arms/../secret.stl": "refused: it leads out of",
        "package://arms/%2e%2e/secret.stl": "refused: it leads out of",
        "package://../x/a.stl": "no package",
        "package://arms/meshes/out.stl": "refused: it leads out of",
        "b.stl": "found",
        "../../../../etc/hostname": "refused: it leads out of",
        "/etc/hostname": "refused: only relative",
        "file:///etc/hostname": "refused: only relative",
        "http://host/a.stl": "refused: only relative",
    }
    text = MESHES.format("".join(f'<mesh filename="{path}"/>' for path in expected))
    path = written(tmp_path / "robot", text, "robot.urdf")
    for how in ({"package_dirs": [tmp_path]}, {"package_dirs": [arms]}):
        found = fates(path, **how)
        assert list(found) == list(expected)
        for name, words in expected.items():
            assert words in found[name], name
            assert "never opened" in found[name]
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.pathsep.join(["/nowhere", str(tmp_path)]))
    assert "found" in fates(path)["package://arms/meshes/a.stl"]
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    assert "no package" in fates(path)["package://arms/meshes/a.stl"]
    (tmp_path / "prefix" / "share").mkdir(parents=True)
    (tmp_path / "prefix" / "share" / "arms").symlink_to(arms)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    assert fates(path)["package://arms/meshes/a.stl"].endswith("; found")


def test_meshes_of_sdf_files_are_reported_too(tmp_path: Path) -> None:
    text = """<sdf version="1.9"><model name="m"><link name="a"><visual name="v"><geometry><mesh>
      <uri>model://m/a.dae</uri></mesh></geometry></visual></link>
      <joint name="j" type="revolute"><parent>world</parent><child>a</child><axis/></joint></model></sdf>"""
    path = written(tmp_path / "m", text, "model.sdf")
    assert "not found" in fates(path)["model://m/a.dae"]
    (tmp_path / "m" / "a.dae").write_bytes(b"")
    assert fates(path)["model://m/a.dae"].endswith("; found")


def test_names_of_packages_are_names(tmp_path: Path) -> None:
    packages = Packages((tmp_path,))
    for name in ("", ".", "..", "a/b", "a\\b", "\x00", "-x"):
        assert packages.find(name) is None


def test_mjcf_files_may_include_from_package_folders(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    body = '<mujocoinclude><body name="a"><joint name="j" axis="0 0 1"/></body></mujocoinclude>'
    shared = written(tmp_path / "shared", body, "arm.xml")
    path = written(
        tmp_path / "robot", f'<mujoco><worldbody><include file="{shared}"/></worldbody></mujoco>', "robot.xml"
    )
    with pytest.raises(vc.FileError):
        vc.load(path)
    assert "a" in vc.load(path, package_dirs=[tmp_path / "shared"]).body
