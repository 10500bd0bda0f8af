"""Directions in which a mechanism can change, each with the rate of change of its matrices.

Along the closed manifold passive joints follow the motors; when a dimension changes, the loops are
closed again with the motors where they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from vincula.analysis.sensitivity import Sensitivities
from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_solver import minimum_norm
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import held_columns, holding, problem_for
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.modes import motors_at
from vincula.mechanism.second_order import MatrixDerivative
from vincula.model import LinearModel
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

Varied = Callable[[Mapping[str, float]], Mechanism]
"""The mechanism at other values of its parameters."""
STEP = 2e-5
"""Relative step of a dimension: the loops stay closed to its square, well within what counts as closed."""


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
        self.motions: Matrix = factors[:, None] * found.kernel

    def of_motors(self) -> list[Direction]:
        """One direction a motor: its rate is one, the other motors stand still, passive joints follow."""
        n_a = len(self.model.motors)
        motors = self.motions[:n_a]
        left, values, right = svd(motors)
        rank = decide_rank(motors, name="motor rates that are possible").rank
        if rank < self.motions.shape[1] - max(0, self.model.ledger.summary.passive_redundancy):
            words = "the member moves with all motors locked: motor positions do not say where it goes"
            return [Direction(None, words)] * n_a
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
        n_a, n_p = len(self.model.motors), len(self.model.passives)
        rates = np.zeros(n_a + n_p)
        rates[layout.active], rates[layout.passive] = motion[:n_a], motion[n_a : n_a + n_p]
        jacobian, member = self._derivative.along(rates, self._in_ground_axes(motion[n_a + n_p :]))
        return self._checked(
            self.found.scaled_rate(jacobian[:, layout.active], jacobian[:, layout.passive], member)
        )

    def of_parameter(
        self, build: Callable[[Mapping[str, float]], Mechanism], at: Mapping[str, float], name: str
    ) -> Direction:
        """The direction of one declared parameter, the loops closing again with the motors held.

        The way of the joints comes from the closure equations; the matrices are then compared a little
        to both sides along it (two steps, extrapolated: about 1e-10 relative).

        Args:
            build: Makes the variants.
            at: Values of all parameters here [m, rad].
            name: The one that changes.
        """
        held = holding(self.mechanism, motors_at(self.mechanism, self.q))
        problem = problem_for(self.mechanism, held)
        free = ~held_columns(problem, held)
        state = problem.start(self.q)
        size = STEP * max(abs(at[name]), min(1.0, self.mechanism.length))

        def varied(step: float) -> Mechanism:
            return build({**at, name: at[name] + step})

        def gaps(step: float) -> Vector:
            return problem_for(varied(step), held).gaps(state)

        opening = (8.0 * (gaps(size) - gaps(-size)) - (gaps(2 * size) - gaps(-2 * size))) / (12.0 * size)
        follow = np.zeros(problem.columns)
        follow[free] = minimum_norm(problem.equations(state).jacobian[:, free], -opening)

        def matrices(step: float) -> tuple[Matrix, Matrix, Matrix]:
            mechanism = varied(step)
            there = problem_for(mechanism, held)
            moved = there.configuration(there.variables.moved(state, step * follow), self.q)
            model = mechanism.linearize(moved)
            return model.jacobian_active, model.jacobian_passive, model.grasp.T

        near = _slopes(matrices(size / 2), matrices(-size / 2), size)
        far = _slopes(matrices(size), matrices(-size), 2 * size)
        better = [(4.0 * one - other) / 3.0 for one, other in zip(near, far, strict=True)]
        return self._checked(self.found.scaled_rate(*better))

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


def _slopes(
    plus: tuple[Matrix, Matrix, Matrix], minus: tuple[Matrix, Matrix, Matrix], between: float
) -> list[Matrix]:
    return [(one - other) / between for one, other in zip(plus, minus, strict=True)]
