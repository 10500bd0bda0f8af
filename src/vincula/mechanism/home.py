"""Another home configuration for a mechanism, everything else staying what it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vincula.mechanism.configuration import Configuration
from vincula.mechanism.parts import GROUND, Coupling, Cut, ReferenceMember
from vincula.mechanism.residuals import axis_values
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def at_home(mechanism: Mechanism, q: Configuration) -> Mechanism:
    """The same mechanism whose home configuration is q.

    Bodies stand where q puts them.  What was given relative to the old home is kept true: couplings
    keep their reference values, declared cut points stay on their bodies.
    """
    poses = mechanism.body_poses(q)
    return replace(
        mechanism,
        bodies=tuple(replace(body, pose=poses[body.name]) for body in mechanism.bodies),
        joints=tuple(replace(j, home=tuple(q[j.name])) if j.name in q else j for j in mechanism.joints),
        couplings=_anchored(mechanism),
        reference=_carried_along(mechanism, poses),
    )


def _anchored(mechanism: Mechanism) -> tuple[Coupling, ...]:
    """The couplings with the values that they refer to written out."""
    if not mechanism.couplings:
        return ()
    home = axis_values(mechanism, mechanism.home)
    return tuple(
        replace(c, references={a: home[a] for a in c.axes if a in home} | dict(c.references))
        for c in mechanism.couplings
    )


def _carried_along(mechanism: Mechanism, poses: Mapping[str, Pose]) -> ReferenceMember | None:
    """The reference member with its cut points, which are fixed on the bodies that are cut."""
    reference = mechanism.reference
    if reference is None or all(cut.at is None for cut in reference.cuts.values()):
        return reference
    moved = dict(reference.cuts)
    for cut in mechanism.reduction.cuts:
        asked = moved.get(cut.joint.name)
        body = cut.other_body
        if asked is not None and asked.at is not None and body != GROUND:
            point = mechanism.body[body].pose.inverse().apply(np.array(asked.at))
            moved[cut.joint.name] = Cut(asked.kind, tuple(map(float, poses[body].apply(point))))
    return replace(reference, cuts=moved)
