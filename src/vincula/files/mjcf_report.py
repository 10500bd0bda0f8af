"""What becomes of the elements of an MJCF file that are no part of the mechanism graph themselves."""

from __future__ import annotations

from typing import Final

from vincula.files.mjcf_document import Document
from vincula.files.mjcf_text import CHANGING_THE_TREE
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.xmltree import Element

_USED: Final = {
    "compiler": "units and conventions, applied by MuJoCo",
    "option": "its flags decide which equalities and motors are active",
    "default": "class of default values, applied by MuJoCo",
    "frame": "placement of what stands in it, applied by MuJoCo",
    "replicate": "copies of what stands in it, made by MuJoCo",
    "composite": "bodies and joints, made by MuJoCo",
    "attach": "part of another model, attached by MuJoCo",
    "model": "model to attach",
}
_IGNORED: Final = {
    "geom": "shapes are not read; contacts are never inferred from geoms",
    "camera": "no part of a mechanism",
    "light": "no part of a mechanism",
    "inertial": "masses play no part in kinematics and statics",
    "lengthrange": "muscles are not simulated",
}
_SECTIONS: Final = {
    "asset": "meshes and pictures are not read",
    "sensor": "no part of a mechanism",
    "contact": "contacts are never inferred from geoms",
    "custom": "no part of a mechanism",
    "deformable": "soft bodies are no part of a mechanism of rigid bodies",
}
_SETTINGS: Final = {
    "size": "sizes of the simulator's memory",
    "visual": "no part of a mechanism",
    "statistic": "no part of a mechanism",
}


def record_elements(document: Document, report: LoadReport) -> None:
    """Record every element that the compiled model does not name: used by MuJoCo, or ignored and why."""
    for part in document.all_documents():
        for file in part.includes:
            report.used("include", file, "part of the model")
        _record_inside(part.root, report)
        _record_compiler(part, report)


def _record_inside(element: Element, report: LoadReport) -> None:
    for child in element.children:
        if element.parent is None and child.tag in _SECTIONS:
            _record_section(child, report)
        elif element.parent is None and child.tag in _SETTINGS:
            report.ignored("setting", child.tag, _SETTINGS[child.tag])
        elif child.tag == "default":
            _record_default(child, report)
        elif child.tag.startswith("flex") and element.tag == "equality":
            report.ignored("equality", f"{child.tag} {child.name}".strip(), "it is inactive in the file")
        elif element.tag not in ("spatial", "fixed", "composite", "option"):
            if child.tag in _USED:
                report.used(child.tag, child.name, _USED[child.tag])
            elif child.tag in _IGNORED:
                report.ignored(child.tag, child.name, _IGNORED[child.tag])
            _record_inside(child, report)


def _record_section(section: Element, report: LoadReport) -> None:
    for child in section.children:
        if child.tag == "model":
            report.used("model", child.name, _USED["model"])
        else:
            kind = "sensor" if section.tag == "sensor" else child.tag
            report.ignored(kind, child.name, _SECTIONS[section.tag])


def _record_default(element: Element, report: LoadReport) -> None:
    report.used("default", element.attributes.get("class", "main"), _USED["default"])
    for child in element.find_all("default"):
        _record_default(child, report)


def _record_compiler(document: Document, report: LoadReport) -> None:
    for compiler in document.root.find_all("compiler"):
        for attribute, instead in CHANGING_THE_TREE.items():
            if compiler.attributes.get(attribute) == "true":
                report.note(f"compiler {attribute}: {instead}")
    for element in document.root.walk():
        if element.tag in ("joint", "freejoint") and element.attributes.get("align") == "true":
            name = f" of {shown(element.parent.name)}" if element.parent is not None else ""
            report.note(f"align of the free joint{name}: {CHANGING_THE_TREE['alignfree']}")
