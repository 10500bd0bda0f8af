"""Prints the Stewart platform of this folder in every convention, as a person would write it.

    python write.py        writes the files beside it

The files are fixtures: they are kept as they are, and nothing of the package is used to write them.
Six legs: universal joints u at the base, sliding motors p, balls s at the platform.  Leg frames have
their x and y along the axes of the universal joint and z along the leg.
"""

import math
from pathlib import Path

HERE = Path(__file__).parent
BASE = [(1.0, 0.3), (-0.2, 1.1), (-0.7, 0.8), (-0.9, -0.4), (0.1, -1.2), (0.8, -0.7)]
TOP = [(0.5, 0.4), (0.2, 0.6), (-0.6, 0.1), (-0.5, -0.3), (0.25, -0.6), (0.45, -0.35)]
HEIGHT = 1.25
LEGS = range(1, 7)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    size = math.sqrt(sum(x * x for x in v))
    return tuple(x / size for x in v)


def text(*values):
    return " ".join(repr(float(v) + 0.0) for v in values)


class Leg:
    def __init__(self, k):
        self.k = k
        self.base = (*BASE[k - 1], 0.0)
        self.top = (*TOP[k - 1], 0.0)  # in the platform's frame, which stands at (0, 0, HEIGHT)
        way = (self.top[0] - self.base[0], self.top[1] - self.base[1], HEIGHT)
        self.length = math.sqrt(sum(x * x for x in way))
        self.z = unit(way)
        self.x = unit((-self.base[1], self.base[0], 0.0))  # a tangent of the base circle, then turned
        self.x = unit(
            tuple(
                a - sum(p * q for p, q in zip(self.x, self.z, strict=True)) * b
                for a, b in zip(self.x, self.z, strict=True)
            )
        )
        self.y = cross(self.z, self.x)

    def rpy(self):
        """Roll, pitch, yaw of the leg frame."""
        x, y, z = self.x, self.y, self.z
        return math.atan2(y[2], z[2]), math.atan2(-x[2], math.hypot(y[2], z[2])), math.atan2(x[1], x[0])

    def platform(self):
        """The platform's origin in a frame at the leg's tip, with the axes of the leg."""
        return tuple(
            -sum(a * b for a, b in zip(axis, self.top, strict=True)) for axis in (self.x, self.y, self.z)
        )

    def back(self):
        """Roll, pitch, yaw of the ground in the leg frame."""
        x, y, z = zip(self.x, self.y, self.z, strict=True)
        return math.atan2(y[2], z[2]), math.atan2(-x[2], math.hypot(y[2], z[2])), math.atan2(x[1], x[0])


ALL = [Leg(k) for k in LEGS]
MOTORS = "".join(
    f"""
  <transmission name="t{k}">
    <type>transmission_interface/SimpleTransmission</type> <joint name="p{k}"/> <actuator name="p{k}"/>
  </transmission>"""
    for k in LEGS
)


def urdf(inside, name="stewart"):
    return f"""<?xml version="1.0"?>
<robot name="{name}" xmlns:drake="http://drake.mit.edu">
  <link name="base"/> <link name="platform"/>{inside}{MOTORS}
</robot>
"""


def joint(name, kind, parent, child, xyz="0 0 0", rpy="", axis=""):
    turn = f' rpy="{rpy}"' if rpy else ""
    line = f' <axis xyz="{axis}"/>' if axis else ""
    limit = ' <limit effort="10" velocity="1"/>' if kind == "prismatic" else ""
    return f"""
  <joint name="{name}" type="{kind}">
    <parent link="{parent}"/> <child link="{child}"/> <origin xyz="{xyz}"{turn}/>{line}{limit}
  </joint>"""


# Legs that stand on the base; the platform floats.
FLOATING = joint("float", "floating", "base", "platform", text(0, 0, HEIGHT))
STANDING = "".join(
    f"""
  <link name="cross{g.k}"/> <link name="cylinder{g.k}"/> <link name="rod{g.k}"/>"""
    + joint(f"u{g.k}.1", "continuous", "base", f"cross{g.k}", text(*g.base), text(*g.rpy()), "1 0 0")
    + joint(f"u{g.k}.2", "continuous", f"cross{g.k}", f"cylinder{g.k}", axis="0 1 0")
    + joint(f"p{g.k}", "prismatic", f"cylinder{g.k}", f"rod{g.k}", axis="0 0 1")
    for g in ALL
)
# Legs that hang from the platform on three hinges each, down to the cross, which is not on the base yet.
HANGING = FLOATING + "".join(
    f"""
  <link name="rod{g.k}.1"/> <link name="rod{g.k}.2"/> <link name="rod{g.k}"/> <link name="cylinder{g.k}"/>
  <link name="cross{g.k}"/>"""
    + joint(f"s{g.k}.x", "continuous", "platform", f"rod{g.k}.1", text(*g.top), axis="1 0 0")
    + joint(f"s{g.k}.y", "continuous", f"rod{g.k}.1", f"rod{g.k}.2", axis="0 1 0")
    + joint(f"s{g.k}.z", "continuous", f"rod{g.k}.2", f"rod{g.k}", axis="0 0 1")
    + joint(f"p{g.k}", "prismatic", f"rod{g.k}", f"cylinder{g.k}", rpy=text(*g.rpy()), axis="0 0 -1")
    + joint(f"u{g.k}.2", "continuous", f"cylinder{g.k}", f"cross{g.k}", text(0, 0, -g.length), axis="0 1 0")
    for g in ALL
)


def loops(pattern):
    return "".join(
        pattern.format(k=g.k, length=repr(g.length), top=text(*g.top), base=text(*g.base), rpy=text(*g.rpy()))
        for g in ALL
    )


URDF = {
    "urdf-plus.urdf": FLOATING + STANDING + loops("""
  <loop name="s{k}" type="spherical">
    <predecessor link="rod{k}"><origin xyz="0 0 {length}"/></predecessor>
    <successor link="platform"><origin xyz="{top}"/></successor>
  </loop>"""),
    "urdf-plus-revolute.urdf": HANGING + loops("""
  <loop name="u{k}.1" type="revolute">
    <predecessor link="base"><origin xyz="{base}" rpy="{rpy}"/></predecessor>
    <successor link="cross{k}"><origin xyz="0 0 0"/></successor>
    <axis xyz="1 0 0"/>
  </loop>"""),
    "isaac.urdf": FLOATING + STANDING + loops("""
  <loop_joint name="s{k}" type="spherical">
    <link1 link="rod{k}" xyz="0 0 {length}" rpy="0 0 0"/> <link2 link="platform" xyz="{top}" rpy="0 0 0"/>
  </loop_joint>"""),
    "isaac-manual.urdf": FLOATING + STANDING + loops("""
  <loop_joint name="s{k}" type="spherical">
    <link1 link="rod{k}" xyz="0 0 {length}" rpy="0 0 0"/> <link1 link="platform" xyz="{top}" rpy="0 0 0"/>
  </loop_joint>"""),
    "isaac-revolute.urdf": HANGING + "".join(f"""
  <loop_joint name="u{g.k}.1" type="revolute">
    <parent link="base"/> <child link="cross{g.k}"/>
    <parent_origin xyz="{text(*g.base)}"/> <child_origin xyz="0 0 0"/>
    <axis xyz="{text(*g.x)}" frame="parent"/>
  </loop_joint>""" for g in ALL),
    "drake.urdf": loops("""
  <link name="cylinder{k}"/> <link name="rod{k}"/>
  <drake:joint name="u{k}" type="universal">
    <parent link="base"/> <child link="cylinder{k}"/> <origin xyz="{base}" rpy="{rpy}"/>
  </drake:joint>
  <joint name="p{k}" type="prismatic">
    <parent link="cylinder{k}"/> <child link="rod{k}"/> <axis xyz="0 0 1"/>
    <limit effort="10" velocity="1"/>
  </joint>""") + f"""
  <drake:joint name="s1" type="ball">
    <parent link="rod1"/> <child link="hub"/> <origin xyz="0 0 {ALL[0].length!r}"/>
  </drake:joint>
  <link name="hub"/>
  <joint name="hub_fixed" type="fixed">
    <parent link="hub"/> <child link="platform"/>
    <origin xyz="{text(*ALL[0].platform())}"
            rpy="{text(*ALL[0].back())}"/>
  </joint>""" + "".join(f"""
  <drake:ball_constraint>
    <drake:ball_constraint_body_A name="rod{g.k}"/> <drake:ball_constraint_body_B name="platform"/>
    <drake:ball_constraint_p_AP value="0 0 {g.length!r}"/>
    <drake:ball_constraint_p_BQ value="{text(*g.top)}"/>
  </drake:ball_constraint>""" for g in ALL[1:]),
    "gazebo.urdf": FLOATING + STANDING + loops("""
  <gazebo>
    <joint name="s{k}" type="ball">
      <parent>rod{k}</parent> <child>platform</child> <pose>{top} 0 0 0</pose>
    </joint>
  </gazebo>"""),
    "urdfdom-proposal.urdf": FLOATING + STANDING + loops("""
  <constraint name="s{k}" type="spherical">
    <parent link="rod{k}"/> <parent_origin xyz="0 0 {length}" rpy="0 0 0"/>
    <child link="platform"/> <child_origin xyz="{top}" rpy="0 0 0"/>
  </constraint>"""),
    "several-parents.urdf": HANGING + "".join(
        joint(f"u{g.k}.1", "continuous", "base", f"cross{g.k}", text(*g.base), text(*g.rpy()), "1 0 0")
        for g in ALL
    ),
}  # fmt: skip

GEPETTO_URDF = (
    "".join(
        f"""
  <link name="cylinder{g.k}"/> <link name="rod{g.k}"/> <link name="tip{g.k}"/> <link name="seat{g.k}"/>"""
        + joint(
            f"u{g.k}", "revolute", "base", f"cylinder{g.k}", text(*g.base), text(*g.rpy()), "1 0 0"
        ).replace(
            '<axis xyz="1 0 0"/>',
            '<axis xyz="1 0 0"/> <limit effort="10" velocity="1" lower="-3" upper="3"/>',
        )
        + joint(f"mot_p{g.k}", "prismatic", f"cylinder{g.k}", f"rod{g.k}", axis="0 0 1")
        + joint(f"tip{g.k}_fixed", "fixed", f"rod{g.k}", f"tip{g.k}", text(0, 0, g.length))
        + joint(f"seat{g.k}_fixed", "fixed", "platform", f"seat{g.k}", text(*g.top))
        for g in ALL
    )
    + FLOATING
)
GEPETTO_YAML = (
    "closed_loop: [" + ", ".join(f"['tip{k}', 'seat{k}']" for k in LEGS) + "]\n"
    "type: ['3d', '3D', '3d', '3D', '3d', '3D']\n"
    "name_mot: [" + ", ".join(f"'mot_p{k}'" for k in LEGS) + "]\n"
    "joint_name: [" + ", ".join(f"'u{k}'" for k in LEGS) + "]\n"
    "joint_type: [" + ", ".join("'CARDAN'" for _ in LEGS) + "]\n"
)

NATIVE = (
    "vincula: 1\nname: stewart\nspace: spatial\njoints:\n"
    + "".join(
        f"""  - name: u{g.k}
    type: universal
    bodies: [ground, cylinder{g.k}]
    at: [{text(*g.base).replace(" ", ", ")}]
    axes: [[{text(*g.x).replace(" ", ", ")}], [{text(*g.y).replace(" ", ", ")}]]
  - name: p{g.k}
    type: prismatic
    bodies: [cylinder{g.k}, rod{g.k}]
    at: [{text(*g.base).replace(" ", ", ")}]
    axis: [{text(*g.z).replace(" ", ", ")}]
  - name: s{g.k}
    type: spherical
    bodies: [rod{g.k}, platform]
    at: [{text(g.top[0], g.top[1], HEIGHT).replace(" ", ", ")}]
"""
        for g in ALL
    )
    + "motors: [p1, p2, p3, p4, p5, p6]\nreference: {body: platform, origin: [0.1, -0.2, 1.5]}\n"
)


def mjcf(inside_rod, rest, sites=""):
    legs = "".join(
        f"""
    <body name="cylinder{g.k}" pos="{text(*g.base)}" xyaxes="{text(*g.x, *g.y)}">
      <joint name="u{g.k}.1" axis="1 0 0"/>
      <joint name="u{g.k}.2" axis="0 1 0"/>
      <geom type="sphere" size="0.05"/>
      <body name="rod{g.k}">
        <joint name="p{g.k}" type="slide" axis="0 0 1"/>
        <geom type="sphere" size="0.05"/>{inside_rod(g)}
      </body>
    </body>"""
        for g in ALL
    )
    return f"""<mujoco model="stewart">
  <worldbody>{legs}
    <body name="platform" pos="{text(0, 0, HEIGHT)}">
      <freejoint name="float"/>
      <geom type="sphere" size="0.1"/>{sites}
    </body>
  </worldbody>
  <equality>{rest}
  </equality>
  <actuator>{
        "".join(
            f'''
    <motor name="p{k}" joint="p{k}"/>'''
            for k in LEGS
        )
    }
  </actuator>
</mujoco>
"""


MJCF = {
    "mjcf-connect.xml": mjcf(
        lambda g: "",
        "".join(f"""
    <connect name="s{g.k}" body1="rod{g.k}" body2="platform" anchor="0 0 {g.length!r}"/>""" for g in ALL),
    ),
    "mjcf-weld-sites.xml": mjcf(
        lambda g: f"""
        <body name="tip{g.k}" pos="0 0 {g.length!r}">
          <joint name="s{g.k}" type="ball"/>
          <geom type="sphere" size="0.05"/>
          <site name="tip{g.k}"/>
        </body>""",
        "".join(f"""
    <weld name="w{g.k}" site1="tip{g.k}" site2="seat{g.k}"/>""" for g in ALL),
        "".join(f"""
      <site name="seat{g.k}" pos="{text(*g.top)}" xyaxes="{text(*g.x, *g.y)}"/>""" for g in ALL),
    ),
}  # fmt: skip


def sdf(balls):
    legs = "".join(
        f"""
  <link name="cylinder{g.k}"><pose>{text(*g.base)} {text(*g.rpy())}</pose></link>
  <link name="rod{g.k}"><pose relative_to="cylinder{g.k}">0 0 {g.length!r} 0 0 0</pose></link>
  <joint name="u{g.k}" type="universal"><parent>world</parent><child>cylinder{g.k}</child>
    <axis><xyz>1 0 0</xyz><limit><effort>0</effort></limit></axis>
    <axis2><xyz>0 1 0</xyz><limit><effort>0</effort></limit></axis2></joint>
  <joint name="p{g.k}" type="prismatic"><parent>cylinder{g.k}</parent><child>rod{g.k}</child>
    <axis><xyz>0 0 1</xyz></axis></joint>"""
        for g in ALL
    )
    return f"""<?xml version="1.0"?>
<sdf version="1.9" xmlns:drake="http://drake.mit.edu"><model name="stewart">
  <link name="platform"><pose>{text(0, 0, HEIGHT)} 0 0 0</pose></link>{legs}{balls}
</model></sdf>
"""


def ball(g):
    return f"""
  <joint name="s{g.k}" type="ball"><parent>rod{g.k}</parent><child>platform</child>
    <pose>{text(*g.top)} 0 0 0</pose></joint>"""


SDF = {
    "sdf.sdf": sdf("".join(ball(g) for g in ALL)),
    "drake.sdf": sdf(ball(ALL[0]) + "".join(f"""
  <drake:ball_constraint>
    <drake:ball_constraint_body_A>rod{g.k}</drake:ball_constraint_body_A>
    <drake:ball_constraint_body_B>platform</drake:ball_constraint_body_B>
    <drake:ball_constraint_p_AP>0 0 0</drake:ball_constraint_p_AP>
    <drake:ball_constraint_p_BQ>{text(*g.top)}</drake:ball_constraint_p_BQ>
  </drake:ball_constraint>""" for g in ALL[1:])),
}  # fmt: skip

if __name__ == "__main__":
    files = {name: urdf(inside) for name, inside in URDF.items()} | MJCF | SDF
    files |= {
        "native.yaml": NATIVE,
        "gepetto.urdf": urdf(GEPETTO_URDF).replace(MOTORS, ""),
        "gepetto.yaml": GEPETTO_YAML,
    }
    for name, content in files.items():
        (HERE / name).write_text(content, encoding="utf-8")
