"""The reference cases of the real MJCF and URDF robots, through the command line alone.

Grasp cases go through a native overlay (`base:`) that adds object, contacts and reference member;
the others through `--reference`, `--active`, `--lock` and `--at`.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from tests.parity.mjcf_cases import CASES, CONTACTS

from vincula.cli.main import cli

URDF_CASES = ("gepetto_5bar_linkage", "gepetto_5bar_linkage_iso3d", "gepetto_robot_delta")


def overlay(case: dict[str, Any], model: Path, folder: Path) -> Path:
    """A native file that adds to the robot what the case adds."""
    contacts = [
        {
            "name": f"c{i + 1}",
            "type": CONTACTS[contact["type"]],
            "bodies": [contact["body"], "object"],
            "at": contact["point_world"],
            "normal": contact["normal_world"],
        }
        for i, contact in enumerate(case["contacts"])
    ]
    content = {
        "vincula": 1,
        "base": str(model),
        "contacts": contacts,
        "reference": {"body": "object", "origin": case["object_frame_point_world"]},
        "configuration": {name: values[0] for name, values in case["configuration"]["by_joint"].items()},
    }
    path = folder / "grasp.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def arguments(case: dict[str, Any], model: Path, folder: Path) -> list[str]:
    """The command line of a case."""
    options = ["--active", ",".join(case["actuated"])]
    if case["locked"]:
        options += ["--lock", ",".join(case["locked"])]
    if "contacts" in case:
        return ["analyze", str(overlay(case, model, folder)), *options, "--json"]
    values = case["configuration"].get("by_joint", case["configuration"])
    at = folder / "at.json"
    plain = {name: value[0] if isinstance(value, list) else value for name, value in values.items()}
    at.write_text(json.dumps(plain), encoding="utf-8")
    body = case["reference_member"]["body"]
    return ["analyze", str(model), "--reference", body, "--at", str(at), *options, "--json"]


@pytest.mark.parametrize("name", [*CASES, *URDF_CASES])
def test_agrees_with_the_reference_case(name: str, shared: Path, tmp_path: Path) -> None:
    case = json.loads((shared / "cases" / name / "expected.json").read_text(encoding="utf-8"))
    result = CliRunner().invoke(cli, arguments(case, shared / case["model_file"], tmp_path))
    assert result.exit_code == 0, result.output
    got = json.loads(result.stdout)
    expected = case["results"]
    summary = got["mobility"]["summary"]
    assert summary["mobility"] == expected["mobility"]
    assert summary["indeterminacy"] == expected["dim_member_indeterminacy"]
    assert summary["redundancy"] == expected["dim_actuated_redundancy"]
    assert summary["coordinated"] == expected["dim_coordinated"]
    assert summary["structural_wrenches"] == expected["dim_structural_wrenches"]
    assert summary["internal_torques"] == expected["dim_internal_torques"]
    kinematic = got["kinematic"]
    finite = [
        e for e, kind in zip(kinematic["efficiencies"], kinematic["classes"], strict=True) if kind == "finite"
    ]
    assert finite == pytest.approx(expected["eig_velocity_eq13"], rel=1e-6)
    assert kinematic["classes"].count("infinite") == expected["dim_member_indeterminacy"]
    assert kinematic["classes"].count("zero") == expected["dim_actuated_redundancy"]
    duals = sorted((1.0 / e for e in finite), reverse=True)
    assert got["dual_force"]["efficiencies"] == pytest.approx(duals, rel=1e-6)
    squeeze = expected.get("paper", {}).get("eig_internal_eq23_f2_over_tau2")
    if squeeze and "robotiq" not in name:
        found = [e for e in got["internal_force"]["efficiencies"] if e != "inf" and not math.isinf(e)]
        assert found == pytest.approx(squeeze, rel=1e-6)
