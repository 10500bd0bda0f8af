"""MuJoCo's reading of an MJCF document, and its errors told with our places."""

from __future__ import annotations

import re
from typing import Any, Final, NoReturn

import mujoco

from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.mjcf_child import CHILD, StoppedError
from vincula.files.mjcf_document import Document
from vincula.files.mjcf_parser import Parsed, parse
from vincula.files.mjcf_text import Written, write_bare, write_complete
from vincula.files.mjcf_words import engine_flags, suggestion_for
from vincula.files.problems import Problems
from vincula.files.xmltree import refuse_element

_LINE: Final = re.compile(r"line (\d+)")
_PREFIX: Final = re.compile(r"(?:^|could not parse model file with error: )(?:XML )?Error: (?:Error: )?")
_QUOTED: Final = re.compile(r"'([^']+)'")
_MODEL: Final = "model.mjb"


def compile_document(document: Document, limits: Limits = DEFAULT_LIMITS) -> tuple[Any, list[str]]:
    """The compiled model of a document, and MuJoCo's warnings.

    Raises:
        FileError: MuJoCo refuses the document; its first error is told with the place.  Or it takes too
            long or dies over it.
    """
    complete, bare = write_complete(document), write_bare(document, engine_flags())
    texts = {
        "complete": complete.text,
        "complete_files": complete.files,
        "bare": bare.text,
        "bare_files": bare.files,
    }
    found = _parsed_apart(document, texts, limits) if limits.isolated else parse(**texts)  # type: ignore[arg-type]
    if found.error:
        _refuse(document, bare if found.bare else complete, found.error)
    return found.model, found.warnings


def _parsed_apart(document: Document, texts: dict[str, Any], limits: Limits) -> Parsed:
    """What MuJoCo makes of the texts in a process of its own."""
    try:
        answer = CHILD.ask(texts, limits.seconds)
    except StoppedError as stopped:
        refuse_element(document.root, str(stopped))
    if answer.error:
        return Parsed(error=answer.error, bare=answer.bare)
    model = mujoco.MjModel.from_binary_path(_MODEL, {_MODEL: answer.model})
    return Parsed(model, answer.warnings)


def _refuse(document: Document, written: Written, text: str) -> NoReturn:
    """Pass MuJoCo's error on, at the element that its line or a name in it leads to."""
    found = _LINE.search(text)
    element = written.elements.get(int(found[1])) if found is not None else None
    if element is None:
        quoted = set(_QUOTED.findall(text))
        element = next((e for e in document.root.walk() if e.name in quoted), None)
    first = next((line for line in text.splitlines() if line.strip()), text)
    message = _PREFIX.sub("", first.strip())
    place = (element or document.root).place
    problems = Problems(document.file)
    name, choices = suggestion_for(message, element, document)
    problems.add(place, f"MuJoCo: {message}", name=name, choices=choices)
    problems.refuse()
