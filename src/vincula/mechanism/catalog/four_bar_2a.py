"""A planar four-bar linkage seen as a grasp: two one-joint limbs hold the coupler at two points."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Contact, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """Crank and rocker as two fingers, hard-finger contacts as the coupler's pins."""
    return Mechanism.planar(
        joints=[
            Revolute("o1", "ground", "crank", at=(0, 0)),
            Revolute("o4", "ground", "rocker", at=(3, 0)),
        ],
        contacts=[
            Contact("c2", "crank", "coupler", type="hard-finger", at=(0, 1), normal=(2, 1)),
            Contact("c3", "rocker", "coupler", type="hard-finger", at=(2, 2), normal=(-2, -1)),
        ],
        reference=Reference("coupler", origin=(1, 1.5)),
        active=["o1"],
        weights=Weights(),
        name="four-bar-2a",
    )


ENTRY = Entry(
    name="four-bar-2a",
    title="Four-bar linkage as two one-joint limbs with hard-finger contacts",
    description=(
        "Crank o1 (motor) and rocker o4 (passive) hold the coupler at its two ends by point contacts with "
        "friction, which in the plane are pins. One degree of freedom. Compare four-bar-2c: the same "
        "linkage with two-joint limbs and complete constraints moves and pushes the same, although its "
        "matrices are larger."
    ),
    reference="after Bicchi and Prattichizzo 2000, Fig. 2(a); the dimensions are ours",
    build=build,
)
