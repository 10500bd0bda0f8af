"""Configurations that stand for a mechanism when it is prepared: what its ranks are in general.

They are fixed by the mechanism alone, so that everything prepared from them is the same on every machine.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vincula.errors import ClosureError
from vincula.kernels.quantities import WATCHED
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel

REACHES: Final = (0.1, 0.2, 0.3, 0.2)
"""Sizes of the random displacements from home [rad, or lengths L]."""


def sample_configurations(mechanism: Mechanism) -> tuple[Configuration, ...]:
    """A few closed configurations around home, home first if it is closed; perhaps none.

    Home itself is often special: drawn symmetric, stretched, or in a singularity.
    """
    rng = np.random.default_rng(20000)
    found = [mechanism.home] if _is_closed(mechanism, mechanism.home) else []
    for reach in REACHES:
        try:
            closed = mechanism.close(_displaced(mechanism, reach, rng), attempts=1)
        except ClosureError:
            continue
        if _is_closed(mechanism, closed):
            found.append(mechanism.home.from_flat(closed.flat))
    return tuple(found)


def general_ranks(mechanism: Mechanism) -> tuple[int, ...]:
    """Ranks of the `WATCHED` matrices away from singularities: the largest over the samples."""
    models = [mechanism.linearize(q) for q in sample_configurations(mechanism)]
    return tuple(max((model.ledger.rank(name) for model in models), default=0) for name in WATCHED)


def distances(model: LinearModel, ranks: tuple[int, ...]) -> list[float]:
    """Smallest singular values that general ranks keep, relative to the largest of all: 0 where singular.

    Args:
        model: The mechanism at one configuration.
        ranks: General ranks of the `WATCHED` matrices.
    """
    ledger = model.ledger
    scale = ledger.scale or 1.0
    values = (ledger.decision(name).singular_values for name in WATCHED)
    return [
        float(v[r - 1]) / scale if 0 < r <= len(v) else np.inf for v, r in zip(values, ranks, strict=True)
    ]


def _is_closed(mechanism: Mechanism, q: Configuration) -> bool:
    try:
        mechanism.linearize(q)
    except ClosureError:
        return False
    return True


def _displaced(mechanism: Mechanism, reach: float, rng: np.random.Generator) -> Configuration:
    """Home with every free joint displaced at random; locked axes stay."""
    values = {}
    locked = {axis.split(".")[0] for axis in mechanism.lock} | set(mechanism.lock)
    for joint, home in mechanism.home.items():
        kind = mechanism.type_of(mechanism.joint[joint])
        if joint in locked or not len(home):
            continue
        step = rng.uniform(-reach, reach, len(home))
        if kind.scalar_values:
            metres = np.array(kind.linear, dtype=bool)
            step[metres] *= mechanism.length / 3.0
        elif len(home) == 7:
            step[:3] *= mechanism.length / 3.0
        values[joint] = home + step
    return mechanism.home.replaced(values)
