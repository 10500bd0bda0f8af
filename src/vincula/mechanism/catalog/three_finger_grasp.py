"""A spatial grasp: three fingers of three joints hold a ball."""

from __future__ import annotations

import numpy as np

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.catalog.shapes import THIRD, on_circle
from vincula.mechanism.drawing import Contact, DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """A ball of radius 40 mm between three fingertips, 120 mm above the palm."""
    joints: list[DrawnJoint] = []
    contacts: list[Contact] = []
    for finger in (1, 2, 3):
        turn = (finger - 1) * THIRD
        outwards = on_circle(1.0, turn, 0.0)
        across = np.cross((0.0, 0.0, 1.0), outwards)
        base = on_circle(0.06, turn, 0.0)
        joints += [
            Revolute(f"f{finger}1", "ground", f"base{finger}", at=base, axis=outwards),
            Revolute(f"f{finger}2", f"base{finger}", f"near{finger}", at=base, axis=across),
            Revolute(
                f"f{finger}3", f"near{finger}", f"tip{finger}", at=on_circle(0.09, turn, 0.06), axis=across
            ),
        ]
        contacts.append(
            Contact(
                f"c{finger}",
                f"tip{finger}",
                "ball",
                type="hard-finger",
                at=on_circle(0.04, turn, 0.12),
                normal=-outwards,
            )
        )
    return Mechanism.spatial(
        joints=joints,
        contacts=contacts,
        reference=Reference("ball", origin=(0, 0, 0.12)),
        active=[joint.name for joint in joints],
        weights=Weights(),
        name="three-finger-grasp",
    )


ENTRY = Entry(
    name="three-finger-grasp",
    title="Spatial grasp: three fingers hold a ball",
    description=(
        "Three fingers of three joints touch a ball with friction (hard-finger contacts). Nine motors "
        "control all six motions of the ball, and three torque patterns only squeeze. With two fingers the "
        "ball would be free to turn about the line between the contacts."
    ),
    reference="textbook grasp; the dimensions are ours",
    build=build,
)
