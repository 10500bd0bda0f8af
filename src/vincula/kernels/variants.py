"""Geometry by lane: one mechanism for every set of parameter values, built once, of one structure."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Mapping
from functools import cached_property
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import ModelError, UnknownNameError, listing
from vincula.mechanism.mechanism import Mechanism

if TYPE_CHECKING:
    from vincula.kernels.traced_geometry import LayOut, TracedGeometry

Builder = Callable[..., Mechanism]
"""Makes a mechanism; its keyword arguments are the parameters, and all of them have defaults."""
KEPT: Final = 256
"""Mechanisms that are kept; beyond them the ones unused longest are dropped."""


class Variants:
    """Mechanisms of one structure, by parameter values.

    Args:
        nominal: The mechanism at the default values.
        build: Makes a variant from keyword arguments; None where no parameter is declared.
    """

    def __init__(self, nominal: Mechanism, build: Builder | None) -> None:
        self.nominal, self.build = nominal, build
        self._kept: OrderedDict[tuple[tuple[str, float], ...], Mechanism] = OrderedDict()
        self._structure = _structure(nominal)
        self._traced: dict[tuple[str, ...], TracedGeometry] = {}

    @cached_property
    def defaults(self) -> Mapping[str, float]:
        """Default values of the parameters that have a number for a default."""
        return {} if self.build is None else defaults_of(self.build)

    @cached_property
    def names(self) -> tuple[str, ...] | None:
        """Names of the parameters; None when the builder takes any name."""
        return () if self.build is None else parameters_of(self.build)

    def names_checked(self, names: Mapping[str, Any]) -> None:
        """Refuse parameters that nothing can be built from.

        Raises:
            ModelError: There is no builder.
            UnknownNameError: The builder does not know a name.
        """
        if not names:
            return
        if self.build is None:
            raise ModelError(
                f"parameters {listing(names)}: the mechanism does not say how it is built from them; give "
                "vincula.compile(build), with a function of these parameters or vincula.builder(file)"
            )
        for name in names:
            if self.names is not None and name not in self.names:
                raise UnknownNameError("parameter", name, self.names)

    def at(self, values: Mapping[str, float]) -> Mechanism:
        """The mechanism with these parameter values.

        Raises:
            ModelError: It cannot be built, or its structure differs from that of the nominal mechanism.
        """
        found = self.tried(values)
        if isinstance(found, str):
            raise ModelError(found)
        return found

    def constants(
        self, program: str, lay_out: LayOut, parameters: Mapping[str, Vector], threads: int | None = None
    ) -> tuple[Matrix, NDArray[np.uint8]]:
        """Constants of a program for many sets of parameters; see `TracedGeometry.constants`.

        Args:
            program: What the program is called: formulas are kept by this name.
            lay_out: How it is laid out.
            parameters: Values by name, one a set.
            threads: Threads to use; None for one a core.
        """
        from vincula.kernels.traced_geometry import TracedGeometry

        key = (program, *parameters)
        if key not in self._traced:
            build = getattr(self.build, "outline", self.build) or (lambda **_: self.nominal)
            self._traced[key] = TracedGeometry(self.nominal, build, self.tried, lay_out, tuple(parameters))
        return self._traced[key].constants(np.column_stack(list(parameters.values())), threads)

    def tried(self, values: Mapping[str, float]) -> Mechanism | str:
        """The mechanism with these parameter values, or why these values are no geometry.

        Raises:
            ModelError: Its structure differs from that of the nominal mechanism.
        """
        if not values or self.build is None:
            return self.nominal
        key = tuple(sorted(values.items()))
        kept = self._kept.get(key)
        if kept is not None:
            return kept
        found = _built(self.build, values)
        if isinstance(found, str):
            return found
        if _structure(found) != self._structure:
            raise ModelError(
                f"with {_said(values)} the mechanism has other joints, motors or rows: parameters of a "
                "batch may change numbers only"
            )
        self._kept[key] = found
        while len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        return found


def parameters_of(build: Builder) -> tuple[str, ...] | None:
    """Names of the parameters of a builder; None when it takes any name.

    A builder may have an attribute `parameters`, names with default values; else its signature tells.
    """
    declared = getattr(build, "parameters", None)
    if isinstance(declared, Mapping):
        return tuple(declared)
    found = signature(build).parameters.values()
    if any(p.kind is Parameter.VAR_KEYWORD for p in found):
        return None
    return tuple(p.name for p in found if p.kind is not Parameter.POSITIONAL_ONLY)


def defaults_of(build: Builder) -> dict[str, float]:
    """Default values of the parameters of a builder that have a number for a default."""
    declared = getattr(build, "parameters", None)
    if not isinstance(declared, Mapping):
        declared = {name: p.default for name, p in signature(build).parameters.items()}
    return {
        n: float(v) for n, v in declared.items() if isinstance(v, (int, float)) and not isinstance(v, bool)
    }


def _built(build: Builder, values: Mapping[str, float]) -> Mechanism | str:
    """A variant, or why these values are no geometry: a length of zero, the root of a negative number."""
    bad = [name for name, value in values.items() if not math.isfinite(value)]
    if bad:
        return f"parameter {listing(bad)} is not a finite number"
    try:
        found = build(**values)
    except (ArithmeticError, ValueError) as error:
        return f"with {_said(values)} the mechanism cannot be built: {error}"
    if not isinstance(found, Mechanism):
        raise ModelError(f"build made {type(found).__name__}, expected a Mechanism")
    return found


def _said(values: Mapping[str, float]) -> str:
    return listing(f"{name} = {value:g}" for name, value in values.items())


def _structure(mechanism: Mechanism) -> tuple[Any, ...]:
    """Everything that a batch takes to be the same in all its lanes."""
    layout = mechanism.layout
    joints = tuple((j.name, j.type, j.first, j.second, j.closure) for j in mechanism.all_joints)
    contacts = tuple((c.name, c.type, c.first, c.second) for c in mechanism.contacts)
    sources = tuple(c.name for c in mechanism.couplings), tuple(d.name for d in mechanism.drives)
    reference = mechanism.reference
    seen = (reference.body, reference.axes) if reference else None
    return (mechanism.space.name, joints, contacts, sources, mechanism.active, mechanism.lock, seen,
            layout.rows, layout.columns, layout.signs.tobytes(), layout.carried.tobytes())  # fmt: skip
