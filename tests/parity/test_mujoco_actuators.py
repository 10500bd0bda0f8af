"""Rate map and torque map of a simulation, against motions and balances of the engine itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.linalg import null_space

import vincula as vc
from vincula.adapters.mujoco import actuator_jacobian
from vincula.arrays import Matrix

FIVE_BAR = """
<mujoco><option gravity="0 0 0"/>
  <worldbody>
    <body name="crank" pos="-1 -2 0"><joint name="o1" axis="0 0 1"/><geom size=".1"/>
      <body name="coupler" pos="0 2 0"><joint name="o2" axis="0 0 1"/><geom size=".1"/>
        <site name="tool" pos=".5 0 0"/></body></body>
    <body name="rocker" pos="1 -2 0"><joint name="o5" axis="0 0 1"/><geom size=".1"/>
      <body name="link" pos="0 1 0"><joint name="o4" axis="0 0 1"/><geom size=".1"/></body></body>
  </worldbody>
  <equality><connect body1="coupler" body2="link" anchor="1 0 0"/></equality>
  <actuator>{actuators}</actuator>
</mujoco>
"""
BASE_MOTORS = '<motor name="left" joint="o1" gear="3"/><motor name="right" joint="o5"/>'
SPRINGS = ("right_spring_link_joint", "left_spring_link_joint")


def simulation(source: str | Path) -> tuple[Any, Any]:
    text = isinstance(source, str)
    model = mujoco.MjModel.from_xml_string(source) if text else mujoco.MjModel.from_xml_path(str(source))
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def closing_rows(model: Any, data: Any, held: tuple[str, ...] = ()) -> Matrix:
    """The engine's equality rows, and one for every held joint."""
    chosen = data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    rows = np.array(data.efc_J).reshape(data.nefc, model.nv)[chosen]
    still = np.eye(model.nv)[[model.joint(name).dofadr[0] for name in held]]
    return np.vstack([rows, still])


def body_rows(model: Any, data: Any, body: int, point: Any) -> Matrix:
    rows = np.zeros((6, model.nv))
    mujoco.mj_jac(model, data, rows[:3], rows[3:], point, body)
    return rows


def assert_maps_hold(
    model: Any, data: Any, found: Any, body: int, point: Any, held: tuple[str, ...] = ()
) -> None:
    """Every motion the loops allow obeys the rate map; the torques of the torque map balance any wrench."""
    rows, jacobian = closing_rows(model, data, held), body_rows(model, data, body, point)
    for motion in null_space(rows, rcond=1e-6).T:
        data.qvel[:] = motion
        mujoco.mj_fwdVelocity(model, data)
        of_motors = np.linalg.lstsq(
            found.transmission, data.actuator_velocity[list(found.actuator_ids)], rcond=None
        )[0]
        assert np.allclose(found.twist_from_rates.matrix @ of_motors, jacobian @ motion, rtol=0, atol=1e-9)
    data.qvel[:] = 0.0
    for wrench in np.eye(6):
        torque = found.torque_from_wrench.matrix @ wrench
        data.ctrl[list(found.actuator_ids)] = np.linalg.lstsq(found.transmission.T, torque, rcond=None)[0]
        mujoco.mj_fwdActuation(model, data)
        load = data.qfrc_actuator + jacobian.T @ wrench
        rest = load - rows.T @ np.linalg.lstsq(rows.T, load, rcond=1e-9)[0]
        assert np.abs(rest).max() < 1e-9


def test_five_bar_of_the_paper(paper: dict[str, Any]) -> None:
    model, data = simulation(FIVE_BAR.format(actuators=BASE_MOTORS))
    found = actuator_jacobian(model, data, "tool")
    assert found.motors == ("o1", "o5")
    assert found.actuators == ("left", "right")
    assert found.transmission.tolist() == [[3.0, 0.0], [0.0, 1.0]]
    assert np.allclose(found.twist_from_rates.matrix, np.array(
        [[-2, 0], [-1, 0.5], [0, 0], [0, 0], [0, 0], [-2, 1]]), rtol=0, atol=1e-12)  # fmt: skip
    squares = np.linalg.svd(found.twist_from_rates.matrix, compute_uv=False) ** 2
    assert squares == pytest.approx([9.73646669, 0.51353331], rel=1e-8)
    assert not found.singular
    assert found.certain
    assert not found.reason
    body, point = model.body("coupler").id, data.site("tool").xpos
    assert_maps_hold(model, data, found, body, point)


def test_units_and_names() -> None:
    model, data = simulation(FIVE_BAR.format(actuators=BASE_MOTORS))
    found = actuator_jacobian(model, data, "tool")
    assert found.twist_from_rates.rows == ("vx", "vy", "vz", "wx", "wy", "wz")
    assert found.twist_from_rates.column_units == ("rad/s", "rad/s")
    assert found.torque_from_wrench.columns == ("fx", "fy", "fz", "mx", "my", "mz")
    assert found.torque_from_wrench.row_units == ("N m", "N m")


def test_more_motors_than_the_loops_allow() -> None:
    """Three motors on two freedoms: rates are projected, torques the least ones; motions still obey."""
    every = "".join(f'<velocity joint="{name}" gear="{k}"/>' for k, name in enumerate(("o1", "o2", "o4"), 2))
    model, data = simulation(FIVE_BAR.format(actuators=every))
    found = actuator_jacobian(model, data, "tool")
    assert "tie the motors together by 1" in found.twist_from_rates.note
    assert "1 internal torques" in found.torque_from_wrench.note
    rows, jacobian = (
        closing_rows(model, data),
        body_rows(model, data, model.body("coupler").id, data.site("tool").xpos),
    )
    order = [model.joint(name).dofadr[0] for name in found.motors]
    for motion in null_space(rows, rcond=1e-6).T:
        assert np.allclose(found.twist_from_rates.matrix @ motion[order], jacobian @ motion, atol=1e-12)


def test_one_motor_leaves_the_coupler_free() -> None:
    model, data = simulation(FIVE_BAR.format(actuators='<motor name="left" joint="o1"/>'))
    found = actuator_jacobian(model, data, "tool")
    assert found.twist_from_rates.matrix is None
    assert "can move in 1 direction" in found.reason
    assert not found.singular


def test_stretched_arms_are_singular() -> None:
    """Link and coupler in one line: the coupler can move with both motors locked."""
    model, data = simulation(FIVE_BAR.format(actuators=BASE_MOTORS))
    # Crank upright at (-1, 0); rocker end at distance 1 + sqrt(2) from (-1, 0) on the circle about (1, -2).
    reach = 1.0 + np.sqrt(2.0)
    turn = _rocker_angle(reach)
    data.qpos[model.joint("o5").qposadr[0]] = turn
    tip = np.array([1.0, -2.0]) + np.array([-np.sin(turn), np.cos(turn)])
    along = np.arctan2(tip[1], tip[0] + 1.0)
    data.qpos[model.joint("o2").qposadr[0]] = along
    elbow = np.array([-1.0, 0.0]) + np.array([np.cos(along), np.sin(along)])
    drawn = np.arctan2(0.0 - -1.0, 0.0 - 1.0)
    data.qpos[model.joint("o4").qposadr[0]] = np.arctan2(*(elbow - tip)[::-1]) - drawn - turn
    mujoco.mj_forward(model, data)
    found = actuator_jacobian(model, data, "tool")
    assert found.singular
    assert found.singularities[0].kind == "platform free"
    assert found.twist_from_rates.matrix is None
    assert "can move in 1 direction" in found.reason


def _rocker_angle(reach: float) -> float:
    """Rocker angle at which its end, 1 from (1, -2), is `reach` from (-1, 0)."""
    gap = np.sqrt(8.0)
    cosine = (gap**2 + 1.0 - reach**2) / (2.0 * gap)
    return float(np.arctan2(2.0, -2.0) + np.arccos(cosine) - np.pi / 2)


@pytest.mark.parametrize("control", [0, 120])
def test_gripper_with_springs_held(models: Path, control: int) -> None:
    model, data = simulation(models / "robotiq_2f85_menagerie" / "2f85_nomesh.xml")
    data.ctrl[:] = control
    for _ in range(control):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    found = actuator_jacobian(model, data, "right_pad", springs="held")
    assert set(found.held) == set(SPRINGS)
    assert found.free_springs == ()
    assert found.motors == ("fingers_actuator",)
    assert found.twist_from_rates.matrix is not None
    assert "can move" not in found.reason
    body = model.body("right_pad").id
    rows, jacobian = closing_rows(model, data, SPRINGS), body_rows(model, data, body, data.xpos[body])
    motions, near = null_space(rows, rcond=1e-3), 1e-9 + 100 * found.model.uncertainty.residual
    assert motions.shape[1] == 1
    for motion in motions.T:
        data.qvel[:] = motion
        mujoco.mj_fwdVelocity(model, data)
        rate = data.actuator_velocity / found.transmission[0, 0]
        assert np.allclose(found.twist_from_rates.matrix @ rate, jacobian @ motion, rtol=0, atol=near)


def test_gripper_with_springs_free(models: Path) -> None:
    model, data = simulation(models / "robotiq_2f85_menagerie" / "2f85_nomesh.xml")
    found = actuator_jacobian(model, data, "right_pad")
    assert set(found.free_springs) == set(SPRINGS)
    assert found.twist_from_rates.matrix is None
    assert "springs are no constraints: " in found.reason
    one = actuator_jacobian(model, data, "right_pad", hold=SPRINGS[:1])
    assert one.held == SPRINGS[:1]
    assert one.free_springs == SPRINGS[1:]


def test_refusals() -> None:
    model, data = simulation(FIVE_BAR.format(actuators=BASE_MOTORS))
    with pytest.raises(vc.ModelError, match="choose free or held"):
        actuator_jacobian(model, data, "tool", springs="stiff")
    with pytest.raises(vc.UnknownNameError, match="o9"):
        actuator_jacobian(model, data, "tool", hold=["o9"])
    with pytest.raises(vc.UnknownNameError, match="toool"):
        actuator_jacobian(model, data, "toool")


@pytest.mark.parametrize(("bend", "singular"), [(0.0, True), (0.3, False)])
def test_straight_wrist_is_singular(models: Path, bend: float, singular: bool) -> None:
    """Forearm roll and wrist rotation in one line turn against each other; the maps exist all the same."""
    model, data = simulation(models / "aloha_mink" / "aloha_nomesh.xml")
    data.qpos[:] = 0.0
    data.qpos[model.joint("right/wrist_angle").qposadr[0]] = bend
    found = actuator_jacobian(model, data, "right/gripper_base")
    assert found.twist_from_rates.matrix is not None
    assert np.linalg.matrix_rank(found.twist_from_rates.matrix, tol=1e-6) == (5 if singular else 6)
    assert found.singular == singular
    for one in found.singularities:
        assert one.kind == "motors without authority"
        assert set(one.joints) == {"right/forearm_roll", "right/wrist_rotate"}
