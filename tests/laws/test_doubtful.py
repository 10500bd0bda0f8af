"""Whatever the uncertainties, an analysis answers: doubt and contradictions are said, never raised."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

from vincula.analysis.result import analyze
from vincula.errors import RankAmbiguityWarning
from vincula.labels import Uncertainty
from vincula.model import LinearModel
from vincula.weights import Weights

BLOCK = 60


def random_case(seed: int) -> tuple[LinearModel, Weights]:
    """Small matrices, often singular, with uncertainties up to their own size; weights of all kinds."""
    rng = np.random.default_rng(seed)
    m, n_a, n_p, d = (int(rng.integers(low, high)) for low, high in ((0, 7), (0, 4), (0, 4), (1, 7)))
    jacobian = rng.standard_normal((m, n_a + n_p)) * 10.0 ** rng.uniform(-3, 0, n_a + n_p)
    grasp = rng.standard_normal((d, m)) * 10.0 ** rng.uniform(-3, 0, (d, 1))
    if rng.random() < 0.5:
        jacobian, grasp = np.round(jacobian), np.round(grasp)
    model = LinearModel.from_matrices(jacobian, grasp, active=list(range(n_a)), length=1.0)
    known = Uncertainty(
        residual=float(10.0 ** rng.uniform(-12, 0)) if rng.random() < 0.7 else 0.0,
        digits_length=float(10.0 ** rng.uniform(-6, -0.5)) if rng.random() < 0.5 else 0.0,
    )
    twist, rate = 10.0 ** rng.uniform(-8, 8, d), 10.0 ** rng.uniform(-8, 8, n_a)
    weights = [
        Weights(),
        Weights(twist=twist * (rng.random(d) < 0.8), rate=rate, reciprocal=True),
        Weights(twist=twist, wrench=1.0 / twist, torque=rate),
    ][seed % 3]
    return replace(model, uncertainty=known), weights


@pytest.mark.parametrize("start", range(0, 480, BLOCK))
def test_every_case_has_an_answer(start: int) -> None:
    for seed in range(start, start + BLOCK):
        model, weights = random_case(seed)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RankAmbiguityWarning)
            result = analyze(model, weights)
            report = json.loads(json.dumps(result.to_dict(), allow_nan=False))
            assert str(result)
        assert bool(report["rank"]["contradictions"]) == bool(result.ledger.counts.contradictory)
        if result.ledger.counts.contradictory or result.ledger.doubtful:
            assert report["rank"]["status"] == "doubtful"
            assert report["warnings"]
