"""At which configurations motors are judged: one, several, or the closed points of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.errors import ClosureError, ModelError, SweepError, listing
from vincula.kernels.quantities import coordinates
from vincula.mechanism.configuration import Configuration

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.model import LinearModel
    from vincula.sweep.sweep import Sweep

MOST: Final = 10_000
"""Most configurations: one linear model each is kept in memory."""
Values = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Looked:
    """The mechanism where it is judged.

    Attributes:
        models: One linear model a configuration.
        configurations: The configurations.
        left_out: Points without a closed configuration: number (from 0) and reason.
    """

    models: tuple[LinearModel, ...]
    configurations: tuple[Configuration, ...]
    left_out: tuple[tuple[int, str], ...] = ()


def looked_at(mechanism: Mechanism, at: Values | Sequence[Values] | None) -> Looked:
    """The mechanism at one or several configurations; home when nothing is given.

    Raises:
        ClosureError: A loop is open at one of them.
        ModelError: No configuration in an empty list; a name or value that the mechanism does not have.
    """
    listed: list[Values | None] = [at] if at is None or isinstance(at, Mapping) else list(at)
    if not listed:
        raise ModelError("at is empty: give one configuration or several, or leave it out for home")
    _refuse_too_many(len(listed))
    found = tuple(mechanism.configuration(values) for values in listed)
    return Looked(tuple(mechanism.linearize(q) for q in found), found)


def looked_at_sweep(mechanism: Mechanism, sweep: Sweep) -> Looked:
    """The mechanism at every closed point of a sweep.

    The sweep has motors of its own, which drive it from point to point; what is computed here is its
    configurations only.

    Raises:
        SweepError: A sweep of another mechanism or over parameters, or no point that closes.
        ModelError: Too many points.
    """
    from vincula.sweep.sweep import Sweep

    changing = [variable.name for variable in sweep.inputs.variables if variable.kind == "parameter"]
    if changing:
        raise SweepError(
            f"the sweep changes parameters ({listing(changing)}): motors are placed on one mechanism; "
            "sweep over motors, joints or the pose of the reference member",
            kind="usage",
        )
    if coordinates(sweep.mechanism) != coordinates(mechanism):
        raise SweepError(
            f"the sweep is over {sweep.mechanism.name!r}, which has other joints than {mechanism.name!r}: "
            "give a sweep of the same mechanism",
            kind="usage",
        )
    _refuse_too_many(sweep.points.count)
    inner = Sweep(
        sweep.compiled, sweep.points, ("configuration",), given=sweep.inputs.given, start=sweep.inputs.start
    )
    reached: list[tuple[int, Any]] = []
    reasons: dict[int, str] = {}
    for chunk in range(inner.chunking.count):
        block = inner.block(chunk)
        numbers = inner.chunking.indices(chunk)
        for first, last, text in block.reasons:
            reasons |= {int(numbers[k]): text for k in range(first, last + 1)}
        reached += zip(map(int, numbers), block.arrays["configuration"], strict=True)
    return _linearized(mechanism, sorted(reached, key=lambda pair: pair[0]), reasons)


def _linearized(
    mechanism: Mechanism, reached: Sequence[tuple[int, Any]], reasons: Mapping[int, str]
) -> Looked:
    models, found = [], []
    left_out: dict[int, str] = {}
    for number, values in reached:
        if not np.isfinite(values).all():
            left_out[number] = reasons.get(number) or "no closed configuration"
            continue
        q = mechanism.home.from_flat(values)
        try:
            models.append(mechanism.linearize(q))
        except ClosureError as error:
            left_out[number] = reasons.get(number) or str(error)
        else:
            found.append(q)
    if not models:
        first = next(iter(left_out.values()), "it has no points")
        raise SweepError(f"no point of the sweep has a closed configuration; the first: {first}")
    return Looked(tuple(models), tuple(found), tuple(sorted(left_out.items())))


def _refuse_too_many(count: int) -> None:
    if count > MOST:
        raise ModelError(f"{count} configurations, at most {MOST} are judged: give fewer points")
