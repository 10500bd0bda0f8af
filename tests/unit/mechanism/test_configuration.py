"""Configurations: values by joint, checked; home, other homes, residuals, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.mechanism.five_bar import five_bar

import vincula as vc
from vincula.errors import ClosureError, ModelError, NonFiniteError, ShapeError, UnknownNameError
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Coupling, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL


def ball_and_hinge() -> Mechanism:
    return Mechanism.spatial(
        joints=[
            vc.Spherical("ball", "ground", "a", at=(0, 0, 0)),
            vc.Revolute("hinge", "a", "b", at=(1, 0, 0), axis=(0, 1, 0)),
        ],
        reference=vc.Reference("b", origin=(2, 0, 0)),
        active=["hinge"],
    )


def test_a_configuration_is_an_immutable_mapping() -> None:
    home = ball_and_hinge().home
    assert dict(home).keys() == {"ball", "hinge"}
    assert home["ball"] == pytest.approx([1, 0, 0, 0])
    with pytest.raises(ValueError, match="read-only"):
        home["ball"][0] = 2.0
    with pytest.raises(TypeError):
        hash(home)
    assert home == {"ball": np.array([1.0, 0, 0, 0]), "hinge": np.array([0.0])}
    assert home != {"hinge": np.array([0.0])}
    assert repr(home) == "Configuration(ball=[1.0, 0.0, 0.0, 0.0], hinge=[0.0])"


def test_named_values_replace_home_values() -> None:
    mechanism = ball_and_hinge()
    q = mechanism.configuration({"hinge": 0.5})
    assert q["hinge"] == pytest.approx([0.5])
    assert q["ball"] == pytest.approx([1, 0, 0, 0])
    assert mechanism.configuration() is mechanism.home
    assert mechanism.configuration(q) is q
    assert mechanism.configuration({"hinge": [0.5]}) == q


def test_quaternions_are_normalised() -> None:
    q = ball_and_hinge().configuration({"ball": (2, 0, 0, 2)})
    assert q["ball"] == pytest.approx(np.array([1, 0, 0, 1]) / np.sqrt(2))


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        (
            {"bal": 0.0},
            UnknownNameError,
            r"no joint with a configuration value is named 'bal'; did you mean 'ball'",
        ),
        ({"ball": (1, 0, 0)}, ShapeError, r"value of joint 'ball' has shape \(3,\), expected \(4\)"),
        ({"hinge": (1, 2)}, ShapeError, r"value of joint 'hinge' has shape \(2,\), expected \(1\)"),
        ({"hinge": [[0.1]]}, ShapeError, r"value of joint 'hinge'"),
        ({"hinge": "half"}, ShapeError, r"value of joint 'hinge'"),
        (
            {"hinge": float("nan")},
            NonFiniteError,
            r"value of joint 'hinge' is nan|value of joint 'hinge'\[0\] is nan",
        ),
        ({"ball": (0, 0, 0, 0)}, ModelError, r"the quaternion \(w, x, y, z\) .* has length zero"),
    ],
)
def test_bad_values(values: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        ball_and_hinge().configuration(values)  # type: ignore[arg-type]


def test_poses_through_the_tree() -> None:
    mechanism = ball_and_hinge()
    turned = {"ball": (np.sqrt(0.5), 0, 0, np.sqrt(0.5)), "hinge": np.pi / 2}
    poses = mechanism.body_poses(turned)
    assert poses["a"].apply(np.array([1.0, 0, 0])) == pytest.approx([0, 1, 0])
    assert poses["b"].apply(np.array([2.0, 0, 0])) == pytest.approx([0, 1, -1])
    assert poses["ground"].position == pytest.approx([0, 0, 0])


def test_home_poses_are_exactly_those_drawn() -> None:
    mechanism = five_bar()
    assert all(
        np.array_equal(pose.rotation, np.eye(2)) and not pose.position.any()
        for pose in mechanism.body_poses().values()
    )
    assert mechanism.body_poses(dict(mechanism.home))["link"].position == pytest.approx([0, 0])


def parallelogram() -> Mechanism:
    """Cranks of length 1 at (0, 0) and (2, 0); closed whenever both have the same angle."""
    return Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "left", at=(0, 0)),
            vc.Revolute("b", "left", "bar", at=(0, 1)),
            vc.Revolute("c", "bar", "right", at=(2, 1)),
            vc.Revolute("d", "right", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("bar", origin=(1, 1)),
        active=["a"],
    )


def test_closed_configurations_are_accepted_and_moved_homes_agree() -> None:
    mechanism = parallelogram()
    for angle in (0.3, -1.0, 2.0):
        q = {"a": angle, "b": -angle, "c": angle, "d": -angle}
        model = mechanism.linearize(q)
        assert max(r.gap for r in mechanism.residuals(q)) < 1e-15
        moved = mechanism.with_configuration(q)
        assert moved.home == mechanism.configuration(q)
        assert moved.linearize().jacobian_active == pytest.approx(model.jacobian_active, abs=1e-14)
        assert moved.linearize().grasp == pytest.approx(model.grasp, abs=1e-14)
        u = np.linalg.lstsq(
            np.hstack([model.jacobian_passive, -model.grasp.T]), -model.jacobian_active[:, 0], rcond=None
        )[0][-3:]
        assert u == pytest.approx([-np.cos(angle), -np.sin(angle), 0], abs=1e-12)
    assert mechanism.linearize({"a": 2 * np.pi}).grasp == pytest.approx(mechanism.linearize().grasp)


def test_open_loops_are_refused_and_named() -> None:
    mechanism = parallelogram()
    with pytest.raises(
        ClosureError, match=r"loop 'c' is open by .* m and 0.2 rad: the configuration does not sat"
    ) as e:
        mechanism.linearize({"a": 0.2})
    chord = 2 * np.sqrt(5) * np.sin(0.1)
    residual = mechanism.residuals({"a": 0.2})[0]
    assert e.value.loop == "c"
    assert residual.angular == pytest.approx(0.2)
    assert residual.linear == pytest.approx(chord)
    assert e.value.gap == pytest.approx(np.hypot(chord, 0.2 * mechanism.length))
    assert e.value.details["residuals"] == (residual,)


def test_closed_means_within_a_hundred_millionth_of_the_length() -> None:
    mechanism = parallelogram()
    assert mechanism.length == 1.0
    at_ease = mechanism.linearize({"a": 1e-9, "b": -1e-9})
    assert 0 < at_ease.uncertainty.residual <= 1e-8
    with pytest.raises(ClosureError):
        mechanism.linearize({"a": 1.1e-8, "b": -1.1e-8})
    assert mechanism.linearize().uncertainty.residual == 0.0


def test_the_value_of_the_closing_joint_itself_must_fit() -> None:
    angle = 0.5
    with pytest.raises(ClosureError, match=r"loop 'c' is open by 0.5 rad|loop 'c' is open by .* and 0.5 rad"):
        parallelogram().linearize({"a": angle, "b": -angle, "d": -angle})


def test_several_open_loops_are_counted() -> None:
    mechanism = Mechanism.planar(
        joints=[vc.Revolute("j", "ground", "plate", at=(0, 0))],
        contacts=[
            vc.Contact(f"c{k}", "ground", "plate", "hard-finger", at=(k, 0), normal=(0, 1)) for k in (1, 2, 3)
        ],
        reference=vc.Reference("plate", origin=(0, 0)),
    )
    with pytest.raises(ClosureError, match=r"contact 'c3' is open by .* m \(2 more open\)"):
        mechanism.linearize({"j": 0.1})


def test_contacts_measure_what_they_block() -> None:
    """A point contact lets its sides slide and turn; it is open along the normal alone."""
    mechanism = Mechanism.planar(
        joints=[vc.Free("f", "ground", "plate", at=(0, 0))],
        contacts=[vc.Contact("c", "ground", "plate", "point", at=(1, 0), normal=(0, 1))],
        reference=vc.Reference("plate", origin=(0, 0)),
    )
    assert mechanism.residuals({"f": (5, 0, 0)})[0].gap == 0.0
    assert mechanism.residuals({"f": (0, 0.25, 0)})[0].linear == pytest.approx(0.25)
    gap = mechanism.residuals({"f": (0, 0, 0.1)})[0]
    assert gap.linear == pytest.approx(np.sin(0.1))
    assert gap.angular == 0.0


def test_couplings_are_refused_open_and_measured_in_their_own_unit() -> None:
    gear = Coupling("gear", {"a": 2.0, "d": 1.0})
    mechanism = five_bar(couplings=[Coupling("gear", {"o1": 1.0, "o5": -2.0})])
    assert mechanism.residuals()[-1].kind == "coupling"
    arm = Mechanism.planar(
        joints=[vc.Revolute("a", "ground", "x", at=(0, 0)), vc.Revolute("d", "x", "y", at=(4, 0))],
        couplings=[gear],
        reference=vc.Reference("y", origin=(8, 0)),
    )
    with pytest.raises(ClosureError, match=r"coupling 'gear' is open by 0.2 rad"):
        arm.linearize({"a": 0.1})
    assert arm.linearize({"a": 0.1, "d": -0.2}).ledger.summary.mobility == 1
    rack = Mechanism.planar(
        joints=[vc.Prismatic("s", "ground", "x", (1, 0), at=(0, 0)), vc.Revolute("r", "x", "y", at=(1, 0))],
        couplings=[Coupling("rack", {"s": 1.0, "r": -0.1})],
        reference=vc.Reference("y", origin=(2, 0)),
    )
    with pytest.raises(ClosureError, match=r"coupling 'rack' is open by 0.05 m"):
        rack.linearize({"s": 0.05})
    assert rack.linearize().rows[-1].linear


def test_couplings_keep_their_references_when_the_home_moves() -> None:
    gear = Coupling("gear", {"a": 1.0, "d": 1.0})
    arm = Mechanism.planar(
        joints=[vc.Revolute("a", "ground", "x", at=(0, 0)), vc.Revolute("d", "x", "y", at=(4, 0))],
        couplings=[gear],
        reference=vc.Reference("y", origin=(8, 0)),
    )
    moved = arm.with_configuration({"a": 0.5, "d": -0.5})
    assert moved.residuals()[-1].gap == 0.0
    assert moved.residuals({"a": 0.0, "d": 0.0})[-1].gap == 0.0
    assert moved.residuals({"a": 0.7})[-1].gap == pytest.approx(0.2 * moved.length)
    assert arm.with_configuration({"a": 0.5}).residuals()[-1].gap == pytest.approx(0.5 * arm.length)


def test_closures_have_no_values_and_give_rows_only() -> None:
    """Two bars pinned by a closure: a four-bar as loop files write it."""
    pin = Joint(
        "tip", "revolute", "link", "rocker", Pose.at((1, 0)), Pose.at((0, 1)), closure=True, cut="contact"
    )
    open_chain = Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("b", "crank", "link", at=(0, 1)),
            vc.Revolute("d", "ground", "rocker", at=(2, 0)),
        ],
        bodies=[vc.Body("link", at=(1, 1)), vc.Body("rocker", at=(2, 0))],
        reference=vc.Reference("link", origin=(1, 1)),
        active=["a"],
    )
    from dataclasses import replace

    closed = replace(open_chain, joints=(*open_chain.joints, pin))
    assert "tip" not in closed.home
    assert closed.linearize().ledger.summary.mobility == 1
    assert [r.name for r in closed.linearize().rows] == ["b.fx", "b.fy", "b.mz", "tip.fx", "tip.fy"]
    assert closed.resolve_motors("all") == ("a", "b", "d")
    with pytest.raises(ClosureError, match=r"loop 'tip' is open by 0.0"):
        closed.linearize({"a": 0.02})
    with pytest.raises(UnknownNameError):
        closed.configuration({"tip": 0.1})


def test_configuration_objects_of_other_mechanisms_are_checked() -> None:
    with pytest.raises(UnknownNameError):
        ball_and_hinge().configuration(Configuration({"o1": np.zeros(1)}))


def test_spaces() -> None:
    assert parallelogram().space is PLANAR
    assert ball_and_hinge().space is SPATIAL
