"""The page of `vincula inspect`: what a newcomer wants to know about a file, on one screen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any, Final

from vincula.cli.inspection_joints import connections
from vincula.cli.page import Page, few, number, plural, point
from vincula.errors import listing

SCREEN: Final = 40
"""Lines that a page should not exceed; tables and reasons are cut down to it, but notes never."""
MOST_ROWS: Final = 10
"""Rows for joints and contacts before the rest is only counted; `--all` shows them."""
FEWEST_ROWS: Final = 4
MOST_LOOPS: Final = 2
"""The same for loops."""
MOST_NAMES: Final = 3
"""Ignored elements are named up to this many of a kind; `--all` names them all."""
LABELS: Final = 20
"""Columns that the labels of the summary take."""

_WHY: Final = " (--all says why)"
_CONTENTS: Final = ("elements", "attributes", "values")

Facts = Mapping[str, Any]


def inspection_page(facts: Facts, *, everything: bool = False) -> Page:
    """The page for the object of `inspection`.

    Args:
        facts: What is known.
        everything: Show every row of every table, and every name.
    """
    if everything:
        return _page(facts, 10**9, 10**9, everything=True)
    page = _page(facts, MOST_ROWS, MOST_LOOPS)
    for reasons in (True, False):
        if page.height > SCREEN:
            page = _fitted(facts, reasons)
    return page


def _fitted(facts: Facts, reasons: bool) -> Page:
    """A page with one loop and as many rows as fit, of those that are shown at all."""
    page = _page(facts, MOST_ROWS, 1, reasons=reasons)
    over = page.height - SCREEN
    fewest = FEWEST_ROWS if reasons else FEWEST_ROWS // 2
    return page if over <= 0 else _page(facts, max(fewest, MOST_ROWS - over), 1, reasons=reasons)


def _page(facts: Facts, rows: int, loops: int, *, reasons: bool = True, everything: bool = False) -> Page:
    page = Page()
    page.heading(facts["mechanism"], f"{facts['space']} mechanism from {facts['file']}")
    page.facts(_summary(facts, 10**9 if everything else page.width - LABELS))
    connections(page, facts, rows, everything=everything)
    _loops(page, facts, loops, 10**9 if everything else 2 * (page.width - 4))
    _load(page, facts["load"], everything, reasons=reasons)
    for note in facts["notes"]:
        page.sentence(note, "note:")
    _next_step(page, facts)
    return page


def _summary(facts: Facts, line: int) -> list[tuple[str, str]]:
    """Label and text of every fact; lists of names are cut to one line, of motors to two."""
    kinds = Counter(joint["type"] for joint in facts["joints"])
    axes = [axis for joint in facts["joints"] for axis in joint["axes"]]
    passive = [axis["name"] for axis in axes if axis["state"] == "passive"]
    motors = facts["active"]
    return [
        ("bodies", _counted(f"{len(facts['bodies'])} and the ground", _names(facts["bodies"]), line)),
        ("joints", _tally(kinds) or "none"),
        ("contacts", _tally(Counter(contact["type"] for contact in facts["contacts"]))),
        ("couplings", few(_names(facts["couplings"]), line)),
        ("motors", _counted(str(len(motors)), motors, 2 * line) if motors else "none"),
        ("passive", _counted(str(len(passive)), passive, line) if passive else "none"),
        ("locked", few(facts["locked"], line)),
        ("loops", _loop_words(facts)),
        ("mobility", _mobility_words(facts["mobility"])),
        ("reference member", _reference_words(facts)),
        ("sites and frames", few(_names(facts["frames"]), line)),
        ("configurations", _keyframes(facts)),
    ]


def _counted(count: str, names: list[str], line: int) -> str:
    """`3: a, b, c`."""
    return f"{count}: {few(names, line - len(count) - 2)}" if names else count


def _keyframes(facts: Facts) -> str:
    names = [f"key:{name}" for name in facts["keyframes"]]
    return f"{listing(names)} (for --at)" if names else ""


def _names(parts: list[dict[str, Any]]) -> list[str]:
    return [part["name"] for part in parts]


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


def _loops(page: Page, facts: Facts, most: int, room: int) -> None:
    loops, closure = facts["loops"], facts["closure"]
    if loops:
        page.heading("Loops", "joints and contacts in the order of a walk round")
        for index, loop in enumerate(loops[:most], start=1):
            page.sentence(_walk(loop, room), f"{index}")
        if len(loops) > most:
            page.sentence(f"{plural(len(loops) - most, 'more loop')} (--all shows them)")
    gaps = closure["open"]
    if gaps:
        shown = [f"{gap['name']} by {_gap(gap)}" for gap in gaps]
        limit = f"; at most {number(closure['allowed'], 2)} m counts as closed"
        page.sentence(f"{few(shown, max(room - len(limit), 0), separator='; ')}{limit}", "open:")


def _gap(gap: Facts) -> str:
    parts = [f"{number(gap['linear'], 3)} m"] if gap["linear"] or not gap["angular"] else []
    parts += [f"{number(gap['angular'], 3)} rad"] if gap["angular"] else []
    return " and ".join(parts)


def _walk(loop: Facts, room: int) -> str:
    """The loop with its bodies if that is short, else its joints alone."""
    texts = [loop["bodies"][0]]
    for part, body in zip(loop["parts"], [*loop["bodies"][1:], loop["bodies"][0]], strict=True):
        texts.append(f"-{part}- {body}")
    with_bodies = " ".join(texts)
    return with_bodies if len(with_bodies) <= room else few(loop["parts"], room)


def _load(page: Page, load: Facts, everything: bool, *, reasons: bool) -> None:
    """What became of the elements of the file: a line for what was used, and one a reason or one in all."""
    if load["format"] == "example":
        return
    page.heading("Read from the file", f"format {load['format']}")
    used = [f"{count['used']} {kind}" for kind, count in load["counts"].items() if count["used"]]
    page.facts(
        [
            ("used", ", ".join(used)),
            *(_reasons(load, everything) if reasons else _without_reasons(load, 2 * (page.width - LABELS))),
            *(("note", n) for n in load["notes"]),
            ("in all", _contents_words(load["contents"])),
        ]
    )


def _contents_words(contents: Facts) -> str:
    """`157 of 266 elements, 214 of 445 attributes and all 11 values are used; the rest is ignored`."""
    parts = [
        f"all {counts['total']} {kind}" if not counts["ignored"] else
        f"{counts['used'] + counts['repaired']} of {counts['total']} {kind}"
        for kind, counts in sorted(contents.items(), key=lambda item: _CONTENTS.index(item[0]))
        if counts["total"]
    ]  # fmt: skip
    return f"{', '.join(parts)} used" if parts else ""


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
            few_enough = names and (everything or len(names) <= MOST_NAMES)
            shown = f" ({', '.join(names)})" if few_enough else ""
            said.append(f"{sum(entry['count'] for entry in entries)} {kind}{shown}")
        texts.append((fate, f"{', '.join(said)}: {detail or 'no reason given'}"))
    return texts


def _without_reasons(load: Facts, room: int) -> list[tuple[str, str]]:
    """How much was ignored and repaired, most of it first, where reasons would not fit a screen."""
    texts = []
    for fate in ("ignored", "repaired"):
        counted = [(count[fate], kind) for kind, count in load["counts"].items() if count[fate]]
        named = [f"{count} {kind}" for count, kind in sorted(counted, key=lambda pair: -pair[0])]
        if named:
            texts.append((fate, f"{few(named, room - len(_WHY))}{_WHY}"))
    return texts


def _next_step(page: Page, facts: Facts) -> None:
    """The command that a newcomer wants next: a member to name, loops to close."""
    opened, missing = bool(facts["closure"]["open"]), facts["reference"] is None
    if not (opened or missing):
        return
    wanted = ["name the body whose motion and forces you want, the reference member"] if missing else []
    wanted += ["close the loops"] if opened else []
    page.heading("Next", ", and ".join(wanted))
    words = f"{' --reference BODY' if missing else ''}{' --close' if opened else ''}"
    page.sentence(f"vincula analyze {facts['file']}{words}")
