"""ros2_control in URDF files: joints with a command interface are motors, the others passive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Coupling

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_IGNORED: Final = {
    "hardware": "drivers are never loaded",
    "sensor": "no part of a mechanism",
    "gpio": "no part of a mechanism",
    "transmission": "motors are the joints with a command interface; ratios are not used",
}


def read_ros2_control(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Read one `<ros2_control>` element."""
    joints = {joint.name for joint in draft.joints if not joint.closure}
    draft.motors = {} if draft.motors is None else draft.motors
    for part in element.children:
        if part.tag in _IGNORED:
            report.ignored(part.tag, part.name or element.name, _IGNORED[part.tag], of=part)
        elif part.tag != "joint":
            values.problems.add(
                part.place, f"<{part.tag}> is not understood in <ros2_control>", name=part.tag,
                choices=("joint", *_IGNORED),
            )  # fmt: skip
        elif (name := values.name(part)) and name not in joints:
            values.problems.add(part.place, f"there is no joint {shown(name)}", name=name, choices=joints)
        elif name:
            _joint(part, name, joints, draft, values, report)


def _joint(
    part: Element, name: str, joints: set[str], draft: RobotDraft, values: XmlValues, report: LoadReport
) -> None:
    settings = {p.name: p.text for p in part.find_all("param")}
    if "mimic" in settings:
        _mimic(part, name, settings, joints, draft, values, report)
    elif any(part.find_all("command_interface")):
        if draft.motors is not None and name not in draft.motors.values():
            draft.motors[name] = name
        report.used("ros2_control joint", name, "motor: it has a command interface")
    else:
        draft.passive.add(name)
        report.used("ros2_control joint", name, "passive: it has no command interface")


def _mimic(
    part: Element,
    name: str,
    settings: dict[str, str],
    joints: set[str],
    draft: RobotDraft,
    values: XmlValues,
    report: LoadReport,
) -> None:
    """The older way of coupling joints, by parameters of the interface."""
    leader = settings["mimic"]
    if leader not in joints or leader == name:
        values.problems.add(
            part.place, f"mimic names the joint {shown(leader)}", name=leader, choices=joints - {name}
        )
        return
    numbers = [
        values.numbers(part, settings.get(key, default), 1, what=key)
        for key, default in (("multiplier", "1"), ("offset", "0"))
    ]
    if numbers[0] is None or numbers[1] is None:
        return
    factor, offset = float(numbers[0][0]), float(numbers[1][0])
    report.used("ros2_control joint", name, f"{name} = {factor:g} x {leader} + {offset:g}")
    if all(coupling.name != f"mimic:{name}" for coupling in draft.couplings):
        draft.couplings.append(
            Coupling(
                f"mimic:{name}",
                {name: 1.0, leader: -factor},
                polynomial=(offset,),
                references={name: 0.0, leader: 0.0},
            )
        )
