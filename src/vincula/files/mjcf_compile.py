"""MuJoCo's reading of an MJCF document, and its errors told with our places."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import mujoco

from vincula.files.mjcf_document import Document
from vincula.files.mjcf_text import Written, write_bare, write_complete
from vincula.files.mjcf_words import engine_flags, suggestion_for
from vincula.files.problems import Problems

_LINE: Final = re.compile(r"line (\d+)")
_PREFIX: Final = re.compile(r"(?:^|could not parse model file with error: )(?:XML )?Error: (?:Error: )?")
_QUOTED: Final = re.compile(r"'([^']+)'")


def compile_document(document: Document) -> tuple[Any, list[str]]:
    """The compiled model of a document, and MuJoCo's warnings.

    Raises:
        FileError: MuJoCo refuses the document; its first error is told with the place.
    """
    complete, bare = write_complete(document), write_bare(document, engine_flags())
    with _warnings_caught() as caught:
        _spec(document, complete)
        spec = _spec(document, bare)
        try:
            model = spec.compile()
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            _refuse(document, bare, error)
    return model, list(dict.fromkeys(caught))


def _spec(document: Document, written: Written) -> Any:
    files = {name: text.encode("utf-8") for name, text in written.files.items()}
    try:
        return mujoco.MjSpec.from_string(written.text, include=files)
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        _refuse(document, written, error)


@contextmanager
def _warnings_caught() -> Iterator[list[str]]:
    """Collect MuJoCo's warnings, which would be printed and put in a log file in the user's folder."""
    caught: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(caught.append)
    try:
        with warnings.catch_warnings(record=True) as recorded:
            warnings.simplefilter("always")
            yield caught
        caught.extend(str(warning.message) for warning in recorded)
    finally:
        mujoco.set_mju_user_warning(before)


def _refuse(document: Document, written: Written, error: Exception) -> Any:
    """Pass MuJoCo's error on, at the element that its line or a name in it leads to."""
    text = str(error)
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
