"""The one model of an SDF file: alone, or in a world whose other models stand still."""

from __future__ import annotations

from typing import Final

from vincula.errors import listing
from vincula.files.problems import Problems, shown
from vincula.files.report import LoadReport
from vincula.files.xmltree import Element

_BESIDE: Final = ("light", "actor", "state", "road", "population")
"""What may stand beside models, and holds no joints of theirs."""
_OF_THE_WORLD: Final = {
    **dict.fromkeys(("light", "actor", "road", "population", "audio"), "no part of a mechanism"),
    **dict.fromkeys(("gui", "scene", "plugin"), "plugins and pictures are not read"),
    **dict.fromkeys(
        ("physics", "gravity", "magnetic_field", "atmosphere", "wind", "spherical_coordinates"),
        "simulator settings",
    ),
    "state": "a moment of a simulation; the model is read as it is drawn",
    "include": "another model; it is not opened",
    "frame": "frames of the world hold no joint of the model",
}


def only_model(root: Element, problems: Problems, report: LoadReport) -> tuple[Element, list[Element]]:
    """The model to read, and elements that nobody knows.

    A file holds one model, or a world with one; of several models in a world the one that is not
    `<static>` is meant.

    Raises:
        FileError: No model, or several that could be meant.
        UnsupportedFeatureError: A joint between models.
    """
    worlds, models = list(root.find_all("world")), list(root.find_all("model"))
    unknown: list[Element] = []
    holder, known = root, dict.fromkeys(_BESIDE, "no part of a mechanism")
    if len(worlds) == 1 and not models:
        for part in root.children:
            if part.tag in known:
                report.ignored(part.tag, part.name, known[part.tag], of=part)
            elif part.tag != "world":
                unknown.append(part)
        holder, known = worlds[0], _OF_THE_WORLD
    for part in holder.children:
        if part.tag in known:
            report.ignored(part.tag, part.name, known[part.tag], of=part)
        elif part.tag in ("world", "joint", "include"):
            message = f"<{part.tag}> cannot be read in <{holder.tag}>: expected one <model>"
            problems.add(part.place, message, unsupported=True)
        elif part.tag != "model":
            unknown.append(part)
    problems.refuse_if_any()
    return _moving(holder, problems, report), unknown


def _moving(holder: Element, problems: Problems, report: LoadReport) -> Element:
    models = list(holder.find_all("model"))
    moving = [model for model in models if not _is_static(model)]
    if len(models) > 1 and len(moving) == 1:
        for model in models:
            if model is not moving[0]:
                report.ignored("model", model.name, "it is static: a part of the surroundings", of=model)
        return moving[0]
    if len(models) != 1:
        names = f" ({listing([shown(model.name) for model in moving], 6)})" if moving else ""
        got = f"{len(moving or models)} models{names}"
        problems.add(
            holder.place, got=got, expected=f"one <model> in <{holder.tag}>", unsupported=bool(moving)
        )
        problems.refuse()
    return models[0]


def _is_static(model: Element) -> bool:
    return any(part.tag == "static" and part.characters in ("1", "true") for part in model.children)
