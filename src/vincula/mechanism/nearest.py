"""The nearest singular configuration: Gauss-Newton on f(q) = 0, J(q) v = 0, c . v = 1.

Source: numerics page, "Helpers that decide doubt" (deflated polish).  c is the direction that a doubtful
singular value belongs to; v stays perpendicular to the motions that the block has anyway, so that at the
solution it is one motion more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding, problem_for
from vincula.mechanism.watching import locked
from vincula.numerics.evidence import NearestSingular
from vincula.numerics.lapack import svd
from vincula.numerics.ledger import MatrixName
from vincula.numerics.rank import decide_rank

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

FARTHEST: Final = 0.1
"""A singular configuration farther away than this is not the one that was doubted [rad, or lengths L]."""
CLOSED: Final = 1e-10
"""What the equations may leave, scaled."""
SMALLEST_SHARE: Final = 0.005
"""Joints with less of the motion are not named."""
_STEP: Final = 1e-5
"""Step of the central differences of J(q) v: truncation and rounding are both about 1e-10."""
_ITERATIONS: Final = 40
_CLOSED_BY: Final[dict[MatrixName, tuple[bool, bool]]] = {
    "all": (False, False),
    "passive+member": (True, False),
    "active+passive": (False, True),
    "passive": (True, True),
}
"""For the four matrices of the summary counts, whether motors and member are locked."""


@dataclass(frozen=True, slots=True, eq=False)
class _Deflation:
    """The enlarged equations at one block of columns."""

    problem: ClosureProblem
    free: Mask
    block: Mask
    direction: Vector
    others: Matrix

    def values(self, state: Vector, v: Vector) -> tuple[Vector, Matrix]:
        """Everything that must vanish, and the Jacobian of the loops."""
        here = self.problem.equations(state)
        motion = here.jacobian[:, self.block] @ v
        rest = np.array([self.direction @ v - 1.0, *(self.others.T @ v)])
        return np.concatenate([here.gaps, motion, rest]), here.jacobian

    def jacobian(self, state: Vector, v: Vector, of_loops: Matrix) -> Matrix:
        """Derivatives with respect to the free rates and v."""
        turned = self._turned(state, v, of_loops)[:, self.free]
        loops = of_loops[:, self.block]
        rest = np.vstack([self.direction, self.others.T])
        upper = np.hstack([of_loops[:, self.free], np.zeros_like(loops)])
        middle = np.hstack([turned, loops])
        return np.vstack([upper, middle, np.hstack([np.zeros((len(rest), turned.shape[1])), rest])])

    def _turned(self, state: Vector, v: Vector, of_loops: Matrix) -> Matrix:
        """Derivatives of J(q) v, by one central difference along v: second derivatives are symmetric.

        But for rates of balls, which are no coordinates: turning about e and then along v is not turning
        along v and then about e; they differ by turning about e x v.
        """
        along = np.zeros(self.problem.columns)
        along[self.block] = v
        step = _STEP / max(1.0, float(np.linalg.norm(v)))
        moved = (self.problem.variables.moved(state, sign * step * along) for sign in (1.0, -1.0))
        ahead, behind = (self.problem.equations(there).jacobian for there in moved)
        turned: Matrix = (ahead - behind) / (2.0 * step)
        for ball in self.problem.variables.balls:
            turned[:, ball] += of_loops[:, ball] @ np.cross(np.eye(3), along[ball]).T
        return turned


def nearest_singular(
    mechanism: Mechanism, q: Configuration, doubtful: tuple[MatrixName, ...]
) -> NearestSingular | None:
    """The singular configuration that a doubtful one may be; None where none is found near by.

    Args:
        mechanism: The mechanism.
        q: A closed configuration.
        doubtful: The matrices whose ranks are doubtful; the first of the four that the summary counts
            rest on is looked at.
    """
    name = next((name for name in _CLOSED_BY if name in doubtful), None)
    if name is None:
        return None
    motors = tuple(mechanism.active)
    problem = problem_for(mechanism, Holding({}, {}, {}), motors, member=mechanism.reference is not None)
    start = problem.start(q)
    deflation = _deflation(problem, start, motors, *_CLOSED_BY[name])
    return None if deflation is None else _polished(deflation, start, q)


def _deflation(
    problem: ClosureProblem, state: Vector, motors: tuple[str, ...], hold_motors: bool, hold_member: bool
) -> _Deflation | None:
    where = problem.variables
    free = ~locked(problem)
    block = free.copy()
    if hold_motors:
        block[[where.column[name] for name in motors]] = False
    if hold_member and MEMBER in where.columns_of:
        block[where.columns_of[MEMBER]] = False
    jacobian = problem.equations(state).jacobian[:, block]
    if not jacobian.size:
        return None
    _, values, right = svd(jacobian)
    # The doubtful value is the smallest that rounding does not explain, or the first that it does.
    rank = min(decide_rank(jacobian, values=values).rank_max, len(values))
    if rank == 0:
        return None
    return _Deflation(problem, free, block, right[:, rank - 1], right[:, rank:])


def _polished(deflation: _Deflation, start: Vector, q: Configuration) -> NearestSingular | None:
    problem = deflation.problem
    state, v = start, deflation.direction.copy()
    left, of_loops = deflation.values(state, v)
    fraction, count = 1.0, int(deflation.free.sum())
    for _ in range(_ITERATIONS):
        before = float(np.linalg.norm(left))
        if before < 1e-14 or fraction < 1e-3:
            break
        full = -_solved(deflation.jacobian(state, v, of_loops), left)
        step = np.zeros(problem.columns)
        step[deflation.free] = fraction * full[:count]
        trial, turned = problem.variables.moved(state, step), v + fraction * full[count:]
        new, jacobian = deflation.values(trial, turned)
        if float(np.linalg.norm(new)) >= before:
            fraction *= 0.25
            continue
        state, v, left, of_loops, fraction = trial, turned, new, jacobian, min(1.0, 2.0 * fraction)
    return _found(deflation, start, state, v, left, q)


def _solved(jacobian: Matrix, right_side: Vector) -> Vector:
    """The shortest least-squares solution at the decided rank."""
    left, values, right = svd(jacobian)
    # The differences in the Jacobian are good to about 1e-10: smaller values are none.
    rank = decide_rank(jacobian, values=values, uncertainty={"differences": 1e-9}).rank
    return np.asarray(right[:, :rank] @ ((left[:, :rank].T @ right_side) / values[:rank]))


def _found(
    deflation: _Deflation, start: Vector, state: Vector, v: Vector, left: Vector, q: Configuration
) -> NearestSingular | None:
    problem = deflation.problem
    residual = float(np.linalg.norm(left))
    where = problem.variables
    step = where.step_between(start, state)
    distance = float(np.linalg.norm(step))
    if not (residual <= CLOSED and distance <= FARTHEST):
        return None
    jacobian = deflation.jacobian(state, v, problem.equations(state).jacobian)
    sigma = decide_rank(jacobian, uncertainty={"differences": 1e-9}).kept
    moved = step * where.column_scale
    own = [k for k, name in enumerate(where.names) if not name.startswith(MEMBER)]
    most = max(own, key=lambda k: abs(float(step[k])))
    return NearestSingular(
        distance=distance,
        largest=(where.names[most], float(moved[most])),
        residual=residual,
        kantorovich=residual / (sigma * sigma),
        configuration={
            name: tuple(map(float, values)) for name, values in problem.configuration(state, q).items()
        },
        joints=_shares(deflation, v),
    )


def _shares(deflation: _Deflation, v: Vector) -> dict[str, float]:
    """Squared shares of joints in a motion of the block, largest first."""
    motion = np.zeros(deflation.problem.columns)
    motion[deflation.block] = v / float(np.linalg.norm(v))
    shares = {
        name: float(motion[place] @ motion[place])
        for name, place in deflation.problem.variables.columns_of.items()
        if name != MEMBER
    }
    return dict(sorted(((n, s) for n, s in shares.items() if s >= SMALLEST_SHARE), key=lambda pair: -pair[1]))
