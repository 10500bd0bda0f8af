"""Maps against geometry: what an engineer knows of the five-bar and the 3-RRR."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import vincula as vc
from vincula.maps.curves import distances
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.kinematics import part_frames

INDEX = "kinematic.inverse_condition_number:translation"
EXACT = 1e-8


def points(mechanism: vc.Mechanism, q: vc.Configuration) -> dict[str, np.ndarray]:
    poses = mechanism.body_poses(q)
    return {joint.name: part_frames(joint, poses)[0].position for joint in mechanism.joints}


def crossed(one: np.ndarray, two: np.ndarray) -> float:
    """Sine of the angle between two directions in the plane."""
    return float((one[0] * two[1] - one[1] * two[0]) / (np.linalg.norm(one) * np.linalg.norm(two)))


@cache
def led_five_bar() -> vc.SingularityMap:
    over = [vc.Variable("x", -1.6, 1.8, 14), vc.Variable("y", -4.2, 0.5, 16)]
    return vc.map_over(example("five-bar"), over, quantities=[INDEX])


@cache
def driven_five_bar() -> vc.SingularityMap:
    over = [vc.Variable("o1", -1.7, 0.8, 12), vc.Variable("o5", -2.0, 2.0, 12)]
    return vc.map_over(example("five-bar"), over)


@cache
def turned_3rrr() -> vc.SingularityMap:
    robot = example("3rrr")
    turned = robot.follow([vc.Pose.from_angle(-0.5, (0, 0))]).end
    over = [vc.Variable("x", -0.6, 0.7, 10), vc.Variable("y", -0.5, 0.7, 10)]
    return vc.map_over(robot, over, start=turned)


@pytest.mark.parametrize("made", [led_five_bar, driven_five_bar])
def test_five_bar_singularities_are_where_links_are_in_line(made) -> None:
    """Motors o1, o5: the coupler is free where o2, o3, o4 are in line; authority is lost where a leg is."""
    found = made()
    mechanism = found.mechanism
    kinds = {curve.kind for curve in found.curves}
    assert kinds == {"platform free", "motors without authority"}
    for curve in found.curves:
        for crossing in curve.crossings:
            p = points(mechanism, crossing.configuration)
            p["P"] = mechanism.body_poses(crossing.configuration)["coupler"].apply(mechanism.reference.origin)
            free = crossed(p["o3"] - p["o2"], p["o4"] - p["o3"])
            right = crossed(p["o4"] - p["o3"], p["o5"] - p["o4"])
            left = crossed(p["o2"] - p["o1"], p["P"] - p["o2"])
            if crossing.kind == "platform free":
                assert abs(free) < EXACT
            else:
                assert min(abs(right), abs(left)) < EXACT


def test_the_edge_of_the_region_tells_what_stops_it() -> None:
    """Led by its point the five-bar stops where motors lose authority, driven where the coupler is free."""
    assert {c.kind for c in led_five_bar().curves if c.edge} == {"motors without authority"}
    assert {c.kind for c in driven_five_bar().curves if c.edge} == {"platform free"}
    assert {c.kind for c in led_five_bar().curves if not c.edge} == {"platform free"}
    assert {c.kind for c in driven_five_bar().curves if not c.edge} == {"motors without authority"}


def test_3rrr_singularities() -> None:
    """Type 2: the lines of the outer links meet in a point. Type 1: a leg is stretched or folded."""
    found = turned_3rrr()
    assert {c.kind for c in found.curves if not c.edge} == {"platform free"}
    assert {c.kind for c in found.curves if c.edge} == {"motors without authority"}
    for curve in found.curves:
        for crossing in curve.crossings:
            p = points(found.mechanism, crossing.configuration)
            if crossing.kind == "platform free":
                rows = []
                for leg in "123":
                    along = p[f"c{leg}"] - p[f"b{leg}"]
                    along = along / np.linalg.norm(along)
                    at = p[f"c{leg}"]
                    rows.append([*along, at[0] * along[1] - at[1] * along[0]])
                assert abs(np.linalg.det(rows)) < EXACT
            else:
                folded = [crossed(p[f"b{k}"] - p[f"a{k}"], p[f"c{k}"] - p[f"b{k}"]) for k in "123"]
                assert min(map(abs, folded)) < EXACT


def test_every_point_reached_is_closed_and_where_it_should_be() -> None:
    found = led_five_bar()
    mechanism, sheet = found.mechanism, found.sheets[0]
    compiled = vc.compile(mechanism)
    asked = ["closure.residual", "reference.pose", INDEX]
    closed = compiled.evaluate(sheet.configurations[sheet.reached], asked, path="reference")
    assert closed["closure.residual"].max() < 1e-11
    first, second = np.meshgrid(*found.grid, indexing="ij")
    places = np.stack([first, second], axis=-1)[sheet.reached]
    assert np.abs(closed["reference.pose"][:, :2] - places).max() < 1e-12
    # Kernels, where numba is installed, differ from the reference path in the last digits.
    assert np.allclose(closed[INDEX], sheet.quantities[INDEX][sheet.reached], rtol=1e-10, atol=1e-12)
    assert np.isnan(sheet.quantities[INDEX][~sheet.reached]).all()


def test_the_region_is_that_of_the_geometry() -> None:
    """On one branch the coupler's point is reached exactly where both legs can be put together."""
    found = led_five_bar()
    mechanism, sheet = found.mechanism, found.sheets[0]
    first, second = np.meshgrid(*found.grid, indexing="ij")
    reach = np.hypot(first + 1, second + 2)
    assert not sheet.reached[(reach > 2.5 + 1e-9) | (reach < 1.5 - 1e-9)].any()
    whole = np.array([curve.points for curve in found.curves if curve.edge], dtype=object)
    assert len(whole) >= 1
    left_edge = [c for curve in found.curves if curve.edge for c in curve.crossings]
    at_limits = [abs(math.hypot(c.values[0] + 1, c.values[1] + 2) - r) for c in left_edge for r in (1.5, 2.5)]
    assert min(at_limits) < 1e-9
    assert mechanism.active == ("o1", "o5")


def test_distance_to_the_nearest_singular_curve() -> None:
    found = driven_five_bar()
    sheet = found.sheets[0]
    assert found.distance_unit == "rad"
    assert np.nanmin(sheet.distance) >= 0.0
    line = next(curve for curve in found.curves if len(curve.points) > 2)
    on_line = distances(line.points, [line], np.ones(2))
    assert on_line.max() < 1e-12
    place = line.points[:1] + np.array([0.0, 50.0])
    beside = distances(place, [line], np.ones(2))
    lowest = np.abs(place - line.points)
    assert beside[0] <= np.hypot(*lowest.T).min() + 1e-12


def test_all_branches_are_found() -> None:
    """From o1 the coupler's point is reached with o2 on either side, but then o3 is too far from o5.

    So only the leg o3, o4, o5 can be put on in two ways.
    """
    over = [vc.Variable("x", -0.6, -0.4, 3), vc.Variable("y", -0.1, 0.05, 3)]
    found = vc.map_over(example("five-bar"), over, modes="all")
    assert len(found.sheets) == 2


def test_joint_limits_bound_the_region() -> None:
    joints = [vc.Revolute("a", "ground", "one", at=(0, 0), limits=vc.Limits(-0.5, 0.5)),
              vc.Revolute("b", "one", "two", at=(1, 0), limits=vc.Limits(-1.0, 2.0))]  # fmt: skip
    arm = vc.Mechanism.planar(joints=joints, reference=vc.Reference("two", origin=(2, 0)), active=vc.ALL)
    found = vc.map_over(arm, [vc.Variable("a", -1, 1, 9), vc.Variable("b", 0.2, 3, 9)])
    edges = [c for curve in found.curves if curve.edge for c in curve.crossings]
    assert {c.kind for c in edges} == {"limit"}
    for crossing in edges:
        a, b = crossing.values
        assert min(abs(abs(a) - 0.5), abs(b - 2.0)) < 1e-9
    free = vc.map_over(arm, [vc.Variable("a", -1, 1, 9), vc.Variable("b", 0.2, 3, 9)], limits=False)
    assert free.sheets[0].reached.all()


def test_a_spatial_mechanism_led_by_two_coordinates() -> None:
    over = [vc.Variable("x", -0.3, 0.3, 5), vc.Variable("y", -0.3, 0.3, 5)]
    found = vc.map_over(example("delta"), over)
    assert found.sheets[0].reached.any()
    assert found.units == ("m", "m")


def test_bad_questions() -> None:
    mechanism = example("five-bar")
    x, y = vc.Variable("x", -1, 1, 5), vc.Variable("y", -1, 1, 5)
    with pytest.raises(vc.UnknownNameError, match="variable of a map"):
        vc.map_over(mechanism, [vc.Variable("o9", 0, 1), x])
    with pytest.raises(vc.ModelError, match="choose two of a kind"):
        vc.map_over(mechanism, [vc.Variable("o1", 0, 1), x])
    with pytest.raises(vc.ModelError, match="choose two"):
        vc.map_over(mechanism, [x, x])
    with pytest.raises(vc.ModelError, match="is no range"):
        vc.Variable("x", 1, 1)
    with pytest.raises(vc.ModelError, match="2 to 2000"):
        vc.Variable("x", 0, 1, 10**12)
    with pytest.raises(vc.ModelError, match="one number a point"):
        vc.map_over(mechanism, [x, y], quantities=["kinematic.efficiencies"])
    with pytest.raises(vc.ModelError, match="does not reach the grid"):
        vc.map_over(mechanism, [vc.Variable("x", 40, 41, 3), y])
    places = enumerate([("a", "ground", "p"), ("b", "p", "q"), ("c", "q", "r")])
    joints = [vc.Revolute(name, one, two, at=(k, 0)) for k, (name, one, two) in places]
    three_links = vc.Mechanism.planar(
        joints=joints, reference=vc.Reference("r", origin=(3, 0)), active=["a", "b"]
    )
    with pytest.raises(vc.ModelError, match="can still move"):
        vc.map_over(three_links, [vc.Variable("a", -1, 1, 5), vc.Variable("b", -1, 1, 5)])


def test_the_same_numbers_in_json_and_the_figure_is_drawn(tmp_path) -> None:
    import json

    found = led_five_bar()
    told = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert told["schema"] == "vincula/map/1"
    assert [v["name"] for v in told["variables"]] == ["x", "y"]
    assert sum(map(sum, told["sheets"][0]["reached"])) == int(found.sheets[0].reached.sum())
    assert {c["kind"] for c in told["sheets"][0]["curves"]} == {"platform free", "motors without authority"}
    pytest.importorskip("matplotlib")
    figure = vc.plot_map(found)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["member free with motors locked", "motors lose authority"]
    for name in ("map.svg", "map.png"):
        from vincula.view.plot import save_figure

        save_figure(figure, tmp_path / name)
        assert (tmp_path / name).stat().st_size > 5000
