"""The same four-bar linkage written by hand in every convention that can be read.

Crank o1 (0, 0) to o2 (0, 1), coupler from there to o3 (2, 2), rocker from o4 (3, 0) to o3; all axes
along z.  Files that cut the loop cut it at o3.
"""

from __future__ import annotations

NATIVE = """
vincula: 1
space: planar
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [0, 0]}
  - {name: o2, type: revolute, bodies: [crank, coupler], at: [0, 1]}
  - {name: o3, type: revolute, bodies: [coupler, rocker], at: [2, 2]}
  - {name: o4, type: revolute, bodies: [ground, rocker], at: [3, 0]}
motors: [o1]
"""

NATIVE_SPATIAL = """
vincula: 1
space: spatial
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [0, 0, 0], axis: [0, 0, 1]}
  - {name: o2, type: revolute, bodies: [crank, coupler], at: [0, 1, 0], axis: [0, 0, 1]}
  - {name: o3, type: revolute, bodies: [coupler, rocker], at: [2, 2, 0], axis: [0, 0, 1]}
  - {name: o4, type: revolute, bodies: [ground, rocker], at: [3, 0, 0], axis: [0, 0, 1]}
motors: [o1]
"""

TREE = """
  <link name="base"/> <link name="crank"/> <link name="coupler"/> <link name="rocker"/>
  <joint name="o1" type="continuous">
    <parent link="base"/> <child link="crank"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o2" type="continuous">
    <parent link="crank"/> <child link="coupler"/> <origin xyz="0 1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o4" type="continuous">
    <parent link="base"/> <child link="rocker"/> <origin xyz="3 0 0"/> <axis xyz="0 0 1"/>
  </joint>
"""

URDF = {
    "URDF+": """
  <loop name="o3" type="continuous">
    <predecessor link="coupler"><origin xyz="2 1 0"/></predecessor>
    <successor link="rocker"><origin xyz="-1 2 0" rpy="0 0 0.3"/></successor>
    <axis xyz="0 0 1"/>
  </loop>""",
    "Isaac, two links": """
  <loop_joint name="o3" type="spherical">
    <link1 link="coupler" xyz="2 1 0" rpy="0 0 0"/> <link2 link="rocker" xyz="-1 2 0" rpy="0 0 0"/>
  </loop_joint>""",
    "Isaac, as its manual prints it": """
  <loop_joint name="o3" type="spherical">
    <link1 link="coupler" xyz="2 1 0" rpy="0 0 0"/> <link1 link="rocker" xyz="-1 2 0" rpy="0 0 0"/>
  </loop_joint>""",
    "Isaac, parent and child": """
  <loop_joint name="o3" type="revolute">
    <parent link="coupler"/> <child link="rocker"/>
    <parent_origin xyz="2 1 0"/> <child_origin xyz="-1 2 0"/> <axis xyz="0 0 1" frame="parent"/>
  </loop_joint>""",
    "Drake ball": """
  <drake:ball_constraint>
    <drake:ball_constraint_body_A name="coupler"/> <drake:ball_constraint_body_B name="rocker"/>
    <drake:ball_constraint_p_AP value="2 1 0"/> <drake:ball_constraint_p_BQ value="-1 2 0"/>
  </drake:ball_constraint>""",
    "Drake weld": """
  <link name="tip"/>
  <joint name="o3" type="continuous">
    <parent link="coupler"/> <child link="tip"/> <origin xyz="2 1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <frame name="hole" link="rocker" xyz="-1 2 0"/>
  <drake:weld_constraint>
    <drake:weld_constraint_frame_a name="tip"/> <drake:weld_constraint_frame_b name="hole"/>
  </drake:weld_constraint>""",
    "Gazebo": """
  <gazebo>
    <joint name="o3" type="revolute">
      <parent>coupler</parent> <child>rocker</child> <pose>-1 2 0 0 0 0</pose>
      <axis><xyz>0 0 1</xyz></axis>
    </joint>
  </gazebo>""",
    "urdfdom proposal": """
  <constraint name="o3" type="revolute">
    <parent link="coupler"/> <parent_origin xyz="2 1 0" rpy="0 0 0"/> <parent_axis xyz="0 0 1"/>
    <child link="rocker"/> <child_origin xyz="-1 2 0" rpy="1.5707963267948966 0 0"/>
    <child_axis xyz="0 1 0"/>
  </constraint>""",
    "several parents": """
  <link name="pin"/>
  <joint name="o3" type="continuous">
    <parent link="coupler"/> <child link="pin"/> <origin xyz="2 1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="glue" type="fixed"> <parent link="rocker"/> <child link="pin"/>
    <origin xyz="-1 2 0"/> </joint>""",
}
"""The loop in dialects of URDF; it stands below the tree."""

CONSTRUCTED = {
    "Drake distance": """
  <link name="base"/> <link name="crank"/> <link name="rocker"/>
  <joint name="o1" type="continuous">
    <parent link="base"/> <child link="crank"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o4" type="continuous">
    <parent link="base"/> <child link="rocker"/> <origin xyz="3 0 0"/> <axis xyz="0 0 1"/>
  </joint>
  <drake:distance_constraint name="coupler">
    <drake:distance_constraint_body_A name="crank"/> <drake:distance_constraint_body_B name="rocker"/>
    <drake:distance_constraint_p_AP value="0 1 0"/> <drake:distance_constraint_p_BQ value="-1 2 0"/>
    <drake:distance_constraint_distance value="2.23606797749979"/>
  </drake:distance_constraint>""",
}
"""Other ways to say it that need no coupler link."""

GEPETTO_TREE = """
  <link name="pin"/> <link name="hole"/>
  <joint name="o3" type="continuous">
    <parent link="coupler"/> <child link="pin"/> <origin xyz="2 1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="to_hole" type="fixed">
    <parent link="rocker"/> <child link="hole"/> <origin xyz="-1 2 0"/>
  </joint>
"""
GEPETTO = {
    "6d": "closed_loop: [[pin, hole]]\ntype: [6d]\nname_mot: [o1]\n",
    "3d": "closed_loop: [[o3, to_hole]]\ntype: [3d]\nname_mot: [o1]\n",
}

SDF_GRAPH = """<sdf version="1.9"><model name="four-bar">
  <link name="crank"/>
  <link name="coupler"><pose>0 1 0 0 0 0</pose></link>
  <link name="rocker"><pose>3 0 0 0 0 0</pose></link>
  <joint name="o1" type="revolute"><parent>world</parent><child>crank</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="o2" type="revolute"><parent>crank</parent><child>coupler</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="o3" type="revolute"><parent>coupler</parent><child>rocker</child>
    <pose relative_to="rocker">-1 2 0 0 0 0</pose>
    <axis><xyz expressed_in="__model__">0 0 1</xyz></axis></joint>
  <joint name="o4" type="revolute"><parent>world</parent><child>rocker</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>"""

SDF_BALL = SDF_GRAPH.replace(
    """  <joint name="o3" type="revolute"><parent>coupler</parent><child>rocker</child>
    <pose relative_to="rocker">-1 2 0 0 0 0</pose>
    <axis><xyz expressed_in="__model__">0 0 1</xyz></axis></joint>
""",
    """  <drake:ball_constraint>
    <drake:ball_constraint_body_A>coupler</drake:ball_constraint_body_A>
    <drake:ball_constraint_body_B>rocker</drake:ball_constraint_body_B>
    <drake:ball_constraint_p_AP>2 1 0</drake:ball_constraint_p_AP>
    <drake:ball_constraint_p_BQ>-1 2 0</drake:ball_constraint_p_BQ>
  </drake:ball_constraint>
""",
)

MJCF = """<mujoco>
  <worldbody>
    <body name="crank"><joint name="o1" axis="0 0 1"/>
      <body name="coupler" pos="0 1 0"><joint name="o2" axis="0 0 1"/></body>
    </body>
    <body name="rocker" pos="3 0 0"><joint name="o4" axis="0 0 1"/></body>
  </worldbody>
  <equality><connect name="o3" body1="coupler" body2="rocker" anchor="2 1 0"/></equality>
  <actuator><motor name="m1" joint="o1"/></actuator>
</mujoco>"""

MJCF_WELD = (
    MJCF.replace(
        '<joint name="o2" axis="0 0 1"/></body>',
        """<joint name="o2" axis="0 0 1"/>
        <body name="pin" pos="2 1 0"><joint name="o3" axis="0 0 1"/><site name="pin"/></body></body>""",
    )
    .replace(
        '<joint name="o4" axis="0 0 1"/>', '<joint name="o4" axis="0 0 1"/><site name="hole" pos="-1 2 0"/>'
    )
    .replace(
        '<connect name="o3" body1="coupler" body2="rocker" anchor="2 1 0"/>',
        '<weld site1="pin" site2="hole"/>',
    )
)
