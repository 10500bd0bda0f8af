"""The page of `vincula analyze`: words first, then the numbers with their units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.cli.page import Column, Page, Table, combination, number, point
from vincula.errors import listing

if TYPE_CHECKING:
    from vincula.analysis.ellipsoid import Ellipsoid
    from vincula.analysis.maps import LinearMap
    from vincula.analysis.result import Analysis
    from vincula.arrays import Vector
    from vincula.labels import Column as LabelledColumn
    from vincula.model import LinearModel

SUMMARY: Final = {
    "mobility": "independent motions of the whole mechanism",
    "coordinated": "motions of the member that the motors drive",
    "redundancy": "motions of the motors that leave the member at rest",
    "indeterminacy": "motions of the member with all motors locked",
    "passive_redundancy": "motions of passive joints alone",
    "internal_torques": "ways to squeeze: motor torques without a load on the member",
    "structural_wrenches": "loads on the member that need no motor torque",
    "static_indeterminacy": "constraint forces that neither load nor torque determines",
}

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


def analysis_page(analysis: Analysis) -> Page:
    """The page for an analysis."""
    model = analysis.model
    page = Page()
    page.heading(model.mechanism, "at one configuration")
    page.facts(_subject(analysis))
    page.heading("In words")
    for verdict in analysis.verdicts:
        page.sentence(verdict, "-")
    for warning in analysis.warnings:
        page.sentence(warning, "warning:")
    for note in model.notes:
        page.sentence(note, "note:")
    _counts(page, model)
    for ellipsoid in analysis.ellipsoids:
        _ellipsoid(page, ellipsoid, analysis)
    rates, torques = analysis.twist_from_rates, analysis.torque_from_wrench
    _map(page, "Motor rates to twist", "twist of the member per unit rate", rates, by_column=True)
    _map(page, "Load to motor torques", "torque that balances a unit load", torques)
    page.heading("Rank")
    page.sentence(_rank_line(analysis))
    return page


def _subject(analysis: Analysis) -> list[tuple[str, str]]:
    model = analysis.model
    cuts = [f"{cut.joint} ({cut.kind}) at {point(cut.at)}" for cut in model.cuts]
    return [
        ("reference member", f"{model.reference} [m]; twist and wrench in {model.frame}"),
        ("motors", _names(model.motors)),
        ("passive axes", _names(model.passives)),
        ("constraints", f"{len(model.rows)} rows" + (f"; joints cut: {listing(cuts, 6)}" if cuts else "")),
        ("weights", _weights(analysis)),
        ("convention", "as printed in the paper" if analysis.convention == "printed" else ""),
    ]


def _names(columns: Sequence[LabelledColumn]) -> str:
    return f"{len(columns)}: {listing((c.name for c in columns), 24)}" if columns else "none"


def _weights(analysis: Analysis) -> str:
    """The weights that are not one, or that all are."""
    kinematic, force = analysis.kinematic, analysis.passive_force
    sides = {
        "twist": kinematic.task_weight,
        "rate": kinematic.motor_weight,
        "wrench": force.task_weight,
        "torque": force.motor_weight,
    }
    said = []
    for name, metric in sides.items():
        diagonal = metric.diagonal
        if diagonal is None:
            said.append(f"{name} by a matrix")
        elif not np.all(diagonal == 1.0):
            said.append(f"{name} {', '.join(number(w, 4) for w in diagonal)}")
    return "; ".join(said) + "; others 1" if said else "all 1 (in m, rad, N, N m)"


def _counts(page: Page, model: LinearModel) -> None:
    page.heading("Mobility and statics")
    summary = model.ledger.summary.as_dict()
    page.table(
        Table(
            [Column("number"), Column("", "right"), Column("counts", fold=True)],
            [[name.replace("_", " "), str(summary[name]), meaning] for name, meaning in SUMMARY.items()],
        )
    )
    twelve = model.ledger.counts.as_dict()
    page.sentence("  ".join(f"{name} {value}" for name, value in twelve.items()), "twelve counts:")


def _ellipsoid(page: Page, ellipsoid: Ellipsoid, analysis: Analysis) -> None:
    page.heading(f"{ellipsoid.kind.capitalize()} ellipsoid", READINGS[ellipsoid.kind][ellipsoid.viewpoint])
    if not ellipsoid.classes:
        page.sentence("none: there is no such force" if "force" in ellipsoid.kind else "none")
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


def _map(page: Page, title: str, note: str, found: LinearMap, *, by_column: bool = False) -> None:
    """A map with a row a motor, whichever way it maps, so that it never gets wide."""
    page.heading(title, note)
    if found.matrix is None:
        page.sentence(f"undefined: {found.reason}")
        return
    if not found.matrix.size:
        page.sentence("there are no motors")
        return
    if by_column:
        matrix, motors, units = found.matrix.T, found.columns, found.column_units
        names, name_units = found.rows, found.row_units
    else:
        matrix, motors, units = found.matrix, found.rows, found.row_units
        names, name_units = found.columns, found.column_units
    heads = [f"{name}\n{unit}" for name, unit in zip(names, name_units, strict=True)]
    columns = [Column("motor"), *(Column(head, "right") for head in heads)]
    scale = float(np.abs(matrix).max())
    rows = [
        [f"{motor} [{unit}]", *("0" if abs(x) <= 1e-12 * scale else number(x, 4) for x in row)]
        for motor, unit, row in zip(motors, units, matrix, strict=True)
    ]
    page.table(Table(columns, rows))
    if found.note:
        page.sentence(found.note)


def _rank_line(analysis: Analysis) -> str:
    ledger = analysis.ledger
    residual = f"closure residual {number(analysis.model.uncertainty.residual, 2)} m"
    if ledger.status != "certain":
        return f"{ledger.status}: see the warnings; {residual}"
    full = ledger.decision("all")
    return (
        f"{ledger.status}: the smallest singular value of all constraints that counts is "
        f"{number(full.kept, 3)}, the largest taken as zero {number(full.dropped, 2)}, "
        f"the limit {number(full.cutoff, 2)}; {residual}"
    )
