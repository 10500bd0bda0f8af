"""Signed measures of branches over a batch: what the branch of every configuration says, as numbers."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.mechanism.branches import branch_of
from vincula.mechanism.catalog import examples

BOTH = ("branch.assembly", "branch.working")


def _random(mechanism: vc.Mechanism, count: int) -> np.ndarray:
    """Closed configurations around home, some of them far away."""
    rng = np.random.default_rng(7)
    rows = []
    for k in range(count):
        near = mechanism.home.from_flat(
            mechanism.home.flat + rng.normal(0.0, 0.3 + 0.2 * (k % 4), len(mechanism.home.flat))
        )
        try:
            rows.append(mechanism.close(near, attempts=2).flat)
        except vc.ClosureError:
            continue
    return np.array(rows)


def _signs(values: np.ndarray) -> str:
    return "".join("?" if np.isnan(v) else "0" if v == 0.0 else "+" if v > 0.0 else "-" for v in values)


@pytest.mark.parametrize("name", [entry.name for entry in examples()])
def test_signs_are_those_of_the_branch(name: str) -> None:
    mechanism = vc.load(f"example:{name}")
    compiled = vc.compile(mechanism)
    rows = np.vstack([mechanism.home.flat, _random(mechanism, 6)])
    found = compiled.evaluate(rows, BOTH, path="reference")
    for k, flat in enumerate(rows):
        named = branch_of(mechanism, mechanism.home.from_flat(flat))
        assert _signs(found["branch.assembly"][k]) == named.assembly
        assert _signs(found["branch.working"][k]) == named.working
    assert (found["branch.working"][0] > 0.0).all(), "home is on its own branch"


def test_groups_have_names() -> None:
    """Legs by their motors, the platform by its name."""
    known = vc.compile(vc.load("example:3rrr")).quantities
    assert known["branch.working"].labels == (("a1", "a2", "a3"),)
    assert known["branch.assembly"].labels == (("platform",),)
    assert known["branch.assembly"].dims == ("assembly group",)


def test_a_measure_goes_straight_through_zero() -> None:
    """Along a path through a singularity the smallest singular value has a corner, the measure has none."""
    linkage = vc.load("example:five-bar")
    compiled = vc.compile(linkage)
    path = linkage.follow([{"o1": 0.0, "o5": -1.5}], samples=30, through=["motors without authority"])
    rows = np.array([point.configuration.flat for point in path.points])
    leg = compiled.evaluate(rows, BOTH)["branch.working"][:, 1]
    assert leg[0] > 0.05
    assert leg[-1] < -0.05
    assert np.abs(np.diff(leg, 2)).max() < 0.1 * np.abs(np.diff(leg)).max()


@pytest.mark.parametrize("name", ["five-bar", "3rrr", "delta", "mixed", "stewart-spherical"])
def test_lanes_are_the_reference_path(name: str) -> None:
    """Square groups, groups with more rows than rank and with idle joints; any batch size and threads."""
    pytest.importorskip("numba", reason="extra fast")
    mechanism = vc.load(f"example:{name}")
    compiled = vc.compile(mechanism)
    rows = np.vstack([mechanism.home.flat, _random(mechanism, 8)])
    lanes = compiled.evaluate(rows, BOTH, path="lanes")
    reference = compiled.evaluate(rows, BOTH, path="reference")
    assert lanes.status.tolist() == reference.status.tolist()
    many = compiled.evaluate(np.tile(rows, (40, 1)), BOTH, path="lanes", threads=2)
    for quantity in BOTH:
        np.testing.assert_allclose(lanes[quantity], reference[quantity], rtol=0.0, atol=1e-10)
        assert many[quantity].tobytes() == np.tile(lanes[quantity], (40, 1)).tobytes()
        alone = np.array([compiled.at(row, BOTH)[quantity] for row in rows])
        assert alone.tobytes() == lanes[quantity].tobytes()


def test_designs_have_their_own_homes() -> None:
    """Every design is compared with its own home, where it is on its own branch."""
    compiled = vc.compile(vc.builder("example:stewart"))
    found = compiled.evaluate(None, BOTH, parameters={"alpha": np.radians([1.0, 20.0])})
    for quantity in BOTH:
        assert (found[quantity] > 0.0).all()
