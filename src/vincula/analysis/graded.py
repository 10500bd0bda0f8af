"""Bases of motions and equilibria that are accurate entry by entry, for weights of very different size.

Source: numerics page, step 5.  Every basis is in echelon form on pivots that follow the weights, from
one refined solution of (1).  Equilibria are the annihilator of motions: on the rows that are no pivots
of the motions they have the identity, on the others the negative transpose of the same entries.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.model import LinearModel
from vincula.numerics.echelon import graded_pivots, refined_kernel
from vincula.numerics.subspaces import kernel


@dataclass(frozen=True, slots=True, eq=False)
class GradedParts:
    """Bases of the parts of a relation, accurate entry by entry, for weights of very different size.

    Attributes:
        infinite: t x n_inf, motor side zero.
        finite_task: t x n_f.
        finite_motor: r x n_f; the finite part is any complement of the other two.
        zero: r x n_zero, task side zero.
    """

    infinite: Matrix
    finite_task: Matrix
    finite_motor: Matrix
    zero: Matrix


def graded_motions(model: LinearModel, task_sizes: Vector, motor_sizes: Vector) -> GradedParts:
    """Motions of the relation M.

    Args:
        model: The mechanism at one configuration.
        task_sizes: Sizes of the twist components in the metric, scaled.
        motor_sizes: Sizes of the motor rates.
    """
    ledger, subspaces = model.ledger, model.ledger.subspaces
    n_a, n_p = len(model.motors), len(model.passives)
    motions, _ = subspaces.motions_and_equilibria
    k, counts = motions.shape[1], ledger.summary
    free = motions[n_a:] @ kernel(motions[:n_a], k - counts.indeterminacy)
    idle = motions[:n_a] @ kernel(motions[n_a:], k - counts.redundancy)
    of_free = graded_pivots(free, task_sizes, counts.indeterminacy)
    of_idle = graded_pivots(idle, motor_sizes, counts.redundancy)
    taken = [*of_idle, *(n_a + i for i in of_free)]
    rest = graded_pivots(motions, np.concatenate([motor_sizes, task_sizes]), counts.coordinated, taken)
    finite = _motions_on(model, [*taken, *rest])[:, len(taken) :]
    held = _held(model)
    infinite = refined_kernel(
        ledger.matrix("passive+member"), ledger.rank("passive+member"), [n_p + i for i in of_free], held
    )
    zero = refined_kernel(
        ledger.matrix("active+passive"), ledger.rank("active+passive"), of_idle, [n_a + j for j in held]
    )
    return GradedParts(infinite[n_p:], finite[n_a:], finite[:n_a], zero[:n_a])


def graded_equilibria(model: LinearModel, task_sizes: Vector, motor_sizes: Vector) -> GradedParts:
    """Equilibria of the relation F: structural wrenches, transmitted pairs, internal torques.

    Args:
        model: The mechanism at one configuration.
        task_sizes: Sizes of the wrench components in the metric, scaled.
        motor_sizes: Sizes of the motor torques.
    """
    n_a, d = len(model.motors), model.dimension
    motions, equilibria = model.ledger.subspaces.motions_and_equilibria
    k, m, counts = equilibria.shape[1], motions.shape[1], model.ledger.summary
    carried = equilibria[n_a:] @ kernel(equilibria[:n_a], k - counts.structural_wrenches)
    squeezed = equilibria[:n_a] @ kernel(equilibria[n_a:], k - counts.internal_torques)
    of_carried = [n_a + i for i in graded_pivots(carried, task_sizes, counts.structural_wrenches)]
    of_squeezed = graded_pivots(squeezed, motor_sizes, counts.internal_torques)
    taken = [*of_squeezed, *of_carried]
    sizes = np.concatenate([motor_sizes, task_sizes])
    rest = graded_pivots(equilibria, sizes, counts.coordinated, taken)
    finite = _annihilator(model, rest, taken)
    # Torques that no allowed rate feels: motions on rates alone, free twists aside; and the like.
    twists = motions[n_a:] @ kernel(motions[:n_a], m - counts.indeterminacy)
    rates = motions[:n_a] @ kernel(motions[n_a:], m - counts.redundancy)
    of_twists = [n_a + i for i in graded_pivots(twists, np.ones(d), counts.indeterminacy)]
    of_rates = graded_pivots(rates, np.ones(n_a), counts.redundancy)
    others = [n_a + i for i in range(d) if n_a + i not in of_twists]
    infinite = _annihilator(model, of_carried, [i for i in range(n_a) if i not in of_rates])
    zero = _annihilator(model, of_squeezed, others)
    return GradedParts(infinite[n_a:], finite[n_a:], finite[:n_a], zero[:n_a])


def _annihilator(model: LinearModel, free: list[int], held: list[int]) -> Matrix:
    """Pairs (tau, w) that do no work in any motion: the identity on rows `free`, zero on rows `held`."""
    size = len(model.motors) + model.dimension
    pivots = [i for i in range(size) if i not in set(free) and i not in set(held)]
    motions = _motions_on(model, pivots)
    pairs = np.zeros((size, len(free)))
    pairs[free, range(len(free))] = 1.0
    pairs[pivots] = -motions[free].T
    return pairs


def _motions_on(model: LinearModel, pivots: list[int]) -> Matrix:
    """Motions (q_a, u) with the identity on the pivot rows, refined."""
    ledger = model.ledger
    n_a, n_p = len(model.motors), len(model.passives)
    columns = [i if i < n_a else i + n_p for i in pivots]
    found = refined_kernel(ledger.matrix("all"), ledger.rank("all"), columns, [n_a + j for j in _held(model)])
    return np.vstack([found[:n_a], found[n_a + n_p :]])


def _held(model: LinearModel) -> list[int]:
    """Passive joints to hold still so that none moves by itself."""
    passive = model.ledger.subspaces.kernel("passive")
    return graded_pivots(passive, np.ones(passive.shape[0]), passive.shape[1])
