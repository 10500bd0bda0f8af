"""What can be held: the force blocks of (19) and the conditions (17)-(18).

Source: theory page, section 5.  w is the wrench of the surroundings on the member, f the constraint
forces, tau the torques of the motors: w = G f, tau = -J_a^T f, 0 = J_p^T f (15).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vincula.analysis.relation import force_relation
from vincula.analysis.spectrum import spectrum
from vincula.arrays import Matrix, frozen
from vincula.model import LinearModel
from vincula.numerics.lapack import svd
from vincula.numerics.metric import Metric


@dataclass(frozen=True, slots=True, eq=False)
class ForceBlock:
    """A set of equilibria, one a column.

    Attributes:
        name: Its name in the glossary.
        meaning: In words.
        wrench: d x k wrenches on the member [N, N m].
        torque: n_a x k motor torques [N m or N].
        contact_force: m x k constraint forces, least norm in scaled units [N or N m].
        residual: Largest violation of (15), relative to the force, scaled units.
    """

    name: str
    meaning: str
    wrench: Matrix
    torque: Matrix
    contact_force: Matrix
    residual: float

    @property
    def count(self) -> int:
        """Dimension of the block."""
        return int(self.wrench.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class ForceBlocks:
    """The four blocks of (19); together a basis of all equilibria.

    Attributes:
        internal: x_h: torques that squeeze, no wrench.
        transmitted: x_a: wrenches that the motors balance.
        structural: x_s: wrenches that the skeleton carries without motor torque.
        undetermined: ker G with ker J^T: forces that neither wrench nor torque determines.
    """

    internal: ForceBlock
    transmitted: ForceBlock
    structural: ForceBlock
    undetermined: ForceBlock

    def __iter__(self) -> Iterator[ForceBlock]:
        yield self.internal
        yield self.transmitted
        yield self.structural
        yield self.undetermined


def force_blocks(model: LinearModel, wrench: Metric, torque: Metric) -> ForceBlocks:
    """The blocks of (19), mutually orthogonal in the metrics.

    Structural and transmitted wrenches satisfy Gamma_s^T W_w Gamma_w = 0, internal and transmitted
    torques Gamma_h^T W_tau Gamma_tau = 0.  Columns have length one in the metric of torques
    (internal, transmitted) or of wrenches (structural).

    Args:
        model: The mechanism at one configuration.
        wrench: W_w, definite.
        torque: W_tau, definite.
    """
    found = spectrum(force_relation(model), wrench, torque)
    d, n_a = model.dimension, len(model.motors)
    none_w, none_t = np.zeros((d, found.zero.shape[1])), np.zeros((n_a, found.infinite.shape[1]))
    return ForceBlocks(
        internal=_block(model, "internal", "motors squeeze, no wrench on the member", none_w, found.zero),
        transmitted=_block(
            model, "transmitted", "wrenches balanced by the motors", found.task * found.ratios, found.motor
        ),
        structural=_block(
            model, "structural", "wrenches carried without motor torque", found.infinite, none_t
        ),
        undetermined=_undetermined(model),
    )


def balances_every_wrench(model: LinearModel) -> bool:
    """Conditions (17)-(18): ker G^T = 0, and range(G^T) meets range(J_p) only at 0."""
    return model.ledger.summary.indeterminacy == 0


def _block(model: LinearModel, name: str, meaning: str, wrench: Matrix, torque: Matrix) -> ForceBlock:
    scaled, ledger = model.scaled, model.ledger
    loads = np.vstack(
        [
            scaled.active_column[:, None] * torque,
            np.zeros((len(model.passives), torque.shape[1])),
            scaled.twist[:, None] * wrench,
        ]
    )
    # [J_a J_p -G^T]^T f = -(tau, 0, w): least-norm f, rank from the ledger.
    left, values, right = svd(ledger.matrix("all"))
    rank = ledger.rank("all")
    forces = -left[:, :rank] @ ((right[:, :rank].T @ loads) / values[:rank, None])
    return _checked_block(model, name, meaning, wrench, torque, forces, loads)


def _undetermined(model: LinearModel) -> ForceBlock:
    forces = model.ledger.subspaces.left_kernel("all")
    k = forces.shape[1]
    loads = np.zeros((len(model.columns) + model.dimension, k))
    meaning = "forces that neither wrench nor torque determines"
    wrench, torque = np.zeros((model.dimension, k)), np.zeros((len(model.motors), k))
    return _checked_block(model, "undetermined", meaning, wrench, torque, forces, loads)


def _checked_block(
    model: LinearModel,
    name: str,
    meaning: str,
    wrench: Matrix,
    torque: Matrix,
    forces: Matrix,
    loads: Matrix,
) -> ForceBlock:
    ledger = model.ledger
    left = np.linalg.norm(ledger.matrix("all").T @ forces + loads, axis=0)
    size = ledger.scale * np.linalg.norm(forces, axis=0)
    worst = (left / np.where(size > 0.0, size, 1.0)).max(initial=0.0)
    return ForceBlock(
        name=name,
        meaning=meaning,
        wrench=frozen(np.array(wrench)),
        torque=frozen(np.array(torque)),
        contact_force=frozen(model.scaled.row[:, None] * forces),
        residual=float(worst),
    )
