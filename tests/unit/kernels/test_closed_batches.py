"""Batches of motor positions and poses through the front door: in lanes as one by one."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.kernels.reference_path import ReferencePath

pytest.importorskip("numba")

WANTED = ("kinematic.efficiencies", "configuration", "closure.residual", "closure.iterations", "summary")


def both_ways(mechanism: vc.Mechanism, given: str, inputs: np.ndarray) -> tuple[vc.Evaluation, vc.Evaluation]:
    compiled = vc.compile(mechanism)
    lanes = compiled.evaluate(inputs, WANTED, given=given, path="lanes")
    return lanes, compiled.evaluate(inputs, WANTED, given=given, path="reference")


def test_motors_driven_in_and_out_of_reach() -> None:
    linkage = vc.load("example:five-bar").with_weights(vc.Weights())
    angle = np.linspace(0.0, 2.0 * np.pi, 60)[:, None]
    lanes, reference = both_ways(linkage, "motors", 0.3 * np.sin(angle * [1.0, 0.79]))
    assert set(lanes.status_counts) == {"ok", "no-closure"}
    assert np.array_equal(lanes.status, reference.status)
    assert np.array_equal(lanes["summary"], reference["summary"])
    ok = lanes.status == 0
    assert np.abs(lanes["configuration"][ok] - reference["configuration"][ok]).max() < 1e-9
    one, two = lanes["kinematic.efficiencies"][ok], reference["kinematic.efficiencies"][ok]
    assert np.nanmax(np.abs(one / two - 1.0)) < 1e-8
    assert np.array_equal(np.isnan(one), np.isnan(two))
    assert np.isnan(lanes["kinematic.efficiencies"][~ok]).all()
    assert "close" in lanes.reason(int(np.flatnonzero(~ok)[0]))
    assert lanes["closure.residual"][ok].max() < 1e-12


def test_lanes_that_do_not_close_are_not_evaluated(monkeypatch: pytest.MonkeyPatch) -> None:
    """They hold the singular configuration at the border of the workspace, which only milliseconds decide."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    compiled = vc.compile(linkage)
    border = linkage.follow([{"o1": 0.9, "o5": 0.9}], limits=False).end
    inputs = np.linspace([0.9, 0.9], [0.95, 0.95], 40)
    asked: list[int] = []
    fill = ReferencePath.fill
    monkeypatch.setattr(ReferencePath, "fill", lambda self, *rest: asked.append(0) or fill(self, *rest))
    found = compiled.evaluate(inputs, WANTED, given="motors", start=border.flat)
    assert set(found.status_counts) == {"no-closure"}
    assert not asked
    assert np.isnan(found["kinematic.efficiencies"]).all()
    assert np.isnan(found["configuration"]).all()
    assert "gaps stay open" in found.reason(39)


def test_poses_of_a_platform() -> None:
    platform = vc.load("example:stewart")
    rng = np.random.default_rng(1)
    turn = np.concatenate([np.ones((7, 1)), rng.uniform(-0.2, 0.2, (7, 3))], axis=1)
    poses = np.concatenate([rng.uniform(-0.2, 0.2, (7, 3)) + np.array([0.0, 0.0, 2.0]), turn], axis=1)
    lanes, reference = both_ways(platform, "reference", poses)
    assert lanes.status_counts == reference.status_counts == {"ok": 7}
    one, two = lanes["kinematic.efficiencies"], reference["kinematic.efficiencies"]
    assert np.nanmax(np.abs(one / two - 1.0)) < 1e-10
    assert lanes["closure.residual"].max() < 1e-12


def test_one_pose_at_a_time_gives_what_a_batch_gives() -> None:
    platform = vc.load("example:stewart")
    compiled = vc.compile(platform)
    poses = np.array([[0.1, 0.0, 2.1, 1.0, 0.1, 0.0, 0.05], [0.0, -0.1, 1.9, 1.0, 0.0, 0.1, 0.0]])
    many = compiled.evaluate(poses, WANTED, given="reference", start=np.tile(compiled.flat(), (2, 1)))
    for k, pose in enumerate(poses):
        compiled.evaluate(pose, WANTED, given="reference")  # prepares
        single = compiled.evaluate(pose, WANTED, given="reference")
        for name in WANTED:
            assert np.array_equal(single[name], many[name][k], equal_nan=True), name
