"""Singular curves over a sweep: interpolated zeros of signed measures, against geometry."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import vincula as vc
from vincula.maps.curve_styles import CURVES
from vincula.sweep.zero_curves import zero_curves

xarray = pytest.importorskip("xarray", reason="extra sweep")
pytest.importorskip("zarr", reason="extra sweep")
BOTH = ["branch.assembly", "branch.working"]
INDEX = "kinematic.inverse_condition_number:translation"


@cache
def turned_3rrr() -> Any:
    """A 3-RRR turned by -0.5 rad, over the middle of its workspace."""
    robot = vc.load("example:3rrr")
    start = robot.follow([vc.Pose.from_angle(-0.5, (0, 0))]).end
    over = {"reference.x": np.linspace(-0.25, 0.25, 6), "reference.y": np.linspace(-0.2, 0.24, 7)}
    return vc.Sweep(robot.with_configuration(start), over, BOTH).to_xarray()


@cache
def driven_five_bar() -> Any:
    """A five-bar over its motors, across the line where its right leg is straight."""
    over = {"o1": np.linspace(-0.3, 0.1, 5), "o5": np.linspace(-0.7, -0.1, 7)}
    quantities = [*BOTH, "kinematic.efficiencies", INDEX]
    return vc.Sweep(vc.load("example:five-bar"), over, quantities).to_xarray()


def _curves(data: Any, name: str, group: int) -> list[np.ndarray]:
    """Curves of one measure in the units of the data set: x is its second dimension."""
    up, across = (data[dim].values for dim in data["status"].dims)
    found = zero_curves(data[name].values[..., group]).curves
    return [
        np.column_stack([np.interp(c[:, k], np.arange(len(v)), v) for k, v in enumerate((across, up))])
        for c in found
    ]


def _concurrent(x: float, y: float) -> float:
    """Zero where the three outer bars of the 3-RRR are lines through one point, turned by -0.5."""
    turn = vc.Pose.from_angle(-0.5, (x, y))
    lines = []
    for k in range(3):
        outwards = 0.5 * np.pi + 2.0 * np.pi * k / 3.0
        base = 2.0 * np.array([np.cos(outwards), np.sin(outwards)])
        tip = turn.apply(0.25 * base)
        elbow = _elbow(base, tip, 1.0, 1.0)
        along = tip - elbow
        lines.append([*along, tip[0] * along[1] - tip[1] * along[0]])
    return float(np.linalg.det(lines))


def _elbow(base: np.ndarray, tip: np.ndarray, inner: float, outer: float) -> np.ndarray:
    """The elbow of a leg, on the right of the way from its base to its tip."""
    way = tip - base
    reach = float(np.hypot(*way))
    share = (reach**2 + inner**2 - outer**2) / (2.0 * reach)
    aside = np.sqrt(inner**2 - share**2)
    return np.asarray(base + (share * way + aside * np.array([-way[1], way[0]])) / reach)


def test_the_curve_of_a_3rrr_is_where_its_outer_bars_meet() -> None:
    data = turned_3rrr()
    assert (data["status"] == 0).all()
    x, y = data["reference.x"].values, data["reference.y"].values
    (curve,) = _curves(data, "branch.assembly", 0)
    assert np.array_equal(curve[0], curve[-1]), "it closes"
    assert len(curve) > 10
    worst = 0.0
    for up, across in curve:  # dimensions of the sweep: x first, so that y is drawn to the right
        if np.isclose(across, x).any():
            fixed, values, moving = across, y, up
            exact = _root(lambda v, fixed=fixed: _concurrent(fixed, v), values, moving)
        else:
            fixed, values, moving = up, x, across
            exact = _root(lambda v, fixed=fixed: _concurrent(v, fixed), values, moving)
        worst = max(worst, abs(exact - moving))
    assert worst < 0.2 * (x[1] - x[0])


def _root(function: Any, values: np.ndarray, near: float) -> float:
    """The root between the two grid points around a place."""
    k = min(max(int(np.searchsorted(values, near)), 1), len(values) - 1)
    return float(brentq(function, values[k - 1], values[k]))


def test_the_curve_of_a_five_bar_is_where_a_leg_is_straight() -> None:
    """Motors lose authority where o3, o4 and o5 are in line: the angle between the bars is then small."""
    data, robot = driven_five_bar(), vc.load("example:five-bar")
    assert _curves(data, "branch.assembly", 0) == []
    assert _curves(data, "branch.working", 0) == []
    (curve,) = _curves(data, "branch.working", 1)
    assert len(curve) >= 5
    start = robot.home
    for o5, o1 in curve:
        start = robot.close(start, motors={"o1": o1, "o5": o5})
        p = {j.name: robot.body_poses(start)[j.first].apply(j.frame_on_first.position) for j in robot.joints}
        one, two = p["o4"] - p["o3"], p["o5"] - p["o4"]
        angle = np.arcsin((one[0] * two[1] - one[1] * two[0]) / (np.hypot(*one) * np.hypot(*two)))
        assert abs(angle) < 0.02, "a step of the grid turns it by a tenth"


def test_a_jump_is_no_zero() -> None:
    """Points of another branch have measures of other sign, as large as those of their neighbours."""
    y, x = np.mgrid[-1.0:1.0:13j, -1.0:1.0:15j]
    circle = 0.36 - x**2 - y**2
    found = zero_curves(circle)
    (curve,) = found.curves
    assert not len(found.jumps)
    places = curve / [7.0, 6.0] - 1.0
    np.testing.assert_allclose(np.hypot(*places.T), 0.6, atol=0.01)
    y, x = np.mgrid[-1.0:1.0:25j, -1.0:1.0:29j]
    other = 0.36 - x**2 - y**2
    other[:, 20:] *= -1.0
    large = np.flatnonzero(np.abs(other[:, 19:21]).min(axis=1) > 0.15)
    jumps = {tuple(side.mean(axis=0)) for side in zero_curves(other).jumps}
    assert jumps >= {(19.5, float(row)) for row in large}
    assert len(large) > 12
    assert {column for column, _ in jumps} == {19.5}
    lone = np.full((5, 5), 0.3) + 0.001 * np.arange(5)
    lone[2, 2] *= -1.0
    assert zero_curves(lone).curves == ()
    assert len(zero_curves(lone).jumps) == 4


def test_unknown_points_interrupt_a_curve() -> None:
    y, x = np.mgrid[0.0:8.0:9j, 0.0:8.0:9j]
    plane = x - 3.5 + 0.01 * y
    plane[4, 3] = np.nan
    curves = zero_curves(plane).curves
    assert sorted(len(curve) for curve in curves) == [4, 4]
    assert all((np.abs(curve[:, 0] - 3.5 + 0.01 * curve[:, 1]) < 1e-12).all() for curve in curves)


def test_curves_are_drawn_by_type() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    drawn = {}
    for data in (turned_3rrr(), driven_five_bar()):
        ax = data.vincula.singularities()
        colours = {line.get_color() for line in ax.lines} - {"white"}
        texts = {text.get_text() for legend in ax.figure.legends for text in legend.get_texts()}
        drawn[frozenset(colours)] = texts
    free, lost = CURVES["platform free"], CURVES["motors without authority"]
    assert drawn[frozenset({free.colour})] == {free.label}
    assert lost.label in drawn[frozenset({lost.colour})]
    ax = driven_five_bar().vincula.map("kinematic.efficiencies", entry=1)
    assert lost.colour in {line.get_color() for line in ax.lines}
    assert ax.figure.axes[-1].get_ylabel() == "efficiencies\nkinematic, entry 1"
    for name in (INDEX, INDEX.replace(":", ".")):
        ax = driven_five_bar().vincula.map(name)
        assert ax.figure.axes[-1].get_ylabel() == "inverse condition number\nkinematic, translation"
    ax = driven_five_bar().vincula.map("branch.working", group="o5")
    assert ax.figure.axes[-1].get_ylabel() == "working\nbranch, o5"
    pyplot.close("all")


def test_what_is_missing_is_named() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    data = driven_five_bar()
    with pytest.raises(vc.ModelError, match=r"branch\.assembly and branch\.working not"):
        data.drop_vars(BOTH).vincula.singularities()
    half = data.drop_vars("branch.working")
    half["counts"] = xarray.concat([xarray.zeros_like(data["status"])] * 2, "count").transpose(..., "count")
    figure = half.vincula.singularities().figure
    assert "branch.working" in figure.legends[0].get_title().get_text()
    pyplot.close("all")


def test_points_of_a_branch() -> None:
    data = driven_five_bar()
    other = data.vincula.on_branch(working="+-")
    expected = (data["status"] == 0) & (data["branch.working"].values[..., 1] < 0.0)
    assert other.values.any()
    assert np.array_equal(other.values, expected.values)
    assert np.array_equal(data.vincula.on_branch("+", "**").values, (data["status"] == 0).values)
    with pytest.raises(vc.ModelError, match="o1, o5"):
        data.vincula.on_branch(working="+")
