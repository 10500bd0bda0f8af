"""Poses, loop residuals and motions of real robots against MuJoCo's own kinematics and equality rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.parity.mujoco_peer import Peer, gap, our_kernel

pytest.importorskip("mujoco")

ROBOTS = {
    "aloha_mink/aloha_nomesh.xml": "left/gripper_link",
    "leap_hand_mink/right_hand_nomesh.xml": "thumb_fingertip",
    "robotiq_2f85_menagerie/2f85_nomesh.xml": "right_pad",
    "robotiq_2f85_menagerie/2f85_nomesh_explicit_jointpos.xml": "left_pad",
    "stewart_sdf/stewart_from_sdf.xml": "platform",
    "unitree_go1_mink/go1_nomesh.xml": "FR_calf",
}


@pytest.mark.parametrize("robot", ROBOTS)
def test_body_poses(models: Path, robot: str, rng: np.random.Generator) -> None:
    peer = Peer.of(models / robot)
    for _ in range(3):
        peer.scatter(rng, 0.3)
        poses = peer.mechanism.body_poses(peer.values())
        for index, body in enumerate(peer.bodies):
            assert np.abs(poses[body].position - peer.data.xpos[index]).max() < 1e-13
            assert np.abs(poses[body].rotation - peer.data.xmat[index].reshape(3, 3)).max() < 1e-13


@pytest.mark.parametrize("robot", ROBOTS)
def test_motions(models: Path, robot: str, rng: np.random.Generator) -> None:
    peer, body = Peer.of(models / robot), ROBOTS[robot]
    for _ in range(2):
        peer.scatter(rng, 0.1)
        peer.close()
        ours = our_kernel(peer.mechanism, peer.values(), body, peer.joints)
        theirs = peer.kernel(body, peer.data.xpos[peer.bodies.index(body)])
        assert gap(ours, theirs) < 1e-9


@pytest.mark.parametrize("robot", ROBOTS)
def test_open_loops_are_open_by_what_mujoco_says(models: Path, robot: str, rng: np.random.Generator) -> None:
    peer = Peer.of(models / robot)
    peer.scatter(rng, 0.05)
    _, residual = peer.rows()
    ours = [r.linear for r in peer.mechanism.residuals(peer.values()) if r.kind != "coupling"]
    theirs, row = [], 0
    for equality in range(peer.model.neq):
        count = {0: 3, 1: 6}.get(int(peer.model.eq_type[equality]), 1)
        if count > 1:
            theirs.append(np.linalg.norm(residual[row : row + 3]))
        row += count
    assert np.allclose(ours, theirs, rtol=0, atol=1e-14)
