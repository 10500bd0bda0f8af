"""Whether what a mechanism is drawn from is of the right kind; refused at the door, with the place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from numbers import Real
from typing import Final

from vincula.errors import ModelError
from vincula.mechanism.drawing import Contact, DrawnBody, DrawnJoint, Reference
from vincula.mechanism.parts import Coupling, Drive, Limits
from vincula.weights import Weights

_PARTS: Final[dict[str, tuple[type, str]]] = {
    "joints": (DrawnJoint, "joints such as vc.Revolute(...)"),
    "contacts": (Contact, "vc.Contact(...)"),
    "couplings": (Coupling, "vc.Coupling(...)"),
    "drives": (Drive, "vc.Drive(...)"),
    "bodies": (DrawnBody, "vc.Body(...)"),
}
"""What the lists of a drawing hold, and how that is made."""


def refuse_other_kinds(lists: Mapping[str, object], reference: object = None, weights: object = None) -> None:
    """Refuse arguments of a drawing that are not what they are called.

    Args:
        lists: Joints, contacts, couplings, drives and bodies by the name of the argument.
        reference: The reference member.
        weights: The weights.

    Raises:
        ModelError: One is of another kind; says where, what was given and what is expected.
    """
    for what, given in lists.items():
        kind, made = _PARTS[what]
        if isinstance(given, str) or not isinstance(given, Iterable):
            raise ModelError(f"{what}: got {_shown(given)}, expected a list of {made}")
        for index, part in enumerate(given):
            if not isinstance(part, kind):
                raise ModelError(f"{what}[{index}]: got {_shown(part)}, expected {made}")
            _refuse_fields(part, f"{what}[{index}]")
    if reference is not None and not isinstance(reference, Reference):
        raise ModelError(f"reference: got {_shown(reference)}, expected vc.Reference(body, origin=...)")
    if weights is not None and not isinstance(weights, Weights):
        raise ModelError(f"weights: got {_shown(weights)}, expected vc.Weights(...)")


def _refuse_fields(part: object, what: str) -> None:
    for field in ("name", "first", "second"):
        given = getattr(part, field, "")
        if not isinstance(given, str):
            raise ModelError(f"{what}: {field}: got {_shown(given)}, expected a name")
    limits = getattr(part, "limits", ())
    if not isinstance(limits, tuple) or not all(isinstance(limit, Limits) for limit in limits):
        raise ModelError(f"{what}: limits: got {_shown(limits)}, expected vc.Limits(...)")
    for field in ("rates", "driver", "references", "drives"):
        given = getattr(part, field, {})
        if not isinstance(given, Mapping) or not all(isinstance(value, Real) for value in given.values()):
            raise ModelError(f"{what}: {field}: got {_shown(given)}, expected numbers by axis, {{'j1': 1.0}}")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) < 60 else f"a {type(value).__name__}"
