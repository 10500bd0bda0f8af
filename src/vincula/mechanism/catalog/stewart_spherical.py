"""The Stewart platform with ball joints at both ends of its legs."""

from __future__ import annotations

import numpy as np

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.catalog.stewart import PARAMETERS, leg_ends, leg_joints
from vincula.mechanism.drawing import DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Spherical
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build(alpha: float, beta: float, height: float, upper_radius: float, lower_radius: float) -> Mechanism:
    """The platform on six ball-slide-ball legs; angles in rad, lengths in m."""
    joints: list[DrawnJoint] = []
    for leg in range(1, 7):
        base, platform = leg_ends(leg, alpha, beta, height, upper_radius, lower_radius)
        joints += leg_joints(leg, base, platform)
        joints.append(Spherical(f"s{leg}", f"rod{leg}", "platform", at=platform))
    return Mechanism.spatial(
        joints=joints,
        reference=Reference("platform", origin=np.array([0.0, 0.0, height])),
        active=[f"p{leg}" for leg in range(1, 7)],
        weights=Weights(),
        name="stewart-spherical",
    )


ENTRY = Entry(
    name="stewart-spherical",
    title="Stewart platform with ball joints at the platform: six legs spin",
    description=(
        "As the example stewart, but with balls s at the platform instead of soft-finger contacts. The "
        "platform moves and pushes exactly the same; in addition every leg is free to spin about its own "
        "axis, which nobody commands and nobody feels: six passive redundancies."
    ),
    reference="a variant of Bicchi and Prattichizzo 2000, second case study",
    build=build,
    parameters=PARAMETERS,
)
