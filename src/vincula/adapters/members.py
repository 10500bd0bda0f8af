"""The reference member as users of live objects name it: a body, a frame, or BODY@FRAME."""

from __future__ import annotations

from vincula.errors import UnknownNameError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND

FIXED = (GROUND, "world", "universe")
"""What the fixed surroundings are called."""


def member_named(mechanism: Mechanism, text: str) -> tuple[str, str | None]:
    """Body and frame of `BODY`, `FRAME` or `BODY@FRAME`; the frame is None for the body's own.

    Raises:
        UnknownNameError: Neither a body nor a frame.
    """
    if text in mechanism.body:
        return text, None
    if text in FIXED:
        return GROUND, None
    frames = {frame.name: frame.body for frame in mechanism.frames}
    if text in frames:
        return frames[text], text
    body, at, frame = text.rpartition("@")
    if at and body in mechanism.body:
        return body, frame
    raise UnknownNameError("body, site or frame", text, [*mechanism.body, *frames])
