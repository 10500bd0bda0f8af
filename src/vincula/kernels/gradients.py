"""Gradients of indices along the closed manifold: by motors, by all joints, by declared dimensions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.errors import ModelError, UnknownNameError, listing
from vincula.kernels.gradients_one_by_one import DISTANCE, SMOOTH
from vincula.kernels.inputs import batch_of
from vincula.kernels.many_gradients import evaluate_gradients
from vincula.kernels.quantities import Quantity

if TYPE_CHECKING:
    from vincula.kernels.compiled import CompiledMechanism


@dataclass(frozen=True, slots=True, eq=False)
class Gradient:
    """Derivatives of one quantity over a batch of configurations.

    Attributes:
        quantity: Its name.
        names: What it is differentiated by: motors, joint axes, parameters.
        values: The quantity, batch (x entries).
        gradient: Its derivatives, batch (x entries) x names; NaN where there is none.
        smooth: For every value, whether all its derivatives exist.
        reasons: Why one does not, by place in `smooth`.
    """

    quantity: str
    names: tuple[str, ...]
    values: NDArray[np.float64]
    gradient: NDArray[np.float64]
    smooth: NDArray[np.bool_]
    reasons: Mapping[tuple[int, ...], str] = field(repr=False)

    def reason(self, *index: int) -> str:
        """Why a value has no derivative; empty where it has one."""
        return self.reasons.get(tuple(index), "")


def gradient(
    compiled: CompiledMechanism,
    configurations: ArrayLike | Mapping[str, object] | None,
    quantity: str,
    *,
    wrt: str | Sequence[str] = "motors",
    parameters: Mapping[str, ArrayLike] | None = None,
) -> Gradient:
    """Exact derivatives of an index or of efficiencies at closed configurations.

    By the motors: the derivative along the closed manifold, one motor moving and the passive joints
    following.  By all joints: the covector g with d(index) = g . (joint rates) for every motion that the
    loops allow, the shortest one.  By parameters: motors stay where they are, the loops close again.

    A symmetric function of equal efficiencies (volume, isotropy) is smooth; one of several equal
    efficiencies, or an extreme among them, is not, and says so.

    Derivatives of the matrices are analytic, by motions and by dimensions; only the numbers that a builder
    draws (frames in their bodies, leads, gears, weights) are differenced, to about 1e-12.  Configurations
    that are certain are computed together, some tens to some hundreds of microseconds each; what one of
    them gives does not depend on the others.

    Args:
        compiled: The mechanism.
        configurations: (..., numbers) joint values in the order of `coordinates`; None for home.
        quantity: `<ellipsoid>.efficiencies`, `.smallest`, `.largest`, an index of it, such as
            `kinematic.condition:translation`, or `singularity.distance`.
        wrt: `motors`, `joints`, or names of parameters.
        parameters: Values of parameters, one a lane.

    Raises:
        ModelError: A quantity that has no derivatives.
        UnknownNameError: A quantity or parameter that does not exist.
        ShapeError: Arrays that do not fit.
    """
    asked = _asked(compiled, quantity)
    names = _names(compiled, wrt)
    settings = dict(parameters or {})
    compiled.variants.names_checked({**settings, **({} if isinstance(wrt, str) else dict.fromkeys(names))})
    batch = batch_of(compiled.mechanism, "configuration", configurations, None, settings)
    found = evaluate_gradients(compiled, batch, asked, wrt, names)
    shape, entries = batch.shape, asked.shape
    return Gradient(
        quantity,
        names,
        found.values.reshape((*shape, *entries)),
        found.slopes.reshape((*shape, *entries, len(names))),
        found.smooth.reshape((*shape, *entries)),
        found.reasons.reshaped((*shape, *entries)),
    )


def _asked(compiled: CompiledMechanism, name: str) -> Quantity:
    known = compiled.quantities
    if name not in known:
        raise UnknownNameError("quantity", str(name), known)
    found = known[name]
    if found.part == DISTANCE:
        return found
    of_efficiencies = found.part in ("efficiencies", "smallest", "largest")
    if found.kind is None or not (of_efficiencies or found.part in SMOOTH):
        able = ["<ellipsoid>.efficiencies", "<ellipsoid>.smallest", "<ellipsoid>.largest"]
        able += [*(f"<ellipsoid>.{index}" for index in SMOOTH), DISTANCE]
        raise ModelError(f"{name} has no derivatives here: choose {listing(able)}")
    return found


def _names(compiled: CompiledMechanism, wrt: str | Sequence[str]) -> tuple[str, ...]:
    layout = compiled.mechanism.layout
    if wrt == "motors":
        return tuple(layout.columns[k].name for k in layout.active)
    if wrt == "joints":
        return tuple(column.name for column in layout.columns)
    if isinstance(wrt, str):
        raise ModelError(f"wrt is {wrt!r}: choose motors, joints, or a list of parameters")
    return tuple(wrt)
