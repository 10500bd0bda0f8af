"""Results are the same numbers wherever they go: past the caches, straight, one by one, or in one array."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.arrays import Matrix
from vincula.kernels import lane_path

pytest.importorskip("numba")

from vincula.kernels.lanes.outputs import BOUNDS, EFFORTS, MOTIONS

ASKED = (
    "kinematic.efficiencies", "kinematic.task_directions", "kinematic.motor_directions", "bounds",
    "active_force.efficiencies", "active_force.task_directions", "active_force.motor_directions",
    "passive_force.efficiencies", "kinematic.smallest", "active_force.largest", "kinematic.classes",
    "closure.residual", "summary",
)  # fmt: skip
NAMES = ("stewart", "five-bar")


def configurations(compiled: vc.CompiledMechanism, count: int) -> Matrix:
    """Closed configurations: home, and the way there and back along the first motor."""
    mechanism = compiled.mechanism
    home = mechanism.home
    closed = [mechanism.close(home, motors={mechanism.active[0]: home[mechanism.active[0]][0] + step}).flat
              for step in (0.0, 0.05, 0.1)]  # fmt: skip
    return np.array([closed[k % 3] for k in range(count)])


def same(one: vc.Evaluation, other: vc.Evaluation) -> None:
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)


@pytest.mark.parametrize("name", NAMES)
def test_past_the_caches(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole lines, with a last block that is not full, give the bits of plain writing."""
    compiled = vc.compile(vc.load(f"example:{name}"))
    lanes = configurations(compiled, 1500)
    plain = compiled.evaluate(lanes, ASKED, path="lanes")
    assert not plain.status.any()
    monkeypatch.setattr(lane_path, "PAST_CACHES", 0)
    same(compiled.evaluate(lanes, ASKED, path="lanes"), plain)
    same(compiled.evaluate(lanes[:21], ASKED, path="lanes", threads=1), _first(plain, 21))


@pytest.mark.parametrize("name", NAMES)
def test_one_by_one(name: str) -> None:
    compiled = vc.compile(vc.load(f"example:{name}"))
    lanes = configurations(compiled, 3)
    whole = compiled.evaluate(lanes, ASKED, path="lanes")
    for k, flat in enumerate(lanes):
        one = compiled.evaluate(flat, ASKED)
        assert one.names == whole.names
        for quantity in whole:
            np.testing.assert_array_equal(one[quantity], whole[quantity][k], err_msg=quantity)


def test_results_of_one_configuration_are_its_own() -> None:
    """Memory is used again from call to call, results are not."""
    compiled = vc.compile(vc.load("example:stewart"))
    lanes = configurations(compiled, 3)
    first = compiled.evaluate(lanes[0], ASKED)
    kept = {name: np.array(array) for name, array in first.items()}
    first["kinematic.efficiencies"][...] = -1.0
    compiled.evaluate(lanes[1], ASKED)
    again = compiled.evaluate(lanes[0], ASKED)
    for name, value in kept.items():
        np.testing.assert_array_equal(again[name], value, err_msg=name)


@pytest.mark.parametrize("name", NAMES)
def test_raw_results_are_those_of_the_door(name: str) -> None:
    """Efforts under equal weights are copied from motions: the reciprocal, the same axes in reverse."""
    compiled = vc.compile(vc.load(f"example:{name}"))
    lanes = configurations(compiled, 40)
    writers = compiled._runner.writers(compiled._plan(ASKED), False)
    assert not isinstance(writers, str)
    program = writers.path.program
    found = compiled.evaluate(lanes, ASKED, path="lanes")
    raw = program.run(lanes, want=MOTIONS | EFFORTS | BOUNDS)
    assert raw.certain.all()
    count = raw.efficiencies.shape[1]
    np.testing.assert_array_equal(found["kinematic.efficiencies"][:, :count], raw.efficiencies)
    np.testing.assert_array_equal(found["active_force.efficiencies"][:, :count],
                                  1.0 / raw.efficiencies[:, ::-1])  # fmt: skip
    object.__setattr__(program, "shared", 0)
    apart = program.run(lanes, want=MOTIONS | EFFORTS | BOUNDS)
    for part in ("twists", "rates", "wrenches", "torques", "bounds"):
        np.testing.assert_array_equal(getattr(apart, part), getattr(raw, part), err_msg=part)


def _first(found: vc.Evaluation, count: int) -> vc.Evaluation:
    parts = {name: found[name][:count] for name in found}
    return vc.Evaluation((count,), found.quantities, parts, lambda lane: "")
