"""Proofs about ranks: exact ranks of exact matrices, and enclosures of singular values of floating ones.

A rank can be proved from below with floating data: enough singular values are away from zero for every
matrix within the uncertainty.  From above it can be proved with exact data only.  Needs python-flint
(extra `exact`).  Source: numerics page, step 7.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.arrays import Matrix
from vincula.errors import MissingExtraError
from vincula.numerics.evidence import Certificate
from vincula.numerics.lapack import svd
from vincula.numerics.surds import MOST_ROOTS, NotExactError, Surd, primes_of

if TYPE_CHECKING:
    from vincula.numerics.exact_blocks import ExactMatrix

_DIGITS = 40
"""Decimal digits of the ball arithmetic."""


def exact_rank(matrix: ExactMatrix) -> int:
    """The rank of a matrix of exact numbers, over the reals.

    Over a field of degree D every entry acts on the field as a D x D rational matrix; the rational
    matrix of all these blocks has D times the rank.

    Raises:
        NotExactError: Its entries mix more square roots than are kept apart.
        MissingExtraError: python-flint is not installed.
    """
    if not matrix or not matrix[0]:
        return 0
    flint = _flint()
    basis = _basis(matrix)
    rows: list[list[int]] = []
    for row in matrix:
        block = [[_acting(entry, root, basis) for entry in row] for root in basis]
        rows += [_whole([part for parts in line for part in parts]) for line in block]
    return int(flint.fmpz_mat(rows).rank()) // len(basis)


def enclosed_singular_values(matrix: Matrix, uncertainty: float = 0.0) -> tuple[tuple[float, float], ...]:
    """Lower and upper bounds of the singular values of every matrix within an uncertainty.

    Bounds hold for every matrix whose difference from this one has spectral norm `uncertainty` at
    most, this one taken as exact doubles.  With the computed A ~ U S V^T: ball arithmetic bounds how
    far U and V are from orthogonal and how far U^T A V is from S; then Weyl's inequality.

    Args:
        matrix: m x n doubles.
        uncertainty: Bound on the spectral norm of the error of the matrix, same units.

    Raises:
        MissingExtraError: python-flint is not installed.
    """
    if 0 in matrix.shape:
        return ()
    flint = _flint()
    with _digits(flint):
        left, values, right = svd(matrix)
        u, v, a = _balls(flint, left), _balls(flint, right), _balls(flint, matrix)
        off_u = _norm(u.transpose() * u - _unit(flint, left.shape[1]))
        off_v = _norm(v.transpose() * v - _unit(flint, right.shape[1]))
        middle = _balls(flint, _diagonal(values, matrix.shape))
        off = _norm(u.transpose() * a * v - middle)
        # Singular values of U^T A V are those of A times factors in [sqrt(1 - off_u) ...] each side.
        low, high = (1 - off_u) * (1 - off_v), (1 + off_u) * (1 + off_v)
        result = []
        for value in values:
            below = _lower((_ball(flint, value) - off) / high.sqrt()) - uncertainty
            above = _upper((_ball(flint, value) + off) / low.sqrt()) + uncertainty
            result.append((max(0.0, math.nextafter(below, -math.inf)), math.nextafter(above, math.inf)))
    return tuple(result)


def certified_rank(matrix: Matrix, uncertainty: float = 0.0) -> Certificate:
    """What is proved about the rank of every matrix within an uncertainty of a floating one.

    Args:
        matrix: m x n doubles.
        uncertainty: Bound on the spectral norm of the error of the matrix, same units.

    Raises:
        MissingExtraError: python-flint is not installed.
    """
    enclosures = enclosed_singular_values(matrix, uncertainty)
    rank = sum(1 for low, _ in enclosures if low > 0.0)
    return Certificate(rank, False, enclosures)


def _flint() -> Any:
    try:
        import flint
    except ImportError:
        raise MissingExtraError("python-flint", "exact", "proving ranks") from None
    return flint


class _digits:  # noqa: N801  a context, used like a function
    """Sets the precision of balls for a while."""

    def __init__(self, flint: Any) -> None:
        self._context, self._before = flint.ctx, flint.ctx.dps

    def __enter__(self) -> None:
        self._context.dps = _DIGITS

    def __exit__(self, *_: object) -> None:
        self._context.dps = self._before


def _basis(matrix: ExactMatrix) -> list[int]:
    """Products of the primes below all roots: the square roots of these are a basis of the field."""
    primes = primes_of(term for row in matrix for entry in row for term in entry.terms)
    if len(primes) > MOST_ROOTS:
        raise NotExactError(f"the numbers mix the square roots of {len(primes)} primes")
    return [math.prod(chosen) for count in range(len(primes) + 1) for chosen in combinations(primes, count)]


def _acting(entry: Surd, root: int, basis: Sequence[int]) -> list[Any]:
    """Coordinates of entry x sqrt(root)."""
    from fractions import Fraction

    product = dict((entry * Surd(((root, Fraction(1)),))).terms)
    return [product.get(one, Fraction(0)) for one in basis]


def _whole(row: Sequence[Any]) -> list[int]:
    """A row of fractions times their common denominator."""
    common = math.lcm(*(part.denominator for part in row))
    return [int(part * common) for part in row]


def _ball(flint: Any, value: float) -> Any:
    numerator, denominator = float(value).as_integer_ratio()
    return flint.arb(numerator) / flint.arb(denominator)


def _balls(flint: Any, matrix: Matrix) -> Any:
    return flint.arb_mat([[_ball(flint, x) for x in row] for row in matrix.tolist()])


def _unit(flint: Any, size: int) -> Any:
    return _balls(flint, np.eye(size))


def _diagonal(values: Sequence[float] | Any, shape: tuple[int, ...]) -> Matrix:
    middle = np.zeros(shape)
    np.fill_diagonal(middle, values)
    return middle


def _norm(matrix: Any) -> Any:
    """Upper bound of the spectral norm: that of Frobenius."""
    total = sum((entry * entry for entry in matrix.entries()), start=matrix.entries()[0] * 0)
    return total.abs_upper().sqrt()


def _lower(ball: Any) -> float:
    return float(ball.mid()) - float(ball.rad()) - abs(float(ball.mid())) * 2.0**-52


def _upper(ball: Any) -> float:
    return float(ball.mid()) + float(ball.rad()) + abs(float(ball.mid())) * 2.0**-52
