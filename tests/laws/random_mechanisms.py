"""Random mechanisms of every shape, drawn in place and therefore closed.

In the plane and in space: one to six limbs with joints and contacts of every type, limbs that branch,
inner loops, legs that hang from the member and stand on the ground or swing in the air, second
objects, locked axes, couplings and drives.  Points and directions are reused now and then, so that
parallel axes and common centres occur.  A `Drawn` is still in drawn parts: laws change it (turn it,
mirror it, swap a joint) and then make the mechanism.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

import vincula as vc
from vincula.arrays import Vector
from vincula.mechanism.drawing import DrawnJoint
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import ALL, Coupling, Cut, Drive
from vincula.spatial.selectors import CONTACT_TYPES
from vincula.spatial.space import PLANAR, SPATIAL, Space

MEMBER = "member"
COUNT = 300
"""Random mechanisms that every law is held on."""

_SPATIAL_JOINTS = {
    "revolute": 0.34, "prismatic": 0.14, "screw": 0.08, "cylindrical": 0.09, "universal": 0.11,
    "spherical": 0.12, "planar": 0.06, "fixed": 0.03, "free": 0.03,
}  # fmt: skip
_PLANAR_JOINTS = {"revolute": 0.65, "prismatic": 0.27, "fixed": 0.05, "free": 0.03}
_WAYS = {"limb": 0.6, "branch": 0.12, "inner": 0.12, "leg": 0.12, "air": 0.04}


@dataclass(frozen=True)
class Drawn:
    """A mechanism in drawn parts, with everything that belongs to it."""

    space: Space
    joints: tuple[DrawnJoint, ...]
    contacts: tuple[vc.Contact, ...]
    bodies: tuple[vc.Body, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    drives: tuple[Drive, ...] = ()
    active: tuple[str, ...] = ()
    lock: tuple[str, ...] = ()
    origin: Vector = field(default_factory=lambda: np.zeros(3))
    cuts: Mapping[str, Cut] = field(default_factory=dict)
    member: str = MEMBER

    def mechanism(self, **changes: Any) -> Mechanism:
        """The mechanism, with some fields changed."""
        if changes:
            return replace(self, **changes).mechanism()
        make = Mechanism.planar if self.space is PLANAR else Mechanism.spatial
        return make(
            joints=self.joints,
            contacts=self.contacts,
            bodies=self.bodies,
            couplings=self.couplings,
            drives=self.drives,
            active=self.active,
            lock=self.lock,
            reference=vc.Reference(self.member, origin=self.origin, cuts=self.cuts),
            name="random",
        )

    def kind(self, joint: DrawnJoint) -> tuple[str, ...]:
        """Axis names of a drawn joint."""
        return joint_type(joint.type, self.space).axis_names(joint.name)


@cache
def random_drawn(seed: int) -> Drawn:
    """Random mechanism number `seed`; even ones are planar, odd ones spatial."""
    rng = np.random.default_rng([seed, 20001])
    return _Growth(rng, PLANAR if seed % 2 == 0 else SPATIAL).grown()


@cache
def random_mechanism(seed: int) -> Mechanism:
    """The same as a mechanism."""
    return random_drawn(seed).mechanism()


class _Growth:
    """Grows one mechanism limb by limb."""

    def __init__(self, rng: np.random.Generator, space: Space) -> None:
        self.rng, self.space = rng, space
        self.joints: list[DrawnJoint] = []
        self.contacts: list[vc.Contact] = []
        self.limb_bodies: list[str] = ["ground"]
        self._joint_types = _SPATIAL_JOINTS if space is SPATIAL else _PLANAR_JOINTS
        self._points: list[Vector] = []
        self._directions: list[Vector] = []

    def grown(self) -> Drawn:
        for limb in range(int(self.rng.integers(1, 7))):
            way = "limb" if limb == 0 else self._choice(_WAYS)
            if limb == 0 and self.rng.random() < 0.1:
                way = "leg"
            self._grow(limb, way)
        if self.rng.random() < 0.1:
            self._second_object()
        active, lock = self._motors()
        drawn = Drawn(
            self.space,
            tuple(self.joints),
            tuple(self.contacts),
            self._frames(),
            active=active,
            lock=lock,
            origin=self._point(),
        )
        return self._coupled(drawn)

    def _grow(self, limb: int, way: str) -> None:
        """One chain of bodies from somewhere to somewhere."""
        start = MEMBER if way == "leg" else "ground" if way == "limb" else self._choice_of(self.limb_bodies)
        links = int(self.rng.integers(0, 4)) if way in ("limb", "leg") else int(self.rng.integers(1, 3))
        inner = [f"link{limb}_{k}" for k in range(links)]
        chain = [start, *inner]
        for one, two in pairwise(chain):
            self._joint(one, two, self._choice(self._joint_types))
        if way in ("limb", "branch"):
            self._connect(chain[-1], MEMBER, contact=0.35)
        elif way == "inner":
            others = [b for b in (*self.limb_bodies, *inner) if b != chain[-1]]
            self._connect(chain[-1], self._choice_of(others), contact=0.25)
        elif way == "leg" and (limb == 0 or self.rng.random() < 0.8):
            self._connect(chain[-1], "ground", contact=0.9)
        if way != "leg":
            self.limb_bodies += inner

    def _connect(self, one: str, two: str, contact: float) -> None:
        if self.rng.random() < contact:
            self._contact(one, two)
        else:
            self._joint(one, two, self._choice(self._joint_types | {"fixed": 0.0}))

    def _frames(self) -> tuple[vc.Body, ...]:
        """Half of the bodies get a frame of their own somewhere."""
        names = {end for part in (*self.joints, *self.contacts) for end in (part.first, part.second)}
        chosen = [name for name in sorted(names - {"ground"}) if self.rng.random() < 0.5]
        return tuple(vc.Body(name, at=self.rng.normal(size=self.space.translations)) for name in chosen)

    def _second_object(self) -> None:
        for _ in range(int(self.rng.integers(1, 4))):
            self._contact(self._choice_of([*self.limb_bodies, MEMBER]), "object")

    def _joint(self, one: str, two: str, kind: str) -> None:
        if self.rng.random() < 0.3:
            one, two = two, one
        spatial = self.space is SPATIAL
        axis = self._direction() if kind not in ("spherical", "fixed", "free") else None
        if kind == "revolute" and not spatial:
            axis = None
        second = self._direction_apart(axis) if kind == "universal" and axis is not None else None
        lead = float(self.rng.uniform(-1, 1)) if kind == "screw" else 0.0
        name = f"j{len(self.joints)}"
        self.joints.append(DrawnJoint(name, kind, one, two, self._point(), axis, second, lead))

    def _contact(self, one: str, two: str) -> None:
        if self.rng.random() < 0.3:
            one, two = two, one
        types = [c.name for c in CONTACT_TYPES.values() if self.space is SPATIAL or c.planar is not None]
        kind = self._choice_of(types)
        normal = self._direction()
        line = None
        if kind.startswith("line"):
            line = np.cross(normal, self._direction_apart(normal))
        name = f"c{len(self.contacts)}"
        self.contacts.append(vc.Contact(name, one, two, kind, self._point(), normal, line))

    def _motors(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Whole joints of several axes are active or passive, single axes of universal ones may differ."""
        active: list[str] = []
        lock: list[str] = []
        share = self.rng.uniform(0.1, 0.7)
        for joint in self.joints:
            axes = joint_type(joint.type, self.space).axis_names(joint.name)
            single = [(axis,) for axis in axes] if joint.type in ("universal", "cylindrical") else [axes]
            for together in single:
                draw = self.rng.random()
                if draw < (0.1 if joint.type == "free" else share):
                    active.extend(together)
                elif draw > 0.96:
                    lock.extend(together)
        self.rng.shuffle(active)
        return tuple(active), tuple(lock)

    def _coupled(self, drawn: Drawn) -> Drawn:
        """Now and then a coupling between two axes, and a motor that drives two."""
        scalar = [
            axis for joint in drawn.joints if joint.type in ("revolute", "prismatic", "universal")
            for axis in drawn.kind(joint)
        ]  # fmt: skip
        if len(scalar) > 1 and self.rng.random() < 0.2:
            one, two = self.rng.choice(scalar, 2, replace=False)
            gear = Coupling("gear", {str(one): 1.0, str(two): float(self.rng.uniform(-2, 2))})
            drawn = replace(drawn, couplings=(gear,))
        idle = [axis for axis in scalar if axis not in (*drawn.active, *drawn.lock)]
        if len(idle) > 1 and self.rng.random() < 0.2:
            one, two = self.rng.choice(idle, 2, replace=False)
            drive = Drive("split", {str(one): 0.5, str(two): float(self.rng.uniform(-1, 1))})
            drawn = replace(drawn, drives=(drive,), active=(*drawn.active, "split"))
        return drawn

    def _choice(self, weights: Mapping[str, float]) -> str:
        share = np.array(list(weights.values()))
        return str(self.rng.choice(list(weights), p=share / share.sum()))

    def _choice_of(self, names: list[str]) -> str:
        return str(self.rng.choice(names))

    def _point(self) -> Vector:
        if self._points and self.rng.random() < 0.12:
            return self._points[int(self.rng.integers(len(self._points)))]
        self._points.append(self.rng.normal(size=self.space.translations))
        return self._points[-1]

    def _direction(self) -> Vector:
        if self._directions and self.rng.random() < 0.2:
            return self._directions[int(self.rng.integers(len(self._directions)))]
        vector = self.rng.normal(size=self.space.translations)
        self._directions.append(vector / np.linalg.norm(vector))
        return self._directions[-1]

    def _direction_apart(self, other: Vector) -> Vector:
        """A direction at least 0.4 rad away from another."""
        while True:
            vector = self.rng.normal(size=3)
            vector /= np.linalg.norm(vector)
            if np.linalg.norm(np.cross(vector, other)) > 0.4:
                return vector


def all_driven(drawn: Drawn) -> Mechanism:
    """The same mechanism with every unlocked axis driven, no coupling and no drive."""
    return drawn.mechanism(couplings=(), drives=(), active=(), lock=()).with_active(ALL)
