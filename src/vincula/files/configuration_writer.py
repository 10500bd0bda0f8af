"""A configuration in the units of a file, as CONFIG files and texts hold it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from vincula.arrays import Vector
from vincula.files.units import SI, Units

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def configuration_values(
    q: Mapping[str, Vector], mechanism: Mechanism, units: Units = SI
) -> dict[str, float | list[float]]:
    """Values by joint, one number or a list, that `read_configuration` reads back.

    Args:
        q: The configuration [m, rad].
        mechanism: The mechanism that it belongs to; joints without values are left out.
        units: Units of the file that the numbers are for.
    """
    result: dict[str, float | list[float]] = {}
    for joint in mechanism.all_joints:
        if joint.name not in q or len(q[joint.name]) == 0:
            continue
        kind = mechanism.type_of(joint)
        values = [float(value) for value in q[joint.name]]
        plain = len(values) if kind.scalar_values else len(values) - 4
        for k in range(plain):
            values[k] /= units.size(kind.value_linear[k])
        result[joint.name] = values[0] if len(values) == 1 else values
    return result


def configuration_text(values: Mapping[str, float | list[float]]) -> str:
    """`name=value,...`, names with a comma, a blank or an equals sign in quotes."""
    parts = []
    for name, value in values.items():
        quoted = f'"{name}"' if any(mark in name for mark in ",= '") else name
        shown = f"[{','.join(map(repr, value))}]" if isinstance(value, list) else repr(value)
        parts.append(f"{quoted}={shown}")
    return ",".join(parts)
