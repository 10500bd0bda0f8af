"""Gradients by dimensions against central differences of mechanisms that were built and closed again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.laws.random_closed import displaced, random_closed

import vincula as vc
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import ContactPart, Joint
from vincula.spatial.poses import Pose, rotation_about

STEP = 1e-4
KINEMATIC = "kinematic.efficiencies"
FORCE = "passive_force.efficiencies"


def turned_by(spatial: bool, turn: np.ndarray) -> np.ndarray:
    if not spatial:
        return Pose.from_angle(float(turn[2])).rotation
    size = float(np.linalg.norm(turn))
    return rotation_about(turn / size, size) if size else np.eye(3)


def varied(mechanism: Mechanism, seed: int) -> Callable[..., Mechanism]:
    """A builder that moves all frames in their bodies, the reference point, leads and second axes."""
    spatial = mechanism.space.translations == 3

    def build(p: float = 0.0) -> Mechanism:
        rng = np.random.default_rng(seed)

        def pose(found: Pose) -> Pose:
            turn, shift = rng.normal(size=3), rng.normal(size=mechanism.space.translations)
            return Pose(turned_by(spatial, p * turn) @ found.rotation, found.position + 0.3 * p * shift)

        def part(found: Joint) -> Joint:
            axis = turned_by(True, p * rng.normal(size=3)) @ found.second_axis
            return replace(
                found,
                frame_on_first=pose(found.frame_on_first),
                frame_on_second=pose(found.frame_on_second),
                lead=found.lead * (1.0 + p),
                second_axis=axis if found.type == "universal" else found.second_axis,
            )

        def contact(found: ContactPart) -> ContactPart:
            return replace(
                found,
                frame_on_first=pose(found.frame_on_first),
                frame_on_second=pose(found.frame_on_second),
            )

        member = mechanism.reference
        moved = member.origin + p * rng.normal(size=len(member.origin))
        return replace(
            mechanism,
            joints=tuple(map(part, mechanism.joints)),
            contacts=tuple(map(contact, mechanism.contacts)),
            reference=replace(member, origin=moved),
        )

    return build


def held(mechanism: Mechanism, q: vc.Configuration) -> dict[str, float]:
    """Values of the motors, by axis or drive."""
    from vincula.mechanism.modes import motors_at

    return dict(motors_at(mechanism, q))


def check(
    build: Callable[..., Mechanism],
    q: vc.Configuration,
    weights: vc.Weights | None,
    quantities: tuple[str, ...] = (KINEMATIC, FORCE),
) -> None:
    nominal = build()
    compiled = vc.compile(build, weights=weights)
    ends = []
    for step in (1.0, -1.0, 2.0, -2.0):
        there = build(p=step * STEP)
        closed = there.close(near=q, motors=held(nominal, q))
        # To the last bit: what is left open is divided by the step.
        assert closed.residual < 1e-12
        ends.append(vc.compile(there, weights=weights).evaluate(closed.flat, quantities, path="reference"))
    for quantity in quantities:
        found = compiled.gradient(q.flat, quantity, wrt=["p"])
        assert found.smooth.any(), found.reason(*(0,) * found.smooth.ndim)
        plus, minus, far_plus, far_minus = (end[quantity][found.smooth] for end in ends)
        difference = (8.0 * (plus - minus) - (far_plus - far_minus)) / (12.0 * STEP)
        size = np.abs(difference).max() + 1e-2 * np.abs(found.values[found.smooth]).max()
        assert np.abs(found.gradient[found.smooth][:, 0] - difference).max() <= 1e-6 * size


def unit_weights(mechanism: Mechanism) -> vc.Weights:
    return vc.Weights(twist=[1.0] * mechanism.space.dimension)


def with_holdable_motors(mechanism: Mechanism, seed: int) -> Mechanism:
    from tests.laws.random_closed import holdable_motors

    return mechanism.with_active(list(holdable_motors(np.random.default_rng(seed), mechanism)))


@pytest.mark.parametrize("axes", ["ground", "body"])
@pytest.mark.parametrize("name", ["five-bar", "stewart", "stewart-spherical", "3rrr", "delta", "serial-7r"])
def test_everything_that_is_drawn(name: str, axes: str) -> None:
    mechanism = example(name)
    member = mechanism.reference
    mechanism = replace(mechanism, reference=replace(member, axes=axes))
    q = mechanism.close(near=displaced(np.random.default_rng(3), mechanism, 0.1))
    check(varied(mechanism, seed=4), q, unit_weights(mechanism))


@pytest.mark.parametrize("kind", ["kept", "contact"])
@pytest.mark.parametrize("seed", [0, 2, 3, 4, 6, 8, 9, 11, 12, 15, 16, 20, 23, 28])
def test_random_mechanisms(seed: int, kind: str) -> None:
    """Screws, universal joints, slides, balls, whichever way their loops are cut."""
    rng = np.random.default_rng(seed)
    mechanism = random_closed(rng, planar=seed % 3 == 0, loops=1 + seed % 3)
    mechanism = with_holdable_motors(mechanism, seed)
    if kind == "contact":
        # What has no motor and no pitch may be cut so that its columns vanish.
        taken = {axis.split(".")[0] for axis in mechanism.active}
        cuts = [cut.joint for cut in mechanism.reduction.cuts]
        free = [joint.name for joint in cuts if joint.name not in taken and joint.type != "screw"]
        member = replace(mechanism.reference, cuts={name: vc.Cut(kind="contact") for name in free})
        mechanism = replace(mechanism, reference=member)
    q = mechanism.close(near=displaced(rng, mechanism, 0.1))
    check(varied(mechanism, seed), q, unit_weights(mechanism))


def pushed() -> Mechanism:
    """A finger that pushes a rocker: without friction it slides along it."""
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "finger", at=(0, 0)),
            vc.Revolute("b", "ground", "rocker", at=(1, 0)),
        ],
        contacts=[vc.Contact("tip", "finger", "rocker", "point", at=(0.6, 0.9), normal=(0.8, 0.3))],
        reference=vc.Reference("rocker", origin=(0.9, 0.8)),
        active=["a"],
    )


def gripped(kind: str) -> Callable[[], Mechanism]:
    """A finger that moves a hanging body, by a contact that blocks some directions."""

    def build() -> Mechanism:
        joints = [
            vc.Revolute("a", "ground", "finger", at=(0, 0, 0), axis=(0.1, 0.2, 1)),
            vc.Universal("b", "ground", "hanger", at=(1, 0, 1), axes=((1, 0, 0), (0, 1, 0.2))),
            vc.Prismatic("c", "hanger", "body", axis=(-0.5, 0.3, -1), at=(1, 0, 1)),
        ]
        if kind == "line":
            joints.append(vc.Cylindrical("d", "finger", "pad", at=(0.3, 0.1, 0.2), axis=(0.2, 1, 0.1)))
        first = "pad" if kind == "line" else "finger"
        line = (-0.1, 0.9, -0.1) if kind == "line" else None
        touch = vc.Contact(
            "touch", first, "body", kind, at=(0.5, 0.3, 0.1), normal=(0.6, 0.1, 0.3), line=line
        )
        return vc.Mechanism.spatial(
            joints=joints,
            contacts=[touch],
            reference=vc.Reference("body", origin=(0.7, 0.2, 0)),
            active=["a", "c", "d.rotation", "d.translation"] if kind == "line" else ["a"],
        )

    return build


@pytest.mark.parametrize("build", [pushed, gripped("hard-finger"), gripped("line")])
def test_contacts(build: Callable[[], Mechanism]) -> None:
    mechanism = build()
    q = mechanism.close(near=displaced(np.random.default_rng(3), mechanism, 0.1))
    check(varied(mechanism, seed=4), q, unit_weights(mechanism))


def geared(p: float = 0.0) -> Mechanism:
    """Three links; the second follows the first by a bent gear, the third by a straight one and a belt."""
    joints = [
        vc.Revolute("a", "ground", "one", at=(0, 0)),
        vc.Revolute("b", "one", "two", at=(1, 0)),
        vc.Revolute("c", "two", "three", at=(1.7, 0)),
        vc.Prismatic("d", "three", "tool", axis=(1, 0)),
    ]
    curve = [0.1 * p, 0.5, 0.3 + p, -0.2]
    bent = vc.Coupling("bent", {"b": 1.0 + p}, {"a": 1.0 - 2 * p}, curve, {"a": 0.3 * p})
    straight = vc.Coupling("straight", {"c": 1.0, "a": 0.4 + p})
    return vc.Mechanism.planar(
        joints=joints,
        couplings=[bent, straight],
        drives=[vc.Drive("belt", {"a": 1.0 + p * p + p, "d": 0.5 - p})],
        reference=vc.Reference("tool", origin=(2.5, 0.2)),
        active=["belt", "d"],
    )


def test_couplings_and_drives() -> None:
    mechanism = geared()
    q = mechanism.close(motors={"belt": 0.5, "d": 0.1})
    check(geared, q, unit_weights(mechanism), (KINEMATIC, FORCE, "singularity.distance"))


def welded(p: float = 0.0) -> Mechanism:
    """A four-bar with a bracket on its crank and a tool on its coupler, both fixed."""
    joints = [
        vc.Revolute("a", "ground", "crank", at=(0, 0)),
        vc.Fixed("bracket", "crank", "arm", at=(0.2, 0.3)),
        vc.Revolute("b", "arm", "coupler", at=(0.2 + p, 0.8)),
        vc.Fixed("mount", "tool", "coupler"),
        vc.Revolute("c", "coupler", "rocker", at=(1.2, 1.0 - p)),
        vc.Revolute("d", "rocker", "ground", at=(1, 0)),
    ]
    reference = vc.Reference("tool", origin=(0.7 + 2 * p, 1.5))
    return vc.Mechanism.planar(joints=joints, reference=reference, active=["a"])


def test_bodies_that_are_fixed_to_others() -> None:
    mechanism = welded()
    q = mechanism.close(motors={"a": 0.2})
    check(welded, q, unit_weights(mechanism), (KINEMATIC, FORCE, "singularity.distance"))
    check(varied(mechanism, seed=1), q, unit_weights(mechanism))


def weighed(p: float = 0.0) -> Mechanism:
    """Dimensions and weights change together: larger motors for longer links."""
    elbow = 1.0 + p
    joints = [vc.Revolute("a", "ground", "one", at=(0, 0)), vc.Revolute("b", "one", "two", at=(elbow, 0))]
    weights = vc.Weights(twist=[1.0, 2.0 + p, 0.5], rate=[1.0 + 3 * p, 2.0 - p])
    return vc.Mechanism.planar(
        joints=joints, reference=vc.Reference("two", origin=(elbow + 0.8, 0)), active=vc.ALL, weights=weights
    )


def test_weights_that_change_with_a_dimension() -> None:
    indices = ("kinematic.yoshikawa_volume:translation", "active_force.isotropy:translation")
    check(weighed, weighed().configuration({"a": 0.3, "b": 1.1}), None, (KINEMATIC, FORCE, *indices))
    check(weighed, weighed().configuration({"a": 0.3, "b": 1.1}), vc.Weights(), indices)


def test_what_cannot_close_says_so() -> None:
    """A four-bar drawn in space closes in its plane only: by frames that leave it there is no derivative."""
    places = [(0, 0, 0), (0, 1, 0), (1, 1.2, 0), (1, 0, 0)]
    bodies = ["ground", "crank", "coupler", "rocker", "ground"]
    joints = [vc.Revolute(f"j{k}", bodies[k], bodies[k + 1], at=at) for k, at in enumerate(places)]
    mechanism = vc.Mechanism.spatial(
        joints=joints, reference=vc.Reference("coupler", origin=(0.5, 1.1, 0)), active=["j0"]
    )
    found = vc.compile(varied(mechanism, seed=4)).gradient(None, KINEMATIC, wrt=["p"])
    assert not found.smooth.any()
    assert "do not close again" in found.reason(0)


@pytest.mark.parametrize("member", ["coupler", "rocker"])
def test_a_body_held_by_contacts_alone(member: str) -> None:
    """The coupler of a four-bar is gripped, not hinged: it gets an implicit free joint to the ground."""
    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("d", "ground", "rocker", at=(1, 0)),
        ],
        contacts=[
            vc.Contact("b", "crank", "coupler", "hard-finger", at=(0.1, 0.8), normal=(1, 0.2)),
            vc.Contact("c", "rocker", "coupler", "hard-finger", at=(1.2, 1.0), normal=(-1, 0.4)),
        ],
        reference=vc.Reference(member, origin=(0.6, 1.2)),
        active=["a"],
    )
    assert mechanism.implicit_joints
    q = mechanism.close(motors={"a": 0.2})
    check(varied(mechanism, seed=2), q, unit_weights(mechanism))


def test_locked_joints() -> None:
    mechanism = example("five-bar").with_lock(["o5"]).with_active(["o1"])
    q = mechanism.close(motors={"o1": -0.15})
    check(varied(mechanism, seed=2), q, unit_weights(mechanism))
