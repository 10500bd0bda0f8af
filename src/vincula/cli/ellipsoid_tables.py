"""The five ellipsoids as tables: values, classes, and directions by component."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.cli.page import Column, Page, Table, combination, number

if TYPE_CHECKING:
    from vincula.analysis.ellipsoid import Ellipsoid
    from vincula.analysis.result import Analysis
    from vincula.arrays import Vector

READINGS: Final = {
    "kinematic": {
        "efficiency": "speed of the member per motor speed; large is fast",
        "accuracy": "error of the member per motor error; large is inaccurate",
    },
    "active force": {
        "efficiency": "what the motors push through the member, per motor torque",
        "accuracy": "error of the pushed force per error of motor torque; large is inaccurate",
    },
    "passive force": {
        "efficiency": "what the member resists, per motor torque; inf costs no torque",
        "accuracy": "error of the resisted load per error of motor torque; large is inaccurate",
    },
    "internal force": {
        "efficiency": "squeeze without a load on the member, per motor torque",
        "accuracy": "error of the squeeze per error of motor torque; large is inaccurate",
    },
    "dual force": {
        "efficiency": "the force problem dual to the kinematic one",
        "accuracy": "the force problem dual to the kinematic one; large is inaccurate",
    },
}


def add_ellipsoid(page: Page, ellipsoid: Ellipsoid, analysis: Analysis) -> None:
    """Put an ellipsoid on a page.

    Args:
        page: The page.
        ellipsoid: One of the five.
        analysis: Where it is from; what repeats another ellipsoid is said in a line.
    """
    page.heading(f"{ellipsoid.kind.capitalize()} ellipsoid", READINGS[ellipsoid.kind][ellipsoid.viewpoint])
    if not ellipsoid.classes:
        page.sentence("none: there is no such force" if "force" in ellipsoid.kind else "none: nothing moves")
        return
    if ellipsoid.kind in ("passive force", "dual force") and _repeats(ellipsoid, analysis.active_force):
        page.sentence("the same finite values and directions as the active force ellipsoid")
        return
    in_words = [_in_words(ellipsoid, 44), _in_words(ellipsoid, 34), _stacked(ellipsoid, 42)]
    page.table(*([] if ellipsoid.kind == "internal force" else [_in_columns(ellipsoid)]), *in_words)


def _repeats(one: Ellipsoid, other: Ellipsoid) -> bool:
    """Whether one lists what the other lists as finite (reciprocal weights)."""
    return (
        set(one.classes) == {"finite"}
        and np.array_equal(one.efficiencies, other.finite)
        and all(
            a is not None and b is not None and np.array_equal(a, b)
            for a, b in zip(one.task_directions, other.task_directions, strict=False)
        )
    )


def _values(ellipsoid: Ellipsoid) -> list[list[str]]:
    return [
        [number(value), number(axis), kind]
        for value, axis, kind in zip(
            ellipsoid.efficiencies, ellipsoid.semi_axes, ellipsoid.classes, strict=True
        )
    ]


_HEAD: Final = [Column("efficiency", "right"), Column("semi-axis", "right"), Column("class")]


def _in_columns(ellipsoid: Ellipsoid) -> Table:
    """Directions with a column a component: easiest to compare, needs a wide terminal."""
    names = [*ellipsoid.components, *ellipsoid.motors]
    units = [*ellipsoid.units, *ellipsoid.motor_units]
    columns = [*_HEAD, *(Column(f"{n}\n{u}", "right") for n, u in zip(names, units, strict=True))]
    rows = []
    for start, task, motor in zip(
        _values(ellipsoid), ellipsoid.task_directions, ellipsoid.motor_directions, strict=True
    ):
        parts = [*_cells(task, len(ellipsoid.components)), *_cells(motor, len(ellipsoid.motors))]
        rows.append([*start, *parts])
    return Table(columns, rows)


def _cells(direction: Vector | None, count: int) -> list[str]:
    if direction is None:
        return ["-"] * count
    return ["0" if abs(x) < 5e-4 else f"{x:.3f}" for x in direction]


def _in_words(ellipsoid: Ellipsoid, width: int) -> Table:
    """Directions as sums over their components, in lines of a width."""
    task_units = ", ".join(dict.fromkeys(ellipsoid.units))
    motor_units = ", ".join(dict.fromkeys(ellipsoid.motor_units))
    columns = [
        *_HEAD,
        Column(f"direction\n{task_units}", fold=True),
        Column(f"motors\n{motor_units}", fold=True),
    ]
    rows = [
        [
            *start,
            "-" if task is None else combination(task, ellipsoid.components, width),
            "-" if motor is None else combination(motor, ellipsoid.motors, width),
        ]
        for start, task, motor in zip(
            _values(ellipsoid), ellipsoid.task_directions, ellipsoid.motor_directions, strict=True
        )
    ]
    return Table(columns, rows)


def _stacked(ellipsoid: Ellipsoid, width: int) -> Table:
    """The same for narrow terminals: the motors below the direction."""
    units = ", ".join(dict.fromkeys(ellipsoid.units))
    motor_units = ", ".join(dict.fromkeys(ellipsoid.motor_units))
    columns = [*_HEAD, Column(f"direction [{units}]\nby motors [{motor_units}]", fold=True)]
    rows = []
    for start, task, motor in zip(
        _values(ellipsoid), ellipsoid.task_directions, ellipsoid.motor_directions, strict=True
    ):
        lines = ["-" if task is None else combination(task, ellipsoid.components, width)]
        if motor is not None:
            lines.append("by " + combination(motor, ellipsoid.motors, width - 3).replace("\n", "\n   "))
        rows.append([*start, "\n".join(lines)])
    return Table(columns, rows)
