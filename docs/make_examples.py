"""Write the pages of the examples and the figures of the documentation.

    python docs/make_examples.py          all pages and figures
    python docs/make_examples.py delta    one example

Everything on a page comes from the catalog and from `analyze`, so a page cannot say what the library
does not.  A test compares the committed pages with what this script would write now.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import vincula as vc
from vincula.analysis.result import Analysis
from vincula.mechanism.catalog.entry import Entry
from vincula.mechanism.catalog.registry import examples
from vincula.mechanism.mechanism import Mechanism
from vincula.view.plot import plot_comparison, plot_mechanism, save_figure

DOCS = Path(__file__).resolve().parent
PAGES = DOCS / "examples"
FIGURES = DOCS / "figures"

SUMMARY = {
    "mobility": "mobility",
    "passive_redundancy": "passive redundancy",
    "redundancy": "redundancy",
    "indeterminacy": "indeterminacy",
    "coordinated": "coordinated motions",
    "internal_torques": "internal torques",
    "structural_wrenches": "structural wrenches",
    "static_indeterminacy": "static indeterminacy",
}
ELLIPSOIDS = {
    "kinematic": "kinematic (KME)",
    "active_force": "active force (AFME)",
    "passive_force": "passive force (PFME)",
    "internal_force": "internal force",
    "dual_force": "dual force (OWFME)",
}
WIDTH = 7.0
"""Width of a figure [inch]: planar panels side by side, as in the README."""

EFFICIENCIES = (
    "Efficiencies: squares of the semi-axes, task size squared per motor effort squared, in m, rad, N, N m. "
    "Infinite and zero ones are explained under [concepts](../concepts.md)."
)
MORE_FIGURES = {
    "five-bar": "![Three choices of motors side by side](../figures/five-bar-motors.svg)",
}


def page(entry: Entry) -> str:
    """The page of one example, in Markdown."""
    mechanism = entry.mechanism({})
    analysis = vc.analyze(mechanism.linearize())
    blocks = [
        f"# {entry.title}",
        f"`example:{entry.name}`",
        entry.description,
        f"Source: {entry.reference}.",
        f"![{entry.title}, with its ellipsoids at the reference point](../figures/{entry.name}.svg)",
        *_parts(mechanism, analysis),
        *_parameters(entry),
        *_mobility(analysis),
        *_ellipsoids(analysis),
        *([MORE_FIGURES[entry.name]] if entry.name in MORE_FIGURES else []),
        *_use(entry),
    ]
    return "\n\n".join(blocks) + "\n"


def index() -> str:
    """The list of examples, in Markdown."""
    lines = [f"| [{entry.name}]({entry.name}.md) | {entry.title} |" for entry in examples()]
    table = "\n".join(["| example | what it is |", "|---|---|", *lines])
    intro = (
        "Mechanisms that come with vincula. Write `example:NAME` wherever a command takes a file, or "
        '`vincula.load("example:NAME")` in Python. These pages are written by `docs/make_examples.py`.'
    )
    return f"# Examples\n\n{intro}\n\n{table}\n"


def _parts(mechanism: Mechanism, analysis: Analysis) -> list[str]:
    found = analysis.to_dict()
    joints = Counter(joint.type for joint in mechanism.joints)
    contacts = Counter(contact.type for contact in mechanism.contacts)
    rows = [
        ("space", mechanism.space.name),
        ("moving bodies", str(len(mechanism.bodies))),
        ("joints", _counted(joints)),
        ("contacts", _counted(contacts)),
        ("motors", ", ".join(found["active"]) or "none"),
        ("passive joint axes", ", ".join(_joined(mechanism, found["passive"])) or "none"),
        ("reference member", f"{found['reference']}, {found['frame']}"),
    ]
    return ["\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows)])]


def _joined(mechanism: Mechanism, axes: list[str]) -> list[str]:
    """Axes by name, those of joints that are passive altogether by the name of the joint."""
    names: dict[str, None] = {}
    for joint in mechanism.joints:
        own = mechanism.type_of(joint).axis_names(joint.name)
        whole = bool(own) and set(own) <= set(axes)
        names |= dict.fromkeys([joint.name] if whole else [axis for axis in own if axis in axes])
    return list(names)


def _counted(kinds: Counter[str]) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none"


def _parameters(entry: Entry) -> list[str]:
    if not entry.parameters:
        return []
    rows = [f"| `{p.name}` | {p.default} | {p.meaning} |" for p in entry.parameters]
    return [
        "## Parameters",
        f"Change one with `--set {entry.parameters[0].name}=VALUE`.",
        "\n".join(["| name | default | what it is |", "|---|---|---|", *rows]),
    ]


def _mobility(analysis: Analysis) -> list[str]:
    mobility = analysis.to_dict()["mobility"]
    summary = [f"| {words} | {mobility['summary'][key]} |" for key, words in SUMMARY.items()]
    counts = ", ".join(f"{name} = {count}" for name, count in mobility["counts"].items() if count)
    return [
        "## What can move, and what carries load",
        "\n".join(f"- {verdict}" for verdict in mobility["verdicts"]),
        "\n".join(["| | |", "|---|---|", *summary]),
        f"Counts that are not zero: {counts}.",
    ]


def _ellipsoids(analysis: Analysis) -> list[str]:
    found = analysis.to_dict()
    rows = [f"| {words} | {_efficiencies(found[key]['efficiencies'])} |" for key, words in ELLIPSOIDS.items()]
    return [
        "## Ellipsoids",
        EFFICIENCIES,
        "\n".join(["| ellipsoid | efficiencies |", "|---|---|", *rows]),
    ]


def _efficiencies(values: list[float | str]) -> str:
    return ", ".join(value if isinstance(value, str) else f"{value:.4g}" for value in values) or "none"


def _use(entry: Entry) -> list[str]:
    shell = "\n".join(
        [
            "```sh",
            f"vincula analyze example:{entry.name}",
            f"vincula plot example:{entry.name} -o {entry.name}.svg",
            "```",
        ]
    )
    python = "\n".join(
        [
            "```python",
            "import vincula as vc",
            "",
            f'print(vc.analyze(vc.load("example:{entry.name}").linearize()))',
            "```",
        ]
    )
    return ["## Try it", shell, python]


def write_figures(entry: Entry) -> None:
    """The figure of one example; for the five-bar also the three choices of motors side by side."""
    mechanism = entry.mechanism({})
    save_figure(plot_mechanism(mechanism, width=WIDTH), FIGURES / f"{entry.name}.svg")
    if entry.name == "five-bar":
        choices = ["o1,o5", "o2,o4", vc.ALL]
        save_figure(plot_comparison(mechanism, choices, width=WIDTH), FIGURES / "five-bar-motors.svg")


def main(names: list[str]) -> None:
    """Write the pages and figures of some examples, or of all."""
    PAGES.mkdir(exist_ok=True)
    FIGURES.mkdir(exist_ok=True)
    for entry in examples():
        if not names or entry.name in names:
            (PAGES / f"{entry.name}.md").write_text(page(entry), encoding="utf-8")
            write_figures(entry)
    (PAGES / "README.md").write_text(index(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
