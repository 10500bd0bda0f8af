"""Pinocchio as an independent peer: models with every kind of joint, and the motions of its own engine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from scipy.linalg import null_space

from vincula.arrays import Matrix, Vector
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel

AXIS = np.array([0.0, 0.6, 0.8])

LINKAGE = """
<robot name="linkage">
  <link name="base"/><link name="lever"/><link name="slider"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="lever"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/></joint>
  <joint name="b" type="prismatic"><parent link="lever"/><child link="slider"/><axis xyz="0 .6 .8"/>
    <origin xyz="1 2 3" rpy=".1 .2 .3"/><mimic joint="a" multiplier="2" offset=".3"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/></joint>
</robot>
"""


def joint_kinds() -> dict[str, Any]:
    """One joint model of every kind that is supported."""
    composite = pin.JointModelComposite()
    composite.addJoint(pin.JointModelRX(), placement(1))
    composite.addJoint(pin.JointModelPY(), placement(2))
    composite.addJoint(pin.JointModelSphericalZYX(), placement(3))
    return {
        "RX": pin.JointModelRX(),
        "RY": pin.JointModelRY(),
        "RevoluteUnaligned": pin.JointModelRevoluteUnaligned(AXIS),
        "RUBZ": pin.JointModelRUBZ(),
        "PZ": pin.JointModelPZ(),
        "PrismaticUnaligned": pin.JointModelPrismaticUnaligned(AXIS),
        "HX": pin.JointModelHX(0.1),
        "HelicalUnaligned": pin.JointModelHelicalUnaligned(AXIS, -0.2),
        "FreeFlyer": pin.JointModelFreeFlyer(),
        "Spherical": pin.JointModelSpherical(),
        "SphericalZYX": pin.JointModelSphericalZYX(),
        "Translation": pin.JointModelTranslation(),
        "Planar": pin.JointModelPlanar(),
        "Universal": pin.JointModelUniversal(AXIS, np.array([0.0, -0.8, 0.6])),
        "Composite": composite,
    }


def placement(seed: int) -> Any:
    """A placement drawn at random."""
    rng = np.random.default_rng(seed)
    return pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))


def chain(*kinds: str) -> Any:
    """A model with these joints one after the other, and a frame on the last body."""
    model, parent, known = pin.Model(), 0, joint_kinds()
    for number, kind in enumerate(kinds):
        parent = model.addJoint(parent, known[kind], placement(10 + number), f"{kind}{number}")
    model.addFrame(pin.Frame("tool", parent, 0, placement(5), pin.FrameType.OP_FRAME))
    return model


def scattered(model: Any, seed: int) -> Vector:
    """A configuration drawn at random."""
    rng = np.random.default_rng(seed)
    return np.array(pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv)))


def rates_of(model: Any, q: Vector) -> Matrix:
    """From the engine's velocities to rates of our axes: bodies' own axes to the joint's first frame."""
    found = np.eye(model.nv)
    for joint in model.joints[1:]:
        kind, at = joint.shortname().removeprefix("JointModel"), joint.idx_v
        if kind == "FreeFlyer":
            turn = pin.Quaternion(np.array(q[joint.idx_q + 3 : joint.idx_q + 7]))
            found[at : at + 3, at : at + 3] = turn.toRotationMatrix()
        elif kind == "Planar":
            c, s = q[joint.idx_q + 2 : joint.idx_q + 4]
            found[at : at + 2, at : at + 2] = [[c, -s], [s, c]]
    return found


def engine_kernel(model: Any, q: Vector, frame: str, constraints: Any = ()) -> Matrix:
    """Basis of all (rates of our axes, twist of `frame`) that the constraints permit."""
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    motions = np.eye(model.nv)
    if constraints:
        states = [one.createData() for one in constraints]
        for one, state in zip(constraints, states, strict=True):
            if hasattr(one, "calc"):  # since 4: three rows are in axes that only this brings up to date
                one.calc(model, data, state)
        rows = pin.getConstraintsJacobian(model, data, list(constraints), states)
        motions = null_space(rows, rcond=1e-9)
    jacobian = pin.getFrameJacobian(
        model, data, model.getFrameId(frame), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    )
    return np.linalg.qr(np.vstack([rates_of(model, q) @ motions, jacobian @ motions]))[0]


def our_kernel(linear: LinearModel, mechanism: Mechanism) -> Matrix:
    """The same from a linear model, axes in the order of the mechanism's joints."""
    rows = np.hstack([linear.jacobian_active, linear.jacobian_passive, -linear.grasp.T])
    names = [column.name for column in linear.columns]
    order = [names.index(axis) for axis in mechanism.axis_names if axis in names]
    assert len(order) == len(names)
    return null_space(rows, rcond=1e-9)[[*order, *range(len(names), len(names) + 6)]]
