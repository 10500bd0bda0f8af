"""Random mechanisms with joints of every kind are read back from what was written."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.files.same_mechanism import ROBOTS, read_back, same_numbers, same_poses

import vincula as vc
from vincula.files.written import roll_pitch_yaw
from vincula.spatial.poses import Pose, rotation_about

KINDS = (vc.Revolute, vc.Prismatic, vc.Cylindrical, vc.Spherical, vc.Universal, vc.Screw, vc.PlanarJoint)


def random_mechanism(seed: int) -> vc.Mechanism:
    """Chains of joints of all kinds between the ground and a platform, drawn where they are closed."""
    rng = np.random.default_rng(seed)

    def unit() -> list[float]:
        vector = rng.normal(size=3)
        return list(vector / np.linalg.norm(vector))

    joints = []
    for chain in range(int(rng.integers(2, 4))):
        links = ["ground", *(f"c{chain}_{k}" for k in range(int(rng.integers(1, 3)))), "platform"]
        for k, pair in enumerate(pairwise(links)):
            kind = KINDS[int(rng.integers(len(KINDS)))]
            place, words = list(rng.uniform(-1, 1, size=3)), {}
            one, two = reversed(pair) if rng.random() < 0.3 else pair
            if kind is vc.Universal:
                first = unit()
                across = np.cross(first, unit())
                words["axes"] = [first, list(across / np.linalg.norm(across))]
            elif kind is not vc.Spherical:
                words["axis"] = unit()
            if kind is vc.Screw:
                words["lead"] = float(rng.uniform(0.1, 2.0))
            joints.append(kind(f"j{chain}_{k}", one, two, at=place, **words))
    base = vc.Mechanism.spatial(
        joints=joints, reference=vc.Reference("platform", origin=list(rng.normal(size=3)))
    )
    axes = list(base.axis_names)
    couplings = []
    scalar = [
        a
        for j in base.joints
        if j.type in ("revolute", "prismatic")
        for a in base.type_of(j).axis_names(j.name)
    ]
    if len(scalar) >= 2 and rng.random() < 0.6:
        one, two = rng.choice(scalar, size=2, replace=False)
        couplings.append(vc.Coupling("gear", {str(one): 1.0, str(two): float(rng.uniform(-3, 3))}))
    active = [str(a) for a in rng.choice(axes, size=min(len(axes), 4), replace=False)]
    return vc.Mechanism.spatial(
        joints=joints, couplings=couplings, active=active, name="random",
        reference=vc.Reference("platform", origin=list(rng.normal(size=3))),
    )  # fmt: skip


@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), to=st.sampled_from(["native", "mjcf", "urdf-plus", "urdf-gepetto"]))
def test_random_mechanisms_are_read_back(
    seed: int, to: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    if to == "mjcf":
        pytest.importorskip("mujoco")
    mechanism = random_mechanism(seed)
    path = tmp_path_factory.mktemp("random") / f"robot{ROBOTS.get(to, '.yaml')}"
    again, _ = read_back(mechanism, path, to)
    assert sorted(again.active) == sorted(mechanism.active)
    same_numbers(mechanism, again, counts=to == "native")
    same_poses(mechanism, again, origins=not to.startswith("urdf"))


@settings(max_examples=200)
@given(
    st.sampled_from([0.0, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, np.pi, 0.3]),
    st.floats(-4, 4),
    st.floats(-4, 4),
)
def test_angles_are_exact_where_pitch_is_a_right_angle(pitch: float, roll: float, yaw: float) -> None:
    x, y, z = np.eye(3)
    rotation = rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)
    r, p, w = roll_pitch_yaw(Pose.at(np.zeros(3), rotation))
    again = rotation_about(z, w) @ rotation_about(y, p) @ rotation_about(x, r)
    assert np.abs(again - rotation).max() < 4e-16 * 4
