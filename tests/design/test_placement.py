"""Placement of motors: every choice against the mechanism linearised anew, the paper, ranking, words."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import vincula as vc
from vincula.analysis.ranking import ranked_designs
from vincula.design.admissible import Admissible
from vincula.design.placement import EVERY
from vincula.design.resplit import with_motors

FIVE = ("o1", "o2", "o3", "o4", "o5")


@pytest.fixture(scope="module")
def five_bar() -> vc.Mechanism:
    return vc.load("example:five-bar")


def all_subsets() -> list[tuple[str, ...]]:
    return [choice for size in range(1, 6) for choice in combinations(FIVE, size)]


def test_the_three_designs_of_the_paper(five_bar, paper) -> None:
    found = vc.place(five_bar, range(1, 6))
    for motors, key in (("o1,o5", "motors_1_5"), ("o2,o4", "motors_2_4"), (FIVE, "motors_all")):
        choice, expected = found.choice(motors), paper["five_bar"][key]
        assert choice.controls
        assert choice.index == pytest.approx(expected["kinematic"][-1], abs=6e-5)
        assert choice.indices["active-force"].worst == pytest.approx(expected["active_force"][1], abs=6e-5)
        assert choice.indices["passive-force"].worst == pytest.approx(expected["passive_force"][-1], abs=6e-5)
        assert choice.largest("internal_torques") == len(expected["internal_force"])
    assert found.choice("o1,o5").cost == 2.0


def test_every_choice_is_the_mechanism_linearised_anew(five_bar) -> None:
    """Counts, all five ellipsoids and verdicts, for all 31 choices."""
    found = vc.place(five_bar, range(1, 6))
    assert {frozenset(choice.motors) for choice in found.choices} == {frozenset(m) for m in all_subsets()}
    for choice in found.choices:
        peer = vc.analyze(five_bar.with_active(choice.motors).linearize())
        mine = choice.analyze()
        assert choice.counts[0] == peer.ledger.summary
        assert mine.ledger.counts == peer.ledger.counts
        assert mine.verdicts == peer.verdicts
        for one, other in zip(mine.ellipsoids, peer.ellipsoids, strict=True):
            assert one.classes == other.classes
            np.testing.assert_allclose(one.efficiencies, other.efficiencies, rtol=1e-10)


def test_the_ranking_is_that_of_compare(five_bar) -> None:
    for criterion in ("kinematic", "internal-force", "isotropy"):
        found = vc.place(five_bar, range(1, 6), rank_by=criterion)
        peers = [vc.analyze(five_bar.with_active(motors).linearize()) for motors in all_subsets()]
        ranked = ranked_designs(peers, criterion)
        assert len(found.choices) == len(ranked)
        for choice, design in zip(found.choices, ranked, strict=True):
            assert choice.controls == (design.analysis.ledger.summary.indeterminacy == 0)
            assert (choice.index is None) == (design.index is None)
            assert (choice.index or 0.0) == pytest.approx(design.index or 0.0, rel=1e-9)
            assert choice.reason == design.reason


def test_single_motors_fail_with_the_motion_that_is_left(five_bar) -> None:
    """With o1 locked the coupler turns about o2, with o3 locked it translates: elementary geometry."""
    found = vc.place(five_bar, range(1, 3))
    failing = [choice.motors for choice in found.choices if not choice.controls]
    assert sorted(failing) == [(name,) for name in FIVE]
    (words,) = found.choice("o1").why
    assert "turn about the point (-1, 0)" in words
    assert words.endswith("joints o2, o3, o4, o5.")
    assert found.choice("o1,o5").why == ()
    assert found.best is not None
    assert found.best.motors == ("o1", "o2")
    assert found.explanation[0].startswith("o1, o2: first by")


def test_every_joint_of_a_parallelogram_controls_it() -> None:
    """One degree of freedom in which every joint turns: one motor is enough, a second squeezes."""
    flat = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "left", at=(0, 0)),
            vc.Revolute("b", "left", "coupler", at=(0, 1)),
            vc.Revolute("c", "coupler", "right", at=(2, 1)),
            vc.Revolute("d", "right", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("coupler"),
        weights=vc.Weights(),
    )
    found = vc.place(flat, (1, 2))
    assert all(choice.controls for choice in found.choices)
    assert {choice.largest("internal_torques") for choice in found.choices if len(choice.motors) == 2} == {1}


def test_an_open_arm_needs_a_motor_on_every_joint() -> None:
    """Three joints, three motions of the hand: no two of them hold it."""
    arm = vc.Mechanism.planar(
        joints=[
            vc.Revolute("shoulder", "ground", "upper", at=(0, 0)),
            vc.Revolute("elbow", "upper", "fore", at=(1, 0)),
            vc.Revolute("wrist", "fore", "hand", at=(1, 1)),
        ],
        reference=vc.Reference("hand", origin=(2, 1)),
        weights=vc.Weights(),
    )
    found = vc.place(arm, (1, 2, 3))
    assert [choice.motors for choice in found.controlling] == [("shoulder", "elbow", "wrist")]
    assert "no other choice controls the member" in found.explanation[0]
    none = vc.place(arm, 2)
    assert none.best is None
    assert none.explanation[0].startswith("No admissible choice controls the member.")
    assert len(none.choices[0].why) == 1


def test_forbidden_required_and_cost(five_bar) -> None:
    found = vc.place(five_bar, (2, 3), forbid="o3", require=["o5"], cost={"o1": 2.5, "o5": 0})
    assert {choice.motors for choice in found.choices} == {
        ("o1", "o5"), ("o2", "o5"), ("o4", "o5"), ("o1", "o2", "o5"), ("o1", "o4", "o5"), ("o2", "o4", "o5")
    }  # fmt: skip
    assert found.choice("o1,o2,o5").cost == 3.5
    assert found.choice("o4,o5").cost == 1.0


def test_the_front_is_what_nothing_beats(five_bar) -> None:
    criteria = ("kinematic", "active-force", "motors", "cost")
    found = vc.place(five_bar, range(1, 6), cost={"o1": 3, "o2": 2}, front=criteria)

    def merits(choice: vc.MotorChoice) -> np.ndarray:
        values = [choice.indices[name].worst for name in criteria[:2]]
        return np.array([*values, -len(choice.motors), -choice.cost])

    for choice in found.controlling:
        beaten = any(
            (merits(other) >= merits(choice)).all() and (merits(other) > merits(choice)).any()
            for other in found.controlling
        )
        assert (choice in found.front) == (not beaten)


def test_worst_and_mean_over_configurations(five_bar) -> None:
    places = [five_bar.close(motors={"o1": x, "o5": y}) for x in (-0.1, 0.0) for y in (-0.1, 0.0)]
    found = vc.place(five_bar, 2, at=places)
    for choice in found.choices:
        peers = [
            min(vc.analyze(five_bar.with_active(choice.motors).linearize(q)).kinematic.finite) for q in places
        ]
        assert choice.index == pytest.approx(min(peers), rel=1e-9)
        assert choice.mean == pytest.approx(np.mean(peers), rel=1e-9)
        assert choice.indices["kinematic"].at == int(np.argmin(peers))
    values = [choice.index for choice in found.choices]
    assert values == sorted(values, reverse=True)


def test_a_choice_that_fails_at_one_configuration_fails() -> None:
    """A slider-crank at its dead centre: the slider motor loses the crank there, and only there."""
    crank = vc.Mechanism.planar(
        joints=[
            vc.Revolute("crank", "ground", "arm", at=(0, 0)),
            vc.Revolute("pin", "arm", "rod", at=(0, 1)),
            vc.Revolute("gudgeon", "rod", "slider", at=(2, 0)),
            vc.Prismatic("slide", "slider", "ground", axis=(1, 0), at=(2, 0)),
        ],
        reference=vc.Reference("arm"),
        weights=vc.Weights(),
    )
    dead = crank.with_active("crank").close(motors={"crank": -np.pi / 2})
    found = vc.place(crank, 1, at=[crank.home, dead])
    slide = found.choice("slide")
    assert slide.fails_at == (1,)
    assert slide.counts[0].indeterminacy == 0
    assert "at 1 of 2 configurations (number 2)" in slide.reason
    assert "moves with all motors locked" in slide.why[0]
    assert found.choice("crank").controls
    assert found.choices[-1] is slide


def test_the_points_of_a_sweep(five_bar) -> None:
    sweep = vc.Sweep(five_bar, vc.Grid({"o1": [-0.1, 0.0], "o5": [-0.1, 0.0]}))
    found = vc.place(five_bar, 2, over=sweep)
    places = [five_bar.close(motors={"o1": x, "o5": y}) for x in (-0.1, 0.0) for y in (-0.1, 0.0)]
    peer = vc.place(five_bar, 2, at=places)
    assert [choice.motors for choice in found.choices] == [choice.motors for choice in peer.choices]
    for one, other in zip(found.choices, peer.choices, strict=True):
        assert one.index == pytest.approx(other.index, rel=1e-6)
        assert one.mean == pytest.approx(other.mean, rel=1e-6)


def test_sweeps_that_do_not_fit_and_points_that_do_not_close(five_bar) -> None:
    other = vc.load("example:four-bar-2a")
    with pytest.raises(vc.SweepError, match="other joints"):
        vc.place(five_bar, 2, over=vc.Sweep(other, vc.Grid({other.active[0]: [0.0]})))
    far = vc.Sweep(
        five_bar, vc.Grid({"reference.x": [-0.5, 40.0], "reference.y": [0.0], "reference.angle": [0.0]})
    )
    found = vc.place(five_bar, 2, over=far)
    assert len(found.looked.models) == 1
    assert [point for point, _ in found.looked.left_out] == [1]
    assert found.looked.left_out[0][1]


def test_motors_that_drive_several_axes_are_extra() -> None:
    """A drive is a candidate; where it is not chosen, nothing of it is left in the model."""
    gripper = vc.load("example:five-bar")
    driven = vc.Mechanism(
        **{
            **{name: getattr(gripper, name) for name in gripper.__dataclass_fields__},
            "drives": (vc.Drive("belt", {"o1": 1.0, "o5": -1.0}),),
        }
    )
    found = vc.place(driven, (1, 2))
    assert found.admissible.candidates == (*FIVE, "belt")
    for choice in found.choices:
        peer = driven.with_active(choice.motors).linearize()
        assert choice.model().jacobian_passive.shape == peer.jacobian_passive.shape
        assert choice.counts[0] == peer.ledger.summary
        mine = vc.kinematic_ellipsoid(choice.model()).efficiencies
        np.testing.assert_allclose(mine, vc.kinematic_ellipsoid(peer).efficiencies, rtol=1e-10)
    assert not any(row.kind == "drive" for row in found.choice("o1,o5").model().rows)


def test_weights_by_name_fit_every_choice(five_bar) -> None:
    weights = vc.Weights(rate={"o1": 4.0, "o5": 9.0}, twist=[1, 1, 2])
    found = vc.place(five_bar, 2, weights=weights)
    for motors in (("o1", "o2"), ("o2", "o4"), ("o1", "o5")):
        own = {name: value for name, value in weights.rate.items() if name in motors}
        model = five_bar.with_active(motors).linearize()
        peer = vc.kinematic_ellipsoid(model, vc.Weights(rate=own, twist=[1, 1, 2]))
        assert found.choice(motors).index == pytest.approx(peer.efficiencies[-1], rel=1e-10)
    with pytest.raises(vc.UnknownNameError):
        vc.place(five_bar, 2, weights=vc.Weights(rate={"o9": 1.0}))


def test_bare_matrices() -> None:
    """u = J_1 q_1 + ... for a member held by three rows: a motor a direction, none to spare."""
    model = vc.LinearModel.from_matrices(-np.eye(3, 4, dtype=float) - np.eye(3, 4, k=1), np.eye(3), active=[])
    found = vc.place(model, (3, 4), weights=vc.Weights())
    assert [c.controls for c in found.choices] == [len(c.motors) == 4 for c in found.choices]
    assert found.choice("q1,q2,q3,q4").largest("redundancy") == 1


def test_stewart_legs(rng) -> None:
    """Six prismatic legs control the platform; any five of them leave one motion."""
    stewart = vc.load("example:stewart", parameters={"alpha": "10deg", "beta": "-120deg"})
    balls = [name for name in stewart.axis_names if not name.startswith(("p", "platform"))]
    found = vc.place(stewart.with_weights(vc.Weights()), (5, 6), forbid=balls)
    assert len(found.choices) == 7
    assert found.choices[0].motors == ("p1", "p2", "p3", "p4", "p5", "p6")
    assert all(choice.largest("indeterminacy") == 1 for choice in found.choices[1:])
    assert "motor on" not in " ".join(found.explanation)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"motors": 0}, "1 or more"),
        ({"motors": True}, "1 or more"),
        ({"motors": 1.5}, "1 or more"),
        ({"motors": ()}, "empty"),
        ({"motors": 6}, "6 motors, and only 5 joint axes"),
        ({"motors": 5, "forbid": "o2"}, "only 4 joint axes that can carry one after o2 is forbidden"),
        ({"motors": 2, "forbid": "o9"}, "'o9'"),
        ({"motors": 2, "require": "o9"}, "'o9'"),
        ({"motors": 2, "cost": {"o9": 1}}, "'o9'"),
        ({"motors": 2, "cost": {"o1": float("nan")}}, "finite number"),
        ({"motors": 2, "cost": {"o1": -1}}, "0 or more"),
        ({"motors": 2, "forbid": "o1,o2", "require": "o2"}, "o2: forbidden and required at once"),
        ({"motors": 1, "require": "o1,o2"}, "2 are required"),
        ({"motors": 2, "rank_by": "speed"}, "'speed'"),
        ({"motors": 2, "front": ["beauty"]}, "'beauty'"),
        ({"motors": 2, "front": []}, "give a list"),
        ({"motors": 2, "at": []}, "at is empty"),
        ({"motors": 2, "budget": 0}, "budget"),
        ({"motors": 2, "at": {"o1": 0.0}, "over": 1}, "both given"),
    ],
)
def test_refusals(five_bar, asked: dict, message: str) -> None:
    with pytest.raises(vc.ModelError, match=message):
        vc.place(five_bar, **asked)


def test_required_and_locked(five_bar) -> None:
    with pytest.raises(vc.ModelError, match="locked"):
        vc.place(five_bar.with_lock("o2"), 2, require="o2")
    assert "o2" not in vc.place(five_bar.with_lock("o2"), 1).admissible.candidates


def test_a_model_with_other_motors_refuses_names(five_bar) -> None:
    model = five_bar.linearize()
    with pytest.raises(vc.UnknownNameError):
        with_motors(model, ["o1", "o7"])
    with pytest.raises(vc.DuplicateNameError):
        with_motors(model, ["o1", "o1"])


def test_the_number_of_choices(five_bar) -> None:
    assert Admissible.of_mechanism(five_bar, range(1, 6)).count == 31
    assert EVERY == 65536


def chain(count: int) -> vc.LinearModel:
    """A planar member that is driven by `count` joints in series, all different."""
    rng = np.random.default_rng(5)
    return vc.LinearModel.from_matrices(
        rng.normal(size=(3, count)), np.eye(3), active=[], linear_rows=[True] * 3
    )


def test_beyond_all_choices_a_seeded_search_says_so() -> None:
    """More than 65536 choices: a search looks at some, the same ones for the same seed."""
    asked = {"weights": vc.Weights(), "budget": 20, "seed": 3}
    model = chain(26)
    one, two = vc.place(model, range(20, 25), **asked), vc.place(model, range(20, 25), **asked)
    assert not one.exhaustive
    assert len(one.choices) <= 20
    assert one.admissible.count > EVERY
    assert "search with seed 3" in str(one)
    assert [c.motors for c in one.choices] == [c.motors for c in two.choices]
    other = vc.place(model, range(20, 25), **{**asked, "seed": 4})
    assert [c.motors for c in other.choices] != [c.motors for c in one.choices]


def test_a_search_climbs(monkeypatch) -> None:
    """On a problem small enough to look at everything, a search of a quarter of it finds the best."""
    from vincula.design import placement

    model = chain(9)
    everything = vc.place(model, 7, weights=vc.Weights())
    monkeypatch.setattr(placement, "EVERY", 1)
    found = [vc.place(model, 7, weights=vc.Weights(), budget=18, seed=seed) for seed in range(3)]
    assert all(len(one.choices) == 18 for one in found)
    best = everything.choices[0].index
    assert sum(one.choices[0].index == pytest.approx(best) for one in found) >= 2
