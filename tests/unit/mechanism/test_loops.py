"""Loops as people list them: how many, and that each is a walk from body to body and back."""

from __future__ import annotations

import pytest

import vincula as vc
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.loops import independent_loops


def test_the_loop_of_the_five_bar_is_walked_in_order() -> None:
    (loop,) = independent_loops(example("five-bar"))
    assert loop.bodies == ("ground", "crank", "coupler", "link", "rocker")
    assert loop.parts == ("o1", "o2", "o3", "o4", "o5")
    assert loop.closed_by == "o3"


@pytest.mark.parametrize(
    ("name", "count"),
    [("stewart", 5), ("quadruped", 3), ("serial-7r", 0), ("two-finger-grasp", 1), ("two-arms", 1)],
)
def test_number_of_independent_loops(name: str, count: int) -> None:
    assert len(independent_loops(example(name))) == count


@pytest.mark.parametrize("name", MODULES)
def test_every_loop_is_a_closed_walk_that_ends_at_its_closing_part(name: str) -> None:
    mechanism = example(name)
    ends = {part.name: {part.first, part.second} for part in (*mechanism.joints, *mechanism.contacts)}
    loops = independent_loops(mechanism)
    for loop in loops:
        around = [*loop.bodies, loop.bodies[0]]
        for part, one, two in zip(loop.parts, around, around[1:], strict=False):
            assert ends[part] == {one, two}
        assert len(loop.parts) == len(loop.bodies)
        assert len(set(loop.parts)) == len(loop.parts)
        assert loop.closed_by in loop.parts
    # Each closing part is in no other loop, which makes the loops independent.
    for loop in loops:
        assert sum(loop.closed_by in other.parts for other in loops) == 1


def test_two_joints_between_the_same_bodies_make_a_loop_of_two() -> None:
    hinges = [vc.Revolute(name, "ground", "door", at=(0, 0, z)) for name, z in (("low", 0), ("high", 2))]
    (loop,) = independent_loops(vc.Mechanism.spatial(joints=hinges))
    assert loop.parts == ("low", "high")
    assert loop.bodies == ("ground", "door")


def test_contacts_close_loops_and_free_joints_do_not() -> None:
    box = vc.Mechanism.spatial(
        joints=[vc.Free("float", "ground", "box")],
        contacts=[
            vc.Contact(f"c{i}", "ground", "box", type="point", at=(i, 0, 0), normal=(0, 0, 1))
            for i in range(3)
        ],
    )
    loops = independent_loops(box)
    assert [loop.closed_by for loop in loops] == ["c1", "c2"]
    assert all("float" not in loop.parts for loop in loops)
