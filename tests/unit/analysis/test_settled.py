"""Doubt settled by assumption, by proof, or by another reading; what the result then says."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

import vincula as vc
from vincula.errors import RankAmbiguityWarning
from vincula.labels import Uncertainty
from vincula.numerics.evidence import Evidence, Reading


def bare(smallest: float, residual: float = 0.0) -> vc.LinearModel:
    """Two passive joints whose second singular value is small; one motor, three constraints."""
    jacobian = np.array([[1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, smallest]])
    model = vc.LinearModel.from_matrices(jacobian, np.eye(3)[:1], active=[0], length=1.0)
    return replace(model, uncertainty=Uncertainty(residual=residual))


def analysed(model: vc.LinearModel, **options: bool) -> vc.Analysis:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return vc.analyze(model, vc.Weights(), **options)


def test_assumed_singular_takes_doubtful_values_as_zero_and_says_so() -> None:
    model = bare(1e-9, residual=1e-12)
    open_ = analysed(model)
    assert open_.ledger.status == "doubtful"
    low, high = open_.ledger.scenarios
    assert low.mobility == high.mobility + 1
    with pytest.warns(RankAmbiguityWarning, match="assumed to be zero"):
        settled = vc.analyze(model, vc.Weights(), assume_singular=True)
    assert settled.ledger.status == "assumed"
    assert settled.ledger.summary == low
    rank = json.loads(json.dumps(settled.to_dict()))["rank"]
    assert rank["status"] == "assumed"
    assert rank["assumed_singular"] is True
    assert any("assumed to be zero" in text for text in rank["messages"])
    assert rank["scenarios"]["none_zero"]["mobility"] == high.mobility


def test_nothing_is_assumed_where_nothing_is_doubtful() -> None:
    found = analysed(bare(0.5), assume_singular=True)
    assert found.ledger.status == "certain"
    assert found.warnings == ()


def test_matrices_from_python_are_exact_as_given() -> None:
    pytest.importorskip("flint")
    for smallest, nullity in ((1e-17, 1), (1e-100, 1), (0.0, 2)):
        found = analysed(bare(smallest), exact=True)
        assert found.ledger.status == "exact"
        assert found.ledger.summary.mobility == nullity
    told = analysed(bare(1e-100), exact=True).to_dict()["rank"]
    assert told["basis"] == "the matrices as given, every double exact"
    assert any(decision["certificate"]["exact"] for decision in told["decisions"])


def test_floating_data_prove_ranks_from_below_only() -> None:
    pytest.importorskip("flint")
    model = replace(bare(0.5), exact=None)
    found = analysed(model, exact=True)
    assert found.ledger.status == "certified_lower"
    decisions = found.to_dict()["rank"]["decisions"]
    for decision in decisions:
        proved = decision["certificate"]
        assert not proved["exact"]
        for (low, high), value in zip(proved["enclosures"], decision["singular_values"], strict=True):
            assert low <= value <= high
    # What is in doubt stays in doubt: no proof from floating data says that something is zero.
    still = analysed(replace(bare(1e-9, residual=1e-12), exact=None), exact=True)
    assert still.ledger.status == "doubtful"


def test_another_reading_with_other_counts_makes_a_certain_result_doubtful() -> None:
    model = bare(0.5)
    other = analysed(bare(0.0)).ledger.summary
    reading = Reading(("1.57 means pi/2 (robot.urdf:8, joint 'o1', rpy)",), other)
    contested = analysed(replace(model, evidence=Evidence(reading=reading)))
    assert contested.ledger.status == "doubtful"
    message = next(text for text in contested.warnings if "as typed" in text)
    assert message.startswith("Mobility is 1 with the numbers as typed, 2")
    assert "1.57 means pi/2 (robot.urdf:8" in message
    assert "--snap" in message
    told = contested.to_dict()["rank"]["readings"]
    assert (told["typed"]["mobility"], told["meant"]["mobility"]) == (1, 2)
    same = Reading(("1.57 means pi/2",), analysed(model).ledger.summary)
    agreed = analysed(replace(model, evidence=Evidence(reading=same)))
    assert agreed.ledger.status == "certain"
    assert agreed.warnings == ()
