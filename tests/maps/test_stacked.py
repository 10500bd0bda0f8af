"""The closure equations over many states are those of one state; so are roots of many functions."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.maps.roots import roots
from vincula.maps.stacked import StackedProblem
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.holding import Holding, problem_for


@pytest.mark.parametrize("name", MODULES)
def test_many_states_have_the_equations_of_one(name: str) -> None:
    """Steps, gaps, Jacobians and configurations, near closure and far from it."""
    mechanism = example(name)
    problem = problem_for(
        mechanism, Holding({}, {}, {}), mechanism.active, member=mechanism.reference is not None
    )
    stacked, rng = StackedProblem(problem), np.random.default_rng(7)
    home = problem.start(mechanism.home)
    sizes = np.array([0.0, 1e-6, 1e-3, 0.05, 0.2, 0.5])
    steps = sizes[:, None] * rng.normal(size=(len(sizes), problem.columns))
    states = stacked.moved(np.tile(home, (len(sizes), 1)), steps)
    gaps, jacobian = stacked.equations(states)
    flat = stacked.configurations(states, mechanism.home)
    assert np.array_equal(stacked.gaps(states), gaps)
    back = stacked.steps_between(np.tile(home, (len(sizes), 1)), states)
    for k, state in enumerate(states):
        one = problem.equations(state)
        assert np.abs(state - problem.variables.moved(home, steps[k])).max() < 1e-14
        assert np.abs(back[k] - problem.variables.step_between(home, state)).max() < 1e-14
        assert np.abs(gaps[k] - one.gaps).max() < 1e-13
        assert np.abs(jacobian[k] - one.jacobian).max() < 1e-13
        assert np.abs(flat[k] - problem.configuration(state, mechanism.home).flat).max() < 1e-13


def test_roots_of_many_functions() -> None:
    """Smooth ones take few values, bad ones are found all the same, one without values is left alone."""
    functions = [
        lambda x: x - 0.3, lambda x: np.cos(x) - x, lambda x: x**3 - 1e-3,
        lambda x: np.expm1(40.0 * (x - 0.9)), lambda x: np.cbrt(x - 0.7), lambda x: np.nan,
    ]  # fmt: skip
    exact = [0.3, 0.7390851332151607, 0.1, 0.9, 0.7]
    best, count = [np.inf] * len(functions), [0] * len(functions)
    at = [np.nan] * len(functions)

    def values(which, x):
        found = np.array([float(functions[k](y)) for k, y in zip(which, x, strict=True)])
        for k, y, value in zip(which, x, found, strict=True):
            count[k] += 1
            if abs(value) < best[k]:
                best[k], at[k] = abs(value), y
        return found

    ends = [np.array([float(f(x)) for f in functions]) for x in (0.0, 1.0)]
    ends[0][-1], ends[1][-1] = -1.0, 1.0
    roots(values, np.zeros(len(functions)), np.ones(len(functions)), *ends)
    assert at[:2] == pytest.approx(exact[:2], abs=1e-15)
    assert at[2:5] == pytest.approx(exact[2:5], abs=1e-12)
    assert count[0] <= 2
    assert count[1] <= 9
    assert count[-1] == 1
