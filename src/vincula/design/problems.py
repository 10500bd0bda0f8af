"""Design problems to try: the paper's platform, a five-bar, a Delta, a gripper finger, an ankle."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from vincula.arrays import Matrix
from vincula.design.capabilities import Force, Speed
from vincula.design.constraints import Bound, NoSingularity
from vincula.design.linkages import ankle, finger, five_bar
from vincula.design.measures import Index, SphereDistance
from vincula.design.problem import DesignProblem
from vincula.design.variables import DesignVariable
from vincula.errors import UnknownNameError
from vincula.mechanism.catalog import delta, stewart
from vincula.weights import Weights

DEGREE: Final = math.pi / 180.0
PAPER: Final = (1.0 * DEGREE, -120.0 * DEGREE)
"""The optimum that the paper prints, alpha and beta [rad]."""


def _stewart(metric: tuple[float, ...], name: str, **how: Any) -> DesignProblem:
    def build(alpha: float = PAPER[0], beta: float = PAPER[1]) -> Any:
        return stewart.build(alpha, beta, height=2.0, upper_radius=1.5, lower_radius=2.0)

    turns = [
        DesignVariable(name, -math.pi, math.pi, start, unit="deg", scale=DEGREE)
        for name, start in zip(("alpha", "beta"), PAPER, strict=True)
    ]
    return DesignProblem(
        build, turns, SphereDistance(), weights=Weights(twist=list(metric)), name=name, **how
    )


def stewart_problem(**how: Any) -> DesignProblem:
    """The paper's second case study with the task metric that its text states, W_u = diag(1,1,1,5,5,5)."""
    return _stewart((1.0, 1.0, 1.0, 5.0, 5.0, 5.0), "stewart", **how)


def stewart_unit_problem(**how: Any) -> DesignProblem:
    """The paper's second case study with W_u = I, which its printed numbers were computed with."""
    return _stewart((1.0,) * 6, "stewart-unit", **how)


def five_bar_problem(**how: Any) -> DesignProblem:
    """Link lengths of a symmetric five-bar: even in all directions, and strong, over a workspace.

    What is slow in its fastest direction is strong in its weakest one: the second objective is both.
    """
    return DesignProblem(
        five_bar,
        [
            DesignVariable("base", 0.05, 0.6, unit="m"),
            DesignVariable("near", 0.1, 0.6, tolerance=1e-3, unit="m"),
            DesignVariable("far", 0.1, 0.8, tolerance=1e-3, unit="m"),
        ],
        [
            Index(quantity="kinematic.condition:translation", label="unevenness"),
            Index(
                quantity="kinematic.largest", sense="smaller", label="largest efficiency"
            ),
        ],
        constraints=[NoSingularity()],
        configurations=_turns(2, 0.3, 3),
        given="motors",
        weights=Weights(twist=[1.0, 1.0, 0.0]),
        name="five-bar",
        **how,
    )


def delta_problem(**how: Any) -> DesignProblem:
    """A Delta robot for its worst speed and its worst force, among 27 configurations."""

    def build(base_radius: float = 0.2, arm: float = 0.2, rod: float = 0.5) -> Any:
        return delta.build(base_radius, 0.06, arm, rod, width=0.1, angle=30.0 * DEGREE)

    return DesignProblem(
        build,
        [
            DesignVariable("base_radius", 0.1, 0.3, unit="m"),
            DesignVariable("arm", 0.1, 0.35, unit="m"),
            DesignVariable("rod", 0.3, 0.8, unit="m"),
        ],
        [Index(quantity="kinematic.smallest"), Index(quantity="passive_force.smallest")],
        constraints=[NoSingularity()],
        configurations=_turns(3, 0.35, 3),
        given="motors",
        weights=Weights(twist=[1.0, 1.0, 1.0, 0.0, 0.0, 0.0], wrench=[1.0] * 6),
        name="delta",
        **how,
    )


def finger_problem(**how: Any) -> DesignProblem:
    """A four-bar gripper finger: the weakest squeeze of its tip over the stroke of the motor.

    A finger that need not move squeezes as hard as one likes: its tip must move 3 cm a radian everywhere.
    """
    return DesignProblem(
        finger,
        [
            DesignVariable("crank", 0.01, 0.04, tolerance=1e-4, unit="m"),
            DesignVariable("coupler", 0.03, 0.09, tolerance=1e-4, unit="m"),
            DesignVariable("lever", 0.015, 0.05, tolerance=1e-4, unit="m"),
        ],
        Force(direction=(1.0, 0.0, 0.0), label="squeeze"),
        constraints=[
            NoSingularity(),
            Bound(measure=Speed(direction=(1.0, 0.0, 0.0)), least=0.03, label="slow tip"),
        ],
        configurations=_turns(1, 0.5, 7),
        given="motors",
        weights=Weights(),
        name="finger",
        **how,
    )


def ankle_problem(**how: Any) -> DesignProblem:
    """A humanoid ankle on two parallel linear motors: torque and speed of pitch over its range."""
    return DesignProblem(
        ankle,
        [
            DesignVariable("lever", 0.03, 0.09, unit="m"),
            DesignVariable("height", 0.12, 0.3, unit="m"),
        ],
        [
            Force(direction=(0.0, 0.0, 0.0, 0.0, 1.0, 0.0), label="pitch torque"),
            Speed(direction=(0.0, 0.0, 0.0, 0.0, 1.0, 0.0), label="pitch speed"),
        ],
        constraints=[NoSingularity()],
        configurations=_turns(2, 0.015, 3),
        given="motors",
        weights=Weights(),
        name="ankle",
        **how,
    )


PROBLEMS: Final[dict[str, Callable[..., DesignProblem]]] = {
    "stewart": stewart_problem,
    "stewart-unit": stewart_unit_problem,
    "five-bar": five_bar_problem,
    "delta": delta_problem,
    "finger": finger_problem,
    "ankle": ankle_problem,
}
"""The catalog of problems, by name."""


def design_problem(name: str, **how: Any) -> DesignProblem:
    """A problem of the catalog.

    Args:
        name: Its name; `PROBLEMS` lists them.
        **how: Settings of `DesignProblem` that the problem leaves open, such as `path`.

    Raises:
        UnknownNameError: No such problem.
    """
    if name not in PROBLEMS:
        raise UnknownNameError("design problem", name, PROBLEMS)
    return PROBLEMS[name](**how)


def _turns(motors: int, reach: float, count: int) -> Matrix:
    """A grid of motor values around the drawing, from minus to plus a reach."""
    axes = [np.linspace(-reach, reach, count)] * motors
    return np.stack([mesh.ravel() for mesh in np.meshgrid(*axes, indexing="ij")], axis=1)
