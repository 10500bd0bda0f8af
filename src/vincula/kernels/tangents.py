"""Directions in which a mechanism can change, each with the rate of change of its matrices.

Along the closed manifold passive joints follow the motors; when a dimension changes, the loops are
closed again with the motors where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.analysis.sensitivity import Sensitivities
from vincula.arrays import Matrix, Vector
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.many_frames import crossed
from vincula.mechanism.many_matrices import ManyMatrices
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.placement_rates import PlacementRates
from vincula.mechanism.redrawn import Redrawn
from vincula.mechanism.second_order import FrameMotion, MatrixDerivative
from vincula.model import LinearModel
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

CLOSES: Final = 1e-7
"""How far loops may stay open, or motors have to move, beside what a parameter moves at all."""
SEEN: Final = 1e-9
"""How far derivatives may depend on motions that no joint takes part in."""
LOOSE: Final = "the member moves with all motors locked: motor positions do not say where it goes"
NO_CLOSING: Final = "the loops do not close again with the motors held: this parameter has no derivative"


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """One way to change.

    Attributes:
        rate: Rate of [J_a J_p -G^T] in scaled coordinates; None where the direction does not exist.
        reason: Why it does not.
    """

    rate: Matrix | None
    reason: str = ""


class Tangents:
    """The ways to change a mechanism at one closed configuration.

    Args:
        mechanism: The mechanism.
        q: The configuration.
        model: Its linear model there.
        found: The model's sensitivities.
    """

    def __init__(
        self, mechanism: Mechanism, q: Configuration, model: LinearModel, found: Sensitivities
    ) -> None:
        self.mechanism, self.q, self.model, self.found = mechanism, q, model, found
        self._derivative = MatrixDerivative(mechanism, q)
        scaled = model.scaled
        factors = np.concatenate([scaled.active_column, scaled.passive_column, scaled.twist])
        self._factors: Vector = factors
        self.motions: Matrix = factors[:, None] * found.kernel

    def of_motors(self) -> list[Direction]:
        """One direction a motor: its rate is one, the other motors stand still, passive joints follow."""
        n_a = len(self.model.motors)
        motors = self.motions[:n_a]
        left, values, right = svd(motors)
        rank = decide_rank(motors, name="motor rates that are possible").rank
        if rank < self.motions.shape[1] - max(0, self.model.ledger.summary.passive_redundancy):
            return [Direction(None, LOOSE)] * n_a
        directions = []
        for k in range(n_a):
            wanted = np.eye(n_a)[k]
            outside = left[:, rank:] @ (left[:, rank:].T @ wanted)
            if float(np.linalg.norm(outside)) > 1e-9:
                words = f"motor {self.model.motors[k].name!r} cannot move while the others stand"
                directions.append(Direction(None, words))
            else:
                motion = self.motions @ ((right[:, :rank] / values[:rank]) @ (left[:, :rank].T @ wanted))
                directions.append(self.along(motion))
        return directions

    def of_motions(self) -> list[Direction]:
        """One direction for every motion in `motions`."""
        return [self.along(motion) for motion in self.motions.T]

    def along(self, motion: Vector) -> Direction:
        """The direction of one motion (q_a, q_p, u) [m/s, rad/s]."""
        layout = self._derivative.layout
        jacobian, member = self._derivative.along(*self._parted(motion))
        return self._checked(
            self.found.scaled_rate(jacobian[:, layout.active], jacobian[:, layout.passive], member)
        )

    def of_parameters(self, rates: PlacementRates) -> list[Direction]:
        """One direction a parameter: the loops close again, the motors stay where they are.

        Args:
            rates: How the numbers of the mechanism change.
        """
        if self.model.ledger.summary.indeterminacy > 0:
            return [Direction(None, LOOSE)] * len(rates.turn)
        many = ManyMatrices(self.mechanism, self.q.flat[None])
        redrawn = Redrawn(many, rates)
        return [self._redrawn(redrawn, place) for place in range(len(rates.turn))]

    def _redrawn(self, redrawn: Redrawn, place: int) -> Direction:
        """The direction of one parameter: frames move in their bodies, and the mechanism after them."""
        many, layout = redrawn.many, self._derivative.layout
        scaled = self.model.scaled
        frames, point = redrawn.frames[0, place], redrawn.point[0, place]
        size = float(np.linalg.norm(frames)) + float(np.linalg.norm(redrawn.opening[0, place]))
        closing = self._closing(scaled.row * redrawn.opening[0, place], size)
        if closing is None or float(np.abs(redrawn.rigid[0, place]).max(initial=0.0)) > CLOSES * size:
            return Direction(None, NO_CLOSING)
        rates, twist = self._parted(closing)
        s = len(self._derivative.origin)
        moving = self._derivative.frame_motion(rates, twist)
        arm = many.frames.position[0] - many.frames.origin[0]
        velocity = frames[:, :3] + crossed(frames[:, 3:], arm)
        moving = FrameMotion(moving.turn + frames[:, -len(twist) + s :], moving.velocity + velocity[:, :s])
        jacobian, member = self._derivative.of_frames(moving, twist[:s] + point[:s], twist[s:], rates)
        more, on_member = _beside_frames(redrawn, place)
        jacobian, member = jacobian + more, member + on_member
        return self._checked(
            self.found.scaled_rate(jacobian[:, layout.active], jacobian[:, layout.passive], member)
        )

    def _closing(self, opening: Vector, size: float) -> Vector | None:
        """The motion [m/s, rad/s] that closes gaps of the rows again, motors standing; None if none does."""
        n_a = len(self.model.motors)
        shortest, left_open = self.found.closing(opening)
        if not float(np.linalg.norm(left_open)) <= CLOSES * size:
            return None
        motors = self.found.kernel[:n_a]
        rank = decide_rank(motors, name="motor rates that are possible").rank
        left, values, right = svd(motors)
        back = right[:, :rank] @ ((left[:, :rank].T @ shortest[:n_a]) / values[:rank])
        motion = shortest - self.found.kernel @ back
        if not float(np.linalg.norm(motion[:n_a])) <= CLOSES * size:
            return None
        return self._factors * motion

    def _parted(self, motion: Vector) -> tuple[Vector, Vector]:
        """Rates in the order of the layout, and the twist of the member in ground axes."""
        layout = self._derivative.layout
        n_a, n_p = len(self.model.motors), len(self.model.passives)
        rates = np.zeros(n_a + n_p)
        rates[layout.active], rates[layout.passive] = motion[:n_a], motion[n_a : n_a + n_p]
        return rates, self._in_ground_axes(motion[n_a + n_p :])

    def _in_ground_axes(self, twist: Vector) -> Vector:
        reference = self.mechanism.reference
        if reference is None or reference.axes == "ground":
            return twist
        rotation = self.mechanism.body_poses(self.q)[reference.body].rotation
        s = len(rotation)
        turned = rotation @ twist[s:] if s == 3 else twist[s:]
        return np.concatenate([rotation @ twist[:s], turned])

    def _checked(self, rate: Matrix) -> Direction:
        if not self.found.keeps_rank(rate):
            return Direction(None, "the rank changes here: at a singularity nothing has a derivative")
        return Direction(rate)


def _beside_frames(redrawn: Redrawn, place: int) -> tuple[Matrix, Matrix]:
    """Rates of J (layout's columns) and G^T by what no frame carries: leads, second axes, couplings."""
    many = redrawn.many
    layout, geometric = many.layout, len(many.layout.signs)
    jacobian = np.zeros((len(layout.rows), len(layout.columns)))
    member = np.zeros((1, len(layout.rows), 6))
    if redrawn.screws is not None:
        jacobian[:geometric] += (many.blocked[0] @ redrawn.screws[0, place].T) * layout.signs
    if redrawn.blocked is not None:
        rows = redrawn.blocked[0, place]
        jacobian[:geometric] += (rows @ many.screws[0].T) * layout.signs
        member[0, :geometric] = layout.carried[:, None] * rows
    if redrawn.constant is not None:
        jacobian[geometric:] += redrawn.constant[0, place]
    return jacobian, many.in_own_axes(member)[0]
