"""The page of `vincula place`: ranked choices, what fails and why, the Pareto front, why the best is best."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from vincula.analysis.ranking import CRITERIA
from vincula.cli.page import INDENT, Column, Page, Table, number, plural
from vincula.design.placement_words import how_looked

if TYPE_CHECKING:
    from vincula.design.motor_choice import MotorChoice
    from vincula.design.placement import Placement

SHOWN: Final = 40
"""Choices that the table shows when nothing is said."""
TOLD: Final = 12
"""Choices whose failure is told in words when nothing is said."""
MOTIONS: Final = 2
"""Motions that are told of a choice that leaves several, unless all choices are shown."""
NAMES_ROOM: Final = 26
"""Width of the motors' names below which other columns are left out instead."""
GAP: Final = 3
"""Blanks between two columns."""
LEAST: Final = 3
"""Columns that are never left out."""


def page_of(placement: Placement, show: int | None) -> Page:
    """What the command prints.

    Args:
        placement: The ranking.
        show: Choices in the table and failures told; 0 for all, None for what is usual.
    """
    model, several = placement.looked.models[0], len(placement.looked.models) > 1
    page = Page()
    sizes = placement.admissible.sizes
    motors = plural(sizes[0], "motor") if len(sizes) == 1 else f"{sizes[0]} to {sizes[-1]} motors"
    page.heading(model.mechanism, f"{motors} for {model.reference}, {model.frame}")
    where = f", on {placement.on} components" if placement.rank_by in _INDICES else ""
    worst = " (worst over the configurations)" if several else ""
    page.sentence(f"{how_looked(placement)}, best first by {CRITERIA[placement.rank_by]}{where}{worst}.")
    if several or placement.looked.left_out:
        page.sentence(_judged_at(placement))
    count = len(placement.choices)
    shown = placement.choices[: {None: SHOWN, 0: count}.get(show, show)]
    page.table(_table(placement, shown, several, page.width - INDENT))
    if placement.front:
        page.sentence("* on the Pareto front of " + ", ".join(placement.front_criteria) + ".")
    if len(shown) < count:
        page.sentence(f"{count - len(shown)} more behind these: --show 0 shows all, --json holds all.")
    _failures(page, placement, {None: TOLD, 0: count}.get(show, show or 0), show == 0)
    page.heading("Why")
    for text in placement.explanation:
        page.sentence(text)
    return page


_INDICES: Final = ("yoshikawa", "inverse-condition", "isotropy", "smallest-singular-value")


def _judged_at(placement: Placement) -> str:
    looked = placement.looked
    text = f"Judged at {plural(len(looked.models), 'configuration')}."
    if looked.left_out:
        first, reason = looked.left_out[0]
        text += (
            f" {plural(len(looked.left_out), 'point')} of the sweep left out; "
            f"the first is number {first + 1}: {reason}"
        )
    return text


@dataclass(frozen=True, slots=True)
class _Entry:
    """A column that can be left out: heading, how it is filled, how long it is kept (larger is longer)."""

    title: str
    cell: Callable[[MotorChoice], str]
    keep: int


def _entries(placement: Placement, several: bool) -> list[_Entry]:
    """The columns behind the motors."""
    shown = {"kinematic": "kine-\nmatic", "active-force": "active\nforce", "passive-force": "passive\nforce"}
    own = placement.rank_by
    found = []
    if own not in shown or several:
        title = shown.get(own, own.replace("-", "-\n", 1) if "-" in own else own)
        found.append(_Entry(f"{title}\nworst" if several else title, lambda c: _short(c.index), 9))
        if several:
            found.append(_Entry("mean", lambda c: _short(c.mean), 8))
    for name, title in shown.items():
        if name != own or not several:
            keep = 9 if name == own else {"kinematic": 5, "active-force": 6, "passive-force": 3}[name]
            found.append(_Entry(title, _worst(name), keep))
    found.append(_Entry("redun-\ndancy", lambda c: str(c.largest("redundancy")), 2))
    found.append(_Entry("inter-\nnal", lambda c: str(c.largest("internal_torques")), 4))
    asked = any(value != 1.0 for value in placement.admissible.cost.values())
    found.append(_Entry("cost", lambda c: number(c.cost), 7 if asked else 1))
    found.append(_Entry("controls", _controls, 10))
    return found


def _table(placement: Placement, shown: Sequence[MotorChoice], several: bool, room: int) -> Table:
    """The table; columns are left out from the least important one until the motors' names have room."""
    front = {id(choice) for choice in placement.front}
    places = [f"{place}{'*' if id(choice) in front else ' '}" for place, choice in enumerate(shown, start=1)]
    names = [", ".join(choice.motors) for choice in shown]
    entries = _entries(placement, several)
    wanted = min(NAMES_ROOM, max(map(len, names), default=0))

    def width(entry: _Entry) -> int:
        return max(len(line) for line in [*entry.title.split("\n"), *(entry.cell(c) for c in shown)])

    widths = {entry.title: width(entry) for entry in entries}
    room -= max(map(len, places), default=0) + GAP
    while room - sum(widths[e.title] + GAP for e in entries) < wanted and len(entries) > LEAST:
        entries.remove(min(entries, key=lambda entry: entry.keep))
    columns = [Column("", "right"), Column("motors", fold=True)]
    columns += [Column(e.title, "left" if e.title == "controls" else "right") for e in entries]
    rows = [
        [place, name, *(entry.cell(choice) for entry in entries)]
        for place, name, choice in zip(places, names, shown, strict=True)
    ]
    return Table(columns, rows)


def _controls(choice: MotorChoice) -> str:
    doubt = ", doubtful" if choice.doubtful_at else ""
    if choice.controls:
        return f"yes{doubt}"
    loose = choice.largest("indeterminacy")
    return f"{loose} loose{doubt}"


def _worst(criterion: str) -> Callable[[MotorChoice], str]:
    return lambda choice: _short(choice.indices[criterion].worst)


def _short(value: float | None) -> str:
    return "-" if value is None else number(value, 4)


def _failures(page: Page, placement: Placement, most: int, at_length: bool) -> None:
    """Words for the choices that stand behind: those without the number, those that leave motions."""
    ranked = list(enumerate(placement.choices, start=1))
    without = [(place, choice) for place, choice in ranked if choice.controls and choice.reason]
    loose = [(place, choice) for place, choice in ranked if not choice.controls]
    for heading, group in (
        (f"{plural(len(without), 'choice')} without a number to rank by", without),
        (f"{plural(len(loose), 'choice')} that cannot control the member", loose),
    ):
        if not group:
            continue
        page.heading("Behind", heading)
        for place, choice in group[:most]:
            page.sentence(f"{place} {', '.join(choice.motors)}: {_because(choice, at_length)}")
        if len(group) > most:
            page.sentence(f"{len(group) - most} more: --show 0 tells all, --json the reason of each.")


def _because(choice: MotorChoice, at_length: bool) -> str:
    """Why a choice stands behind: the motions that are left, the rest of many only counted."""
    why = choice.why
    if not why:
        return f"{choice.reason}."
    most = len(why) if at_length or len(why) <= MOTIONS + 1 else MOTIONS
    more = f" And {len(why) - most} more motions." if len(why) > most else ""
    where = f"{choice.reason}. " if len(choice.counts) > 1 else ""
    return where + " ".join(why[:most]) + more
