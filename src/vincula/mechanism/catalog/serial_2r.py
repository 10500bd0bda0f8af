"""The planar arm with two revolute joints."""

from __future__ import annotations

from vincula.elementary import cos, sin
from vincula.mechanism.catalog.entry import Entry, Parameter
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build(upper: float, fore: float, angle: float) -> Mechanism:
    """Upper arm along x, forearm turned by `angle` [rad]; lengths in m."""
    hand = (upper + fore * cos(angle), fore * sin(angle))
    return Mechanism.planar(
        joints=[
            Revolute("shoulder", "ground", "upper_arm", at=(0, 0)),
            Revolute("elbow", "upper_arm", "forearm", at=(upper, 0)),
        ],
        reference=Reference("forearm", origin=hand),
        active=["shoulder", "elbow"],
        weights=Weights(),
        name="serial-2r",
    )


ENTRY = Entry(
    name="serial-2r",
    title="Planar arm with two joints",
    description=(
        "No loop, no passive joint: the textbook arm, whose kinematic ellipsoid is Yoshikawa's J J^T. The "
        "forearm is the reference member, its end the reference point. Two efficiencies, and one wrench "
        "that costs no torque (the member has three directions, the arm two motors). Stretched out (angle "
        "0) it loses a direction."
    ),
    reference="textbook arm",
    build=build,
    parameters=(
        Parameter("upper", "1m", "length", "length of the upper arm"),
        Parameter("fore", "1m", "length", "length of the forearm"),
        Parameter("angle", "90deg", "angle", "angle of the elbow, 0 for the stretched arm"),
    ),
)
