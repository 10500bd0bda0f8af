"""The native format: what is written there is what the same words give in Python."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR, write

import vincula as vc
from vincula.files.load import load_with_report
from vincula.mechanism.joint_types import JOINT_TYPES
from vincula.spatial.selectors import CONTACT_TYPES


def same_model(one: vc.LinearModel, other: vc.LinearModel, tolerance: float = 1e-15) -> None:
    assert [row.name for row in one.rows] == [row.name for row in other.rows]
    assert [c.name for c in one.columns] == [c.name for c in other.columns]
    for name in ("jacobian_active", "jacobian_passive", "grasp"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=0, atol=tolerance)


def five_bar_in_python(scale: float = 1.0) -> vc.Mechanism:
    points = scale * np.array([[-1, -2], [-1, 0], [0, 0], [1, -1], [1, -2]])
    bodies = ["ground", "crank", "coupler", "link", "rocker", "ground"]
    return vc.Mechanism.planar(
        joints=[vc.Revolute(f"o{k + 1}", bodies[k], bodies[k + 1], at=points[k]) for k in range(5)],
        reference=vc.Reference(
            "coupler",
            origin=(-0.5 * scale, 0),
            cuts={"o2": vc.Cut(at=(-2 / 3 * scale, 0)), "o3": vc.Cut(at=(-1 / 3 * scale, 0))},
        ),
        active=["o1", "o5"],
        weights=vc.Weights(),
    )


def test_the_five_bar_is_the_one_of_the_paper(tmp_path: Path, paper: dict) -> None:
    mechanism = vc.load(write(tmp_path, FIVE_BAR))
    found = vc.kinematic_ellipsoid(mechanism.linearize()).efficiencies
    np.testing.assert_allclose(found, paper["five_bar"]["motors_1_5"]["kinematic"], atol=5e-5)
    same_model(mechanism.linearize(), five_bar_in_python().linearize())
    everything = mechanism.with_active(vc.ALL).linearize()
    found = vc.internal_force_ellipsoid(everything).efficiencies
    np.testing.assert_allclose(found, paper["five_bar"]["motors_all"]["internal_force"], atol=5e-5)


def test_parameters_are_set_from_outside(tmp_path: Path) -> None:
    path = write(tmp_path, FIVE_BAR)
    same_model(vc.load(path, {"l": 2.5}).linearize(), five_bar_in_python(2.5).linearize())
    same_model(vc.load(path, {"l": "250cm"}).linearize(), five_bar_in_python(2.5).linearize())
    same_model(vc.load(path, {"l": "5/2*sqrt(1)"}).linearize(), five_bar_in_python(2.5).linearize())
    with pytest.raises(vc.UnknownNameError, match=r"no parameter is named 'L'.*Known: l"):
        vc.load(path, {"L": 1.0})
    with pytest.raises(vc.ModelError, match="a decimal point, not a comma"):
        vc.load(path, {"l": "2,5"})


def test_millimetres_and_degrees_give_the_same_matrices(tmp_path: Path) -> None:
    """To the last bit: typed decimals become the same doubles."""
    metres = """
vincula: 1
space: spatial
joints:
  - {name: a, type: cylindrical, bodies: [ground, b1], at: [0.1, 0.2, 0.3], axis: [0, 0.6, 0.8]}
  - {name: b, type: screw, bodies: [b1, b2], at: [0.35, 0.2, 0.3], axis: [1, 0, 0], lead: 0.005}
couplings: [{name: rack, rates: {a.rotation: 0.02, a.translation: 1.0}}]
motors: [{name: m, drives: {a.translation: 2, b: 0.004}}]
configuration: {a: [0.5235987755982988, -0.010471975511965976]}
reference: {body: b2, origin: [0.4, 0.1, 0.7]}
"""
    millimetres = """
vincula: 1
space: spatial
units: {length: mm, angle: deg}
joints:
  - {name: a, type: cylindrical, bodies: [ground, b1], at: [100, 200, 300], axis: [0, 0.6, 0.8]}
  - {name: b, type: screw, bodies: [b1, b2], at: [350, 200, 300], axis: [1, 0, 0], lead: 5}
couplings: [{name: rack, rates: {a.rotation: 0.3490658503988659, a.translation: 1.0}}]
motors: [{name: m, drives: {a.translation: 2, b: 0.06981317007977318}}]
configuration: {a: [30, -10.471975511965976]}
reference: {body: b2, origin: [400, 100, 700]}
"""
    one = vc.load(write(tmp_path, metres, "m.yaml"))
    other = vc.load(write(tmp_path, millimetres, "mm.yaml"))
    np.testing.assert_allclose(one.home["a"], other.home["a"], rtol=1e-15)
    # The rows of the file are multiplied by the size of the unit of their first axis.
    a, b = one.couplings[0].rates, other.couplings[0].rates
    assert a["a.translation"] / a["a.rotation"] == pytest.approx(
        b["a.translation"] / b["a.rotation"], rel=1e-14
    )
    assert one.drives[0].drives == pytest.approx(dict(other.drives[0].drives), rel=1e-14)
    np.testing.assert_allclose(
        vc.kinematic_ellipsoid(one.linearize(), vc.Weights()).efficiencies,
        vc.kinematic_ellipsoid(other.linearize(), vc.Weights()).efficiencies,
        rtol=1e-12,
    )


def test_five_bar_in_every_unit_of_length(tmp_path: Path) -> None:
    for unit, factor in (("mm", 1e3), ("cm", 1e2), ("m", 1.0)):
        text = FIVE_BAR.replace("l: 1.0", f"l: {factor:g}").replace(
            "space:", f"units: {{length: {unit}}}\nspace:"
        )
        same_model(vc.load(write(tmp_path, text)).linearize(), five_bar_in_python().linearize(), 1e-15)
    inches = FIVE_BAR.replace("space:", "units: {length: in}\nspace:")
    same_model(vc.load(write(tmp_path, inches)).linearize(), five_bar_in_python(0.0254).linearize(), 1e-15)


def all_joints_in_python() -> vc.Mechanism:
    ball = (
        vc.Spherical("k", "b5", "b6", at=(2, 1, 1)),
        vc.PlanarJoint("e", "b6", "b7", (2, 2, 1), (1, 1, 1)),
    )
    return vc.Mechanism.spatial(
        bodies=[vc.Body(name) for name in ("plate", "b1", "b2", "b3", "b4", "b5", "b6", "b7", "hand", "vane")]
        + [vc.Body("tool", "hand", (3, 2, 1))],
        joints=[
            vc.Revolute("r", "ground", "b1", at=(0, 0, 1), axis=(0, 0.6, 0.8)),
            vc.Prismatic("p", "b1", "b2", axis=(1, 0, 0)),
            vc.Screw("s", "b2", "b3", at=(1, 0, 0), axis=(0, 0, 1), lead=-0.01),
            vc.Cylindrical("c", "b3", "b4", at=(1, 1, 0), axis=(0, 1, 1)),
            vc.Universal("u", "b4", "b5", at=(1, 1, 1), axes=((1, 0, 0), (0, 1, 0))),
            *ball,
            vc.Fixed("f", "b7", "hand"),
            vc.Free("fl", "ground", "plate", at=(0, 0, 5)),
            vc.Revolute("v", "plate", "vane", at=(4, 2, 2), axis=(1, 0, 0)),
        ],
        contacts=[
            vc.Contact("c1", "tool", "plate", "line-friction", (3, 2, 2), (0, 0, 1), (1, 1, 0), 0.5),
            vc.Contact("c2", "vane", "tool", "soft-finger", (3.5, 2, 2), (1, 0, 0)),
        ],
        reference=vc.Reference("plate", origin=(3, 2, 2), axes="body"),
        lock=["s"],
        active=["r", "c.translation", "u.2", "k"],
    )


def test_every_joint_and_contact_as_in_python(tmp_path: Path) -> None:
    one = vc.load(write(tmp_path, ALL_JOINTS))
    same_model(one.linearize(), all_joints_in_python().linearize(), 1e-14)
    assert one.contacts[0].friction == 0.5
    assert one.active == ("r", "c.translation", "u.2", "k.x", "k.y", "k.z")
    assert one.lock == ("s",)


def test_json_is_read_like_yaml(tmp_path: Path) -> None:
    from ruamel.yaml import YAML

    content = YAML(typ="safe", pure=True).load(ALL_JOINTS)
    for name in ("model.json", "model.txt", "model.yaml"):
        path = write(tmp_path, json.dumps(content), name)
        same_model(vc.load(path).linearize(), vc.load(write(tmp_path, ALL_JOINTS, "a.yaml")).linearize(), 0.0)


def test_content_decides_not_the_ending(tmp_path: Path) -> None:
    expected = five_bar_in_python().linearize()
    for name in ("model.json", "model.xml", "model"):
        same_model(vc.load(write(tmp_path, FIVE_BAR, name)).linearize(), expected)
    (tmp_path / "crlf.yaml").write_bytes(b"\xef\xbb\xbf" + FIVE_BAR.replace("\n", "\r\n").encode())
    same_model(vc.load(tmp_path / "crlf.yaml").linearize(), expected)


def test_type_names_are_those_of_the_library() -> None:
    from vincula.files.json_schema import json_schema

    definitions = json_schema()["$defs"]
    mapping = definitions["NativeFile"] if "NativeFile" in definitions else json_schema()
    joints = mapping["properties"]["joints"]["items"]["discriminator"]["mapping"]
    assert set(joints) == set(JOINT_TYPES)
    assert set(definitions["ContactEntry"]["properties"]["type"]["enum"]) == set(CONTACT_TYPES)


def test_the_published_schema_says_what_is_read() -> None:
    from vincula.files.json_schema import json_schema

    schema = json_schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["additionalProperties"] is False
    assert schema["required"] == ["vincula"]
    assert '"null"' not in json.dumps({k: v for k, v in schema.items() if k != "$defs"})
    words = "vincula space units parameters bodies joints contacts closures couplings motors lock reference "
    assert set(f"{words} weights configuration base".split()) <= set(schema["properties"])


def test_loops_through_named_frames(tmp_path: Path) -> None:
    """A five-bar whose last joint is a closure between frames has the same counts and efficiencies."""
    text = FIVE_BAR.replace(
        "- {name: o5, type: revolute, bodies: [rocker, ground], at: [$l, -2*$l]}", ""
    ).replace(
        "motors:",
        "frames: {foot: {body: rocker, at: [$l, -2*$l]}, base: {body: ground, at: [$l, -2*$l]}}\n"
        "closures: [{name: o5, type: revolute, frames: [foot, base]}]\nmotors:",
    )
    found, whole = (vc.load(write(tmp_path, t)).linearize() for t in (text, FIVE_BAR))
    for ellipsoid in (vc.kinematic_ellipsoid, vc.passive_force_ellipsoid):
        np.testing.assert_allclose(ellipsoid(found).efficiencies, ellipsoid(whole).efficiencies, rtol=1e-12)
    summaries = [vc.analyze(model).to_dict()["mobility"]["summary"] for model in (found, whole)]
    assert summaries[0] == summaries[1]


def test_configuration_and_keyframes_are_displacements(tmp_path: Path) -> None:
    text = """
vincula: 1
space: planar
units: {angle: deg}
joints:
  - {name: a, type: revolute, bodies: [ground, upper], at: [0, 0]}
  - {name: b, type: revolute, bodies: [upper, lower], at: [1, 0]}
couplings: [{name: belt, rates: {b: 1, a: 2}}]
configuration: {a: 30, b: -60}
keyframes: {straight: {a: 0, b: 0}, up: {a: 90}}
reference: {body: lower, origin: [2, 0]}
motors: [a]
"""
    mechanism = vc.load(write(tmp_path, text))
    assert mechanism.home["a"][0] == pytest.approx(math.pi / 6, rel=1e-15)
    tip = mechanism.body_poses()["lower"].apply(np.array([2.0, 0.0]))
    np.testing.assert_allclose(tip, [math.cos(math.pi / 6) * 2, 0.0], atol=1e-15)
    assert all(residual.gap < 1e-15 for residual in mechanism.residuals())
    assert mechanism.residuals({"a": 0.1})[0].gap > 0.1  # the belt stays what it was drawn as
    assert mechanism.keyframes["up"] == {"a": (pytest.approx(math.pi / 2),)}


def test_an_open_loop_is_named_when_it_is_used(tmp_path: Path) -> None:
    mechanism = vc.load(write(tmp_path, FIVE_BAR + "configuration: {o1: 0.2}\n"))
    with pytest.raises(vc.ClosureError, match=r"o[1-5]") as refused:
        mechanism.linearize()
    assert refused.value.gap > 0.1


def test_limits_named_motors_and_weights_from_limits(tmp_path: Path) -> None:
    text = """
vincula: 1
space: planar
units: {length: cm, angle: deg}
joints:
  - {name: a, type: revolute, bodies: [ground, arm], at: [0, 0],
     limits: {lower: -90, upper: 180, rate: 360, effort: 5}}
  - {name: b, type: prismatic, bodies: [arm, rod], axis: [1, 0], limits: {upper: 50, rate: 20, effort: 100}}
motors: [{name: shoulder, axis: a}, b]
reference: {body: rod, origin: [100, 0]}
weights: limits
"""
    mechanism = vc.load(write(tmp_path, text))
    a, b = (joint.limits[0] for joint in mechanism.joints)
    assert (a.lower, a.upper, a.rate, a.effort) == pytest.approx((-math.pi / 2, math.pi, 2 * math.pi, 5))
    assert (b.lower, b.upper, b.rate, b.effort) == (None, 0.5, 0.2, 100)
    assert mechanism.with_active(["shoulder"]).active == ("a",)
    weights = mechanism.weights
    assert weights is not None
    assert weights.rate == pytest.approx({"a": 1 / (2 * math.pi) ** 2, "b": 1 / 0.04})
    assert weights.torque == pytest.approx({"a": 1 / 25, "b": 1e-4})


@pytest.mark.parametrize(
    ("at", "axis", "length", "angle"),
    [
        ("[0, 0, 1.5]", "[0, 0, 1]", 0.0, 0.0),
        ("[0, 0, 1.57080]", "[0, 0, 1]", 5e-6, 0.0),
        ("[0, 0, 0.5]", "[0, 0.7071, 0.7071]", 0.0, 5e-5),
        ("[$l, 0, 0]", "[0, 0, 1]", 5e-6, 0.0),
        ("[100*$l, 0, 0]", "[0, 0, 1]", 5e-4, 0.0),
    ],
)
def test_typed_digits(tmp_path: Path, at: str, axis: str, length: float, angle: float) -> None:
    text = f"""
vincula: 1
space: spatial
parameters: {{l: 1.23456}}
joints: [{{name: a, type: revolute, bodies: [ground, arm], at: {at}, axis: {axis}}}]
reference: {{body: arm, origin: [0.123456, 0, 0]}}
"""
    precision = vc.load(write(tmp_path, text)).precision
    assert precision.digits_length == pytest.approx(length)
    assert precision.digits_angle == pytest.approx(angle, rel=1e-3)


def test_examples_are_loaded_by_name() -> None:
    mechanism, report = load_with_report("example:stewart", {"alpha": "1deg", "beta": "-120deg"})
    assert report.counts()["contact"]["used"] == 6
    assert mechanism.name == "stewart"
    with pytest.raises(vc.UnknownNameError, match="did you mean 'five-bar'"):
        vc.load("example:five_bar")
    with pytest.raises(vc.UnknownNameError, match="parameter of example"):
        vc.load("example:stewart", {"gamma": 1.0})


def test_a_serial_arm_and_a_lone_body_in_contact_are_legal(tmp_path: Path) -> None:
    arm = (
        "vincula: 1\nspace: planar\njoints: [{name: a, type: revolute, bodies: [ground, arm], at: [0, 0]}]\n"
    )
    mechanism = vc.load(write(tmp_path, arm + "motors: [a]\nreference: {body: arm, origin: [1, 0]}\n"))
    assert vc.kinematic_ellipsoid(mechanism.linearize(), vc.Weights()).efficiencies == pytest.approx([2.0])
    box = (
        "vincula: 1\nspace: planar\nreference: {body: box, origin: [0, 1]}\ncontacts:\n"
        "  - {name: left, type: point, bodies: [ground, box], at: [-1, 0], normal: [0, 1]}\n"
        "  - {name: right, type: point, bodies: [ground, box], at: [1, 0], normal: [0, 1]}\n"
    )
    model = vc.load(write(tmp_path, box)).linearize()
    assert model.grasp.shape == (3, 2)


def test_world_is_the_ground_unless_a_body_is_called_so(tmp_path: Path) -> None:
    text = FIVE_BAR.replace("ground", "world")
    same_model(vc.load(write(tmp_path, text)).linearize(), five_bar_in_python().linearize())
    own = vc.load(write(tmp_path, FIVE_BAR.replace("crank", "world") + "bodies: {world: {}}\n"))
    assert "world" in own.body
    same_model(own.linearize(), five_bar_in_python().linearize())
