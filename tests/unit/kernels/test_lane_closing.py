"""Closing in lanes: against `Mechanism.close`, against geometry, and the same bits however it is cut up."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.random_closed import random_closed

import vincula as vc

pytest.importorskip("numba")

from vincula.kernels.closing import pose_from
from vincula.kernels.lanes.closing import STRETCH, LaneClosing
from vincula.kernels.lanes.flatten import Unsupported
from vincula.kernels.quantities import quaternion_places
from vincula.mechanism.catalog.registry import examples

NAMES = [entry.name for entry in examples()]


def along(closing: LaneClosing, seed: int, count: int, step: float) -> np.ndarray:
    """Inputs near home that exist: those of configurations on a path of closed ones."""
    mechanism, rng = closing.mechanism, np.random.default_rng(seed)
    inputs, q = [], mechanism.home
    start = closing.at_home
    for _ in range(count):
        aim = start + step * rng.uniform(-1.0, 1.0, len(start))
        try:
            q = closed_by_the_library(closing, aim, q)
        except vc.ClosureError:
            continue
        inputs.append(aim)
    return np.array(inputs).reshape(-1, len(start))


def closed_by_the_library(
    closing: LaneClosing, given: np.ndarray, near: vc.Configuration
) -> vc.Configuration:
    if closing.given == "motors":
        motors = dict(zip(closing.mechanism.active, map(float, given), strict=True))
        return closing.mechanism.close(near, motors=motors, attempts=1)
    return closing.mechanism.close(near, pose=pose_from(given), attempts=1)


def difference(mechanism: vc.Mechanism, one: np.ndarray, two: np.ndarray) -> float:
    """Largest difference of two configurations, quaternions up to their sign."""
    other = two.copy()
    for place in quaternion_places(mechanism):
        if one[place : place + 4] @ two[place : place + 4] < 0.0:
            other[place : place + 4] *= -1.0
    return float(np.abs(one - other).max(initial=0.0))


def prepared(mechanism: vc.Mechanism, given: str) -> LaneClosing:
    try:
        return LaneClosing.prepare(mechanism, given)
    except Unsupported as error:
        pytest.skip(str(error))


def agrees_with_the_library(closing: LaneClosing, inputs: np.ndarray) -> None:
    mechanism = closing.mechanism
    found = closing.run(inputs, mechanism.home, len(inputs))
    near: vc.Configuration = mechanism.home
    for k, given in enumerate(inputs):
        near = closed_by_the_library(closing, given, near)
        if not found.closed[k]:  # slow near singularities: handed to the library, never called open
            assert not closing.determined
            assert found.jumped[k] or found.residual[k] < 1e-6 * mechanism.length
            continue
        q = mechanism.home.from_flat(found.values[k])
        gap = max((r.gap for r in mechanism.residuals(q)), default=0.0)
        assert gap <= 2e-12 * mechanism.length
        if closing.determined:
            assert difference(mechanism, found.values[k], near.flat) < 1e-9


@pytest.mark.parametrize("given", ["motors", "reference"])
@pytest.mark.parametrize("name", NAMES)
def test_catalog_closes_as_the_library_does(name: str, given: str) -> None:
    mechanism = vc.load(f"example:{name}")
    if not mechanism.active and given == "motors":
        pytest.skip("no motors")
    closing = prepared(mechanism, given)
    if not closing.home_is_closed:
        pytest.skip("open at home")
    inputs = along(closing, 3, 6, 0.03)
    agrees_with_the_library(closing, inputs)


@pytest.mark.parametrize("seed", range(16))
def test_random_mechanisms_close_as_the_library_does(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mechanism = random_closed(rng, planar=bool(seed % 2), loops=1 + seed % 3)
    scalar = [j.name for j in mechanism.joints if j.type in ("revolute", "prismatic") and not j.closure]
    if not scalar:
        pytest.skip("nothing to drive")
    mechanism = mechanism.with_active(scalar[:1])
    closing = prepared(mechanism, "motors")
    agrees_with_the_library(closing, along(closing, seed, 5, 0.05))


def test_what_is_out_of_reach_is_open_and_what_is_not_is_closed() -> None:
    """Five-bar: the second and fourth joint must be between 0.414 m and 2.414 m apart."""
    linkage = vc.load("example:five-bar")
    closing = LaneClosing.prepare(linkage, "motors")
    angle = np.linspace(0.0, 2.0 * np.pi, 300)[:, None]
    inputs = 0.3 * np.sin(angle * [1.0, 0.79])
    found = closing.run(inputs, linkage.home, len(inputs))
    one = np.stack([-1.0 - 2.0 * np.sin(inputs[:, 0]), -2.0 + 2.0 * np.cos(inputs[:, 0])], axis=1)
    two = np.stack([1.0 + np.sin(inputs[:, 1]), -2.0 + np.cos(inputs[:, 1])], axis=1)
    apart = np.linalg.norm(one - two, axis=1)
    assert np.array_equal(found.closed, (apart < 1.0 + np.sqrt(2.0)) & (apart > np.sqrt(2.0) - 1.0))
    assert 0.3 < found.closed.mean() < 0.9


def test_bits_do_not_depend_on_lanes_threads_or_what_follows() -> None:
    platform = vc.load("example:stewart")
    closing = LaneClosing.prepare(platform, "reference")
    angle = np.arange(6 * STRETCH + 40)[:, None] / 160.0
    offset = 0.15 * np.sin(angle * [1.0, 0.83, 0.71, 0.59, 0.47, 0.37])
    turn = np.concatenate([np.ones((len(offset), 1)), offset[:, 3:]], axis=1)
    poses = np.concatenate([offset[:, :3] + [0.0, 0.0, 2.0], turn], axis=1)
    whole = closing.run(poses, platform.home, len(poses), threads=2)
    assert whole.closed.all()
    again = closing.run(poses, platform.home, len(poses), threads=1)
    assert np.array_equal(whole.values, again.values)
    few = closing.run(poses[: 2 * STRETCH + 7], platform.home, 2 * STRETCH + 7)
    assert np.array_equal(few.values, whole.values[: 2 * STRETCH + 7])
    one = closing.run(poses[:40], platform.home, 40)  # one lane alone
    assert np.array_equal(one.values, whole.values[:40])


def test_many_turns_are_followed_stretch_after_stretch() -> None:
    """A crank that turns five times: joints follow their neighbours, also across stretches."""
    linkage = vc.Mechanism.planar(
        joints=[
            vc.Revolute("crank", "ground", "one", at=(0, 0)),
            vc.Revolute("left", "one", "two", at=(0, 1)),
            vc.Revolute("right", "two", "three", at=(3, 2.5)),
            vc.Revolute("rocker", "three", "ground", at=(3.5, 0)),
        ],
        reference=vc.Reference("two"),
        active=["crank"],
    )
    closing = LaneClosing.prepare(linkage, "motors")
    inputs = np.linspace(0.0, 10.0 * np.pi, 4 * STRETCH)[:, None]
    found = closing.run(inputs, linkage.home, len(inputs))
    assert found.closed.all()
    assert np.abs(np.diff(found.values, axis=0)).max() < 0.2
    turn = np.interp(2.0 * np.pi, inputs[:, 0], found.values[:, 3])
    assert abs(turn) < 1e-3  # the rocker is back after one turn


def test_rows_of_a_batch_start_afresh() -> None:
    linkage = vc.load("example:five-bar")
    closing = LaneClosing.prepare(linkage, "motors")
    row = np.linspace([0.0, 0.0], [-0.3, -0.2], 9)
    rows = closing.run(np.concatenate([row, row]), linkage.home, 9)
    assert np.array_equal(rows.values[:9], rows.values[9:])
    each = closing.run_each(row, np.tile(linkage.home.flat, (9, 1)))
    assert each.closed.all()
    assert np.abs(each.values - rows.values[:9]).max() < 1e-12


def test_numbers_that_are_none_do_not_close_and_spoil_nothing() -> None:
    linkage = vc.load("example:five-bar")
    closing = LaneClosing.prepare(linkage, "motors")
    inputs = np.linspace([0.0, 0.0], [-0.3, -0.2], 9)
    spoiled = inputs.copy()
    spoiled[4] = np.nan
    found = closing.run(spoiled, linkage.home, 9)
    assert found.closed.tolist() == [True] * 4 + [False] + [True] * 4
    assert np.abs(found.values[5:] - closing.run(inputs, linkage.home, 9).values[5:]).max() < 1e-12
