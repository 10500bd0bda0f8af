"""Cosines and sines of the motions by one-sided Jacobi rotations, in lanes.

The columns (q; u) are orthonormal; rotating them until their lower parts are mutually orthogonal makes
the upper parts orthogonal too.  Every rotation is computed from whichever part of its pair is smaller, so
tiny cosines and tiny sines stay accurate.  Columns end up with the longest twist first.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import (
    absolute,
    at_most,
    both,
    either,
    fma,
    fnma,
    less,
    load,
    more,
    neg,
    rsqrt,
    select,
    some_lane,
    splat,
    store,
)

SWEEPS = 16
"""At most so many rounds over all pairs; five or six are usual."""
ORTHOGONAL = 1e-29
"""Squared cosine below which two columns count as orthogonal."""
SMALL = 1e-17
"""Squared sine, and squared cosine of two columns, below which a rotation disturbs nothing any more.

A round of such rotations leaves every cosine below the product of the two times the number of columns, so
it is the last one: nothing is left to look at."""
NOTHING = 1e-290


@kernel
def rotate_all(w: Slots, code: Code, base: int, z: Lane) -> Lane:
    """Rotate all pairs until rotations are small; 1 in lanes where that was reached, else 0.

    A lane that is done is left as it is while others go on.  Pairs come with growing sums of their places:
    for every column that is the order row by row, but neighbours have no column in common, so the processor
    works at several of them at once.
    """
    k, motors, size = code[t.FREEDOM], code[t.MOTORS], code[t.MOTORS] + code[t.TWIST]
    first, squares = base + code[t.MOTIONS], base + code[t.SQUARES]
    changed = base + code[t.NOTES] + t.CHANGED
    store(w, changed, z)
    for sweep in range(1, SWEEPS + 1):
        measure(w, first, squares, k, motors, size, z)
        count = splat(float(sweep), z)
        done = True
        for total in range(1, 2 * k - 2):
            for p in range(max(0, total - k + 1), (total + 1) // 2):
                q = total - p
                a, b = first + p * size, first + q * size
                if _rotate(w, a, b, squares + 2 * p, squares + 2 * q, motors, size, changed, count, z):
                    done = False
        if done:
            break
    return select(less(load(w, changed, z), splat(float(SWEEPS), z)), splat(1.0, z), z)


@kernel
def measure(w: Slots, first: int, squares: int, k: int, motors: int, size: int, z: Lane) -> None:
    """Squared lengths of both parts of every column: motors, twist."""
    for p in range(k):
        a = first + p * size
        own = z
        for i in range(motors):
            x = load(w, a + i, z)
            own = fma(x, x, own)
        store(w, squares + 2 * p, own)
        own = z
        for i in range(motors, size):
            x = load(w, a + i, z)
            own = fma(x, x, own)
        store(w, squares + 2 * p + 1, own)


@kernel
def _rotate(
    w: Slots, a: int, b: int, of_a: int, of_b: int, motors: int, size: int, changed: int, count: Lane, z: Lane
) -> bool:
    """One rotation of columns a and b; whether it was not small in any lane."""
    inner_q, inner_u = z, z
    for i in range(motors):
        inner_q = fma(load(w, a + i, z), load(w, b + i, z), inner_q)
    for i in range(motors, size):
        inner_u = fma(load(w, a + i, z), load(w, b + i, z), inner_u)
    a_q, a_u = load(w, of_a, z), load(w, of_a + 1, z)
    b_q, b_u = load(w, of_b, z), load(w, of_b + 1, z)
    by_twist = less(a_u + b_u, a_q + b_q)
    inner = select(by_twist, inner_u, neg(inner_q))
    gap = select(by_twist, b_u - a_u, a_q - b_q)
    product = select(by_twist, a_u * b_u, a_q * b_q)
    skew = more(inner * inner, splat(ORTHOGONAL, z) * product)
    before = load(w, changed, z)
    # A lane goes on while the round before, or this one, changed much in it.
    last = before + splat(1.5, z)
    going, halted = more(last, count), at_most(last, count)
    skew, exchanged = both(going, skew), both(going, more(gap, z))
    if not some_lane(either(skew, exchanged)):
        return False
    twice = inner + inner
    radius = fma(gap, gap, twice * twice)
    inverse = rsqrt(radius)
    skew = both(skew, more(radius, splat(NOTHING, z)))
    half = splat(0.5, z)
    square = fma(absolute(gap) * half, inverse, half)
    root = rsqrt(square)
    cosine = select(skew, square * root, splat(1.0, z))
    sine = select(skew, inner * inverse * root, z)
    tangent = sine * root
    # The longer twist comes first: where b has it, the pair is exchanged as well.
    stay = either(at_most(gap, z), halted)
    c, s = select(stay, cosine, sine), select(stay, neg(sine), neg(cosine))
    for i in range(size):
        x, y = load(w, a + i, z), load(w, b + i, z)
        store(w, a + i, fnma(s, y, c * x))
        store(w, b + i, fma(s, x, c * y))
    store(w, of_a + 1, fma(tangent, inner_u, select(stay, a_u, b_u)))
    store(w, of_b + 1, fnma(tangent, inner_u, select(stay, b_u, a_u)))
    store(w, of_a, fma(tangent, inner_q, select(stay, a_q, b_q)))
    store(w, of_b, fnma(tangent, inner_q, select(stay, b_q, a_q)))
    turned = either(more(sine * sine, splat(SMALL, z)), more(inner * inner, splat(SMALL, z) * product))
    much = either(exchanged, both(skew, turned))
    store(w, changed, select(much, count, before))
    found: bool = some_lane(much)
    return found
