"""Closed configurations around home that stand for a mechanism in general.

They are fixed by the mechanism alone, so that everything made from them is the same on every machine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.errors import ClosureError
from vincula.mechanism.configuration import Configuration

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

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
