"""Answers do not depend on how a mechanism is written down: 300 random ones, written in many ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation
from tests.laws.holding import IN_BLOCKS, hold, model_of
from tests.laws.motion_spaces import (
    apart,
    assert_same_numbers,
    assert_same_relation,
    motions,
)
from tests.laws.random_mechanisms import Drawn, random_drawn, random_mechanism

from vincula.errors import TopologyError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, Cut
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR
from vincula.spatial.twists import block_rotation, transport


@IN_BLOCKS
def test_choice_of_tree_and_cut_points(block: range) -> None:
    """Cuts declared elsewhere, at arbitrary points: all motions of all joints, and all twelve counts."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, base = random_mechanism(seed), model_of(seed)
        names = [joint.name for joint in mechanism.joints]
        cuts: dict[str, Cut] = {}
        for name in rng.permutation(names)[:6]:
            point = tuple(map(float, rng.normal(size=mechanism.space.translations)))
            wanted = {**cuts, str(name): Cut("kept", point)}
            if _is_possible(mechanism, wanted):
                cuts = wanted
        other = with_cuts(mechanism, cuts).linearize()
        assert {c.joint for c in other.cuts} >= set(cuts)
        assert other.ledger.counts == base.ledger.counts
        assert_same_numbers(base, other)
        names = sorted(motions(base).rows)
        assert set(names) == set(motions(other).rows)
        assert apart(motions(base).of(names), motions(other).of(names)) < 1e-6

    hold(block, law)


def with_cuts(mechanism: Mechanism, cuts: dict[str, Cut]) -> Mechanism:
    reference = mechanism.reference
    assert reference is not None
    return replace(mechanism, reference=replace(reference, cuts=cuts))


def _is_possible(mechanism: Mechanism, cuts: dict[str, Cut]) -> bool:
    """Whether these joints can be cut all at once: a joint that no loop goes through cannot."""
    try:
        with_cuts(mechanism, cuts).reduction  # noqa: B018
    except TopologyError:
        return False
    return True


@IN_BLOCKS
def test_cuts_kept_or_as_contacts(block: range) -> None:
    """Selector rows instead of complete rows and columns: of the twelve counts pr, a, o, none stay."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, base = random_mechanism(seed), model_of(seed)
        cuts: dict[str, Cut] = {}
        for cut in base.cuts:
            wanted = {**cuts, cut.joint: Cut("contact")}
            if rng.random() < 0.8 and _is_possible(mechanism, wanted):
                cuts = wanted
        other = with_cuts(mechanism, cuts).linearize()
        assert {c.joint for c in other.cuts if c.kind == "contact"} == set(cuts)
        assert_same_relation(base, other)
        assert_same_numbers(base, other)
        for name in ("pr", "a", "o", "none"):
            assert getattr(other.ledger.counts, name) == getattr(base.ledger.counts, name)

    hold(block, law)


@IN_BLOCKS
def test_order_of_declaration(block: range) -> None:
    def law(seed: int, rng: np.random.Generator) -> None:
        drawn, base = random_drawn(seed), model_of(seed)
        shuffled = replace(
            drawn,
            joints=tuple(drawn.joints[k] for k in rng.permutation(len(drawn.joints))),
            contacts=tuple(drawn.contacts[k] for k in rng.permutation(len(drawn.contacts))),
            active=tuple(drawn.active[k] for k in rng.permutation(len(drawn.active))),
        )
        other = shuffled.mechanism().linearize()
        assert_same_relation(base, other)
        assert_same_numbers(base, other)
        assert other.ledger.counts == base.ledger.counts

    hold(block, law)


@IN_BLOCKS
def test_direction_of_joints_and_contacts(block: range) -> None:
    """First and second body exchanged: rates change sign, the axes of a universal joint change places."""

    def law(seed: int, rng: np.random.Generator) -> None:
        drawn, base = random_drawn(seed), model_of(seed)
        flips = {joint.name: rng.random() < 0.5 for joint in drawn.joints}
        names: dict[str, tuple[str, float]] = {}
        joints = []
        for joint in drawn.joints:
            axes = drawn.kind(joint)
            if not flips[joint.name]:
                joints.append(joint)
                continue
            turned = replace(joint, first=joint.second, second=joint.first)
            if joint.type == "universal":
                turned = replace(turned, axis=joint.second_axis, second_axis=joint.axis)
                names |= {axes[0]: (axes[1], -1.0), axes[1]: (axes[0], -1.0)}
            else:
                names |= {axis: (axis, -1.0) for axis in axes}
            joints.append(turned)
        contacts = [
            replace(c, first=c.second, second=c.first, normal=-np.asarray(c.normal))
            if rng.random() < 0.5
            else c
            for c in drawn.contacts
        ]

        def renamed(terms: dict[str, float]) -> dict[str, float]:
            pairs = [(names.get(axis, (axis, 1.0)), c) for axis, c in terms.items()]
            return {name: factor * c for (name, factor), c in pairs}

        other = replace(
            drawn,
            joints=tuple(joints),
            contacts=tuple(contacts),
            couplings=tuple(replace(c, rates=renamed(dict(c.rates))) for c in drawn.couplings),
            drives=tuple(replace(d, drives=renamed(dict(d.drives))) for d in drawn.drives),
            active=tuple(names.get(axis, (axis, 1.0))[0] for axis in drawn.active),
            lock=tuple(names.get(axis, (axis, 1.0))[0] for axis in drawn.lock),
        )
        model = other.mechanism().linearize()
        assert_same_relation(base, model, motors=names)
        assert_same_numbers(base, model)
        assert model.ledger.counts == base.ledger.counts

    hold(block, law)


def moved(mechanism: Mechanism, pose: Pose) -> Mechanism:
    """The whole mechanism carried to another place, everything on the ground with it."""

    def on_ground(body: str, frame: Pose) -> Pose:
        return pose @ frame if body == GROUND else frame

    reference = mechanism.reference
    assert reference is not None
    return replace(
        mechanism,
        bodies=tuple(replace(b, pose=pose @ b.pose) for b in mechanism.bodies),
        joints=tuple(
            replace(
                j,
                frame_on_first=on_ground(j.first, j.frame_on_first),
                frame_on_second=on_ground(j.second, j.frame_on_second),
            )
            for j in mechanism.joints
        ),
        contacts=tuple(
            replace(
                c,
                frame_on_first=on_ground(c.first, c.frame_on_first),
                frame_on_second=on_ground(c.second, c.frame_on_second),
            )
            for c in mechanism.contacts
        ),
    )


@IN_BLOCKS
def test_rigid_motion_of_the_whole_mechanism(block: range) -> None:
    """Twists turn along with the mechanism; in body axes nothing changes at all."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, base = random_mechanism(seed), model_of(seed)
        s = mechanism.space.translations
        if mechanism.space is PLANAR:
            pose = Pose.from_angle(float(rng.uniform(-3, 3)), 5 * rng.normal(size=2))
        else:
            pose = Pose.at(5 * rng.normal(size=3), Rotation.random(random_state=rng).as_matrix())
        other = moved(mechanism, pose)
        model = other.linearize()
        assert model.length == base.length
        assert_same_relation(base, model, twist=block_rotation(pose.rotation))
        assert_same_numbers(base, model)
        assert model.ledger.counts == base.ledger.counts
        assert other.reference is not None
        in_body_axes = replace(other, reference=replace(other.reference, axes="body")).linearize()
        assert_same_relation(base, in_body_axes)
        assert in_body_axes.frame == "axes of member"
        assert s == len(pose.position)

    hold(block, law)


@IN_BLOCKS
def test_mirror_image(block: range) -> None:
    """In a mirror turns go the other way round, screws change hand, everything else stays."""

    def law(seed: int, rng: np.random.Generator) -> None:
        drawn, base = random_drawn(seed), model_of(seed)
        s = drawn.space.translations
        normal = rng.normal(size=s)
        normal /= np.linalg.norm(normal)
        glass = np.eye(s) - 2 * np.outer(normal, normal)

        def seen(vector):  # type: ignore[no-untyped-def]
            return None if vector is None else glass @ np.asarray(vector)

        mirrored = replace(
            drawn,
            joints=tuple(
                replace(j, at=seen(j.at), axis=seen(j.axis), second_axis=seen(j.second_axis), lead=-j.lead)
                for j in drawn.joints
            ),
            contacts=tuple(
                replace(c, at=seen(c.at), normal=seen(c.normal), line=seen(c.line)) for c in drawn.contacts
            ),
            bodies=tuple(replace(b, at=seen(b.at)) for b in drawn.bodies),
            origin=glass @ drawn.origin,
            couplings=tuple(replace(c, rates=_mirrored_terms(drawn, dict(c.rates))) for c in drawn.couplings),
            drives=tuple(replace(d, drives=_mirrored_terms(drawn, dict(d.drives))) for d in drawn.drives),
        )
        other = mirrored.mechanism().linearize()
        turn = np.eye(base.dimension)
        turn[:s, :s] = glass
        turn[s:, s:] = -glass if s == 3 else [[-1.0]]
        assert_same_numbers(base, other)
        assert other.ledger.counts == base.ledger.counts
        if not any(j.type in ("spherical", "planar", "free") for j in _driven(drawn)):
            motors = {c.name: (c.name, 1.0 if c.linear else -1.0) for c in base.motors}
            motors |= {d.name: (d.name, 1.0) for d in drawn.drives}
            assert_same_relation(base, other, motors=motors, twist=turn)

    hold(block, law)


def _driven(drawn: Drawn):  # type: ignore[no-untyped-def]
    return [j for j in drawn.joints if set(drawn.kind(j)) & set(drawn.active)]


def _mirrored_terms(drawn: Drawn, terms: dict[str, float]) -> dict[str, float]:
    """Coefficients of turning axes change sign."""
    slides = {axis for j in drawn.joints if j.type == "prismatic" for axis in drawn.kind(j)}
    return {axis: c if axis in slides else -c for axis, c in terms.items()}


@IN_BLOCKS
def test_reference_point_and_units_of_length(block: range) -> None:
    """Another point carries the twist there; millimetres multiply what is linear by a thousand."""

    def law(seed: int, rng: np.random.Generator) -> None:
        drawn, base = random_drawn(seed), model_of(seed)
        offset = rng.normal(size=drawn.space.translations)
        other = drawn.mechanism(origin=drawn.origin + offset).linearize()
        assert_same_relation(base, other, twist=transport(offset))
        assert other.ledger.counts == base.ledger.counts
        model = _in_millimetres(drawn).mechanism().linearize()
        assert model.ledger.counts == base.ledger.counts
        motors = {c.name: (c.name, 1000.0 if c.linear else 1.0) for c in base.motors}
        twist = np.diag(np.where(base.twist_linear, 1000.0, 1.0))
        assert_same_relation(base, model, motors=motors, twist=twist)

    hold(block, law)


def _in_millimetres(drawn: Drawn) -> Drawn:
    """The same mechanism with every length a thousand times as large; mixed couplings go along."""
    slides = {axis for j in drawn.joints if j.type == "prismatic" for axis in drawn.kind(j)}

    def scaled(terms: dict[str, float]) -> dict[str, float]:
        mixed = bool(slides & set(terms))
        return {axis: c * (1000.0 if mixed and axis not in slides else 1.0) for axis, c in terms.items()}

    return replace(
        drawn,
        joints=tuple(replace(j, at=1000 * np.asarray(j.at), lead=1000 * j.lead) for j in drawn.joints),
        contacts=tuple(replace(c, at=1000 * np.asarray(c.at)) for c in drawn.contacts),
        bodies=tuple(replace(b, at=1000 * np.asarray(b.at)) for b in drawn.bodies),
        origin=1000 * drawn.origin,
        couplings=tuple(replace(c, rates=scaled(dict(c.rates))) for c in drawn.couplings),
        drives=tuple(replace(d, drives=scaled(dict(d.drives))) for d in drawn.drives),
    )
