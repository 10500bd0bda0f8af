"""What is zero: cutoffs and their parts, doubt, monotony, and the proof of full rank."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vincula.labels import Uncertainty
from vincula.model import LinearModel
from vincula.numerics.ledger import MATRIX_NAMES, RankLedger
from vincula.numerics.rank import EPS, decide_rank, negligible


def with_values(*values: float) -> np.ndarray:
    """A 6 x n matrix with these singular values."""
    rng = np.random.default_rng(len(values))
    left = np.linalg.qr(rng.standard_normal((6, 6)))[0][:, : len(values)]
    right = np.linalg.qr(rng.standard_normal((len(values), len(values))))[0]
    return left * values @ right


def test_regular_matrix_is_certain() -> None:
    decision = decide_rank(with_values(3.0, 1.0, 1e-3))
    assert (decision.rank, decision.status, decision.deciding) == (3, "certain", "rounding")
    assert decision.kept == pytest.approx(1e-3, rel=1e-9)
    assert decision.dropped == 0.0
    assert decision.gap == float("inf")


def test_rounding_alone_is_zero_and_certain() -> None:
    matrix = with_values(3.0, 1.0)
    decision = decide_rank(np.hstack([matrix, matrix @ np.array([[0.3], [0.7]])]))
    assert (decision.rank_min, decision.rank, decision.rank_max) == (2, 2, 2)
    assert decision.cutoff == pytest.approx(decision.singular_values[0] * 10 * 6 * EPS)


@pytest.mark.parametrize(
    ("smallest", "ranks"),
    [(1e-6, (2, 2, 3)), (0.5e-5, (2, 2, 3)), (5e-5, (2, 3, 3)), (5e-4, (3, 3, 3)), (1e-17, (2, 2, 2))],
)
def test_interval_of_rank_follows_the_margins(smallest: float, ranks: tuple[int, int, int]) -> None:
    decision = decide_rank(with_values(1.0, 0.5, smallest), uncertainty={"digits": 1e-5})
    assert (decision.rank_min, decision.rank, decision.rank_max) == ranks
    assert decision.deciding == "digits"
    assert decision.status == ("certain" if ranks[0] == ranks[2] else "doubtful")
    assert len(decision.doubtful_values) == ranks[2] - ranks[0]


def test_empty_and_zero_matrices_have_rank_zero() -> None:
    for shape in ((0, 3), (3, 0), (0, 0), (4, 2)):
        decision = decide_rank(np.zeros(shape))
        assert (decision.rank, decision.status) == (0, "certain")
        assert decision.kept == float("inf")


def test_a_block_of_rounding_error_has_rank_zero_in_the_scale_of_its_model() -> None:
    noise = 1e-17 * np.ones((3, 1))
    assert decide_rank(noise).rank == 1
    assert decide_rank(noise, scale=1.0).rank == 0


def test_negligible_is_relative() -> None:
    assert negligible(1e-14, 1.0)
    assert not negligible(1e-14, 1e-3)
    assert negligible(1e-6, 1.0, doubt=1e-5)


def near_fold(offset: float, uncertainty: Uncertainty) -> LinearModel:
    """A slider-crank of equal bars, `offset` [rad] away from its dead point; the crank is passive."""
    jacobian = np.array([[np.sin(offset), 0.0], [np.cos(offset), 1.0]])
    model = LinearModel.from_matrices(jacobian, np.array([[1.0, 0.0]]), active=[], length=1.0)
    return replace(model, uncertainty=uncertainty)


def test_closure_residual_makes_a_small_singular_value_doubtful() -> None:
    near = near_fold(1.7e-8, Uncertainty(residual=1e-14)).ledger.decision("passive")
    assert near.status == "doubtful"
    assert near.deciding == "closure"
    exact = near_fold(1.7e-8, Uncertainty()).ledger.decision("passive")
    assert (exact.status, exact.rank) == ("certain", 2)
    far = near_fold(1e-2, Uncertainty(residual=1e-14)).ledger.decision("passive")
    assert (far.status, far.rank) == ("certain", 2)


def test_typed_digits_and_tolerance_are_relative_to_the_length() -> None:
    model = near_fold(1e-6, Uncertainty())
    jacobian, grasp = np.hstack([model.jacobian_active, model.jacobian_passive]), model.grasp
    large = LinearModel.from_matrices(jacobian, grasp, active=[], length=1024.0)
    typed = replace(large, uncertainty=Uncertainty(digits_length=1e-3))
    assert typed.ledger.uncertainty["digits"] == pytest.approx(1e-3 / 1024.0)
    angles = replace(large, uncertainty=Uncertainty(tolerance_angle=1e-3))
    assert angles.ledger.uncertainty["tolerance"] == 1e-3


@pytest.mark.parametrize("seed", range(40))
def test_the_proof_of_full_rank_agrees_with_singular_values(seed: int) -> None:
    """The same ranks whether or not singular values were computed first; the bound is a bound."""
    rng = np.random.default_rng(seed)
    n_a, n_p, d = (int(k) for k in rng.integers(0, 5, 3))
    m, d = int(rng.integers(1, 10)), d + 1
    jacobian = rng.standard_normal((m, n_a + n_p)) * 10.0 ** rng.uniform(-4, 0, n_a + n_p)
    grasp = rng.standard_normal((d, m))
    active = list(range(n_a))
    proved = LinearModel.from_matrices(jacobian, grasp, active=active)
    computed = LinearModel.from_matrices(jacobian, grasp, active=active)
    for name in MATRIX_NAMES:
        computed.ledger.decision(name)
    assert proved.ledger.summary == computed.ledger.summary
    assert proved.ledger.counts == computed.ledger.counts
    elimination = RankLedger(computed.scaled).elimination
    if elimination is not None:
        columns = np.hstack([computed.jacobian_passive, computed.jacobian_active, computed.grasp.T])
        values = np.linalg.svd(columns, compute_uv=False)
        bound = elimination.smallest_singular_value(slice(None))
        assert bound <= values[min(m, columns.shape[1]) - 1] * (1.0 + 1e-9) + 1e-15


def test_units_do_not_change_a_decision() -> None:
    """mm and m give the same scaled matrices to the last bit but for the rounding of the numbers."""
    rng = np.random.default_rng(3)
    metres = rng.integers(-512, 512, (6, 8)) / 256.0
    linear_rows, linear_columns = [True, True, False] * 2, [True, False] * 2 + [False]
    for power in (-10, -3, 4, 20):
        unit = 2.0**power
        scale_row = np.where(linear_rows, unit, 1.0)
        scale_column = np.where([*linear_columns, True, True, False], 1.0 / unit, 1.0)
        scaled = scale_row[:, None] * metres * scale_column
        models = [
            LinearModel.from_matrices(
                table[:, :5], table[:, 5:].T, active=[0, 1], linear_rows=linear_rows,
                linear_columns=linear_columns, length=length,
            )
            for table, length in ((metres, 1.0), (scaled, unit))
        ]  # fmt: skip
        first, second = (model.ledger.decision("all").singular_values for model in models)
        assert (first == second).all()
