"""The rank table of the numerics page: how often common rules are silently wrong about a rank.

Mechanisms of known truth, in five units of length, are decided by six rules: numpy's default
tolerance (matrix_rank, null_space), SuiteSparseQR's default, a fixed 1e-10, the largest gap, and
vincula's ledger.  A rule is silently wrong when it reports another rank than the truth; the ledger is
silently wrong when it does so with status `certain`.

    python benchmarks/rank_table.py [--cases 10000] [--seed 1]
"""

from __future__ import annotations

import argparse
import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from rank_newton import close_by_newton

import vincula as vc
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Precision
from vincula.model import LinearModel

UNITS = (1e-6, 1e-3, 1.0, 1e3, 1e6)
RULES = ("matrix_rank", "SuiteSparseQR", "fixed 1e-10", "largest gap", "vincula")
ROWS = (
    "exactly singular, exact data",
    "regular",
    "near-singular, exact data",
    "singular pose found by loop closure, tol 1e-8 to 1e-14",
    "planar four-bar in space, pi/2 typed with 4-10 decimals",
)


@dataclass(frozen=True)
class Case:
    """One matrix of known rank: the passive and member constraints [J_p G^T], or all of them."""

    row: str
    mechanism: str
    model: LinearModel
    matrix: str
    truth: int


# Mechanisms ---------------------------------------------------------------------------------------


def five_bar(points: np.ndarray) -> Mechanism:
    """A planar five-bar through five points, motors at both ends, member the link between 2 and 3."""
    bodies = ["ground", "crank", "coupler", "link", "rocker", "ground"]
    joints = [vc.Revolute(f"o{k + 1}", bodies[k], bodies[k + 1], at=points[k]) for k in range(5)]
    centre = 0.5 * (points[1] + points[2])
    return Mechanism.planar(joints, reference=vc.Reference("coupler", origin=centre), active=["o1", "o5"])


def four_bar(points: np.ndarray, axes: np.ndarray) -> Mechanism:
    """A four-bar in space with four revolutes; one motor at the first."""
    bodies = ["ground", "crank", "coupler", "rocker", "ground"]
    joints = [
        vc.Revolute(f"o{k + 1}", bodies[k], bodies[k + 1], at=points[k], axis=axes[k]) for k in range(4)
    ]
    centre = 0.5 * (points[1] + points[2])
    return Mechanism.spatial(joints, reference=vc.Reference("coupler", origin=centre), active=["o1"])


def stewart(lower: np.ndarray, upper: np.ndarray) -> Mechanism:
    """Six legs, spherical below, prismatic motor, soft finger at the platform."""
    joints, contacts = [], []
    for k in range(6):
        along = upper[k] - lower[k]
        joints += [
            vc.Spherical(f"b{k + 1}", "ground", f"cylinder{k + 1}", at=lower[k]),
            vc.Prismatic(
                f"p{k + 1}", f"cylinder{k + 1}", f"rod{k + 1}", axis=along, at=0.5 * (lower[k] + upper[k])
            ),
        ]
        contacts.append(
            vc.Contact(f"c{k + 1}", f"rod{k + 1}", "platform", type="soft-finger", at=upper[k], normal=along)
        )
    reference = vc.Reference("platform", origin=upper.mean(axis=0))
    return Mechanism.spatial(
        joints, contacts=contacts, reference=reference, active=[f"p{k + 1}" for k in range(6)]
    )


def delta(elbow: np.ndarray, wrist: np.ndarray, base: np.ndarray, side: np.ndarray) -> Mechanism:
    """Three arms of two rods between ball joints; motors at the base."""
    joints = []
    for k in range(3):
        joints.append(vc.Revolute(f"m{k + 1}", "ground", f"arm{k + 1}", at=base[k], axis=side[k]))
        for sign, letter in ((-1, "l"), (1, "r")):
            shift = 0.1 * sign * side[k] * np.linalg.norm(wrist[0] - elbow[0])
            rod = f"rod{k + 1}{letter}"
            joints += [
                vc.Spherical(f"e{k + 1}{letter}", f"arm{k + 1}", rod, at=elbow[k] + shift),
                vc.Spherical(f"w{k + 1}{letter}", rod, "platform", at=wrist[k] + shift),
            ]
    reference = vc.Reference("platform", origin=wrist.mean(axis=0))
    return Mechanism.spatial(joints, reference=reference, active=["m1", "m2", "m3"])


# Geometries ---------------------------------------------------------------------------------------


def five_bar_points(rng: np.random.Generator, unit: float, offset: float) -> np.ndarray:
    """Five-bar whose joints 2, 3, 4 are collinear up to `offset` (relative)."""
    step = rng.integers(-4, 5, 2)
    while not step.any():
        step = rng.integers(-4, 5, 2)
    start = rng.integers(-3, 4, 2)
    p2, p3, p4 = start, start + step, start + step * int(rng.integers(2, 4))
    p1, p5 = p2 + rng.integers(1, 5, 2) * [-1, 1], p4 + rng.integers(1, 5, 2)
    points = np.array([p1, p2, p3, p4, p5], dtype=float)
    normal = np.array([-step[1], step[0]]) / np.linalg.norm(step)
    points[2] += offset * np.linalg.norm(step) * normal
    return points * unit


def hexagon(rng: np.random.Generator, unit: float, offset: float) -> tuple[np.ndarray, np.ndarray]:
    """Stewart platform whose odd and even lower joints coincide up to `offset` (an angle)."""
    # Lifting and turning depend on each other by sin(beta) - sin(alpha), about offset * cos(alpha):
    # near +-90 degrees an offset of 1e-11 would be below rounding itself, for which no rule can have truth.
    alpha = rng.choice([0.0, math.pi]) + rng.uniform(-1.2, 1.2)

    def triangle(radius: float, turn: float, height: float) -> np.ndarray:
        angle = turn + np.arange(3) * 2 * math.pi / 3
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(3, height)])

    upper = np.repeat(triangle(1.5, 0.0, rng.uniform(1.5, 2.5)), 2, axis=0)
    lower = np.empty((6, 3))
    lower[0::2], lower[1::2] = triangle(2.0, alpha, 0.0), triangle(2.0, alpha + offset, 0.0)
    return lower * unit, upper * unit


def delta_points(rng: np.random.Generator, unit: float, offset: float) -> tuple[np.ndarray, ...]:
    """Delta whose rods lie in one horizontal plane up to `offset` (relative)."""
    angle = np.arange(3) * 2 * math.pi / 3 + rng.uniform(-0.1, 0.1)
    out = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(3)])
    side = np.column_stack([-np.sin(angle), np.cos(angle), np.zeros(3)])
    down = np.array([0.0, 0.0, -1.0])
    theta = rng.uniform(0.2, 1.0)
    base = 0.8 * out
    elbow = base + 0.7 * (math.cos(theta) * out + math.sin(theta) * down)
    wrist = 0.3 * out + elbow[0, 2] * np.array([0.0, 0.0, 1.0]) + offset * down
    return elbow * unit, wrist * unit, base * unit, side


def four_bar_points(rng: np.random.Generator, unit: float, offset: float) -> np.ndarray:
    """Four-bar whose joints 2, 3, 4 are collinear up to `offset`: the motor cannot hold the coupler."""
    flat = five_bar_points(rng, unit, offset)[:4]
    return np.column_stack([flat, np.zeros(4)])


# Cases --------------------------------------------------------------------------------------------

Make = Callable[[np.random.Generator, float, float], tuple[Mechanism, int, int]]
"""Mechanism, its full rank of [J_p G^T], and the loss at the singularity."""


def _five(rng: np.random.Generator, unit: float, offset: float) -> tuple[Mechanism, int, int]:
    return five_bar(five_bar_points(rng, unit, offset)), 6, 1


def _four(rng: np.random.Generator, unit: float, offset: float) -> tuple[Mechanism, int, int]:
    axes = np.tile([0.0, 0.0, 1.0], (4, 1))
    return four_bar(four_bar_points(rng, unit, offset), axes), 9, 1


def _stewart(rng: np.random.Generator, unit: float, offset: float) -> tuple[Mechanism, int, int]:
    return stewart(*hexagon(rng, unit, offset)), 24, 3


def _delta(rng: np.random.Generator, unit: float, offset: float) -> tuple[Mechanism, int, int]:
    # 36 passive coordinates and 6 of the platform, less one free spin a rod.
    return delta(*delta_points(rng, unit, offset)), 36, 3


MECHANISMS: dict[str, Make] = {
    "five-bar": _five, "four-bar in space": _four, "Stewart platform": _stewart, "Delta": _delta,
}  # fmt: skip


def cases(count: int, seed: int) -> Iterator[Case]:
    """About `count` cases, spread over rows, mechanisms and units."""
    rng = np.random.default_rng(seed)
    each = max(1, round(0.28 * count / (len(MECHANISMS) * len(UNITS))))
    for name, make in MECHANISMS.items():
        for unit in UNITS:
            for _ in range(each):
                mechanism, full, loss = make(rng, unit, 0.0)
                yield Case(ROWS[0], name, mechanism.linearize(), "passive+member", full - loss)
                mechanism, full, _ = make(rng, unit, rng.choice([-1, 1]) * rng.uniform(0.1, 0.6))
                yield Case(ROWS[1], name, mechanism.linearize(), "passive+member", full)
                mechanism, full, _ = make(rng, unit, 10.0 ** rng.uniform(-11, -3))
                yield Case(ROWS[2], name, mechanism.linearize(), "passive+member", full)
            closed = each if name == "five-bar" else max(2, each // 12)
            for _ in range(closed):
                mechanism, full, loss = make(rng, unit, 0.0)
                tolerance = 10.0 ** rng.uniform(-14, -8)
                q = close_by_newton(mechanism, rng, tolerance * mechanism.length)
                if q is not None:
                    yield Case(ROWS[3], name, mechanism.linearize(q), "passive+member", full - loss)
    for unit in UNITS:
        for _ in range(each):
            yield typed_four_bar(rng, unit)


def typed_four_bar(rng: np.random.Generator, unit: float) -> Case:
    """A planar four-bar whose hinge axes are turned by pi/2 as typed with 4 to 10 decimals."""
    decimals = int(rng.integers(4, 11))
    typed = round(math.pi / 2, decimals)
    axes = np.tile([0.0, -1.0, 0.0], (4, 1))
    for k in rng.permutation(4)[: rng.integers(1, 4)]:
        axes[k] = [0.0, -math.sin(typed), math.cos(typed)]
    flat = rng.integers(-4, 5, (4, 2)) + np.array([[-6, 0], [-6, 9], [6, 11], [6, 0]])
    points = np.column_stack([flat[:, 0], np.zeros(4), flat[:, 1]]).astype(float) * unit
    mechanism = four_bar(points, axes)
    mechanism = replace(mechanism, precision=Precision(digits_angle=0.5 * 10.0**-decimals))
    return Case(ROWS[4], "four-bar in space", mechanism.linearize(), "all", 9)


# Rules --------------------------------------------------------------------------------------------


def matrix_of(case: Case) -> np.ndarray:
    """The matrix in plain metres and radians, as the other rules see it."""
    model = case.model
    parts = [model.jacobian_passive, model.grasp.T]
    if case.matrix == "all":
        parts.insert(0, model.jacobian_active)
    return np.hstack(parts)


def suitesparse_rank(matrix: np.ndarray) -> int:
    """Rank by pivoted QR with SuiteSparseQR's default tolerance."""
    import scipy.linalg

    r = scipy.linalg.qr(matrix, mode="r", pivoting=True)[0]
    m, n = matrix.shape
    tolerance = 20 * (m + n) * np.finfo(float).eps * np.sqrt((matrix**2).sum(axis=0).max())
    return int(np.sum(np.abs(np.diagonal(r)) > tolerance))


def gap_rank(singular: np.ndarray) -> int:
    """Rank at the largest ratio between neighbouring singular values."""
    floor = np.append(singular, singular[0] * np.finfo(float).eps)
    floor = np.maximum(floor, singular[0] * 1e-20)
    return int(np.argmax(floor[:-1] / floor[1:])) + 1


def verdicts(case: Case) -> tuple[dict[str, bool], bool]:
    """Which rules are silently wrong, and whether vincula flagged the case."""
    matrix = matrix_of(case)
    singular = np.linalg.svd(matrix, compute_uv=False)
    decision = case.model.ledger.decision(case.matrix)
    ranks = {
        "matrix_rank": int(np.linalg.matrix_rank(matrix)),
        "SuiteSparseQR": suitesparse_rank(matrix),
        "fixed 1e-10": int(np.sum(singular > 1e-10)),
        "largest gap": gap_rank(singular),
    }
    wrong = {rule: rank != case.truth for rule, rank in ranks.items()}
    wrong["vincula"] = decision.rank != case.truth and decision.status == "certain"
    return wrong, decision.status != "certain"


def main() -> None:
    """Run and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=12_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    wrong: dict[str, dict[str, int]] = {row: defaultdict(int) for row in ROWS}
    flagged: dict[str, int] = defaultdict(int)
    total: dict[str, int] = defaultdict(int)
    by_mechanism: dict[str, int] = defaultdict(int)
    start = time.perf_counter()
    for case in cases(options.cases, options.seed):
        judged, doubtful = verdicts(case)
        total[case.row] += 1
        by_mechanism[case.mechanism] += 1
        flagged[case.row] += doubtful
        for rule, bad in judged.items():
            wrong[case.row][rule] += bad
    width = max(map(len, ROWS))
    print(
        f"silently wrong, percent{'':{width - 23}}"
        + "".join(f"{rule:>15}" for rule in RULES)
        + f"{'flagged':>10}{'cases':>8}"
    )
    for row in ROWS:
        n = max(total[row], 1)
        shares = "".join(f"{100 * wrong[row][rule] / n:15.1f}" for rule in RULES)
        print(f"{row:{width}}{shares}{100 * flagged[row] / n:10.1f}{total[row]:8d}")
    silent = sum(wrong[row]["vincula"] for row in ROWS)
    print(
        f"{sum(total.values())} cases ({dict(by_mechanism)}), {time.perf_counter() - start:.0f} s; "
        f"vincula silently wrong: {silent}"
    )


if __name__ == "__main__":
    main()
