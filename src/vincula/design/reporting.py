"""Design reports: plain values for JSON, and text for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.design.front import NAMES
from vincula.design.judged import Judged
from vincula.design.measures import SphereDistance
from vincula.design.neighbourhood import MOVES

if TYPE_CHECKING:
    from vincula.arrays import Vector
    from vincula.design.front import Front
    from vincula.design.landscape import Landscape
    from vincula.design.optimum import Optimum
    from vincula.design.problem import DesignProblem

BETTER: Final = 1e-6
"""Gain beside an optimum, in parts of the objective, from which on it is none."""
LINES: Final = 24
"""Compromises that the text shows."""


def number(value: float) -> float | str | None:
    """A number for JSON: infinity as a word, NaN as null."""
    if math.isnan(value):
        return None
    return float(value) if math.isfinite(value) else ("inf" if value > 0 else "-inf")


def numbers(values: Vector) -> list[Any]:
    """A table of numbers for JSON."""
    return [numbers(row) if np.ndim(row) else number(float(row)) for row in values]


def problem_facts(problem: DesignProblem) -> dict[str, Any]:
    """What was asked for."""
    return {
        "name": problem.name,
        "mechanism": problem.compiled.mechanism.name,
        "variables": [
            {
                "name": v.name,
                "low": v.low,
                "high": v.high,
                "start": number(float(s)),
                "tolerance": v.tolerance,
                "unit": v.unit,
                "scale": v.scale,
            }
            for v, s in zip(problem.space.variables, problem.space.start, strict=True)
        ],
        "objectives": [{"name": o.name, "better": o.better, "over": o.over} for o in problem.objectives],
        "constraints": list(problem.names_of_constraints),
        "configurations": problem.places,
        "reach": problem.reach,
    }


def designs_facts(problem: DesignProblem, judged: Judged) -> list[dict[str, Any]]:
    """Designs with their objectives."""
    names = [objective.name for objective in problem.objectives]
    return [
        {
            "variables": problem.space.named(design),
            "objectives": dict(zip(names, numbers(values), strict=True)),
            "doubtful": bool(doubt),
        }
        for design, values, doubt in zip(judged.designs, judged.objectives, judged.doubtful, strict=True)
    ]


def optimum_facts(found: Optimum) -> dict[str, Any]:
    """A search for one objective as plain values."""
    problem = found.problem
    sampled = found.around.sampled
    known = sampled[np.isfinite(sampled)]
    return {
        "schema": "vincula/design/1",
        "kind": "optimum",
        "problem": problem_facts(problem),
        "best": {
            "variables": found.parameters,
            "value": number(found.value),
            "inverse": number(_inverse(problem, found.value)),
            "on_bounds": found.bounds,
        },
        "start": {
            "variables": problem.space.named(found.start),
            "value": number(found.start_value),
            "inverse": number(_inverse(problem, found.start_value)),
        },
        "sensitivity": {
            "moves": list(MOVES),
            "values": dict(zip(problem.space.names, numbers(found.around.moved), strict=True)),
        },
        "tolerance": None
        if not len(sampled)
        else {
            "samples": len(sampled),
            "feasible_share": number(found.around.kept),
            "mean": number(float(known.mean())) if len(known) else None,
            "worst": number(_worst(problem, known)) if len(known) else None,
        },
        "runners_up": designs_facts(problem, found.runners_up)[1:],
        "search": {
            "evaluated": found.evaluated,
            "feasible": int(found.everything.feasible.sum()),
            "doubtful": int(found.everything.doubtful.sum()),
            "killed_by": found.counts,
            "seed": found.seed,
            "converged": found.converged,
            "polish": found.polish,
        },
    }


def front_facts(found: Front) -> dict[str, Any]:
    """A search for compromises as plain values."""
    return {
        "schema": "vincula/design/1",
        "kind": "front",
        "problem": problem_facts(found.problem),
        "members": designs_facts(found.problem, found.members),
        "largest_difference": number(found.largest_difference),
        "search": {
            "evaluated": found.evaluated,
            "feasible": int(found.everything.feasible.sum()),
            "killed_by": found.counts,
            "seed": found.seed,
            "method": found.method,
        },
    }


def landscape_facts(found: Landscape) -> dict[str, Any]:
    """A landscape as plain values."""
    problem = found.problem
    best = None
    if found.judged.feasible.any():
        design, value = found.best()
        best = {"variables": design, "value": number(value), "inverse": number(_inverse(problem, value))}
    return {
        "schema": "vincula/design/1",
        "kind": "landscape",
        "problem": problem_facts(problem),
        "names": list(found.names),
        "axes": [numbers(axis) for axis in found.axes],
        "values": numbers(found.values),
        "best": best,
        "search": {
            "evaluated": len(found.judged),
            "feasible": int(found.judged.feasible.sum()),
            "killed_by": found.counts,
        },
    }


def optimum_text(found: Optimum) -> str:
    """A search for one objective in words."""
    problem, objective = found.problem, found.problem.objectives[0]
    lines = [
        f"{problem.name}: {objective.name} ({objective.better} is better) at {_places(problem)}",
        f"  best   {_value(problem, found.value)}   {_designs(problem, found.design)}",
        f"  start  {_value(problem, found.start_value)}   {_designs(problem, found.start)}",
    ]
    for name, end in found.bounds.items():
        lines.append(f"  {name} is on its {end} bound: the best design may lie outside")
    lines += _moved(found)
    if len(found.around.sampled):
        known = found.around.sampled[np.isfinite(found.around.sampled)]
        told = f"{100.0 * found.around.kept:.3g} % of {len(found.around.sampled)} stay feasible"
        if len(known):
            told += f", mean {known.mean():.6g}, worst {_worst(problem, known):.6g}"
        lines.append(f"  with manufacturing errors {told}")
    for k in range(1, len(found.runners_up)):
        design, value = found.runners_up.designs[k], float(found.runners_up.objectives[k, 0])
        lines.append(f"  runner-up {_value(problem, value)}   {_designs(problem, design)}")
    feasible = int(found.everything.feasible.sum())
    agreed = "the population agreed" if found.converged else "stopped at the last generation"
    lines.append(
        f"  {found.evaluated} designs evaluated, {feasible} feasible; seed {found.seed}, {agreed}, "
        f"polished by {found.polish}"
    )
    return "\n".join([*lines, *killed_text(found.counts)])


def _moved(found: Optimum) -> list[str]:
    """How flat the optimum is, as a table; and whether something beside it is better."""
    heads = "  ".join(f"{100.0 * move:+10.3g} %" for move in MOVES)
    lines = ["  change of the objective when a variable moves by so much of its range"]
    lines.append(f"    {'':16}{heads}")
    for name, row in zip(found.problem.space.names, found.around.moved, strict=True):
        changes = "  ".join(f"{_change(float(value), found.value):>12}" for value in row)
        lines.append(f"    {name:16}{changes}")
    sign = float(found.problem.signs[0])
    gain = np.nanmax(sign * (found.value - found.around.moved), initial=0.0)
    if gain > BETTER * max(1.0, abs(found.value)):
        lines.append("  one of these is better: the search ended too early, give it more generations")
    return lines


def front_text(found: Front) -> str:
    """A search for compromises in words: a numbered line each, best in the first objective first."""
    problem = found.problem
    lines = [f"{problem.name}: {len(found.members)} compromises at {_places(problem)}"]
    letters = [chr(ord("a") + k) for k in range(len(problem.objectives))]
    for letter, objective in zip(letters, problem.objectives, strict=True):
        lines.append(f"  {letter}  {objective.name} ({objective.better} is better, {objective.over})")
    lines.append("    no  " + "  ".join(f"{letter:>10}" for letter in letters))
    for k in _spread(len(found.members)):
        columns = "  ".join(f"{value:10.6g}" for value in found.members.objectives[k])
        lines.append(f"  {k + 1:4}  {columns}   {_designs(problem, found.members.designs[k])}")
    if len(found.members) > LINES:
        lines.append(f"  {len(found.members) - LINES} more between these: --json holds all")
    feasible = int(found.everything.feasible.sum())
    method = f"{NAMES[found.method]}, seed {found.seed}"
    lines.append(f"  {found.evaluated} designs evaluated, {feasible} feasible; {method}")
    lines.append(f"  computed again one by one: largest difference {found.largest_difference:.1e}")
    return "\n".join([*lines, *killed_text(found.counts)])


def _spread(count: int) -> list[int]:
    """At most `LINES` of so many, evenly, both ends among them."""
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, LINES))})


def landscape_text(found: Landscape) -> str:
    """A landscape in words: its best design of every objective, and what killed the others."""
    problem = found.problem
    size = " x ".join(str(len(axis)) for axis in found.axes)
    lines = [f"{problem.name}: landscape of {size} designs over {', '.join(found.names)}"]
    for k, objective in enumerate(problem.objectives):
        if found.judged.feasible.any():
            design, value = found.best(k)
            told = _designs(problem, np.array(list(design.values())))
            lines.append(f"  best {objective.name}: {_value(problem, value, k)}   {told}")
    return "\n".join([*lines, *killed_text(found.counts)])


def killed_text(counts: Mapping[str, int]) -> list[str]:
    """Which constraint killed how many designs."""
    return [f"  {count} designs: {name}" for name, count in sorted(counts.items(), key=lambda c: -c[1])]


def _places(problem: DesignProblem) -> str:
    return f"{problem.places} configuration{'s' if problem.places > 1 else ''}"


def _designs(problem: DesignProblem, design: Vector) -> str:
    parts = zip(problem.space.variables, design, strict=True)
    return ", ".join(f"{v.name} {v.shown(float(x))}" for v, x in parts)


def _value(problem: DesignProblem, value: float, objective: int = 0) -> str:
    if math.isnan(value):
        return "not feasible"
    inverse = _inverse(problem, value, objective)
    return f"{value:.6g}" + ("" if math.isnan(inverse) else f" (inverse {inverse:.5g})")


def _inverse(problem: DesignProblem, value: float, objective: int = 0) -> float:
    """1/cost, as the paper draws it; NaN for other objectives."""
    return (
        1.0 / value if isinstance(problem.objectives[objective], SphereDistance) and value > 0 else math.nan
    )


def _change(value: float, best: float) -> str:
    if math.isnan(value):
        return "not allowed"
    return f"{100.0 * (value - best) / abs(best):+.2g} %" if best else f"{value - best:+.2g}"


def _worst(problem: DesignProblem, values: Vector) -> float:
    return float(values.max() if problem.objectives[0].better == "smaller" else values.min())
