"""The page of `vincula place`: ranked choices, what fails and why, the Pareto front, why the best is best."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from vincula.analysis.ranking import CRITERIA
from vincula.cli.page import Column, Page, Table, number, plural
from vincula.design.placement_words import how_looked

if TYPE_CHECKING:
    from vincula.design.motor_choice import MotorChoice, OverConfigurations
    from vincula.design.placement import Placement

MOST_FAILURES: Final = 40
"""Choices whose failure is told in words."""


def page_of(placement: Placement, show: int) -> Page:
    """What the command prints.

    Args:
        placement: The ranking.
        show: Choices in the table; 0 for all.
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
    shown = placement.choices[:show] if show else placement.choices
    page.table(_table(placement, shown, several))
    page.sentence("* on the Pareto front of " + ", ".join(placement.front_criteria) + ".")
    if len(shown) < len(placement.choices):
        rest = len(placement.choices) - len(shown)
        page.sentence(f"{rest} more behind these: --show 0 shows all, --json holds all.")
    _failures(page, placement, show or len(placement.choices))
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


def _table(placement: Placement, shown: Sequence[MotorChoice], several: bool) -> Table:
    columns = [Column("", "right"), Column("motors", fold=True), Column("cost", "right")]
    columns += (
        [Column("worst\nindex", "right"), Column("mean", "right")] if several else [Column("index", "right")]
    )
    columns += [
        Column("kine-\nmatic", "right"),
        Column("active\nforce", "right"),
        Column("passive\nforce", "right"),
        Column("redun-\ndancy", "right"),
        Column("internal\ntorques", "right"),
        Column("controls"),
    ]
    front = {id(choice) for choice in placement.front}
    rows = []
    for place, choice in enumerate(shown, start=1):
        row = [f"{place}{'*' if id(choice) in front else ' '}", ", ".join(choice.motors), number(choice.cost)]
        row += [_short(choice.index), _short(choice.mean)] if several else [_short(choice.index)]
        row += [_worst(choice.indices[name]) for name in ("kinematic", "active-force", "passive-force")]
        row += [str(choice.largest("redundancy")), str(choice.largest("internal_torques"))]
        row.append(_controls(choice))
        rows.append(row)
    return Table(columns, rows)


def _controls(choice: MotorChoice) -> str:
    doubt = ", doubtful" if choice.doubtful_at else ""
    if choice.controls:
        return f"yes{doubt}"
    loose = choice.largest("indeterminacy")
    return f"no, {loose} loose{doubt}"


def _worst(found: OverConfigurations) -> str:
    return _short(found.worst)


def _short(value: float | None) -> str:
    return "-" if value is None else number(value, 4)


def _failures(page: Page, placement: Placement, show: int) -> None:
    """Words for the choices that stand behind."""
    failing = [(place, choice) for place, choice in enumerate(placement.choices, start=1) if choice.reason]
    if not failing:
        return
    able = len(placement.controlling)
    page.heading(
        "Behind", f"{plural(len(placement.choices) - able, 'choice')} that cannot control the member"
    )
    told = failing[: min(show, MOST_FAILURES)]
    for place, choice in told:
        words = " ".join(choice.why) or f"{choice.reason}."
        page.sentence(f"{place} {', '.join(choice.motors)}: {words}")
    if len(told) < len(failing):
        page.sentence(f"{len(failing) - len(told)} more; --json gives the reason of each.")
