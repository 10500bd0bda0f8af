"""Exact numbers: sums of rational multiples of square roots, closed under + - * / .

They hold what people type: 0.1 as 1/10, sqrt(3)/2, cos(5*pi/12) = (sqrt(6) - sqrt(2))/4.  Three square
roots at most are mixed (a field of degree eight); whatever is beyond that is not exact, and said so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

MOST_ROOTS: Final = 3
"""Independent square roots in one number."""
_LONGEST: Final = 4000
"""Bits of a numerator or denominator."""
_LARGEST_RADICAND: Final = 10**10


class NotExactError(ArithmeticError):
    """A number that is no sum of few square roots, or too long to be kept exactly."""


@dataclass(frozen=True, slots=True)
class Surd:
    """sum of coefficient x sqrt(radicand), radicands square-free; no entry is zero.

    Attributes:
        terms: Coefficient by radicand.
    """

    terms: tuple[tuple[int, Fraction], ...] = ()

    @staticmethod
    def of(value: int | Fraction) -> Surd:
        """A rational number."""
        return _made({1: Fraction(value)})

    @staticmethod
    def decimal(text: str) -> Surd:
        """A decimal number as it is typed: `0.1` is 1/10.

        Raises:
            NotExactError: An exponent beyond all reason.
        """
        _, _, exponent = text.lower().partition("e")
        if exponent and abs(int(exponent)) > 300:
            raise NotExactError(f"{text} is too large or small")
        return Surd.of(Fraction(text))

    @staticmethod
    def cosine(twelfths: Fraction) -> Surd:
        """cos(twelfths x pi/12).

        Raises:
            NotExactError: Not a whole number of twelfths.
        """
        if twelfths.denominator != 1:
            raise NotExactError("cosines of multiples of pi/12 only are exact")
        count = int(twelfths) % 24
        count = min(count, 24 - count)
        sign, count = (1, count) if count <= 6 else (-1, 12 - count)
        return _made({root: sign * part for root, part in _COSINES[count].items()})

    def __add__(self, other: Surd) -> Surd:
        result = dict(self.terms)
        for root, part in other.terms:
            result[root] = result.get(root, Fraction(0)) + part
        return _made(result)

    def __neg__(self) -> Surd:
        return Surd(tuple((root, -part) for root, part in self.terms))

    def __sub__(self, other: Surd) -> Surd:
        return self + -other

    def __mul__(self, other: Surd) -> Surd:
        result: dict[int, Fraction] = {}
        for one, a in self.terms:
            for two, b in other.terms:
                shared = math.gcd(one, two)
                root = (one // shared) * (two // shared)
                result[root] = result.get(root, Fraction(0)) + a * b * shared
        return _made(result)

    def __truediv__(self, other: Surd) -> Surd:
        """The quotient; a ZeroDivisionError for zero."""
        top, bottom = self, other
        for prime in primes_of(other.terms):
            conjugate = Surd(tuple((r, -c if r % prime == 0 else c) for r, c in bottom.terms))
            top, bottom = top * conjugate, bottom * conjugate
        rational = dict(bottom.terms).get(1, Fraction(0))
        return top * Surd.of(1 / rational)

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __float__(self) -> float:
        return math.fsum(float(part) * math.sqrt(root) for root, part in self.terms)

    def root(self) -> Surd:
        """The square root of a rational number.

        Raises:
            NotExactError: The root of anything else, or of too large a number.
        """
        value = self.rational
        if value is None or value < 0:
            raise NotExactError("only square roots of positive rational numbers are exact")
        square, rest = _square_part(value.numerator * value.denominator)
        return _made({rest: Fraction(square, value.denominator)}) if value else Surd()

    @property
    def rational(self) -> Fraction | None:
        """Its value if it is rational."""
        if not self.terms:
            return Fraction(0)
        return self.terms[0][1] if len(self.terms) == 1 and self.terms[0][0] == 1 else None


def primes_of(terms: Iterable[tuple[int, Fraction]]) -> tuple[int, ...]:
    """The primes below the roots, in order."""
    found: set[int] = set()
    for root, _ in terms:
        left, prime = root, 2
        while prime * prime <= left:
            if left % prime == 0:
                found.add(prime)
                left //= prime
            else:
                prime += 1
        if left > 1:
            found.add(left)
    return tuple(sorted(found))


def _made(terms: Mapping[int, Fraction]) -> Surd:
    kept = tuple(sorted((root, part) for root, part in terms.items() if part))
    if any(max(p.numerator.bit_length(), p.denominator.bit_length()) > _LONGEST for _, p in kept):
        raise NotExactError("too many digits")
    if len(kept) > 2**MOST_ROOTS:
        raise NotExactError(f"more than {MOST_ROOTS} different square roots")
    return Surd(kept)


def _square_part(number: int) -> tuple[int, int]:
    """s and r with number = s^2 r, r square-free."""
    if number > _LARGEST_RADICAND:
        exact = math.isqrt(number)
        if exact * exact == number:
            return exact, 1
        raise NotExactError("the square root of too large a number")
    square, rest, factor = 1, number, 2
    while factor * factor <= rest:
        while rest % (factor * factor) == 0:
            rest //= factor * factor
            square *= factor
        factor += 1
    return square, rest


_COSINES: Final[dict[int, dict[int, Fraction]]] = {
    0: {1: Fraction(1)},
    1: {6: Fraction(1, 4), 2: Fraction(1, 4)},
    2: {3: Fraction(1, 2)},
    3: {2: Fraction(1, 2)},
    4: {1: Fraction(1, 2)},
    5: {6: Fraction(1, 4), 2: Fraction(-1, 4)},
    6: {},
}
"""cos(k pi/12)."""
ZERO: Final = Surd()
ONE: Final = Surd.of(1)


@dataclass(frozen=True, slots=True)
class WithPi:
    """An exact number a + b pi, for angles.

    Attributes:
        plain: a.
        turns: b.
    """

    plain: Surd = ZERO
    turns: Surd = ZERO

    def __add__(self, other: WithPi) -> WithPi:
        return WithPi(self.plain + other.plain, self.turns + other.turns)

    def __neg__(self) -> WithPi:
        return WithPi(-self.plain, -self.turns)

    def __mul__(self, other: WithPi) -> WithPi:
        if self.turns and other.turns:
            raise NotExactError("pi squared")
        return WithPi(self.plain * other.plain, self.plain * other.turns + self.turns * other.plain)

    def __truediv__(self, other: WithPi) -> WithPi:
        if other.turns:
            raise NotExactError("division by pi")
        return WithPi(self.plain / other.plain, self.turns / other.plain)

    @property
    def number(self) -> Surd:
        """Its value, if pi is not in it.

        Raises:
            NotExactError: It is.
        """
        if self.turns:
            raise NotExactError("a multiple of pi")
        return self.plain

    @property
    def cosine(self) -> Surd:
        """Its cosine, for multiples of pi/12.

        Raises:
            NotExactError: It is no such multiple.
        """
        part = self.turns.rational
        if self.plain or part is None:
            raise NotExactError("cosines of multiples of pi/12 only are exact")
        return Surd.cosine(12 * part)


PI: Final = WithPi(turns=ONE)
QUARTER: Final = WithPi(turns=Surd.of(Fraction(1, 2)))
"""pi/2, a quarter of a turn."""


class ExactFloat(float):
    """A float that knows which number it is the rounding of.

    Attributes:
        exact: That number; None where it is not known exactly.
    """

    exact: Surd | None

    def __new__(cls, value: float, exact: Surd | None) -> ExactFloat:
        """The float, with the number that it stands for."""
        result = super().__new__(cls, value)
        result.exact = exact
        return result


def exactly(value: float) -> Surd:
    """The number that a typed float stands for: the shortest decimal that gives it, up to 15 digits.

    Raises:
        NotExactError: It has more digits, so it is itself the rounding of something.
    """
    if isinstance(value, ExactFloat):
        if value.exact is None:
            raise NotExactError(f"{float(value)!r} is not known exactly")
        return value.exact
    text = repr(float(value))
    if not math.isfinite(value):
        raise NotExactError(f"{text} is no number")
    if len(text.partition("e")[0].replace("-", "").replace(".", "").strip("0")) > MOST_DIGITS:
        raise NotExactError(f"{text} is a rounded number")
    return Surd.decimal(text)


MOST_DIGITS: Final = 15
"""Decimal digits that every double keeps: with more it may be the rounding of another number."""
