"""Exit codes, and which error leads to which; scripts rely on them."""

from __future__ import annotations

from typing import Final

from vincula.errors import (
    ClosureError,
    DesignError,
    DuplicateNameError,
    MissingReferenceError,
    MixedUnitsError,
    ModelError,
    SweepError,
    UnknownNameError,
    VinculaError,
    WeightError,
)

DONE: Final = 0
REFUSED: Final = 1
"""The mechanism cannot be analysed like this: a loop is open, say."""
USAGE: Final = 2
"""Bad usage, a bad file, or a missing extra."""
DOUBTFUL: Final = 3
"""A rank is not decided, and `--strict` was given."""
STORAGE: Final = 4
"""Results cannot be stored or read back."""
FAULT: Final = 70
"""An error that no code foresaw: a fault in vincula, never an answer about the mechanism."""
INTERRUPTED: Final = 130

_WRITTEN_BY_THE_USER = (
    DuplicateNameError,
    MissingReferenceError,
    MixedUnitsError,
    UnknownNameError,
    WeightError,
)


class BadOptionError(VinculaError):
    """Something written on the command line that cannot be used."""


def exit_code(error: VinculaError) -> int:
    """The exit code of an error.

    A name, a weight or an option that cannot be used is bad usage; a mechanism that cannot be
    analysed at this configuration is refused.
    """
    if isinstance(error, _WRITTEN_BY_THE_USER):
        return USAGE
    if isinstance(error, SweepError):
        return {"usage": USAGE, "refused": REFUSED, "storage": STORAGE}[error.kind]
    if isinstance(error, DesignError):
        return {"refused": REFUSED, "storage": STORAGE}[error.kind]
    return REFUSED if isinstance(error, (ClosureError, ModelError)) else USAGE
