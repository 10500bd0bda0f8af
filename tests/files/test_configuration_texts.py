"""CONFIG and weights as people write them on a command line or in a file."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests.files.native_samples import write

import vincula as vc
from vincula.files.configuration import read_configuration
from vincula.files.units import Units
from vincula.files.weights import read_weights

MODEL = """
vincula: 1
space: spatial
joints:
  - {name: a, type: revolute, bodies: [ground, b1], at: [0, 0, 0], axis: [0, 0, 1],
     limits: {rate: 2, effort: 10}}
  - {name: "left,arm", type: prismatic, bodies: [b1, b2], axis: [1, 0, 0], limits: {rate: 0.5, effort: 100}}
  - {name: j.k, type: universal, bodies: [b2, b3], at: [0, 0, 1], axes: [[1, 0, 0], [0, 1, 0]]}
  - {name: ball, type: spherical, bodies: [b3, b4], at: [0, 0, 2]}
  - {name: base, type: free, bodies: [ground, b5]}
  - {name: s, type: screw, bodies: [b5, b6], at: [0, 0, 0], axis: [0, 0, 1], lead: 0.01}
motors: [a, "left,arm"]
keyframes: {up: {a: 1.0, ball: [0, 1, 0, 0]}}
reference: {body: b4}
"""


@pytest.fixture
def mechanism(tmp_path: Path) -> vc.Mechanism:
    return vc.load(write(tmp_path, MODEL))


GOOD = {
    "a=0.3": {"a": [0.3]},
    " a = 0.3 , ": {"a": [0.3]},
    "a=30deg": {"a": [math.pi / 6]},
    "a=30 deg": {"a": [math.pi / 6]},
    "a=-pi/6": {"a": [-math.pi / 6]},
    "a=1e-3,j.k=[0.1,-.2]": {"a": [1e-3], "j.k": [0.1, -0.2]},
    "j.k=0.1 0.2": {"j.k": [0.1, 0.2]},
    "j.k.2=0.2": {"j.k": [0, 0.2]},
    "j.k.2=0.2,j.k.1=0.1": {"j.k": [0.1, 0.2]},
    '"left,arm"=20mm,a=0.1': {"left,arm": [0.02], "a": [0.1]},
    "'left,arm' = 0.02": {"left,arm": [0.02]},
    "ball=[0,3,0,4]": {"ball": [0, 0.6, 0, 0.8]},
    "base=[1,2,3,1,0,0,0]": {"base": [1, 2, 3, 1, 0, 0, 0]},
    "base=[1cm,2cm,3cm,1,0,0,0]": {"base": [0.01, 0.02, 0.03, 1, 0, 0, 0]},
    "s=100": {"s": [100]},
    "key:up": {"a": [1.0], "ball": [0, 1, 0, 0]},
}


@pytest.mark.parametrize("text", GOOD)
def test_configurations(text: str, mechanism: vc.Mechanism) -> None:
    found = read_configuration(text, mechanism)
    for joint, value in found.items():
        expected = GOOD[text].get(joint, mechanism.home[joint])
        np.testing.assert_allclose(value, expected, rtol=1e-15, atol=1e-17)


BAD = {
    "a": "there is no such file .*name=value",
    "=1": "cannot read '=1'",
    "a=": "cannot read",
    "a==1": "cannot read",
    "a=1,,b=2": "cannot read",
    "a=[1": "cannot read",
    "a=1,a=2": "'a' is given twice",
    "b=1": "no joint with a configuration value is named 'b'",
    "ball.x=1": "no joint with a configuration value is named 'ball.x'",
    "a=1 2": "a has 1 values?, got 2",
    "ball=1": r"ball has 4 values, got 1: write ball=\[1,0,0,0\]",
    "ball=[0,0,0,0]": "length zero",
    "a=nan": "give a number",
    "a=1,5": "cannot read '5'",
    "a=٣": "give a number",
    "a=0x10": "give a number|unit",
    "a=30mm": "unit 'mm' is not one of rad, deg",
    "a=30": "a is 30: angles are in radians here",
    "a=1/0": "cannot read|give a number",
    "a=pi/0": "division by zero",
    "a=__import__('os')": "cannot read|give a number",
    "key:down": "no keyframe is named 'down'.*Known: up",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_configurations(text: str, mechanism: vc.Mechanism) -> None:
    with pytest.raises((vc.ModelError, vc.FileError), match=BAD[text]):
        read_configuration(text, mechanism)


def test_units_of_the_file(mechanism: vc.Mechanism, tmp_path: Path) -> None:
    units = Units("mm", "deg")
    text = 'a=90,"left,arm"=20,base=[1000,0,0,1,0,0,0],j.k=[0.5rad,90]'
    file = write(tmp_path, json.dumps({"a": 90, "left,arm": 20, "base": [1000, 0, 0, 1, 0, 0, 0]}), "q.json")
    for given in (text, str(file)):
        found = read_configuration(given, mechanism, units)
        assert found["a"] == pytest.approx([math.pi / 2])
        assert found["left,arm"] == pytest.approx([0.02])
        assert found["base"][0] == pytest.approx(1.0)
    assert read_configuration(text, mechanism, units)["j.k"] == pytest.approx([0.5, math.pi / 2])


def test_configuration_files(mechanism: vc.Mechanism, tmp_path: Path) -> None:
    file = write(tmp_path, "a: 0.25\nj.k: [0.1, pi/8]\nball: [1, 0, 0, 1]\n", "q.yaml")
    found = read_configuration(str(file), mechanism)
    np.testing.assert_allclose(found["j.k"], [0.1, math.pi / 8])
    np.testing.assert_allclose(found["ball"], np.array([1, 0, 0, 1]) / math.sqrt(2))
    assert found["s"][0] == 0.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 0.1\nc: 2\n", r"q\.yaml:2:4: c: no joint .* named 'c'"),
        ("a: 0.1\nball: [1, 0]\n", r"q\.yaml:2:7: ball: ball has 4 values, got 2"),
        ("a: far\n", r"q\.yaml:1:4: a: got 'far', expected a number"),
        ("- 1\n", r"q\.yaml:1:1: got a list of 1, expected a table"),
        ("a: 90\n", r"q\.yaml:1:4: a: a is 90: angles are in radians"),
        ("a: 0.1\na: 0.2\n", r"q\.yaml:2:1: a: the key 'a' is already in line 1"),
        ("", r"q\.yaml:1:1: the file is empty"),
    ],
)
def test_bad_configuration_files(text: str, expected: str, mechanism: vc.Mechanism, tmp_path: Path) -> None:
    with pytest.raises(vc.FileError, match=expected):
        read_configuration(str(write(tmp_path, text, "q.yaml")), mechanism)


def test_weights_texts(mechanism: vc.Mechanism) -> None:
    weights = read_weights("twist=1,1,1,5,5,5", mechanism)
    np.testing.assert_array_equal(weights.twist, [1, 1, 1, 5, 5, 5])
    assert weights.explicit
    weights = read_weights(
        "rate=a:4,left,arm:2; torque=2; reciprocal=false".replace("left,arm:2", "x:2"), mechanism
    )
    assert weights.rate == {"a": 4.0, "x": 2.0}
    assert float(np.asarray(weights.torque)) == 2.0
    assert read_weights("twist=1;reciprocal", mechanism).reciprocal
    assert read_weights("contact_force=all rows", mechanism).contact_force == "all rows"
    limits = read_weights("limits", mechanism)
    assert limits.rate == {"a": 0.25, "left,arm": 4.0}
    assert limits.torque == {"a": 0.01, "left,arm": 1e-4}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("twists=1", "no weight is named 'twists'; did you mean 'twist'"),
        ("twist=1,x", "give a number"),
        ("twist=", "cannot read 'twist='"),
        ("twist=-1", "weights are zero"),
        ("twist=1;twist=2", "given twice"),
        ("rate=a:1,a:2", "each name once"),
        ("twist=1;wrench=1;reciprocal", "reciprocal"),
        ("nothing.yaml", "there is no such file .*weights are a file"),
    ],
)
def test_bad_weights_texts(text: str, expected: str, mechanism: vc.Mechanism) -> None:
    with pytest.raises((vc.ModelError, vc.FileError), match=expected):
        read_weights(text, mechanism)


def test_weights_files(mechanism: vc.Mechanism, tmp_path: Path) -> None:
    metric = np.diag([2.0, 1.0, 1.0, 3.0, 3.0, 3.0])
    file = write(tmp_path, f"twist: {metric.tolist()}\nrate: {{a: 4}}\nreciprocal: true\n", "w.yaml")
    weights = read_weights(str(file), mechanism)
    np.testing.assert_array_equal(weights.twist, metric)
    assert weights.reciprocal
    bad = write(tmp_path, "twist: [1, -1]\n", "w.yaml")
    with pytest.raises(vc.FileError, match=r"w\.yaml:1:8: twist: weight twist\[1\] is -1"):
        read_weights(str(bad), mechanism)
    bad = write(tmp_path, "rates: 1\ntwist: x\n", "w.yaml")
    with pytest.raises(vc.FileError, match="2 problems"):
        read_weights(str(bad), mechanism)
