"""Batches of motor positions and poses through the front door: in lanes as one by one."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.kernels.reference_path import ReferencePath
from vincula.mechanism.branches import branch_of

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


def test_a_grid_around_a_hole_stays_on_one_branch() -> None:
    """Behind the hole of what motors reach, rows go on from other rows, not from wherever a search ends."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    angles = np.radians(np.linspace(-120.0, 120.0, 41))
    grid = np.stack(np.meshgrid(angles, angles, indexing="ij"), axis=-1)
    found = vc.compile(linkage).evaluate(grid, ("configuration",), given="motors", path="lanes")
    ok = found.status == 0
    assert np.array_equal(ok, _within_reach(linkage, grid))
    inside = np.argwhere(ok)
    for place in np.random.default_rng(3).choice(inside, 60, replace=False):
        flat = found["configuration"][tuple(place)]
        assert branch_of(linkage, linkage.home.from_flat(flat)).assembly == "+", grid[tuple(place)]


def test_holes_that_are_smaller_than_a_step_are_not_leapt() -> None:
    """A pen carried by two legs, each of which cannot come near its own foot: legs stay bent as they were."""
    places = {"o1": (-0.5, 0), "o2": (-1, 1), "o3": (0, 1.8), "o4": (1, 1), "o5": (0.5, 0)}
    bars = ["ground", "a", "b", "c", "d", "ground"]
    joints = [
        vc.Revolute(name, one, two, at=place)
        for (name, place), one, two in zip(places.items(), bars, bars[1:], strict=False)
    ]
    linkage = vc.Mechanism.planar(
        joints=[*joints, vc.Revolute("pen", "b", "tip", at=places["o3"])],
        reference=vc.Reference("tip", origin=places["o3"]),
        active=["o1", "o5"],
        weights=vc.Weights(),
    )
    across, up = np.meshgrid(np.linspace(-2.5, 2.5, 21), np.linspace(-2.6, 2.6, 31), indexing="ij")
    poses = np.stack([across, up, np.zeros_like(up)], axis=-1)
    found = vc.compile(linkage).evaluate(poses, ("branch.working",), given="reference", path="lanes")
    ok = found.status == 0
    lengths = [np.hypot(0.5, 1.0), np.hypot(1.0, 0.8)]
    reach = np.ones_like(ok)
    for foot in (-0.5, 0.5):
        far = np.hypot(across - foot, up)
        reach &= (far < sum(lengths)) & (far > abs(lengths[0] - lengths[1]))
    assert np.array_equal(ok, reach)
    assert (found["branch.working"][ok] > 0.0).all()


def _within_reach(linkage: vc.Mechanism, grid: np.ndarray) -> np.ndarray:
    """Whether coupler and link reach from the end of one driven bar to that of the other."""
    o1, o2, o3, o4, o5 = (linkage.joint[f"o{k}"].frame_on_first.position for k in range(1, 6))
    turns = grid * [1.0, -1.0]  # o5 is drawn from the rocker to the ground
    cosine, sine = np.cos(turns), np.sin(turns)

    def end(foot: np.ndarray, tip: np.ndarray, k: int) -> np.ndarray:
        x, y = tip - foot
        turned = [cosine[..., k] * x - sine[..., k] * y, sine[..., k] * x + cosine[..., k] * y]
        return foot + np.stack(turned, axis=-1)

    way = np.linalg.norm(end(o5, o4, 1) - end(o1, o2, 0), axis=-1)
    coupler, link = np.linalg.norm(o3 - o2), np.linalg.norm(o4 - o3)
    return (way <= coupler + link) & (way >= abs(coupler - link))


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
