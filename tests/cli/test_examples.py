"""`vincula examples` and `vincula schema`."""

from __future__ import annotations

import json

import pytest

from vincula.mechanism.catalog.registry import MODULES


def test_the_list_names_every_example(run) -> None:
    text = run("examples").stdout
    for name in MODULES:
        assert f"  {name} " in text
    assert "vincula examples NAME" in text


@pytest.mark.parametrize("name", MODULES)
def test_every_example_is_described(run, run_json, name: str) -> None:
    text = run("examples", name).stdout
    assert text.startswith(f"example:{name}")
    assert f"vincula analyze example:{name}" in text
    (one,) = run_json("examples", name)["examples"]
    assert one["name"] == name
    for parameter in one["parameters"]:
        assert parameter["name"] in text
        assert parameter["default"] in text


def test_with_the_prefix_it_is_the_same(run) -> None:
    assert run("examples", "example:stewart").stdout == run("examples", "stewart").stdout


def test_unknown_example(run) -> None:
    result = run("examples", "fivebar", code=2)
    assert result.stdout == ""
    assert "did you mean 'five-bar'" in result.stderr


def test_schema_is_a_json_schema(run) -> None:
    for words in (["schema"], ["schema", "--json"]):
        schema = json.loads(run(*words).stdout)
        assert schema["$schema"].startswith("https://json-schema.org/")
        assert "joints" in schema["properties"]


def test_schemas_of_sweep_and_design_files(run) -> None:
    """They know the keys that the files have, with the hyphens that people write."""
    sweep, design = (json.loads(run("schema", kind).stdout) for kind in ("sweep", "design"))
    assert {"grid", "low-discrepancy", "quantities"} <= set(sweep["properties"])
    assert sweep["additionalProperties"] is design["additionalProperties"] is False
    assert set(design["required"]) == {"design", "model", "variables", "objectives"}
    assert "no-singularity" in design["$defs"]["ConstraintEntry"]["properties"]
    assert set(design["$defs"]["VariableEntry"]["required"]) == {"from", "to"}
    run("schema", "robot", code=2)
