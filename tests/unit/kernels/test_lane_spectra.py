"""What lanes are certain of is what the ordinary functions say: integers, efficiencies, directions, bits."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.random_mechanisms import random_mechanism
from tests.unit.kernels.linkages import ladder, platform

import vincula as vc
from vincula.arrays import Matrix, Vector
from vincula.errors import VinculaError
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.closed import ClosedConfiguration
from vincula.mechanism.mechanism import Mechanism

pytest.importorskip("numba")

from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lane_relations import internal, structural
from vincula.kernels.lane_spectra import oriented
from vincula.kernels.lanes.flatten import Unsupported
from vincula.kernels.lanes.program import COUNTS, EFFORTS, MOTIONS, REST, LaneProgram, RawLanes
from vincula.kernels.small_subspaces import settled_bases


def flat(q: vc.Configuration) -> Vector:
    return np.concatenate([np.zeros(0), *q.values()])


def nearby(mechanism: Mechanism, rng: np.random.Generator, count: int, far: float = 0.2) -> Matrix:
    """Closed configurations around home."""
    found: list[Vector] = []
    while len(found) < count:
        start = {}
        for name, value in mechanism.home.items():
            moved = value + far * rng.normal(size=len(value))
            if len(value) in (4, 7):
                moved[-4:] /= np.linalg.norm(moved[-4:])
            start[name] = moved
        try:
            closed: ClosedConfiguration = mechanism.close(near=start)
        except VinculaError:
            continue
        found.append(flat(closed))
    return np.array(found)


def twice(mechanism: Mechanism) -> Matrix:
    """The home configuration in two lanes."""
    return np.tile(flat(mechanism.home), (2, 1))


def configuration(mechanism: Mechanism, row: Vector) -> vc.Configuration:
    values, at = {}, 0
    for name, home in mechanism.home.items():
        values[name] = row[at : at + len(home)]
        at += len(home)
    return mechanism.configuration(values)


def agrees(mechanism: Mechanism, program: LaneProgram, values: Matrix, raw: RawLanes) -> int:
    """Compare all certain lanes with the ordinary functions; how many were certain."""
    weights = mechanism.weights or vc.Weights()
    rest = _rest(program, raw)
    for i in np.flatnonzero(raw.certain):
        model = mechanism.linearize(configuration(mechanism, values[i]))
        assert model.ledger.summary == program.counts
        assert model.ledger.status == "certain"
        whole = model.ledger.decision("all")
        assert raw.angle[i] >= whole.cutoffs["rounding"] / whole.kept  # a bound, never below the truth
        ellipsoid = vc.kinematic_ellipsoid(model, weights)
        active, passive = (
            vc.active_force_ellipsoid(model, weights),
            vc.passive_force_ellipsoid(model, weights),
        )
        expected = ellipsoid.finite
        gap = np.abs(raw.efficiencies[i] - expected)
        assert (gap <= raw.bounds[i]).all()
        if raw.angle[i] < 1e-8 and len(expected):
            spread = np.maximum(1.0, np.maximum(expected, 1.0 / expected))
            assert (gap <= 1e-10 * expected * spread).all()
        if raw.angle[i] < 1e-6:
            _same_directions(ellipsoid, raw.twists, raw.rates, i)
            _same_directions(active, raw.wrenches, raw.torques, i)
            _same_rest(ellipsoid, active, passive, [part[i] for part in rest])
    return int(raw.certain.sum())


def _rest(program: LaneProgram, raw: RawLanes) -> list[Matrix]:
    """Infinite twists, zero rates, infinite wrenches, zero torques of all lanes."""
    assert raw.free is not None
    assert raw.idle is not None
    of_rates, of_twists = program.roots
    block = LaneBlock(program, raw, np.empty((len(raw.certain), 0)), None)
    found = raw.free, raw.idle, structural(block), internal(block)
    bases = [settled_bases(basis, raw.certain) for basis in found]
    factors = 1.0 / of_twists, 1.0 / of_rates, of_twists, of_rates
    return [oriented(basis * factor) for basis, factor in zip(bases, factors, strict=True)]


def _same_rest(
    kinematic: vc.Ellipsoid, active: vc.Ellipsoid, passive: vc.Ellipsoid, rest: list[Matrix]
) -> None:
    """Directions of the infinite and of the zero efficiencies."""
    ordinary = (
        (kinematic, "infinite", kinematic.task_directions), (kinematic, "zero", kinematic.motor_directions),
        (passive, "infinite", passive.task_directions), (active, "zero", active.motor_directions),
    )  # fmt: skip
    for (ellipsoid, name, directions), found in zip(ordinary, rest, strict=True):
        expected = [d for d, c in zip(directions, ellipsoid.classes, strict=True) if c == name]
        assert len(expected) == len(found)
        for one, other in zip(expected, found, strict=True):
            np.testing.assert_allclose(other, one, rtol=0, atol=1e-7)


def _same_directions(ellipsoid: vc.Ellipsoid, tasks: Matrix | None, motors: Matrix | None, i: int) -> None:
    """Directions of finite efficiencies that stand alone."""
    finite = [k for k, name in enumerate(ellipsoid.classes) if name == "finite"]
    values = ellipsoid.efficiencies[finite]
    assert tasks is not None
    assert motors is not None
    for place, k in enumerate(finite):
        others = np.delete(values, place)
        if (np.abs(others / values[place] - 1.0) < 1e-3).any():
            continue
        task, motor = ellipsoid.task_directions[k], ellipsoid.motor_directions[k]
        assert task is not None
        assert motor is not None
        sign = np.sign(task @ tasks[i, place])
        np.testing.assert_allclose(sign * tasks[i, place], task, rtol=0, atol=1e-7)
        np.testing.assert_allclose(sign * motors[i, place], motor, rtol=0, atol=1e-7)


EVERYTHING = MOTIONS | EFFORTS | REST


@pytest.mark.parametrize("name", MODULES)
def test_catalog(name: str, rng: np.random.Generator) -> None:
    mechanism = example(name)
    values = nearby(mechanism, rng, 10)
    program = LaneProgram.prepare(mechanism, None, [configuration(mechanism, row) for row in values[:3]])
    raw = program.run(values, want=EVERYTHING)
    assert agrees(mechanism, program, values, raw) == 10


@pytest.mark.parametrize("name", MODULES)
def test_twelve_counts(name: str, rng: np.random.Generator) -> None:
    mechanism = example(name)
    values = nearby(mechanism, rng, 4)
    program = LaneProgram.prepare(mechanism, None, [configuration(mechanism, row) for row in values[:3]])
    raw = program.run(values, want=COUNTS)
    for i in np.flatnonzero(raw.certain):
        ledger = mechanism.linearize(configuration(mechanism, values[i])).ledger
        assert ledger.counts == program.twelve
        assert ledger.status == "certain"
    assert raw.certain.all()


def test_random_mechanisms_as_drawn() -> None:
    """Every joint and contact type; limbs that branch, inner loops, couplings, drives, redundant motors."""
    prepared = certain = 0
    for seed in range(150):
        mechanism = random_mechanism(seed)
        if mechanism.linearize().ledger.status != "certain":
            continue
        program = LaneProgram.prepare(mechanism)
        values = twice(mechanism)
        prepared += 1
        certain += agrees(mechanism, program, values, program.run(values, want=EVERYTHING))
    assert prepared > 120
    assert certain > 1.8 * prepared


@pytest.mark.parametrize(
    ("loops", "spatial"), [(1, False), (3, False), (40, False), (100, False), (2, True), (12, True)]
)
def test_ladders(loops: int, spatial: bool, rng: np.random.Generator) -> None:
    mechanism = ladder(loops, spatial=spatial)
    values = nearby(mechanism, rng, 3, far=0.01)
    program = LaneProgram.prepare(mechanism, None, [configuration(mechanism, values[0])])
    raw = program.run(values, want=EVERYTHING)
    assert agrees(mechanism, program, values, raw) == 3


@pytest.mark.parametrize(("legs", "kind"), [(12, "soft-finger"), (30, "soft-finger"), (6, "hard-finger")])
def test_platforms(legs: int, kind: str) -> None:
    mechanism = platform(legs, kind)
    program = LaneProgram.prepare(mechanism)
    values = twice(mechanism)
    assert agrees(mechanism, program, values, program.run(values, want=EVERYTHING)) == 2


def test_singular_and_nearly_singular_platforms() -> None:
    """At and near a singularity lanes are certain of nothing that the ordinary ranks doubt or deny."""
    regular = example("stewart", alpha="20deg", beta="-100deg")
    program = LaneProgram.prepare(regular, general=True)
    values = twice(regular)
    seen = []
    for degrees in (0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1):
        mechanism = example("stewart", alpha="20deg", beta=float(np.deg2rad(20 + degrees)))
        constants = np.tile(program.constants_of(mechanism), (2, 1))
        raw = program.run(twice(mechanism), constants, want=EVERYTHING)
        seen.append(bool(raw.certain[0]))
        agrees(mechanism, program, twice(mechanism), raw)
    assert not any(seen[:2])
    assert all(seen[5:])
    assert program.run(values, np.tile(program.constants_of(regular), (2, 1))).certain[0]


def test_bits_do_not_depend_on_company_or_threads(rng: np.random.Generator) -> None:
    mechanism = example("3rrr")
    some = nearby(mechanism, rng, 12)
    program = LaneProgram.prepare(mechanism, None, [configuration(mechanism, some[0])])
    values = np.tile(some, (300, 1))
    whole = program.run(values, want=EVERYTHING, threads=1)
    many = program.run(values, want=EVERYTHING, threads=3)
    single = [program.run(row[None], want=EVERYTHING) for row in some]
    for name in RawLanes.__slots__:
        expected = getattr(whole, name)
        np.testing.assert_array_equal(getattr(many, name), expected)
        np.testing.assert_array_equal(np.concatenate([getattr(one, name) for one in single]), expected[:12])
        part = getattr(program.run(values[5:41], want=EVERYTHING), name)
        np.testing.assert_array_equal(part, expected[5:41])


def test_open_loops_and_numbers_out_of_range_are_not_certain(rng: np.random.Generator) -> None:
    mechanism = example("five-bar")
    values = nearby(mechanism, rng, 3)
    program = LaneProgram.prepare(mechanism)
    values[0, 1] += 1e-3
    values[2, 0] = np.nan
    assert program.run(values).certain.tolist() == [False, True, False]


def test_no_configurations_at_all() -> None:
    raw = LaneProgram.prepare(example("five-bar")).run(np.empty((0, 5)), want=EVERYTHING)
    assert raw.certain.shape == (0,)
    assert raw.efficiencies.shape == (0, 2)


def test_weights_enter(rng: np.random.Generator) -> None:
    mechanism = example("stewart").with_weights(
        vc.Weights(twist=[1, 2, 3, 4, 5, 6], rate=[1, 2, 1, 3, 1, 4], reciprocal=True)
    )
    values = nearby(mechanism, rng, 4)
    program = LaneProgram.prepare(mechanism)
    assert agrees(mechanism, program, values, program.run(values, want=EVERYTHING)) == 4
    with pytest.raises(Unsupported):
        LaneProgram.prepare(mechanism, vc.Weights(twist=[1, 1, 1, 0, 0, 0]))


@pytest.mark.parametrize("size", [3e-4, 2e-3, 300.0, 4000.0])
def test_plain_weights_on_small_and_large_mechanisms(size: float, rng: np.random.Generator) -> None:
    """Metres and radians weighed alike on grippers of millimetres: weights far apart in scaled units."""
    points = {"o1": (0, 0), "o2": (0.3, 1), "o3": (1.1, 1.7), "o4": (1.9, 1), "o5": (2, 0)}
    bars = ["ground", "a", "b", "c", "d", "ground"]
    joints = [
        vc.Revolute(name, one, two, at=size * np.array(place))
        for (name, place), one, two in zip(points.items(), bars, bars[1:], strict=False)
    ]
    mechanism = Mechanism.planar(
        joints=joints,
        reference=vc.Reference("b", origin=size * np.array(points["o3"])),
        active=["o1", "o5"],
        weights=vc.Weights(),
    )
    values = nearby(mechanism, rng, 6)
    program = LaneProgram.prepare(mechanism)
    assert agrees(mechanism, program, values, program.run(values, want=EVERYTHING)) == 6
