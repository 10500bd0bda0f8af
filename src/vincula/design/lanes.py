"""A batch of designs at the configurations of a problem: arrays, what was reached, single models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.recipes import resolved_weights
from vincula.kernels.evaluation import DOUBTFUL, FAILED, OK, Evaluation
from vincula.kernels.plans import model_without_numbers
from vincula.weights import Quantity, Weights

if TYPE_CHECKING:
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism
    from vincula.model import LinearModel
    from vincula.numerics.metric import Metric

COUNTED: Final = ("coordinated", "indeterminacy")
"""Summary counts that every batch of designs is asked for."""


class Lanes(Mapping[str, NDArray[Any]]):
    """Quantities of designs x configurations, by name.

    Attributes:
        reached: Where there are numbers: closed and evaluated, designs x configurations.
        failed: Where the geometry cannot be built or nothing could be computed.
        doubtful: Where a rank is not decided.
        freedom: Finite kinematic efficiencies that a design has unless it lost a motion.
        usual: Summary counts of a design that is not singular.
        weights: The weights used.
    """

    def __init__(
        self,
        compiled: CompiledMechanism,
        found: Evaluation,
        parameters: Mapping[str, NDArray[np.float64]],
        freedom: int,
        usual: Mapping[str, int],
    ) -> None:
        self._compiled, self._found, self._parameters = compiled, found, parameters
        self.reached = (found.status == OK) | (found.status == DOUBTFUL)
        self.failed = found.status == FAILED
        self.doubtful = found.status == DOUBTFUL
        self.freedom, self.usual = freedom, usual
        self._empty = model_without_numbers(compiled.mechanism)
        self.weights: Weights = resolved_weights(self._empty, compiled.weights)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._found[name]

    def __iter__(self) -> Any:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    def reason(self, design: int) -> str:
        """Why the first configuration of a design that was not reached was not; empty when all were."""
        missing = np.flatnonzero(~self.reached[design])
        return self._found.reason((design, int(missing[0]))) if len(missing) else ""

    def metric(self, quantity: Quantity) -> Metric:
        """The metric of one quantity."""
        return self.weights.metric(quantity, self._empty)

    def mechanism(self, design: int) -> Mechanism:
        """The mechanism of one design."""
        values = {name: float(column[design, 0]) for name, column in self._parameters.items()}
        return self._compiled.variants.at(values)

    def configuration(self, design: int, place: int) -> Configuration:
        """The closed configuration of one design, where it was asked for as a quantity."""
        return self.mechanism(design).home.from_flat(self._found["configuration"][design, place])

    def model(self, design: int, place: int) -> LinearModel:
        """The linear model of one design at one configuration."""
        return self.mechanism(design).linearize(self.configuration(design, place))
