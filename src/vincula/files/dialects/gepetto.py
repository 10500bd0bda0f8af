"""Gepetto side files: `robot.yaml` beside `robot.urdf`, with the loops and the motors.

`closed_loop` lists pairs of frames that coincide, `type` how (6d: position and orientation, 3d:
position; in either case of letters; one word is for all), `name_mot` the joints with motors, `joint_name`
and `joint_type` joints of another type than the URDF file says: SPHERICAL, CARDAN (about x, then about y of
the joint's frame, whatever its axis says), UJOINT_ZY (about z, then about y, and so on) and FIXED.  A frame
is a link, or a joint, which stands for its child link.

Older files write `name_closedloop: fermeture` for the pairs of frames fermeture1_A and fermeture1_B,
fermeture2_A ...; `rotule_name: to_rotule` for all joints that are spherical, whose names contain it; and
`Lidmot`, `Lidvmot`, places of the motors in vectors of Pinocchio, which are not used.

Source: `completeRobotLoader` and `ActuationModel` of Gepetto/example-parallel-robots.  They take a name in
`name_mot` for every joint whose name contains it; here that is done only for a name that no joint has,
because "motor_knee" is also a part of "spherical_motor_knee_holder".
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.files.contents import account_values
from vincula.files.limits import Limits
from vincula.files.problems import form_of, shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import DraftJoint
from vincula.files.source import Source
from vincula.files.tree import Document, Location
from vincula.files.xmlvalues import XmlValues
from vincula.files.yamltree import read_yaml
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_NUMBERS: Final = ("Lidmot", "Lidvmot")
KEYS: Final = (
    "closed_loop", "type", "name_mot", "joint_name", "joint_type", "rotule_name", "name_closedloop",
    "closed_loop_number", *_NUMBERS,
)  # fmt: skip
LOOPS: Final = {"6d": "fixed", "3d": "spherical"}
"""Kinds of loops, and the joint that stands for them; both give rows only, as in Pinocchio."""
_AXES: Final = dict(zip("XYZ", np.eye(3), strict=True))
_TWO_AXES: Final = {"CARDAN": "XY"} | {f"UJOINT_{a}{b}": a + b for a in "XYZ" for b in "XYZ" if a != b}
JOINTS: Final = {"SPHERICAL": "spherical", "FIXED": "fixed"} | dict.fromkeys(_TWO_AXES, "universal")
"""Joint types that a side file may put in place of the URDF file's."""

_SIGN: Final = re.compile(
    r"^(?:closed_loop|name_closedloop|name_mot|joint_type|rotule_name)\s*:|^\s*closed_loop\s*:", re.MULTILINE
)


class GepettoFile:
    """One side file.

    Args:
        source: Its text.
        limits: How much it may hold.
    """

    def __init__(self, source: Source, limits: Limits) -> None:
        self._source, self._limits = source, limits

    @staticmethod
    def recognises(source: Source) -> bool:
        """Whether a text looks like a side file: it has one of its own keys."""
        return _SIGN.search(source.text) is not None

    def read(self, draft: RobotDraft, _values: XmlValues, report: LoadReport) -> None:
        """Add loops, motors and joint types to the draft.

        Raises:
            FileError: The file is not as described above; every problem with its place.
        """
        _SideFileReader(read_yaml(self._source, self._limits), draft, report).read()


class _SideFileReader:
    def __init__(self, document: Document, draft: RobotDraft, report: LoadReport) -> None:
        self._document, self._draft, self._report = document, draft, report
        self._problems = document.problems
        self._frames = {link: link for link in draft.links}
        self._frames |= {j.name: j.child for j in draft.joints if j.name not in draft.links}

    def read(self) -> None:
        tree = self._document.plain()
        if not isinstance(tree, dict):
            self._problems.add(self._document.place(()), got="no mapping", expected=f"keys {', '.join(KEYS)}")
            self._problems.refuse()
        for key in tree:
            if key not in KEYS:
                self._problems.add(
                    self._document.place((key,), at_key=True),
                    f"the key {shown(key)} is not understood",
                    name=str(key),
                    choices=KEYS,
                )
        self._balls(tree.get("rotule_name"))
        self._retype(self._list(tree, "joint_name"), self._list(tree, "joint_type"))
        pairs = self._list(tree, "closed_loop") or self._pairs(tree)
        self._loops(pairs, self._list(tree, "type", alone=len(pairs)))
        self._motors(self._list(tree, "name_mot", alone=1), "name_mot" in tree)
        for key in _NUMBERS:
            if key in tree:
                self._report.ignored(key, "", "the motors are those of name_mot")
        self._problems.refuse_if_any()
        account_values(self._document.root, self._report, ignored=_NUMBERS)

    def _list(self, tree: dict[str, Any], key: str, *, alone: int | None = None) -> list[Any]:
        """The list of a key; a text alone stands for a list of so many like it."""
        value = tree.get(key)
        if value is None:
            return []
        if isinstance(value, str) and alone is not None:
            return [value] * alone
        if isinstance(value, list):
            return value
        self._add((key,), got=form_of(value), expected="a list")
        return []

    def _add(self, location: Location, message: str = "", **details: Any) -> None:
        self._problems.add(self._document.place(location), message, **details)

    def _frame(self, name: object, location: Location) -> str:
        """The link that a frame name stands for; empty after a problem."""
        if isinstance(name, str) and name in self._frames:
            return self._frames[name]
        self._add(location, got=f"frame {form_of(name)}", name=str(name), choices=self._frames)
        return ""

    def _pairs(self, tree: dict[str, Any]) -> list[Any]:
        """Pairs of frames by the beginning of their names, in the older way."""
        word = tree.get("name_closedloop")
        if word is None:
            return []
        if not isinstance(word, str) or not word:
            self._add(("name_closedloop",), got=form_of(word), expected="the beginning of names of frames")
            return []
        found: list[Any] = []
        while all((frame := f"{word}{len(found) + 1}_{end}") in self._frames for end in "AB"):
            found.append([f"{frame[:-1]}A", frame])
        wanted = tree.get("closed_loop_number", -1)
        if not found or (wanted != -1 and wanted != len(found)):
            names = f"frames {shown(word + '1_A')} and {shown(word + '1_B')}, and so on"
            self._add(("name_closedloop",), got=f"{len(found)} pairs of such frames", expected=names)
        return found

    def _balls(self, word: object) -> None:
        """Make all joints spherical whose names contain a word."""
        if word is None:
            return
        names = [j.name for j in self._draft.joints if isinstance(word, str) and word and word in j.name]
        if not names:
            self._add(("rotule_name",), got=form_of(word), expected="a part of the name of a joint")
        self._retype(names, ["SPHERICAL"] * len(names))

    def _loops(self, pairs: list[Any], kinds: list[Any]) -> None:
        if len(kinds) != len(pairs):
            self._add(("type",), got=f"{len(kinds)} types", expected=f"{len(pairs)}, one a closed_loop")
            return
        for i, (pair, kind) in enumerate(zip(pairs, kinds, strict=True)):
            closure = LOOPS.get(kind.lower(), "") if isinstance(kind, str) else ""
            if not closure:
                self._add(
                    ("type", i), got=form_of(kind), expected=" or ".join(LOOPS), name=str(kind), choices=LOOPS
                )
                continue
            if not isinstance(pair, list) or len(pair) != 2:
                self._add(("closed_loop", i), got=form_of(pair), expected="two frames")
                continue
            links = [self._frame(name, ("closed_loop", i, k)) for k, name in enumerate(pair)]
            if not all(links):
                continue
            self._draft.joints.append(
                DraftJoint(
                    name=f"loop:{pair[0]}-{pair[1]}",
                    type=closure,
                    parent=links[0],
                    child=links[1],
                    on_parent=Pose.identity(3),
                    on_child=Pose.identity(3),
                    closure=True,
                    rows_only=True,
                    place=self._document.place(("closed_loop", i)),
                )
            )
            self._report.used("closed_loop", f"{pair[0]}-{pair[1]}", f"{kind}: {closure} closure")

    def _retype(self, names: list[Any], types: list[Any]) -> None:
        if len(names) != len(types):
            self._add(("joint_type",), got=f"{len(types)} types", expected=f"{len(names)}, one a joint_name")
            return
        joints = {joint.name: i for i, joint in enumerate(self._draft.joints)}
        for i, (name, kind) in enumerate(zip(names, types, strict=True)):
            if not isinstance(kind, str) or kind not in JOINTS:
                self._add(("joint_type", i), got=form_of(kind), expected=" or ".join(JOINTS), choices=JOINTS)
            elif not isinstance(name, str) or name not in joints:
                self._add(("joint_name", i), got=f"joint {form_of(name)}", name=str(name), choices=joints)
            else:
                at = joints[name]
                old = self._draft.joints[at]
                one, other = (_AXES.get(letter) for letter in _TWO_AXES.get(kind, "--"))
                self._draft.joints[at] = replace(
                    old, type=JOINTS[kind], axis=one, second_axis=other, limits=()
                )
                self._report.repaired("joint", name, f"{JOINTS[kind]}, as the side file says, not {old.type}")

    def _motors(self, names: list[Any], given: bool) -> None:
        joints = [j.name for j in self._draft.joints if not j.closure and j.type != "fixed"]
        found: dict[str, str] = {}
        for i, name in enumerate(names):
            meant = [name] if name in joints else []
            if not meant and isinstance(name, str) and name:
                meant = [joint for joint in joints if name in joint]
            if not meant:
                self._add(
                    ("name_mot", i), got=f"joint {form_of(name)}", name=str(name), choices=sorted(joints)
                )
            elif meant != [name]:
                self._report.note(f"name_mot: {name} stands for {', '.join(meant)}, whose names contain it")
            found |= dict(zip(meant, meant, strict=True))
        if given:
            self._draft.motors = found
            for name in found:
                self._report.used("motor", name)
