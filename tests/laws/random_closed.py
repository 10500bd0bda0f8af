"""Random mechanisms that are closed as drawn: one to four loops, in the plane and in space.

Grown ear by ear: every loop is a new chain of bodies between two bodies that are there already.  In
space the freedoms of a chain are drawn so that the loop is not rigid by counting.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import vincula as vc
from vincula.mechanism.drawing import DrawnJoint
from vincula.mechanism.mechanism import Mechanism

FREEDOMS = {
    "revolute": 1,
    "prismatic": 1,
    "screw": 1,
    "cylindrical": 2,
    "universal": 2,
    "spherical": 3,
    "planar": 3,
}


def random_closed(rng: np.random.Generator, *, planar: bool, loops: int) -> Mechanism:
    """A mechanism of the given number of loops, joint points about 1 m apart, closed at home."""
    bodies = ["ground"]
    joints: list[DrawnJoint] = []
    for _ in range(loops):
        ends = _ends(rng, bodies)
        kinds = _planar_kinds(rng) if planar else _spatial_kinds(rng)
        inner = [f"b{len(bodies) + k}" for k in range(len(kinds) - 1)]
        chain = [ends[0], *inner, ends[1]]
        for kind, one, two in zip(kinds, chain[:-1], chain[1:], strict=True):
            ends_of_joint = (two, one) if rng.random() < 0.3 else (one, two)
            joints.append(_joint(rng, f"j{len(joints) + 1}", kind, *ends_of_joint, planar))
        bodies += inner
    make = Mechanism.planar if planar else Mechanism.spatial
    return make(joints=joints, reference=vc.Reference(bodies[1]), name="random")


def displaced(rng: np.random.Generator, mechanism: Mechanism, far: float) -> dict[str, list[float]]:
    """A start with every joint value moved by up to `far` [rad, m], balls turned by that angle."""
    start: dict[str, list[float]] = {}
    for name, values in mechanism.home.items():
        if mechanism.joint[name].type == "spherical":
            axis = rng.normal(size=3)
            turn = far * axis / np.linalg.norm(axis)
            half = 0.5 * far
            quaternion = [np.cos(half), *(np.sin(half) / far * turn)]
            start[name] = [float(v) for v in quaternion]
        else:
            start[name] = [float(v) for v in values + far * rng.uniform(-1, 1, len(values))]
    return start


def holdable_motors(rng: np.random.Generator, mechanism: Mechanism) -> dict[str, float]:
    """Home values of as many scalar axes as the mechanism has freedoms, which fix all that they can.

    Axes are taken in random order as long as each of them can still move when the earlier ones stand.
    """
    model = mechanism.with_reference(mechanism.bodies[0].name).linearize()
    jacobian = np.hstack([model.jacobian_passive, -model.grasp.T])
    names = [column.name for column in model.passives]
    kernel = np.linalg.svd(jacobian)[2][np.linalg.matrix_rank(jacobian, tol=1e-9) :].T
    motors: dict[str, float] = {}
    for name in rng.permutation([n for n in names if len(mechanism.home.get(n, ())) == 1]):
        row = kernel[names.index(name)]
        if kernel.shape[1] and np.linalg.norm(row) > 0.05:
            motors[str(name)] = float(mechanism.home[name][0])
            kernel = kernel @ np.linalg.svd(row[None, :])[2][1:].T
    return motors


def _ends(rng: np.random.Generator, bodies: list[str]) -> tuple[str, str]:
    if len(bodies) < 3:
        return "ground", "ground"
    one, two = rng.choice(len(bodies), size=2, replace=False)
    return bodies[one], bodies[two]


def _planar_kinds(rng: np.random.Generator) -> list[str]:
    """Four or five joints, at most one of them prismatic."""
    count = int(rng.integers(4, 6))
    kinds = ["revolute"] * count
    if rng.random() < 0.25:
        kinds[int(rng.integers(count))] = "prismatic"
    return kinds


def _spatial_kinds(rng: np.random.Generator) -> list[str]:
    """Joints with seven or eight freedoms together."""
    names = list(FREEDOMS)
    while True:
        kinds: list[str] = []
        while sum(FREEDOMS[k] for k in kinds) < 7:
            kinds.append(names[int(rng.integers(len(names)))])
        linear = sum(k in ("prismatic", "planar", "cylindrical") for k in kinds)
        if sum(FREEDOMS[k] for k in kinds) <= 8 and len(kinds) >= 3 and linear <= 2:
            return kinds


def _joint(
    rng: np.random.Generator, name: str, kind: str, first: str, second: str, planar: bool
) -> DrawnJoint:
    at = rng.uniform(-1, 1, 2 if planar else 3)
    axis = _unit(rng, 2 if planar else 3)
    if planar:
        if kind == "prismatic":
            return vc.Prismatic(name, first, second, axis, at)
        return vc.Revolute(name, first, second, at)
    makers: dict[str, Callable[[], DrawnJoint]] = {
        "revolute": lambda: vc.Revolute(name, first, second, at, axis),
        "prismatic": lambda: vc.Prismatic(name, first, second, axis, at),
        "screw": lambda: vc.Screw(name, first, second, at, axis, float(rng.uniform(0.2, 1.0))),
        "cylindrical": lambda: vc.Cylindrical(name, first, second, at, axis),
        "universal": lambda: vc.Universal(name, first, second, at, (axis, _unit(rng, 3))),
        "spherical": lambda: vc.Spherical(name, first, second, at),
        "planar": lambda: vc.PlanarJoint(name, first, second, at, axis),
    }
    return makers[kind]()


def _unit(rng: np.random.Generator, size: int) -> np.ndarray:
    vector = rng.normal(size=size)
    return vector / np.linalg.norm(vector)
