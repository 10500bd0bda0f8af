"""Touching geoms of a simulation as contacts of the mechanism graph."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from vincula.adapters.mujoco_names import ModelNames, unused
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import ContactPart
from vincula.spatial.poses import Pose

TYPE_OF_CONDIM: Final = {1: "point", 3: "hard-finger", 4: "soft-finger", 6: "complete"}
"""Contact type by the dimension of MuJoCo's contact."""

_HALF_TURN: Final = np.diag([1.0, -1.0, -1.0])


def touching(
    model: Any, data: Any, names: ModelNames, mechanism: Mechanism, member: str
) -> tuple[list[ContactPart], list[str]]:
    """The contacts that constrain the simulation, in its order, and notes about those left out.

    The contact frame is MuJoCo's: its normal is z, from the first body into the second, which is the
    one of the second geom, or the reference member where that is touched by its first.

    Args:
        model: A `mujoco.MjModel`.
        data: Its `mujoco.MjData`, contacts computed.
        names: Names of its parts.
        mechanism: The mechanism whose home configuration is `data.qpos`.
        member: Name of the reference member.
    """
    member_group = int(model.body_weldid[names.bodies.index(member)]) if member in names.bodies else -1
    found: list[ContactPart] = []
    taken: set[str] = set()
    soft = 0
    for index in range(data.ncon):
        contact = data.contact[index]
        if int(contact.exclude) != 0:
            continue
        geoms = [int(g) for g in contact.geom]
        if min(geoms) < 0:
            soft += 1
            continue
        frame = np.array(contact.frame, dtype=float).reshape(3, 3)
        rotation = np.column_stack([frame[1], frame[2], frame[0]])
        bodies = [int(model.geom_bodyid[g]) for g in geoms]
        if int(model.body_weldid[bodies[0]]) == member_group:
            bodies.reverse()
            rotation = rotation @ _HALF_TURN
        first, second = (names.bodies[b] for b in bodies)
        name = unused(f"{names.geoms[geoms[0]]}-{names.geoms[geoms[1]]}", taken)
        taken.add(name)
        pose = Pose.at(contact.pos, rotation)
        on_first, on_second = (_on(mechanism, body, pose) for body in (first, second))
        kind = TYPE_OF_CONDIM[int(contact.dim)]
        friction = float(contact.friction[0]) if kind != "point" else None
        found.append(ContactPart(name, kind, first, second, on_first, on_second, friction))
    notes = [f"{soft} contacts of soft bodies are left out"] if soft else []
    return found, notes


def _on(mechanism: Mechanism, body: str, pose: Pose) -> Pose:
    """A pose in ground axes, in the frame of a body at home."""
    return pose if body not in mechanism.body else mechanism.body[body].pose.inverse() @ pose
