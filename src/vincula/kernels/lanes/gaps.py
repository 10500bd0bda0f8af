"""How far loops are open, in lanes: an upper bound that is exact for small gaps, in units of the length."""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.rows import polynomial, term
from vincula.kernels.lanes.vector import absolute, fma, larger, load, neg, splat, store


@kernel
def note_gaps(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Note the squared largest gap of all loops, contacts and couplings, and how far joints reach."""
    notes = base + code[t.NOTES]
    at = code[t.GAPS]
    worst = z
    for k in range(code[at]):
        entry = at + 1 + t.GAP_ENTRY * k
        square = _square(w, code, constants, base, entry, z)
        # What is not a number, at half a turn say, must not be lost in a comparison.
        worst = larger(square, worst) + (square - square)
    store(w, notes + t.RESIDUAL, worst)
    at, origin = code[t.REACH], base + code[t.REFERENCE]
    far = z
    for k in range(code[at]):
        frame = base + code[at + 1 + k]
        square = z
        for i in range(3):
            x = load(w, frame + 9 + i, z) - load(w, origin + 9 + i, z)
            square = fma(x, x, square)
        far = larger(square, far)
    store(w, notes + t.REACHED, far)


@kernel
def _square(w: Slots, code: Code, constants: Slots, base: int, entry: int, z: Lane) -> Lane:
    """Squared gap of one part."""
    kind = code[entry]
    if kind == t.BALANCE:
        return _coupling(w, code, constants, base, code[entry + 1], code[entry + 2], z)
    a, b, mask = base + code[entry + 1], base + code[entry + 2], code[entry + 3]
    square = _offset(w, a, b, mask, z)
    if kind == t.WHOLE_POSE:
        return square + _difference(w, a, b, z)
    if kind == t.TURNED:
        return square + _turned(w, a, b, mask, z)
    if kind == t.TILTED:
        return square + _tilted(w, a, b, z)
    beyond = _beyond(w, constants, a, b, code[entry + 4], z)
    return fma(beyond, beyond, square)


@kernel
def _offset(w: Slots, a: int, b: int, mask: int, z: Lane) -> Lane:
    """Squared components of the offset of B in the axes of A."""
    x = load(w, b + 9, z) - load(w, a + 9, z)
    y = load(w, b + 10, z) - load(w, a + 10, z)
    v = load(w, b + 11, z) - load(w, a + 11, z)
    square = z
    for k in range(3):
        if mask & (1 << k):
            c = fma(load(w, a + k, z), x, fma(load(w, a + 3 + k, z), y, load(w, a + 6 + k, z) * v))
            square = fma(c, c, square)
    return square


@kernel
def _difference(w: Slots, a: int, b: int, z: Lane) -> Lane:
    """Squared angle between two rotations: at most pi^2 / 8 times the squared difference of the matrices.

    For small angles it is half of that difference; the factor goes from one to the other.
    """
    square = z
    for i in range(9):
        x = load(w, a + i, z) - load(w, b + i, z)
        square = fma(x, x, square)
    return square * fma(square, splat(0.1, z), splat(0.5, z))


@kernel
def _column_product(w: Slots, a: int, i: int, b: int, j: int, z: Lane) -> Lane:
    """Entry (i, j) of A^T B."""
    return fma(
        load(w, a + i, z), load(w, b + j, z),
        fma(load(w, a + 3 + i, z), load(w, b + 3 + j, z), load(w, a + 6 + i, z) * load(w, b + 6 + j, z)),
    )  # fmt: skip


@kernel
def _turned(w: Slots, a: int, b: int, mask: int, z: Lane) -> Lane:
    """Squared components of the rotation vector: of theta n, bounded by 2 tan(theta / 2) n."""
    square = z
    if mask >> 3 == 0:
        return square
    cosine = splat(-1.0, z)
    for i in range(3):
        cosine = cosine + _column_product(w, a, i, b, i, z)
    # 1 + cos theta, twice: the sum above is 2 cos theta.
    factor = splat(2.0, z) / (splat(2.0, z) + cosine)
    for k in range(3):
        if mask & (8 << k):
            i, j = (k + 1) % 3, (k + 2) % 3
            skew = _column_product(w, a, j, b, i, z) - _column_product(w, a, i, b, j, z)
            c = skew * factor
            square = fma(c, c, square)
    return square


@kernel
def _tilted(w: Slots, a: int, b: int, z: Lane) -> Lane:
    """Squared angle between the two z axes, bounded by 2 tan of its half."""
    x, y = _column_product(w, a, 0, b, 2, z), _column_product(w, a, 1, b, 2, z)
    factor = splat(2.0, z) / (splat(1.0, z) + _column_product(w, a, 2, b, 2, z))
    return fma(x, x, y * y) * factor * factor


@kernel
def _beyond(w: Slots, constants: Slots, a: int, b: int, index: int, z: Lane) -> Lane:
    """Angle of z of A to an axis of B beyond the drawn one, from cosines; exact for small gaps."""
    cosine = neg(constant(constants, w, index + 3, z))
    for k in range(3):
        cosine = fma(_column_product(w, a, 2, b, k, z), constant(constants, w, index + k, z), cosine)
    return cosine * constant(constants, w, index + 4, z) * fma(absolute(cosine), splat(4.0, z), splat(1.0, z))


@kernel
def _coupling(w: Slots, code: Code, constants: Slots, base: int, at: int, factor: int, z: Lane) -> Lane:
    """Squared residual of a coupling."""
    total = z
    for _ in range(code[at]):
        total = total + term(w, constants, base + code[at + 1], code[at + 2], z)
        at += 2
    at += 1
    inner = z
    for _ in range(code[at]):
        inner = inner + term(w, constants, base + code[at + 1], code[at + 2], z)
        at += 2
    at += 1
    gap = total - polynomial(w, constants, code[at], code[at + 1], inner, z)
    gap = gap * constant(constants, w, factor, z)
    return gap * gap
