"""Constants of programs for many sets of dimensions at once.

The builder is run with traced numbers, and what a program is laid out from becomes a list of formulas: one
list for every way that its comparisons come out.  Every list is compared with mechanisms that are built one
by one; where they differ, or something cannot be traced, variants are built one by one as ever.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import VinculaError
from vincula.kernels.formulas import Formulas
from vincula.kernels.twin import Twin, Untraceable
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.mechanism import Mechanism
from vincula.traced import Number, Trace

MOST_CASES: Final = 64
"""Ways that comparisons of one builder come out, of which formulas are kept."""
ROUNDING: Final = 1e-11
"""Largest difference to a mechanism built by itself, relative to one and the number: rounding."""

UNKNOWN, KNOWN, REFUSED = 0, 1, 2
"""What is known of a set of dimensions: nothing; its constants; that no mechanism can be built from it."""

LayOut = Callable[[Any], tuple[NDArray[np.int64], Sequence[Number]]]
"""Tables and constants of a program for a mechanism or its twin."""
TryBuild = Callable[[Mapping[str, float]], Mechanism | str]
UNTRACED: Final = (TypeError, AttributeError, LookupError, Untraceable)
"""What running a builder with numbers that are no floats may end in."""


@dataclass(slots=True, eq=False)
class _Case:
    """One way that all comparisons come out.

    Attributes:
        formulas: The constants, if they are known; and the comparisons.
        state: `KNOWN`, `REFUSED`, or `UNKNOWN` where something cannot be traced.
        confirmed: Whether mechanisms built by themselves said the same.
    """

    formulas: Formulas
    state: int
    confirmed: bool


class TracedGeometry:
    """Constants of one program as functions of some parameters.

    Args:
        nominal: The mechanism at default values.
        build: Makes an outline from traced parameters.
        tried: Makes a mechanism from parameters, or says why there is none.
        lay_out: Tables and constants of the program.
        names: Names of the parameters.
    """

    def __init__(
        self,
        nominal: Mechanism,
        build: Callable[..., Any],
        tried: TryBuild,
        lay_out: LayOut,
        names: Sequence[str],
    ) -> None:
        self._nominal, self._build, self._tried, self._lay_out = nominal, build, tried, lay_out
        self.names = tuple(names)
        self._cases: list[_Case] = []
        self._code, numbers = lay_out(nominal)
        self.width = len(numbers)
        self.possible = True

    def constants(self, parameters: Matrix, threads: int | None = None) -> tuple[Matrix, NDArray[np.uint8]]:
        """Constants of every set of parameters, and what is known of it; NaN where they are not known.

        Args:
            parameters: N x parameters, in the order of `names`.
            threads: Threads to use; None for one a core.
        """
        known = np.zeros(len(parameters), dtype=np.uint8)
        out: Matrix | None = None
        left = np.flatnonzero(np.isfinite(parameters).all(axis=1))
        for k in range(MOST_CASES):
            if not (len(left) and self.possible):
                break
            if k == len(self._cases):
                self._cases.append(self._case(parameters[left[0]]))
            case = self._cases[k]
            rows = parameters if len(left) == len(parameters) else parameters[left]
            found, holds = case.formulas.evaluate(rows, threads)
            if not case.confirmed:
                self._confirm(case, rows, found, holds)
            if case.state == KNOWN:
                if holds.all() and len(left) == len(parameters):
                    known[:] = KNOWN
                    return found, known
                out = np.full((len(parameters), self.width), np.nan) if out is None else out
                out[left[holds]] = found[holds]
            known[left[holds]] = case.state
            left = left[~holds]
        if not self.possible:
            out, known = None, np.zeros_like(known)
        return (np.full((len(parameters), self.width), np.nan) if out is None else out), known

    def _case(self, row: Vector) -> _Case:
        """The builder traced at one set of parameters."""
        trace = Trace()
        values = dict(zip(self.names, map(float, row), strict=True))
        try:
            code, numbers = self._lay_out(self._twin(trace, values))
        except UNTRACED:
            return _Case(Formulas.of(trace, ()), UNKNOWN, confirmed=True)
        except (ArithmeticError, ValueError):
            return _Case(Formulas.of(trace, ()), REFUSED, confirmed=False)
        if not np.array_equal(code, self._code):
            return _Case(Formulas.of(trace, ()), UNKNOWN, confirmed=True)
        return _Case(Formulas.of(trace, numbers), KNOWN, confirmed=False)

    def _twin(self, trace: Trace, values: Mapping[str, float]) -> Twin:
        outline = self._build(**trace.inputs(values))
        if not isinstance(outline, Outline):
            raise Untraceable("the parameters change nothing that is drawn")
        return Twin(self._nominal, outline, trace)

    def _confirm(self, case: _Case, rows: Matrix, found: Matrix, holds: NDArray[np.bool_]) -> None:
        """Compare with mechanisms built by themselves; where they differ nothing is traced any more."""
        places = np.flatnonzero(holds)
        ends = dict.fromkeys(places[[0, -1]].tolist()) if len(places) else {}
        case.confirmed = bool(ends) and all(self._same(case, rows[k], found[k]) for k in ends)
        self.possible = case.confirmed

    def _same(self, case: _Case, row: Vector, found: Vector) -> bool:
        variant = self._tried(dict(zip(self.names, map(float, row), strict=True)))
        if isinstance(variant, str) or case.state == REFUSED:
            return isinstance(variant, str) and case.state == REFUSED
        if not np.array_equal(variant.home.flat, self._nominal.home.flat):
            return False
        try:
            code, numbers = self._lay_out(variant)
        except VinculaError:
            return False
        own = np.array(numbers, dtype=float)
        near = np.abs(own - found) <= ROUNDING * (1.0 + np.abs(own))
        return np.array_equal(code, self._code) and bool(near.all())
