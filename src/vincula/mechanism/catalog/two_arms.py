"""Two six-joint arms that carry one bar."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Contact, DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def _arm(name: str, side: int) -> list[DrawnJoint]:
    """Six joints of one arm; `side` is -1 for the left one, +1 for the right one."""
    base, shoulder, elbow, wrist = (
        (side * x, 0.0, z) for x, z in ((0.8, 0.0), (0.8, 0.4), (0.9, 0.8), (0.5, 0.6))
    )
    forearm = (wrist[0] - elbow[0], 0.0, wrist[2] - elbow[2])
    axes = (
        (base, (0, 0, 1)),
        (shoulder, (0, 1, 0)),
        (elbow, (0, 1, 0)),
        (wrist, forearm),
        (wrist, (0, 1, 0)),
        (wrist, (-side, 0, 0)),
    )
    bodies = ("ground", *(f"{name}{k}" for k in range(1, 6)), f"{name}_hand")
    return [
        Revolute(f"{name[0]}{k}", bodies[k - 1], bodies[k], at=at, axis=axis)
        for k, (at, axis) in enumerate(axes, start=1)
    ]


def build() -> Mechanism:
    """Both hands hold the ends of the bar firmly."""
    return Mechanism.spatial(
        joints=[*_arm("left", -1), *_arm("right", 1)],
        contacts=[
            Contact("grip_l", "left_hand", "bar", type="complete", at=(-0.3, 0, 0.6), normal=(1, 0, 0)),
            Contact("grip_r", "right_hand", "bar", type="complete", at=(0.3, 0, 0.6), normal=(-1, 0, 0)),
        ],
        reference=Reference("bar", origin=(0, 0, 0.6)),
        active=[f"{side}{k}" for side in "lr" for k in range(1, 7)],
        weights=Weights(),
        name="two-arms",
    )


ENTRY = Entry(
    name="two-arms",
    title="Two six-joint arms carry one bar",
    description=(
        "Both hands hold the bar firmly (complete constraints). Twelve motors, six degrees of freedom: six "
        "torque patterns only squeeze the bar. Make one arm passive (motors l1 ... l6) and the other arm "
        "follows without taking part; lock a joint and see what is lost."
    ),
    reference="cooperating arms, the setting of Bicchi and Prattichizzo 2000; the dimensions are ours",
    build=build,
)
