"""A planar four-bar linkage seen as a grasp: two two-joint limbs hold the coupler rigidly."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Contact, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """Two limbs of two joints each, complete constraints at the third points of the coupler."""
    return Mechanism.planar(
        joints=[
            Revolute("o1", "ground", "crank", at=(0, 0)),
            Revolute("o2", "crank", "left_end", at=(0, 1)),
            Revolute("o4", "ground", "rocker", at=(3, 0)),
            Revolute("o3", "rocker", "right_end", at=(2, 2)),
        ],
        contacts=[
            Contact("c2", "left_end", "coupler", type="complete", at=(2 / 3, 4 / 3), normal=(2, 1)),
            Contact("c3", "right_end", "coupler", type="complete", at=(4 / 3, 5 / 3), normal=(-2, -1)),
        ],
        reference=Reference("coupler", origin=(1, 1.5)),
        active=["o1"],
        weights=Weights(),
        name="four-bar-2c",
    )


ENTRY = Entry(
    name="four-bar-2c",
    title="Four-bar linkage as two two-joint limbs with complete constraints",
    description=(
        "Limbs o1, o2 and o4, o3 hold the coupler by complete constraints (firm grips); o1 is the motor, "
        "the other three joints are passive. The same linkage as four-bar-2a, where the pins at the coupler "
        "are contacts instead of joints: the same motions, forces and efficiencies."
    ),
    reference="after Bicchi and Prattichizzo 2000, Fig. 2(c); the dimensions are ours",
    build=build,
)
