"""Couplings, and motors over several axes, as equations of closing between scalar values.

In the table one equation is: gap slot; number of terms, then value slot and coefficient (a constant) of each;
constant offset; input (-1 for none) and its factor; number of terms inside the polynomial, these terms,
their offset, number of coefficients of the polynomial and the first; number of unknowns, then unknown, rate
and inner rate (constants) of each; entries of the normal matrix; slot of the Jacobian.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from vincula.kernels.lanes.closing_order import Elimination, pair_entries
from vincula.kernels.lanes.flat_rows import scalar_value
from vincula.kernels.lanes.flatten import Builder
from vincula.mechanism.parts import Coupling
from vincula.mechanism.residuals import axis_linear, axis_values


@dataclass(slots=True)
class Scalar:
    """One equation: sum of terms + offset - input - polynomial(sum of inner terms + inner offset) = 0.

    Attributes:
        terms: Value slot and coefficient, scaled.
        offset: Constant part.
        inner: Terms inside the polynomial.
        inner_offset: Their constant part.
        polynomial: Coefficients, scaled with the equation.
        signs: Unknown -> (rate, inner rate), scaled.
        source: Index of the input that is taken off; -1 for none.
        factor: What the input is multiplied by.
    """

    terms: list[tuple[int, float]] = field(default_factory=list)
    offset: float = 0.0
    inner: list[tuple[int, float]] = field(default_factory=list)
    inner_offset: float = 0.0
    polynomial: list[float] = field(default_factory=list)
    signs: dict[int, tuple[float, float]] = field(default_factory=dict)
    source: int = -1
    factor: float = 1.0


def scalars_of(
    builder: Builder, given: str, unknown: Mapping[str, int], drive_inputs: Mapping[str, int]
) -> list[Scalar]:
    """Equations of couplings, and of motors over several axes whose positions are given."""
    mechanism = builder.mechanism
    linear = axis_linear(mechanism)
    scalar = axis_values(mechanism, mechanism.home)
    found = []
    for coupling in mechanism.couplings:
        # Couplings of axes without a scalar value bind rates only.
        if set(coupling.axes) <= set(scalar):
            size = 1.0 / builder.length if any(linear[axis] for axis in coupling.rates) else 1.0
            found.append(_coupling(builder, coupling, size, unknown))
    if given == "motors":
        for drive in mechanism.drives:
            if drive.name in drive_inputs:
                in_metres = any(linear[axis] for axis in drive.drives)
                size = 1.0 / builder.length if in_metres else 1.0
                still = Coupling(drive.name, dict(drive.drives), references=dict.fromkeys(drive.drives, 0.0))
                equation = _coupling(builder, still, size, unknown)
                equation.source, equation.factor = drive_inputs[drive.name], size
                found.append(equation)
    return found


def _coupling(builder: Builder, coupling: Coupling, size: float, unknown: Mapping[str, int]) -> Scalar:
    result = Scalar(polynomial=[size * float(a) for a in coupling.polynomial])
    for axis, coefficient in coupling.rates.items():
        slot, unit, reference = scalar_value(builder, coupling, axis)
        result.terms.append((slot, size * coefficient * unit))
        result.offset -= size * coefficient * reference
        _rate(result, unknown, axis, size * coefficient * unit, 0.0)
    for axis, coefficient in coupling.driver.items():
        slot, unit, reference = scalar_value(builder, coupling, axis)
        result.inner.append((slot, coefficient * unit))
        result.inner_offset -= coefficient * reference
        _rate(result, unknown, axis, 0.0, coefficient * unit)
    return result


def _rate(result: Scalar, unknown: Mapping[str, int], axis: str, rate: float, inner: float) -> None:
    if axis in unknown:
        before = result.signs.get(unknown[axis], (0.0, 0.0))
        result.signs[unknown[axis]] = before[0] + rate, before[1] + inner


def scalar_table(
    builder: Builder, scalars: list[Scalar], gap: int, pattern: Elimination, place: Mapping[int, int]
) -> list[int]:
    """The table of all equations; their gaps begin at slot `gap`."""
    numbers = [len(scalars)]
    for k, one in enumerate(scalars):
        numbers += [gap + k, len(one.terms)]
        for slot, coefficient in one.terms:
            numbers += [slot, builder.constant(coefficient)]
        source = -1 if one.source < 0 else one.source
        numbers += [builder.constant(one.offset), source, builder.constant(one.factor), len(one.inner)]
        for slot, coefficient in one.inner:
            numbers += [slot, builder.constant(coefficient)]
        numbers += [
            builder.constant(one.inner_offset),
            len(one.polynomial),
            builder.constant(*one.polynomial),
        ]
        columns = sorted((place[unknown], *rates) for unknown, rates in one.signs.items())
        numbers.append(len(columns))
        for column, rate, inner in columns:
            numbers += [column, builder.constant(rate), builder.constant(inner)]
        numbers += pair_entries([column for column, _, _ in columns], pattern)
        numbers.append(builder.slot(len(columns)))
    return numbers
