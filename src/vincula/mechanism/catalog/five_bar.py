"""The paper's first case study: the planar five-bar linkage."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Cut
from vincula.weights import Weights


def build() -> Mechanism:
    """The five-bar with motors at both ground joints and the paper's cut points."""
    return Mechanism.planar(
        joints=[
            Revolute("o1", "ground", "crank", at=(-1, -2)),
            Revolute("o2", "crank", "coupler", at=(-1, 0)),
            Revolute("o3", "coupler", "link", at=(0, 0)),
            Revolute("o4", "link", "rocker", at=(1, -1)),
            Revolute("o5", "rocker", "ground", at=(1, -2)),
        ],
        reference=Reference(
            "coupler",
            origin=(-0.5, 0),
            cuts={"o2": Cut("kept", at=(-2 / 3, 0)), "o3": Cut("kept", at=(-1 / 3, 0))},
        ),
        active=["o1", "o5"],
        weights=Weights(),
        name="five-bar",
    )


ENTRY = Entry(
    name="five-bar",
    title="Planar five-bar linkage, the paper's first case study",
    description=(
        "Five revolute joints o1 ... o5; the coupler between o2 and o3 is the reference member. Two degrees "
        "of freedom. Compare motors o1,o5 (fast), o2,o4 (strong) and all five (three ways to squeeze): the "
        "same linkage is three different machines. The coupler is cut at (-2/3, 0) and (-1/3, 0), where the "
        "paper puts its two complete constraints, because internal forces depend on the cut."
    ),
    reference="Bicchi and Prattichizzo 2000, first case study",
    build=build,
)
