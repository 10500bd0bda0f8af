"""Proofs about ranks: against planted ranks, against eighty digits, and never more than is true."""

from __future__ import annotations

import builtins
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from vincula.errors import MissingExtraError
from vincula.numerics.certify import certified_rank, enclosed_singular_values, exact_rank
from vincula.numerics.exact_blocks import ExactBlocks
from vincula.numerics.ledger import MATRIX_NAMES
from vincula.numerics.surds import NotExactError, Surd

pytest.importorskip("flint")


def times(one: list[list[Surd]], two: list[list[Surd]]) -> list[list[Surd]]:
    result = []
    for row in one:
        line = []
        for column in zip(*two, strict=True):
            total = Surd()
            for a, b in zip(row, column, strict=True):
                total = total + a * b
            line.append(total)
        result.append(line)
    return result


@pytest.mark.parametrize("seed", range(12))
def test_planted_ranks_over_a_field_of_degree_four(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, n = (int(k) for k in rng.integers(2, 7, 2))
    rank = int(rng.integers(0, min(m, n) + 1))
    roots = [Surd.of(1), Surd.of(2).root(), Surd.of(3).root(), Surd.of(6).root()]

    def block(rows: int, columns: int) -> list[list[Surd]]:
        return [
            [
                roots[int(rng.integers(4))] * Surd.of(Fraction(int(rng.integers(-50, 51)), 7))
                for _ in range(columns)
            ]
            for _ in range(rows)
        ]

    matrix = times(block(m, rank), block(rank, n)) if rank else [[Surd()] * n for _ in range(m)]
    found = exact_rank(matrix)
    floats = np.array([[float(x) for x in row] for row in matrix]).reshape(m, n)
    assert found == np.linalg.matrix_rank(floats, tol=1e-9)
    assert found <= rank


def test_one_part_in_a_googol_counts() -> None:
    tiny = Fraction(1, 10**100)
    root = Surd.of(2).root()
    singular = [[root, Surd.of(2)], [Surd.of(1), root]]
    regular = [[root, Surd.of(2)], [Surd.of(1), root + Surd.of(tiny)]]
    assert exact_rank(singular) == 1
    assert exact_rank(regular) == 2


def test_too_many_roots_are_refused() -> None:
    matrix = [[Surd.of(k).root() for k in (2, 3, 5, 7)]]
    with pytest.raises(NotExactError):
        exact_rank(matrix)


@pytest.mark.parametrize("seed", range(10))
def test_enclosures_hold_the_true_values(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, n = (int(k) for k in rng.integers(1, 7, 2))
    matrix = rng.standard_normal((m, n)) * 10.0 ** rng.uniform(-9, 3, n)
    bounds = enclosed_singular_values(matrix)
    with mpmath.workdps(80):
        exact = mpmath.matrix([[mpmath.mpf(float(x)) for x in row] for row in matrix])
        gram = exact * exact.T if m <= n else exact.T * exact
        true = sorted((mpmath.sqrt(abs(x)) for x in mpmath.eigsy(gram, eigvals_only=True)), reverse=True)
        for (low, high), sigma in zip(bounds, true, strict=True):
            assert low <= sigma <= high
            assert high - low <= 1e-13 * bounds[0][1]


def test_a_bound_is_proved_for_every_matrix_within_the_uncertainty() -> None:
    rng = np.random.default_rng(3)
    matrix = np.diag([1.0, 1e-3, 1e-9])
    assert certified_rank(matrix).rank == 3
    assert certified_rank(matrix, 1e-8).rank == 2
    for _ in range(50):
        off = rng.standard_normal((3, 3))
        near = matrix + 1e-8 * off / np.linalg.norm(off, 2)
        bounds = enclosed_singular_values(matrix, 1e-8)
        for (low, high), sigma in zip(bounds, np.linalg.svd(near)[1], strict=True):
            assert low <= sigma <= high
    assert not certified_rank(matrix).exact


def test_rounding_errors_are_never_proved_to_be_rank() -> None:
    rng = np.random.default_rng(5)
    matrix = rng.standard_normal((8, 3)) @ rng.standard_normal((3, 9))
    assert certified_rank(matrix, 1e-13).rank == 3
    assert exact_rank([]) == 0


def test_blocks_of_doubles_have_the_ranks_of_their_matrices() -> None:
    rng = np.random.default_rng(7)
    a, p, o = (rng.integers(-3, 4, (5, k)).astype(float) for k in (2, 3, 3))
    blocks = ExactBlocks.of_doubles(a, p, o)
    zero = np.zeros
    stacks = {
        "active": a, "passive": p, "member": o, "active+passive": np.hstack([a, p]),
        "active+member": np.hstack([a, o]), "passive+member": np.hstack([p, o]), "all": np.hstack([a, p, o]),
        "triple": np.block([[a, p, zero(o.shape)], [a, zero(p.shape), o]]),
    }  # fmt: skip
    for name in MATRIX_NAMES:
        assert exact_rank(blocks.matrix(name)) == np.linalg.matrix_rank(stacks[name])


def test_without_flint_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def refuse(name: str, *rest: object, **more: object) -> object:
        if name == "flint":
            raise ImportError(name)
        return real(name, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(MissingExtraError, match=r"vincula\[exact\]"):
        certified_rank(np.eye(2))
