"""The Stewart platform in every convention: the same counts, the same efficiencies to 1e-9.

| file | how the loops are written |
|---|---|
| native.yaml | true graph, universal and ball joints |
| urdf-plus, urdf-plus-revolute | `<loop>` of balls; of hinges, the legs hanging from the platform |
| gepetto | 3d loops, base joints CARDAN by the side file |
| isaac, isaac-manual, isaac-revolute | balls in both spellings; the form with parent and child has hinges |
| drake.urdf, drake.sdf | universal and ball joints of Drake, ball constraints |
| gazebo | SDF ball joints in `<gazebo>` |
| urdfdom-proposal | `<constraint>` of balls |
| several-parents | hinges; URDF itself has no balls, so a leg hangs on three of them |
| mjcf-connect, mjcf-weld-sites | connects; ball joints welded at sites |
| sdf | true graph, universal and ball joints |

What cannot be written: Drake's distance constraint (the legs have motors) and a planar file (the
platform leaves the plane).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vincula as vc

FOLDER = Path(__file__).parent / "stewart"
FILES = sorted(
    p.name for p in FOLDER.iterdir() if p.suffix in (".urdf", ".xml", ".sdf") or p.name == "native.yaml"
)
POINT = (0.1, -0.2, 0.25)
"""The reference point in the platform's frame; the native file has ground axes, 1.25 m lower."""
COUNTS = ("ar", "pr", "oi", "t", "ap", "ao", "po")


def numbers(name: str) -> dict[str, Any]:
    robot = vc.load(FOLDER / name)
    if name != "native.yaml":
        robot = robot.with_reference("platform", POINT)
    return vc.analyze(robot.linearize(), vc.Weights()).to_dict()


@pytest.fixture(scope="module")
def native() -> dict[str, Any]:
    return numbers("native.yaml")


def test_the_drawing_moves_as_the_leg_formula_says(native: dict[str, Any]) -> None:
    """Rates of the legs are l . v + (r x l) . w: written here anew, from the points of the legs."""
    base = [(1.0, 0.3), (-0.2, 1.1), (-0.7, 0.8), (-0.9, -0.4), (0.1, -1.2), (0.8, -0.7)]
    top = [(0.5, 0.4), (0.2, 0.6), (-0.6, 0.1), (-0.5, -0.3), (0.25, -0.6), (0.45, -0.35)]
    rows = []
    for b, t in zip(base, top, strict=True):
        way = np.array([t[0] - b[0], t[1] - b[1], 1.25])
        way /= np.linalg.norm(way)
        arm = np.array([*t, 0.0]) - np.array(POINT)
        rows.append([*way, *np.cross(arm, way)])
    sigma = np.linalg.svd(np.array(rows), compute_uv=False)
    assert native["kinematic"]["efficiencies"] == pytest.approx(np.sort(sigma**-2)[::-1], rel=1e-9)
    assert native["mobility"]["summary"]["coordinated"] == 6


def test_every_convention_is_here() -> None:
    assert len(FILES) == 15


@pytest.mark.parametrize("name", FILES)
def test_same_counts_and_efficiencies(name: str, native: dict[str, Any]) -> None:
    if name.endswith(".xml"):
        pytest.importorskip("mujoco")
    found = numbers(name)
    assert [axis.removeprefix("mot_") for axis in found["active"]] == [f"p{k}" for k in range(1, 7)]
    assert found["closure"]["residual"] < 1e-12
    assert found["rank"]["status"] == "certain"
    for part in ("summary", "counts"):
        one, other = (dict(d["mobility"][part]) for d in (native, found))
        keys = COUNTS if part == "counts" else [k for k in one if k != "static_indeterminacy"]
        assert {k: other[k] for k in keys} == {k: one[k] for k in keys}
    for kind in ("kinematic", "active_force", "passive_force", "dual_force"):
        one, other = ([float(e) for e in d[kind]["efficiencies"]] for d in (native, found))
        assert other == pytest.approx(one, rel=1e-9), kind
