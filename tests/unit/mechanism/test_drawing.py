"""Drawn parts: where their frames are, which way their axes point, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vincula as vc
from vincula.errors import (
    DuplicateNameError,
    ModelError,
    NonFiniteError,
    ShapeError,
    TopologyError,
    UnknownNameError,
)
from vincula.mechanism.drawing import Drawing, DrawnJoint
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL


def one_joint(joint: DrawnJoint, **more: Any) -> Joint:
    """The resolved form of one joint from the ground to a body b."""
    make = Mechanism.planar if more.pop("planar", False) else Mechanism.spatial
    return make(joints=[joint], **more).joints[0]


def test_frames_coincide_at_the_drawing_and_values_are_zero() -> None:
    joint = one_joint(vc.Revolute("j", "ground", "b", at=(1, 2, 3), axis=(0, 3, 4)))
    assert joint.home == (0.0,)
    assert joint.frame_on_first.position == pytest.approx([1, 2, 3])
    assert joint.frame_on_second.position == pytest.approx([1, 2, 3])
    assert joint.frame_on_first.rotation[:, 2] == pytest.approx([0, 0.6, 0.8])
    ball = one_joint(vc.Spherical("j", "ground", "b", at=(1, 2, 3)))
    assert ball.home == (1.0, 0.0, 0.0, 0.0)
    assert np.array_equal(ball.frame_on_first.rotation, np.eye(3))


def test_axes_along_ground_axes_are_exact() -> None:
    """No rounding enters a mechanism that is drawn along the axes."""
    for axis in (*np.eye(3), *-np.eye(3)):
        joint = one_joint(vc.Prismatic("j", "ground", "b", axis=axis, at=(0, 0, 0)))
        rotation = joint.frame_on_first.rotation
        assert np.array_equal(rotation[:, 2], axis)
        assert set(np.abs(rotation).ravel()) == {0.0, 1.0}


def test_planar_frames() -> None:
    """A slide moves along x of its frame; a contact's frame is (tangent, normal)."""
    slide = one_joint(vc.Prismatic("j", "ground", "b", axis=(3, 4), at=(1, 1)), planar=True)
    assert slide.frame_on_first.rotation == pytest.approx(np.array([[0.6, -0.8], [0.8, 0.6]]))
    touch = Mechanism.planar(
        joints=[], contacts=[vc.Contact("c", "ground", "b", "point", at=(0, 0), normal=(0, 2))]
    ).contacts[0]
    assert touch.frame_on_first.rotation == pytest.approx(np.eye(2))
    sideways = Mechanism.planar(
        joints=[], contacts=[vc.Contact("c", "ground", "b", "point", at=(0, 0), normal=(1, 0))]
    ).contacts[0]
    assert sideways.frame_on_first.rotation[:, 0] == pytest.approx([0, -1])
    assert np.linalg.det(sideways.frame_on_first.rotation) == pytest.approx(1)


def test_universal_axes() -> None:
    joint = one_joint(vc.Universal("j", "ground", "b", at=(0, 0, 0), axes=((0, 0, 2), (1, 0, 1))))
    assert joint.frame_on_first.rotation[:, 2] == pytest.approx([0, 0, 1])
    second = joint.frame_on_second.rotation @ joint.second_axis
    assert second == pytest.approx(np.array([1, 0, 1]) / np.sqrt(2))


def test_the_line_of_a_line_contact_is_x() -> None:
    contact = Mechanism.spatial(
        joints=[],
        contacts=[vc.Contact("c", "ground", "b", "line", at=(0, 0, 0), normal=(0, 0, 1), line=(1, 1, 0))],
    ).contacts[0]
    assert contact.frame_on_first.rotation[:, 0] == pytest.approx(np.array([1, 1, 0]) / np.sqrt(2))


def test_bodies_may_have_frames_of_their_own_and_give_places_in_them() -> None:
    mechanism = Mechanism.spatial(
        joints=[vc.Revolute("j", "ground", "b", at=vc.In("b", (1, 0, 0)), axis=vc.In("b", (0, 1, 0)))],
        bodies=[vc.Body("b", at=(5, 0, 0)), vc.Body("tip", fixed_to="b", at=vc.In("b", (0, 0, 2)))],
        reference=vc.Reference("tip", origin=vc.In("tip", (0, 0, 1))),
    )
    assert mechanism.joints[-1].frame_on_first.position == pytest.approx([6, 0, 0])
    assert mechanism.joints[-1].frame_on_second.position == pytest.approx([1, 0, 0])
    assert mechanism.body["tip"].pose.position == pytest.approx([5, 0, 2])
    assert mechanism.reference is not None
    assert mechanism.reference.origin == pytest.approx([0, 0, 1])
    assert mechanism.reference.label == "tip at (5, 0, 3)"


def test_drawing_on_a_loaded_mechanism_uses_its_bodies_and_frames() -> None:
    from dataclasses import replace

    from vincula.mechanism.parts import Frame

    base = Mechanism.planar(joints=[vc.Revolute("j", "ground", "b", at=(1, 0))])
    base = replace(base, frames=(Frame("tip", "b", Pose.from_angle(np.pi / 2, (2, 0))),))
    base = base.with_configuration({"j": np.pi / 2})
    drawing = Drawing(PLANAR, base)
    assert drawing.frame_pose("tip").position == pytest.approx([1, 1])
    place = vc.In("tip", (1, 0))
    assert drawing.point(place, "place") == pytest.approx([0, 1])
    drawing.add(
        contacts=[vc.Contact("c", "b", "world", "hard-finger", at=place, normal=vc.In("tip", (0, 1)))]
    )
    contact = drawing.contacts[0]
    assert contact.second == "ground"
    assert contact.frame_on_second.position == pytest.approx([0, 1])
    assert contact.frame_on_first.position == pytest.approx([2, 1])
    assert contact.frame_on_second.rotation[:, 1] == pytest.approx([0, -1])


def test_a_slide_without_a_place_is_put_amid_its_neighbours() -> None:
    """So that nothing depends on where the origin of the drawing is."""

    def drawn(shift: float) -> Mechanism:
        return Mechanism.planar(
            joints=[
                vc.Prismatic("s", "ground", "b", axis=(1, 0)),
                vc.Revolute("j", "b", "c", at=(shift, 1)),
                vc.Revolute("k", "b", "d", at=(shift + 2, 1)),
            ],
            reference=vc.Reference("c", origin=(shift, 2)),
        )

    here, there = drawn(0.0), drawn(1e3)
    assert here.joints[0].frame_on_first.position == pytest.approx([1, 1])
    assert here.length == there.length
    alone = Mechanism.planar(joints=[vc.Prismatic("s", "ground", "b", axis=(1, 0))])
    assert alone.joints[0].frame_on_first.position == pytest.approx([0, 0])


@pytest.mark.parametrize(
    ("joint", "error", "message"),
    [
        (vc.Revolute("j", "a", "b", (1, 2)), ShapeError, r"joint 'j': at has shape \(2,\), expected \(3\)"),
        (vc.Revolute("j", "a", "b", (1, 2, float("nan"))), NonFiniteError, r"joint 'j': at\[2\] is nan"),
        (vc.Revolute("j", "a", "b", (0, 0, 0), (0, 0, 0)), ModelError, "joint 'j': axis .* has no direction"),
        (vc.Revolute("j", "a", "b", (0, 0, 0), (1e-200, 0, 0)), ModelError, "has no direction"),
        (vc.Revolute("j", "a", "b", (0, 0, 0), "up"), ShapeError, "axis"),
        (vc.Screw("j", "a", "b", (0, 0, 0), (0, 0, 1), 0.0), ModelError, "a screw needs a lead"),
        (vc.Screw("j", "a", "b", (0, 0, 0), (0, 0, 1), float("inf")), ModelError, "needs a lead, .* not inf"),
        (
            vc.Universal("j", "a", "b", (0, 0, 0), ((0, 0, 1), (0, 0, -2))),
            ModelError,
            "the two axes of a universal joint are parallel",
        ),
        (
            vc.Spherical("j", "a", "b", vc.In("nowhere", (0, 0, 0))),
            UnknownNameError,
            "no body or frame is named",
        ),
        (DrawnJoint("j", "hinge", "a", "b", (0, 0, 0)), UnknownNameError, "no joint type is named 'hinge'"),
        (DrawnJoint("j", "spherical", "a", "b"), TopologyError, "joint 'j' needs `at`"),
        (DrawnJoint("j", "prismatic", "a", "b", (0, 0, 0)), TopologyError, "joint 'j' needs `axis`"),
        (
            DrawnJoint("j", "universal", "a", "b", (0, 0, 0), (0, 0, 1)),
            TopologyError,
            "joint 'j' needs `axes`",
        ),
    ],
)
def test_bad_joints(joint: DrawnJoint, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        Mechanism.spatial(joints=[vc.Revolute("g", "ground", "a", at=(0, 0, 0)), joint])


@pytest.mark.parametrize(
    ("contact", "error", "message"),
    [
        (("touch", (0, 0, 1), None), UnknownNameError, "no contact type is named 'touch'"),
        (("point", (0, 0, 0), None), ModelError, "contact 'c': normal .* has no direction"),
        (("line", (0, 0, 1), None), ModelError, "contact 'c': a line contact needs `line`"),
        (("line", (0, 0, 1), (0, 1, 1)), ModelError, "is not perpendicular to the normal"),
        (("point", (0, 0, 1), (1, 0, 0)), ModelError, "only line contacts have a line, 'point' has none"),
    ],
)
def test_bad_contacts(contact: Any, error: type[Exception], message: str) -> None:
    kind, normal, line = contact
    with pytest.raises(error, match=message):
        Mechanism.spatial(
            joints=[], contacts=[vc.Contact("c", "ground", "b", kind, at=(0, 0, 0), normal=normal, line=line)]
        )


def test_what_exists_in_space_only_says_what_the_plane_has() -> None:
    with pytest.raises(
        TopologyError, match="'soft-finger' exists in space only; in the plane use point, hard-f"
    ):
        Mechanism.planar(
            joints=[], contacts=[vc.Contact("c", "ground", "b", "soft-finger", at=(0, 0), normal=(0, 1))]
        )
    with pytest.raises(TopologyError, match="'spherical' exists in space only; in the plane use revolute"):
        Mechanism.planar(joints=[vc.Spherical("j", "ground", "b", at=(0, 0))])


def test_bodies_declared_twice() -> None:
    with pytest.raises(DuplicateNameError, match="two bodies are named 'b': every body needs"):
        Mechanism.spatial(joints=[], bodies=[vc.Body("b", fixed_to="ground"), vc.Body("b")])


@pytest.mark.parametrize(
    ("reference", "error", "message"),
    [
        (vc.Reference("bee"), UnknownNameError, "no body is named 'bee'.* Known: b"),
        (vc.Reference("ground"), TopologyError, "the ground cannot be the reference member"),
        (vc.Reference("b", origin=(0, 0)), ShapeError, "reference: origin has shape"),
        (vc.Reference("b", axes="tool"), UnknownNameError, "no choice of axes is named 'tool'"),  # type: ignore[arg-type]
        (vc.Reference("b", cuts={"x": vc.Cut("kept")}), UnknownNameError, "no joint to cut is named 'x'"),
        (vc.Reference("b", cuts={"j": vc.Cut("glue")}), UnknownNameError, "no kind of cut for joint 'j'"),  # type: ignore[arg-type]
        (vc.Reference("b", cuts={"j": vc.Cut("kept", (0, 0))}), ShapeError, "cut of joint 'j': at has shape"),
    ],
)
def test_bad_references(reference: vc.Reference, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        Mechanism.spatial(joints=[vc.Revolute("j", "ground", "b", at=(0, 0, 0))], reference=reference)


def test_the_default_reference_point_is_the_mean_of_what_touches_the_body() -> None:
    """Joints and contacts; what is merely fixed to the body does not count."""
    mechanism = Mechanism.planar(
        joints=[vc.Revolute("j", "ground", "b", at=(0, 0)), vc.Revolute("k", "b", "c", at=(3, 0))],
        contacts=[vc.Contact("c", "b", "ground", "point", at=(0, 3), normal=(0, 1))],
        bodies=[vc.Body("tool", fixed_to="b", at=(100, 100))],
        reference=vc.Reference("b"),
    )
    assert mechanism.reference is not None
    assert mechanism.reference.origin == pytest.approx([1, 1])
    tool = mechanism.with_reference("tool").reference
    assert tool is not None
    assert tool.origin == pytest.approx([0, 0])


def test_spaces_have_the_dimensions_of_their_drawings() -> None:
    assert Mechanism.planar(joints=[vc.Free("f", "ground", "b")]).space is PLANAR
    assert Mechanism.spatial(joints=[vc.Free("f", "ground", "b")]).space is SPATIAL
