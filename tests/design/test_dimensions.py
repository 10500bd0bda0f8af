"""Dimensional design: the paper's platform, searches that resume, measures against single analyses."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.design.capabilities import Force, Speed, Stiffness
from vincula.design.constraints import Bound, NoSingularity, Relation
from vincula.design.judged import Judged
from vincula.design.lengths import Distance, segment_distance
from vincula.design.linkages import ankle, finger, five_bar
from vincula.design.measures import Index
from vincula.design.problem import DesignProblem
from vincula.design.variables import DesignVariable

DEGREE = math.pi / 180.0


def small(**how: object) -> DesignProblem:
    """A five-bar of two lengths, quick to judge."""
    settings: dict[str, object] = {
        "variables": [DesignVariable("near", 0.2, 0.4, tolerance=1e-3), DesignVariable("far", 0.25, 0.6)],
        "objectives": Index(quantity="kinematic.condition:translation"),
        "weights": vc.Weights(twist=[1.0, 1.0, 0.0]),
        "path": "reference",
        **how,
    }
    return DesignProblem(five_bar, **settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "turns", "inverse"),
    [
        ("stewart-unit", (1.0, -120.0), 1.6924),
        ("stewart-unit", (0.0, -120.0), 1.6895),
        ("stewart-unit", (152.456, -31.429), 1.8064),
        ("stewart", (44.317, -44.317), 1.7179),
        ("stewart", (45.0, -45.0), 1.7150),
    ],
)
def test_the_paper_s_platform(name: str, turns: tuple[float, float], inverse: float) -> None:
    """Known values of both task metrics, and the same by a single analysis."""
    problem = vc.design_problem(name, path="reference")
    design = np.array(turns) * DEGREE
    cost = float(problem.judge(design).objectives[0, 0])
    assert 1.0 / cost == pytest.approx(inverse, abs=5e-5)
    found = vc.kinematic_ellipsoid(problem.mechanism(design).linearize(), problem.weights)
    single = (found.efficiencies[0] - 1.0) ** 2 + (found.efficiencies[-1] - 1.0) ** 2
    assert cost == pytest.approx(single, rel=1e-9)


def test_a_singular_platform_is_infinitely_far_away() -> None:
    problem = vc.design_problem("stewart", path="reference")
    judged = problem.judge(np.array([[0.4, 0.4]]))
    assert not judged.feasible[0]
    assert judged.counted(problem.names_of_constraints) == {"no finite cost": 1}


@pytest.mark.slow
def test_the_local_search_climbs_to_the_best_value_known() -> None:
    """From beside the optimum, which is a ridge without gradient, the simplex reaches it."""
    from vincula.design.asking import Asking
    from vincula.design.polish import polished

    problem = vc.design_problem("stewart", path="reference")
    asking = Asking(problem, "test")
    best, how = polished(asking, np.array([45.0, -45.0]) * DEGREE)
    assert how == "simplex"
    assert 1.0 / problem.judge(best).objectives[0, 0] >= 1.7179 - 1e-4


class StoppedError(Exception):
    pass


def test_interrupted_and_resumed_ends_as_undisturbed(tmp_path: Path) -> None:
    how = {"seed": 4, "population": 6, "generations": 3, "samples": 5, "polish": False}
    calm = small().optimize(**how)

    def stop(step: object) -> None:
        nonlocal told
        told += 1
        if told == 3:
            raise StoppedError

    told = 0
    with small().log(str(tmp_path / "log.db")) as log, pytest.raises(StoppedError):
        small().optimize(log=log, progress=stop, **how)
    with small().log(str(tmp_path / "log.db")) as log:
        resumed = small().optimize(log=log, **how)
        kept = log.everything()
    assert np.array_equal(resumed.design, calm.design)
    assert np.array_equal(resumed.everything.designs, calm.everything.designs)
    assert resumed.to_dict() == calm.to_dict()
    assert kept is not None
    assert len(kept) >= len(calm.everything)


def test_a_log_of_another_problem_is_refused(tmp_path: Path) -> None:
    small().log(str(tmp_path / "log.db")).close()
    with pytest.raises(vc.DesignError, match="of another problem"):
        small(objectives=Index(quantity="kinematic.smallest")).log(str(tmp_path / "log.db"))
    (tmp_path / "no.db").write_text("this is no data base, but long enough to be told from one\n" * 20)
    with pytest.raises(vc.DesignError, match="cannot be used"):
        small().log(str(tmp_path / "no.db"))


def test_nothing_feasible_says_what_killed_how_many() -> None:
    problem = small(
        constraints=[Relation(value=lambda v: v["near"] - v["far"], least=1.0, label="longer near")]
    )
    with pytest.raises(vc.DesignError, match="'longer near' killed"):
        problem.optimize(population=6, generations=1)


def test_a_tie_and_a_bound_at_work() -> None:
    """Both lengths tied to one size; the optimum is on the bound that the constraint leaves."""
    problem = small(
        variables=[DesignVariable("size", 0.3, 0.6)],
        ties={"near": lambda v: 0.8 * v["size"], "far": lambda v: v["size"]},
        objectives=Index(quantity="kinematic.smallest"),
        constraints=[Bound(measure=Index(quantity="kinematic.condition:translation"), most=2.0)],
    )
    judged = problem.judge([[0.3], [0.5]])
    built = problem.mechanism([0.5])
    direct = five_bar(near=0.4, far=0.5)
    assert built.linearize().jacobian_active == pytest.approx(direct.linearize().jacobian_active)
    single = vc.kinematic_ellipsoid(direct.linearize(), problem.weights)
    assert judged.objectives[1, 0] == pytest.approx(single.finite[-1], rel=1e-9)
    worst = single.semi_axes.max() / single.semi_axes.min()
    assert judged.broken[1, -1] == pytest.approx(max(0.0, (worst - 2.0) / 2.0), rel=1e-9)


def test_speed_and_force_are_those_of_the_ellipsoids() -> None:
    force = Force(direction=(1.0, 0.5, 0.0))
    speed = Speed(direction=(0.3, 1.0, 0.0))
    variables = [DesignVariable("crank", 0.01, 0.04)]
    problem = DesignProblem(finger, variables, [force, speed], weights=vc.Weights(), path="reference")
    judged = problem.judge([[0.025]])
    model, unit = finger(crank=0.025).linearize(), vc.Weights()
    load = vc.passive_force_ellipsoid(model, unit).along((1.0, 0.5, 0.0))
    assert judged.objectives[0, 0] == pytest.approx(load)
    assert judged.objectives[0, 1] == pytest.approx(
        vc.kinematic_ellipsoid(model, unit).support((0.3, 1.0, 0.0))
    )


def test_stiffness_is_that_of_springs_in_the_place_of_motors() -> None:
    """Least energy of springs and load under the closed chain, from J_a, J_p and G alone."""
    springs = [2.0, 5.0]
    directions = [(0.0, 0.0, 0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 2.0, 1.0, 0.0)]
    objectives = [Stiffness(direction=d) for d in directions]
    objectives.append(Stiffness(direction=directions[0], against=directions[1]))
    weights = vc.Weights(rate=springs)
    variables = [DesignVariable("lever", 0.03, 0.08)]
    problem = DesignProblem(ankle, variables, objectives, weights=weights, path="reference")
    model = ankle(lever=0.06).linearize()
    n_a, n_p, d = len(model.motors), len(model.passives), len(model.grasp)
    rows = np.hstack([model.jacobian_active, model.jacobian_passive, -model.grasp.T])
    energy = np.zeros((n_a + n_p + d,) * 2)
    energy[:n_a, :n_a] = np.diag(springs)
    system = np.block([[energy, rows.T], [rows, np.zeros((len(rows), len(rows)))]])
    expected = []
    for direction in directions:
        load = np.zeros(len(system))
        unit = np.array(direction) / np.linalg.norm(direction)
        load[n_a + n_p : n_a + n_p + d] = unit
        moved = np.linalg.lstsq(system, load, rcond=1e-12)[0]
        assert system @ moved == pytest.approx(load, abs=1e-9)
        expected.append(1.0 / float(unit @ moved[n_a + n_p : n_a + n_p + d]))
    expected.append(expected[0] / expected[1])
    assert problem.judge([[0.06]]).objectives[0] == pytest.approx(expected, rel=1e-8)


def test_lengths_of_a_linkage() -> None:
    problem = small(constraints=[Distance(first="m1", second="e1", most=0.3), NoSingularity()])
    judged = problem.judge([[0.36, 0.4], [0.3, 0.4]])
    assert judged.broken[:, 4] == pytest.approx([0.06, 0.0])


def test_segments() -> None:
    """Crossing, parallel, apart at their ends; against sampling."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        a, b, c, d = rng.normal(size=(4, 3))
        s = np.linspace(0.0, 1.0, 400)[:, None]
        one, two = a + s * (b - a), c + s * (d - c)
        sampled = np.linalg.norm(one[:, None] - two[None], axis=2).min()
        found = segment_distance(a, b, c, d)
        assert found <= sampled + 1e-12
        assert found == pytest.approx(sampled, abs=2e-2)


def test_the_order_of_merit() -> None:
    """Feasible before infeasible, whatever the cost; among each kind by size."""
    broken = np.array([[0.0], [0.0], [0.2], [3.0]])
    designs = np.arange(4.0)[:, None]
    judged = Judged(designs, np.array([[1e300], [2.0], [0.0], [0.0]]), broken, np.ones(1), np.zeros(4, bool))
    assert np.argsort(judged.merit()).tolist() == [1, 0, 2, 3]


def test_a_landscape_and_its_figure(tmp_path: Path) -> None:
    found = small().scan("near", "far", counts=4)
    design, value = found.best()
    assert value == pytest.approx(np.nanmin(found.values))
    again = small().judge([list(design.values())])
    assert again.objectives[0, 0] == pytest.approx(value)
    assert vc.save_figure(vc.plot_design(found), tmp_path / "landscape.png").stat().st_size > 1000


def test_a_front_is_not_beaten_and_checked() -> None:
    pytest.importorskip("pymoo")
    both = [Index(quantity="kinematic.condition:translation"), Index(quantity="kinematic.smallest")]
    found = small(objectives=both).front(population=8, generations=2, seed=1)
    signed = found.members.signed
    others = found.everything.signed
    for member in signed:
        assert not ((others <= member).all(axis=1) & (others < member).any(axis=1)).any()
    assert found.largest_difference < 1e-9
    assert found.method == "nsga2"
    assert "NSGA-II, seed 1" in str(found)


def test_three_objectives_by_nsga3() -> None:
    """Unbeaten in all three, spread over both ends; the same seed finds the same."""
    pytest.importorskip("pymoo")
    three = [
        Index(quantity="kinematic.condition:translation"),
        Index(quantity="kinematic.smallest"),
        Force(direction=(0.0, 1.0, 0.0)),
    ]
    found = small(objectives=three).front(population=12, generations=4, seed=2)
    assert found.to_dict()["search"]["method"] == "nsga3"
    signed, others = found.members.signed, found.everything.signed
    for member in signed:
        assert not ((others <= member).all(axis=1) & (others < member).any(axis=1)).any()
    # The best of every objective alone beats all others there, so it is on the front.
    assert np.array_equal(signed.min(axis=0), others.min(axis=0))
    again = small(objectives=three).front(population=12, generations=4, seed=2)
    assert np.array_equal(found.members.designs, again.members.designs)


def test_an_objective_without_bound_is_the_best_there_is() -> None:
    """Loads that the structure carries without torque are not searched away from as if they were none."""
    from vincula.design.front import BOUNDLESS, searched

    judged = Judged(
        np.zeros((3, 1)), np.array([[np.inf], [2.0], [np.nan]]), np.zeros((3, 4)), np.array([-1.0]),
        np.zeros(3, dtype=bool),
    )  # fmt: skip
    boundless, two, unknown = searched(judged)[:, 0]
    assert boundless == -BOUNDLESS < two < unknown == BOUNDLESS


@pytest.mark.parametrize(("objectives", "population"), [(3, 12), (3, 92), (4, 20), (5, 40), (8, 9)])
def test_a_design_for_every_direction(objectives: int, population: int) -> None:
    directions = pytest.importorskip("pymoo.util.ref_dirs").get_reference_directions
    from vincula.design.front import partitions

    parts = partitions(objectives, population)
    assert len(directions("das-dennis", objectives, n_partitions=parts)) <= population
    assert math.comb(parts + objectives, parts + 1) > population


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"variables": [DesignVariable("nearr", 0.2, 0.4)]}, "did you mean 'near'"),
        ({"variables": []}, "no variables"),
        ({"objectives": []}, "no objectives"),
        ({"objectives": Index(quantity="kinematic.conditon:all", sense="smaller")}, "kinematic.condition"),
        ({"reach": 2.0}, "reach is 2.0"),
    ],
)
def test_bad_problems(how: dict[str, object], words: str) -> None:
    with pytest.raises(vc.ModelError, match=words):
        small(**how).judge([[0.3, 0.4]])


def test_crossed_bounds() -> None:
    with pytest.raises(vc.ModelError, match="crossed"):
        DesignVariable("near", 0.4, 0.2)


def test_the_figure_shows_the_ellipsoids_before_and_after() -> None:
    """What is drawn is the velocity ellipse of the mechanism itself, linearised by itself."""
    pytest.importorskip("matplotlib")
    found = small().optimize(seed=1, population=5, generations=1, polish=False, samples=0)
    velocity, load, bars = vc.plot_design(found).axes
    for line, design in zip(velocity.lines, (found.start, found.design), strict=True):
        model = five_bar(*(0.2, *design)).linearize()
        drawn = np.array(line.get_data())
        for direction in ((1.0, 0.0), (0.0, 1.0), (0.6, 0.8)):
            reach = vc.kinematic_ellipsoid(model, vc.Weights()).support((*direction, 0.0))
            assert (np.array(direction) @ drawn).max() == pytest.approx(reach, rel=1e-3)
    assert [text.get_text() for text in velocity.get_legend().get_texts()] == ["start", "best"]
    assert load.get_xlabel() == "fx [N]"
    assert len(bars.patches) == 4


def test_rotations_are_drawn_where_nothing_translates() -> None:
    from vincula.view.design_ellipsoids import sight, views_of

    problem = vc.design_problem("ankle", path="reference")
    seen = sight(problem, problem.space.start, "start", "black", "-")
    assert seen is not None
    assert views_of([seen]) == (("wx", "wy"), ("wx", "wz"))
    apart = small(configurations=[[1.2, 1.2]], given="motors")
    assert sight(apart, np.array([0.4, 0.25]), "start", "black", "-") is None


def test_one_compromise_is_told_once() -> None:
    from vincula.design.front import different

    values = np.array([[1.0, 2.0], [1.0 + 1e-12, 2.0], [1.0, 3.0], [1.0, 2.0 - 1e-13]])
    assert different(values).tolist() == [0, 2]
