"""Our kernels and our reference path, through the front door: `vincula.compile(...).evaluate(...)`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

import vincula as vc
from peers.cases import Array

SPECTRA = ("kinematic.efficiencies", "active_force.efficiencies")
SHARED = (*SPECTRA, "kinematic.task_directions", "kinematic.motor_directions")
"""Spectra of motions and forces with one set of axes: with unit weights both have the same."""
EVERYTHING = (*SHARED, "active_force.task_directions", "active_force.motor_directions")


@dataclass
class Ours:
    """A compiled mechanism with what it is asked for.

    Attributes:
        mechanism: The mechanism.
        quantities: What is computed.
        given: What the numbers of a configuration are: configuration, motors or reference.
        path: lanes, or reference.
    """

    mechanism: vc.Mechanism
    quantities: tuple[str, ...]
    given: str = "configuration"
    path: str = "lanes"
    compiled: Any = field(init=False)

    def __post_init__(self) -> None:
        self.compiled = vc.compile(self.mechanism)

    def run(self, numbers: Array) -> Any:
        """One batch."""
        return self.compiled.evaluate(numbers, quantities=self.quantities, given=self.given, path=self.path)

    def check(self, numbers: Array, expected: Array) -> float:
        """Largest relative difference of kinematic efficiencies; every status must be ok.

        Raises:
            RuntimeError: A configuration that is not ok.
        """
        found = self.run(numbers)
        if found.status.any():
            raise RuntimeError(f"{found.status_counts}: {found.reason(int(np.flatnonzero(found.status)[0]))}")
        return float(np.abs(found["kinematic.efficiencies"][:, : expected.shape[1]] / expected - 1.0).max())
