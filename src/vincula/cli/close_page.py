"""What `vincula close` says: as a page, and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from vincula.cli.page import Column, Page, Table, number, plural

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.closed import ClosedConfiguration
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.singularities import Singularity

MOST_COLUMNS: Final = 8
"""Joints whose values are shown in the table of modes."""
LONGEST: Final = 400
"""Longest text of a configuration that is shown to be copied."""
NOISE: Final = 1e-12
"""Values below this are shown as 0 [rad, m]; JSON and `--at` texts have them in full."""
REGULAR: Final = 0.5
"""Kantorovich numbers below this prove a regular closed configuration near by."""


def configuration_of(subject: Subject, q: Configuration) -> dict[str, float | list[float]]:
    """The configuration in the units of the file, as `--at` reads it."""
    from vincula.files.configuration_writer import configuration_values

    return configuration_values(q, subject.mechanism, subject.report.units)


def closure_facts(subject: Subject, q: ClosedConfiguration) -> dict[str, Any]:
    """The JSON object: metres and radians, but for `configuration`, which is in the units of the file."""
    units = subject.report.units
    return {
        "schema": "vincula/closure/1",
        "mechanism": subject.mechanism.name,
        "units": {"length": units.length, "angle": units.angle},
        "configuration": configuration_of(subject, q),
        "residual": q.residual,
        "residuals": [
            {"name": r.name, "kind": r.kind, "linear": r.linear, "angular": r.angular, "gap": r.gap}
            for r in q.residuals
        ],
        "iterations": q.iterations,
        "starts": q.attempts,
        "kantorovich": q.kantorovich,
        "branch": {"assembly": q.branch.assembly, "working": q.branch.working},
        "singular": q.singular,
        "singularities": [singularity_facts(s) for s in q.singularities],
        "free_motions": q.free_motions,
        "held": list(q.held),
        "at_limits": list(q.at_limits),
        "moved": q.moved,
    }


def singularity_facts(singularity: Singularity) -> dict[str, Any]:
    """One singularity as JSON."""
    return {
        "kind": singularity.kind,
        "joints": dict(singularity.joints),
        "motors": list(singularity.motors),
        "member": singularity.member,
        "text": str(singularity),
    }


def modes_facts(subject: Subject, modes: Sequence[ClosedConfiguration], starts: int) -> dict[str, Any]:
    """The JSON object of `--modes`."""
    return {
        "schema": "vincula/modes/1",
        "mechanism": subject.mechanism.name,
        "starts": starts,
        "modes": [closure_facts(subject, q) for q in modes],
    }


def closure_page(subject: Subject, q: ClosedConfiguration) -> Page:
    """The page of one closed configuration."""
    page = Page()
    page.heading(subject.mechanism.name, "closed")
    page.facts(_facts(q, named=subject.mechanism.reference is not None))
    for singularity in q.singularities:
        page.sentence(str(singularity), mark="!")
    page.heading("Values", "m, rad")
    page.table(_values(subject, q))
    page.heading("To use it")
    text = _quoted(subject, q)
    page.sentence(
        f"--at {text}" if len(text) < LONGEST else "-o FILE.json writes it, --at FILE.json reads it"
    )
    return page


def _facts(q: ClosedConfiguration, *, named: bool) -> list[tuple[str, str]]:
    """Label and text; branches and two of three kinds of singularity need a reference member."""
    missing = "--reference BODY tells"
    proof = "proved" if q.kantorovich < REGULAR else "not proved"
    facts = [
        ("residual", f"{number(q.residual, 2)} m (angles times the characteristic length)"),
        ("found in", f"{plural(q.iterations, 'iteration')} from {plural(q.attempts, 'start')}"),
        ("regular solution", f"{proof}: Kantorovich number {number(q.kantorovich, 2)}"),
        ("branch", str(q.branch) if named else missing),
        ("singular", "yes" if q.singular else "no" if named else f"the loops are not; {missing} the rest"),
        ("free motions left", str(q.free_motions)),
    ]
    if q.at_limits:
        facts.append(("on a limit", ", ".join(q.at_limits)))
    return facts


def _values(subject: Subject, q: ClosedConfiguration) -> Table:
    """Every joint with its values before and after."""
    mechanism, start = subject.mechanism, subject.configuration
    rows = []
    for joint in mechanism.all_joints:
        if joint.name not in q or len(q[joint.name]) == 0:
            continue
        axes = mechanism.type_of(joint).axis_names(joint.name)
        roles = [role for role, names in (("motor", mechanism.active), ("locked", mechanism.lock))
                 if set(names).intersection(axes)]  # fmt: skip
        roles += ["held"] if set(q.held).intersection((joint.name, *axes)) else []
        rows.append([joint.name, _listed(start[joint.name]), _listed(q[joint.name]), ", ".join(roles)])
    return Table(
        [Column("joint", fold=True), Column("start", "right"), Column("closed", "right"), Column("")], rows
    )


def _listed(values: Sequence[float] | Any) -> str:
    """Values with noise of rounding shown as what it is."""
    return " ".join(number(0.0 if abs(float(value)) < NOISE else float(value)) for value in values)


def _quoted(subject: Subject, q: Configuration) -> str:
    from vincula.files.configuration_writer import configuration_text

    text = configuration_text(configuration_of(subject, q))
    return f"'{text}'"


def modes_page(subject: Subject, modes: Sequence[ClosedConfiguration], starts: int) -> Page:
    """The page of `--modes`: a row a mode."""
    page = Page()
    count = plural(len(modes), "assembly mode")
    page.heading(subject.mechanism.name, f"{count} from {plural(starts, 'start')}")
    names = [n for n, v in modes[0].items() if len(v) == 1] if modes else []
    names = names[:MOST_COLUMNS]
    columns = [Column("mode", "right"), Column("branch", fold=True), *(Column(n, "right") for n in names)]
    rows = [
        [str(k), str(q.branch), *(number(float(q[name][0])) for name in names)]
        for k, q in enumerate(modes, start=1)
    ]
    page.table(Table(columns, rows))
    page.sentence("More starts may find more; --json has every joint value.")
    return page
