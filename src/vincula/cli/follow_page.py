"""What `vincula follow` says: as a page, and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from vincula.cli.close_page import MOST_COLUMNS, configuration_of, singularity_facts
from vincula.cli.page import Column, Page, Table, number, plural

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.paths import Path, PathEvent

THROUGH: Final = {
    "platform": "platform free",
    "authority": "motors without authority",
    "internal": "internal",
}
"""Words of `--through` and the kinds of singularity that they mean."""
ROWS: Final = 12
"""Configurations shown on the page; --csv and --json have all of them."""


def path_facts(subject: Subject, path: Path) -> dict[str, Any]:
    """The JSON object: metres and radians, but for configurations, which are in the units of the file."""
    from vincula.cli.follow_efficiencies import axes_along

    units = subject.report.units
    return {
        "schema": "vincula/path/1",
        "mechanism": subject.mechanism.name,
        "units": {"length": units.length, "angle": units.angle},
        "held": list(path.held),
        "complete": path.complete,
        "length": path.length,
        "steps": path.steps,
        "residual": path.residual,
        "stopped": None if path.stopped is None else _event_facts(subject, path.stopped),
        "passed": [_event_facts(subject, event) for event in path.passed],
        "points": [
            {
                "parameter": point.parameter,
                "configuration": configuration_of(subject, point.configuration),
                "residual": point.residual,
                "margin": _finite(point.margin),
                "efficiencies": [axis.efficiency for axis in axes],
                "motor_directions": [axis.motors for axis in axes],
                "task_directions": [axis.task for axis in axes],
            }
            for point, axes in zip(path.points, axes_along(subject, path), strict=True)
        ],
        "frames": [
            {name: {"position": at, "rotation": turn} for name, (at, turn) in frame.items()}
            for frame in path.frames()
        ],
    }


def _event_facts(subject: Subject, event: PathEvent) -> dict[str, Any]:
    return {
        "kind": event.kind,
        "parameter": event.parameter,
        "configuration": configuration_of(subject, event.configuration),
        "singularities": [singularity_facts(s) for s in event.singularities],
        "joints": list(event.joints),
        "axis": event.axis or None,
        "limit": _finite(event.limit),
        "reason": event.reason,
        "passable": event.passable,
    }


def _finite(value: float) -> float | None:
    return value if abs(value) < float("inf") else None


def path_page(subject: Subject, path: Path) -> Page:
    """The page: what came of it, and some of the configurations."""
    page = Page()
    page.heading(subject.mechanism.name, "followed to the end" if path.complete else "stopped")
    page.facts(_facts(path))
    for event in path.passed:
        page.sentence(f"passed at {number(event.parameter)}: {event.reason}")
    if path.stopped is not None:
        page.sentence(path.stopped.reason, mark="!")
        if path.stopped.kind == "singularity":
            page.sentence(_beyond(path.stopped))
    page.heading("Configurations", "m, rad; parameter: distance travelled by what is held")
    page.table(_table(path))
    return page


def _beyond(event: PathEvent) -> str:
    """Whether the path goes on beyond a singularity, and how to follow it there."""
    if not event.passable:
        return "It cannot be passed: what is held would have to turn back here."
    words = [word for word, kind in THROUGH.items() if kind in {s.kind for s in event.singularities}]
    return f"The path goes on beyond it: --through {' --through '.join(words)} passes it."


def _facts(path: Path) -> list[tuple[str, str]]:
    share = 100.0 * path.points[-1].parameter / path.length if path.length else 100.0
    return [
        ("held", ", ".join(path.held)),
        ("followed", f"{number(share, 4)} % in {plural(path.steps, 'step')}"),
        ("recorded", plural(len(path), "configuration")),
        ("largest residual", f"{number(path.residual, 2)} m"),
        ("smallest margin", f"{number(min(p.margin for p in path.points), 3)} (0: singular)"),
    ]


def _table(path: Path) -> Table:
    """Evenly chosen rows, the first and the last among them."""
    names = [name for name, value in path.end.items() if len(value) == 1][:MOST_COLUMNS]
    count = len(path.points)
    shown = min(count, ROWS)
    rows = [round(k * (count - 1) / max(shown - 1, 1)) for k in range(shown)]
    columns = [Column("parameter", "right"), *(Column(n, "right") for n in names), Column("margin", "right")]
    return Table(
        columns,
        [
            [
                number(path.points[k].parameter),
                *(number(float(path[k][name][0])) for name in names),
                number(path.points[k].margin, 3),
            ]
            for k in rows
        ],
    )
