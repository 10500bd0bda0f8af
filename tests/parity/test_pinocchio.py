"""Pinocchio models against Pinocchio itself: poses, motions through loops, and the reference cases."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

import vincula as vc
from vincula.arrays import Vector

pin = pytest.importorskip("pinocchio")

from tests.parity.mujoco_peer import gap  # noqa: E402
from tests.parity.pinocchio_peer import (  # noqa: E402
    LINKAGE,
    chain,
    engine_kernel,
    joint_kinds,
    our_kernel,
    placement,
    scattered,
)

from vincula.adapters.pinocchio import linear_model, mechanism_of, positions_of  # noqa: E402

needs_mimic = pytest.mark.skipif(
    not hasattr(pin.Model(), "mimicking_joints"), reason="this Pinocchio has no mimic joints"
)
KINDS = tuple(joint_kinds())
CASES = ("gepetto_5bar_linkage", "gepetto_5bar_linkage_iso3d", "gepetto_robot_delta")


def assert_poses(model: Any, q: Vector, mechanism: vc.Mechanism) -> None:
    """Every body and every frame stands where the engine has it."""
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    poses = mechanism.body_poses()
    frames = {frame.name: poses[frame.body] @ frame.pose for frame in mechanism.frames}
    for index, frame in enumerate(model.frames):
        ours = poses.get(frame.name) or frames[frame.name]
        assert np.allclose(ours.rotation, data.oMf[index].rotation, rtol=0, atol=1e-13), frame.name
        assert np.allclose(ours.position, data.oMf[index].translation, rtol=0, atol=1e-13), frame.name


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, 1])
def test_every_kind_of_joint(kind: str, seed: int) -> None:
    model = chain("RY", kind, "RX")
    q = scattered(model, seed)
    mechanism = mechanism_of(model, q)
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    poses = mechanism.body_poses()
    for index, name in enumerate(list(model.names)[1:], start=1):
        assert np.allclose(poses[name].rotation, data.oMi[index].rotation, rtol=0, atol=1e-13)
        assert np.allclose(poses[name].position, data.oMi[index].translation, rtol=0, atol=1e-13)
    assert np.allclose(pin.difference(model, positions_of(model, mechanism.home), q), 0, rtol=0, atol=1e-14)
    linear = linear_model(model, q, "tool", active=["RX2"])
    assert gap(our_kernel(linear, mechanism), engine_kernel(model, q, "tool")) < 1e-12


@pytest.mark.parametrize("kind", ["CONTACT_3D", "CONTACT_6D"])
def test_constraints_have_the_motions_of_the_engine(kind: str) -> None:
    """A ring of nine joints, held to the ground where it stands."""
    model = chain("FreeFlyer", "RX", "Composite", "Spherical", "PZ", "HX")
    q = scattered(model, 3)
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    last, own = model.njoints - 1, placement(8)
    for first, before in ((0, pin.SE3.Identity()), (2, data.oMi[2])):
        constraint = pin.RigidConstraintModel(
            getattr(pin.ContactType, kind), model, first, before.inverse() * data.oMi[last] * own, last, own
        )
        mechanism = mechanism_of(model, q, [constraint])
        linear = linear_model(model, q, "tool", [constraint], active=["RX1"])
        expected = engine_kernel(model, q, "tool", [constraint])
        assert expected.shape[1] == model.nv - (3 if kind == "CONTACT_3D" else 6)
        assert gap(our_kernel(linear, mechanism), expected) < 1e-11


def test_anchors_are_loops_too() -> None:
    if not hasattr(pin, "PointAnchorConstraintModel"):
        pytest.skip("this Pinocchio has no anchor constraints")
    model = chain("RY", "RX", "RY", "RX")
    q = scattered(model, 1)
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    for kind, rows in (("PointAnchorConstraintModel", 3), ("FrameAnchorConstraintModel", 6)):
        constraint = getattr(pin, kind)(model, 4, pin.SE3.Identity(), 0, data.oMi[4])
        assert len(linear_model(model, q, "RY2", [constraint], active=["RY0"]).rows) >= rows
        wrapped = linear_model(model, q, "RY2", [pin.ConstraintModel(constraint)], active=["RY0"])
        plain = linear_model(model, q, "RY2", [constraint], active=["RY0"])
        assert np.array_equal(wrapped.jacobian_passive, plain.jacobian_passive)


@needs_mimic
def test_mimic_joints_are_coupled() -> None:
    model = pin.buildModelFromXML(LINKAGE, mimic=True)
    q = np.array([0.5])
    mechanism = mechanism_of(model, q)
    assert mechanism.home["b"] == pytest.approx([2 * 0.5 + 0.3])
    assert_poses(model, q, mechanism)
    linear = linear_model(model, q, "slider", active=["a"])
    speeds = vc.analyze(linear, vc.Weights()).twist_from_rates.matrix
    data = model.createData()
    expected = pin.computeFrameJacobian(
        model, data, q, model.getFrameId("slider"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    )
    assert np.allclose(speeds, expected.reshape(6, 1), rtol=0, atol=1e-12)


@needs_mimic
def test_limits_and_names() -> None:
    model = pin.buildModelFromXML(LINKAGE, mimic=True)
    mechanism = mechanism_of(model)
    assert [body.name for body in mechanism.bodies] == ["lever", "slider"]
    limits = mechanism.joint["a"].limits[0]
    assert (limits.lower, limits.upper, limits.rate, limits.effort) == (-1.0, 2.0, 4.0, 3.0)
    assert mechanism.joint["b"].limits == ()


def test_a_composite_joint_is_named_as_a_whole() -> None:
    model = chain("RY", "Composite")
    q = scattered(model, 0)
    linear = linear_model(model, q, "tool", active=["RY0"], lock=["Composite1"])
    assert [column.name for column in linear.columns] == ["RY0"]
    linear = linear_model(model, q, "tool", active="Composite1")
    assert [motor.name for motor in linear.motors] == [f"Composite1.{k}" for k in range(1, 6)]


def robot(shared: Path, case: dict[str, Any]) -> tuple[Any, Vector, list[Any]]:
    """Model, configuration and constraints of a reference case, by Pinocchio's own reader."""
    model = pin.buildModelFromUrdf(str(shared / case["model_file"]))
    q = pin.neutral(model)
    for name, value in case["configuration"].items():
        joint = model.joints[model.getJointId(name)]
        both = [math.cos(value), math.sin(value)] if joint.nq == 2 else [value]
        q[joint.idx_q : joint.idx_q + joint.nq] = both
    constraints = []
    for loop in case["loop_closures"]:
        one, two = (model.frames[_frame(model, loop[key])] for key in ("frame_a", "frame_b"))
        kind = getattr(pin.ContactType, f"CONTACT_{loop['type'].upper()}")
        constraints.append(
            pin.RigidConstraintModel(
                kind, model, one.parentJoint, one.placement, two.parentJoint, two.placement
            )
        )
    return model, q, constraints


def _frame(model: Any, name: str) -> int:
    """A link, or a joint that stands for its child link."""
    kinds = [str(frame.type) for frame in model.frames if frame.name == name]
    return int(model.getFrameId(name, pin.FrameType.BODY if "BODY" in kinds else pin.FrameType.JOINT))


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_the_reference_case(name: str, shared: Path) -> None:
    case = json.loads((shared / "cases" / name / "expected.json").read_text(encoding="utf-8"))
    model, q, constraints = robot(shared, case)
    member = case["reference_member"]["body"]
    assert_poses(model, q, mechanism_of(model, q, constraints))
    linear = linear_model(model, q, member, constraints, active=case["actuated"], lock=case["locked"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vc.MixedUnitsWarning)
        found = vc.analyze(linear).to_dict()
    summary, expected = found["mobility"]["summary"], case["results"]
    assert summary["mobility"] == expected["mobility"]
    assert summary["indeterminacy"] == expected["dim_member_indeterminacy"]
    assert summary["redundancy"] == expected["dim_actuated_redundancy"]
    assert summary["coordinated"] == expected["dim_coordinated"]
    assert summary["structural_wrenches"] == expected["dim_structural_wrenches"]
    assert summary["internal_torques"] == expected["dim_internal_torques"]
    assert summary["static_indeterminacy"] == expected["dim_self_stress_of_given_rows"]
    pairs = zip(found["kinematic"]["efficiencies"], found["kinematic"]["classes"], strict=True)
    finite = [value for value, kind in pairs if kind == "finite"]
    assert finite == pytest.approx(expected["eig_velocity_eq13"], rel=1e-8)


@pytest.mark.parametrize("name", CASES)
def test_same_motions_as_the_engine_and_the_file(name: str, shared: Path) -> None:
    case = json.loads((shared / "cases" / name / "expected.json").read_text(encoding="utf-8"))
    model, q, constraints = robot(shared, case)
    member = case["reference_member"]["body"]
    mechanism = mechanism_of(model, q, constraints)
    linear = linear_model(model, q, member, constraints, active=case["actuated"])
    assert gap(our_kernel(linear, mechanism), engine_kernel(model, q, member, constraints)) < 1e-9
    file = vc.load(shared / case["model_file"]).with_configuration(case["configuration"])
    read = file.with_active(case["actuated"]).with_reference(member).linearize()
    theirs, ours = (vc.analyze(m, vc.Weights()).kinematic.efficiencies for m in (read, linear))
    assert np.allclose(theirs, ours, rtol=1e-9)


@pytest.mark.parametrize("name", ["gepetto_cassie_like", "gepetto_5bar_linkage_iso6d"])
def test_robots_closed_from_their_start(name: str, models: Path) -> None:
    """Loops of the side file, closed here; then the engine has the same motions there."""
    side = YAML(typ="safe").load(models / name / "robot.yaml")
    closures = [
        {"frame_a": a, "frame_b": b, "type": kind}
        for (a, b), kind in zip(side["closed_loop"], side["type"], strict=True)
    ]
    case = {"model_file": f"models/{name}/robot_nomesh.urdf", "configuration": {}, "loop_closures": closures}
    model, start, constraints = robot(models.parent, case)
    q = positions_of(model, mechanism_of(model, start, constraints).close())
    mechanism = mechanism_of(model, q, constraints)
    assert_poses(model, q, mechanism)
    member = mechanism.bodies[-1].name
    linear = linear_model(model, q, member, constraints, active=side["name_mot"])
    expected = engine_kernel(model, q, member, constraints)
    assert gap(our_kernel(linear, mechanism), expected) < 1e-8


def test_open_loops_are_refused_and_close(shared: Path) -> None:
    case = json.loads((shared / "cases" / CASES[0] / "expected.json").read_text(encoding="utf-8"))
    model, q, constraints = robot(shared, case)
    moved = q + 0.05
    with pytest.raises(vc.ClosureError, match="loop:"):
        linear_model(model, moved, "effector", constraints, active=case["actuated"])
    mechanism = mechanism_of(model, moved, constraints)
    again = positions_of(model, mechanism.close())
    assert linear_model(model, again, "effector", constraints, active=case["actuated"]).rows
    assert 1e-4 < np.abs(again - q).max() < 0.5


def test_refusals() -> None:
    model = chain("RX", "PZ")
    with pytest.raises(vc.ModelError, match=r"expected a pinocchio\.Model, got str"):
        mechanism_of("model")
    with pytest.raises(vc.ShapeError, match=r"configuration q has shape \(3,\)"):
        mechanism_of(model, [0.0, 0.0, 0.0])
    with pytest.raises(vc.UnknownNameError, match=r"tol.*did you mean 'tool'"):
        linear_model(model, [0, 0], "tol", active=["RX0"])
    with pytest.raises(vc.TopologyError, match="ground"):
        linear_model(model, [0, 0], "universe", active=["RX0"])
    if hasattr(pin, "JointModelEllipsoid"):
        model.addJoint(0, pin.JointModelEllipsoid(0.1, 0.2, 0.3), pin.SE3.Identity(), "egg")
        with pytest.raises(vc.UnsupportedFeatureError, match="joint 'egg': a joint of the kind Ellipsoid"):
            mechanism_of(model)
