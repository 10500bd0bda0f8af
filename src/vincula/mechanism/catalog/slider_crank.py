"""The slider-crank: one motor, one loop, a sliding joint."""

from __future__ import annotations

import numpy as np

from vincula.elementary import cos, sin, sqrt
from vincula.errors import ModelError
from vincula.mechanism.catalog.entry import Entry, Parameter
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Prismatic, Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build(crank: float, rod: float, angle: float) -> Mechanism:
    """Crank at the origin, slider on the x axis; lengths in m, angle in rad."""
    pin = np.array([crank * cos(angle), crank * sin(angle)])
    if not rod > abs(pin[1]):
        raise ModelError(
            f"a rod of {rod:g} m does not reach the slide {abs(pin[1]):g} m away: make it longer"
        )
    slider = np.array([pin[0] + sqrt(rod**2 - pin[1] ** 2), 0.0])
    return Mechanism.planar(
        joints=[
            Revolute("o1", "ground", "crank", at=(0, 0)),
            Revolute("o2", "crank", "rod", at=pin),
            Revolute("o3", "rod", "slider", at=slider),
            Prismatic("slide", "ground", "slider", axis=(1, 0), at=slider),
        ],
        reference=Reference("slider", origin=slider),
        active=["o1"],
        weights=Weights(),
        name="slider-crank",
    )


ENTRY = Entry(
    name="slider-crank",
    title="Slider-crank: a crank drives a slider through a rod",
    description=(
        "The motor o1 turns the crank, the slider is the reference member. One degree of freedom; two "
        "wrenches on the slider (across the slide, and a moment) cost no torque. At angle 0 and at 180deg "
        "the crank is at a dead centre: the slider stands still while the motor turns, and resists any "
        "force. Drive the slide instead of o1 and the same positions become singular the other way round."
    ),
    reference="textbook linkage; the dimensions are ours",
    build=build,
    parameters=(
        Parameter("crank", "1m", "length", "length of the crank"),
        Parameter("rod", "2.5m", "length", "length of the rod"),
        Parameter("angle", "60deg", "angle", "angle of the crank from the slide"),
    ),
)
