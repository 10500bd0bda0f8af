"""The paper's second case study: the Stewart platform."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.catalog.entry import Entry, Parameter
from vincula.mechanism.catalog.shapes import THIRD, on_circle
from vincula.mechanism.drawing import Contact, DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Prismatic, Spherical
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights

PARAMETERS = (
    Parameter("alpha", "1deg", "angle", "turn of the base triangle of legs 1, 3, 5"),
    Parameter("beta", "-120deg", "angle", "turn of the base triangle of legs 2, 4, 6"),
    Parameter("height", "2m", "length", "height of the platform above the base"),
    Parameter("upper_radius", "1.5m", "length", "radius of the circle of the platform joints"),
    Parameter("lower_radius", "2m", "length", "radius of the circle of the base joints"),
)


def leg_ends(
    leg: int, alpha: float, beta: float, height: float, upper_radius: float, lower_radius: float
) -> tuple[Vector, Vector]:
    """Base and platform joint centres of leg 1 ... 6 [m].

    Platform joints coincide in pairs (1 2, 3 4, 5 6) at the vertices of a triangle; base joints of odd
    and of even legs are two triangles turned by alpha and by beta [rad].
    """
    vertex = (leg - 1) // 2 * THIRD
    turn = alpha if leg % 2 else beta
    return on_circle(lower_radius, vertex + turn, 0.0), on_circle(upper_radius, vertex, height)


def leg_joints(leg: int, base: Vector, platform: Vector) -> list[DrawnJoint]:
    """Passive ball at the base and prismatic motor of one leg."""
    return [
        Spherical(f"b{leg}", "ground", f"cylinder{leg}", at=base),
        Prismatic(f"p{leg}", f"cylinder{leg}", f"rod{leg}", axis=platform - base, at=(base + platform) / 2),
    ]


def build(alpha: float, beta: float, height: float, upper_radius: float, lower_radius: float) -> Mechanism:
    """The platform on six legs with soft-finger contacts; angles in rad, lengths in m."""
    joints: list[DrawnJoint] = []
    contacts: list[Contact] = []
    for leg in range(1, 7):
        base, platform = leg_ends(leg, alpha, beta, height, upper_radius, lower_radius)
        joints += leg_joints(leg, base, platform)
        contacts.append(
            Contact(
                f"c{leg}", f"rod{leg}", "platform", type="soft-finger", at=platform, normal=platform - base
            )
        )
    return Mechanism.spatial(
        joints=joints,
        contacts=contacts,
        reference=Reference("platform", origin=np.array([0.0, 0.0, height])),
        active=[f"p{leg}" for leg in range(1, 7)],
        weights=Weights(),
        name="stewart",
    )


ENTRY = Entry(
    name="stewart",
    title="Stewart platform, the paper's second case study",
    description=(
        "Six legs: a passive ball b at the base, a prismatic motor p, and at the platform a soft-finger "
        "contact c with its normal along the leg (it resists spin, so that no leg is free to turn about "
        "itself). Platform joints coincide in pairs at the vertices of a triangle; alpha and beta turn the "
        "two triangles of base joints. Where they are equal, legs coincide in pairs and three motions of "
        "the platform are free with all motors locked."
    ),
    reference="Bicchi and Prattichizzo 2000, second case study",
    build=build,
    parameters=PARAMETERS,
)
