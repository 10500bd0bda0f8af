"""A number in every lane: the vector type `Vec`, W doubles that go through the same arithmetic together.

W = 1 is the build for a single configuration; it and any other width give the same bits, because no
operation is reordered, fused or approximated by the compiler: fused operations stand where they are
written.  Lanes live in a workspace of doubles, slot i of a workspace being W consecutive doubles.

Unary and binary arithmetic is written with the usual operators.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.types.misc import CPointer
from numba.extending import intrinsic, models, overload, register_model

_I32 = ir.IntType(32)


class Vec(types.Type):
    """W lanes of doubles, or of truth values.

    Attributes:
        width: Number of lanes W.
        truth: Whether the lanes hold truth values.
    """

    def __init__(self, width: int, truth: bool = False) -> None:
        self.width, self.truth = width, truth
        super().__init__(name=f"{'Mask' if truth else 'Vec'}{width}")

    @property
    def key(self) -> tuple[int, bool]:
        """What makes two types the same."""
        return self.width, self.truth


@register_model(Vec)
class _VecModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Vec) -> None:
        super().__init__(manager, kind, _llvm(kind.width, kind.truth))


def _llvm(width: int, truth: bool = False) -> Any:
    return ir.VectorType(ir.IntType(1) if truth else ir.DoubleType(), width)


def _is_vec(kind: Any) -> bool:
    return isinstance(kind, Vec) and not kind.truth


def _all(width: int, value: float) -> Any:
    return ir.Constant(_llvm(width), [value] * width)


@intrinsic(prefer_literal=True)
def zeros(context: Any, width: Any) -> Any:
    """Zero in as many lanes as a constant says; everything takes its width from it.

    The width is a plain number, because kernels are found again on disk by what they close over: an
    object made for a width would be another one in every process.
    """
    if not isinstance(width, types.IntegerLiteral):
        return None
    lanes = width.literal_value
    return Vec(lanes)(width), lambda c, b, s, a: _all(lanes, 0.0)


def zero_of(width: int) -> Any:
    """A function of kernels that gives zero in `width` lanes; not for kernels that are kept on disk."""

    @intrinsic
    def zero(context: Any) -> Any:
        return Vec(width)(), lambda c, b, s, a: _all(width, 0.0)

    return zero


# Memory ---------------------------------------------------------------------------------------------


@intrinsic
def first_of(context: Any, array: Any) -> Any:
    """Address of the first number of an array, which its owner keeps alive.

    Kernels take addresses: arrays would be counted in and out of every call.
    """
    if not isinstance(array, types.Array):
        return None

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        return c.make_array(s.args[0])(c, b, a[0]).data

    return CPointer(array.dtype)(array), generate


def _pointer(context: Any, builder: Any, kind: Any, array: Any, index: Any, width: int) -> Any:
    plain = isinstance(kind, CPointer)
    data = array if plain else context.make_array(kind)(context, builder, array).data
    place = builder.gep(data, [builder.mul(index, ir.Constant(index.type, width))])
    return builder.bitcast(place, _llvm(width).as_pointer())


@intrinsic
def load(context: Any, array: Any, slot: Any, like: Any) -> Any:
    """Slot of a workspace; `like` is any vector of the width wanted."""
    if not _is_vec(like):
        return None

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        index = c.cast(b, a[1], s.args[1], types.intp)
        found = b.load(_pointer(c, b, s.args[0], a[0], index, like.width))
        found.align = 8
        return found

    return like(array, slot, like), generate


@intrinsic
def store(context: Any, array: Any, slot: Any, value: Any) -> Any:
    """Write a slot of a workspace."""
    if not _is_vec(value):
        return None

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        index = c.cast(b, a[1], s.args[1], types.intp)
        written = b.store(a[2], _pointer(c, b, s.args[0], a[0], index, value.width))
        written.align = 8
        return c.get_dummy_value()

    return types.void(array, slot, value), generate


@intrinsic
def splat(context: Any, number: Any, like: Any) -> Any:
    """One number in every lane."""

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        return _splat(b, c.cast(b, a[0], s.args[0], types.float64), like.width)

    return like(number, like), generate


def _splat(builder: Any, number: Any, width: int) -> Any:
    empty = ir.Constant(_llvm(width), ir.Undefined)
    first = builder.insert_element(empty, number, ir.Constant(_I32, 0))
    return builder.shuffle_vector(first, empty, ir.Constant(ir.VectorType(_I32, width), [0] * width))


# Arithmetic -----------------------------------------------------------------------------------------


def _binary(name: str) -> Any:
    @intrinsic
    def operation(context: Any, x: Any, y: Any) -> Any:
        if not (_is_vec(x) and _is_vec(y)):
            return None
        return x(x, y), lambda c, b, s, a: getattr(b, name)(a[0], a[1])

    return operation


def _overloaded(symbol: Callable[..., Any], operation: Any) -> None:
    @overload(symbol, inline="never", strict=False)
    def chosen(a: Any, b: Any) -> Any:
        if _is_vec(a) and _is_vec(b):
            return lambda a, b: operation(a, b)  # noqa: PLW0108  numba wants the names
        return None


for _symbol, _name in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
):  # fmt: skip
    _overloaded(_symbol, _binary(_name))


def _call(builder: Any, name: str, width: int, *arguments: Any) -> Any:
    kind = _llvm(width)
    signature = ir.FunctionType(kind, [kind] * len(arguments))
    found = cgutils.get_or_insert_function(builder.module, signature, f"llvm.{name}.v{width}f64")
    return builder.call(found, arguments)


@intrinsic
def fma(context: Any, x: Any, y: Any, u: Any) -> Any:
    """x y + u, rounded once."""
    return x(x, y, u), lambda c, b, s, a: _call(b, "fma", x.width, *a)


@intrinsic
def fnma(context: Any, x: Any, y: Any, u: Any) -> Any:
    """u - x y, rounded once."""
    return x(x, y, u), lambda c, b, s, a: _call(b, "fma", x.width, b.fneg(a[0]), a[1], a[2])


@intrinsic
def neg(context: Any, x: Any) -> Any:
    """-x."""
    return x(x), lambda c, b, s, a: b.fneg(a[0])


def _unary(name: str) -> Any:
    @intrinsic
    def operation(context: Any, x: Any) -> Any:
        return x(x), lambda c, b, s, a: _call(b, name, x.width, a[0])

    return operation


sqrt = _unary("sqrt")
absolute = _unary("fabs")
nearest = _unary("rint")
floor = _unary("floor")


@intrinsic
def rsqrt(context: Any, x: Any) -> Any:
    """1 / sqrt(x) to the last digit or two, for normal x > 0; faster than a root and a division.

    A guess from the bits of x (halved exponent), then three steps of third order.
    """
    width = x.width

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        whole = ir.VectorType(ir.IntType(64), width)
        halved = b.lshr(b.bitcast(a[0], whole), ir.Constant(whole, [1] * width))
        guess = b.sub(ir.Constant(whole, [0x5FE6EB50C7B537A9] * width), halved)
        y = b.bitcast(guess, _llvm(width))
        for _ in range(3):
            left = _call(b, "fma", width, b.fneg(b.fmul(a[0], y)), y, _all(width, 1.0))
            step = _call(b, "fma", width, left, _all(width, 0.375), _all(width, 0.5))
            y = _call(b, "fma", width, b.fmul(y, left), step, y)
        return y

    return x(x), generate


# Truth values ---------------------------------------------------------------------------------------


def _comparison(symbol: str) -> Any:
    @intrinsic
    def operation(context: Any, x: Any, y: Any) -> Any:
        return Vec(x.width, True)(x, y), lambda c, b, s, a: b.fcmp_ordered(symbol, a[0], a[1])

    return operation


less = _comparison("<")
more = _comparison(">")
at_most = _comparison("<=")
at_least = _comparison(">=")


@intrinsic
def select(context: Any, mask: Any, x: Any, y: Any) -> Any:
    """x where the mask is true, else y."""
    return x(mask, x, y), lambda c, b, s, a: b.select(a[0], a[1], a[2])


@intrinsic
def either(context: Any, x: Any, y: Any) -> Any:
    """Whether one of two masks is true."""
    return x(x, y), lambda c, b, s, a: b.or_(a[0], a[1])


@intrinsic
def both(context: Any, x: Any, y: Any) -> Any:
    """Whether both masks are true."""
    return x(x, y), lambda c, b, s, a: b.and_(a[0], a[1])


@intrinsic
def some_lane(context: Any, mask: Any) -> Any:
    """Whether a mask is true in any lane."""

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        bits = b.bitcast(a[0], ir.IntType(mask.width))
        return b.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), generate


@intrinsic
def larger(context: Any, x: Any, y: Any) -> Any:
    """The larger of two numbers; where one of them is NaN, the second."""
    return x(x, y), lambda c, b, s, a: b.select(b.fcmp_ordered(">", a[0], a[1]), a[0], a[1])
