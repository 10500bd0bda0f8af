"""Rates of what is drawn, by tracing: against differences of mechanisms built beside one another."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest

import vincula as vc
from vincula import elementary as e
from vincula.kernels import dimensions
from vincula.kernels.traced_rates import SLOPES, traced_rates
from vincula.kernels.variants import Variants
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.placement_rates import Numbers
from vincula.traced import VALUES


def planar(a: float = 1.2, w: float = 0.7, base: float = 2.0) -> Mechanism:
    c, s = e.cos(w), e.sin(w)
    joints = [
        vc.Revolute("o1", "ground", "crank", at=(-base / 2, 0)),
        vc.Revolute("o2", "crank", "coupler", at=(-base / 2 + a * c, a * s)),
        vc.Revolute("o3", "coupler", "link", at=(0.2, e.sqrt(a * a + 1))),
        vc.Prismatic("o4", "link", "rocker", axis=(c, e.larger(a, w)), at=(1, abs(a) * e.hypot(0.3, w))),
        vc.Revolute("o5", "rocker", "ground", at=(base / 2, -(a**3) / w)),
    ]
    reference = vc.Reference("coupler", origin=(a / 3, w))
    return vc.Mechanism.planar(joints=joints, reference=reference, active=["o1", "o5"])


def spatial(p: float = 0.3, length: float = 1.0) -> Mechanism:
    """The second axis of the universal joint turns with p; the lead of the screw stays."""
    c, s = e.cos(p), e.sin(p)
    joints = [
        vc.Universal("u", "ground", "a", at=(0, 0, length), axes=((c, s, 0.1), (-s, c, 0.4 * p))),
        vc.Revolute("r", "a", "b", at=(length * c, 0, length), axis=(s, 1, p)),
        vc.Screw("w", "b", "c", at=(1, 1, length), axis=(p, length, 1), lead=0.2),
    ]
    reference = vc.Reference("c", origin=(2, p, length))
    return vc.Mechanism.spatial(joints=joints, reference=reference, active=vc.ALL)


@pytest.mark.parametrize("build", [planar, spatial])
def test_exact_rates_and_differences(build: Callable[..., Mechanism]) -> None:
    variants = Variants(build(), build)
    names, nominal = tuple(variants.defaults), variants.at({})
    found = traced_rates(nominal, build, names, variants.defaults)
    assert found is not None
    for name, exact in zip(names, found, strict=True):
        differences = Numbers.rates(dimensions._stencil(variants, nominal, variants.defaults, name))
        for part in Numbers.__slots__:
            assert np.allclose(getattr(exact, part), getattr(differences, part), rtol=0.0, atol=1e-11)


def test_gradients_by_traced_dimensions() -> None:
    compiled = vc.compile(spatial, weights=vc.Weights(twist=[1.0] * 6))
    q = compiled.flat({"u": [0.3, 0.5], "r": 0.4, "w": 0.7})
    found = compiled.gradient(q, "kinematic.efficiencies", wrt=["p", "length"])
    step = 1e-4
    for k, (name, value) in enumerate({"p": 0.3, "length": 1.0}.items()):
        near = [value + n * step for n in (1, -1, 2, -2)]
        ends = compiled.evaluate(q, ["kinematic.efficiencies"], parameters={name: near})
        one, two, three, four = ends["kinematic.efficiencies"][:, found.smooth]
        difference = (8.0 * (one - two) - (three - four)) / (12.0 * step)
        assert found.gradient[found.smooth, k] == pytest.approx(difference, rel=1e-7, abs=1e-9)


def test_every_operation() -> None:
    """The slope of every operation against central differences, away from kinks."""
    assert SLOPES.keys() == VALUES.keys()
    for operation, slopes in SLOPES.items():
        count = slopes.__code__.co_argcount - 1
        given = [0.62, 0.35, 0.81][:count]
        value = VALUES[operation](*given)
        for k, slope in enumerate(slopes(value, *given)):
            ends = [[x + (s if n == k else 0.0) for n, x in enumerate(given)] for s in (1e-6, -1e-6)]
            plus, minus = (VALUES[operation](*end) for end in ends)
            assert slope == pytest.approx((plus - minus) / 2e-6, rel=1e-8, abs=1e-9)


def refused(values: Mapping[str, float], build: Callable[..., Mechanism]) -> bool:
    variants = Variants(build(**values), build)
    return traced_rates(variants.nominal, build, tuple(values), values) is None


def test_what_is_not_traced_is_left_to_differences() -> None:
    def rounded(a: float = 1.0) -> Mechanism:
        joints = [vc.Revolute("j", "ground", "arm", at=(float(a), 0))]
        return vc.Mechanism.planar(joints=joints, reference=vc.Reference("arm", origin=(a, 1)), active=vc.ALL)

    def geared(a: float = 1.0) -> Mechanism:
        joints = [
            vc.Revolute("j", "ground", "arm", at=(a, 0)),
            vc.Revolute("k", "arm", "hand", at=(2 * a, 0)),
        ]
        gear = vc.Coupling("gear", {"k": 1.0, "j": -a})
        reference = vc.Reference("hand", origin=(3, 1))
        return vc.Mechanism.planar(joints=joints, couplings=[gear], reference=reference, active=["j"])

    assert refused({"a": 1.0}, rounded)
    assert refused({"a": 1.0}, geared)
    assert refused({"a": 0.7, "w": 0.7}, planar)  # the larger of two equal numbers has no slope
