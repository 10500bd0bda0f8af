"""The independent reference results for MJCF robots, grasps included: counts and efficiencies."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.parity.mjcf_cases import CASES, CONTACTS

import vincula as vc
from vincula.analysis.result import analyze
from vincula.files.mjcf import load_mjcf
from vincula.mechanism.drawing import Drawing
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.space import SPATIAL

pytest.importorskip("mujoco")


def mechanism_of(shared: Path, case: dict[str, Any]) -> Mechanism:
    """The robot at the configuration of the case, with its grasped object where it has one."""
    robot = load_mjcf(shared / case["model_file"])[0].with_configuration(case["configuration"]["by_joint"])
    member = case.get("reference_member", {"body": "object"})["body"]
    if "contacts" in case:
        drawing = Drawing(SPATIAL, robot)
        contacts = [
            vc.Contact(f"c{k}", c["body"], "object", CONTACTS[c["type"]], c["point_world"], c["normal_world"])
            for k, c in enumerate(case["contacts"])
        ]
        drawing.add(bodies=[vc.Body("object", at=case["object_frame_point_world"])], contacts=contacts)
        robot = replace(robot, bodies=drawing.bodies, contacts=drawing.contacts)
    return robot.with_lock(case["locked"]).with_active(case["actuated"]).with_reference(member)


def all_results(name: str, shared: Path) -> tuple[dict[str, Any], Any]:
    case = json.loads((shared / "cases" / name / "expected.json").read_text(encoding="utf-8"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vc.MixedUnitsWarning)
        return case, analyze(mechanism_of(shared, case).linearize())


@pytest.mark.parametrize("name", CASES)
def test_counts(name: str, shared: Path) -> None:
    case, analysis = all_results(name, shared)
    found = analysis.to_dict()["mobility"]
    counts, expected = found["counts"], case["results"]
    assert found["nullity"] == expected["mobility"]
    assert counts["oi"] + counts["po"] + counts["t"] == expected["dim_member_indeterminacy"]
    assert counts["ar"] + counts["ap"] + counts["t"] == expected["dim_actuated_redundancy"]
    assert counts["ao"] + counts["g"] == expected["dim_coordinated"]
    assert counts["o"] == expected["dim_structural_wrenches"]
    assert counts["a"] == expected["dim_internal_torques"]


@pytest.mark.parametrize("name", CASES)
def test_efficiencies(name: str, shared: Path) -> None:
    case, analysis = all_results(name, shared)
    kinematic = analysis.to_dict()["kinematic"]
    pairs = zip(kinematic["efficiencies"], kinematic["classes"], strict=True)
    finite = [value for value, kind in pairs if kind == "finite"]
    expected = case["results"]["eig_velocity_eq13"]
    assert len(finite) == len(expected)
    assert np.allclose(finite, expected, rtol=1e-10, atol=0)


@pytest.mark.parametrize("name", CASES)
def test_ranks_are_certain(name: str, shared: Path) -> None:
    _, analysis = all_results(name, shared)
    assert analysis.to_dict()["rank"]["status"] == "certain"


def test_every_mjcf_case_is_here(cases: Path) -> None:
    folders = {
        path.parent.name
        for path in cases.glob("*/expected.json")
        if str(json.loads(path.read_text(encoding="utf-8")).get("model_file", "")).endswith(".xml")
    }
    assert folders == set(CASES)
