"""Transmissions of URDF files: motors on single joints, differentials, four-bar linkages.

Source of the formulas: the transmission interface of ros_control, SimpleTransmission,
DifferentialTransmission and FourBarLinkageTransmission.
"""

from __future__ import annotations

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
    if kind == "SimpleTransmission" and len(joints) == 1:
        motor = actuators[0] if actuators and actuators[0] else joints[0]
        draft.motors[motor] = joints[0]
        report.used("transmission", element.name, f"motor on {joints[0]}; its ratio is not used")
    elif kind in TYPES[1:] and len(joints) == 2 and len(actuators) == 2:
        _two_motors(kind, element, joints, actuators, draft, values)
        report.used("transmission", element.name, f"motors {', '.join(actuators)} drive {', '.join(joints)}")
    elif len(joints) == len(list(element.find_all("joint"))):
        values.problems.add(
            element.place,
            got=f"a transmission {shown(kind)} with {len(joints)} joints and {len(actuators)} actuators",
            expected="a simple one with one joint, or a differential or four-bar linkage with two",
            name=kind,
            choices=TYPES,
            unsupported=True,
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
