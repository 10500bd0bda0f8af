"""Traced numbers: the same arithmetic, comparisons as guards, refusal of what cannot be noted."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from vincula import elementary
from vincula.design.functions import of_many
from vincula.spatial.poses import frame_with_z
from vincula.traced import Trace, Traced


def traced(**values: float) -> tuple[Trace, dict[str, Traced]]:
    trace = Trace()
    return trace, trace.inputs(values)


def test_arrays_of_traced_numbers_go_through_numpy() -> None:
    _, x = traced(a=0.3, b=-2.0)
    vector = np.array([x["a"], x["b"], 0.0])
    plain = np.array([0.3, -2.0, 0.0])
    assert np.linalg.norm(vector).value == pytest.approx(np.linalg.norm(plain), rel=1e-15)
    for one, two in zip(np.cross(vector, [0.0, 1.0, 2.0]), np.cross(plain, [0.0, 1.0, 2.0]), strict=True):
        assert (one.value if isinstance(one, Traced) else one) == two


def test_zeros_and_ones_note_nothing() -> None:
    trace, x = traced(a=0.3)
    a: Any = x["a"]
    assert 1.0 * a is a
    assert a + 0.0 is a
    assert a - 0.0 is a
    assert a / 1.0 is a
    assert a * 0.0 == 0.0
    assert a - a == 0.0
    assert len(trace.nodes) == 1


@pytest.mark.parametrize("refused", [float, math.cos, round, int, lambda a: np.array([a, 1.0], dtype=float)])
def test_what_cannot_be_noted_is_refused(refused: Callable[[Any], Any]) -> None:
    _, x = traced(a=0.3)
    with pytest.raises(TypeError):
        refused(x["a"])


def test_frames_follow_the_least_aligned_axis_without_a_guard() -> None:
    for axis in ([0.1, 0.2, 0.9], [0.5, -0.2, 0.3], [1.0, 1.0, 0.1], [0.3, 0.3, 0.3]):
        unit = np.array(axis) / np.linalg.norm(axis)
        trace, x = traced(a=unit[0], b=unit[1], c=unit[2])
        frame = frame_with_z(np.array([x["a"], x["b"], x["c"]]))
        values = np.array([[getattr(entry, "value", entry) for entry in row] for row in frame], dtype=float)
        np.testing.assert_allclose(values, frame_with_z(unit), atol=3e-16)
        assert all(comparison[0] != 26 or outcome is False for comparison, outcome in trace.guards.items())


def bent(row: Any) -> Any:
    a, b = row["a"], row["b"]
    if a > b:
        return elementary.sqrt(a - b) + elementary.cos(a) / b
    return elementary.hypot(a, b) ** 3 - abs(a)


def never_traced(row: Any) -> Any:
    return math.sin(row["a"]) + math.sqrt(row["b"])


@pytest.mark.parametrize("function", [bent, never_traced])
def test_functions_of_many_designs_have_the_bits_of_one_by_one(
    function: Callable[[Any], Any], rng: np.random.Generator
) -> None:
    columns = {"a": rng.normal(size=200), "b": rng.normal(size=200)}
    columns["b"][7] = 0.0
    found = of_many(function, columns)
    for k in range(200):
        try:
            own = function({"a": float(columns["a"][k]), "b": float(columns["b"][k])})
        except (ArithmeticError, ValueError):
            own = math.nan
        assert found[k] == own or (math.isnan(found[k]) and math.isnan(own))
