"""Gradients against central differences along configurations that were closed again."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.laws.random_closed import displaced

import vincula as vc
from vincula.kernels.gradients import Gradient
from vincula.mechanism.catalog.registry import entry, example
from vincula.mechanism.mechanism import Mechanism

STEP = 1e-5
QUANTITIES = [
    "kinematic.efficiencies",
    "active_force.efficiencies",
    "passive_force.efficiencies",
    "dual_force.efficiencies",
    "kinematic.smallest",
    "kinematic.largest",
    "kinematic.yoshikawa_volume:translation",
    "kinematic.condition:translation",
    "kinematic.inverse_condition_number:translation",
    "kinematic.isotropy:translation",
    "kinematic.smallest_singular_value:rotation",
    "active_force.yoshikawa_volume:translation",
    "passive_force.isotropy:rotation",
    "dual_force.condition:translation",
    "internal_force.efficiencies",
    "singularity.distance",
]
DRIVEN = [
    "five-bar",
    "stewart",
    "stewart-spherical",
    "3rrr",
    "delta",
    "slider-crank",
    "four-bar-2c",
    "serial-2r",
    "serial-7r",
]


def motor_values(mechanism: Mechanism, q: vc.Configuration) -> dict[str, float]:
    return {name: float(q[name][0]) for name in mechanism.active}


def two_links() -> Mechanism:
    """An arm with links sqrt(2) and 1, drawn stretched."""
    elbow = math.sqrt(2)
    joints = [vc.Revolute("a", "ground", "one", at=(0, 0)), vc.Revolute("b", "one", "two", at=(elbow, 0))]
    reference = vc.Reference("two", origin=(elbow + 1, 0))
    return vc.Mechanism.planar(joints=joints, reference=reference, active=vc.ALL)


def finite(values: np.ndarray) -> np.ndarray:
    return np.where(np.isfinite(values), values, 0.0)


def agrees(found: Gradient, differences: np.ndarray, places: np.ndarray) -> None:
    """1e-6 beside the largest derivative of the quantity, and beside its value."""
    size = max(1e-3 * float(np.abs(found.values[np.isfinite(found.values)]).max(initial=0.0)),
               float(np.abs(differences[places]).max(initial=0.0)))  # fmt: skip
    assert np.abs(found.gradient - differences)[places].max(initial=0.0) <= 1e-6 * size


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("name", DRIVEN)
def test_by_motors(name: str, weighted: bool) -> None:
    rng = np.random.default_rng(11)
    mechanism = example(name)
    d, n = mechanism.space.dimension, len(mechanism.active)
    weights = vc.Weights(
        twist=rng.uniform(0.5, 2, d), rate=rng.uniform(0.5, 2, n), wrench=rng.uniform(0.5, 2, d)
    )
    compiled = vc.compile(mechanism, weights=weights if weighted else vc.Weights())
    q = mechanism.close(near=displaced(rng, mechanism, 0.15))
    held = motor_values(mechanism, q)
    ends = [[mechanism.close(near=q, motors={**held, motor: held[motor] + s * STEP}).flat for s in (1, -1)]
            for motor in mechanism.active]  # fmt: skip
    values = compiled.evaluate(np.array(ends), QUANTITIES)
    spinning = mechanism.linearize(q).ledger.summary.passive_redundancy > 0
    for quantity in QUANTITIES:
        found = compiled.gradient(q.flat, quantity)
        if quantity == "singularity.distance":
            # A leg that spins turns its matrices, and no motor says how far it is turned.
            assert found.smooth.any() != spinning
        assert found.names == mechanism.active
        plus, minus = finite(values[quantity][:, 0]), finite(values[quantity][:, 1])
        agrees(found, np.moveaxis((plus - minus) / (2 * STEP), 0, -1), found.smooth)


@pytest.mark.parametrize("name", ["five-bar", "3rrr", "two-arms", "two-finger-grasp"])
def test_by_joints_along_any_motion(name: str) -> None:
    """g . q' is the derivative along every motion, with redundant and internal-force mechanisms too."""
    rng = np.random.default_rng(5)
    mechanism = example(name)
    compiled = vc.compile(mechanism, weights=vc.Weights())
    q = mechanism.close(near=displaced(rng, mechanism, 0.1))
    way = displaced(rng, mechanism, 1.0)
    near = [{n: q[n] + s * STEP * (np.array(way[n]) - mechanism.home[n]) for n in q} for s in (1, -1)]
    ends = [mechanism.close(near=values) for values in near]
    scalar = [column.name for column in mechanism.layout.columns if column.name in q]
    rates = np.array([(ends[0][n][0] - ends[1][n][0]) / (2 * STEP) for n in scalar])
    values = compiled.evaluate(np.array([end.flat for end in ends]), ["kinematic.efficiencies"])
    found = compiled.gradient(q.flat, "kinematic.efficiencies", wrt="joints")
    assert found.names == tuple(scalar)
    plus, minus = finite(values["kinematic.efficiencies"])
    assert found.smooth.any()
    along = (found.gradient @ rates)[found.smooth]
    assert along == pytest.approx(((plus - minus) / (2 * STEP))[found.smooth], rel=1e-6, abs=1e-6)


def test_by_parameters() -> None:
    """Dimensions change, motors stand, the loops close again."""
    of_stewart = entry("stewart")
    defaults = {p.name: p.value for p in of_stewart.parameters}

    def build(alpha: float = defaults["alpha"], beta: float = defaults["beta"]) -> Mechanism:
        return of_stewart.mechanism({"alpha": alpha, "beta": beta})

    compiled = vc.compile(build, weights=vc.Weights(twist=[1, 1, 1, 5, 5, 5]))
    mechanism = build()
    q = mechanism.close(near=displaced(np.random.default_rng(2), mechanism, 0.05))
    for quantity in ("kinematic.efficiencies", "kinematic.yoshikawa_volume", "kinematic.condition:rotation"):
        found = compiled.gradient(q.flat, quantity, wrt=["alpha", "beta"])
        differences = np.full(found.gradient.shape, np.nan)
        for k, name in enumerate(("alpha", "beta")):
            ends = []
            for s in (1, -1):
                varied = build(**{name: defaults[name] + s * STEP})
                there = varied.close(near=q, motors=motor_values(mechanism, q))
                value = vc.compile(varied, weights=compiled.weights).evaluate(there.flat, [quantity])[
                    quantity
                ]
                ends.append(finite(value))
            differences[..., k] = (ends[0] - ends[1]) / (2 * STEP)
        assert found.smooth.any()
        agrees(found, differences, found.smooth)


def test_equal_efficiencies_have_a_smooth_volume_but_no_derivative_of_their_own() -> None:
    """An arm with links sqrt(2) and 1 at 135 degrees is isotropic: both semi-axes are equal there."""
    compiled = vc.compile(two_links())
    isotropic = [0.3, 0.75 * math.pi]
    single = compiled.gradient(isotropic, "kinematic.smallest_singular_value:translation")
    assert not single.smooth
    assert "equal" in single.reason()
    assert np.isnan(single.gradient).all()
    volume = compiled.gradient(isotropic, "kinematic.yoshikawa_volume:translation")
    # |det J| = l1 l2 sin b, whatever the first angle.
    assert volume.smooth
    assert volume.values == pytest.approx(math.sqrt(2) * math.sin(isotropic[1]), rel=1e-12)
    assert volume.gradient == pytest.approx([0.0, math.sqrt(2) * math.cos(isotropic[1])], abs=1e-12)
    isotropy = compiled.gradient(isotropic, "kinematic.isotropy:translation")
    assert isotropy.smooth
    assert isotropy.gradient == pytest.approx([0.0, 0.0], abs=1e-12)


def test_where_there_is_no_derivative_it_says_why() -> None:
    arms = vc.compile(example("two-arms"))
    redundant = arms.gradient(None, "kinematic.efficiencies")
    assert not redundant.smooth.any()
    assert "cannot move while the others stand" in redundant.reason(0)
    stretched = vc.compile(two_links()).gradient([0.4, 0.0], "kinematic.smallest_singular_value:translation")
    assert not stretched.smooth
    assert np.isnan(stretched.gradient).all()
    open_loop = vc.compile(example("five-bar")).gradient([0.1, 0, 0, 0, 0], "kinematic.smallest")
    assert not open_loop.smooth
    assert "open" in open_loop.reason()


def test_batches_keep_their_shape() -> None:
    mechanism = example("serial-2r")
    compiled = vc.compile(mechanism)
    q = np.random.default_rng(0).uniform(0.5, 1.5, (3, 4, 2))
    found = compiled.gradient(q, "kinematic.yoshikawa_volume:translation")
    assert found.values.shape == (3, 4)
    assert found.gradient.shape == (3, 4, 2)
    one = compiled.gradient(q[1, 2], "kinematic.yoshikawa_volume:translation")
    assert np.array_equal(one.gradient, found.gradient[1, 2])


def test_bad_questions() -> None:
    compiled = vc.compile(example("five-bar"))
    with pytest.raises(vc.ModelError, match="has no derivatives"):
        compiled.gradient(None, "counts")
    with pytest.raises(vc.UnknownNameError):
        compiled.gradient(None, "kinematic.smalest")
    with pytest.raises(vc.ModelError, match="choose motors, joints"):
        compiled.gradient(None, "kinematic.smallest", wrt="motor")
    with pytest.raises(vc.ModelError, match="how it is built"):
        compiled.gradient(None, "kinematic.smallest", wrt=["width"])


def test_forces_beside_structural_wrenches_whose_metric_leaves_components_out() -> None:
    weights = vc.Weights(wrench=[1.0, 1.0, 0.0])
    found = vc.compile(example("five-bar"), weights=weights).gradient(
        None, "active_force.condition:translation"
    )
    assert not found.smooth
    assert "weights leave components out" in found.reason()
