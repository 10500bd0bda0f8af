"""Exact ranks of drawn mechanisms: the same as by margins where those are certain, and beyond them."""

from __future__ import annotations

import warnings
from math import sqrt
from pathlib import Path

import pytest
from tests.files import rounded

import vincula as vc
from vincula.errors import RankAmbiguityWarning
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.exact import exact_blocks
from vincula.numerics.certify import exact_rank
from vincula.numerics.ledger import MATRIX_NAMES
from vincula.numerics.surds import NotExactError

pytest.importorskip("flint")

MANY_JOINTS = """vincula: 1
space: spatial
joints:
  - {name: u, type: universal, bodies: [ground, a], at: [0, 0, 0], axes: [[1, 0, 0], [0, 1, 0]]}
  - {name: p, type: prismatic, bodies: [a, b], axis: [0.3, 0.4, 1.2]}
  - {name: s, type: spherical, bodies: [b, top], at: [0.3, 0.4, 1.2]}
  - {name: c, type: cylindrical, bodies: [ground, d], at: [1, 0, 0], axis: [0, 0, sqrt(3)]}
  - {name: r, type: revolute, bodies: [d, top], at: [1, 0, "cos(pi/12)"], axis: [1, 1, 0]}
contacts:
  - {name: k, type: line, bodies: [ground, top], at: [0.5, 0.5, 1], normal: [0, 0, 1], line: [1, 0, 0]}
  - {name: f, type: soft-finger, bodies: [ground, top], at: [0.2, 0.1, 1], normal: [0, 1, 1]}
reference: {body: top}
motors: [u.1, p, c.rotation]
"""


def exact_ranks(mechanism: vc.Mechanism) -> list[int]:
    blocks = exact_blocks(mechanism, mechanism.home)
    return [exact_rank(blocks.matrix(name)) for name in MATRIX_NAMES]


@pytest.mark.parametrize(
    "name", ["five-bar", "four-bar-2a", "serial-2r", "serial-7r", "telescope", "two-finger-grasp", "mixed"]
)
def test_the_catalog(name: str) -> None:
    mechanism = example(name)
    ledger = mechanism.linearize().ledger
    assert exact_ranks(mechanism) == [ledger.rank(one) for one in MATRIX_NAMES]


def test_every_kind_of_joint_and_row(tmp_path: Path) -> None:
    path = tmp_path / "many.yaml"
    path.write_text(MANY_JOINTS)
    for member in ("top", "a", "b", "d"):
        mechanism = vc.load(path).with_reference(member)
        ledger = mechanism.linearize().ledger
        assert exact_ranks(mechanism) == [ledger.rank(one) for one in MATRIX_NAMES]


def test_inches_and_millimetres_are_exact(tmp_path: Path) -> None:
    for unit in ("in", "mm"):
        path = tmp_path / f"{unit}.yaml"
        path.write_text(MANY_JOINTS.replace("space:", f"units: {{length: {unit}}}\nspace:"))
        mechanism = vc.load(path)
        ledger = mechanism.linearize().ledger
        assert exact_ranks(mechanism) == [ledger.rank(one) for one in MATRIX_NAMES]


def parallelogram(height: str) -> vc.Mechanism:
    """A four-bar at its change point but for the height of one joint."""
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(0, 0)),
            vc.Revolute("o2", "crank", "coupler", at=(1, float(height))),
            vc.Revolute("o3", "coupler", "rocker", at=(3, float(height))),
            vc.Revolute("o4", "rocker", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("coupler"),
        active=["o1"],
    )


def test_exact_numbers_decide_what_margins_cannot() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RankAmbiguityWarning)
        doubtful = vc.analyze(parallelogram("1e-14").linearize(), vc.Weights())
        proved = vc.analyze(parallelogram("1e-14").linearize(), vc.Weights(), exact=True)
        invisible = vc.analyze(parallelogram("1e-200").linearize(), vc.Weights(), exact=True)
        singular = vc.analyze(parallelogram("0").linearize(), vc.Weights(), exact=True)
    assert doubtful.ledger.status == "doubtful"
    assert proved.ledger.status == invisible.ledger.status == singular.ledger.status == "exact"
    assert proved.ledger.summary.mobility == invisible.ledger.summary.mobility == 1
    assert singular.ledger.summary.mobility == 2
    assert any("is exactly" in text for text in invisible.warnings)
    assert not singular.warnings


@pytest.mark.parametrize(("case", "typed"), [("native-0.000001", 0), ("inclined-0.866", 0)])
def test_as_typed_and_as_meant(tmp_path: Path, case: str, typed: int) -> None:
    path = rounded.write(tmp_path, case)
    for snap, mobility in ((False, typed), (True, 1)):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = vc.analyze(vc.load(path, snap=snap).linearize(), vc.Weights(), exact=True)
        assert found.ledger.status == "exact"
        assert found.ledger.summary.mobility == mobility


def test_what_is_not_exact_is_not_claimed_to_be() -> None:
    triangle = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "link", at=(0, 0)),
            vc.Revolute("b", "link", "tip", at=(0.5, sqrt(3) / 2)),
        ],
        reference=vc.Reference("tip", origin=(1, 1)),
        active=["a", "b"],
    )
    with pytest.raises(NotExactError, match="rounded number"):
        exact_blocks(triangle, triangle.home)
    found = vc.analyze(triangle.linearize(), vc.Weights(), exact=True)
    assert found.ledger.status == "certified_lower"
    assert "from below only" in found.to_dict()["rank"]["basis"]
    moved = parallelogram("0.5")
    with pytest.raises(NotExactError, match="not where it was drawn"):
        exact_blocks(moved, moved.configuration({"o1": 0.1}))
