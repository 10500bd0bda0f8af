"""A file as a function of its parameters."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import vincula as vc

FILE = """\
vincula: 1
space: planar
units: {length: mm, angle: deg}
parameters: {crank: 300, ratio: 2}
joints:
  - {name: o1, type: revolute, bodies: [ground, crank], at: [0, 0]}
  - {name: o2, type: revolute, bodies: [crank, rod], at: [0, $crank]}
  - {name: o3, type: revolute, bodies: [rod, rocker], at: ['$crank*$ratio', $crank]}
  - {name: o4, type: revolute, bodies: [rocker, ground], at: ['$crank*$ratio', -100]}
motors: [o1]
reference: {body: rod, origin: [0, 0]}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bars.yaml"
    path.write_text(FILE)
    return path


def test_a_file_is_a_function_of_its_parameters(file: Path) -> None:
    build = vc.builder(file, {"ratio": 3})
    assert build.parameters == {"crank": 300.0, "ratio": 3.0}
    again = pickle.loads(pickle.dumps(build))
    for made in (build(crank=250.0), again(crank=250.0)):
        want = vc.load(file, {"crank": 250.0, "ratio": 3})
        np.testing.assert_array_equal(made.frame_table.position, want.frame_table.position)
    over = file.parent / "over.yaml"
    over.write_text("vincula: 1\nbase: bars.yaml\nparameters: {more: 1}\n")
    assert vc.builder(over).parameters == {"crank": 300.0, "ratio": 2.0, "more": 1.0}


def test_changes_are_made_to_every_mechanism(file: Path) -> None:
    build = (
        vc.builder(file).with_active(["o4"]).with_reference("rocker", (0.0, 0.0)).with_weights(vc.Weights())
    )
    made = build(crank=200.0)
    assert made.active == ("o4",)
    assert made.reference is not None
    assert made.reference.body == "rocker"
    compiled = vc.compile(build)
    found = compiled.evaluate(None, ["kinematic.efficiencies"], parameters={"crank": [200.0, 400.0]})
    for lane, crank in enumerate((200.0, 400.0)):
        want = vc.kinematic_ellipsoid(build(crank=crank).linearize()).efficiencies
        np.testing.assert_allclose(found["kinematic.efficiencies"][lane, : len(want)], want, rtol=1e-12)


def test_examples_are_builders_too() -> None:
    build = vc.builder("example:stewart", {"alpha": "2deg"})
    assert build.parameters["alpha"] == pytest.approx(np.radians(2))
    assert build.parameters["upper_radius"] == 1.5
    compiled = vc.compile(build)
    found = compiled.evaluate(None, ["summary"], parameters={"beta": [np.radians(2.0), 1.0]})
    assert found["summary"][:, 3].tolist() == [3, 0]


def test_what_cannot_be_built_is_told_at_once(file: Path) -> None:
    with pytest.raises(vc.UnknownNameError, match="crank"):
        vc.builder(file, {"crnk": 1})
    with pytest.raises(vc.FileError):
        vc.builder(file.parent / "none.yaml")
    assert vc.builder(file).parameters
