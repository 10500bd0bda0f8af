"""The hourglass holds: imports point down, no cycles, slow packages stay in their rooms, files are short."""

from __future__ import annotations

import ast

import pytest
from tests.house.source import ROOT, SOURCE, imports, modules, tree

FLOORS = {
    "__main__": 6,
    "cli": 6,
    "files": 5,
    "adapters": 5,
    "view": 5,
    "maps": 4,
    "sweep": 4,
    "design": 4,
    "kernels": 3.5,
    "mechanism": 3,
    "analysis": 3,
    "labels": 2,
    "model": 2,
    "weights": 2,
    "numerics": 1,
    "spatial": 1,
    "errors": 0,
    "arrays": 0,
    "traced": 0,
    "elementary": 0,
}

# Which rooms may import a package that is slow to import or may be missing.
ROOMS_OF = {
    "click": {"cli"},
    "rich": {"cli"},
    "pydantic": {"files"},
    "ruamel": {"files"},
    "matplotlib": {"view", "sweep"},  # the plots of a data set hang on its accessor, which is in sweep
    "mpl_toolkits": {"view"},
    "mujoco": {"files", "adapters"},
    "pinocchio": {"adapters"},
    "flint": {"numerics"},
    "xarray": {"sweep", "maps"},  # maps are written as data sets too
    "zarr": {"sweep", "maps"},
    "distributed": {"sweep"},
}

LONGEST_FILE = 350
LONGEST_FUNCTION = 60


def room(module: str) -> str:
    """First name below the package: its room."""
    return module.split(".")[1]


INSIDE = [name for name in modules() if name != "vincula"]


@pytest.mark.parametrize("name", INSIDE)
def test_every_module_has_a_room(name: str) -> None:
    assert room(name) in FLOORS


@pytest.mark.parametrize("name", INSIDE)
def test_imports_point_down(name: str) -> None:
    wrong = []
    for found in imports(name):
        if found.target == "vincula":
            if set(found.names) != {"__version__"}:
                wrong.append(f"line {found.line}: {found.names} from the package itself")
        elif found.target.startswith("vincula."):
            up = FLOORS[room(found.target)] > FLOORS[room(name)]
            if up and not found.typing_only:
                wrong.append(f"line {found.line}: {found.target}")
    assert not wrong


@pytest.mark.parametrize("name", INSIDE)
def test_mechanism_and_analysis_meet_only_at_the_waist(name: str) -> None:
    apart = {"mechanism": "analysis", "analysis": "mechanism"}.get(room(name))
    targets = [found.target for found in imports(name) if found.target.startswith("vincula.")]
    assert not [target for target in targets if room(target) == apart]


@pytest.mark.parametrize("name", INSIDE)
def test_slow_and_optional_packages_stay_in_their_rooms(name: str) -> None:
    for found in imports(name):
        allowed = ROOMS_OF.get(found.target.split(".")[0], {room(name)})
        assert found.typing_only or room(name) in allowed, f"line {found.line}: {found.target}"


def test_no_import_cycles() -> None:
    """Inside one room a method may import late what is built on its own class, as `Mechanism.planar` does."""
    graph = {
        name: {
            found.target
            for found in imports(name)
            if found.target in INSIDE
            and not found.typing_only
            and not (found.late and room(found.target) == room(name))
        }
        for name in INSIDE
    }
    done: set[str] = set()

    def visit(name: str, path: tuple[str, ...]) -> None:
        assert name not in path, " -> ".join([*path[path.index(name) :], name])
        if name not in done:
            for target in sorted(graph[name]):
                visit(target, (*path, name))
            done.add(name)

    for name in graph:
        visit(name, ())


@pytest.mark.parametrize("name", modules())
def test_files_hold_one_idea(name: str) -> None:
    assert len(modules()[name].read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE


def test_test_files_are_short_too() -> None:
    files = [*ROOT.glob("tests/**/*.py"), *ROOT.glob("benchmarks/**/*.py")]
    lengths = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in files
    }
    assert not {name: count for name, count in lengths.items() if count > LONGEST_FILE}


@pytest.mark.parametrize("name", modules())
def test_functions_fit_a_screen(name: str) -> None:
    long = {}
    for node in ast.walk(tree(name)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            first = (
                node.body[1] if ast.get_docstring(node) is not None and len(node.body) > 1 else node.body[0]
            )
            length = (node.end_lineno or 0) - first.lineno + 1
            if length > LONGEST_FUNCTION:
                long[node.name] = length
    assert not long


def test_no_catch_all_module_names() -> None:
    forbidden = {"utils", "util", "misc", "helpers", "helper", "common"}
    assert not [path for path in SOURCE.rglob("*") if path.stem in forbidden]
