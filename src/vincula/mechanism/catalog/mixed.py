"""One linkage that is redundant, indeterminate and statically indeterminate at once."""

from __future__ import annotations

from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.drawing import Reference
from vincula.mechanism.drawn_joints import Revolute
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights


def build() -> Mechanism:
    """A table on three parallel cranks, pushed by a three-joint arm; a tray turns freely on the table."""
    cranks = [
        joint
        for k, x in enumerate((-1, 0, 1), start=1)
        for joint in (
            Revolute(f"g{k}", "ground", f"crank{k}", at=(x, 0)),
            Revolute(f"t{k}", f"crank{k}", "table", at=(x + 0.6, 0.8)),
        )
    ]
    arm = [
        Revolute("a1", "ground", "arm1", at=(3, 0)),
        Revolute("a2", "arm1", "arm2", at=(3.5, 1)),
        Revolute("a3", "arm2", "arm3", at=(2.5, 1.5)),
        Revolute("pin", "arm3", "table", at=(2, 0.8)),
    ]
    return Mechanism.planar(
        joints=[*cranks, *arm, Revolute("pivot", "table", "tray", at=(0.6, 1))],
        reference=Reference("tray", origin=(0.6, 1.4)),
        active=["a1", "a2", "a3"],
        weights=Weights(),
        name="mixed",
    )


ENTRY = Entry(
    name="mixed",
    title="Redundant, indeterminate and statically indeterminate at once",
    description=(
        "A table hangs on three equal parallel cranks, one more than it needs: the force that they carry "
        "against each other cannot be computed from equilibrium (statically indeterminate). An arm of three "
        "motors a1, a2, a3 pushes it through a pin, one motor more than it needs to place the pin: it can "
        "move while the table stands (redundant), and as the table has one freedom, one torque pattern only "
        "strains the linkage. On the table a tray, the reference member, turns freely about its pivot "
        "(indeterminate)."
    ),
    reference="ours",
    build=build,
)
