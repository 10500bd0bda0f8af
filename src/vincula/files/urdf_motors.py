"""Transmissions of URDF files: motors on single joints, differentials, four-bar linkages.

Source of the formulas: the transmission interface of ros_control, SimpleTransmission,
DifferentialTransmission and FourBarLinkageTransmission.  Of a type that nobody knows (makers write their own)
only the joints are understood: each counts as driven by a motor of its own, and a note says so.
"""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import TYPE_CHECKING, Final

from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Drive

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

TYPES: Final = ("SimpleTransmission", "DifferentialTransmission", "FourBarLinkageTransmission")


def read_transmission(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add the motors of one `<transmission>` to the draft.

    A simple transmission makes its joint active, whatever its ratio (q_a is the joint's rate); the two
    motors of a differential or a four-bar linkage drive combinations of two joints.
    """
    kind = _kind(element)
    joints = _named(element, "joint", draft, values)
    actuators = [values.name(a) for a in element.find_all("actuator")]
    draft.motors = {} if draft.motors is None else draft.motors
    if len(joints) < len(list(element.find_all("joint"))):
        return
    if kind == "SimpleTransmission" and len(joints) == 1:
        _one_motor(element, joints[0], actuators, draft, report)
    elif kind in TYPES[1:] and len(joints) == 2 and len(actuators) == 2:
        _two_motors(kind, element, joints, actuators, draft, values)
        report.used("transmission", element.name, f"motors {', '.join(actuators)} drive {', '.join(joints)}")
    elif _may_be_known(kind):
        values.problems.add(
            element.place,
            got=f"a transmission {shown(kind)} with {len(joints)} joints and {len(actuators)} actuators",
            expected="a simple one with one joint, or a differential or four-bar linkage with two",
            name=kind,
            choices=TYPES,
            unsupported=True,
        )
    else:
        _unknown(kind, element, draft, report)


def _one_motor(
    element: Element, joint: str, actuators: list[str], draft: RobotDraft, report: LoadReport
) -> None:
    """A motor called as its actuator is, or as its joint where another joint has that motor already."""
    if any(one.name == joint and one.type == "fixed" for one in draft.joints):
        report.ignored("transmission", element.name, f"joint {joint} is fixed", of=element)
        return
    motors = draft.motors if draft.motors is not None else {}
    name = actuators[0] if actuators and actuators[0] else joint
    other = motors.get(name, joint)
    if other != joint:
        report.note(f"the actuator {name} drives {other} and {joint}: each counts as a motor of its own")
        name = joint
    motors[name] = joint
    report.used("transmission", element.name, f"motor on {joint}; its ratio is not used")


def _may_be_known(kind: str) -> bool:
    """Whether a type is one that we know, or one of them with a slip of the pen, or none at all."""
    alike = (SequenceMatcher(None, kind, known).ratio() for known in TYPES if abs(len(kind) - len(known)) < 3)
    return not kind or max(alike, default=0.0) > 0.9


def _unknown(kind: str, element: Element, draft: RobotDraft, report: LoadReport) -> None:
    """A motor for every joint that a transmission of an unknown type names, but for passive ones."""
    known = {joint.name for joint in draft.joints if joint.type != "fixed"}
    parts = [part for part in element.children if part.tag.lower().endswith("joint")]
    named = [part.get("name", "") for part in parts if "passive" not in part.tag.lower()]
    driven = [name for name in named if name in known]
    motors = draft.motors if draft.motors is not None else {}
    motors |= {name: name for name in driven if name not in motors.values()}
    if driven:
        report.used("transmission", element.name, f"of type {kind}: a motor on each of {', '.join(driven)}")
    else:
        report.ignored(
            "transmission", element.name, f"of type {kind}: it names no joint that moves", of=element
        )
    report.note(
        f"transmissions of type {kind} are not understood: whatever they couple is not in the mechanism, "
        "and every joint that they name counts as a motor of its own; choose with --active"
    )


def _kind(element: Element) -> str:
    """`transmission_interface/SimpleTransmission` and `SimpleTransmission` are the same."""
    inside = next(element.find_all("type"), None)
    text = inside.text if inside is not None else element.get("type", "")
    return text.rsplit("/", 1)[-1].rsplit("::", 1)[-1].strip()


def _named(element: Element, tag: str, draft: RobotDraft, values: XmlValues) -> list[str]:
    known = [joint.name for joint in draft.joints]
    names = []
    for child in element.find_all(tag):
        name = values.name(child)
        if name and name not in known:
            values.problems.add(child.place, f"there is no joint {shown(name)}", name=name, choices=known)
        elif name:
            names.append(name)
    return names


def _ratio(element: Element, values: XmlValues) -> float:
    found = next(element.find_all("mechanicalReduction"), None)
    if found is None:
        return 1.0
    numbers = values.numbers(found, found.text, 1, what="mechanicalReduction")
    return 1.0 if numbers is None else float(numbers[0])


def _two_motors(
    kind: str, element: Element, joints: list[str], actuators: list[str], draft: RobotDraft, values: XmlValues
) -> None:
    motor = [_ratio(a, values) for a in element.find_all("actuator")]
    joint = [_ratio(j, values) for j in element.find_all("joint")]
    if kind == "DifferentialTransmission":
        rows = (
            {joints[0]: motor[0] * joint[0], joints[1]: motor[0] * joint[1]},
            {joints[0]: motor[1] * joint[0], joints[1]: -motor[1] * joint[1]},
        )
    else:
        rows = (
            {joints[0]: motor[0] * joint[0]},
            {joints[0]: motor[1], joints[1]: motor[1] * joint[1]},
        )
    for name, row in zip(actuators, rows, strict=True):
        draft.drives.append(Drive(name, row))
        if draft.motors is not None:
            draft.motors[name] = name
