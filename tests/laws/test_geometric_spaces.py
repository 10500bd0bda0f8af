"""Ranks, counts and spaces of 300 random mechanisms are those that plain numpy finds; all kinds occur."""

from __future__ import annotations

from collections import Counter

import numpy as np
from tests.laws.holding import IN_BLOCKS, hold, model_of
from tests.laws.motion_spaces import apart, equilibria, motions, relation
from tests.laws.random_mechanisms import COUNT, random_drawn, random_mechanism

from vincula.mechanism.joint_types import JOINT_TYPES
from vincula.spatial.selectors import CONTACT_TYPES


def test_every_kind_of_part_and_answer_occurs() -> None:
    """The laws hold on what was meant: nothing is missing from the random mechanisms."""
    seen: Counter[str] = Counter()
    for seed in range(COUNT):
        mechanism, model, drawn = random_mechanism(seed), model_of(seed), random_drawn(seed)
        kinds = {joint.type for joint in mechanism.joints}
        kinds |= {contact.type for contact in mechanism.contacts}
        kinds |= {row.kind for row in model.rows}
        kinds |= {name for name in model.ledger.counts.__slots__ if getattr(model.ledger.counts, name)}
        kinds |= {
            f"on ground {sum('ground' in (p.first, p.second) for p in (*drawn.joints, *drawn.contacts))}"
        }
        carried = [name for name, it in mechanism.reduction.carried.items() if it and name != "member"]
        kinds |= {"carried"} if carried else set()
        kinds |= {"second object"} if "object" in mechanism.body else set()
        kinds |= {"locked"} if mechanism.lock else set()
        seen.update(kinds)
    counts = ("ar", "pr", "oi", "t", "ap", "ao", "po", "g", "a", "p", "o", "none")
    rows = ("contact", "member cut", "loop cut", "coupling", "drive")
    more = ("carried", "second object", "locked", *(f"on ground {k}" for k in (1, 2, 3, 4)))
    rare = {
        name: seen[name] for name in (*JOINT_TYPES, *CONTACT_TYPES, *counts, *rows, *more) if seen[name] < 5
    }
    assert not rare


@IN_BLOCKS
def test_ranks_and_spaces_are_those_of_plain_numpy(block: range) -> None:
    def law(seed: int, rng: np.random.Generator) -> None:
        model = model_of(seed)
        counts, summary = model.ledger.counts, model.ledger.summary
        whole = motions(model)
        motors = [c.name for c in model.motors]
        twist = [f"u.{c}" for c in model.twist_components]
        assert model.ledger.status == "certain"
        assert whole.basis.shape[1] == summary.mobility
        assert all(getattr(counts, name) >= 0 for name in counts.__slots__)

        def still(*names: str) -> int:
            """Dimension of the motions in which these rows are at rest."""
            held = whole.of(names)
            return (
                whole.basis.shape[1] - int(np.linalg.matrix_rank(held, tol=1e-9))
                if names
                else whole.basis.shape[1]
            )

        free_passives = still(*motors, *twist)
        assert free_passives == summary.passive_redundancy
        assert still(*twist) - free_passives == summary.redundancy
        assert still(*motors) - free_passives == summary.indeterminacy
        rank_of = {rows: summary.mobility - still(*names) for rows, names in (("q", motors), ("u", twist))}
        assert len(motors) - rank_of["q"] == summary.internal_torques
        assert len(twist) - rank_of["u"] == summary.structural_wrenches
        forces = np.hstack([model.scaled.active, model.scaled.passive, model.scaled.member])
        rank = int(np.linalg.matrix_rank(forces, tol=1e-9)) if forces.size else 0
        assert len(model.rows) - rank == summary.static_indeterminacy

    hold(block, law)


@IN_BLOCKS
def test_equilibria_are_the_annihilator_of_motions(block: range) -> None:
    """(15) by itself, from its own kernel, gives exactly what does no work on any motion."""

    def law(seed: int, rng: np.random.Generator) -> None:
        model = model_of(seed)
        m, f = relation(model), equilibria(model)
        assert np.abs(m.T @ f).max(initial=0.0) < 1e-9
        left = np.linalg.matrix_rank(m, tol=1e-9) if m.size else 0
        right = np.linalg.matrix_rank(f, tol=1e-9) if f.size else 0
        assert left + right == len(model.motors) + model.dimension
        own_motions, own_forces = model.ledger.subspaces.motions_and_equilibria
        assert apart(m, own_motions) < 1e-6
        assert apart(f, own_forces) < 1e-6

    hold(block, law)
