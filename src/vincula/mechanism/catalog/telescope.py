"""The smallest mechanism with one direction common to motors, passive joints and member."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Prismatic
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """Two slides in line, the first one driven."""
    return Mechanism.planar(
        joints=[
            Prismatic("driven", "ground", "tube", axis=(1, 0), at=(0, 0)),
            Prismatic("slack", "tube", "rod", axis=(1, 0), at=(1, 0)),
        ],
        reference=Reference("rod", origin=(2, 0)),
        active=["driven"],
        weights=Weights(),
        name="telescope",
    )


ENTRY = Entry(
    name="telescope",
    title="Telescope with one driven and one slack slide: the case t = 1",
    description=(
        "The motor moves the tube, the rod slides in it freely in the same direction. So the motor is "
        "without effect (redundant: the slack slide takes it up) and the rod is loose (indeterminate), both "
        "by the same direction, which motors, passive joints and member have in common. This is where the "
        "seven blocks of eq. (5) do not add up: its count of motions in which all three must move would be "
        "-1; the twelve counts have t = 1."
    ),
    reference="ours; the degenerate case of Bicchi and Prattichizzo 2000, eq. (5)",
    build=build,
)
