"""Whether the ranks of the plan hold at a configuration, in lanes.

Lower bounds of smallest singular values come from inverses of triangles: the smallest singular value of
[R B; 0 C] is at least 1 / sqrt(r^2 + (1 + |R^-1 B|^2) c^2) with r and c the norms of the inverses of R
and C.  A rank is certain when its bound is farther above the uncertainty than the ordinary rule asks, and
everything that should be zero is below half of what that rule takes for certainly zero; so what is
certain here is certain there, with the same ranks.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.reflections import inverse_square, solved_square, square_below, triangularise
from vincula.kernels.lanes.vector import (
    both,
    fma,
    larger,
    less,
    load,
    more,
    select,
    splat,
    sqrt,
    store,
)

ASKED = 12.0
"""How many times above the uncertainty a bound must be: a little more than the safety of `numerics.rank`.

The uncertainty is itself taken with the Frobenius norm for the largest singular value."""


@kernel
def certify_twists(w: Slots, code: Code, base: int, z: Lane) -> None:
    """Notes on the twist columns of the reduced rows, with all motors locked and with all of them free."""
    notes, stack, d = base + code[t.NOTES], base + code[t.STACK], code[t.TWIST]
    order, rank = code[t.OBJECT_ORDER], code[t.OBJECT_RANK]
    store(w, notes + t.OBJECT_INVERSE, _stacked(w, code, base, stack, code[t.REDUCED], order, rank, z))
    m = code[t.REST_ROWS]
    row = 0
    worst = z
    for limb in range(code[t.LIMBS]):
        entry = code[t.LIMB] + t.LIMB_ENTRY * limb
        inverse = _free_motors(w, code, base, entry, stack + row, m, z)
        worst = larger(worst, inverse)
        row += code[entry + 1] - code[entry + 4]
    store(w, notes + t.DRIVEN_INVERSE, worst)
    _triangle(w, code, base, stack, m, d, code[t.REST_ORDER], code[t.REST_RANK], t.REST_INVERSE, z)


@kernel
def _stacked(w: Slots, code: Code, base: int, stack: int, m: int, order: int, rank: int, z: Lane) -> Lane:
    """Squared norm of the inverse for the twist columns of all reduced rows."""
    d, row = code[t.TWIST], 0
    for limb in range(code[t.LIMBS]):
        entry = code[t.LIMB] + t.LIMB_ENTRY * limb
        motors, source = code[entry + 2], base + code[entry]
        for r in range(code[entry + 1]):
            for i in range(d):
                store(w, stack + i * m + row, load(w, source + r * (motors + d) + motors + i, z))
            row += 1
    _triangle(w, code, base, stack, m, d, order, rank, t.OBJECT_INVERSE, z)
    return load(w, base + code[t.NOTES] + t.OBJECT_INVERSE, z)


@kernel
def _triangle(
    w: Slots, code: Code, base: int, matrix: int, m: int, columns: int, order: int, rank: int, note: int,
    z: Lane,
) -> None:  # fmt: skip
    """Note the inverse of the independent columns, and what the others leave below."""
    notes, factors = base + code[t.NOTES], base + code[t.FACTORS]
    triangularise(w, matrix, m, code, order, rank, columns, factors, z)
    square = inverse_square(w, matrix, m, code, order, rank, factors, base + code[t.VECTOR], z)
    store(w, notes + note, square)
    trail = z
    for j in range(rank, columns):
        trail = trail + square_below(w, matrix + code[order + j] * m, rank, m, z)
    store(w, notes + t.TRAIL, larger(load(w, notes + t.TRAIL, z), trail))


@kernel
def _free_motors(w: Slots, code: Code, base: int, entry: int, stack: int, stride: int, z: Lane) -> Lane:
    """Inverse for the motor columns of one limb; the rows that they leave go to the stack.

    What it makes of the twist columns is noted: the product of norms would be far too large where rows of a
    long chain are small in both.
    """
    m, motors, rank, order = code[entry + 1], code[entry + 2], code[entry + 4], code[entry + 5]
    d, source = code[t.TWIST], base + code[entry]
    matrix, factors = base + code[t.BUFFER], base + code[t.FACTORS]
    columns = motors + d
    for j in range(columns):
        for r in range(m):
            store(w, matrix + j * m + r, load(w, source + r * columns + j, z))
    triangularise(w, matrix, m, code, order, rank, columns, factors, z)
    trail = z
    for j in range(rank, motors):
        trail = trail + square_below(w, matrix + code[order + j] * m, rank, m, z)
    notes = base + code[t.NOTES]
    store(w, notes + t.TRAIL, larger(load(w, notes + t.TRAIL, z), trail))
    for i in range(d):
        column = matrix + (motors + i) * m
        for r in range(rank, m):
            store(w, stack + i * stride + r - rank, load(w, column + r, z))
        solved = solved_square(w, matrix, m, code, order, rank, factors, column, base + code[t.VECTOR], z)
        store(w, notes + t.DRIVEN_COUPLING, load(w, notes + t.DRIVEN_COUPLING, z) + solved)
    return inverse_square(w, matrix, m, code, order, rank, factors, base + code[t.VECTOR], z)


@kernel
def _joined(first: Lane, second: Lane, coupling: Lane, z: Lane) -> Lane:
    """Squared inverse of a block triangle from those of its two blocks and the square of R^-1 B."""
    return fma(splat(1.0, z) + coupling, second, first)


@kernel
def certain_ranks(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> Lane:
    """1 where the four ranks of the summary are those of the plan for certain, else 0.

    Leaves in the notes, at `LIMB_INVERSE`, the uncertainty of the motions: an angle.
    """
    notes = base + code[t.NOTES]
    norm = load(w, notes + t.NORM, z)
    passive = load(w, notes + t.PASSIVE_INVERSE, z)
    of_motors, of_twist = load(w, notes + t.MOTOR_COUPLING, z), load(w, notes + t.OBJECT_COUPLING, z)
    of_rows = load(w, notes + t.DRIVEN_INVERSE, z)
    driven = _joined(passive, of_rows, of_motors, z)
    locked = _joined(passive, load(w, notes + t.OBJECT_INVERSE, z), of_twist, z)
    # R^-1 B for passive joints and motors together, B the twist: through the motors it goes by their rows.
    reduced = load(w, notes + t.DRIVEN_COUPLING, z)
    both_ways = sqrt(of_twist) + sqrt(of_motors * reduced)
    whole = _joined(driven, load(w, notes + t.REST_INVERSE, z), fma(both_ways, both_ways, reduced), z)
    together = passive + driven + locked + whole
    # What is infinite or not a number must not be lost in a comparison.
    worst = larger(larger(passive, driven), larger(locked, whole)) + (together - together)
    good = is_certain(w, code, constants, base, worst, load(w, notes + t.TRAIL, z), z)
    rho, size = _rho(w, code, constants, base, z), sqrt(norm)
    of_whole = uncertainty(w, code, constants, whole, size, rho, z)
    store(w, notes + t.LIMB_INVERSE, of_whole * sqrt(whole))
    return select(good, splat(1.0, z), z)


@kernel
def is_certain(
    w: Slots, code: Code, constants: Slots, base: int, inverse: Lane, trail: Lane, z: Lane
) -> Lane:
    """Whether a rank is certain: squared norms of an inverse, and of what should be zero."""
    rho = _rho(w, code, constants, base, z)
    size = sqrt(load(w, base + code[t.NOTES] + t.NORM, z))
    doubt = uncertainty(w, code, constants, inverse, size, rho, z)
    good = less(splat(ASKED, z) * doubt * sqrt(inverse), splat(1.0, z))
    zero = constant(constants, w, code[t.DOUBT] + 1, z) * size
    return both(good, less(trail, zero * zero))


@kernel
def _rho(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> Lane:
    """Residual times the bound on second derivatives; a residual below rounding counts as rounding."""
    notes = base + code[t.NOTES]
    reach = larger(load(w, notes + t.REACHED, z), splat(1.0, z))
    residual = sqrt(load(w, notes + t.RESIDUAL, z)) + splat(4.5e-16, z)
    return constant(constants, w, code[t.DOUBT] + 2, z) * sqrt(reach) * residual


@kernel
def uncertainty(
    w: Slots, code: Code, constants: Slots, inverse: Lane, size: Lane, rho: Lane, z: Lane
) -> Lane:
    """Uncertainty Delta of a matrix whose inverse has this squared norm (numerics page, step 2)."""
    regular = more(splat(0.5, z), rho * inverse)
    closure = select(regular, rho * sqrt(inverse), sqrt(rho + rho))
    return size * (constant(constants, w, code[t.DOUBT], z) + closure)
