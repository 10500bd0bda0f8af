"""Verdicts name joints and bodies; blocks have meanings and residuals; doubt is said aloud."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from vincula.analysis.diagnosis import verdicts
from vincula.analysis.localise import localised
from vincula.analysis.mobility import motion_blocks
from vincula.analysis.result import analyze
from vincula.analysis.wording import motion_of_body
from vincula.errors import RankAmbiguityWarning
from vincula.labels import Uncertainty
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.model import LinearModel
from vincula.numerics.subspaces import projector_distance
from vincula.weights import Weights


def test_six_legs_spin_one_by_one() -> None:
    said = [v for v in verdicts(example("stewart-spherical").linearize()) if "freely" in v]
    assert len(said) == 6
    for leg, verdict in enumerate(said, start=1):
        assert f"cylinder{leg}, rod{leg} can turn freely about the axis through" in verdict
        assert f"joints b{leg}, s{leg} (" in verdict


def test_spin_axes_are_the_legs() -> None:
    model = example("stewart-spherical").linearize()
    assert model.motions is not None
    basis = localised(model.ledger.subspaces.kernel("passive"))
    for column in (model.scaled.passive_column[:, None] * basis).T:
        rates = np.concatenate([np.zeros(6), column])
        twists = model.motions.twists(rates, np.zeros(6))
        moving = np.flatnonzero(np.linalg.norm(twists, axis=0) > 1e-9)
        assert len(moving) == 2
        v, omega = twists[:3, moving[0]], twists[3:, moving[0]]
        assert v @ omega == pytest.approx(0.0, abs=1e-12)  # a rotation, not a screw


def test_where_the_stewart_platform_is_singular_it_says_how_it_moves() -> None:
    said = verdicts(example("stewart", alpha="10deg", beta="10deg").linearize())
    assert said[0] == "6 independent motions in all (mobility 6)."
    free = [v for v in said if "moves with all motors locked" in v]
    assert len(free) == 3
    assert all("it can" in v and "joints" in v for v in free)
    assert any("work against each other in 3 ways" in v for v in said)


def test_redundancy_names_motors_and_the_passive_joints_that_follow() -> None:
    said = verdicts(example("telescope").linearize())
    assert any("(redundancy): joint driven, together with passive joint slack." in v for v in said)
    assert any("translate along (1, 0) (direction vx 1); joint slack." in v for v in said)


@pytest.mark.parametrize("name", MODULES)
def test_every_example_says_something_and_its_blocks_are_motions(name: str) -> None:
    result = analyze(example(name).linearize(), Weights())
    assert all(verdict.endswith(".") for verdict in result.verdicts)
    counts = result.ledger.counts
    assert sum(block.count for block in result.motions) == counts.nullity
    assert sum(block.count for block in result.forces) == len(result.model.rows) - result.ledger.rank(
        "passive"
    )
    for block in (*result.motions, *result.forces):
        assert block.meaning
        assert block.residual < 1e-13
    assert result.ledger.status == "certain"


def test_the_telescope_shows_its_three_ranges_where_the_theory_says() -> None:
    blocks = motion_blocks(example("telescope").linearize())
    counts = {block.name: block.count for block in blocks if block.count}
    assert counts == {"indeterminate_with_passive": 1, "object_locked": 1}


def test_localised_bases_span_the_same_and_are_sparse(rng: np.random.Generator) -> None:
    parts = np.zeros((9, 3))
    for k in range(3):
        parts[3 * k : 3 * k + 3, k] = rng.standard_normal(3)
    mixed = np.linalg.qr(parts @ (rng.standard_normal((3, 3)) + 2 * np.eye(3)))[0]
    simple = localised(mixed)
    assert projector_distance(np.linalg.qr(simple)[0], mixed) < 1e-14
    assert (np.count_nonzero(simple, axis=0) == 3).all()
    assert np.abs(simple).max(axis=0) == pytest.approx(1.0)


MOTIONS = [
    ([1.0, 2.0, 0.0], (0.0, 0.0), ("translate", "along (0.4472, 0.8944)")),
    ([0.0, 1.0, 1.0], (1.0, 0.0), ("turn", "about the point (0, 0)")),
    ([0.0, 0, 0, 0, 0, -2.0], (1.0, 2.0, 3.0), ("turn", "about the axis through (1, 2, 3) along (0, 0, 1)")),
    (
        [0.0, 3.0, 0, 0, 0, 1.0],
        (1.0, 0.0, 0.0),
        ("turn", "about the axis through (-2, 0, 0) along (0, 0, 1)"),
    ),
    (
        [0.0, 0.0, 0.5, 0, 0, 2.0],
        (0.0, 0.0, 0.0),
        ("screw", "about the axis through (0, 0, 0) along (0, 0, 1), 0.25 m per rad"),
    ),
    ([0.0, 0.0, -3.0, 0, 0, 0], (0.0, 0.0, 0.0), ("translate", "along (0, 0, 1)")),
]


@pytest.mark.parametrize(("twist", "origin", "expected"), MOTIONS)
def test_motions_in_words(twist: list[float], origin: tuple[float, ...], expected: tuple[str, str]) -> None:
    d = len(twist)
    model = LinearModel.from_matrices(np.zeros((1, 1)), np.zeros((d, 1)), active=[0], length=1.0)
    assert motion_of_body(model, np.array(twist), np.array(origin)) == expected


def doubtful(residual: float) -> LinearModel:
    """The straight two-bar linkage, 1.7e-8 rad from its dead point, closed to a residual."""
    offset = 1.7e-8
    jacobian = np.array([[np.sin(offset), 0.0], [np.cos(offset), 1.0]])
    model = LinearModel.from_matrices(
        jacobian, np.array([[1.0, 0.0]]), active=[], columns=["crank", "rod"], length=1.0, name="two-bar"
    )
    return replace(model, uncertainty=Uncertainty(residual=residual), reference="slider")


def test_doubt_is_said_in_words_with_both_consequences() -> None:
    with pytest.warns(RankAmbiguityWarning) as caught:
        result = analyze(doubtful(1e-14), Weights())
    text = next(str(w.message) for w in caught if "passive constraints" in str(w.message))
    assert "is 1 or 2: not decided" in text
    assert "1.2e-08 is above rounding" in text
    assert "loop closure to 1e-14 m can tell from zero" in text
    assert (
        "If 1: passive joints can move with motors and member at rest (shares: crank 0.50, rod 0.50)" in text
    )
    assert "If 2: they cannot" in text
    assert "To decide: close the loops more tightly, or --assume-singular." in text
    assert result.ledger.status == "doubtful"
    assert text in result.warnings
    report = result.to_dict()["rank"]
    assert report["status"] == "doubtful"
    zero, none = report["scenarios"]["all_doubtful_zero"], report["scenarios"]["none_zero"]
    assert zero["passive_redundancy"] == 1
    assert none["passive_redundancy"] == 0


def test_no_doubt_without_a_reason() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert analyze(doubtful(0.0), Weights()).ledger.status == "certain"
