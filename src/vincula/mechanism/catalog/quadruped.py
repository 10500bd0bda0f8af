"""A walking robot: the trunk floats, four feet stand on the ground."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Contact, DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Free, Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights

LEGS = {"fl": (1, 1), "fr": (1, -1), "rl": (-1, 1), "rr": (-1, -1)}
"""Front or rear, left or right."""


def build() -> Mechanism:
    """A trunk 0.3 m above the ground on four legs of three joints."""
    joints: list[DrawnJoint] = [Free("float", "ground", "trunk", at=(0, 0, 0.3))]
    contacts: list[Contact] = []
    for leg, (front, left) in LEGS.items():
        hip = (0.2 * front, 0.1 * left, 0.3)
        thigh = (0.2 * front, 0.15 * left, 0.3)
        knee = (0.2 * front - 0.1, 0.15 * left, 0.15)
        foot = (0.2 * front, 0.15 * left, 0.0)
        joints += [
            Revolute(f"{leg}_roll", "trunk", f"{leg}_hip", at=hip, axis=(1, 0, 0)),
            Revolute(f"{leg}_pitch", f"{leg}_hip", f"{leg}_thigh", at=thigh, axis=(0, 1, 0)),
            Revolute(f"{leg}_knee", f"{leg}_thigh", f"{leg}_shank", at=knee, axis=(0, 1, 0)),
        ]
        contacts.append(
            Contact(f"{leg}_foot", f"{leg}_shank", "ground", type="hard-finger", at=foot, normal=(0, 0, -1))
        )
    return Mechanism.spatial(
        joints=joints,
        contacts=contacts,
        reference=Reference("trunk", origin=(0, 0, 0.3)),
        active=[joint.name for joint in joints if joint.type == "revolute"],
        weights=Weights(),
        name="quadruped",
    )


ENTRY = Entry(
    name="quadruped",
    title="Walking robot: four legs of three joints, feet on the ground",
    description=(
        "The trunk is the reference member; it floats, and its legs hang from it. Every foot holds the "
        "ground as a point with friction. Twelve motors, six degrees of freedom of the trunk, six torque "
        "patterns that only push the feet against each other. Lift a foot by leaving its contact out: its "
        "leg then swings in the air without moving the trunk."
    ),
    reference="the common four-legged robot; the dimensions are ours",
    build=build,
)
