"""MuJoCo's own parser and compiler at work on texts: run in a process of its own (see `mjcf_child`)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import mujoco


@dataclass(frozen=True, slots=True)
class Parsed:
    """What MuJoCo made of two versions of a document (see `mjcf_text`).

    Attributes:
        model: The compiled `MjModel`; None when MuJoCo refuses.
        warnings: MuJoCo's warnings, each once.
        error: MuJoCo's words of refusal.
        bare: Whether the bare version is what it refused, not the complete one.
    """

    model: Any = None
    warnings: list[str] = field(default_factory=list)
    error: str = ""
    bare: bool = False


def parse(
    complete: str, complete_files: Mapping[str, str], bare: str, bare_files: Mapping[str, str]
) -> Parsed:
    """Check the complete version against MuJoCo's schema, and compile the bare one.

    Args:
        complete: The complete document.
        complete_files: Texts of the models attached to it, by file name.
        bare: The document as it is compiled.
        bare_files: Texts of the models attached to that.
    """
    checking_bare = False
    with _warnings_caught() as caught:
        try:
            _spec(complete, complete_files)
            checking_bare = True
            model = _spec(bare, bare_files).compile()
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            return Parsed(error=str(error) or type(error).__name__, bare=checking_bare)
    return Parsed(model, list(dict.fromkeys(caught)))


def _spec(text: str, files: Mapping[str, str]) -> Any:
    include = {name: content.encode("utf-8") for name, content in files.items()}
    return mujoco.MjSpec.from_string(text, include=include)


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
