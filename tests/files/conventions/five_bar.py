"""The paper's five-bar linkage written by hand in the conventions that cut a loop at the ground.

Joints at o1 (-1, -2), o2 (-1, 0), o3 (0, 0), o4 (1, -1), o5 (1, -2), axes along z; the loop is cut at o5.
"""

from __future__ import annotations

NATIVE = """
vincula: 1
space: planar
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [-1, -2]}
  - {name: o2, type: revolute, bodies: [crank, coupler], at: [-1, 0]}
  - {name: o3, type: revolute, bodies: [coupler, link], at: [0, 0]}
  - {name: o4, type: revolute, bodies: [link, rocker], at: [1, -1]}
  - {name: o5, type: revolute, bodies: [rocker, ground], at: [1, -2]}
motors: [o1, o4]
"""

NATIVE_SPATIAL = """
vincula: 1
space: spatial
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [-1, -2, 0], axis: [0, 0, 1]}
  - {name: o2, type: revolute, bodies: [crank, coupler], at: [-1, 0, 0], axis: [0, 0, 1]}
  - {name: o3, type: revolute, bodies: [coupler, link], at: [0, 0, 0], axis: [0, 0, 1]}
  - {name: o4, type: revolute, bodies: [link, rocker], at: [1, -1, 0], axis: [0, 0, 1]}
  - {name: o5, type: revolute, bodies: [rocker, ground], at: [1, -2, 0], axis: [0, 0, 1]}
motors: [o1, o4]
"""

TREE = """
  <link name="base"/> <link name="crank"/> <link name="coupler"/> <link name="link"/> <link name="rocker"/>
  <joint name="o1" type="continuous">
    <parent link="base"/> <child link="crank"/> <origin xyz="-1 -2 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o2" type="continuous">
    <parent link="crank"/> <child link="coupler"/> <origin xyz="0 2 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o3" type="continuous">
    <parent link="coupler"/> <child link="link"/> <origin xyz="1 0 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="o4" type="continuous">
    <parent link="link"/> <child link="rocker"/> <origin xyz="1 -1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <transmission name="t1">
    <type>transmission_interface/SimpleTransmission</type> <joint name="o1"/> <actuator name="m1"/>
  </transmission>
  <transmission name="t4">
    <type>transmission_interface/SimpleTransmission</type> <joint name="o4"/> <actuator name="m4"/>
  </transmission>
"""

URDF = {
    "URDF+": """
  <loop name="o5" type="revolute">
    <predecessor link="rocker"><origin xyz="0 -1 0"/></predecessor>
    <successor link="base"><origin xyz="1 -2 0"/></successor>
    <axis xyz="0 0 1"/>
  </loop>""",
    "Isaac": """
  <loop_joint name="o5" type="spherical">
    <link1 link="rocker" xyz="0 -1 0" rpy="0 0 0"/> <link2 link="base" xyz="1 -2 0" rpy="0 0 0"/>
  </loop_joint>""",
    "Isaac, as its manual prints it": """
  <loop_joint name="o5" type="spherical">
    <link1 link="rocker" xyz="0 -1 0" rpy="0 0 0"/> <link1 link="base" xyz="1 -2 0" rpy="0 0 0"/>
  </loop_joint>""",
    "Isaac, parent and child": """
  <loop_joint name="o5" type="revolute">
    <parent link="rocker"/> <child link="base"/>
    <parent_origin xyz="0 -1 0"/> <child_origin xyz="1 -2 0"/> <axis xyz="0 0 1" frame="parent"/>
  </loop_joint>""",
    "several parents": """
  <joint name="o5" type="continuous">
    <parent link="base"/> <child link="pin"/> <origin xyz="1 -2 0"/> <axis xyz="0 0 1"/>
  </joint>
  <link name="pin"/>
  <joint name="glue" type="fixed"> <parent link="rocker"/> <child link="pin"/>
    <origin xyz="0 -1 0"/> </joint>""",
    "Drake weld": """
  <link name="pin"/>
  <joint name="o5" type="continuous">
    <parent link="rocker"/> <child link="pin"/> <origin xyz="0 -1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <frame name="hole" link="base" xyz="1 -2 0"/>
  <drake:weld_constraint>
    <drake:weld_constraint_frame_a name="pin"/> <drake:weld_constraint_frame_b name="hole"/>
  </drake:weld_constraint>""",
    "Drake": """
  <drake:ball_constraint>
    <drake:ball_constraint_body_A name="rocker"/> <drake:ball_constraint_body_B name="base"/>
    <drake:ball_constraint_p_AP value="0 -1 0"/> <drake:ball_constraint_p_BQ value="1 -2 0"/>
  </drake:ball_constraint>""",
    "Gazebo": """
  <gazebo>
    <joint name="o5" type="revolute">
      <parent>world</parent> <child>rocker</child> <pose>0 -1 0 0 0 0</pose>
      <axis><xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>
    </joint>
  </gazebo>""",
    "urdfdom proposal": """
  <constraint name="o5" type="continuous">
    <parent link="base"/> <parent_origin xyz="1 -2 0"/> <parent_axis xyz="0 0 1"/>
    <child link="rocker"/> <child_origin xyz="0 -1 0" rpy="3.141592653589793 0 0"/> <child_axis xyz="0 0 -1"/>
  </constraint>""",
}

GEPETTO_TREE = """
  <link name="pin"/> <link name="hole"/>
  <joint name="o5" type="continuous">
    <parent link="rocker"/> <child link="pin"/> <origin xyz="0 -1 0"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="to_hole" type="fixed">
    <parent link="base"/> <child link="hole"/> <origin xyz="1 -2 0"/>
  </joint>
"""
GEPETTO = "closed_loop: [[pin, hole]]\ntype: [6d]\nname_mot: [o1, o4]\n"

SDF = """<sdf version="1.5"><model name="five-bar">
  <link name="base"/>
  <link name="crank"><pose>-1 -2 0 0 0 0</pose></link>
  <link name="coupler"><pose>-1 0 0 0 0 0</pose></link>
  <link name="link"><pose>0 0 0 0 0 0</pose></link>
  <link name="rocker"><pose>1 -1 0 0 0 0</pose></link>
  <joint name="o1" type="revolute"><parent>base</parent><child>crank</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="o2" type="revolute"><parent>crank</parent><child>coupler</child>
    <axis><xyz>0 0 1</xyz><limit><effort>0</effort></limit></axis></joint>
  <joint name="o3" type="revolute"><parent>coupler</parent><child>link</child>
    <axis><xyz>0 0 1</xyz><limit><effort>0</effort></limit></axis></joint>
  <joint name="o4" type="revolute"><parent>link</parent><child>rocker</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="o5" type="revolute"><parent>base</parent><child>rocker</child><pose>0 -1 0 0 0 0</pose>
    <axis><xyz>0 0 1</xyz><limit><effort>0</effort></limit></axis></joint>
</model></sdf>"""

_JOINT = SDF[SDF.index('  <joint name="o5"') : SDF.index("</model>")]
SDF_BALL = SDF.replace(
    _JOINT,
    """  <drake:ball_constraint>
    <drake:ball_constraint_body_A>base</drake:ball_constraint_body_A>
    <drake:ball_constraint_body_B>rocker</drake:ball_constraint_body_B>
    <drake:ball_constraint_p_AP>1 -2 0</drake:ball_constraint_p_AP>
    <drake:ball_constraint_p_BQ>0 -1 0</drake:ball_constraint_p_BQ>
  </drake:ball_constraint>
""",
).replace("<sdf", '<sdf xmlns:drake="http://drake.mit.edu"')

MJCF = """<mujoco>
  <worldbody>
    <body name="crank" pos="-1 -2 0"><joint name="o1" axis="0 0 1"/>
      <body name="coupler" pos="0 2 0"><joint name="o2" axis="0 0 1"/>
        <body name="link" pos="1 0 0"><joint name="o3" axis="0 0 1"/>
          <body name="rocker" pos="1 -1 0"><joint name="o4" axis="0 0 1"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><connect name="o5" body1="rocker" anchor="0 -1 0"/></equality>
  <actuator><motor name="m1" joint="o1"/><motor name="m4" joint="o4"/></actuator>
</mujoco>"""

MJCF_WELD = (
    MJCF.replace(
        '<joint name="o4" axis="0 0 1"/></body>',
        """<joint name="o4" axis="0 0 1"/>
            <body name="pin" pos="0 -1 0"><joint name="o5" axis="0 0 1"/><site name="pin"/></body></body>""",
    )
    .replace("</worldbody>", '<site name="hole" pos="1 -2 0"/></worldbody>')
    .replace('<connect name="o5" body1="rocker" anchor="0 -1 0"/>', '<weld site1="pin" site2="hole"/>')
)
