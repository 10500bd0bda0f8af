"""The one error tree: every refusal of the library is one of these classes.

Each class carries the data of the refusal (names, values, valid choices) so that callers can act on
it, and a message that names the place, the value, the valid choices and the repair.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Final, Literal

LONGEST_MESSAGE: Final = 20_000
"""Characters of a message that are told; what stands in the middle of a longer one is left out."""
LONGEST_NAME: Final = 200
"""Characters of a name given by the caller that are told, and compared with the names that exist."""


class VinculaError(Exception):
    """Base class of every error that vincula raises on purpose.

    Messages are printable whatever names, files and other libraries put into them: terminals and logs
    are safe from control characters, and from texts without end.
    """

    def __init__(self, message: str = "", *more: object) -> None:
        super().__init__(printable(message) if isinstance(message, str) else message, *more)


class ModelError(VinculaError, ValueError):
    """A mechanism, a matrix, a weight or a name that cannot be used."""


class ShapeError(ModelError):
    """An array has the wrong shape.

    Attributes:
        name: What the array is.
        shape: The shape that was given.
        expected: The shape that was expected, in words or numbers.
    """

    def __init__(self, name: str, shape: Sequence[int], expected: str) -> None:
        self.name, self.shape, self.expected = name, tuple(shape), expected
        super().__init__(f"{name} has shape {tuple(shape)}, expected {expected}")


class NonFiniteError(ModelError):
    """A number is NaN or infinite.

    Attributes:
        name: What holds the number.
        index: Where in the array it is.
        value: The number.
    """

    def __init__(self, name: str, index: tuple[int, ...] = (), value: float = float("nan")) -> None:
        self.name, self.index, self.value = name, index, value
        where = f"{name}[{', '.join(map(str, index))}]" if index else name
        super().__init__(f"{where} is {value}: only finite numbers are allowed")


class WeightError(ModelError):
    """A weight that is not symmetric, not positive (semi)definite, or of the wrong size."""


class TopologyError(ModelError):
    """The graph of bodies and joints is not a mechanism: islands, self-joints, impossible cuts."""


class MissingReferenceError(ModelError):
    """No reference member is named.

    Attributes:
        candidates: Bodies that could be the reference member.
    """

    def __init__(self, candidates: Iterable[str]) -> None:
        self.candidates = tuple(candidates)
        super().__init__(
            "no reference member: name the body whose motion and forces you want, one of "
            + listing(self.candidates)
        )


class UnknownNameError(ModelError):
    """A name that does not exist.

    Attributes:
        kind: What was looked for (joint, body, motor ...).
        name: The text that was given.
        choices: The names that exist.
    """

    def __init__(self, kind: str, name: str, choices: Iterable[str]) -> None:
        self.kind, self.name, self.choices = kind, name, tuple(choices)
        told = name[:LONGEST_NAME] if isinstance(name, str) else name
        near = difflib.get_close_matches(told, self.choices, n=3) if isinstance(told, str) else []
        hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else "."
        cut = "..." if told != name else ""
        super().__init__(f"no {kind} is named {told!r}{cut}{hint} Known: {listing(self.choices)}")


class DuplicateNameError(ModelError):
    """Two things of one kind have the same name.

    Attributes:
        kind: What they are.
        name: The name they share.
    """

    def __init__(self, kind: str, name: str) -> None:
        self.kind, self.name = kind, name
        super().__init__(f"two {_plural(kind)} are named {name!r}: every {kind} needs a name of its own")


class MixedUnitsError(ModelError):
    """An index over metres and radians together was asked for without saying how to weigh them."""


class ClosureError(VinculaError):
    """Loops are open, or cannot be closed.

    Attributes:
        loop: Name of the loop or contact with the largest gap.
        gap: Its residual, metres (angles multiplied by the characteristic length).
        details: Further data, by name: gaps of every loop, best configuration, lengths.
    """

    def __init__(self, message: str, *, loop: str = "", gap: float = float("nan"), **details: object) -> None:
        self.loop, self.gap, self.details = loop, gap, details
        super().__init__(message)


class FileError(VinculaError):
    """A file cannot be read or written.

    Attributes:
        problems: Every independent problem found, as printable texts `file:line:col: ...`.
    """

    def __init__(self, message: str, problems: Sequence[str] = ()) -> None:
        super().__init__(message)
        self.problems = tuple(map(printable, problems)) or (str(self),)


class UnsupportedFeatureError(FileError):
    """A file says something that vincula understands but cannot represent."""


class SweepError(VinculaError):
    """A sweep cannot be run, resumed, stored or read.

    Attributes:
        kind: `usage` (asked for the wrong thing), `refused` (another process is at it, another model) or
            `storage` (no room, a damaged ledger).
        details: Further data, by name: hashes, bytes needed, chunks.
    """

    def __init__(
        self, message: str, *, kind: Literal["usage", "refused", "storage"] = "refused", **details: object
    ) -> None:
        self.kind, self.details = kind, details
        super().__init__(message)


class DesignError(VinculaError):
    """A search for a design that finds nothing, or cannot be kept or gone on with.

    Attributes:
        kind: `refused` (no feasible design, a log of another problem) or `storage` (the log cannot be used).
        details: Further data, by name: how many designs each constraint killed.
    """

    def __init__(
        self, message: str, *, kind: Literal["refused", "storage"] = "refused", **details: object
    ) -> None:
        self.kind, self.details = kind, details
        super().__init__(message)


class MissingExtraError(VinculaError, ImportError):
    """An optional dependency is not installed.

    Attributes:
        extra: Name of the extra that brings it.
    """

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        self.extra = extra
        super().__init__(
            f"{purpose} needs {package}, which is not installed. "
            f"Install it with: python -m pip install 'vincula[{extra}]'"
        )


class RankAmbiguityWarning(UserWarning):
    """A rank could not be decided: the answer depends on singular values near the uncertainty."""


class MixedUnitsWarning(UserWarning):
    """Unit weights over metres and radians: the result depends on the unit of length."""


def printable(text: str) -> str:
    """A message with what a terminal cannot show escaped, cut in the middle when it is very long."""
    if len(text) > LONGEST_MESSAGE:
        half = LONGEST_MESSAGE // 2
        left_out = len(text) - 2 * half
        text = f"{text[:half]} ... ({left_out} characters left out) ... {text[-half:]}"
    if text.replace("\n", "").isprintable():
        return text
    return "".join(
        c if c == "\n" or c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def _plural(kind: str) -> str:
    if kind.endswith("axis"):
        return kind.removesuffix("is") + "es"
    return kind.removesuffix("y") + "ies" if kind.endswith("y") else f"{kind}s"


def listing(names: Iterable[str], most: int = 12) -> str:
    """Names as a short readable list, `(none)` when empty, `... (n more)` when long."""
    all_names = list(names)
    if not all_names:
        return "(none)"
    shown = ", ".join(all_names[:most])
    more = len(all_names) - most
    return f"{shown} ... ({more} more)" if more > 0 else shown
