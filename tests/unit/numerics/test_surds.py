"""Exact numbers against mpmath at fifty digits."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath
import pytest

from vincula.numerics.surds import (
    PI,
    QUARTER,
    ExactFloat,
    NotExactError,
    Surd,
    WithPi,
    exactly,
)

TWO, THREE, FIVE, SEVEN = (Surd.of(k).root() for k in (2, 3, 5, 7))


def value(number: Surd) -> mpmath.mpf:
    with mpmath.workdps(50):
        return mpmath.fsum(
            mpmath.mpf(part.numerator) / part.denominator * mpmath.sqrt(root) for root, part in number.terms
        )


def some(rng: random.Random) -> Surd:
    total = Surd.of(Fraction(rng.randint(-9, 9), rng.randint(1, 9)))
    for root in (TWO, THREE, FIVE):
        total = total + Surd.of(Fraction(rng.randint(-9, 9), rng.randint(1, 9))) * root
    return total


def test_arithmetic() -> None:
    rng = random.Random(1)
    with mpmath.workdps(50):
        for _ in range(100):
            one, two = some(rng), some(rng)
            assert abs(value(one + two) - (value(one) + value(two))) < 1e-45
            assert abs(value(one - two) - (value(one) - value(two))) < 1e-45
            assert abs(value(one * two) - value(one) * value(two)) < 1e-42
            if two:
                assert one / two * two == one
                assert abs(value(one / two) - value(one) / value(two)) < 1e-35


@pytest.mark.parametrize("k", range(-30, 31))
def test_cosines(k: int) -> None:
    with mpmath.workdps(50):
        assert abs(value(Surd.cosine(Fraction(k))) - mpmath.cos(k * mpmath.pi / 12)) < 1e-45


def test_roots() -> None:
    assert Surd.of(Fraction(3, 4)).root() == Surd.of(Fraction(1, 2)) * THREE
    assert Surd.of(Fraction(50, 9)).root() == Surd.of(Fraction(5, 3)) * TWO
    assert Surd.of(0).root() == Surd()
    for refused in (Surd.of(-1), TWO, Surd.of(10**14 + 31)):
        with pytest.raises(NotExactError):
            refused.root()


def test_what_is_typed() -> None:
    assert exactly(0.1).rational == Fraction(1, 10)
    assert exactly(-1.5e-3).rational == Fraction(-3, 2000)
    assert exactly(ExactFloat(0.8660254037844386, Surd.of(Fraction(1, 2)) * THREE)).rational is None
    # Seventeen digits are the rounding of something else, and nobody knows of what.
    for refused in (0.1 + 0.2, 2.0**0.5, float("inf"), ExactFloat(1.0, None)):
        with pytest.raises(NotExactError):
            exactly(refused)


def test_angles() -> None:
    third = PI / WithPi(Surd.of(3))
    assert third.cosine == Surd.of(Fraction(1, 2))
    assert (QUARTER + -third).cosine == Surd.of(Fraction(1, 2)) * THREE
    with pytest.raises(NotExactError):
        _ = WithPi(Surd.of(1)).cosine
    with pytest.raises(NotExactError):
        _ = PI.number


def test_too_many_roots() -> None:
    product = (Surd.of(1) + TWO) * (Surd.of(1) + THREE) * (Surd.of(1) + FIVE)
    with pytest.raises(NotExactError):
        _ = product * (Surd.of(1) + SEVEN)
