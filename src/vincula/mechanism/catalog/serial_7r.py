"""A redundant arm with seven revolute joints, built like a human arm."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights

SHOULDER, ELBOW, WRIST, TIP = (0, 0, 0.34), (0.24, 0, 0.66), (0.56, 0, 0.42), (0.56, 0, 0.29)
UPPER_ARM, FOREARM, HAND = (0.6, 0, 0.8), (0.8, 0, -0.6), (0, 0, -1)


def build() -> Mechanism:
    """Three shoulder axes through one point, an elbow, three wrist axes through one point."""
    axes = (
        (SHOULDER, (0, 0, 1)),
        (SHOULDER, (0, 1, 0)),
        (SHOULDER, UPPER_ARM),
        (ELBOW, (0, 1, 0)),
        (WRIST, FOREARM),
        (WRIST, (0, 1, 0)),
        (WRIST, HAND),
    )
    bodies = ("ground", *(f"link{k}" for k in range(1, 7)), "hand")
    return Mechanism.spatial(
        joints=[
            Revolute(f"j{k}", bodies[k - 1], bodies[k], at=at, axis=axis)
            for k, (at, axis) in enumerate(axes, start=1)
        ],
        reference=Reference("hand", origin=TIP),
        active=[f"j{k}" for k in range(1, 8)],
        weights=Weights(),
        name="serial-7r",
    )


ENTRY = Entry(
    name="serial-7r",
    title="Arm with seven joints: one more than the hand needs",
    description=(
        "Three shoulder axes through one point, an elbow, three wrist axes through one point, drawn with a "
        "bent elbow. The hand moves in all six directions, and one motor motion leaves it where it is: the "
        "elbow turns about the line from shoulder to wrist. One redundancy, one zero efficiency, no loop."
    ),
    reference="the common anthropomorphic arm; the dimensions are ours",
    build=build,
)
