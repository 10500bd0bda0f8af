"""The page of `vincula analyze`: words first, then the numbers with their units."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.cli.ellipsoid_tables import add_ellipsoid
from vincula.cli.output import said_warnings
from vincula.cli.page import Column, Page, Table, number, plural, point
from vincula.errors import listing

if TYPE_CHECKING:
    from vincula.analysis.maps import LinearMap
    from vincula.analysis.result import Analysis
    from vincula.cli.subject import Subject
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


def analysis_page(analysis: Analysis, subject: Subject) -> Page:
    """The page for an analysis.

    Args:
        analysis: What is told.
        subject: What was analysed.
    """
    model = analysis.model
    page = Page()
    page.heading(model.mechanism, f"{subject.mechanism.space.name} mechanism from {subject.file}")
    page.facts(_subject(analysis, subject))
    page.heading("In words")
    for verdict in analysis.verdicts:
        page.sentence(verdict, "-")
    for warning in said_warnings([analysis]):
        page.sentence(warning, "warning:")
    for note in model.notes:
        page.sentence(note, "note:")
    if subject.report.notes:
        remarks = plural(len(subject.report.notes), "remark")
        page.sentence(f"the reader made {remarks} on this file: vincula inspect {subject.file}", "note:")
    _counts(page, model)
    for ellipsoid in analysis.ellipsoids:
        add_ellipsoid(page, ellipsoid, analysis)
    rates, torques = analysis.twist_from_rates, analysis.torque_from_wrench
    _map(page, "Motor rates to twist", "twist of the member per unit rate", rates, by_column=True)
    _map(page, "Load to motor torques", "torque that balances a unit load", torques)
    page.heading("Rank")
    page.sentence(_rank_line(analysis))
    if analysis.nearest_singular is not None:
        from vincula.analysis.readings import nearest_words

        page.sentence(nearest_words(analysis.nearest_singular))
    return page


def _subject(analysis: Analysis, subject: Subject) -> list[tuple[str, str]]:
    model = analysis.model
    metres = " m" if model.reference.endswith(")") or "," in model.reference else ""
    home = subject.configuration == subject.mechanism.home
    at = "" if home else listing(_values_away_from_home(subject), 12)
    cuts = [f"{cut.joint} ({cut.kind}) at {point(cut.at)}" for cut in model.cuts]
    return [
        ("reference member", f"{model.reference}{metres}; twist and wrench in {model.frame}"),
        ("configuration", at),
        ("motors", _names(model.motors)),
        ("passive axes", _names(model.passives)),
        ("locked", listing(subject.mechanism.lock, 24) if subject.mechanism.lock else ""),
        ("constraints", f"{len(model.rows)} rows" + (f"; joints cut: {listing(cuts, 6)}" if cuts else "")),
        ("weights", _weights(analysis)),
        ("convention", "as printed in the paper" if analysis.convention == "printed" else ""),
    ]


def _values_away_from_home(subject: Subject) -> Iterator[str]:
    """`joint value` for every joint that is not where the file has it."""
    home = subject.mechanism.home
    for joint, values in subject.configuration.items():
        if not np.array_equal(values, home[joint]):
            yield f"{joint} {point(values) if len(values) > 1 else number(float(values[0]), 4)}"


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
    """The summary numbers (with both readings where ranks are in doubt) and the twelve counts."""
    ledger = model.ledger
    page.heading("Mobility and statics")
    readings = {"": ledger.summary}
    if ledger.status in ("doubtful", "assumed"):
        zero, none_zero = ledger.scenarios
        readings = {"taken as": ledger.summary, "if doubtful\nare zero": zero, "if none\nis zero": none_zero}
    values = [reading.as_dict() for reading in readings.values()]
    columns = [Column("number"), *(Column(title, "right") for title in readings), Column("counts", fold=True)]
    rows = [
        [name.replace("_", " "), *(str(value[name]) for value in values), meaning]
        for name, meaning in SUMMARY.items()
    ]
    # In doubt the two readings matter more than what the names mean.
    brief = [Table(columns[:-1], [row[:-1] for row in rows])] if len(readings) > 1 else []
    page.table(Table(columns, rows), *brief)
    twelve = ledger.counts.as_dict()
    page.sentence("  ".join(f"{name} {value}" for name, value in twelve.items()), "twelve counts:")


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
    if ledger.status in ("doubtful", "assumed"):
        return f"{ledger.status}: see the warnings; {residual}"
    if ledger.status != "certain":
        proved = "proved" if ledger.status == "exact" else "proved from below"
        return f"{ledger.status}: ranks {proved} for {analysis.model.evidence.basis}; {residual}"
    full = ledger.decision("all")
    return (
        f"{ledger.status}: the smallest singular value of all constraints that counts is "
        f"{number(full.kept, 3)}, the largest taken as zero {number(full.dropped, 2)}, "
        f"the limit {number(full.cutoff, 2)}; {residual}"
    )
