"""What the ranks of a mechanism are in general, and how far a configuration is from losing one."""

from __future__ import annotations

import numpy as np

from vincula.kernels.quantities import WATCHED
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.samples import sample_configurations
from vincula.model import LinearModel


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
