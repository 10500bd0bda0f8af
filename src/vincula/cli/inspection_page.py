"""The page of `vincula inspect`: what a newcomer wants to know about a file, on one screen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any, Final

from vincula.cli.page import Column, Page, Table, number, plural, point
from vincula.errors import listing

MOST_ROWS: Final = 10
"""Rows for joints and contacts before the rest is only counted; `--all` shows them."""
MOST_LOOPS: Final = 2
"""The same for loops."""
MOST_CHARACTERS: Final = 160
"""A loop is told with its bodies as long as that takes no more characters."""

Facts = Mapping[str, Any]


def inspection_page(facts: Facts, *, everything: bool = False) -> Page:
    """The page for the object of `inspection`.

    Args:
        facts: What is known.
        everything: Show every row of every table.
    """
    page = Page()
    page.heading(facts["mechanism"], f"{facts['space']} mechanism from {facts['file']}")
    page.facts(_summary(facts))
    _connections(page, facts, 10**9 if everything else MOST_ROWS)
    _loops(page, facts, 10**9 if everything else MOST_LOOPS)
    _load(page, facts["load"], everything)
    for note in facts["notes"]:
        page.sentence(note, "note:")
    _next_step(page, facts)
    return page


def _summary(facts: Facts) -> list[tuple[str, str]]:
    kinds = Counter(joint["type"] for joint in facts["joints"])
    axes = [axis for joint in facts["joints"] for axis in joint["axes"]]
    passive = [axis["name"] for axis in axes if axis["state"] == "passive"]
    motors = facts["active"]
    return [
        ("bodies", f"{len(facts['bodies'])} and the ground: {_names(facts['bodies'])}"),
        ("joints", _tally(kinds) or "none"),
        ("contacts", _tally(Counter(contact["type"] for contact in facts["contacts"]))),
        ("couplings", _names(facts["couplings"])),
        ("motors", f"{len(motors)}: {listing(motors, 8)}" if motors else "none"),
        ("passive", f"{len(passive)}: {listing(passive, 8)}" if passive else "none"),
        ("locked", listing(facts["locked"]) if facts["locked"] else ""),
        ("loops", _loop_words(facts)),
        ("mobility", _mobility_words(facts["mobility"])),
        ("reference member", _reference_words(facts)),
        ("sites and frames", _names(facts["frames"])),
        ("configurations", _keyframes(facts)),
    ]


def _keyframes(facts: Facts) -> str:
    names = [f"key:{name}" for name in facts["keyframes"]]
    return f"{listing(names)} (for --at)" if names else ""


def _names(parts: list[dict[str, Any]]) -> str:
    return listing((part["name"] for part in parts), 8) if parts else ""


def _tally(kinds: Counter[str]) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())


def _loop_words(facts: Facts) -> str:
    loops, opened = facts["loops"], facts["closure"]["open"]
    if not loops and not opened:
        return "none: an open chain" if not facts["contacts"] else "none"
    if opened:
        return f"{len(loops)}; {plural(len(opened), 'gap')}: not closed at this configuration (see below)"
    residual = facts["closure"]["residual"]
    return f"{len(loops)}, closed" + (f" to {number(residual, 2)} m" if residual else "")


def _mobility_words(mobility: Facts) -> str:
    if mobility["motions"] is None:
        return f"not known: {mobility['reason']}"
    text = plural(mobility["motions"], "independent motion")
    return text if mobility["status"] == "certain" else f"{text} (doubtful: see vincula analyze)"


def _reference_words(facts: Facts) -> str:
    reference = facts["reference"]
    if reference is None:
        return "none yet"
    return f"{reference['body']}, point {point(reference['point'])} m on it, {reference['axes']} axes"


def _connections(page: Page, facts: Facts, most: int) -> None:
    """Joints and contacts in one table; fixed joints only where there is nothing else."""
    joints = [joint for joint in facts["joints"] if joint["type"] != "fixed"] or facts["joints"]
    rows = [[j["name"], j["type"], " - ".join(j["between"]), _values(j), _roles(j)] for j in joints]
    rows += [[c["name"], c["type"], " - ".join(c["between"]), "", "contact"] for c in facts["contacts"]]
    if not rows:
        return
    page.heading("Joints and contacts" if facts["contacts"] else "Joints")
    columns = [
        Column("name"),
        Column("type"),
        Column("connects", fold=True),
        Column("value", justify="right"),
        Column("role", fold=True),
    ]
    page.table(Table(columns, rows[:most]))
    left_out, fixed = len(rows) - len(rows[:most]), len(facts["joints"]) - len(joints)
    more = [f"{left_out} more (--all shows them)"] if left_out else []
    more += [f"{plural(fixed, 'fixed joint')} not listed"] if fixed else []
    if more:
        page.sentence("; ".join(more))


def _values(joint: Facts) -> str:
    if joint["closes_loop"]:
        return ""
    values, axes = joint["values"], joint["axes"]
    if len(values) == len(axes):
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


def _loops(page: Page, facts: Facts, most: int) -> None:
    loops = facts["loops"]
    if loops:
        page.heading("Loops", "joints and contacts in the order of a walk round")
        for index, loop in enumerate(loops[:most], start=1):
            page.sentence(_walk(loop), f"{index}")
        if len(loops) > most:
            page.sentence(f"{plural(len(loops) - most, 'more loop')} (--all shows them)")
    for gap in facts["closure"]["open"]:
        page.sentence(
            f"{gap['kind']} {gap['name']!r} is open by {_gap(gap)}: more than "
            f"{number(facts['closure']['allowed'], 2)} m counts as open",
            "open:",
        )


def _gap(gap: Facts) -> str:
    parts = [f"{number(gap['linear'], 3)} m"] if gap["linear"] or not gap["angular"] else []
    parts += [f"{number(gap['angular'], 3)} rad"] if gap["angular"] else []
    return " and ".join(parts)


def _walk(loop: Facts) -> str:
    """The loop with its bodies if that is short, else its joints alone."""
    texts = [loop["bodies"][0]]
    for part, body in zip(loop["parts"], [*loop["bodies"][1:], loop["bodies"][0]], strict=True):
        texts.append(f"-{part}- {body}")
    with_bodies = " ".join(texts)
    return with_bodies if len(with_bodies) <= MOST_CHARACTERS else ", ".join(loop["parts"])


def _load(page: Page, load: Facts, everything: bool) -> None:
    """What became of the elements of the file, in one line for what was used and one a reason."""
    if load["format"] == "example":
        return
    page.heading("Read from the file", f"format {load['format']}")
    used = [f"{count['used']} {kind}" for kind, count in load["counts"].items() if count["used"]]
    page.facts(
        [("used", ", ".join(used)), *_reasons(load, everything), *(("note", n) for n in load["notes"])]
    )


def _reasons(load: Facts, everything: bool) -> list[tuple[str, str]]:
    """What was ignored or repaired, and why; equal reasons once."""
    groups: dict[tuple[str, str], dict[str, list[Facts]]] = {}
    for entry in load["entries"]:
        if entry["fate"] != "used":
            kinds = groups.setdefault((entry["fate"], entry["detail"]), {})
            kinds.setdefault(entry["kind"], []).append(entry)
    texts = []
    for (fate, detail), kinds in groups.items():
        said = []
        for kind, entries in kinds.items():
            names = [entry["name"] for entry in entries if entry["name"]]
            shown = f" ({listing(names, 10**6 if everything else 4)})" if names else ""
            said.append(f"{sum(entry['count'] for entry in entries)} {kind}{shown}")
        texts.append((fate, f"{', '.join(said)}: {detail or 'no reason given'}"))
    return texts


def _next_step(page: Page, facts: Facts) -> None:
    if facts["reference"] is not None:
        return
    bodies = [body["name"] for body in facts["bodies"]]
    page.heading("Next", "name the body whose motion and forces you want, the reference member")
    page.sentence(f"vincula analyze {facts['file']} --reference BODY")
    page.sentence(f"BODY is one of {listing(bodies, 8)}")
