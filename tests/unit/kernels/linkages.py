"""Mechanisms of many limbs and of many loops, for tests of cost and of structure."""

from __future__ import annotations

import numpy as np

import vincula as vc
from vincula.mechanism.drawing import Contact, DrawnJoint
from vincula.mechanism.mechanism import Mechanism


def platform(legs: int, kind: str = "soft-finger") -> Mechanism:
    """A platform on any number of legs: a ball, a prismatic motor, and a contact each."""
    rng = np.random.default_rng(5)
    joints: list[DrawnJoint] = []
    contacts: list[Contact] = []
    for k in range(legs):
        a, b = 2 * np.pi * k / legs, 2 * np.pi * (k * 0.618 % 1.0)
        base = np.array([2 * np.cos(a), 2 * np.sin(a), 0.1 * rng.normal()])
        top = np.array([1.5 * np.cos(b), 1.5 * np.sin(b), 2 + 0.1 * rng.normal()])
        joints += [
            vc.Spherical(f"b{k}", "ground", f"cylinder{k}", at=base),
            vc.Prismatic(f"p{k}", f"cylinder{k}", f"rod{k}", axis=top - base, at=(base + top) / 2),
        ]
        contacts.append(Contact(f"c{k}", f"rod{k}", "platform", type=kind, at=top, normal=top - base))
    return Mechanism.spatial(
        joints=joints, contacts=contacts, reference=vc.Reference("platform", origin=np.array([0, 0, 2.0])),
        active=[f"p{k}" for k in range(legs)],
    )  # fmt: skip


def ladder(loops: int, *, spatial: bool = False) -> Mechanism:
    """Four-bar loops one after the other: the rocker of each is the crank of the next; one motor."""
    rng = np.random.default_rng(7)
    feet = [np.array([1.5 * k, 0.05 * rng.normal()]) for k in range(loops + 1)]
    heads = [foot + np.array([0.2 * rng.normal(), 1.0 + 0.2 * rng.uniform()]) for foot in feet]

    def revolute(name: str, one: str, two: str, at: np.ndarray) -> DrawnJoint:
        if spatial:
            return vc.Revolute(name, one, two, at=(*at, 0.0), axis=(0, 0, 1))
        return vc.Revolute(name, one, two, at=at)

    joints = [revolute("o0", "ground", "crank0", feet[0])]
    for k in range(loops):
        joints += [
            revolute(f"a{k}", f"crank{k}", f"bar{k}", heads[k]),
            revolute(f"b{k}", f"bar{k}", f"crank{k + 1}", heads[k + 1]),
            revolute(f"o{k + 1}", f"crank{k + 1}", "ground", feet[k + 1]),
        ]
    make = Mechanism.spatial if spatial else Mechanism.planar
    return make(joints=joints, reference=vc.Reference(f"bar{loops - 1}"), active=["o0"])
