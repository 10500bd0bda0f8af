"""Columns and rows at displaced configurations, against central differences of body poses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.unit.mechanism.joint_samples import moved_values, twist_between

import vincula as vc
from vincula.arrays import Vector
from vincula.mechanism.drawing import DrawnJoint
from vincula.mechanism.joint_types import axis_twists, values_between
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Cut
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL, Space
from vincula.spatial.twists import moment_arm

SPATIAL_CHAIN = ("planar", "cylindrical", "universal", "spherical", "screw", "prismatic", "free", "revolute")
PLANAR_CHAIN = ("revolute", "prismatic", "free", "revolute", "prismatic")


def chain(
    rng: np.random.Generator, space: Space, kinds: tuple[str, ...], last: str
) -> tuple[list[DrawnJoint], list[str]]:
    """Joints one after the other from the ground, some of them drawn backwards."""
    s = space.translations
    bodies = ["ground", *(f"b{k}" for k in range(len(kinds) - 1)), last]
    joints = []
    for k, kind in enumerate(kinds):
        axis = (
            None if kind in ("spherical", "free") or (kind == "revolute" and s == 2) else rng.normal(size=s)
        )
        ends = bodies[k : k + 2] if rng.random() < 0.5 else bodies[k : k + 2][::-1]
        second = rng.normal(size=3) if kind == "universal" else None
        joints.append(DrawnJoint(f"j{k}", kind, *ends, rng.normal(size=s), axis, second, lead=0.4))
    return joints, bodies


def random_configuration(rng: np.random.Generator, mechanism: Mechanism) -> dict[str, Vector]:
    q = {}
    for joint in mechanism.joints:
        kind = mechanism.type_of(joint)
        rates = rng.uniform(-1.5, 1.5, len(kind.axes))
        q[joint.name] = moved_values(kind, mechanism.home[joint.name], rates, 1.0)
    return q


def stepped(mechanism: Mechanism, q: dict[str, Vector], axis: str, time: float) -> dict[str, Vector]:
    """The configuration after one axis has moved at unit rate for a time."""
    joint = next(j for j in mechanism.joints if axis in mechanism.type_of(j).axis_names(j.name))
    kind = mechanism.type_of(joint)
    rates = np.array([float(name == axis) for name in kind.axis_names(joint.name)])
    return {**q, joint.name: moved_values(kind, q[joint.name], rates, time)}


@pytest.mark.parametrize("space", [PLANAR, SPATIAL], ids=lambda space: space.name)
@pytest.mark.parametrize("axes", ["ground", "body"])
def test_columns_are_velocities_of_the_member(space: Space, axes: str, rng: np.random.Generator) -> None:
    """u = (G^T)^-1 J q' along a chain of every joint type, at random values of all of them."""
    make = Mechanism.planar if space is PLANAR else Mechanism.spatial
    kinds = PLANAR_CHAIN if space is PLANAR else SPATIAL_CHAIN
    for _ in range(6):
        joints, _ = chain(rng, space, tuple(rng.permutation(kinds)), "tool")
        origin = rng.normal(size=space.translations)
        reference = vc.Reference("tool", origin=origin, axes=axes)  # type: ignore[arg-type]
        mechanism = make(joints=joints, reference=reference, active=vc.ALL)
        q = random_configuration(rng, mechanism)
        model = mechanism.linearize(q)
        jacobian = np.hstack([model.jacobian_active, model.jacobian_passive])
        twists = np.linalg.solve(model.grasp.T, jacobian)
        home = mechanism.body_poses(q)["tool"]
        point = home.apply(origin)
        back = home.rotation.T if axes == "body" else np.eye(space.translations)
        for column, found in zip(model.columns, twists.T, strict=True):
            poses = [
                mechanism.body_poses(stepped(mechanism, q, column.name, t))["tool"] for t in (-1e-5, 1e-5)
            ]
            twist = twist_between(poses[0], poses[1], home, point, 2e-5)
            s = space.translations
            told = np.concatenate([back @ twist[:s], twist[s:] if s == 2 else back @ twist[s:]])
            assert found == pytest.approx(told, abs=2e-8 * (1 + np.abs(told).max())), column.name


CONTACTS = {
    SPATIAL: ("point", "hard-finger", "line", "line-friction", "plane", "complete", "soft-finger"),
    PLANAR: ("point", "hard-finger", "complete"),
}
EVERY_CONTACT = pytest.mark.parametrize(
    ("space", "kind"),
    [(space, kind) for space, kinds in CONTACTS.items() for kind in kinds],
    ids=[f"{space.name}-{kind}" for space, kinds in CONTACTS.items() for kind in kinds],
)


def permitted(rng: np.random.Generator, space: Space, kind: str) -> Pose:
    """A displacement of the second side in the contact frame that leaves the contact closed.

    A soft finger's is none: spin resisted about a normal that tilts is no condition on positions.
    """
    if space is PLANAR:
        slide, turn = rng.normal(), float(rng.uniform(-2, 2))
        return {
            "point": Pose.from_angle(turn, (slide, 0)),
            "hard-finger": Pose.from_angle(turn),
            "complete": Pose.identity(2),
        }[kind]
    slide = (*rng.normal(size=2), 0.0)
    spin = Rotation.from_rotvec([0, 0, rng.uniform(-2, 2)])
    roll = Rotation.from_rotvec([rng.uniform(-2, 2), 0, 0])
    still, any_turn = (0.0, 0.0, 0.0), Rotation.random(random_state=rng)
    place, turn = {
        "point": (slide, any_turn),
        "hard-finger": (still, any_turn),
        "line": (slide, spin * roll),
        "line-friction": (still, roll),
        "plane": (slide, spin),
        "complete": (still, Rotation.identity()),
        "soft-finger": (still, Rotation.identity()),
    }[kind]
    return Pose.at(place, turn.as_matrix())


@EVERY_CONTACT
def test_contact_rows_where_the_contact_has_moved(space: Space, kind: str, rng: np.random.Generator) -> None:
    """Displaced as the contact permits, motions of the kernel keep it closed to O(eps^2), others do not."""
    for _ in range(5):
        mechanism, q = displaced_contact(rng, space, kind)
        model = mechanism.linearize(q)
        jacobian = np.hstack([model.jacobian_active, model.jacobian_passive, -model.grasp.T])
        rank = len(model.rows)
        assert np.linalg.matrix_rank(jacobian) == rank
        right = np.linalg.svd(jacobian)[2]
        along = right[rank:].T @ rng.normal(size=len(right) - rank)
        across = right[:rank].T @ rng.normal(size=rank)
        first, second = (gap_after(mechanism, q, along, time) for time in (1e-3, 1e-4))
        assert second < 0.015 * first + 1e-12
        first, second = (gap_after(mechanism, q, across, time) for time in (1e-3, 1e-4))
        assert second == pytest.approx(0.1 * first, rel=0.1)
        assert second > 1e-5


def gap_after(mechanism: Mechanism, q: dict[str, Vector], motion: Vector, time: float) -> float:
    """Gap after a time at the rates of the columns and the twist of the free member."""
    model = mechanism.linearize(q)
    member = mechanism.joint["member.free"]
    free = mechanism.type_of(member)
    assert model.motions is not None
    place = mechanism.body_poses(q)["member"]
    axes = axis_twists(free, member.frame_on_first, place, 0.0, member.second_axis, model.motions.origin)
    count = len(model.columns)
    there = dict(q)
    for column, rate in zip(model.columns, motion[:count], strict=True):
        there = stepped(mechanism, there, column.name, rate * time)
    rates = np.linalg.solve(axes, motion[count:])
    there["member.free"] = moved_values(free, q["member.free"], rates, time)
    return max(r.gap for r in mechanism.residuals(there))


def displaced_contact(
    rng: np.random.Generator, space: Space, kind: str
) -> tuple[Mechanism, dict[str, Vector]]:
    """A limb of three hinges that touches a free member, moved away from its drawing, still closed."""
    s = space.translations
    joints, _ = chain(rng, space, ("revolute",) * 3, "tip")
    normal = rng.normal(size=s)
    line = np.cross(normal, rng.normal(size=3)) if kind.startswith("line") else None
    make = Mechanism.planar if space is PLANAR else Mechanism.spatial
    mechanism = make(
        joints=joints,
        contacts=[vc.Contact("touch", "tip", "member", kind, rng.normal(size=s), normal, line)],
        reference=vc.Reference("member", origin=rng.normal(size=s)),
        active=["j0"],
    )
    q = random_configuration(rng, mechanism)
    contact = mechanism.contacts[0]
    first = mechanism.body_poses(q)["tip"] @ contact.frame_on_first
    there = first @ permitted(rng, space, kind) @ contact.frame_on_second.inverse()
    free = mechanism.joint["member.free"]
    q["member.free"] = values_between(
        mechanism.type_of(free), free.frame_on_first, there @ free.frame_on_second, free.second_axis
    )
    assert max(r.gap for r in mechanism.residuals(q)) < 1e-12
    return mechanism, q


@EVERY_CONTACT
def test_selectors_block_what_table_one_says(space: Space, kind: str, rng: np.random.Generator) -> None:
    """Row by row in a frame along the axes: J of the limb's tip, G^T of the member, same selector."""
    s = space.translations
    normal, line = (np.eye(s)[-1], np.eye(3)[0])
    at = rng.normal(size=s)
    make = Mechanism.planar if space is PLANAR else Mechanism.spatial
    mechanism = make(
        joints=[vc.Free("float", "ground", "tip", at=at)],
        contacts=[
            vc.Contact("touch", "tip", "member", kind, at, normal, line if kind.startswith("line") else None)
        ],
        reference=vc.Reference("member", origin=at),
        active=[],
    )
    model = mechanism.linearize()
    unit = np.eye(space.dimension)
    blocked = {
        SPATIAL: {
            "point": [2], "hard-finger": [0, 1, 2], "line": [2, 4], "line-friction": [0, 1, 2, 4, 5],
            "plane": [2, 3, 4], "complete": [0, 1, 2, 3, 4, 5], "soft-finger": [0, 1, 2, 5],
        },
        PLANAR: {"point": [1], "hard-finger": [0, 1], "complete": [0, 1, 2]},
    }[space][kind]  # fmt: skip
    of_member = model.grasp.T
    assert of_member == pytest.approx(unit[blocked])
    assert model.jacobian_passive == pytest.approx(unit[blocked])
    letters = ("ft", "fn", "mz") if space is PLANAR else ("fx", "fy", "fz", "mx", "my", "mz")
    assert [row.name for row in model.rows] == [f"touch.{letters[k]}" for k in blocked]
    assert [row.linear for row in model.rows] == [k < s for k in blocked]


def test_the_cut_point_rides_on_the_member(rng: np.random.Generator) -> None:
    """A declared cut point is fixed on the body that is cut, at every configuration and for every frame."""
    for frame in ((0.0, 0.0), (0.3, -2.0)):
        arm = Mechanism.planar(
            joints=[
                vc.Revolute("one", "ground", "link", at=(0, 0)),
                vc.Revolute("two", "link", "tool", at=(1, 0)),
            ],
            bodies=[vc.Body("tool", at=frame)],
            reference=vc.Reference("tool", origin=(2, 0), cuts={"two": Cut("kept", at=(1.5, 0.25))}),
        )
        assert arm.linearize().cuts[0].at == pytest.approx((1.5, 0.25))
        model = arm.linearize({"one": np.pi / 2, "two": np.pi / 2})
        assert model.cuts[0].at == pytest.approx((-0.5, 0.75))
        assert model.cuts[0].role == "member cut"
        arm_of_cut = np.array([-0.5, 0.75]) - np.array([-1.0, 1.0])
        of_member = model.grasp.T
        assert of_member == pytest.approx(
            np.vstack([np.hstack([np.eye(2), moment_arm(arm_of_cut)]), [0, 0, 1]])
        )
        again = arm.with_configuration({"one": np.pi / 2, "two": np.pi / 2})
        assert again.reference is not None
        assert again.reference.cuts["two"].at == pytest.approx((-0.5, 0.75))
        assert again.linearize().jacobian_passive == pytest.approx(model.jacobian_passive)
