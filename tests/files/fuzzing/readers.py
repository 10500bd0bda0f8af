"""The readers that are fuzzed, each with the files that it starts from and what a reading goes through."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from tests.conftest import ROOT
from tests.files.conventions import five_bar, four_bar
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR

import vincula as vc
from vincula.files.configuration import read_configuration
from vincula.files.dialects.gepetto import GepettoFile
from vincula.files.dialects.srdf import SrdfFile
from vincula.files.expressions import Measured, evaluate
from vincula.files.limits import DEFAULT_LIMITS
from vincula.files.load import _Loader
from vincula.files.source import Source, decode
from vincula.files.tree import plain
from vincula.files.treefile import read_tree
from vincula.files.urdf import UrdfReader
from vincula.files.weights import read_weights
from vincula.files.xmltree import parse_xml

FILES = ROOT / "tests" / "files"
SHARED = Path(os.environ.get("VINCULA_SHARED", ROOT.parent / "shared"))
LARGEST = int(os.environ.get("VINCULA_FUZZ_LARGEST", "40000"))


@dataclass(frozen=True)
class Seed:
    """A file to start from.

    Attributes:
        data: Its bytes.
        path: Where it is, for what stands beside it.
        tree: Its content, of YAML and JSON files that can be parsed.
    """

    data: bytes
    path: Path
    tree: Any = None

    @property
    def good(self) -> bool:
        """Whether it can be read as it is."""
        return "bad" not in self.path.parts


@dataclass(frozen=True)
class Reader:
    """One reader.

    Attributes:
        name: Its name.
        kind: xml, yaml, json or text: what its structure is.
        read: Reads bytes at a path, and uses what was read.
        seeds: Files to start from.
    """

    name: str
    kind: str
    read: Callable[[bytes, Path], None]
    seeds: list[Seed] = field(default_factory=list)


@cache
def reader(name: str) -> Reader:
    """The reader with a name, its files read."""
    kind, read, texts = READERS[name]
    seeds = []
    for path, data in texts():
        if len(data) > LARGEST:
            continue
        tree = _tree(data) if kind in ("yaml", "json") else None
        if kind != "json":
            seeds.append(Seed(data, path, tree))
        elif tree is not None:
            seeds.append(Seed(json.dumps(tree).encode(), path.with_suffix(".json"), tree))
    return Reader(name, kind, read, seeds)


def _tree(data: bytes) -> Any:
    try:
        return _jsonable(plain(read_tree(decode(data, "seed"), DEFAULT_LIMITS).root))
    except vc.FileError:
        return None


def _jsonable(tree: Any) -> Any:
    if isinstance(tree, dict):
        return {key: _jsonable(value) for key, value in tree.items()}
    if isinstance(tree, list):
        return [_jsonable(value) for value in tree]
    return float(tree) if isinstance(tree, float) else tree


def _used(mechanism: vc.Mechanism, report: Any = None) -> None:
    """What every user does with a mechanism first."""
    mechanism.residuals()
    if report is not None:
        str(report)
        json.dumps(report.to_dict())


def _load(data: bytes, path: Path) -> None:
    loaded = _Loader({}, DEFAULT_LIMITS)._read(decode(data, path.name, path))
    _used(loaded.mechanism, loaded.report)


def _beside_urdf(data: bytes, path: Path, side: type[GepettoFile | SrdfFile]) -> None:
    urdf = UrdfReader(*_five_bar_urdf())
    urdf.read(parse_xml(_five_bar_urdf()[0]))
    side(decode(data, path.name, path), DEFAULT_LIMITS).read(urdf.draft, urdf.values, urdf.report)
    _used(urdf.finish(), urdf.report)


@cache
def _five_bar_urdf() -> tuple[Source, Any]:
    return decode(_urdf(four_bar.TREE).encode(), "robot.urdf"), DEFAULT_LIMITS


@cache
def _arm() -> vc.Mechanism:
    return vc.load(_temporary(ALL_JOINTS.encode(), "arm.yaml"))


def _temporary(data: bytes, name: str) -> Path:
    """A file in memory, where there is such a place."""
    folder = Path("/dev/shm") if Path("/dev/shm").is_dir() else Path(os.environ.get("TMPDIR", "/tmp"))
    path = folder / f"vincula-fuzz-{os.getpid()}-{name}"
    path.write_bytes(data)
    return path


def _configuration(data: bytes, path: Path) -> None:
    if path.suffix:
        at = _temporary(data, path.name)
        read_configuration(str(at), _arm())
    else:
        read_configuration(data.decode("utf-8", "surrogateescape"), _arm())


def _weights(data: bytes, path: Path) -> None:
    text = str(_temporary(data, path.name)) if path.suffix else data.decode("utf-8", "surrogateescape")
    weights = read_weights(text, _arm())
    model = _arm().linearize()
    for quantity in ("rate", "twist", "torque", "wrench", "contact_force"):
        weights.metric(quantity, model)


def _expression(data: bytes, _path: Path) -> None:
    evaluate(data.decode("utf-8", "surrogateescape"), {"l": Measured(1.0, 0.1), "r": Measured(0.0)})


def _urdf(inside: str) -> str:
    return f'<robot name="linkage" xmlns:drake="http://drake.mit.edu">{inside}</robot>'


def _files(*patterns: str) -> Iterator[tuple[Path, bytes]]:
    for folder in (FILES, SHARED / "models"):
        for pattern in patterns:
            for path in sorted(folder.glob(pattern)):
                if not path.is_dir():
                    yield path, path.read_bytes()


def _texts(name: str, *texts: str) -> Iterator[tuple[Path, bytes]]:
    for text in texts:
        yield Path("nowhere") / name, text.encode()


def _native() -> Iterator[tuple[Path, bytes]]:
    rest = "closures: [{name: tip, type: revolute, frames: [a, b]}]\n"
    overlay = (
        "vincula: 1\nbase: example:five-bar\nmotors: [{name: m, drives: {o1: 1, o3: 2}}, {name: n, axis: o5}]"
    )
    overlay += (
        "lock: [o2]\nconfiguration: {o1: 0.3}\nweights: {twist: [1, 1, 1], rate: {m: 4}, reciprocal: true}\n"
    )
    overlay += "couplings: [{name: gear, rates: {o1: 1}, driver: {o4: 1}, polynomial: [0, 2, 1]}]\n"
    frames = "frames: {a: {body: crank, at: [0, 0]}, b: {body: rocker, at: [0, 0], x: [1, 0]}}\n"
    more = "keyframes: {home: {o1: 0.1}}\nprecision: {length: 1e-3}\nnotes: [hello]\n"
    more += "units: {length: mm, angle: deg}\n"
    yield from _texts(
        "m.yaml", *[FIVE_BAR] * 6, *[ALL_JOINTS] * 6, *[FIVE_BAR + frames + rest + more] * 6, *[overlay] * 6,
        four_bar.NATIVE_SPATIAL,
    )  # fmt: skip
    yield from _files("legal/native/*.yaml", "bad/native/*.yaml")


def _mjcf() -> Iterator[tuple[Path, bytes]]:
    yield from _files("mjcf/*.xml", "bad/mjcf/*.xml", "*/*.xml")


def _urdfs() -> Iterator[tuple[Path, bytes]]:
    texts = [_urdf(four_bar.TREE + "".join(four_bar.URDF.values()))]
    texts += [_urdf(four_bar.TREE + loop) for loop in four_bar.URDF.values()]
    texts += [_urdf(five_bar.TREE + loop) for loop in five_bar.URDF.values()]
    texts += [_urdf(four_bar.CONSTRUCTED["Drake distance"])]
    yield from _texts("robot.urdf", *texts * 3)
    yield from _files("bad/urdf/*.urdf", "*/*.urdf")


def _sdfs() -> Iterator[tuple[Path, bytes]]:
    ball = four_bar.SDF_BALL.replace("<sdf", '<sdf xmlns:drake="d"')
    yield from _texts("model.sdf", *[four_bar.SDF_GRAPH, ball, five_bar.SDF] * 5)
    yield from _files("bad/sdf/*.sdf", "*/*.sdf")


def _gepetto() -> Iterator[tuple[Path, bytes]]:
    text = "closed_loop: [[coupler, rocker], [o1, o4]]\ntype: [6d, 3d]\nname_mot: [o1]\njoint_name: [o2]\n"
    yield from _texts("robot.yaml", *[text + "joint_type: [SPHERICAL]\n"] * 4)
    yield from _files("*/robot.yaml", "bad/gepetto/*.yaml")


def _srdf() -> Iterator[tuple[Path, bytes]]:
    passive = '<passive_joint name="o2"/><passive_joint name="o4"/>'
    group = '<group name="g"><chain base_link="base" tip_link="coupler"/></group>'
    group += '<group_state name="s" group="g"/>'
    yield from _texts("robot.srdf", f'<robot name="linkage">{passive}{group}</robot>')
    yield from _files("bad/srdf/*.srdf")


def _configurations() -> Iterator[tuple[Path, bytes]]:
    yield from _texts(
        "q", "r=0.3,u=[0.1,0.2]", "r=30deg, k=[1 0 0 0]", "'s'=pi/6", "p=3 mm, fl=[0,0,5,1,0,0,0]", "key:home"
    )
    text = "r: 0.3\np: 0.1\nu: [0.1, pi/6]\nk: [1, 0, 0, 0]\nfl: [0, 0, 5, 1, 0, 0, 0]\ne: [0, 0, 0.1]\n"
    yield from _texts("q.yaml", text)
    yield from _texts("q.json", '{"r": 0.3, "k": [1, 0, 0, 0], "u": [0.1, 0.2]}')
    yield from _files("bad/configuration/*.yaml", "bad/configuration/*.json")


def _weight_files() -> Iterator[tuple[Path, bytes]]:
    yield from _texts(
        "w", "twist=1,1,1,5,5,5", "rate=r:4,u.2:1;reciprocal", "limits", "contact_force=all rows"
    )
    matrix = [[2.0 if i == j else 0.5 for j in range(6)] for i in range(6)]
    text = (
        f"twist: {matrix}\nrate: {{r: 4}}\ntorque: 2\nwrench: [1, 1, 1, 2, 2, 2]\ncontact_force: all rows\n"
    )
    yield from _texts(
        "w.yaml", text, "twist: [1, 1, 1, 5, 5, 5]\nrate: {r: 2, c.translation: 0.1}\nreciprocal: true\n"
    )
    yield from _texts("w.json", json.dumps({"twist": matrix, "rate": [1, 2, 3, 4, 5, 6]}))
    yield from _files("bad/weights/*.yaml", "bad/weights/*.json")


def _expressions() -> Iterator[tuple[Path, bytes]]:
    yield from _texts(
        "e", "$l/2", "2*pi/3", "$r*cos($l)", "-(1.5e-3 + sqrt(2))*tan(0.1)", "$l - -$l", "((($l)))/$r", "1/3"
    )


Texts = Callable[[], Iterator[tuple[Path, bytes]]]

READERS: dict[str, tuple[str, Callable[[bytes, Path], None], Texts]] = {
    "native-yaml": ("yaml", _load, _native),
    "native-json": ("json", _load, _native),
    "mjcf": ("xml", _load, _mjcf),
    "urdf": ("xml", _load, _urdfs),
    "sdf": ("xml", _load, _sdfs),
    "gepetto": ("yaml", lambda data, path: _beside_urdf(data, path, GepettoFile), _gepetto),
    "srdf": ("xml", lambda data, path: _beside_urdf(data, path, SrdfFile), _srdf),
    "configuration": ("yaml", _configuration, _configurations),
    "weights": ("yaml", _weights, _weight_files),
    "expressions": ("text", _expression, _expressions),
}
"""By name: what the structure is, how it is read, and the files to start from."""
