"""Every public name exists, is documented, and is imported only when used."""

from __future__ import annotations

import ast
import subprocess
import sys

import pytest
from tests.house.source import modules, public_definitions, tree

import vincula


@pytest.mark.parametrize("name", vincula.__all__)
def test_public_name_exists_and_is_documented(name: str) -> None:
    value = getattr(vincula, name)
    assert value is not None
    if callable(value):
        assert value.__doc__
        assert value.__doc__.strip()


def test_type_checkers_see_the_same_names() -> None:
    seen: dict[str, str] = {}
    for node in tree("vincula").body:
        if isinstance(node, ast.If):
            for inner in node.body:
                assert isinstance(inner, ast.ImportFrom)
                seen |= {a.asname or a.name: f"{inner.module}:{a.name}" for a in inner.names}
    assert seen == vincula._HOME
    assert sorted(vincula.__all__) == sorted(seen)
    assert set(vincula.__all__) <= set(dir(vincula))


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'Mechanisms'"):
        _ = vincula.Mechanisms


def test_importing_the_package_imports_none_of_it() -> None:
    code = "import sys, vincula; print(*[m for m in sys.modules if m.startswith(('vincula.', 'numpy'))])"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.split() == []


@pytest.mark.parametrize("name", modules())
def test_every_public_definition_has_a_docstring(name: str) -> None:
    assert not [dotted for dotted, _, documented in public_definitions(name) if not documented]
