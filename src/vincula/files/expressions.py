"""Numbers written as expressions: `$l/2`, `2*pi/3`, `$r*cos($alpha)`.

A small grammar with its own reader; nothing is ever given to Python to evaluate:

    sum     = product {("+" | "-") product}
    product = signed {("*" | "/") signed}
    signed  = {"+" | "-"} atom
    atom    = number | "pi" | "$" name | function "(" sum ")" | "(" sum ")"

Every value carries how far it may be off because of typed digits, to first order, and where it can the
exact number that it stands for.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, NoReturn

from vincula.elementary import cos, is_finite, sin, sqrt, tan
from vincula.errors import ModelError, listing
from vincula.files.digits import half_unit
from vincula.files.problems import shown, suggestion
from vincula.files.traced_digits import doubt_of_angle
from vincula.files.tree import number
from vincula.numerics.surds import PI, QUARTER, NotExactError, WithPi, exactly

_LONGEST: Final = 1000
_DEEPEST: Final = 64
_TOKEN: Final = re.compile(
    r"\s*(?:(?P<number>[0-9.][0-9.]*(?:[eE][-+]?[0-9]+)?)|(?P<parameter>\$[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<word>[A-Za-z_][A-Za-z0-9_]*)|(?P<sign>[-+*/()]))"
)
FUNCTIONS: Final = ("sin", "cos", "tan", "sqrt")
"""Names of the functions in expressions; angles in radians."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A number and how far it may be off.

    Attributes:
        value: The number.
        half_unit: Half a unit of its last typed digit, carried through expressions; 0 when exact.
        angular_half_unit: The same of a plain number that is an angle or a component of a direction.
        exact: The number that an expression stands for; None where it is not known exactly.
        computed: Whether it is the value of an expression, not a number as it was typed.
    """

    value: float
    half_unit: float = 0.0
    angular_half_unit: float = 0.0
    exact: WithPi | None = field(default=None, compare=False)
    computed: bool = field(default=False, compare=False)


def exact_number(measured: Measured) -> WithPi:
    """The number that a typed number or an expression stands for.

    Raises:
        NotExactError: It is not known exactly.
    """
    if not measured.computed:
        return WithPi(exactly(measured.value))
    if measured.exact is None:
        raise NotExactError("an expression without an exact value")
    return measured.exact


class ExpressionError(ModelError):
    """An expression that cannot be read or has no finite value.

    Attributes:
        reason: What is wrong, without the expression itself.
        position: Index of the character where it was found.
    """

    def __init__(self, text: str, reason: str, position: int) -> None:
        self.reason, self.position = reason, position
        super().__init__(f"expression {shown(text)}: {reason}")


def is_expression(text: str) -> bool:
    """Whether a text was meant as an expression: it uses a parameter, pi or a function."""
    return "$" in text or bool(re.search(r"\b(?:pi|sin|cos|tan|sqrt)\b", text))


def evaluate(text: str, parameters: Mapping[str, Measured]) -> Measured:
    """The value of an expression.

    Args:
        text: The expression.
        parameters: Values of the parameters that it may use.

    Raises:
        ExpressionError: Not in the grammar, an unknown parameter, or no finite value.
    """
    if len(text) > _LONGEST:
        raise ExpressionError(text, f"longer than {_LONGEST} characters", _LONGEST)
    reader = _Reader(text, parameters)
    result = reader.whole()
    if not (is_finite(result.value) and is_finite(result.half_unit)):
        raise ExpressionError(text, "its value is too large", 0)
    return result


class _Reader:
    def __init__(self, text: str, parameters: Mapping[str, Measured]) -> None:
        self._text, self._parameters = text, parameters
        self._at = 0
        self._depth = 0
        self._kind = self._symbol = ""
        self._start = 0
        self._advance()

    def whole(self) -> Measured:
        result = self._sum()
        if self._symbol:
            self._refuse(f"expected an operator, got {shown(self._symbol)}")
        return result

    def _advance(self) -> None:
        match = _TOKEN.match(self._text, self._at)
        if match is None:
            rest = self._text[self._at :].lstrip()
            self._start = len(self._text) - len(rest)
            self._kind = self._symbol = ""
            if rest:
                self._refuse(
                    f"{shown(rest[0])} is not in the grammar (+ - * / ( ) numbers $names "
                    f"pi {' '.join(FUNCTIONS)})"
                )
            return
        self._kind = match.lastgroup or ""
        self._symbol = match[self._kind]
        self._start, self._at = match.start(self._kind), match.end()

    def _sum(self) -> Measured:
        left = self._product()
        while self._symbol in ("+", "-"):
            sign = 1.0 if self._symbol == "+" else -1.0
            self._advance()
            right = self._product()
            exact = _exactly(lambda a, b, s=sign: a + (b if s > 0.0 else -b), left, right)
            left = _computed(left.value + sign * right.value, left.half_unit + right.half_unit, exact)
        return left

    def _product(self) -> Measured:
        left = self._signed()
        while self._symbol in ("*", "/"):
            operator, start = self._symbol, self._start
            self._advance()
            right = self._signed()
            if operator == "*":
                off = abs(left.value) * right.half_unit + abs(right.value) * left.half_unit
                left = _computed(left.value * right.value, off, _exactly(lambda a, b: a * b, left, right))
                continue
            if right.value == 0.0:
                raise ExpressionError(self._text, "division by zero", start)
            quotient = left.value / right.value
            off = (left.half_unit + abs(quotient) * right.half_unit) / abs(right.value)
            left = _computed(quotient, off, _exactly(lambda a, b: a / b, left, right))
        return left

    def _signed(self) -> Measured:
        sign = 1.0
        while self._symbol in ("+", "-"):
            sign = -sign if self._symbol == "-" else sign
            self._advance()
        atom = self._atom()
        exact = _exactly(lambda a: a if sign > 0.0 else -a, atom)
        return _computed(sign * atom.value, atom.half_unit, exact)

    def _atom(self) -> Measured:
        kind, symbol = self._kind, self._symbol
        if kind == "number":
            found = number(symbol)
            if found is None:
                self._refuse(f"{shown(symbol)} is no plain decimal number")
            self._advance()
            return Measured(float(found), half_unit(symbol))
        if kind == "parameter":
            name = symbol[1:]
            if name not in self._parameters:
                hint = suggestion(name, self._parameters) or "; none is known here"
                self._refuse(f"no parameter is named {shown(name)}{hint}")
            self._advance()
            return self._parameters[name]
        if kind == "word":
            return self._word(symbol)
        if symbol == "(":
            return self._parenthesis()
        return self._refuse("ends too early" if not symbol else f"expected a value, got {shown(symbol)}")

    def _word(self, word: str) -> Measured:
        if word == "pi":
            self._advance()
            return _computed(math.pi, 0.0, PI)
        if word not in FUNCTIONS:
            dollar = f"; a parameter is written ${word}" if word in self._parameters else ""
            self._refuse(f"{shown(word)} is not known: {listing(('pi', *FUNCTIONS))}{dollar}")
        start = self._start
        self._advance()
        if self._symbol != "(":
            self._refuse(f"expected '(' after {word}")
        argument = self._parenthesis()
        x, off = argument.value, argument.half_unit
        if word == "sqrt":
            if x < 0.0:
                raise ExpressionError(self._text, f"square root of {x:g}", start)
            root = sqrt(x)
            exact = _exactly(lambda a: WithPi(a.number.root()), argument)
            return _computed(root, off / (2.0 * root) if root > 0.0 else sqrt(off), exact)
        if not is_finite(x):
            raise ExpressionError(self._text, "its value is too large", start)
        off = max(off, doubt_of_angle(x))
        if word == "sin":
            exact = _exactly(lambda a: WithPi((QUARTER + -a).cosine), argument)
            return _computed(sin(x), abs(cos(x)) * off, exact)
        if word == "cos":
            exact = _exactly(lambda a: WithPi(a.cosine), argument)
            return _computed(cos(x), abs(sin(x)) * off, exact)
        exact = _exactly(lambda a: WithPi((QUARTER + -a).cosine) / WithPi(a.cosine), argument)
        return _computed(tan(x), (1.0 + tan(x) ** 2) * off, exact)

    def _parenthesis(self) -> Measured:
        self._depth += 1
        if self._depth > _DEEPEST:
            self._refuse(f"more than {_DEEPEST} parentheses inside each other")
        self._advance()
        inner = self._sum()
        if self._symbol != ")":
            self._refuse("expected ')'")
        self._depth -= 1
        self._advance()
        return inner

    def _refuse(self, reason: str) -> NoReturn:
        raise ExpressionError(self._text, reason, self._start)


def _computed(value: float, half_unit: float, exact: WithPi | None) -> Measured:
    return Measured(value, half_unit, 0.0, exact, computed=True)


def _exactly(operation: Callable[..., WithPi], *operands: Measured) -> WithPi | None:
    """The result of an operation on exact numbers; None where it is not exact."""
    try:
        return operation(*(exact_number(operand) for operand in operands))
    except (NotExactError, ZeroDivisionError):
        return None
