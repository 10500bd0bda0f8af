"""The same four-bar in four formats, one of its axes turned by an angle that was typed with few digits.

With the angle at pi/2 all axes are parallel and the four-bar moves; with the angle as it is typed they
are not, and the loop of four turning joints in space is stuck.  All loops close as drawn.
"""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

ANGLES = ("1.57", "1.5708", "1.57075", "1.570796")
"""How pi/2 is typed; 1.57075 is half of 3.1415, and wrong in the fourth digit."""


def urdf(angle: str) -> str:
    """The crank's frame is turned by `angle` and the coupler's turned back."""
    links = "\n".join(f'  <link name="{name}"/>' for name in ("base", "crank", "coupler", "rocker", "end"))
    return f"""<robot name="rounded">
{links}
  <joint name="o1" type="revolute"><parent link="base"/><child link="crank"/>
    <origin xyz="0 0 0" rpy="{angle} 0 0"/><axis xyz="0 0 1"/><limit effort="1" velocity="1"/></joint>
  <joint name="o2" type="revolute"><parent link="crank"/><child link="coupler"/>
    <origin xyz="0.3 0 0" rpy="-{angle} 0 0"/><axis xyz="0 -1 0"/><limit effort="1" velocity="1"/></joint>
  <joint name="o3" type="revolute"><parent link="coupler"/><child link="rocker"/>
    <origin xyz="0.4 0 0.25"/><axis xyz="0 -1 0"/><limit effort="1" velocity="1"/></joint>
  <joint name="weld" type="fixed"><parent link="rocker"/><child link="end"/>
    <origin xyz="0.15 0 -0.45"/></joint>
  <joint name="o4" type="revolute"><parent link="base"/><child link="end"/>
    <origin xyz="0.85 0 -0.2"/><axis xyz="0 -1 0"/><limit effort="1" velocity="1"/></joint>
</robot>
"""


def sdf(angle: str) -> str:
    """The crank's link is turned by `angle`."""
    return f"""<sdf version="1.9"><model name="rounded">
  <link name="crank"><pose>0 0 0 {angle} 0 0</pose></link>
  <link name="coupler"><pose>0.3 0 0 0 0 0</pose></link>
  <link name="rocker"><pose>0.7 0 0.25 0 0 0</pose></link>
  <joint name="o1" type="revolute"><parent>world</parent><child>crank</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="o2" type="revolute"><parent>crank</parent><child>coupler</child>
    <axis><xyz>0 -1 0</xyz></axis></joint>
  <joint name="o3" type="revolute"><parent>coupler</parent><child>rocker</child>
    <axis><xyz>0 -1 0</xyz></axis></joint>
  <joint name="o4" type="revolute"><parent>world</parent><child>rocker</child>
    <pose>0.15 0 -0.45 0 0 0</pose><axis><xyz>0 -1 0</xyz></axis></joint>
</model></sdf>
"""


def mjcf_euler(angle: str) -> str:
    """The crank's body is turned by `angle` and the coupler's turned back; the loop is a point."""
    return _mjcf(f'euler="{angle} 0 0"', "0 0 1", f'euler="-{angle} 0 0"')


def mjcf_quat(digits: int) -> str:
    """The same by quaternions with some digits, the two turns rounded differently."""
    half = round(cos(pi / 4), digits)
    short = half - 10.0**-digits
    return _mjcf(
        f'quat="{half:.{digits}f} {short:.{digits}f} 0 0"', "0 0 1",
        f'quat="{half:.{digits}f} -{short:.{digits}f} 0 0"',
    )  # fmt: skip


def mjcf_axis(tilt: str) -> str:
    """The crank's axis leans by a typed number."""
    return _mjcf("", f"0 -1 {tilt}", "")


def _mjcf(crank: str, axis: str, coupler: str) -> str:
    return f"""<mujoco model="rounded"><compiler angle="radian" autolimits="true"/>
  <worldbody>
    <body name="crank" {crank}><joint name="o1" axis="{axis}"/>{_MASS}
      <body name="coupler" pos="0.3 0 0" {coupler}><joint name="o2" axis="0 -1 0"/>{_MASS}
        <body name="rocker" pos="0.4 0 0.25"><joint name="o3" axis="0 -1 0"/>{_MASS}</body>
      </body>
    </body>
  </worldbody>
  <equality><connect name="o4" body1="rocker" anchor="0.15 0 -0.45"/></equality>
  <actuator><motor joint="o1"/></actuator>
</mujoco>
"""


_MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def native(axis: str) -> str:
    """The crank turns about a typed axis; the others about -y."""
    return f"""vincula: 1
name: rounded
space: spatial
joints:
  - {{name: o1, type: revolute, bodies: [ground, crank], at: [0, 0, 0], axis: {axis}}}
  - {{name: o2, type: revolute, bodies: [crank, coupler], at: [0.3, 0, 0], axis: [0, -1, 0]}}
  - {{name: o3, type: revolute, bodies: [coupler, rocker], at: [0.7, 0, 0.25], axis: [0, -1, 0]}}
  - {{name: o4, type: revolute, bodies: [ground, rocker], at: [0.85, 0, -0.2], axis: [0, -1, 0]}}
reference: {{body: coupler}}
motors: [o1]
"""


def inclined(cosine: str, sine: str) -> str:
    """A native four-bar in a plane inclined by 30 degrees: one axis typed, the others exact."""
    exact = "[0, -sqrt(3)/2, 1/2*sqrt(1)]"
    text = native(f"[0, -{cosine}, {sine}]")
    return (
        text.replace("[0, -1, 0]", exact)
        .replace("[0.7, 0, 0.25]", "[0.7, 0.125, 0.25*sqrt(3)/2]")
        .replace("[0.85, 0, -0.2]", "[0.85, -0.1, -0.2*sqrt(3)/2]")
    )


CASES: dict[str, tuple[str, str]] = (
    {f"urdf-{a}": ("robot.urdf", urdf(a)) for a in ANGLES}
    | {f"sdf-{a}": ("model.sdf", sdf(a)) for a in ANGLES}
    | {f"euler-{a}": ("model.xml", mjcf_euler(a)) for a in ANGLES}
    | {f"quat-{n}": ("model.xml", mjcf_quat(n)) for n in (4, 6)}
    | {f"axis-{t}": ("model.xml", mjcf_axis(t)) for t in ("0.00005", "4.6e-05", "1e-6")}
    | {f"native-{t}": ("model.yaml", native(f"[0, -1, {t}]")) for t in ("0.00005", "3.7e-6", "0.000001")}
    | {f"cosine-{a}": ("model.yaml", native(f"[0, -sin({a}), cos({a})]")) for a in ANGLES}
    | {f"inclined-{c}": ("model.yaml", inclined(c, s)) for c, s in (("0.866", "0.5"), ("0.8660", "0.5000"))}
)
"""Files by name of the case."""


def write(folder: Path, case: str) -> Path:
    """The file of a case, in a folder."""
    name, text = CASES[case]
    path = folder / name
    path.write_text(text)
    return path


def tilt(angle: float) -> float:
    """How far the axis is from being parallel to the others, for an angle typed for pi/2."""
    return abs(cos(angle) / sin(angle))
