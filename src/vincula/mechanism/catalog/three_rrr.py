"""The planar 3-RRR platform."""

from __future__ import annotations

import math

from vincula.mechanism.catalog.entry import Entry, Parameter
from vincula.mechanism.catalog.shapes import THIRD, elbow, on_circle
from vincula.mechanism.drawing import DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build(base_radius: float, platform_radius: float, near: float, far: float, turn: float) -> Mechanism:
    """Triangular platform on three legs of three revolute joints; lengths in m, turn in rad."""
    joints: list[DrawnJoint] = []
    for leg in (1, 2, 3):
        angle = math.pi / 2 + (leg - 1) * THIRD
        base = on_circle(base_radius, angle)
        tip = on_circle(platform_radius, angle + turn)
        joints += [
            Revolute(f"a{leg}", "ground", f"near{leg}", at=base),
            Revolute(f"b{leg}", f"near{leg}", f"far{leg}", at=elbow(base, tip, near, far)),
            Revolute(f"c{leg}", f"far{leg}", "platform", at=tip),
        ]
    return Mechanism.planar(
        joints=joints,
        reference=Reference("platform", origin=(0, 0)),
        active=["a1", "a2", "a3"],
        weights=Weights(),
        name="3rrr",
    )


ENTRY = Entry(
    name="3rrr",
    title="Planar 3-RRR parallel robot",
    description=(
        "A triangular platform on three legs with joints a (motor, at the ground), b (elbow) and c "
        "(platform). Three degrees of freedom, no redundancy. With motors a1, a2 alone the platform is "
        "loose in one direction; with all nine joints driven there are six internal torques. It is singular "
        "where the lines of the three outer links meet in one point."
    ),
    reference="textbook parallel robot; the dimensions are ours",
    build=build,
    parameters=(
        Parameter("base_radius", "2m", "length", "radius of the circle of the ground joints"),
        Parameter("platform_radius", "0.5m", "length", "radius of the circle of the platform joints"),
        Parameter("near", "1m", "length", "length of the links at the ground"),
        Parameter("far", "1m", "length", "length of the links at the platform"),
        Parameter("turn", "0deg", "angle", "turn of the platform against the ground"),
    ),
)
