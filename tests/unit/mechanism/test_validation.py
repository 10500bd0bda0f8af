"""What is no mechanism is refused when it is made, each with its class, its data and its choices."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.unit.mechanism.five_bar import five_bar

import vincula as vc
from vincula.errors import (
    DuplicateNameError,
    ModelError,
    NonFiniteError,
    ShapeError,
    TopologyError,
    UnknownNameError,
)
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Body, ContactPart, Coupling, Drive, Frame, Joint, Limits, ReferenceMember
from vincula.spatial.poses import Pose
from vincula.spatial.space import SPATIAL

HERE = Pose.identity(2)


def resolved(**changes: Any) -> Mechanism:
    """The five-bar in resolved parts, with some of them changed."""
    return replace(five_bar(), **changes)


def test_names_are_unique_among_their_kind() -> None:
    bar = five_bar()
    for kind, changes in {
        "body": {"bodies": (*bar.bodies, bar.bodies[0])},
        "joint": {"joints": (*bar.joints, bar.joints[0])},
        "frame": {"frames": (Frame("tip", "link", HERE), Frame("tip", "crank", HERE))},
        "coupling": {"couplings": (Coupling("g", {"o1": 1.0}), Coupling("g", {"o2": 1.0}))},
        "motor": {"drives": (Drive("m", {"o1": 1.0}), Drive("m", {"o2": 1.0}))},
        "active axis": {"active": ("o1", "o1")},
    }.items():
        with pytest.raises(DuplicateNameError) as refused:
            resolved(**changes)
        assert refused.value.kind == kind
    with pytest.raises(DuplicateNameError, match="'ground'"):
        resolved(bodies=(*bar.bodies, Body("ground", HERE)))
    with pytest.raises(ModelError, match="a frame has an empty name"):
        resolved(frames=(Frame("", "link", HERE),))


def test_one_name_may_be_a_body_a_joint_and_a_contact() -> None:
    mechanism = Mechanism.planar(
        joints=[vc.Revolute("arm", "ground", "arm", at=(0, 0))],
        contacts=[vc.Contact("arm", "arm", "ground", "point", at=(1, 0), normal=(0, -1))],
        reference=vc.Reference("arm"),
        active="arm",
    )
    assert mechanism.linearize().ledger.summary.mobility == 0


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"active": ("o9",)}, "active axis or motor"),
        ({"lock": ("o9",)}, "locked axis"),
        ({"couplings": (Coupling("g", {"o9": 1.0}),)}, "axis in coupling 'g'"),
        ({"drives": (Drive("m", {"o9": 1.0}),)}, "axis in motor 'm'"),
        ({"motors": {"m": "o9"}}, "axis of motor 'm'"),
        ({"frames": (Frame("tip", "lnk", HERE),)}, "body of frame 'tip'"),
        ({"reference": ReferenceMember("lnk", np.zeros(2))}, "body"),
        ({"reference": ReferenceMember("link", np.zeros(2), axes="tool")}, "choice of axes"),
        ({"joints": (Joint("j", "revolute", "ground", "lnk", HERE, HERE, (0.0,)),)}, "body of joint 'j'"),
        ({"contacts": (ContactPart("c", "point", "ground", "lnk", HERE, HERE),)}, "body of contact 'c'"),
    ],
)
def test_unknown_names_list_the_choices(changes: dict[str, Any], kind: str) -> None:
    with pytest.raises(UnknownNameError) as refused:
        resolved(**changes)
    assert refused.value.kind == kind
    assert refused.value.choices
    assert refused.value.name in ("o9", "lnk", "tool")


def test_topology() -> None:
    with pytest.raises(TopologyError, match="joint 'j' connects body 'a' to itself"):
        Mechanism.planar(joints=[vc.Revolute("j", "a", "a", at=(0, 0))])
    with pytest.raises(TopologyError, match="contact 'c' connects body 'a' to itself"):
        Mechanism.planar(joints=[], contacts=[vc.Contact("c", "a", "a", "point", (0, 0), (0, 1))])
    with pytest.raises(
        TopologyError, match="'a', 'b' are connected to nothing: no joint or contact leads to the ground"
    ):
        Mechanism.planar(
            joints=[vc.Revolute("j", "a", "b", at=(0, 0)), vc.Revolute("k", "ground", "c", (0, 0))]
        )
    with pytest.raises(TopologyError, match="'a' is connected to nothing"):
        Mechanism.planar(joints=[vc.Revolute("k", "ground", "c", (0, 0))], bodies=[vc.Body("a")])


def test_a_mechanism_may_be_empty_but_then_has_no_member() -> None:
    empty = Mechanism.planar(joints=[])
    assert empty.residuals() == ()
    with pytest.raises(vc.MissingReferenceError, match=r"one of \(none\)"):
        empty.linearize()


def test_active_and_locked_at_once() -> None:
    with pytest.raises(
        ModelError, match="o1 cannot be active and locked at once: drop it from one of the two"
    ):
        five_bar().with_lock("o1").with_active("o1")


def test_numbers_of_couplings_and_drives() -> None:
    with pytest.raises(NonFiniteError, match="coefficient of coupling 'g' is nan"):
        resolved(couplings=(Coupling("g", {"o1": float("nan")}),))
    with pytest.raises(NonFiniteError, match="reference of coupling 'g' is inf"):
        resolved(couplings=(Coupling("g", {"o1": 1.0}, references={"o1": float("inf")}),))
    with pytest.raises(ModelError, match="coupling 'g' has no coefficient other than zero"):
        resolved(couplings=(Coupling("g", {"o1": 0.0}),))
    with pytest.raises(ModelError, match="motor 'm' drives nothing: give at least one coefficient"):
        resolved(drives=(Drive("m", {"o1": 0.0}),))
    with pytest.raises(ModelError, match="motor 'o1' has the name of a joint axis"):
        resolved(drives=(Drive("o1", {"o2": 1.0}),))


def test_a_polynomial_needs_values_and_a_ball_has_none() -> None:
    cam = Coupling("cam", {"hinge": 1.0}, driver={"ball.x": 1.0}, polynomial=(0.0, 1.0))
    with pytest.raises(
        ModelError, match=r"coupling 'cam' needs the value of ball.x, but balls and loop joints"
    ):
        Mechanism.spatial(
            joints=[
                vc.Spherical("ball", "ground", "a", (0, 0, 0)),
                vc.Revolute("hinge", "a", "b", (1, 0, 0)),
            ],
            couplings=[cam],
        )
    linear = Mechanism.spatial(
        joints=[vc.Spherical("ball", "ground", "a", (0, 0, 0)), vc.Revolute("hinge", "a", "b", (1, 0, 0))],
        couplings=[Coupling("gear", {"hinge": 1.0, "ball.x": -1.0})],
        reference=vc.Reference("b"),
    )
    assert linear.linearize().ledger.summary.mobility == 3


def test_frames_of_parts() -> None:
    stretched = Pose.at((0, 0), np.diag([1.0, 1.1]))
    with pytest.raises(
        ModelError, match=r"joint 'j': frame on the second body: the matrix .* is no rotation"
    ):
        Joint("j", "revolute", "ground", "link", HERE, stretched, (0.0,))
    with pytest.raises(ModelError, match=r"body 'b': the matrix .* is no rotation"):
        Body("b", Pose.at((0, 0), np.diag([1.0, -1.0])))
    with pytest.raises(NonFiniteError, match=r"frame 'f': position\[1\] is nan"):
        Frame("f", "b", Pose.at((0, np.nan)))
    with pytest.raises(
        ShapeError, match=r"joint 'j': frame on the first body.* expected the position of a planar pose"
    ):
        resolved(joints=(Joint("j", "revolute", "ground", "link", Pose.identity(3), HERE, (0.0,)),))
    with pytest.raises(ShapeError, match="reference point has shape"):
        resolved(reference=ReferenceMember("link", np.zeros(3)))


def test_parts_cannot_be_changed() -> None:
    bar = five_bar()
    with pytest.raises(ValueError, match="read-only"):
        bar.joints[0].frame_on_first.position[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        bar.home["o1"][0] = 1.0
    assert bar.reference is not None
    with pytest.raises(ValueError, match="read-only"):
        bar.reference.origin[0] = 1.0


def spatial(joint: Joint) -> Mechanism:
    return Mechanism(space=SPATIAL, bodies=(Body("b", Pose.identity()),), joints=(joint,))


def test_numbers_of_resolved_joints() -> None:
    at = Pose.identity()
    with pytest.raises(ShapeError, match=r"joint 'j': home values has shape \(1,\), expected \(4\)"):
        spatial(Joint("j", "spherical", "ground", "b", at, at, (0.0,)))
    with pytest.raises(NonFiniteError, match=r"joint 'j': home values\[0\] is inf"):
        spatial(Joint("j", "revolute", "ground", "b", at, at, (np.inf,)))
    with pytest.raises(ModelError, match=r"home quaternion .* has length zero"):
        spatial(Joint("j", "spherical", "ground", "b", at, at, (0.0, 0.0, 0.0, 0.0)))
    with pytest.raises(ModelError, match="a screw needs a lead, its advance a turn in metres, not 0"):
        spatial(Joint("j", "screw", "ground", "b", at, at, (0.0,)))
    with pytest.raises(ModelError, match=r"second axis \[0.0, 2.0, 0.0\] is not a unit vector"):
        Joint("j", "universal", "ground", "b", at, at, (0.0, 0.0), second_axis=np.array([0.0, 2.0, 0.0]))
    with pytest.raises(ModelError, match="the two axes of a universal joint are parallel"):
        spatial(
            Joint("j", "universal", "ground", "b", at, at, (0.0, 0.0), second_axis=np.array([0.0, 0.0, 1.0]))
        )
    with pytest.raises(ModelError, match="joint 'j': lower limit 1 is above upper limit -1"):
        spatial(Joint("j", "revolute", "ground", "b", at, at, (0.0,), limits=(Limits(1.0, -1.0),)))
    with pytest.raises(ModelError, match=r"the coefficient of friction is -0.5, it must be 0 or more"):
        Mechanism(
            space=SPATIAL,
            bodies=(Body("b", at),),
            joints=(),
            contacts=(ContactPart("c", "point", "ground", "b", at, at, friction=-0.5),),
        )
