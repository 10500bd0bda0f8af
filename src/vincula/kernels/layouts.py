"""What programs take from a mechanism: tables, which are structure, and constants, which are dimensions.

The same functions serve a mechanism and its `Twin` with traced numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.kernels.twin import Twin, Untraceable
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Precision
from vincula.numerics.rank import rounding_unit
from vincula.traced import Number

if TYPE_CHECKING:
    from vincula.kernels.lane_path import LanePath

Laid = tuple[NDArray[np.int64], Sequence[Number]]
"""Tables and constants."""


def spectra_layout(path: LanePath) -> Callable[[Any], Laid]:
    """How the program of a path is laid out for other dimensions.

    Args:
        path: The path, with a general program.
    """
    from vincula.kernels.lanes import tables as t
    from vincula.kernels.lanes.flatten import Unsupported, flatten

    program = path.program
    code, numbers = program.code, program.constants
    metric, doubt = int(code[t.METRIC]), int(code[t.DOUBT])

    def laid(mechanism: Mechanism | Twin) -> Laid:
        if isinstance(mechanism, Mechanism):
            if not path.same_weights(mechanism):
                raise Unsupported("other weights")
            return program.flat.code, program.constants_of(mechanism, path.program_weights).tolist()
        if path.given_weights is None and repr(mechanism.weights) != repr(path.mechanism.weights):
            raise Untraceable("other weights")
        flat = flatten(mechanism, general=True)  # type: ignore[arg-type]
        if not np.array_equal(flat.code, program.flat.code):
            raise Untraceable("other tables")
        own = _metric(path, mechanism, numbers[metric:doubt])
        relative = _relative(mechanism)
        return flat.code, [*flat.constants, *own, relative, *numbers[doubt + 1 :]]

    return laid


def _metric(path: LanePath, twin: Twin, nominal: Vector) -> list[Number]:
    """Factors of the metrics: those of the nominal mechanism in units of another characteristic length."""
    from vincula.kernels.lanes.metrics import APART

    layout, space = path.mechanism.layout, path.mechanism.space
    linear = [layout.columns[k].linear for k in layout.active]
    linear += [k < space.translations for k in range(space.dimension)]
    count = len(linear)
    share = path.mechanism.length / twin.length
    _guard_spread(1.0 / nominal[:count], np.array(linear), share, APART)
    own: list[Number] = [x * share if flag else x for x, flag in zip(nominal, linear, strict=False)]
    return [*own, *nominal[count:]]


def _guard_spread(sizes: Vector, linear: NDArray[np.bool_], share: Number, most: float) -> None:
    """Refuse, for lengths in other units, what the nominal program would refuse."""
    metres, others = sizes[linear], sizes[~linear]
    if not (len(metres) and len(others)):
        return
    if not (metres.max() <= most * others.min() * share and others.max() * share <= most * metres.min()):
        raise Untraceable("weights of very different size")


def _relative(twin: Twin) -> Number:
    """Relative uncertainty of the matrices, as `metrics.doubt_constants` takes it."""
    layout = twin.layout
    known: Precision = twin.precision
    doubt: Number = rounding_unit(len(layout.rows), len(layout.columns) + twin.space.dimension)
    doubt = doubt + (known.digits_length / twin.length + known.digits_angle)
    return doubt + (known.tolerance_length / twin.length + known.tolerance_angle)


def closing_layout(given: Literal["motors", "reference"]) -> Callable[[Any], Laid]:
    """How closing is laid out for other dimensions: tables; constants, then scales of values and inputs.

    Args:
        given: What is given.
    """
    from vincula.kernels.lanes.closing_flat import closing_arrays

    def laid(mechanism: Mechanism | Twin) -> Laid:
        arrays = closing_arrays(mechanism, given, general=True)  # type: ignore[arg-type]
        numbers = [*arrays.constants, *arrays.value_scale, *arrays.input_scale]
        return np.concatenate([arrays.code, arrays.plan]), numbers

    return laid
