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
