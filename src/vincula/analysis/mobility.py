"""What can move: the blocks of (2)-(5), each with its meaning, a basis and its residual.

Source: theory page, section 3.  Unique are the kernels, {u = 0}, {q_a = 0}, {q_p = 0} and the whole
kernel of (1); the blocks are complements inside them, of the dimensions that the ledger gives.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, frozen
from vincula.model import LinearModel
from vincula.numerics.ledger import MatrixName
from vincula.numerics.subspaces import complement, span


@dataclass(frozen=True, slots=True, eq=False)
class MotionBlock:
    """A set of feasible motions, one a column.

    Attributes:
        name: Its name in the glossary.
        meaning: In words.
        motors: n_a x k motor rates [rad/s or m/s].
        passives: n_p x k passive rates.
        twist: d x k twists of the reference member.
        residual: Largest constraint velocity that a motion of length one leaves, relative to the
            largest singular value of (1), scaled units: about 1e-16 when the block satisfies (1).
    """

    name: str
    meaning: str
    motors: Matrix
    passives: Matrix
    twist: Matrix
    residual: float

    @property
    def count(self) -> int:
        """Dimension of the block."""
        return int(self.twist.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class MotionBlocks:
    """The seven blocks; together a basis of all feasible motions.

    Attributes:
        active_redundancy: Gamma_a,r: motors move, nothing else does.
        passive_redundancy: Gamma_p,r: passive joints move, nothing else does.
        indeterminate_object: Gamma_o,i: the member moves with all joints still.
        indeterminate_with_passive: Gamma_po,i and Gamma_op,i: the member and passive joints move,
            motors locked.
        object_locked: Gamma_a,p,c and Gamma_pa,c: motors and passive joints, member at rest.
        all_moving: Gamma_a,po,c, Gamma_poa,c and Gamma_opa,c: all three must move.
        passive_locked: Gamma_a,o,c and Gamma_oa,c: motors and member, passive joints at rest.
    """

    active_redundancy: MotionBlock
    passive_redundancy: MotionBlock
    indeterminate_object: MotionBlock
    indeterminate_with_passive: MotionBlock
    object_locked: MotionBlock
    all_moving: MotionBlock
    passive_locked: MotionBlock

    def __iter__(self) -> Iterator[MotionBlock]:
        yield self.active_redundancy
        yield self.passive_redundancy
        yield self.indeterminate_object
        yield self.indeterminate_with_passive
        yield self.object_locked
        yield self.all_moving
        yield self.passive_locked


_MEANINGS = {
    "active_redundancy": "motors move, nothing else does",
    "passive_redundancy": "passive joints move, nothing else does",
    "indeterminate_object": "the member moves with all joints still",
    "indeterminate_with_passive": "the member moves with passive joints, motors locked",
    "object_locked": "motors and passive joints move, the member rests",
    "all_moving": "motors, passive joints and member must all move",
    "passive_locked": "motors and member move, passive joints rest",
}


def motion_blocks(model: LinearModel) -> MotionBlocks:
    """The blocks of (2)-(5) of a model.

    When directions lie in all three ranges (t > 0) they appear in `object_locked` and in
    `indeterminate_with_passive`, whose sum is the motion with passive joints locked, and not in
    `passive_locked`.
    """
    counts = model.ledger.counts
    a, p, o = (_embedded(model, name) for name in ("active", "passive", "member"))
    still = _embedded(model, "active+passive")
    locked = _embedded(model, "passive+member")
    without_passive = _embedded(model, "active+member")
    everything = _embedded(model, "all")
    po = complement(locked, np.hstack([p, o]), max(counts.po + counts.t, 0))
    ap = complement(still, np.hstack([a, p]), max(counts.ap + counts.t, 0))
    both = still.shape[1] + locked.shape[1] - p.shape[1]
    known = span(np.hstack([still, locked]), both)
    ao = complement(without_passive, known, max(counts.ao, 0))
    known = span(np.hstack([known, ao]), both + ao.shape[1])
    g = complement(everything, known, max(counts.g, 0))
    found = {
        "active_redundancy": a,
        "passive_redundancy": p,
        "indeterminate_object": o,
        "indeterminate_with_passive": po,
        "object_locked": ap,
        "all_moving": g,
        "passive_locked": ao,
    }
    return MotionBlocks(**{name: _block(model, name, basis) for name, basis in found.items()})


_PRESENT: dict[MatrixName, tuple[bool, bool, bool]] = {
    "active": (True, False, False),
    "passive": (False, True, False),
    "member": (False, False, True),
    "active+passive": (True, True, False),
    "active+member": (True, False, True),
    "passive+member": (False, True, True),
    "all": (True, True, True),
}


def _embedded(model: LinearModel, name: MatrixName) -> Matrix:
    """The kernel of one stacked matrix as motions (q_a, q_p, u), orthonormal in scaled units."""
    basis = model.ledger.subspaces.kernel(name)
    widths = len(model.motors), len(model.passives), model.dimension
    present = np.repeat(_PRESENT[name], widths)
    motions = np.zeros((sum(widths), basis.shape[1]))
    motions[present] = basis
    return motions


def _block(model: LinearModel, name: str, basis: Matrix) -> MotionBlock:
    n_a, n_p = len(model.motors), len(model.passives)
    ledger, scaled = model.ledger, model.scaled
    left = ledger.matrix("all") @ basis
    residual = float(np.linalg.norm(left, axis=0).max(initial=0.0))
    return MotionBlock(
        name=name,
        meaning=_MEANINGS[name],
        motors=frozen(scaled.active_column[:, None] * basis[:n_a]),
        passives=frozen(scaled.passive_column[:, None] * basis[n_a : n_a + n_p]),
        twist=frozen(scaled.twist[:, None] * basis[n_a + n_p :]),
        residual=residual / ledger.scale if ledger.scale else residual,
    )
