"""Where parts were drawn, as it was written: the exact numbers behind typed coordinates and expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.numerics.surds import NotExactError, Surd, exactly

if TYPE_CHECKING:
    from vincula.mechanism.drawing import Place

ExactVector = tuple[Surd, ...]
"""Exact coordinates in ground axes at the drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class Written:
    """Where a joint or contact was drawn; its directions have any length.

    Attributes:
        at: Its point [m]; None where its place does not matter.
        directions: Axis and second axis of a joint, normal and line of a contact; None for those that
            it does not have.
    """

    at: Place | None
    directions: tuple[Place | None, ...]

    @property
    def point(self) -> ExactVector | None:
        """The point, exactly.

        Raises:
            NotExactError: A coordinate is not known exactly, or is given in axes of a body.
        """
        return None if self.at is None else _exact(self.at)

    @property
    def axes(self) -> tuple[ExactVector, ...]:
        """The directions that it has, exactly.

        Raises:
            NotExactError: As for `point`.
        """
        return tuple(_exact(one) for one in self.directions if one is not None)


def _exact(place: Place) -> ExactVector:
    if not isinstance(place, (Sequence, np.ndarray)):
        raise NotExactError("coordinates in axes of a body are not exact")
    return tuple(exactly(value) for value in place)
