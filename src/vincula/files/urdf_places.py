"""Where things are in URDF files and their dialects: `<origin>` with its three ways of turning."""

from __future__ import annotations

from typing import Final

import numpy as np

from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose, rotation_from_quaternion_wxyz

_SHORTEST_QUATERNION: Final = 1e-6


def origin(element: Element, values: XmlValues, tag: str = "origin") -> Pose | None:
    """Pose of an optional `<origin>` child (identity without one); None after a problem."""
    found = next(element.find_all(tag), None)
    return Pose.identity(3) if found is None else placement(found, values)


def placement(element: Element, values: XmlValues) -> Pose | None:
    """Pose of the attributes xyz [m] with rpy [rad] or, from URDF 1.2 on, quat_xyzw; None after a problem."""
    xyz = values.numbers(element, element.get("xyz", "0 0 0"), 3, what="xyz", unit="length")
    quaternion = element.get("quat_xyzw")
    if quaternion is not None:
        q = values.numbers(element, quaternion, 4, what="quat_xyzw", unit="angle")
        if q is not None and float(np.linalg.norm(q)) < _SHORTEST_QUATERNION:
            values.problems.add(element.place, got="quat_xyzw of length zero", expected="a unit quaternion")
            q = None
        turn = None if q is None else rotation_from_quaternion_wxyz([q[3], q[0], q[1], q[2]])
    else:
        turn = values.angles(element, element.get("rpy", "0 0 0"), what="rpy")
    return None if xyz is None or turn is None else Pose.at(xyz, turn)
