"""From slots of the workspace to rows of arrays, in lanes: results go straight where they stay.

What goes where is a table of whole numbers, five a part: first slot (from `OUTPUT` on), slots from one number
to the next (0: one number again and again), count, address of the first of them in row 0, and doubles from
one row to the next.

Large arrays are written past the caches, or every line would be read before it is written.  That needs whole
lines at a time, so rows of one block are put together in a small array first: the table then leads there, and
a second one, three numbers an array, says where its rows go: address of the small one, address of row 0 of
the large one, doubles in a row.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.types.misc import CPointer
from numba.extending import intrinsic

from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel

PART = 5
"""Entries of one part."""
COPY = 3
"""Entries of one array that is written past the caches."""
LINE = 8
"""Doubles in a line of a cache."""


@intrinsic
def _doubles_at(context: Any, address: Any) -> Any:
    """Doubles at an address."""
    kind = CPointer(types.float64)

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        return b.inttoptr(a[0], ir.DoubleType().as_pointer())

    return kind(address), generate


def _tile(side: int) -> Any:
    """Slots as rows of an array: `side` consecutive ones at a time, turned over in registers."""

    @intrinsic
    def written(context: Any, array: Any, slot: Any, out: Any, first: Any, stride: Any, like: Any) -> Any:
        width = like.width

        def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
            indices = [c.cast(b, a[k], s.args[k], types.intp) for k in (1, 3, 4)]
            slots = [_slot(b, a[0], indices[0], k, width) for k in range(side)]
            for start in range(0, width - side + 1, side):
                part = [_picked(b, value, value, range(start, start + side)) for value in slots]
                for lane, row in enumerate(_turned(b, part, side)):
                    place = b.add(indices[1], b.mul(indices[2], ir.Constant(indices[2].type, start + lane)))
                    kind = ir.VectorType(ir.DoubleType(), side).as_pointer()
                    b.store(row, b.bitcast(b.gep(a[2], [place]), kind)).align = 8
            return c.get_dummy_value()

        return types.void(array, slot, out, first, stride, like), generate

    return written


def _slot(builder: Any, data: Any, first: Any, k: int, width: int) -> Any:
    """Slot first + k of a workspace."""
    index = builder.mul(builder.add(first, ir.Constant(first.type, k)), ir.Constant(first.type, width))
    kind = ir.VectorType(ir.DoubleType(), width).as_pointer()
    found = builder.load(builder.bitcast(builder.gep(data, [index]), kind))
    found.align = 8
    return found


def _picked(builder: Any, one: Any, two: Any, places: Any) -> Any:
    """Numbers of two vectors by their places in both."""
    mask = ir.Constant(ir.VectorType(ir.IntType(32), len(places)), list(places))
    return builder.shuffle_vector(one, two, mask)


def _turned(builder: Any, rows: list[Any], side: int) -> list[Any]:
    """Rows to columns: at every bit of the places, exchange across the diagonal."""
    bit = 1
    while bit < side:
        for low in range(side):
            if not low & bit:
                one, two = rows[low], rows[low | bit]
                keep = [k if not k & bit else side + (k ^ bit) for k in range(side)]
                rest = [k | bit if not k & bit else side + k for k in range(side)]
                rows[low] = _picked(builder, one, two, keep)
                rows[low | bit] = _picked(builder, one, two, rest)
        bit *= 2
    return rows


_narrow_tile, _wide_tile = _tile(4), _tile(8)


@intrinsic
def _stream(context: Any, source: Any, target: Any, place: Any) -> Any:
    """Eight doubles from one array to the same place in another, a whole line, past the caches."""

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        kind = ir.VectorType(ir.DoubleType(), LINE).as_pointer()
        found = b.load(b.bitcast(b.gep(a[0], [a[2]]), kind))
        found.align = 8
        written = b.store(found, b.bitcast(b.gep(a[1], [a[2]]), kind))
        written.align = 8 * LINE
        written.set_metadata("nontemporal", b.module.add_metadata([ir.Constant(ir.IntType(32), 1)]))
        return c.get_dummy_value()

    return types.void(source, target, place), generate


@intrinsic
def fence(context: Any) -> Any:
    """Everything written before is seen before everything written after."""

    def generate(c: Any, b: Any, s: Any, a: Any) -> Any:
        b.fence("seq_cst")
        return c.get_dummy_value()

    return types.void(), generate


@kernel
def pass_on(copies: Code, count: int, row: int, lanes: int) -> None:
    """Write the rows of one block from small arrays to large ones.

    Args:
        copies: The second table.
        count: Number of arrays.
        row: Row of the first lane.
        lanes: Number of lanes that have rows.
    """
    for k in range(count):
        at = COPY * k
        size = copies[at + 2]
        place = copies[at + 1] + 8 * row * size
        source, target, numbers = _doubles_at(copies[at]), _doubles_at(place), lanes * size
        if place % (8 * LINE) == 0 and numbers % LINE == 0:
            for j in range(0, numbers, LINE):
                _stream(source, target, j)
        else:
            for j in range(numbers):
                target[j] = source[j]


@kernel
def deliver(w: Slots, slot: int, parts: Code, count: int, row: int, lanes: int, width: int, z: Lane) -> None:
    """Write the results of one block to their rows.

    Args:
        w: The workspace.
        slot: Slot of the results.
        parts: The table.
        count: Number of parts.
        row: Row of the first lane.
        lanes: Number of lanes that have rows.
        width: Number of lanes.
        z: Zero.
    """
    for p in range(count):
        at = PART * p
        source, step, numbers, stride = slot + parts[at], parts[at + 1], parts[at + 2], parts[at + 4]
        target, first = _doubles_at(parts[at + 3]), row * stride
        if step == 0:
            value = w[source * width]
            for lane in range(lanes):
                for k in range(numbers):
                    target[first + lane * stride + k] = value
        elif lanes < width or width < 8 or numbers < 4:
            for lane in range(lanes):
                for k in range(numbers):
                    target[first + lane * stride + k] = w[(source + k * step) * width + lane]
        else:
            _turned_over(w, source, numbers, target, first, stride, z)


@kernel
def _turned_over(
    w: Slots, source: int, numbers: int, target: Slots, first: int, stride: int, z: Lane
) -> None:
    """Consecutive slots, four or eight at a time; the last tile overlaps the one before."""
    k = 0
    while numbers - k >= 8:
        _wide_tile(w, source + k, target, first + k, stride, z)
        k += 8
    if numbers == k:
        return
    if numbers >= 8 and numbers - k > 4:
        _wide_tile(w, source + numbers - 8, target, first + numbers - 8, stride, z)
        return
    while numbers - k >= 4:
        _narrow_tile(w, source + k, target, first + k, stride, z)
        k += 4
    if numbers > k:
        _narrow_tile(w, source + numbers - 4, target, first + numbers - 4, stride, z)
