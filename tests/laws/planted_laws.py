"""The laws of the numerics page that need only matrices; each returns what it finds broken."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from tests.laws.planted import Matrix, Planted, model, planted
from tests.laws.planted_peers import (
    UNITS,
    compare,
    gentle,
    inverse,
    no_larger,
    nonzero,
    null,
    random_matrix,
    same_space,
    same_values,
    small,
    without,
)

from vincula.analysis.equilibrium import ForceBlocks, force_blocks
from vincula.analysis.maps import torque_from_wrench, twist_from_rates
from vincula.analysis.mobility import MotionBlocks, motion_blocks
from vincula.analysis.recipes import ellipsoid_of_kind
from vincula.analysis.relation import force_relation
from vincula.analysis.spectrum import spectrum
from vincula.numerics.metric import Metric, identity_metric
from vincula.weights import Weights

Law = Callable[[Planted, np.random.Generator], Iterator[str]]


def counts_and_dimensions(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """The twelve counts, and every dimension that follows from them."""
    ledger, c = p.model.ledger, p.counts
    n_a, d = p.active.shape[1], p.member.shape[1]
    motions, equilibria = ledger.subspaces.motions_and_equilibria
    summary, kinematic = ledger.summary, ellipsoid_of_kind("kinematic", p.model, _EXPLICIT)
    passive, active = (
        ellipsoid_of_kind(kind, p.model, _EXPLICIT) for kind in ("passive force", "active force")
    )
    nullity = c["ar"] + c["pr"] + c["oi"] + 2 * c["t"] + c["ap"] + c["ao"] + c["po"] + c["g"]
    yield from compare(
        {
            "counts": (ledger.counts.as_dict(), c),
            "status": (ledger.status, "certain"),
            "nullity": (ledger.counts.nullity, nullity),
            "mobility": (summary.mobility, nullity),
            "dim M": (motions.shape[1], nullity - c["pr"]),
            "dim F": (equilibria.shape[1], n_a + d - nullity + c["pr"]),
            "redundancy": (summary.redundancy, c["ar"] + c["ap"] + c["t"]),
            "indeterminacy": (summary.indeterminacy, c["oi"] + c["po"] + c["t"]),
            "coordinated": (summary.coordinated, c["ao"] + c["g"]),
            "internal torques": (summary.internal_torques, c["a"]),
            "structural wrenches": (summary.structural_wrenches, c["o"]),
            "static indeterminacy": (summary.static_indeterminacy, c["none"]),
            "infinite kinematic": (kinematic.classes.count("infinite"), c["oi"] + c["po"] + c["t"]),
            "zero kinematic": (kinematic.classes.count("zero"), c["ar"] + c["ap"] + c["t"]),
            "infinite force": (passive.classes.count("infinite"), c["o"]),
            "zero force": (active.classes.count("zero"), c["a"]),
            "feasible rates": (np.linalg.matrix_rank(motions[:n_a], 1e-8) + c["a"], n_a),
            "reachable twists": (np.linalg.matrix_rank(motions[n_a:], 1e-8) + c["o"], d),
        }
    )


def blocks_of_motion(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Blocks satisfy (1), have their dimensions, and together span all motions."""
    c, blocks = p.counts, motion_blocks(p.model)
    yield from compare(
        {
            "active_redundancy": (blocks.active_redundancy.count, c["ar"]),
            "passive_redundancy": (blocks.passive_redundancy.count, c["pr"]),
            "indeterminate_object": (blocks.indeterminate_object.count, c["oi"]),
            "indeterminate_with_passive": (blocks.indeterminate_with_passive.count, c["po"] + c["t"]),
            "object_locked": (blocks.object_locked.count, c["ap"] + c["t"]),
            "passive_locked": (blocks.passive_locked.count, c["ao"]),
            "all_moving": (blocks.all_moving.count, c["g"]),
        }
    )
    yield from (f"{b.name}: residual {b.residual}" for b in blocks if b.residual > 1e-13)
    whole = _stacked(blocks)
    yield from same_space("all motions", whole, p.kernel)
    n_a, n_p = p.active.shape[1], p.passive.shape[1]
    rows = {"q_a": slice(0, n_a), "q_p": slice(n_a, n_a + n_p), "u": slice(n_a + n_p, None)}
    inside = {
        "u": (blocks.active_redundancy, blocks.passive_redundancy, blocks.object_locked),
        "q_a": (blocks.passive_redundancy, blocks.indeterminate_object, blocks.indeterminate_with_passive),
    }
    for name, parts in inside.items():
        found = np.hstack([_column(part) for part in parts])
        kernel = p.kernel @ null(p.kernel[rows[name]])
        yield from same_space(f"{{{name} = 0}}", found, kernel)


def blocks_of_force(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Blocks satisfy (15), are orthogonal in the metrics, and together span all equilibria."""
    wrench, torque = _random_metric(p.member.shape[1], rng), _random_metric(p.active.shape[1], rng)
    blocks = force_blocks(p.model, wrench, torque)
    c = p.counts
    yield from compare(
        {
            "internal": (blocks.internal.count, c["a"]),
            "transmitted": (blocks.transmitted.count, c["ao"] + c["g"]),
            "structural": (blocks.structural.count, c["o"]),
            "undetermined": (blocks.undetermined.count, c["none"]),
        }
    )
    yield from (f"{b.name}: residual {b.residual}" for b in blocks if b.residual > 1e-11)
    across = blocks.structural.wrench.T @ wrench.matrix @ blocks.transmitted.wrench
    squeeze = blocks.internal.torque.T @ torque.matrix @ blocks.transmitted.torque
    size = 1.0 + np.abs(blocks.transmitted.wrench).max(initial=0.0)
    yield from small("structural against transmitted", across / size)
    yield from small("internal against transmitted", squeeze)
    yield from same_space("all equilibria", _forces(blocks), null(p.passive.T))
    yield from _virtual_work(p, blocks)


def efficiencies_of_the_paper(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Finite efficiencies are the generalised eigenvalues of (8), (11)-(13), computed apart."""
    twist, rate = random_matrix(p.member.shape[1], rng), random_matrix(p.active.shape[1], rng)
    found = ellipsoid_of_kind("kinematic", p.model, Weights(rate=rate, twist=twist)).finite
    n_a, n_p = p.active.shape[1], p.passive.shape[1]
    q, u = p.kernel[:n_a], p.kernel[n_a + n_p :]
    # Worst case over indeterminacy, best over redundancy: remove both in their metrics.
    u_left = without(np.linalg.cholesky(twist).T @ u, np.linalg.cholesky(twist).T @ u @ null(q))
    q_left = without(np.linalg.cholesky(rate).T @ q, np.linalg.cholesky(rate).T @ q @ null(u))
    gain = u_left @ inverse(q_left)
    values = np.linalg.svd(gain, compute_uv=False) ** 2 if gain.size else np.empty(0)
    yield from same_values("kinematic efficiencies", found, values[: len(found)])
    yield from small("further efficiencies", values[len(found) :])


def duality(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Force spectra, computed by themselves, are reciprocal to the kinematic one; so are the maps."""
    d, n_a = p.member.shape[1], p.active.shape[1]
    weights = Weights(rate=random_matrix(n_a, rng), twist=random_matrix(d, rng), reciprocal=True)
    motions = ellipsoid_of_kind("kinematic", p.model, weights)
    wrench, torque = weights.metric("wrench", p.model), weights.metric("torque", p.model)
    apart = spectrum(force_relation(p.model), wrench, torque)
    yield from same_values("dual", apart.ratios[::-1] ** 2, 1.0 / motions.finite)
    for kind in ("active force", "passive force", "dual force"):
        forces = ellipsoid_of_kind(kind, p.model, weights)
        yield from same_values(kind, forces.finite[::-1], 1.0 / motions.finite)
    passive = ellipsoid_of_kind("passive force", p.model, weights)
    lines = [w for w, c in zip(passive.task_directions, passive.classes, strict=True) if c == "infinite"]
    yield from same_space("structural wrenches", np.array(lines).reshape(len(lines), d).T, apart.infinite)
    if p.model.ledger.summary.indeterminacy == 0:
        rates = twist_from_rates(p.model, weights.metric("twist", p.model), weights.metric("rate", p.model))
        torques = torque_from_wrench(p.model, wrench, torque)
        if rates.matrix is None or torques.matrix is None:
            yield "maps missing"
        else:
            size = 1.0 + float(np.abs(rates.matrix).max(initial=0.0))
            yield from small("S + T^T", (torques.matrix + rates.matrix.T) / size)


def invariance(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Mixing rows or passive coordinates, and changing motor units with their metric, changes nothing."""
    d, n_a = p.member.shape[1], p.active.shape[1]
    twist, rate = random_matrix(d, rng), random_matrix(n_a, rng)
    before = ellipsoid_of_kind("kinematic", p.model, Weights(rate=rate, twist=twist))
    rows, free = gentle(p.active.shape[0], rng), gentle(p.passive.shape[1], rng)
    units = 10.0 ** rng.integers(-3, 4, n_a)
    changed = model(rows @ p.active * units, rows @ p.passive @ free, rows @ p.member)
    after = ellipsoid_of_kind("kinematic", changed, Weights(rate=rate * np.outer(units, units), twist=twist))
    yield from compare(
        {
            "counts": (changed.ledger.counts, p.model.ledger.counts),
            "classes": (after.classes, before.classes),
        }
    )
    yield from same_values("efficiencies after mixing", after.finite, before.finite, UNITS)


def monotony(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Weights scale; heavier rates lower efficiencies; a motor added never raises one; a lock shrinks M."""
    d, n_a = p.member.shape[1], p.active.shape[1]
    twist, rate = random_matrix(d, rng), np.diag(10.0 ** rng.uniform(-1, 1, n_a))
    base = ellipsoid_of_kind("kinematic", p.model, Weights(rate=rate, twist=twist)).finite
    scaled = ellipsoid_of_kind("kinematic", p.model, Weights(rate=4.0 * rate, twist=9.0 * twist)).finite
    yield from same_values("scaled weights", scaled, base * 9.0 / 4.0)
    push = rng.standard_normal((n_a, 2))
    heavier = ellipsoid_of_kind("kinematic", p.model, Weights(rate=rate + push @ push.T, twist=twist)).finite
    yield from no_larger("heavier rates", heavier, base)
    if p.passive.shape[1]:
        more = model(np.hstack([p.active, p.passive[:, :1]]), p.passive[:, 1:], p.member)
        wide = np.diag([*np.diag(rate), 1.0])
        finer = ellipsoid_of_kind("kinematic", more, Weights(rate=wide, twist=twist))
        before = ellipsoid_of_kind("kinematic", p.model, Weights(rate=rate, twist=twist))
        yield from no_larger("a motor added", nonzero(finer.efficiencies), nonzero(before.efficiencies))
    if n_a:
        locked = model(p.active[:, 1:], p.passive, p.member).ledger.subspaces.motions_and_equilibria[0]
        free = p.model.ledger.subspaces.motions_and_equilibria[0]
        widened = np.vstack([np.zeros(locked.shape[1]), locked])
        yield from small("a lock leaves M", widened - free @ (free.T @ widened))
        largest = ellipsoid_of_kind("kinematic", p.model, _EXPLICIT).efficiencies
        freed = model(p.active[:, 1:], np.hstack([p.passive, p.active[:, :1]]), p.member)
        after = ellipsoid_of_kind("kinematic", freed, _EXPLICIT).efficiencies
        yield from no_larger("a joint freed", nonzero(largest)[:1], nonzero(after)[:1])


def internal_forces(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Squeezing forces: (22)-(23) against plain numpy, with definite weights on all rows."""
    force = random_matrix(p.active.shape[0], rng)
    torque = random_matrix(p.active.shape[1], rng)
    found = ellipsoid_of_kind("internal force", p.model, Weights(contact_force=force, torque=torque))
    f = null(np.hstack([p.passive, p.member]).T)
    tau = -p.active.T @ f
    weigh = np.linalg.cholesky(force).T
    left = without(weigh @ f, weigh @ f @ null(tau))
    gain = left @ inverse(np.linalg.cholesky(torque).T @ tau)
    values = np.linalg.svd(gain, compute_uv=False) ** 2 if gain.size else np.empty(0)
    yield from compare(
        {
            "infinite": (found.classes.count("infinite"), p.counts["none"]),
            "finite": (found.classes.count("finite"), p.counts["a"]),
        }
    )
    yield from same_values("internal efficiencies", found.finite, values[: len(found.finite)])


def positions_only(p: Planted, rng: np.random.Generator) -> Iterator[str]:
    """Ignored twist components: the projection of the full set; their reciprocal: the section."""
    d, n_a = p.member.shape[1], p.active.shape[1]
    kept = rng.random(d) < 0.6
    weights = Weights(twist=kept.astype(float), rate=np.ones(n_a), reciprocal=True)
    part = ellipsoid_of_kind("kinematic", p.model, weights)
    n_p = p.passive.shape[1]
    q, u = p.kernel[:n_a], p.kernel[n_a + n_p :][kept]
    gain = without(u, u @ null(q)) @ inverse(without(q, q @ null(u)))
    rank = np.linalg.matrix_rank
    both, of_q, of_u = rank(np.vstack([q, u]), 1e-8), rank(q, 1e-8), rank(u, 1e-8)
    yield from compare(
        {
            "infinite": (part.classes.count("infinite"), int(both - of_q)),
            "zero": (part.classes.count("zero"), int(both - of_u)),
            "finite": (part.classes.count("finite"), int(of_q + of_u - both)),
            "undefined": (part.classes.count("undefined"), p.kernel.shape[1] - p.counts["pr"] - int(both)),
        }
    )
    values = np.linalg.svd(gain, compute_uv=False) ** 2 if gain.size else np.empty(0)
    yield from same_values("projected", part.finite, values[: len(part.finite)])
    wrench, torque = weights.metric("wrench", p.model), weights.metric("torque", p.model)
    forces = spectrum(force_relation(p.model), wrench, torque)
    yield from same_values("sectioned", forces.ratios[::-1] ** 2, 1.0 / part.finite)
    yield from small("required zeros", forces.task[~kept])


LAWS: tuple[Law, ...] = (
    counts_and_dimensions,
    blocks_of_motion,
    blocks_of_force,
    efficiencies_of_the_paper,
    duality,
    invariance,
    monotony,
    internal_forces,
    positions_only,
)
_EXPLICIT = Weights()


def broken_laws(seed: int, at_once: int = 2) -> list[str]:
    """What the mechanism of a seed breaks: its counts always, the other laws in turn, `at_once` of them."""
    p = planted(np.random.default_rng(seed))
    others = LAWS[1:]
    chosen = [others[(at_once * seed + k) % len(others)] for k in range(at_once)]
    return [
        f"seed {seed} {law.__name__}: {broken}"
        for law in (LAWS[0], *chosen)
        for broken in law(p, np.random.default_rng(seed))
    ]


def _virtual_work(p: Planted, blocks: ForceBlocks) -> Iterator[str]:
    n_a, n_p = p.active.shape[1], p.passive.shape[1]
    q, u = p.kernel[:n_a], p.kernel[n_a + n_p :]
    scale = 1.0 + max(float(np.abs(b.wrench).max(initial=0.0)) for b in blocks)
    for block in blocks:
        yield from small(f"virtual work of {block.name}", (block.torque.T @ q + block.wrench.T @ u) / scale)


def _stacked(blocks: MotionBlocks) -> Matrix:
    return np.hstack([_column(block) for block in blocks])


def _column(block: object) -> Matrix:
    return np.vstack([block.motors, block.passives, block.twist])  # type: ignore[attr-defined]


def _forces(blocks: ForceBlocks) -> Matrix:
    return np.hstack([block.contact_force for block in blocks])


def _random_metric(size: int, rng: np.random.Generator) -> Metric:
    weights = Weights(rate=random_matrix(size, rng))
    columns = model(np.zeros((0, size)), np.zeros((0, 0)), np.zeros((0, 1)))
    return weights.metric("rate", columns) if size else identity_metric(0)
