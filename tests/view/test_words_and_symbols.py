"""Numbers in titles, labels beside their anchors, symbols of the plane."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.view import symbols
from vincula.view.labels import place_labels, sampled
from vincula.view.layout import window
from vincula.view.style import _component, _number


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (9.7365, "9.74"),
        (0.22, "0.220"),
        (0.0, "0"),
        (float("inf"), "∞"),
        (2340.4, "2340"),
        (223.4, "223"),
        (0.00448, "0.00448"),
        (0.00000448, "4.48·10⁻⁶"),
        (1.5e9, "1.50·10⁹"),
        (float("nan"), "undefined"),
    ],
)
def test_efficiencies_are_written_with_three_digits(value: float, text: str) -> None:
    assert _number(value) == text


@pytest.mark.parametrize(("value", "text"), [(-0.4472, "−0.45"), (1e-16, "0"), (-1e-16, "0"), (1.0, "1.00")])
def test_directions_are_written_with_two_decimals(value: float, text: str) -> None:
    assert _component(value) == text


def test_labels_keep_off_symbols_and_each_other() -> None:
    anchors = [np.array([0.0, 0.0]), np.array([14.0, 0.0]), np.array([28.0, 0.0])]
    line = sampled(np.array([[0.0, 0.0], [28.0, 0.0]]), 2.0)
    centres = place_labels(anchors, ["o1", "o2", "o3"], np.array(anchors), line)
    for anchor, centre in zip(anchors, centres, strict=True):
        assert 4.0 < np.linalg.norm(centre - anchor) < 25.0
        assert min(anchors, key=lambda a: np.linalg.norm(a - centre)) is anchor
        assert abs(centre[1]) > 3.75
    for k, one in enumerate(centres):
        assert all(np.any(np.abs(one - other) > [8.4, 7.4]) for other in centres[k + 1 :])


def test_a_free_label_stands_to_the_upper_right() -> None:
    none = np.zeros((0, 2))
    (centre,) = place_labels([np.zeros(2)], ["o1"], none, none)
    np.testing.assert_allclose(centre, (4.0 + (4.2 + 3.75) / np.sqrt(2)) / np.sqrt(2))


@pytest.mark.parametrize("towards", [(0, -1), (-1, 0), (0, 1), (0.6, 0.8)])
@pytest.mark.parametrize("symbol", [symbols.support, symbols.guide, symbols.surface])
def test_the_ground_lies_where_it_is_said_to(symbol: object, towards: tuple[float, float]) -> None:
    direction = np.array(towards, dtype=float)
    strokes = symbol(direction)
    hatches = [stroke.points for stroke in strokes if stroke.thin]
    (line,) = [stroke.points for stroke in strokes if not stroke.thin and not stroke.filled]
    level = line[0] @ direction
    assert line[1] @ direction == pytest.approx(level)
    assert level >= 0
    for hatch in hatches:
        assert hatch[0] @ direction == pytest.approx(level)
        assert hatch[1] @ direction > level


def test_a_slider_box_lies_along_its_axis() -> None:
    axis = np.array([0.6, 0.8])
    (box,) = symbols.box(axis, length=10.0, width=4.0)
    assert np.ptp(box.points @ axis) == pytest.approx(10.0)
    assert np.ptp(box.points @ np.array([-0.8, 0.6])) == pytest.approx(4.0)


def test_a_contact_points_at_the_object() -> None:
    normal = np.array([0.0, 1.0])
    wedge, tangent = symbols.contact(normal)
    assert (wedge.points @ normal).max() == 0.0
    np.testing.assert_allclose(tangent.points @ normal, 0.0)


@pytest.mark.parametrize(
    "extent", [(2.0, 2.0), (10.0, 0.5), (0.5, 10.0), (0.0, 3.0), (0.0, 0.0), (1e-3, 2e-3)]
)
def test_a_window_shows_every_point_with_a_margin(extent: tuple[float, float]) -> None:
    points = np.array([[1.0, 2.0], [1.0 + extent[0], 2.0 + extent[1]]])
    seen = window(points, 1.5)
    assert np.all(seen.low < points[0])
    assert np.all(seen.high > points[1])
    width, height = (seen.high - seen.low) * seen.points_per_metre / 72.0
    assert width == pytest.approx(1.5)
    assert height == pytest.approx(seen.height)
    assert 0.5 * 1.5 - 1e-9 <= height <= 1.35 * 1.5 + 1e-9
