"""Geometry of many designs at once is that of mechanisms built one by one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("numba")

import vincula as vc
from vincula.design.problems import PROBLEMS, design_problem
from vincula.files.design_builder import NumbersBuilder
from vincula.kernels.lane_path import LanePath, lane_path
from vincula.kernels.layouts import closing_layout, spectra_layout
from vincula.kernels.traced_geometry import KNOWN, REFUSED, UNKNOWN, TracedGeometry
from vincula.kernels.variants import Variants
from vincula.mechanism.catalog import examples
from vincula.mechanism.drawn_joints import Revolute

FILE = """
vincula: 1
space: spatial
parameters: {a: 0.4, r: 0.3, h: 1}
joints:
  - {name: turn, type: revolute, bodies: [ground, arm], at: [0, 0, 0], axis: ["sin($a)", 0, "cos($a)"]}
  - {name: slide, type: prismatic, bodies: [arm, hand], at: ["$r*cos($a)", "$r*sin($a)", "$h"],
     axis: [1, "$r", 0]}
motors: [turn, slide]
reference: {body: hand, origin: ["2*$r", 0, "$h"]}
"""


def geometry(nominal: vc.Mechanism, build: Any, names: tuple[str, ...], kind: str) -> TracedGeometry:
    variants = Variants(nominal, build)
    path = lane_path(nominal, vc.Weights(), general=True)
    assert isinstance(path, LanePath)
    lay_out: Any = spectra_layout(path) if kind == "spectra" else closing_layout(kind)  # type: ignore[arg-type]
    return TracedGeometry(nominal, getattr(build, "outline", build), variants.tried, lay_out, names)


def compare(
    nominal: vc.Mechanism, build: Any, spans: Mapping[str, tuple[float, float]], rng: np.random.Generator
) -> None:
    """Constants of the spectra and of closing at random dimensions, some of them against single builds."""
    names = tuple(spans)
    designs = np.column_stack([rng.uniform(*span, 60) for span in spans.values()])
    for kind in ("spectra", "motors", "reference"):
        traced = geometry(nominal, build, names, kind)
        constants, known = traced.constants(designs, 1)
        assert traced.possible
        assert not (known == UNKNOWN).any()
        for k in range(4):
            variant = Variants(nominal, build).tried(dict(zip(names, map(float, designs[k]), strict=True)))
            if isinstance(variant, str):
                assert known[k] == REFUSED
                continue
            assert known[k] == KNOWN
            own = np.array(traced._lay_out(variant)[1], dtype=float)
            np.testing.assert_allclose(constants[k], own, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("name", [name for name in PROBLEMS if name != "stewart-unit"])
def test_catalog_problems(name: str, rng: np.random.Generator) -> None:
    problem = design_problem(name)
    spans = {v.name: (v.low, v.high) for v in problem.space.variables}
    compare(problem.compiled.mechanism, problem.build, spans, rng)


@pytest.mark.parametrize("name", [e.name for e in examples() if e.parameters and e.name != "stewart"])
def test_examples(name: str, rng: np.random.Generator) -> None:
    build = vc.builder(f"example:{name}")
    spans = {n: (x - 0.1 * abs(x) - 0.01, x + 0.1 * abs(x) + 0.01) for n, x in build.parameters.items()}
    compare(build(), build, spans, rng)


def test_native_file_with_expressions_and_numbers_by_path(tmp_path: Path, rng: np.random.Generator) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text(FILE, encoding="utf-8")
    build = vc.builder(file)
    compare(build(), build, {"a": (0.2, 0.24), "r": (0.1, 0.5), "h": (0.5, 3.0)}, rng)
    numbers = NumbersBuilder(str(file))
    compare(numbers(), numbers, {"joints[turn]/at[0]": (-0.5, 0.5), "r": (0.1, 0.5)}, rng)


def test_numbers_that_may_mean_others_are_not_traced(tmp_path: Path) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text(FILE, encoding="utf-8")
    build = vc.builder(file)
    traced = geometry(build(), build, ("a",), "spectra")
    _, known = traced.constants(np.array([[0.2345678901234567], [1.5708], [3e-5]]), 1)
    assert known.tolist() == [KNOWN, UNKNOWN, UNKNOWN]


def drawn(sine: Callable[[Any], Any]) -> Callable[..., vc.Mechanism]:
    def build(a: float = 0.5, b: float = 0.5) -> vc.Mechanism:
        if b < 0.0:
            raise vc.ModelError("b is negative")
        second = (0.5 + sine(a), 0.2) if a < 1.0 else (b, 0.3)
        return vc.Mechanism.planar(
            joints=[
                Revolute("one", "ground", "link", at=(0.0, 0.0)),
                Revolute("two", "link", "hand", at=second),
            ],
            reference=vc.Reference("hand", origin=(1.0, b)),
            active=["one", "two"],
        )

    return build


def test_comparisons_make_cases_and_refusals_are_known() -> None:
    compiled = vc.compile(drawn(np.sin), weights=vc.Weights())
    a, b = np.array([0.3, 2.0, 0.4, 1.5]), np.array([0.5, 0.7, -1.0, 0.2])
    found = compiled.evaluate(None, ["kinematic.efficiencies"], parameters={"a": a, "b": b})
    again = compiled.evaluate(None, ["kinematic.efficiencies"], parameters={"a": a, "b": b}, path="reference")
    assert found.status.tolist() == again.status.tolist() == [0, 0, 4, 0]
    assert "b is negative" in found.reason(2)
    np.testing.assert_allclose(found["kinematic.efficiencies"], again["kinematic.efficiencies"], rtol=1e-12)


def test_builders_that_cannot_be_traced_are_run_one_by_one() -> None:
    traced, plain = (vc.compile(drawn(sine), weights=vc.Weights()) for sine in (np.sin, math.sin))
    parameters = {"a": np.linspace(0.1, 2.0, 5), "b": np.linspace(0.2, 0.9, 5)}
    one, two = (c.evaluate(None, parameters=parameters)["kinematic.efficiencies"] for c in (traced, plain))
    np.testing.assert_allclose(one, two, rtol=1e-12)


def test_bits_do_not_depend_on_the_batch(rng: np.random.Generator) -> None:
    problem = design_problem("delta")
    names = problem.space.names
    designs = problem.space.low + rng.random((50, len(names))) * (problem.space.high - problem.space.low)
    traced = geometry(problem.compiled.mechanism, problem.build, names, "spectra")
    whole, known = traced.constants(designs, 2)
    for k in (0, 17, 49):
        one, state = traced.constants(designs[k : k + 1], 1)
        assert state[0] == known[k]
        assert np.array_equal(one[0], whole[k], equal_nan=True)


def test_designs_closed_at_many_places_are_those_of_the_reference_path(rng: np.random.Generator) -> None:
    problem = design_problem("finger")
    compiled, space = problem.compiled, problem.space
    designs = space.low + rng.random((6, 3)) * (space.high - space.low)
    parameters = {name: column[:, None] for name, column in space.parameters(designs).items()}
    asked: dict[str, Any] = {"given": "motors", "parameters": parameters}
    places = np.linspace(-0.9, 0.9, 9)[:, None]
    wanted = ["summary", "kinematic.efficiencies", "configuration", "closure.residual"]
    found = compiled.evaluate(places, wanted, **asked)
    again = compiled.evaluate(places, wanted, path="reference", **asked)
    assert np.array_equal(found.status, again.status)
    assert np.array_equal(found["summary"], again["summary"])
    for name in ("kinematic.efficiencies", "configuration"):
        np.testing.assert_allclose(found[name], again[name], rtol=1e-9, atol=1e-9)


def test_singular_designs_together_are_singular_alone() -> None:
    problem = design_problem("stewart-unit")
    turns = np.linspace(-3.0, 3.0, 13)
    designs = np.column_stack([turns, turns])
    parameters = problem.space.parameters(designs)
    wanted = ["summary", "kinematic.efficiencies", "kinematic.classes"]
    found = problem.compiled.evaluate(None, wanted, parameters=parameters, alike=True)
    again = problem.compiled.evaluate(None, wanted, parameters=parameters, path="reference")
    for name in ("status", "summary", "kinematic.classes"):
        assert np.array_equal(found[name], again[name])
    np.testing.assert_allclose(found["kinematic.efficiencies"], again["kinematic.efficiencies"], rtol=1e-9)
