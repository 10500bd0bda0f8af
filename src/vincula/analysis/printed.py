"""The printed force numbers: a particular basis, kept for the regression against the paper only.

Source: theory page, section 5, "The printed force numbers".  Not invariant: the result depends on the
cut points and on how contact forces are scaled against wrenches and torques.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from vincula.analysis.relation import force_relation
from vincula.analysis.spectrum import Spectrum, spectrum
from vincula.arrays import Matrix
from vincula.errors import WeightError
from vincula.model import LinearModel
from vincula.numerics.csd import angles_of_pair
from vincula.numerics.metric import Metric
from vincula.numerics.subspaces import complement, kernel, span


def printed_spectrum(
    model: LinearModel, kind: Literal["active force", "passive force"], task: Metric, motor: Metric
) -> Spectrum:
    """Force efficiencies as printed: eqs. (20)-(21) in an orthonormal basis of the kernel of (15).

    The middle block of (19) is the orthogonal complement, in the stacked (w, tau, f) space, of the
    subspaces with tau = 0 and with w = 0; only structural wrenches (active) or internal torques
    (passive) are projected out, although the text asks for both.

    Args:
        model: The mechanism at one configuration.
        kind: Which of the two force ellipsoids.
        task: Metric of wrenches.
        motor: Metric of torques.

    Raises:
        WeightError: A weight that ignores a component, or requires it to be zero.
    """
    if not (task.definite and motor.definite):
        raise WeightError(
            "the printed convention needs weights above zero on every wrench component and torque"
        )
    invariant = spectrum(force_relation(model), task, motor)
    stack, d, n_a = _equilibria(model)
    counts = model.ledger.summary
    if min(counts.as_dict().values()) < 0:
        return invariant  # contradictory rank decisions, flagged by the counts
    free, carried = counts.static_indeterminacy, counts.structural_wrenches
    structural = stack @ kernel(stack[d : d + n_a], stack.shape[1] - free - carried)
    internal = stack @ kernel(stack[:d], stack.shape[1] - free - counts.internal_torques)
    outside = span(np.hstack([structural, internal]), free + carried + counts.internal_torques)
    middle = complement(stack, outside, counts.coordinated)
    wrench, torque = task.factor @ middle[:d], motor.factor @ middle[d : d + n_a]
    if kind == "active force":
        wrench = _without(wrench, task.factor @ structural[:d], carried)
    else:
        torque = _without(torque, motor.factor @ internal[d : d + n_a], counts.internal_torques)
    angles = angles_of_pair(wrench, torque)
    return replace(
        invariant,
        ratios=angles.ratios,
        task=task.inverse @ angles.task,
        motor=motor.inverse @ angles.motor,
    )


def _equilibria(model: LinearModel) -> tuple[Matrix, int, int]:
    """Orthonormal basis of all (w, tau, f) of (15), physical units; d and n_a."""
    forces = model.scaled.row[:, None] * model.ledger.subspaces.left_kernel("passive")
    stack = np.vstack([model.grasp @ forces, -model.jacobian_active.T @ forces, forces])
    return span(stack, stack.shape[1]), model.dimension, len(model.motors)


def _without(block: Matrix, removed: Matrix, rank: int) -> Matrix:
    basis = span(removed, rank)
    return block - basis @ (basis.T @ block)
