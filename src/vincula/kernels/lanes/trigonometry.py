"""Sine and cosine in lanes."""

from __future__ import annotations

from vincula.kernels.lanes.jit import Lane, kernel
from vincula.kernels.lanes.vector import (
    absolute,
    at_most,
    both,
    floor,
    fma,
    fnma,
    less,
    more,
    nearest,
    neg,
    select,
    splat,
)

LARGEST_ANGLE = 1e9
"""Beyond this an angle has no meaning left beside its rounding; sine and cosine are then NaN."""


@kernel
def cosine_sine(x: Lane, z: Lane) -> tuple[Lane, Lane]:
    """cos x and sin x, to about one unit of the last digit; NaN beyond `LARGEST_ANGLE`.

    Multiples of pi/2 are taken off with pi/2 in two doubles, exactly but for the last step; then the
    polynomials of fdlibm on [-pi/4, pi/4].
    """
    count = nearest(x * splat(0.6366197723675814, z))
    r = fnma(count, splat(1.5707963267948966, z), x)
    r = fnma(count, splat(6.123233995736766e-17, z), r)
    square = r * r
    c, s = _cosine_kernel(square, z), _sine_kernel(r, square, z)
    # The quarter turn 0 ... 3 that the angle is in.
    quarter = fnma(floor(count * splat(0.25, z)), splat(4.0, z), count)
    odd = more(fnma(floor(count * splat(0.5, z)), splat(2.0, z), count), splat(0.5, z))
    cosine, sine = select(odd, s, c), select(odd, c, s)
    turned = both(more(quarter, splat(0.5, z)), less(quarter, splat(2.5, z)))
    below = more(quarter, splat(1.5, z))
    known = at_most(absolute(x), splat(LARGEST_ANGLE, z))
    nothing = z / z
    cosine = select(known, select(turned, neg(cosine), cosine), nothing)
    return cosine, select(known, select(below, neg(sine), sine), nothing)


@kernel
def _sine_kernel(r: Lane, square: Lane, z: Lane) -> Lane:
    s = fma(square, splat(1.58969099521155010221e-10, z), splat(-2.50507602534068634195e-08, z))
    s = fma(square, s, splat(2.75573137070700676789e-06, z))
    s = fma(square, s, splat(-1.98412698298579493134e-04, z))
    s = fma(square, s, splat(8.33333333332248946124e-03, z))
    s = fma(square, s, splat(-1.66666666666666324348e-01, z))
    return fma(square * r, s, r)


@kernel
def _cosine_kernel(square: Lane, z: Lane) -> Lane:
    c = fma(square, splat(-1.13596475577881948265e-11, z), splat(2.08757232129817482790e-09, z))
    c = fma(square, c, splat(-2.75573143513906633035e-07, z))
    c = fma(square, c, splat(2.48015872894767294178e-05, z))
    c = fma(square, c, splat(-1.38888888888741095749e-03, z))
    c = fma(square, c, splat(4.16666666666666019037e-02, z))
    return fma(square * square, c, fma(square, splat(-0.5, z), splat(1.0, z)))
