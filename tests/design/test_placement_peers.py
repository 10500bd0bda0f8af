"""Placement against peers that know nothing of it: null spaces of matrices written down here, and MuJoCo."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space

import vincula as vc

PINS = {"o1": (-1, -2), "o2": (-1, 0), "o3": (0, 0), "o4": (1, -1), "o5": (1, -2)}
POINT = (-0.5, 0.0)
LEGS = ("FR", "FL", "RR", "RL")


def velocity(pin: tuple[float, float], at: tuple[float, float]) -> list[float]:
    """vx, vy, wz of a point of a body that turns about a pin with 1 rad/s."""
    return [-(at[1] - pin[1]), at[0] - pin[0], 1.0]


def extremes(motions: np.ndarray, member: np.ndarray, motors: list[int]) -> tuple[int, np.ndarray]:
    """How many motions of the member are left with motors locked; squared speeds a motor speed if none is.

    Args:
        motions: Columns: all motions that the loops allow.
        member: Twist of the member for joint rates.
        motors: Rows of `motions` that are motors.
    """
    twists = member @ motions
    left = twists @ null_space(motions[motors], rcond=1e-9)
    loose = np.linalg.matrix_rank(left, tol=1e-9)
    if loose:
        return int(loose), np.empty(0)
    # Every twist follows from the motor rates; the least rates that give it are those of the pseudo-inverse.
    values = np.linalg.svd(twists @ np.linalg.pinv(motions[motors], rcond=1e-9), compute_uv=False) ** 2
    return 0, values[values > 1e-12]


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_five_bar_by_null_spaces(size: int) -> None:
    """All 31 choices: loose motions, kinematic index, force index, ways to squeeze."""
    names = list(PINS)
    loop = np.array([velocity(pin, (0.3, 0.7)) for pin in PINS.values()]).T  # around the loop nothing is left
    motions = null_space(loop)
    member = np.zeros((3, 5))
    for k, name in enumerate(names[:2]):  # ground - crank - coupler
        member[:, k] = velocity(PINS[name], POINT)
    found = vc.place(vc.load("example:five-bar"), size)
    assert len(found.choices) == len(list(combinations(names, size)))
    for choice in found.choices:
        motors = [names.index(name) for name in choice.motors]
        loose, values = extremes(motions, member, motors)
        assert choice.largest("indeterminacy") == loose == max(2 - size, 0)
        assert choice.largest("internal_torques") == max(size - 2, 0)
        assert choice.largest("redundancy") == 0
        if not loose:
            assert choice.index == pytest.approx(values.min(), rel=1e-9)
            # Virtual work: what is fast is weak, in the same proportion.
            for force in ("active-force", "passive-force"):
                assert choice.indices[force].worst == pytest.approx(1.0 / values.max(), rel=1e-9)


@pytest.fixture(scope="module")
def standing(models: Path, tmp_path_factory: pytest.TempPathFactory) -> vc.Mechanism:
    """A quadruped on point contacts with friction, the trunk as member."""
    pytest.importorskip("mujoco")
    source = models / "unitree_go1_mink" / "go1_nomesh.xml"
    pose = {"hip": 0.0, "thigh": 0.9, "calf": -1.8}
    values = ", ".join(f"{leg}_{part}_joint: {value}" for leg in LEGS for part, value in pose.items())
    contacts = "\n".join(
        f"  - {{name: foot-{leg}, type: hard-finger, bodies: [ground, {leg}_calf], "
        f"at: {{in: {leg}, xyz: [0, 0, 0]}}, normal: [0, 0, 1]}}"
        for leg in LEGS
    )
    path = tmp_path_factory.mktemp("standing") / "go1.yaml"
    path.write_text(
        f"vincula: 1\nbase: {source}\nreference: {{body: trunk}}\ncontacts:\n{contacts}\n"
        f"configuration: {{jnt0: [0, 0, 0.27, 1, 0, 0, 0], {values}}}\n",
        encoding="utf-8",
    )
    return vc.load(path).with_weights(vc.Weights(twist=[1, 1, 1, 0.05, 0.05, 0.05]))


@pytest.fixture(scope="module")
def engine(models: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the leg joints; motions with the feet at rest (rows: leg joints); the trunk, weighted."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(models / "unitree_go1_mink" / "go1_nomesh.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    rows = []
    for leg in LEGS:
        rows.append(np.zeros((3, model.nv)))
        mujoco.mj_jacSite(model, data, rows[-1], None, model.site(leg).id)
    motions = null_space(np.vstack(rows))
    trunk = np.zeros((6, model.nv))
    mujoco.mj_jacBody(model, data, trunk[:3], trunk[3:], model.body("trunk").id)
    weighted = np.diag(np.sqrt([1, 1, 1, 0.05, 0.05, 0.05])) @ trunk @ motions
    names = [model.joint(k).name for k in range(1, model.njnt)]
    return names, motions[6:], weighted @ np.linalg.pinv(motions[6:])


def test_a_standing_quadruped_with_up_to_three_motors(standing, engine) -> None:
    """All 298 choices leave what the null space of MuJoCo's foot Jacobians leaves; fewest left come first."""
    names, motions, member = engine
    found = vc.place(standing, (1, 2, 3))
    assert found.admissible.candidates == tuple(names)
    assert len(found.choices) == 12 + 66 + 220
    for choice in found.choices:
        loose, _ = extremes(motions, member, [names.index(name) for name in choice.motors])
        assert choice.largest("indeterminacy") == loose
    left = [choice.largest("indeterminacy") for choice in found.choices]
    assert left == sorted(left)
    assert left[0] == 3
    assert (found.fewest, found.limit.controls) == (6, True)
    assert "3 motors cannot be enough. Ask for 6 or more" in found.explanation[0]
    assert found.explanation[1].startswith(f"Nearest comes {', '.join(found.choices[0].motors[:-1])}")


def test_a_standing_quadruped_with_enough_motors(standing, engine) -> None:
    """Six motors: a few random choices, and the two legs of a diagonal, by MuJoCo's Jacobians."""
    names, motions, member = engine
    forbidden = [name for name in names if name.startswith("RL") and "calf" not in name]
    required = ["FR_hip_joint", "FR_thigh_joint", "FR_calf_joint", "RR_hip_joint"]
    found = vc.place(standing, 6, forbid=forbidden, require=required)
    assert len(found.choices) == 15
    holding = 0
    for choice in found.choices:
        loose, values = extremes(motions, member, [names.index(name) for name in choice.motors])
        assert choice.largest("indeterminacy") == loose
        if not loose:
            holding += 1
            assert choice.index == pytest.approx(values.min(), rel=1e-7)
    assert holding == len(found.controlling) > 0
    assert found.best is not None
    assert found.best.index == max(choice.index for choice in found.controlling)


def test_a_floating_body_is_loose_whatever_the_motors(models: Path) -> None:
    """Without contacts no motor can hold the trunk, and the words say so once."""
    pytest.importorskip("mujoco")
    robot = vc.load(models / "unitree_go1_mink" / "go1_nomesh.xml").with_reference("trunk")
    found = vc.place(robot, 1)
    assert found.best is None
    assert not found.limit.controls
    assert "None can: even motors on all 12 candidates leave 'trunk' loose in 6 ways" in found.explanation[0]
    assert found.explanation[1].startswith("Nothing holds 'trunk'")


def test_a_figure_where_no_choice_holds_the_member(standing) -> None:
    """The bars are the nearest choices, the discs count what is left: 66 pairs, most of which leave four."""
    pytest.importorskip("matplotlib")
    from vincula.view.placement_figure import plot_placement

    found = vc.place(standing, 2)
    bars, left = plot_placement(found).axes
    assert "no choice controls" in bars.get_title()
    assert bars.get_yticklabels()[0].get_text() == ", ".join(
        name.removesuffix("_joint") for name in found.choices[0].motors
    )
    counted = {int(text.xy[1]): int(text.get_text()) for text in left.texts}
    assert sum(counted.values()) == 66
    assert counted[4] == sum(choice.largest("indeterminacy") == 4 for choice in found.choices) > 33
