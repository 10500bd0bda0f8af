"""Closed configurations of any mechanism: ordinary ones, singular ones, and ones ever nearer to them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import vincula as vc
from vincula.arrays import Matrix
from vincula.errors import VinculaError


def random_configurations(mechanism: vc.Mechanism, count: int, seed: int = 0) -> Matrix:
    """count x coordinates; about a third lies in or near singularities, where some are found."""
    rng = np.random.default_rng(seed)
    singular = list(special_configurations(mechanism, rng))
    found: list[vc.Configuration] = singular[: max(1, count // 6)]
    here = mechanism.home
    tries = 0
    while len(found) < count:
        tries += 1
        if singular and tries % 4 == 0:
            start, reach = singular[tries // 4 % len(singular)], 10.0 ** -rng.uniform(1.0, 15.0)
        else:
            start, reach = here, rng.uniform(0.05, 0.6)
        try:
            closed = mechanism.close(displaced(mechanism, start, reach, rng), attempts=1)
            mechanism.linearize(closed)
        except VinculaError:
            here = mechanism.home
            if tries > 20 * count:
                break
            continue
        found.append(closed)
        if reach > 0.04:
            here = closed if tries % 10 else mechanism.home
    return np.array([q.flat for q in found])


def special_configurations(mechanism: vc.Mechanism, rng: np.random.Generator) -> Iterator[vc.Configuration]:
    """Home, right angles everywhere, and singularities on the way of single motors."""
    yield mechanism.home
    for _ in range(3):
        turned = {
            joint: np.array(value) + rng.integers(-1, 2) * np.pi / 2
            for joint, value in mechanism.home.items()
            if mechanism.joint[joint].type == "revolute"
        }
        try:
            closed = mechanism.close(turned, attempts=1)
            mechanism.linearize(closed)
        except VinculaError:
            continue
        yield closed
    scalar = [name for name in mechanism.active if name in mechanism.home and len(mechanism.home[name]) == 1]
    for motor in scalar[:3]:
        for way in (-3.0, 3.0):
            target = {m: mechanism.home[m] + (way if m == motor else 0.0) for m in scalar}
            try:
                path = mechanism.follow([target], limits=False)
            except VinculaError:
                continue
            if path.stopped is not None and path.stopped.kind == "singularity":
                yield path.stopped.configuration


def displaced(
    mechanism: vc.Mechanism, start: vc.Configuration, reach: float, rng: np.random.Generator
) -> vc.Configuration:
    """A configuration with every value moved by up to `reach` [rad, and lengths L / 3]; open in general."""
    values = {}
    for joint, value in start.items():
        kind = mechanism.type_of(mechanism.joint[joint])
        step = rng.uniform(-reach, reach, len(value))
        if kind.scalar_values:
            step[np.array(kind.linear, dtype=bool)] *= mechanism.length / 3.0
        elif len(value) == 7:
            step[:3] *= mechanism.length / 3.0
        if len(value):
            values[joint] = value + step
    return mechanism.home.replaced(values)
