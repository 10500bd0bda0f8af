"""The Delta robot: three motors, a platform that only translates."""

from __future__ import annotations

import numpy as np

from vincula.elementary import cos, sin, sqrt
from vincula.errors import ModelError
from vincula.mechanism.catalog.entry import Entry, Parameter
from vincula.mechanism.catalog.shapes import THIRD, on_circle
from vincula.mechanism.drawing import DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Revolute, Spherical, Universal
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build(
    base_radius: float, platform_radius: float, arm: float, rod: float, width: float, angle: float
) -> Mechanism:
    """Platform below the base, symmetric pose; lengths in m, angle in rad."""
    reach = base_radius + arm * cos(angle) - platform_radius
    if not rod > abs(reach):
        raise ModelError(f"rods of {rod:g} m do not bridge {abs(reach):g} m: make them longer")
    drop = arm * sin(angle) + sqrt(rod**2 - reach**2)
    joints: list[DrawnJoint] = []
    for leg in (1, 2, 3):
        turn = (leg - 1) * THIRD
        across = np.array([-sin(turn), cos(turn), 0.0])
        elbow = on_circle(base_radius + arm * cos(angle), turn, -arm * sin(angle))
        wrist = on_circle(platform_radius, turn, -drop)
        joints.append(
            Revolute(f"a{leg}", "ground", f"arm{leg}", at=on_circle(base_radius, turn, 0.0), axis=across)
        )
        for side, offset in (("l", 0.5 * width * across), ("r", -0.5 * width * across)):
            name = f"{leg}{side}"
            hinge = (across, np.cross(across, wrist - elbow))
            joints += [
                Universal(f"u{name}", f"arm{leg}", f"rod{name}", at=elbow + offset, axes=hinge),
                Spherical(f"s{name}", f"rod{name}", "platform", at=wrist + offset),
            ]
    return Mechanism.spatial(
        joints=joints,
        reference=Reference("platform", origin=(0, 0, -drop)),
        active=["a1", "a2", "a3"],
        weights=Weights(),
        name="delta",
    )


ENTRY = Entry(
    name="delta",
    title="Delta robot: three arms, six rods, a platform that only translates",
    description=(
        "Each arm, turned by its motor a, carries a parallelogram of two rods: universal joint u at the "
        "arm, ball s at the platform (two balls would let every rod spin). The parallelograms keep the "
        "platform from turning: three degrees of freedom, all of them translations, and three moments on "
        "the platform that cost no motor torque. Its loops are full of passive joints, none of which is "
        "redundant."
    ),
    reference="Clavel 1988, the Delta robot; the dimensions are ours",
    build=build,
    parameters=(
        Parameter("base_radius", "0.2m", "length", "radius of the circle of the motors"),
        Parameter("platform_radius", "0.06m", "length", "radius of the circle of the platform joints"),
        Parameter("arm", "0.2m", "length", "length of the arms"),
        Parameter("rod", "0.5m", "length", "length of the rods"),
        Parameter("width", "0.1m", "length", "distance of the two rods of a parallelogram"),
        Parameter("angle", "30deg", "angle", "angle of the arms below the horizontal"),
    ),
)
