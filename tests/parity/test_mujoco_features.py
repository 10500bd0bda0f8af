"""Every MJCF feature that makes a mechanism, in a file of its own, against MuJoCo's own motions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.conftest import ROOT
from tests.parity.mujoco_peer import Peer, gap, our_kernel

pytest.importorskip("mujoco")

FOLDER = ROOT / "tests" / "files" / "mjcf"
MEMBERS = {
    "hinges": "b3",
    "slide": "b2",
    "ball": "b2",
    "several-joints-in-a-body": "b2",
    "hinge-ball-in-a-body": "b1",
    "free-joint": "b3",
    "ref": "b2",
    "degrees-and-ref": "b3",
    "radians": "b",
    "euler-sequence": "b",
    "frames": "b",
    "several-top-level-bodies": "b3",
    "defaults": "b",
    "replicate": "b-1",
    "connect-to-the-world": "b5",
    "connect-at-sites": "b5",
    "weld": "b5",
    "weld-with-relpose-and-anchor": "b5",
    "weld-at-sites": "b5",
    "weld-without-torque": "b5",
    "joint-equality": "b3",
    "joint-equality-with-ref": "b3",
    "equality-of-one-joint": "b3",
    "tendon-equality": "b6",
    "equality-of-one-tendon": "b3",
    "inactive-equality": "b5",
    "fused-bodies": "b",
    "inertia-that-turns-a-free-body": "c",
}


def file_of(feature: str) -> Path:
    return FOLDER / f"{feature}.xml"


@pytest.mark.parametrize("feature", MEMBERS)
def test_motions(feature: str, rng: np.random.Generator) -> None:
    peer, body = Peer.of(file_of(feature)), MEMBERS[feature]
    for size in (0.0, 0.05, 0.2):
        peer.scatter(rng, size)
        peer.close()
        values = peer.values()
        assert max((r.gap for r in peer.mechanism.residuals(values)), default=0.0) < 1e-11
        ours = our_kernel(peer.mechanism, values, body, peer.joints)
        assert gap(ours, peer.kernel(body, peer.data.xpos[peer.bodies.index(body)])) < 1e-9


@pytest.mark.parametrize("feature", MEMBERS)
def test_poses_and_sites(feature: str, rng: np.random.Generator) -> None:
    peer = Peer.of(file_of(feature))
    peer.scatter(rng, 1.0)
    poses = peer.mechanism.body_poses(peer.values())
    for index, body in enumerate(peer.bodies):
        assert np.abs(poses[body].position - peer.data.xpos[index]).max() < 1e-13
        assert np.abs(poses[body].rotation - peer.data.xmat[index].reshape(3, 3)).max() < 1e-13
    for index, frame in enumerate(peer.mechanism.frames):
        pose = poses[frame.body] @ frame.pose
        assert np.abs(pose.position - peer.data.site_xpos[index]).max() < 1e-13
        assert np.abs(pose.rotation - peer.data.site_xmat[index].reshape(3, 3)).max() < 1e-13


def test_home_is_qpos0() -> None:
    peer = Peer.of(file_of("joint-equality-with-ref"))
    peer.move_to(peer.model.qpos0)
    for joint, value in peer.values().items():
        assert np.array_equal(peer.mechanism.home[joint], value)
    assert peer.mechanism.home["s"][0] == 0.4
