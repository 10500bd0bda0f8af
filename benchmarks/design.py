"""Design at the speed of lanes: `python -m benchmarks.design [landscape] [evolution] [seeds] [front]`.

Without arguments all four: a landscape of 1000 x 1000 designs of the platform, an evolution of 200 000
designs, the best value of both task metrics from 20 seeds, and a front of the five-bar with four free lengths
over 5000 configurations.  Best designs are evaluated once more by the reference path, and from the leg
directions alone.  Wall and processor seconds are told; on a busy machine only the second mean something.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

import vincula as vc
from vincula.design.constraints import NoSingularity
from vincula.design.linkages import uneven_five_bar
from vincula.design.measures import Index
from vincula.design.optimum import optimize
from vincula.design.problem import DesignProblem
from vincula.design.problems import design_problem
from vincula.design.variables import DesignVariable

BEST = {"stewart-unit": 1.80641, "stewart": 1.71789}
"""Best inverse cost known."""
METRIC = {"stewart-unit": np.ones(6), "stewart": np.array([1.0, 1.0, 1.0, 5.0, 5.0, 5.0])}


def inverse_cost(name: str, alpha: float, beta: float) -> float:
    """The platform's inverse cost from its six leg lines alone: rates of legs are n . (v + w x r)."""
    third = 2.0 * np.pi / 3.0
    rows = []
    for leg in range(6):
        vertex = leg // 2 * third
        turn = vertex + (beta if leg % 2 else alpha)
        top = np.array([1.5 * np.cos(vertex), 1.5 * np.sin(vertex), 2.0])
        along = top - np.array([2.0 * np.cos(turn), 2.0 * np.sin(turn), 0.0])
        along /= np.linalg.norm(along)
        rows.append([*along, *np.cross(top - [0.0, 0.0, 2.0], along)])
    root = np.sqrt(METRIC[name])
    semi_axes = 1.0 / np.linalg.svd(np.array(rows) / root, compute_uv=False)
    return float(1.0 / ((semi_axes.max() ** 2 - 1.0) ** 2 + (semi_axes.min() ** 2 - 1.0) ** 2))


def timed(what: str, action: Callable[[], object]) -> object:
    """Do something and tell how long it took."""
    wall, own = time.perf_counter(), time.process_time()
    found = action()
    print(
        f"{what}: {time.perf_counter() - wall:.1f} s, {time.process_time() - own:.1f} s of processor",
        flush=True,
    )
    return found


def landscape() -> None:
    """A million designs."""
    problem = design_problem("stewart-unit")
    problem.judge(np.zeros((200, 2)) + np.linspace(0.1, 1.0, 200)[:, None] * [1.0, -1.0])
    found = timed("landscape of 1000 x 1000", lambda: problem.scan("alpha", "beta", counts=1000))
    design, value = found.best()  # type: ignore[attr-defined]
    print(f"  best {np.degrees(list(design.values()))} deg, inverse cost {1.0 / value:.6f}", found.counts)  # type: ignore[attr-defined]


def evolution() -> None:
    """200 000 designs without polishing, in generations of 400."""
    problem = design_problem("stewart-unit")
    problem.judge(np.zeros((200, 2)) + np.linspace(0.1, 1.0, 200)[:, None] * [1.0, -1.0])
    found = timed(
        "evolution of 200 000",
        lambda: optimize(problem, population=400, generations=499, tolerance=0.0, polish=False),
    )
    print(f"  {found.evaluated} designs, inverse cost {1.0 / found.value:.7f}")  # type: ignore[attr-defined]


def seeds(count: int = 20) -> None:
    """Both metrics from many seeds."""
    for name, best in BEST.items():
        problem = design_problem(name)
        values, designs = [], []
        for seed in range(count):
            found = problem.optimize(seed=seed)
            values.append(1.0 / found.value)
            designs.append(found.design)
        k = int(np.argmax(values))
        again = 1.0 / float(problem.by_reference().judge(designs[k][None]).objectives[0, 0])
        print(f"{name}: {sum(v > best - 1e-4 for v in values)} of {count} seeds find {best} to 1e-4; "
              f"worst {min(values):.7f}, best {max(values):.7f} at {np.degrees(designs[k]).round(4)} deg; "
              f"reference path {again:.10f}, from the leg lines {inverse_cost(name, *designs[k]):.10f}",
              flush=True)  # fmt: skip


def five_bar() -> DesignProblem:
    """Four free lengths, 5000 configurations, two objectives, no singularity inside."""
    axes = np.linspace(-0.3, 0.3, 50), np.linspace(-0.3, 0.3, 100)
    places = np.stack([mesh.ravel() for mesh in np.meshgrid(*axes, indexing="ij")], axis=1)
    bounds = {
        "near_left": (0.15, 0.4),
        "near_right": (0.15, 0.4),
        "far_left": (0.25, 0.6),
        "far_right": (0.25, 0.6),
    }
    return DesignProblem(
        uneven_five_bar,
        [DesignVariable(name, low, high, unit="m") for name, (low, high) in bounds.items()],
        [Index(quantity="kinematic.condition:translation"),
         Index(quantity="kinematic.smallest_singular_value:translation")],
        constraints=[NoSingularity()], configurations=places, given="motors", weights=vc.Weights(),
        name="five-bar with four free lengths",
    )  # fmt: skip


def front() -> None:
    """The compromises of the five-bar."""
    problem = five_bar()
    problem.judge(problem.space.start[None])
    found = timed("front of 40 x 50 designs at 5000 configurations", lambda: problem.front(seed=1))
    print(f"  {len(found.members)} members, {found.evaluated} designs, largest difference to the reference "  # type: ignore[attr-defined]
          f"path {found.largest_difference:.1e}", found.counts)  # type: ignore[attr-defined]  # fmt: skip


if __name__ == "__main__":
    known = {"landscape": landscape, "evolution": evolution, "seeds": seeds, "front": front}
    for word in sys.argv[1:] or known:
        known[word]()
