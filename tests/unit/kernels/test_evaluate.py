"""The front door: what a batch says is what the ordinary functions say, one configuration at a time."""

from __future__ import annotations

import json
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import vincula as vc
from vincula.kernels.evaluation import FAILED, NO_CLOSURE, OK, OPEN
from vincula.kernels.quantities import CLASS_CODES, KINDS, NO_CLASS, NO_COUNT
from vincula.mechanism.catalog import examples

ALL = ("status", "counts", "summary", "mobility",
       "closure.residual", "reference.pose", "configuration", "bounds",
       *(f"{kind}.{part}" for kind in KINDS
         for part in ("efficiencies", "classes", "task_directions", "motor_directions")))  # fmt: skip


@pytest.fixture
def five_bar() -> vc.CompiledMechanism:
    return vc.compile(vc.load("example:five-bar"))


@pytest.mark.parametrize("name", [entry.name for entry in examples()])
def test_home_is_what_analyze_says(name: str) -> None:
    mechanism = vc.load(f"example:{name}")
    model = mechanism.linearize()
    analysis = vc.analyze(model)
    found = vc.compile(mechanism).evaluate(None, ALL, path="reference")
    assert found.shape == ()
    assert found.status == OK
    for word, ellipsoid in zip(KINDS, analysis.ellipsoids, strict=True):
        count = len(ellipsoid.classes)
        values, classes = found[f"{word}.efficiencies"], found[f"{word}.classes"]
        np.testing.assert_array_equal(values[:count], ellipsoid.efficiencies)
        assert np.isnan(values[count:]).all()
        assert classes.tolist() == [CLASS_CODES[c] for c in ellipsoid.classes] + [NO_CLASS] * (
            len(values) - count
        )
        for side in ("task_directions", "motor_directions"):
            array = found[f"{word}.{side}"]
            for entry, direction in enumerate(getattr(ellipsoid, side)):
                wanted = np.full(array.shape[1], np.nan) if direction is None else direction
                np.testing.assert_array_equal(array[entry], wanted)
            assert np.isnan(array[count:]).all()
    assert found["counts"].tolist() == list(model.ledger.counts.as_dict().values())
    assert found["summary"].tolist() == list(model.ledger.summary.as_dict().values())
    assert found["mobility"] == model.ledger.summary.mobility
    assert found["closure.residual"] == model.uncertainty.residual
    np.testing.assert_array_equal(found["configuration"], mechanism.home.flat)
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["counts"] == found["counts"].tolist()


def test_leading_dimensions_are_anything(five_bar: vc.CompiledMechanism) -> None:
    home = five_bar.flat()
    lanes = np.stack([home] * 6)
    one = five_bar.evaluate(home)["kinematic.efficiencies"]
    assert five_bar.evaluate(lanes[:0])["kinematic.efficiencies"].shape == (0, *one.shape)
    assert five_bar.evaluate(np.empty((3, 0, 5))).shape == (3, 0)
    for shape in ((6,), (1, 6), (2, 3), (3, 1, 2)):
        found = five_bar.evaluate(lanes.reshape(*shape, -1))
        assert found.shape == shape
        np.testing.assert_array_equal(
            found["kinematic.efficiencies"], np.broadcast_to(one, (*shape, *one.shape))
        )


def test_indices_are_those_of_the_analysis(five_bar: vc.CompiledMechanism) -> None:
    model = five_bar.mechanism.linearize()
    names = (
        "yoshikawa_volume",
        "condition_number",
        "inverse_condition_number",
        "isotropy",
        "smallest_singular_value",
    )
    found = five_bar.evaluate(
        None, [f"kinematic.{n}:{part}" for n in names for part in ("translation", "all")]
    )
    for name in names:
        for part in ("translation", "all"):
            want = getattr(vc, name)(model, part)
            assert found[f"kinematic.{name}:{part}"] == pytest.approx(want, rel=1e-12, abs=1e-15)


def test_motors_are_followed_from_their_neighbours(five_bar: vc.CompiledMechanism) -> None:
    motors = np.linspace([0.0, 0.0], [-0.5, 0.3], 7)
    names = ("configuration", "closure.residual", "closure.iterations", "kinematic.efficiencies")
    loop = five_bar.evaluate(motors, names, given="motors", path="reference")
    assert (loop.status == OK).all()
    near = five_bar.mechanism.home
    for lane, (one, two) in enumerate(motors):
        near = five_bar.mechanism.close(near, motors={"o1": one, "o5": two}, attempts=1)
        np.testing.assert_array_equal(loop["configuration"][lane], near.flat)
        assert loop["closure.iterations"][lane] == near.iterations
    found = five_bar.evaluate(motors, names, given="motors")
    assert (found["closure.residual"] < 1e-12).all()
    for name in ("configuration", "kinematic.efficiencies"):
        np.testing.assert_allclose(found[name], loop[name], rtol=1e-10, atol=1e-12)
    backwards = five_bar.evaluate(motors[::-1], ["configuration"], given="motors", start=near)
    np.testing.assert_allclose(backwards["configuration"][::-1], found["configuration"], atol=1e-12)


def test_every_lane_has_its_own_start(five_bar: vc.CompiledMechanism) -> None:
    motors = np.linspace([0.0, 0.0], [-0.5, 0.3], 4)
    home = np.stack([five_bar.flat()] * 4)
    together = five_bar.evaluate(motors, ["configuration"], given="motors", start=home)["configuration"]
    for lane in range(4):
        alone = five_bar.evaluate(motors[lane], ["configuration"], given="motors")["configuration"]
        np.testing.assert_allclose(together[lane], alone, atol=1e-12)


def test_poses_of_the_member_give_themselves() -> None:
    compiled = vc.compile(vc.load("example:stewart"))
    poses = np.linspace([0, 0, 2, 1, 0, 0, 0], [0.1, -0.2, 2.2, 0.99, 0.05, -0.1, 0.08], 3)
    found = compiled.evaluate(poses, ["reference.pose"], given="reference")
    assert (found.status == OK).all()
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1)[:, None]
    np.testing.assert_allclose(found["reference.pose"], poses, atol=1e-13)


def test_what_cannot_be_evaluated_is_said_lane_by_lane(five_bar: vc.CompiledMechanism) -> None:
    lanes = np.stack([five_bar.flat()] * 3)
    lanes[1, 0] = np.nan
    lanes[2, 0] += 0.1
    found = five_bar.evaluate(lanes, ["kinematic.efficiencies", "mobility", "closure.residual"])
    assert found.status.tolist() == [OK, FAILED, OPEN]
    assert found["mobility"].tolist() == [2, NO_COUNT, NO_COUNT]
    assert np.isnan(found["kinematic.efficiencies"][1:]).all()
    assert found["closure.residual"][2] > 0.01
    assert found.reason(0) == ""
    assert "finite" in found.reason(1)
    assert "open by" in found.reason(2)
    away = five_bar.evaluate([[0.0, 0.0], [1.0, -1.0], [0.0, 0.0]], given="motors")
    assert away.status.tolist() == [OK, NO_CLOSURE, OK]
    assert away.reason(1)
    with pytest.raises(vc.ModelError, match="not in a batch"):
        found.reason(3)


def linkage(crank: float = 2.0, rocker: float = 1.0) -> vc.Mechanism:
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, -crank)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0)),
            vc.Revolute("o4", "link", "rocker", at=(1, -1)),
            vc.Revolute("o5", "rocker", "ground", at=(1, -1 - rocker)),
        ],
        reference=vc.Reference("coupler", origin=(-0.5, 0)),
        active=["o1", "o5"],
        weights=vc.Weights(),
    )


def test_parameters_a_lane() -> None:
    compiled = vc.compile(linkage)
    cranks = np.array([1.0, 2.0, 0.0, np.nan, 3.0])
    found = compiled.evaluate(parameters={"crank": cranks})
    for lane in (0, 1, 4):
        alone = vc.kinematic_ellipsoid(linkage(cranks[lane]).linearize()).efficiencies
        np.testing.assert_allclose(found["kinematic.efficiencies"][lane, : len(alone)], alone, rtol=1e-12)
    assert found.status[3] == FAILED
    grid = compiled.evaluate(parameters={"crank": cranks[:2, None], "rocker": np.array([1.0, 1.5, 2.0])})
    assert grid.shape == (2, 3)
    with pytest.raises(vc.UnknownNameError, match="crank"):
        compiled.evaluate(parameters={"crnk": cranks})
    with pytest.raises(vc.ModelError, match="builder"):
        vc.compile(linkage()).evaluate(parameters={"crank": cranks})


def test_refusals(five_bar: vc.CompiledMechanism) -> None:
    with pytest.raises(vc.UnknownNameError, match=r"kinematic\.efficiencies"):
        five_bar.evaluate(None, ["kinematic.eficiencies"])
    with pytest.raises(vc.ModelError, match="list of names"):
        five_bar.evaluate(None, "mobility")
    with pytest.raises(vc.ShapeError, match="o1, o2"):
        five_bar.evaluate(np.zeros((3, 4)))
    with pytest.raises(vc.ShapeError, match="fit together"):
        five_bar.evaluate(np.zeros((3, 2)), given="motors", start=np.zeros((2, 5)))
    with pytest.raises(vc.ModelError, match="choose configuration, motors, reference"):
        five_bar.evaluate(given="torques")  # type: ignore[arg-type]
    with pytest.raises(vc.ModelError, match="nothing is given"):
        five_bar.evaluate(given="motors")
    with pytest.raises(vc.ModelError, match="Mechanism"):
        vc.compile("five-bar")  # type: ignore[arg-type]
    with pytest.raises(vc.MissingReferenceError):
        vc.compile(vc.Mechanism.planar([vc.Revolute("o", "ground", "arm", at=(0, 0))]))


def test_units_that_nobody_chose() -> None:
    mechanism = vc.load("example:five-bar").with_weights(None)
    compiled = vc.compile(mechanism)
    with pytest.raises(vc.MixedUnitsError):
        compiled.evaluate(None, ["kinematic.condition"])
    with pytest.warns(vc.MixedUnitsWarning):
        compiled.evaluate(None, ["kinematic.condition:translation"])
    weighed = vc.compile(mechanism, weights=vc.Weights(twist=[1, 1, 4]))
    alone = vc.kinematic_ellipsoid(mechanism.linearize(), vc.Weights(twist=[1, 1, 4])).efficiencies
    found = weighed.evaluate()["kinematic.efficiencies"]
    np.testing.assert_allclose(found[: len(alone)], alone, rtol=1e-12)
    with pytest.raises(vc.WeightError):
        vc.compile(mechanism, weights=vc.Weights(twist=[1, 1]))


def test_a_compiled_mechanism_pickles() -> None:
    compiled = vc.compile(linkage)
    again = pickle.loads(pickle.dumps(compiled))
    assert again.coordinates == compiled.coordinates
    want = compiled.evaluate(parameters={"crank": 1.5})["kinematic.efficiencies"]
    np.testing.assert_array_equal(again.evaluate(parameters={"crank": 1.5})["kinematic.efficiencies"], want)


def test_distance_to_the_nearest_singularity() -> None:
    """A Stewart platform turned towards the pose in which all its legs would meet one line twice."""
    compiled = vc.compile(vc.builder("example:stewart"))
    betas = np.radians([-120.0, -60.0, 0.0, 1.0])
    found = compiled.evaluate(None, ["singularity.distance", "summary"], parameters={"beta": betas})
    distance = found["singularity.distance"]
    assert compiled.quantities["singularity.distance"].labels == (
        ("passive", "active+passive", "passive+member", "all"),
    )
    assert (distance[:3] > 1e-3).all()
    assert distance[3, 2] < 1e-13  # the member is free, motors locked
    assert distance[3, 0] > 0.1
    assert found["summary"][3, 3] == 3


def test_one_configuration_at_a_time(five_bar: vc.CompiledMechanism) -> None:
    names = ("kinematic.efficiencies", "mobility")
    alone = five_bar.at(five_bar.flat({}), names)
    assert alone.shape == ()
    np.testing.assert_array_equal(alone["kinematic.efficiencies"], five_bar.evaluate(None, names)[names[0]])
    assert alone["mobility"] == 2
    near = five_bar.at([-0.1, 0.1], ("configuration",), given="motors", start=five_bar.flat())
    closed = five_bar.mechanism.close(motors={"o1": -0.1, "o5": 0.1})
    np.testing.assert_allclose(near["configuration"], closed.flat, atol=1e-12)
    with pytest.raises(vc.ShapeError, match="one configuration"):
        five_bar.at(np.zeros((2, 5)))


def test_threads_share_a_compiled_mechanism(five_bar: vc.CompiledMechanism) -> None:
    motors = np.linspace([0.0, 0.0], [-0.5, 0.3], 8)
    want = five_bar.evaluate(motors, given="motors")["kinematic.efficiencies"]
    fresh = vc.compile(five_bar.mechanism)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: fresh.evaluate(motors, given="motors"), range(8)):
            np.testing.assert_array_equal(found["kinematic.efficiencies"], want)


def test_what_only_the_reference_path_does_is_said(five_bar: vc.CompiledMechanism) -> None:
    pytest.importorskip("numba")
    graded = vc.compile(five_bar.mechanism, weights=vc.Weights(twist=[1.0, 1.0, 1e12]))
    with pytest.raises(vc.ModelError, match=r"kinematic.efficiencies: weights of twist differ by more than"):
        graded.evaluate(None, path="lanes")
    assert graded.evaluate(None).status == OK
    assert five_bar.evaluate(None, ["internal_force.efficiencies"], path="lanes").status == OK
    assert five_bar.evaluate(np.zeros((0, 2)), given="motors", path="lanes").shape == (0,)


def test_lanes_without_numba_name_the_extra(
    five_bar: vc.CompiledMechanism, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vincula.kernels.lane_path.numba_is_installed", lambda: False)
    with pytest.raises(vc.MissingExtraError, match=r"vincula\[fast\]"):
        five_bar.evaluate(None, path="lanes")
    assert five_bar.evaluate(None).status == OK


def test_open_loops_need_no_second_look() -> None:
    """Lanes tell that a loop is open, and by how much, as one configuration alone does."""
    compiled = vc.compile(vc.load("example:3rrr"))
    rng = np.random.default_rng(3)
    lanes = compiled.flat() + 10.0 ** -rng.uniform(0.5, 12.0, (40, 1)) * rng.standard_normal((40, 9))
    names = ("closure.residual", "kinematic.efficiencies", "reference.pose")
    fast, slow = (compiled.evaluate(lanes, names, path=path) for path in ("auto", "reference"))
    np.testing.assert_array_equal(fast.status, slow.status)
    assert 5 < (fast.status == OPEN).sum() < 35
    np.testing.assert_allclose(fast["closure.residual"], slow["closure.residual"], rtol=1e-9, atol=1e-14)
    lane = int(np.flatnonzero(fast.status == OPEN)[0])
    assert fast.reason(lane) == slow.reason(lane)


def test_motor_values_of_a_mechanism_without_motors() -> None:
    """Loops are closed from where the lane before stands; there is nothing to give."""
    compiled = vc.compile(vc.load("example:five-bar").with_active([]))
    for shape in ((), (3,), (2, 0)):
        found = compiled.evaluate(np.empty((*shape, 0)), ("mobility",), given="motors", path="reference")
        assert found.shape == shape
        assert (found["mobility"] == 2).all()


def test_what_is_given_is_left_alone(five_bar: vc.CompiledMechanism) -> None:
    """Arrays of the caller are read where they are: never written, and frozen ones are taken too."""
    motors = np.linspace([0.0, 0.0], [0.2, -0.1], 40)
    closed = five_bar.evaluate(motors, ["configuration"], given="motors")["configuration"]
    for given, numbers in (("motors", motors), ("configuration", closed)):
        kept = numbers.copy()
        found = five_bar.evaluate(numbers, ["kinematic.efficiencies", "configuration"], given=given)
        np.testing.assert_array_equal(numbers, kept)
        frozen = numbers.copy()
        frozen.setflags(write=False)
        again = five_bar.evaluate(frozen, ["kinematic.efficiencies", "configuration"], given=given)
        for name in found:
            np.testing.assert_array_equal(again[name], found[name])
            assert not np.shares_memory(found[name], numbers)
