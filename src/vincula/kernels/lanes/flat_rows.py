"""Rows, columns, couplings and gaps of a mechanism as tables: see `tables`."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.elementary import hypot
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.flatten import Builder, Unsupported
from vincula.mechanism.parts import ContactPart, Coupling, Joint
from vincula.mechanism.residuals import axis_linear
from vincula.spatial.selectors import contact_components


def add_rows(builder: Builder) -> None:
    """Tables of columns, row blocks and rows."""
    order = [*builder.layout.active, *builder.layout.passive]
    directions: list[int] = []
    columns: list[int] = []
    for column in order:
        columns += _column(builder, int(column), directions)
    blocks, rows, signs = _geometric_blocks(builder, order, directions)
    polynomials: list[int] = []
    _scalar_blocks(builder, order, blocks, rows, signs, polynomials)
    builder.code[t.BLOCKS] = len(blocks) // t.BLOCK_ENTRY
    builder.table(t.COLUMN, columns)
    builder.table(t.BLOCK, blocks)
    builder.table(t.ROW, rows)
    builder.table(t.SIGN, signs)
    builder.table(t.DIRECTIONS, [len(directions) // t.DIRECTION_ENTRY, *directions])
    builder.table(t.POLYNOMIAL, polynomials)


def _column(builder: Builder, column: int, directions: list[int]) -> list[int]:
    """Entry of one column."""
    screws = builder.layout.screws
    frame, centre = int(screws.frame[column]), int(screws.centre[column])
    if frame == 0:
        return [0, 0, 0, 0, -1]
    axis, turn, slide = screws.axis[column], float(screws.turn[column]), float(screws.slide[column])
    if len(axis) == 2:
        axis = np.array([*axis, 0.0]) if not turn else np.array([0.0, 0.0, 1.0])
    slot = builder.slot_of[frame]
    unit = _unit_axis(axis)
    if unit < 0:
        slot = _direction(builder, directions, t.FIXED_DIRECTION, slot, axis)
    if not slide or (slide == 1.0 and not turn):
        advance = -2 if slide else -1
    else:
        advance = builder.constant(slide / builder.length)
    return [slot, builder.slot_of[centre], unit, int(turn), advance]


def _direction(builder: Builder, directions: list[int], kind: int, frame: int, *vectors: Vector) -> int:
    """First slot of a direction made once a configuration."""
    target = builder.slot(3 * len(vectors))
    first = builder.constant(*(number for vector in vectors for number in vector))
    directions += [kind, target, frame, first, 0]
    return target


def _unit_axis(axis: Vector) -> int:
    """Index of the frame axis that a vector is, -1 if none."""
    found = [k for k in range(3) if np.array_equal(axis, np.eye(3)[k])]
    return found[0] if found else -1


def _geometric_blocks(
    builder: Builder, order: list[int], directions: list[int]
) -> tuple[list[int], list[int], list[int]]:
    """Blocks of rows that share frame, point and signs."""
    layout = builder.layout
    blocked, count = layout.blocked, len(layout.blocked.frame)
    blocks: list[int] = []
    rows: list[int] = []
    signs: list[int] = []
    start = 0
    for row in range(count):
        rows += _row(builder, row, directions)
        last = row + 1 == count or layout.rows[row + 1].source != layout.rows[row].source
        if last or layout.rows[row + 1].kind != layout.rows[row].kind:
            point = int(blocked.point[row])
            slot = builder.slot_of[point] if point else -1
            blocks += [start, row + 1 - start, slot, int(layout.carried[row]), t.GEOMETRY]
            signs += [int(layout.signs[row, column]) for column in order]
            start = row + 1
    return blocks, rows, signs


def _row(builder: Builder, row: int, directions: list[int]) -> list[int]:
    """Entry of one row from geometry."""
    blocked = builder.layout.blocked
    frame = int(blocked.frame[row])
    push, turn = blocked.push[row], blocked.turn[row]
    if len(push) == 2:
        push, turn = np.array([*push, 0.0]), np.array([0.0, 0.0, *turn])
    for of_row, other, axis in blocked.across:
        if of_row == row:
            target = builder.slot(6)
            first = builder.constant(*axis)
            directions += [
                t.COMMON_NORMAL, target, builder.slot_of[frame], first, builder.slot_of[int(other)]
            ]  # fmt: skip
            return [t.GENERAL, target, 0]
    ground = frame == 0
    if not turn.any() and _unit_axis(push) >= 0:
        kind = t.PUSH_GROUND if ground else t.PUSH_FRAME
        return [kind, 0 if ground else builder.slot_of[frame], _unit_axis(push)]
    if not push.any() and _unit_axis(turn) >= 0:
        kind = t.TURN_GROUND if ground else t.TURN_FRAME
        return [kind, 0 if ground else builder.slot_of[frame], _unit_axis(turn)]
    scaled = turn / builder.length if push.any() else turn
    return [t.GENERAL, _direction(builder, directions, t.FIXED_ROW, builder.slot_of[frame], push, scaled), 0]


def _scalar_blocks(
    builder: Builder,
    order: list[int],
    blocks: list[int],
    rows: list[int],
    signs: list[int],
    polynomials: list[int],
) -> None:
    """One block for every coupling and drive; its signs are the coefficients' constants plus one, or 0."""
    layout, length = builder.layout, builder.length
    first = len(layout.blocked.frame)
    curved = dict(layout.polynomials)
    sizes = np.array([length if column.linear else 1.0 for column in layout.columns])
    for k, coefficients in enumerate(layout.constant):
        factor = 1.0 / length if layout.rows[first + k].linear else 1.0
        kind = t.CURVED if k in curved else t.LINEAR
        blocks += [first + k, 1, -1, 0, kind]
        rows += [0, 0, 0]
        scaled = coefficients * factor * sizes
        if kind == t.LINEAR:
            signs += [builder.constant(scaled[c]) + 1 if scaled[c] else 0 for c in order]
        else:
            signs += _polynomial(builder, curved[k], factor, sizes, order, polynomials)
    polynomials.insert(0, len(curved))


def _polynomial(
    builder: Builder,
    coupling: Coupling,
    factor: float,
    sizes: Vector,
    order: list[int],
    polynomials: list[int],
) -> list[int]:
    """Entry of a polynomial coupling: slot of its slope, axes of the driver, derivative; and its signs.

    Every sign points at two constants: the rate's coefficient and the driver's, times the slope.
    """
    layout = builder.layout
    slot = builder.slot(1)
    derivative = np.polynomial.polynomial.polyder(list(coupling.polynomial) or [0.0])
    entry = [slot, len(coupling.driver)]
    for axis, coefficient in coupling.driver.items():
        value, size, reference = scalar_value(builder, coupling, axis)
        entry += [value, builder.constant(coefficient * size, coefficient * reference)]
    entry += [len(derivative), builder.constant(*derivative)]
    polynomials += entry
    index = layout.index
    of_column = {index[axis]: axis for axis in coupling.axes if axis in index}
    signs = []
    for c in order:
        if c not in of_column:
            signs.append(0)
            continue
        axis, scale = of_column[c], factor * float(sizes[c])
        pair = scale * coupling.rates.get(axis, 0.0), -scale * coupling.driver.get(axis, 0.0)
        signs.append(builder.constant(*pair) + 1)
    return signs


def scalar_value(builder: Builder, coupling: Coupling, axis: str) -> tuple[int, float, float]:
    """Value slot of an axis, its unit (the length for metres), and the coupling's reference value."""
    mechanism = builder.mechanism
    for joint in mechanism.all_joints:
        kind = mechanism.type_of(joint)
        names = kind.axis_names(joint.name)
        if axis in names and kind.scalar_values and joint.name in builder.value_of:
            at = names.index(axis)
            home = float(mechanism.home[joint.name][at])
            size = builder.length if kind.linear[at] else 1.0
            slot = builder.code[t.VALUE_SLOT] + builder.value_of[joint.name] + at
            return slot, size, float(coupling.references.get(axis, home))
    raise Unsupported(f"coupling {coupling.name!r}: axis {axis!r} has no scalar value")


# Gaps -----------------------------------------------------------------------------------------------


def add_gaps(builder: Builder) -> None:
    """Table of everything that can be open."""
    mechanism = builder.mechanism
    tree = {joint.name for joint, _ in mechanism.tree}
    gaps: list[int] = []
    for joint in mechanism.all_joints:
        if joint.name not in tree:
            gaps += _joint_gap(builder, joint)
    for contact in mechanism.contacts:
        gaps += _contact_gap(builder, contact)
    gaps += _coupling_gaps(builder)
    builder.table(t.GAPS, [len(gaps) // t.GAP_ENTRY, *gaps])
    explicit = [builder.layout.frames.of_joint[joint.name] for joint in mechanism.joints]
    known = [builder.slot_of.get(k, builder.aliases.get(k)) for k in explicit]
    found = [slot for slot in known if slot is not None and slot >= 0]
    builder.table(t.REACH, [len(found), *found])


def _joint_gap(builder: Builder, joint: Joint) -> list[int]:
    index = builder.layout.frames.of_joint[joint.name]
    kind = builder.mechanism.type_of(joint)
    first, second = builder.frame(index), builder.frame(index + 1)
    if not joint.closure:
        wanted = builder.copy(first)
        builder.tape.extend(builder.motion(joint, wanted, 1))
        return [t.WHOLE_POSE, wanted, second, 63, 0]
    if "H" in kind.steps:
        raise Unsupported(f"closure {joint.name!r} is a screw: its turns are counted by the reference path")
    moving = {"xyz".index(step[1]) for step in kind.steps if step[0] == "T"}
    pushes = sum(1 << k for k in range(builder.mechanism.space.translations) if k not in moving)
    turning = [step for step in kind.steps if step[0] != "T"]
    if "S" in turning or (kind.planar and turning):
        return [t.TURNED, first, second, pushes, 0]
    if kind.planar:
        return [t.TURNED, first, second, pushes | 32, 0]
    if len(turning) == 2:
        return [t.BEYOND, first, second, pushes, _beyond(builder, joint.second_axis)]
    return [t.TILTED if turning else t.TURNED, first, second, pushes | (0 if turning else 56), 0]


def _beyond(builder: Builder, axis: Vector) -> int:
    """An axis of B, the cosine of its drawn angle to z of A, and one over the sine."""
    return builder.constant(*axis, axis[2], 1.0 / hypot(axis[0], axis[1]))


def _contact_gap(builder: Builder, contact: ContactPart) -> list[int]:
    space = builder.mechanism.space
    index = builder.layout.frames.of_contact[contact.name]
    first, second = builder.frame(index), builder.frame(index + 1)
    components = contact_components(contact.type, space)
    # In the plane the turn is about z, the sixth component in space.
    turn = 5 if space.dimension == 3 else 3
    mask = sum(1 << (k if k < space.translations else k - space.translations + turn) for k in components)
    if contact.type == "line":
        return [t.BEYOND, first, second, mask & 7, _beyond(builder, np.array([1.0, 0.0, 0.0]))]
    return [t.TURNED, first, second, mask, 0]


def _coupling_gaps(builder: Builder) -> list[int]:
    """Couplings whose axes all have values."""
    mechanism = builder.mechanism
    linear = axis_linear(mechanism)
    gaps: list[int] = []
    for coupling in mechanism.couplings:
        if not all(_has_value(builder, axis) for axis in coupling.axes):
            continue
        in_metres = any(linear[axis] for axis in coupling.rates)
        terms: list[int] = []
        for part in (coupling.rates, coupling.driver):
            terms.append(len(part))
            for axis, coefficient in part.items():
                value, size, reference = scalar_value(builder, coupling, axis)
                terms += [value, builder.constant(coefficient * size, coefficient * reference)]
        polynomial = list(coupling.polynomial) or [0.0]
        terms += [len(polynomial), builder.constant(*polynomial)]
        factor = builder.constant(1.0 / builder.length if in_metres else 1.0)
        place = len(builder.code)
        builder.code.extend(terms)
        gaps += [t.BALANCE, place, factor, 0, 0]
    return gaps


def _has_value(builder: Builder, axis: str) -> bool:
    mechanism = builder.mechanism
    return any(
        axis in mechanism.type_of(joint).axis_names(joint.name)
        and mechanism.type_of(joint).scalar_values
        and not joint.closure
        for joint in mechanism.all_joints
    )
