"""A running simulation as a linear model, against the rows that the engine itself works with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.linalg import null_space
from tests.parity.mujoco_peer import gap

import vincula as vc
from vincula.adapters.mujoco import linear_model
from vincula.arrays import Matrix
from vincula.model import LinearModel

BOXES = """
<mujoco>
  <option cone="elliptic"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1" condim="1" friction=".7 .1 .1"/>
    <body name="arm" pos="0 0 .5">
      <joint name="lift" type="slide" axis="0 0 1"/><joint name="turn" axis=".1 0 1" pos=".3 0 0"/>
      <geom name="plate" type="box" size=".2 .2 .05" condim="{condim}"/>
    </body>
    <body name="thing" pos="0 0 .649" euler="0 0 20">
      <freejoint name="thing"/>
      <geom name="box" type="box" size=".1 .1 .1" condim="1"/>
      <site name="corner" pos=".1 .1 .1"/>
    </body>
  </worldbody>
  <actuator><motor name="lifter" joint="lift"/></actuator>
</mujoco>
"""


def simulation(source: str | Path) -> tuple[Any, Any]:
    model = (
        mujoco.MjModel.from_xml_path(str(source))
        if isinstance(source, Path)
        else mujoco.MjModel.from_xml_string(source)
    )
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def engine_rows(model: Any, data: Any, *kinds: Any) -> Matrix:
    chosen = np.isin(data.efc_type[: data.nefc], [int(k) for k in kinds])
    return np.array(data.efc_J).reshape(data.nefc, model.nv)[chosen]


def kernel_of(linear: LinearModel, order: list[str]) -> Matrix:
    rows = np.hstack([linear.jacobian_active, linear.jacobian_passive, -linear.grasp.T])
    names = [column.name for column in linear.columns]
    index = [names.index(axis) for axis in order]
    return null_space(rows, rcond=1e-9)[[*index, *range(len(names), len(names) + 6)]]


@pytest.mark.parametrize("condim", [1, 3, 4, 6])
def test_contacts_have_the_rows_of_the_engine(condim: int) -> None:
    model, data = simulation(BOXES.format(condim=condim))
    data.qpos[:2] = 0.001, 0.2
    mujoco.mj_forward(model, data)
    # The arm's own kernel: the box hangs from nothing, so its twist is that of the free joint.
    linear = linear_model(model, data, "thing", contacts=True)
    assert len(linear.rows) == condim * data.ncon
    elliptic = mujoco.mjtConstraint.mjCNSTR_CONTACT_ELLIPTIC
    theirs = engine_rows(model, data, elliptic, mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
    assert len(theirs) == len(linear.rows)
    motions = null_space(theirs, rcond=1e-9)
    jacobian = np.zeros((6, model.nv))
    body = model.body("thing").id
    mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], body)
    stacked = np.linalg.qr(np.vstack([motions[:2], jacobian @ motions]))[0]
    assert gap(kernel_of(linear, ["lift", "turn"]), stacked) < 1e-9
    assert linear.motors[0].name == "lift"


def test_normals_point_into_the_member() -> None:
    model, data = simulation(BOXES.format(condim=3))
    for member, sign in (("thing", 1.0), ("arm", -1.0)):
        linear = linear_model(model, data, member, contacts=True)
        row = [r.name for r in linear.rows].index("plate-box.fz")
        # A force along the normal, of the limb on the member, pushes the box up and the plate down.
        assert linear.grasp[2, row] == pytest.approx(sign)


def test_a_site_is_the_reference_point() -> None:
    model, data = simulation(BOXES.format(condim=3))
    for text in ("corner", "thing@corner"):
        assert linear_model(model, data, text, contacts=True).reference == "thing@corner"


def test_contacts_belong_to_qpos_not_to_the_last_step() -> None:
    model, data = simulation(BOXES.format(condim=3))
    data.qpos[2:5] = 0.0, 0.0, 3.0
    before = data.ncon
    linear = linear_model(model, data, "arm", contacts=True)
    assert before == data.ncon == 4
    assert not [row for row in linear.rows if row.kind == "contact"]


def test_soft_loops_close_where_they_stand(models: Path) -> None:
    model, data = simulation(models / "robotiq_2f85_menagerie" / "2f85_nomesh.xml")
    data.ctrl[:] = 120
    for _ in range(200):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    linear = linear_model(
        model, data, "right_pad", lock=["right_spring_link_joint", "left_spring_link_joint"]
    )
    equality = mujoco.mjtConstraint.mjCNSTR_EQUALITY
    open_by = np.abs(data.efc_pos[: data.nefc][data.efc_type[: data.nefc] == int(equality)]).max()
    assert 1e-8 < open_by / 2 < linear.uncertainty.residual < 2 * open_by < 1e-3
    assert any("soft" in note for note in linear.notes)
    held = [model.joint(f"{side}_spring_link_joint").dofadr[0] for side in ("right", "left")]
    moving = [i for i in range(model.nv) if i not in held]
    theirs = null_space(engine_rows(model, data, equality)[:, moving], rcond=1e-3)
    order = [model.joint(i).name for i in range(model.njnt) if model.joint(i).dofadr[0] in moving]
    rates = np.linalg.qr(kernel_of(linear, order)[: len(order)])[0]
    assert gap(rates, theirs) < 100 * open_by / linear.length
    with pytest.raises(vc.ClosureError, match="settled"):
        linear_model(model, data, "right_pad", softness=1e-8)


def test_active_equalities_of_the_data_count(models: Path) -> None:
    model, data = simulation(models / "robotiq_2f85_menagerie" / "2f85_nomesh.xml")
    with_loops = linear_model(model, data, "right_pad")
    data.eq_active[:] = 0
    without = linear_model(model, data, "right_pad")
    assert len(with_loops.rows) - len(without.rows) == 3 + 3 + 1
    assert model.eq_active0.all()


def test_same_as_the_file(models: Path) -> None:
    path = models / "unitree_go1_mink" / "go1_nomesh.xml"
    model, data = simulation(path)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    from vincula.files.mjcf import load_mjcf

    robot = load_mjcf(path)[0]
    q = robot.configuration(robot.keyframes["home"])
    wanted = robot.with_reference("FR_calf", frame="FR").linearize(q)
    found = linear_model(model, data, "FR")
    assert [c.name for c in found.columns] == [c.name for c in wanted.columns]
    assert np.allclose(found.jacobian_active, wanted.jacobian_active, rtol=0, atol=1e-15)
    assert np.allclose(found.grasp, wanted.grasp, rtol=0, atol=1e-15)


def test_mocap_bodies_stand_where_the_data_has_them() -> None:
    text = """
    <mujoco><worldbody>
      <body name="target" mocap="true" pos="0 0 1"/>
      <body name="arm" pos="0 0 1"><joint name="a" type="ball"/><geom size=".1"/></body>
    </worldbody><equality><connect body1="arm" body2="target" anchor="0 0 0"/></equality></mujoco>"""
    model, data = simulation(text)
    data.mocap_pos[0] = 0.0, 0.0, 1.2
    with pytest.raises(vc.ClosureError, match="connect:arm-target"):
        linear_model(model, data, "arm")


def test_refusals(models: Path) -> None:
    model, data = simulation(BOXES.format(condim=3))
    with pytest.raises(vc.ModelError, match=r"mujoco\.MjModel"):
        linear_model(data, model, "thing")
    with pytest.raises(vc.UnknownNameError, match=r"thng.*did you mean 'thing'"):
        linear_model(model, data, "thng")
    with pytest.raises(vc.TopologyError, match="ground"):
        linear_model(model, data, "world")
    other, _ = simulation(models / "unitree_go1_mink" / "go1_nomesh.xml")
    with pytest.raises(vc.ModelError, match="another model"):
        linear_model(other, data, "trunk")
