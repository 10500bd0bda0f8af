"""Verdicts: the counts of mobility and statics in plain words that name joints and bodies.

Verdicts are made from the seven summary counts, which do not depend on where the graph was cut.
"""

from __future__ import annotations

import numpy as np

from vincula.analysis.localise import localised
from vincula.analysis.relation import force_relation
from vincula.analysis.wording import (
    components,
    count_of,
    joint_list,
    motion_of_body,
)
from vincula.arrays import Matrix, Vector
from vincula.errors import listing
from vincula.labels import Column
from vincula.model import LinearModel
from vincula.numerics.lapack import svd
from vincula.numerics.rank import negligible
from vincula.numerics.subspaces import complement


def verdicts(model: LinearModel) -> list[str]:
    """What the mechanism can do at this configuration, one sentence a fact."""
    counts = model.ledger.summary
    said = [_overall(model)]
    if counts.passive_redundancy:
        said += _free_passives(model)
    if counts.redundancy:
        said += _redundant_motors(model)
    if counts.indeterminacy:
        said += indeterminate_motions(model)
    said.append(_driven(model))
    if counts.structural_wrenches:
        said.append(_structural(model))
    if counts.internal_torques:
        said.append(_internal(model))
    if counts.static_indeterminacy:
        said.append(_undetermined(model))
    return said + contradictions(model)


def contradictions(model: LinearModel) -> list[str]:
    """Rank decisions that contradict each other: negative counts."""
    negative = model.ledger.counts.contradictory
    if not negative:
        return []
    said = (
        f"The rank decisions contradict each other (negative: {listing(negative)}): the configuration is "
        "too near a singular one for these numbers."
    )
    return [said]


def _overall(model: LinearModel) -> str:
    counts = model.ledger.summary
    if counts.mobility == 0:
        return f"Nothing can move: {model.mechanism!r} is a structure at this configuration."
    if not model.rows:
        loops = "No constraint rows: every joint and the member move freely"
        return f"{loops} ({count_of(counts.mobility, 'motion')})."
    return f"{count_of(counts.mobility, 'independent motion')} in all (mobility {counts.mobility})."


def _driven(model: LinearModel) -> str:
    counts, member = model.ledger.summary, repr(model.reference)
    if not model.motors:
        return "No motors: whatever moves, moves freely, and whatever is held, is held by the structure."
    everything = " Every joint axis carries a motor." if not model.passives else ""
    if counts.coordinated == 0:
        return f"The motors do not move {member}.{everything}"
    ways = count_of(counts.coordinated, "independent way")
    if counts.indeterminacy:
        return f"The motors drive {member} in {ways}, besides what they leave free.{everything}"
    return f"The motors drive {member} in {ways} and hold it when locked.{everything}"


def _free_passives(model: LinearModel) -> list[str]:
    """One verdict a motion of passive joints alone: spinning legs, mostly."""
    n_a = len(model.motors)
    simple = localised(model.ledger.subspaces.kernel("passive"), doubt=model.ledger.subspace_doubt)
    simple = simple * model.scaled.passive_column[:, None]
    said = []
    for column in simple.T:
        joints = joint_list(_taking_part(column, model.passives))
        rates = np.concatenate([np.zeros(n_a), column])
        body = _bodies(model, rates, np.zeros(model.dimension))
        if body:
            said.append(f"{body}: {joints} (motors and {model.reference!r} at rest).")
        else:
            said.append(f"Passive {joints} can move with motors and {model.reference!r} at rest.")
    return said


def _redundant_motors(model: LinearModel) -> list[str]:
    """Motor motions that leave the member at rest."""
    n_a = len(model.motors)
    free = model.ledger.subspaces.kernel("passive")
    alone = np.vstack([np.zeros((n_a, free.shape[1])), free])
    found = complement(
        model.ledger.subspaces.kernel("active+passive"), alone, model.ledger.summary.redundancy
    )
    rests = f"while {model.reference!r} rests (redundancy)"
    said, alone_moving = [], []
    for column in localised(found, slice(0, n_a), model.ledger.subspace_doubt).T:
        motors = _taking_part(column[:n_a], model.motors)
        passives = _taking_part(column[n_a:], model.passives)
        if len(motors) == 1 and not passives:
            alone_moving += motors
            continue
        with_passive = f", together with passive {joint_list(passives)}" if passives else ""
        said.append(f"Motors can move {rests}: {joint_list(motors)}{with_passive}.")
    if len(alone_moving) > 1:
        said.append(f"Each of these motors can move by itself {rests}: {joint_list(alone_moving)}.")
    elif alone_moving:
        said.append(f"Motors can move {rests}: {joint_list(alone_moving)}.")
    return said


def indeterminate_motions(model: LinearModel) -> list[str]:
    """Motions of the member with all motors locked: one sentence each, with the joints that take part."""
    n_p = len(model.passives)
    if not np.any(model.grasp):
        return [f"Nothing holds {model.reference!r}: it moves freely in all {model.dimension} directions."]
    free = model.ledger.subspaces.kernel("passive")
    alone = np.vstack([free, np.zeros((model.dimension, free.shape[1]))])
    found = complement(
        model.ledger.subspaces.kernel("passive+member"), alone, model.ledger.summary.indeterminacy
    )
    said = []
    for column in localised(found, slice(n_p, None), model.ledger.subspace_doubt).T:
        twist = model.scaled.twist * column[n_p:]
        if not np.any(twist):
            said.append(f"{model.reference!r} moves with all motors locked; doubt hides the direction.")
            continue
        joints = _taking_part(model.scaled.passive_column * column[:n_p], model.passives)
        how = f"direction {components(twist / (np.abs(twist).max() or 1.0), model.twist_components)}"
        if model.motions is not None and model.frame == "ground axes":
            verb, path = motion_of_body(model, twist, model.motions.origin, model.ledger.subspace_doubt)
            how = f"it can {verb} {path} ({how})"
        moving = joint_list(joints) if joints else "no joint moves"
        said.append(f"{model.reference!r} moves with all motors locked: {how}; {moving}.")
    return said


def _structural(model: LinearModel) -> str:
    counts = model.ledger.summary
    if counts.structural_wrenches == model.dimension:
        return f"Every wrench on {model.reference!r} is carried by the structure without motor torque."
    relation = force_relation(model)
    free = _kernel_side(relation.motor, relation.task, counts.structural_wrenches)
    wrenches = localised(free, doubt=model.ledger.subspace_doubt) * relation.task_factor[:, None]
    words = "; ".join(components(w / np.linalg.norm(w), model.wrench_components) for w in wrenches.T)
    return (
        f"{count_of(counts.structural_wrenches, 'wrench', 'wrenches')} on {model.reference!r} carried by the "
        f"structure without motor torque: {words}."
    )


def _undetermined(model: LinearModel) -> str:
    count = model.ledger.summary.static_indeterminacy
    return (
        f"{count_of(count, 'constraint force')} cannot be found from wrench and torques: the structure is "
        "statically indeterminate (the number depends on how closures are written)."
    )


def _internal(model: LinearModel) -> str:
    counts = model.ledger.summary
    relation = force_relation(model)
    torques = _kernel_side(relation.task, relation.motor, counts.internal_torques)
    loaded = {
        name for column in localised(torques, doubt=model.ledger.subspace_doubt).T
        for name in _taking_part(column, model.motors)
    }  # fmt: skip
    # In the order of the motors: that of a basis may hang on rounding.
    joints = [column.joint for column in model.motors if column.joint in loaded]
    ways = count_of(counts.internal_torques, "way")
    return (
        f"The motors can work against each other in {ways} without pushing on anything outside: "
        f"{joint_list(joints)}."
    )


def _kernel_side(vanishing: Matrix, wanted: Matrix, count: int) -> Matrix:
    """The `wanted` side of the pairs whose other side vanishes."""
    return wanted @ svd(vanishing)[2][:, vanishing.shape[1] - count :]


def _taking_part(rates: Vector, columns: tuple[Column, ...]) -> list[str]:
    size = float(np.abs(rates).max(initial=0.0))
    return [c.joint for c, rate in zip(columns, rates, strict=True) if not negligible(abs(float(rate)), size)]


def _bodies(model: LinearModel, rates: Vector, twist: Vector) -> str:
    """Which bodies move and how, for joint rates and a member twist; empty without geometry."""
    motions = model.motions
    if motions is None:
        return ""
    twists = motions.twists(rates, twist)
    length = np.repeat(
        [1.0, model.length or 1.0], [len(motions.origin), model.dimension - len(motions.origin)]
    )
    sizes = np.linalg.norm(twists * length[:, None], axis=0)
    doubt = model.ledger.subspace_doubt
    moving = [i for i, size in enumerate(sizes) if not negligible(float(size), float(sizes.max()), doubt)]
    if not moving:
        return ""
    ways: dict[tuple[str, str], list[str]] = {}
    for i in moving:
        how = motion_of_body(model, twists[:, i], motions.origin, doubt)
        ways.setdefault(how, []).append(motions.names[i])
    return "; ".join(
        f"{'Body' if len(names) == 1 else 'Bodies'} {listing(names)} can {verb} freely {path}"
        for (verb, path), names in ways.items()
    )
