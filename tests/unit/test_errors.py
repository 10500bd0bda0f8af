"""Messages: printable and of a size that can be read, whatever is put into them."""

from __future__ import annotations

import pytest

import vincula as vc
from vincula.errors import LONGEST_MESSAGE, printable

NASTY = "a\u2028b\x1b[31mc\ufffed\ud800"


@pytest.mark.parametrize(
    "error",
    [
        vc.FileError(f"robot.urdf:1:1: {NASTY}"),
        vc.FileError("two", ["one", NASTY]),
        vc.UnknownNameError("joint", NASTY, [NASTY]),
        vc.DuplicateNameError("joint", NASTY),
        vc.ClosureError(NASTY, loop=NASTY),
    ],
)
def test_messages_are_printable(error: vc.VinculaError) -> None:
    texts = [str(error), *getattr(error, "problems", ())]
    assert all(text.isprintable() for text in texts)
    str(error).encode("utf-8")


def test_what_is_printable_stays_as_it_is() -> None:
    text = "r\u00e9sidu 1.2e-9 m\n\u03b8 = 30\u00b0: joint 'o1'"
    assert printable(text) == text
    assert printable(printable(NASTY)) == printable(NASTY)


def test_long_texts_are_cut_in_the_middle() -> None:
    text = str(vc.ModelError("begin " + "x" * 10**6 + " end"))
    assert len(text) < LONGEST_MESSAGE + 100
    assert text.startswith("begin ")
    assert text.endswith(" end")


def test_an_endless_name_is_cut_and_still_compared_quickly() -> None:
    text = str(vc.UnknownNameError("joint", "elbow" * 100_000, ["elbow", "knee"]))
    assert len(text) < 1000
    assert text.endswith("Known: elbow, knee")
