"""What is singular at a closed configuration, of which type, and which joints take part.

A block of the closure equations is singular where its rank is lower than at closed configurations
near by: the generic rank is measured, not counted, so redundant rows and paradoxical mechanisms are
not mistaken for singular ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.errors import listing
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_solver import solve
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding, problem_for
from vincula.mechanism.watching import (
    ZERO_SHARE,
    SingularityKind,
    Watch,
    beyond,
    decided,
    locked,
    watches,
)
from vincula.numerics.lapack import svd
from vincula.numerics.rank import negligible

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

NEARBY: Final = 0.03
"""How far away closed configurations are looked at to learn the generic rank [rad, or lengths L]."""
SHARE: Final = 1e-5
"""Accuracy to which a singular direction is known; smaller parts of it are none."""


@dataclass(frozen=True, slots=True, eq=False)
class Singularity:
    """One way in which a configuration is singular.

    Attributes:
        kind: `platform free` (the member moves with the motors locked), `motors without authority`
            (motors move with the member locked), or `internal` (loops or passive joints alone).
        joints: Share of every joint in the singular direction, largest first; squares of all shares and of
            the member's add up to one.
        motors: The motors that it is about: those locked, or those that move.
        member: Name of the reference member, empty when none is named.
        member_share: Share of the member's motion.
    """

    kind: SingularityKind
    joints: Mapping[str, float]
    motors: tuple[str, ...]
    member: str
    member_share: float

    def __str__(self) -> str:
        shares = listing([f"{name} {share:.2f}" for name, share in self.joints.items()], 6)
        motors = listing(self.motors, 6)
        if self.kind == "platform free":
            return f"{self.member!r} becomes free: it can move with {motors} locked (joints {shares})"
        if self.kind == "motors without authority":
            return f"motors lose authority: {motors} can move with {self.member!r} locked (joints {shares})"
        return f"inner degeneracy: joints gain a motion of their own (joints {shares})"


def singularities_at(
    mechanism: Mechanism, q: Configuration, motors: Iterable[str] | None = None
) -> tuple[Singularity, ...]:
    """What is singular at a closed configuration.

    Args:
        mechanism: The mechanism.
        q: A closed configuration.
        motors: Axes and drives that count as motors; the active ones by default.
    """
    chosen = tuple(mechanism.active if motors is None else motors)
    member = mechanism.reference is not None
    problem = problem_for(mechanism, Holding({}, {}, {}), chosen, member=member)
    state = problem.start(q)
    here = problem.equations(state)
    residual = float(np.linalg.norm(here.gaps))
    around = _neighbours(problem, state, here.jacobian, residual)
    found: list[Singularity] = []
    for watch in watches(problem, chosen, locked(problem)):
        lost = _lost_direction(here.jacobian[:, watch.columns], residual, watch, around)
        if lost is not None:
            found.append(classified(problem, state, watch, *lost, chosen))
    return _distinct(found)


def classified(
    problem: ClosureProblem,
    state: Vector,
    watch: Watch,
    kernel: Matrix,
    lost: Matrix,
    motors: tuple[str, ...],
) -> Singularity:
    """The singularity of a block at a state.

    Args:
        problem: The equations.
        state: The singular state.
        watch: The block.
        kernel: Orthonormal basis of its kernel there.
        lost: Orthonormal directions in it that are free at this state alone.
        motors: Axes and drives that count as motors.
    """
    where = problem.variables
    outside = problem.rates_outside(state)
    everything = np.vstack([np.eye(problem.columns), *outside.values()])[:, watch.columns]
    full = _without_idle(everything, kernel, lost)
    places = dict(where.columns_of)
    start = problem.columns
    for name, rates in outside.items():
        places[name] = slice(start, start + len(rates))
        start += len(rates)
    shares = {name: float(np.linalg.norm(full[place])) for name, place in places.items()}
    part = shares.pop(MEMBER, 0.0)
    moving = {name: float(np.linalg.norm(full[where.column[name]])) for name in motors}
    driven = float(np.linalg.norm(list(moving.values())))
    kind: SingularityKind = "internal"
    if watch.name == "motors locked" and not negligible(part, 1.0, SHARE):
        kind = "platform free"
    elif watch.name in ("member locked", "held") and not negligible(driven, 1.0, SHARE):
        kind = "motors without authority"
        motors = tuple(_named(moving))
    reference = problem.mechanism.reference
    member = reference.body if reference else ""
    return Singularity(kind, _named(shares), motors, member, part)


def _named(shares: Mapping[str, float]) -> dict[str, float]:
    """Those that are told in words, largest first."""
    named = [(name, share) for name, share in shares.items() if share > ZERO_SHARE]
    return dict(sorted(named, key=lambda item: -item[1]))


def _without_idle(everything: Matrix, kernel: Matrix, lost: Matrix) -> Matrix:
    """Rates of all joints in the singular directions, at right angles to those that are always free.

    A rod that spins about itself everywhere has no part in them, whichever of its joints closes the
    loop.  Several directions count alike; the squares of all entries add up to one.
    """
    count = lost.shape[1]
    idle = everything @ kernel @ svd(lost.T @ kernel)[2][:, count:]
    full = everything @ lost
    if idle.shape[1]:
        full = full - idle @ np.linalg.lstsq(idle, full, rcond=None)[0]
    return np.asarray(np.linalg.qr(full)[0] / np.sqrt(count))


def _neighbours(
    problem: ClosureProblem, state: Vector, jacobian: Matrix, residual: float
) -> list[tuple[Matrix, bool]]:
    """Jacobians at closed states near by, and whether each was really away from this one."""
    free = ~locked(problem)
    _, values, right = svd(jacobian[:, free])
    kernel = right[:, decided(jacobian[:, free], residual, values).rank :]
    if kernel.shape[1] == 0:
        return []
    rng = np.random.default_rng(0)
    found = []
    mix = rng.normal(size=kernel.shape[1])
    for size in (NEARBY, -NEARBY):  # evenly about this state: what is linear in the distance cancels
        step = np.zeros(problem.columns)
        step[free] = size * (kernel @ (mix / np.linalg.norm(mix)))
        near = solve(problem, problem.variables.moved(state, step), free, iterations=40)
        away = float(np.linalg.norm(problem.variables.step_between(state, near.state)))
        found.append((near.equations.jacobian, away > 0.1 * NEARBY and near.residual < 1e-10))
    return found


def _lost_direction(
    jacobian: Matrix, residual: float, watch: Watch, around: list[tuple[Matrix, bool]]
) -> tuple[Matrix, Matrix] | None:
    """The kernel, and its directions that are constrained near by; None at a regular block."""
    _, values, right = svd(jacobian)
    rank = decided(jacobian, residual, values).rank
    kernel = right[:, rank:]
    bases, generic = [], rank
    for other, away in around:
        if not away:
            return (kernel, kernel[:, :1]) if watch.name == "loops" and kernel.shape[1] else None
        block = other[:, watch.columns]
        found = decided(block, 0.0).rank
        if found > rank:
            generic = max(generic, found)
            bases.append(svd(block)[2][:, found:])
    if not bases:
        return None
    return kernel, beyond(kernel, bases, generic - rank)


def _distinct(found: list[Singularity]) -> tuple[Singularity, ...]:
    """One singularity of every kind: a degenerate loop shows in every block."""
    kinds: dict[str, Singularity] = {}
    for one in found:
        kinds.setdefault(one.kind, one)
    return tuple(kinds.values())
