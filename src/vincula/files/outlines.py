"""Files and examples drawn with traced numbers, for `vincula.kernels.traced_geometry`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.load import EXAMPLE, load_with_report
from vincula.files.native import Loaded, outline_native
from vincula.files.parameters import declared
from vincula.files.tree import Document
from vincula.mechanism.catalog.registry import entry as catalog_entry
from vincula.mechanism.drawing import In, Reference
from vincula.mechanism.drawn_mechanism import Outline
from vincula.spatial.units import quantity
from vincula.traced import Traced, holds_traced

_KEEP_GEOMETRY: Final = ("with_active", "with_lock", "with_weights", "with_tolerance")
"""Changes of a mechanism after which it is drawn as before."""


def outline_of_example(path: str, settings: Mapping[str, Any]) -> Outline:
    """An example of the catalog with some parameters traced.

    Args:
        path: `example:NAME`.
        settings: Parameters at other values than the declared ones.

    Raises:
        TypeError: Its builder does something that cannot be traced.
        ModelError: Values that are no geometry.
    """
    found = catalog_entry(path[len(EXAMPLE) :].strip())
    values = {p.name: settings.get(p.name, p.default) for p in found.parameters}
    dimensions = {p.name: p.dimension for p in found.parameters}
    made: Any = found.build(
        **{n: v if isinstance(v, Traced) else quantity(v, dimensions[n], n) for n, v in values.items()}
    )
    if not isinstance(made, Outline):
        raise TypeError("nothing that is drawn depends on the parameters")
    return made


def outline_of_document(
    document: Document, path: str, settings: Mapping[str, Any], limits: Limits = DEFAULT_LIMITS
) -> Outline:
    """A native file with some parameters or numbers traced.

    Args:
        document: Its tree.
        path: The file; a base is looked for beside it.
        settings: Parameters at other values than the declared ones.
        limits: How much a file may hold.

    Raises:
        TypeError: Something depends on the numbers that is not traced.
        FileError: The file is refused with these numbers.
    """

    def base(file: str) -> Loaded:
        own = {name: value for name, value in settings.items() if name not in declared(document)}
        if holds_traced(list(own.values())):
            raise TypeError("parameters of a base are not traced")
        inner = file if file.startswith(EXAMPLE) else str(Path(path).parent / file)
        return Loaded(*load_with_report(inner, own), tuple(own))

    return outline_native(document, base, settings, limits)


def changed(
    outline: Outline, changes: Sequence[tuple[str, tuple[Any, ...], tuple[tuple[str, Any], ...]]]
) -> Outline:
    """An outline after what is done to every mechanism that is built.

    Args:
        outline: The outline.
        changes: Methods of `Mechanism` with their arguments.

    Raises:
        TypeError: A change that is not traced.
    """
    for method, arguments, named in changes:
        if method == "with_reference":
            outline = replace(outline, reference=_reference(outline, *arguments, **dict(named)))
        elif method not in _KEEP_GEOMETRY:
            raise TypeError(f"{method} is not traced")
    return outline


def _reference(outline: Outline, body: str, origin: Any = None, **how: Any) -> Reference:
    """A reference member named as `Mechanism.with_reference` does, in axes of the body."""
    frame = how.get("frame")
    place: In | None = None
    if frame is not None:
        place = In(frame, np.zeros(outline.drawing.space.translations).tolist())
    elif origin is not None:
        place = In(body, list(origin))
    return Reference(body, place, how.get("axes", "ground"), how.get("cuts") or {})
