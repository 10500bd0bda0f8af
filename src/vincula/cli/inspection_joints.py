"""The table of joints and contacts on the page of `vincula inspect`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from vincula.cli.page import Column, Page, Table, number, plural

WIDTHS: Final = (10_000, 28, 20, 14, 10, 7)
"""Lengths to which names of bodies are shortened in turn, until the table fits the terminal."""

Facts = Mapping[str, Any]


def connections(page: Page, facts: Facts, most: int, *, everything: bool) -> None:
    """Joints and contacts in one table; fixed joints only where there is nothing else.

    Args:
        page: Where to put it.
        facts: The object of `inspection`.
        most: Rows before the rest is only counted.
        everything: Never shorten a name.
    """
    joints = [joint for joint in facts["joints"] if joint["type"] != "fixed"] or facts["joints"]
    moved = any(value for joint in joints for value in joint["values"] if _has_scalars(joint))
    rows = [(j["name"], j["type"], j["between"], _values(j), _roles(j)) for j in joints]
    rows += [(c["name"], c["type"], c["between"], "", "contact") for c in facts["contacts"]]
    if not rows:
        return
    title = "Joints and contacts" if facts["contacts"] else "Joints"
    page.heading(title, "" if moved or not joints else "every joint value is 0")
    widths = WIDTHS[:1] if everything else WIDTHS
    page.table(*(_table(rows[:most], width, moved, fold=everything) for width in widths))
    left_out, fixed = len(rows) - len(rows[:most]), len(facts["joints"]) - len(joints)
    more = [f"{left_out} more (--all shows them)"] if left_out else []
    more += [f"{plural(fixed, 'fixed joint')} not listed"] if fixed else []
    if more:
        page.sentence("; ".join(more))


def shortened(name: str, most: int) -> str:
    """A name of at most `most` characters; its middle is left out, ends tell names apart."""
    if len(name) <= most:
        return name
    tail = (most - 1) // 2
    return f"{name[: most - 1 - tail]}…{name[len(name) - tail :]}"


def _table(
    rows: Sequence[tuple[str, str, Sequence[str], str, str]], width: int, moved: bool, *, fold: bool
) -> Table:
    columns = [Column("name"), Column("type"), Column("connects", fold=fold)]
    columns += [Column("value", justify="right")] if moved else []
    columns += [Column("role", fold=True)]
    texts = []
    for name, kind, between, value, role in rows:
        connects = " - ".join(shortened(body, width) for body in between)
        texts.append([name, kind, connects, *([value] if moved else []), role])
    return Table(columns, texts)


def _has_scalars(joint: Facts) -> bool:
    return len(joint["values"]) == len(joint["axes"])


def _values(joint: Facts) -> str:
    if joint["closes_loop"]:
        return ""
    values, axes = joint["values"], joint["axes"]
    if _has_scalars(joint):
        return ", ".join(
            f"{number(value, 4)} {axis['unit']}" for value, axis in zip(values, axes, strict=True)
        )
    return "pose" if len(values) == 7 else f"({', '.join(number(value, 3) for value in values)})"


def _roles(joint: Facts) -> str:
    if not joint["axes"]:
        return "closes a loop" if joint["closes_loop"] else "rigid"
    states = [axis["state"] for axis in joint["axes"]]
    if len(set(states)) <= 1:
        return str(states[0])
    return ", ".join(f"{axis['name']} {axis['state']}" for axis in joint["axes"])
