"""The source as data: modules, what they import, and their public definitions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"


@dataclass(frozen=True)
class Import:
    """One imported module.

    Attributes:
        target: Dotted name of the module (for `from a import b`, `a.b` where that is a module).
        names: Names taken from it.
        line: Line of the statement.
        typing_only: Under `if TYPE_CHECKING`, so it does not happen at run time.
        late: Inside a function.
    """

    target: str
    names: tuple[str, ...]
    line: int
    typing_only: bool
    late: bool


@cache
def modules() -> dict[str, Path]:
    """Every module of the package: dotted name to file."""
    found = {}
    for path in sorted(SOURCE.rglob("*.py")):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(name: str) -> ast.Module:
    """Syntax tree of a module."""
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


def imports(name: str) -> list[Import]:
    """Everything that a module imports, anywhere in it."""
    return list(_walk(name, tree(name), typing_only=False, late=False))


def public_definitions(name: str) -> Iterator[tuple[str, ast.AST, bool]]:
    """Dotted name, node and "has a docstring" of every public class, function and method."""
    yield name, tree(name), ast.get_docstring(tree(name)) is not None
    yield from _definitions(name, tree(name).body)


def _definitions(prefix: str, body: list[ast.stmt]) -> Iterator[tuple[str, ast.AST, bool]]:
    for node in body:
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            continue
        if node.name.startswith("_") or _is_overload(node):
            continue
        yield f"{prefix}.{node.name}", node, ast.get_docstring(node) is not None
        if isinstance(node, ast.ClassDef):
            yield from _definitions(f"{prefix}.{node.name}", node.body)


def _is_overload(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> bool:
    return any(isinstance(d, ast.Name) and d.id == "overload" for d in node.decorator_list)


def _walk(module: str, node: ast.AST, *, typing_only: bool, late: bool) -> Iterator[Import]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            for alias in child.names:
                yield Import(alias.name, (), child.lineno, typing_only, late)
        elif isinstance(child, ast.ImportFrom):
            yield from _from(module, child, typing_only, late)
        elif isinstance(child, ast.If) and _is_type_checking(child.test):
            for inner in child.body:
                yield from _walk(module, ast.Module([inner], []), typing_only=True, late=late)
            yield from _walk(module, ast.Module(child.orelse, []), typing_only=typing_only, late=late)
        else:
            inside = late or isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
            yield from _walk(module, child, typing_only=typing_only, late=inside)


def _from(module: str, node: ast.ImportFrom, typing_only: bool, late: bool) -> Iterator[Import]:
    base = node.module or ""
    if node.level:
        is_package = modules()[module].name == "__init__.py"
        parts = module.split(".")
        kept = parts[: len(parts) - node.level + (1 if is_package else 0)]
        base = ".".join([*kept, *([base] if base else [])])
    rest = []
    for alias in node.names:
        if f"{base}.{alias.name}" in modules():
            yield Import(f"{base}.{alias.name}", (), node.lineno, typing_only, late)
        else:
            rest.append(alias.name)
    if rest:
        yield Import(base, tuple(rest), node.lineno, typing_only, late)


def _is_type_checking(test: ast.expr) -> bool:
    return (isinstance(test, ast.Name) and test.id == "TYPE_CHECKING") or (
        isinstance(test, ast.Attribute) and test.attr == "TYPE_CHECKING"
    )
