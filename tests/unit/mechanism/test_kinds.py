"""Arguments of the wrong kind are refused at the door, with the place and what is expected there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import vincula as vc
from vincula.errors import ModelError

ONE: Any = [vc.Revolute("a", "ground", "b", at=(0, 0))]


def planar(**arguments: Any) -> vc.Mechanism:
    return vc.Mechanism.planar(**{"joints": ONE, **arguments})


def five_bar() -> Any:
    return vc.load("example:five-bar")


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "load a number": (lambda: vc.load(3), "load: got 3, expected a path or example:NAME"),  # type: ignore[arg-type]
    "load nothing": (lambda: vc.load(None), "load: got None, expected a path"),  # type: ignore[arg-type]
    "parameters": (
        lambda: vc.load("example:five-bar", parameters=3),
        "parameters: got 3, expected numbers by",
    ),  # type: ignore[arg-type]
    "joints": (
        lambda: planar(joints=None),
        "joints: got None, expected a list of joints such as vc.Revolute",
    ),
    "a joint": (lambda: planar(joints=[1]), r"joints\[0\]: got 1, expected joints such as vc.Revolute"),
    "a text": (lambda: planar(joints="abc"), "joints: got 'abc', expected a list"),
    "a contact": (lambda: planar(contacts=[ONE[0]]), r"contacts\[0\]: got .*, expected vc.Contact"),
    "a coupling": (lambda: planar(couplings=[3]), r"couplings\[0\]: got 3, expected vc.Coupling"),
    "rates": (lambda: planar(couplings=[vc.Coupling("c", 3)]), r"couplings\[0\]: rates: got 3"),  # type: ignore[arg-type]
    "a rate": (
        lambda: planar(couplings=[vc.Coupling("c", {"a": "x"})]),
        "rates: got .*expected numbers by axis",
    ),  # type: ignore[dict-item]
    "a drive": (lambda: planar(drives=[3]), r"drives\[0\]: got 3, expected vc.Drive"),
    "a body": (lambda: planar(bodies=["b"]), r"bodies\[0\]: got 'b', expected vc.Body"),
    "reference": (lambda: planar(reference="b"), "reference: got 'b', expected vc.Reference"),
    "its body": (lambda: planar(reference=vc.Reference(3)), "no body is named 3"),  # type: ignore[arg-type]
    "weights": (lambda: planar(weights=3), "weights: got 3, expected vc.Weights"),
    "limits": (
        lambda: planar(joints=[vc.Revolute("a", "ground", "b", at=(0, 0), limits=3)]),  # type: ignore[arg-type]
        r"joints\[0\]: limits: got",
    ),
    "name": (
        lambda: planar(joints=[vc.Revolute(3, "ground", "b", at=(0, 0))]),  # type: ignore[arg-type]
        r"joints\[0\]: name: got 3, expected a name",
    ),
    "active": (lambda: planar(active=3), "got 3, expected names of joints, axes or motors"),
    "an active one": (lambda: planar(active=[["a"]]), r"got \['a'\], expected names"),
    "with_active": (lambda: five_bar().with_active([3]), "got 3, expected names"),
    "with_lock": (lambda: five_bar().with_lock(3), "got 3, expected names"),
    "with_reference": (lambda: five_bar().with_reference(3), "no body is named 3"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_wrong_kinds_are_refused_in_our_words(what: str) -> None:
    make, expected = REFUSED[what]
    with pytest.raises(ModelError, match=expected):
        make()


def test_generators_tuples_and_numbers_of_numpy_are_right_kinds() -> None:
    import numpy as np

    gear = vc.Coupling("gear", {"a": np.float64(1.0), "b": 2})
    two = (*ONE, vc.Revolute("b", "b", "c", at=(1, 0)))
    mechanism = vc.Mechanism.planar(joints=two, couplings=[gear], active=(name for name in ("a",)))
    assert mechanism.active == ("a",)
