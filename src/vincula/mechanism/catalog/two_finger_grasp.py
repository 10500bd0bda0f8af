"""A planar grasp: two fingers of two joints hold a disc."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Contact, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """A disc of radius 0.5 m between two fingertips."""
    return Mechanism.planar(
        joints=[
            Revolute("l1", "ground", "left_near", at=(-0.6, 0)),
            Revolute("l2", "left_near", "left_tip", at=(-1.3, 0.7)),
            Revolute("r1", "ground", "right_near", at=(0.6, 0)),
            Revolute("r2", "right_near", "right_tip", at=(1.3, 0.7)),
        ],
        contacts=[
            Contact("c_l", "left_tip", "disc", type="hard-finger", at=(-0.5, 1.5), normal=(1, 0)),
            Contact("c_r", "right_tip", "disc", type="hard-finger", at=(0.5, 1.5), normal=(-1, 0)),
        ],
        reference=Reference("disc", origin=(0, 1.5)),
        active=["l1", "l2", "r1", "r2"],
        weights=Weights(),
        name="two-finger-grasp",
    )


ENTRY = Entry(
    name="two-finger-grasp",
    title="Planar grasp: two fingers hold a disc",
    description=(
        "Two fingers of two joints touch a disc at opposite points, with friction. Three degrees of freedom "
        "of the disc are controlled by four motors; the fourth torque pattern squeezes along the line "
        "between the contacts. With contacts of type point (no friction) the disc can slip and turn."
    ),
    reference="textbook grasp; the dimensions are ours",
    build=build,
)
