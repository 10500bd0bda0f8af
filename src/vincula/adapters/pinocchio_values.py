"""Joint values of the mechanism graph as the configuration vector of a Pinocchio model."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from vincula.arrays import Vector


def put(joint: Any, values: Iterator[Vector], q: Vector) -> None:
    """Write the values of one joint, element by element, where Pinocchio keeps them.

    Args:
        joint: A joint model, or a part of a composite one.
        values: Values of the elements that are left, in the order of `pinocchio_joints.elements`.
        q: The configuration vector, changed in place.
    """
    kind = joint.shortname().removeprefix("JointModel")
    start, count = int(joint.idx_q), int(joint.nq)
    if kind == "Composite":
        for part in joint.extract().joints:
            put(part, values, q)
    elif kind in ("SphericalZYX", "Translation"):
        q[start : start + count] = [float(next(values)[0]) for _ in range(count)]
    elif kind in ("FreeFlyer", "Spherical"):
        *position, w, x, y, z = next(values)
        q[start : start + count] = [*position, x, y, z, w]
    elif kind == "Planar":
        x, y, angle = next(values)
        q[start : start + count] = [x, y, math.cos(angle), math.sin(angle)]
    elif kind != "Mimic" and int(joint.nv) == 1 and count == 2:
        angle = float(next(values)[0])
        q[start : start + count] = [math.cos(angle), math.sin(angle)]
    else:
        q[start : start + count] = next(values)[:count]
