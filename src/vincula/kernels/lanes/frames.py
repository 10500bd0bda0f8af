"""Where the frames are, in lanes: instructions of the tape, one after the other.

A frame takes 12 slots: its rotation row by row, then its origin in ground axes (scaled).
"""

from __future__ import annotations

from typing import Any

from numba.core import types
from numba.extending import overload

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.trigonometry import cosine_sine
from vincula.kernels.lanes.vector import first_of, fma, fnma, load, neg, rsqrt, splat, store


def constant(constants: Any, w: Slots, index: int, z: Lane) -> Any:
    """A constant: the same number in every lane, or one a lane where `constants` has two dimensions.

    In the second case it was copied to the slots from 0 on.
    """
    raise TypeError(f"only for kernels: {type(constants)}")


def _same_in_all(constants: Any) -> bool:
    return not isinstance(constants, types.Array) or constants.ndim == 1


@overload(constant, inline="never", strict=False)
def _constant(constants: Any, w: Any, index: Any, z: Any) -> Any:
    if _same_in_all(constants):
        return lambda constants, w, index, z: splat(constants[index], z)
    return lambda constants, w, index, z: load(w, index, z)


def borrowed(constants: Any) -> Any:
    """Constants as kernels take them: an address where they are the same in every lane."""
    raise TypeError(f"only for kernels: {type(constants)}")


@overload(borrowed, inline="never", strict=False)
def _borrowed(constants: Any) -> Any:
    if _same_in_all(constants):
        return lambda constants: first_of(constants)  # noqa: PLW0108  numba wants the names
    return lambda constants: constants


def enter_constants(w: Slots, constants: Any, block: int, width: int) -> None:
    """Copy constants that differ from lane to lane to the first slots; nothing where they do not."""
    raise TypeError(f"only for kernels: {type(constants)}")


@overload(enter_constants, inline="never", strict=False)
def _enter_constants(w: Any, constants: Any, block: Any, width: Any) -> Any:
    if _same_in_all(constants):
        return lambda w, constants, block, width: None

    return lambda w, constants, block, width: _copied(w, constants, block, width)  # noqa: PLW0108


@kernel
def _copied(w: Slots, constants: Slots, block: int, width: int) -> None:
    last = constants.shape[0] - 1
    for lane in range(width):
        source = min(block * width + lane, last)
        for k in range(constants.shape[1]):
            w[k * width + lane] = constants[source, k]


@kernel
def place_all(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Every frame and direction at the values in the workspace.

    Args:
        w: The workspace.
        code: Tables.
        constants: Constants.
        base: First slot after constants that differ from lane to lane: all slots of the tables are
            counted from it.
        z: Zero.
    """
    run_tape(w, code, constants, base, 0, code[t.TAPE_LENGTH], z)
    directions(w, code, constants, base, z)


@kernel
def run_tape(w: Slots, code: Code, constants: Slots, base: int, first: int, last: int, z: Lane) -> None:
    """Instructions first ... last - 1 of the tape."""
    for k in range(first, last):
        at = code[t.TAPE] + t.INSTRUCTION * k
        operation, target = code[at], base + code[at + 1]
        if operation == t.PLACE:
            source = code[at + 2]
            parent = base + source if source >= 0 else -1
            place(w, constants, parent, code[at + 3], code[at + 6], target, z)
        elif operation == t.TURN:
            c, s = cosine_sine(_value(w, base + code[at + 4], code[at + 5], z), z)
            turn_z(w, target, c, s, z)
        elif operation == t.SLIDE:
            slide(w, target, code[at + 7], _value(w, base + code[at + 4], code[at + 5], z), z)
        elif operation == t.HELIX:
            q = _value(w, base + code[at + 4], code[at + 5], z)
            c, s = cosine_sine(q, z)
            turn_z(w, target, c, s, z)
            slide(w, target, 2, q * constant(constants, w, code[at + 3], z), z)
        else:
            scratch = base + code[t.SCRATCH]
            if operation == t.BALL:
                quaternion_rotation(w, base + code[at + 4], code[at + 5], scratch, z)
            else:
                q = _value(w, base + code[at + 4], code[at + 5], z)
                axis_rotation(w, constants, code[at + 3], q, scratch, z)
            multiply(w, target, scratch, z)


@kernel
def _value(w: Slots, slot: int, sign: int, z: Lane) -> Lane:
    q = load(w, slot, z)
    if sign < 0:
        return neg(q)
    return q


@kernel
def place(w: Slots, constants: Slots, parent: int, index: int, flags: int, target: int, z: Lane) -> None:
    """target = parent times a constant pose; parent -1 is the ground."""
    if parent < 0:
        for i in range(12):
            store(w, target + i, constant(constants, w, index + i, z))
        return
    for i in range(3):
        a, b, c = load(w, parent + 3 * i, z), load(w, parent + 3 * i + 1, z), load(w, parent + 3 * i + 2, z)
        if flags & 1:
            for j in range(3):
                p, q = constant(constants, w, index + j, z), constant(constants, w, index + 3 + j, z)
                r = constant(constants, w, index + 6 + j, z)
                store(w, target + 3 * i + j, fma(a, p, fma(b, q, c * r)))
        else:
            store(w, target + 3 * i, a)
            store(w, target + 3 * i + 1, b)
            store(w, target + 3 * i + 2, c)
        x = load(w, parent + 9 + i, z)
        if flags & 2:
            p, q = constant(constants, w, index + 9, z), constant(constants, w, index + 10, z)
            x = fma(a, p, fma(b, q, fma(c, constant(constants, w, index + 11, z), x)))
        store(w, target + 9 + i, x)


@kernel
def turn_z(w: Slots, frame: int, c: Lane, s: Lane, z: Lane) -> None:
    """Turn a frame about its own z by the angle of this cosine and sine."""
    for i in range(3):
        a, b = load(w, frame + 3 * i, z), load(w, frame + 3 * i + 1, z)
        store(w, frame + 3 * i, fma(c, a, s * b))
        store(w, frame + 3 * i + 1, fnma(s, a, c * b))


@kernel
def slide(w: Slots, frame: int, axis: int, distance: Lane, z: Lane) -> None:
    """Move a frame along one of its axes."""
    for i in range(3):
        moved = fma(distance, load(w, frame + 3 * i + axis, z), load(w, frame + 9 + i, z))
        store(w, frame + 9 + i, moved)


@kernel
def quaternion_rotation(w: Slots, slot: int, sign: int, target: int, z: Lane) -> None:
    """Rotation matrix of a quaternion (w, x, y, z) of any length; of its inverse for sign -1."""
    one = splat(1.0, z)
    a, b, c, d = load(w, slot, z), load(w, slot + 1, z), load(w, slot + 2, z), load(w, slot + 3, z)
    if sign < 0:
        a = neg(a)
    double = splat(2.0, z) / fma(a, a, fma(b, b, fma(c, c, d * d)))
    b2, c2, d2 = b * double, c * double, d * double
    store(w, target, fnma(c, c2, fnma(d, d2, one)))
    store(w, target + 1, fnma(a, d2, b * c2))
    store(w, target + 2, fma(a, c2, b * d2))
    store(w, target + 3, fma(a, d2, b * c2))
    store(w, target + 4, fnma(b, b2, fnma(d, d2, one)))
    store(w, target + 5, fnma(a, b2, c * d2))
    store(w, target + 6, fnma(a, c2, b * d2))
    store(w, target + 7, fma(a, b2, c * d2))
    store(w, target + 8, fnma(b, b2, fnma(c, c2, one)))


@kernel
def axis_rotation(w: Slots, constants: Slots, index: int, q: Lane, target: int, z: Lane) -> None:
    """Rotation matrix of a turn by q about a constant unit vector."""
    c, s = cosine_sine(q, z)
    x, y = constant(constants, w, index, z), constant(constants, w, index + 1, z)
    v = constant(constants, w, index + 2, z)
    rest = splat(1.0, z) - c
    store(w, target, fma(rest * x, x, c))
    store(w, target + 1, fnma(s, v, rest * x * y))
    store(w, target + 2, fma(s, y, rest * x * v))
    store(w, target + 3, fma(s, v, rest * x * y))
    store(w, target + 4, fma(rest * y, y, c))
    store(w, target + 5, fnma(s, x, rest * y * v))
    store(w, target + 6, fnma(s, y, rest * x * v))
    store(w, target + 7, fma(s, x, rest * y * v))
    store(w, target + 8, fma(rest * v, v, c))


@kernel
def multiply(w: Slots, frame: int, rotation: int, z: Lane) -> None:
    """Turn a frame by a rotation given in its own axes."""
    for i in range(3):
        a, b, c = load(w, frame + 3 * i, z), load(w, frame + 3 * i + 1, z), load(w, frame + 3 * i + 2, z)
        for k in range(3):
            p, q = load(w, rotation + k, z), load(w, rotation + 3 + k, z)
            store(w, frame + 3 * i + k, fma(a, p, fma(b, q, c * load(w, rotation + 6 + k, z))))


@kernel
def turned(w: Slots, constants: Slots, frame: int, index: int, target: int, z: Lane) -> None:
    """Write a constant vector, given in the axes of a frame, in ground axes."""
    x, y = constant(constants, w, index, z), constant(constants, w, index + 1, z)
    v = constant(constants, w, index + 2, z)
    for i in range(3):
        p, q = load(w, frame + 3 * i, z), load(w, frame + 3 * i + 1, z)
        store(w, target + i, fma(p, x, fma(q, y, load(w, frame + 3 * i + 2, z) * v)))


@kernel
def directions(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Directions of general rows and columns."""
    at = code[t.DIRECTIONS]
    for k in range(code[at]):
        entry = at + 1 + t.DIRECTION_ENTRY * k
        kind, target = code[entry], base + code[entry + 1]
        frame, index = base + code[entry + 2], code[entry + 3]
        if kind == t.COMMON_NORMAL:
            other = base + code[entry + 4]
            turned(w, constants, other, index, target, z)
            _common_normal(w, frame, target, z)
        else:
            turned(w, constants, frame, index, target, z)
            if kind == t.FIXED_ROW:
                turned(w, constants, frame, index + 3, target + 3, z)


@kernel
def _common_normal(w: Slots, frame: int, target: int, z: Lane) -> None:
    """Row that turns about the unit normal of z of a frame and the vector at `target`."""
    a, b, c = load(w, frame + 2, z), load(w, frame + 5, z), load(w, frame + 8, z)
    x, y, v = load(w, target, z), load(w, target + 1, z), load(w, target + 2, z)
    p, q, r = fnma(c, y, b * v), fnma(a, v, c * x), fnma(b, x, a * y)
    scale = rsqrt(fma(p, p, fma(q, q, r * r)))
    for i in range(3):
        store(w, target + i, z)
    store(w, target + 3, p * scale)
    store(w, target + 4, q * scale)
    store(w, target + 5, r * scale)
