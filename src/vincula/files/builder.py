"""A file as a function of its parameters: what a batch or a sweep builds its mechanisms with."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.load import EXAMPLE, load
from vincula.files.parameters import parameter_values, setting
from vincula.files.source import open_source
from vincula.files.tree import Leaf
from vincula.files.units import Units
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.mechanism import Mechanism

Change = tuple[str, tuple[Any, ...], tuple[tuple[str, Any], ...]]
"""A method of `Mechanism` that makes a variant, with its arguments."""


def changed_mechanism(mechanism: Mechanism, changes: Sequence[Change]) -> Mechanism:
    """The mechanism after all changes, in order."""
    for method, arguments, named in changes:
        mechanism = getattr(mechanism, method)(*arguments, **dict(named))
    return mechanism


@dataclass(frozen=True)
class FileBuilder:
    """The mechanism of a file or an example, as a function of the parameters that it declares.

    It is called with new values by name, numbers in the units of the file (examples: m and rad).  The
    methods `with_active` and so on are those of `Mechanism`, done to every mechanism it makes.  It
    pickles, so that workers of a sweep can build for themselves; they must find the file.

    Attributes:
        path: The file, or `example:NAME`.
        settings: Parameters that are fixed at other values than the declared ones.
        beside: Side files of a URDF file.
        limits: How much a file may hold.
        changes: What is done to every mechanism, in order.
    """

    path: str
    settings: tuple[tuple[str, float | str], ...] = ()
    beside: tuple[str, ...] = ()
    limits: Limits = DEFAULT_LIMITS
    changes: tuple[Change, ...] = ()

    def __call__(self, **values: float) -> Mechanism:
        """The mechanism with some parameters at other values.

        Raises:
            FileError: The file cannot be read.
            UnknownNameError: A parameter that the file does not declare.
            ModelError: Values that are no geometry.
        """
        settings: dict[str, float | str] = {**dict(self.settings), **values}
        return changed_mechanism(
            load(self.path, settings, beside=self.beside, limits=self.limits), self.changes
        )

    def outline(self, **values: Any) -> Outline:
        """What is drawn with traced parameters: the geometry of many mechanisms at once.

        Raises:
            TypeError: Something that cannot be traced depends on them.
            ModelError: Values that are no geometry.
        """
        from vincula.files.outlines import changed, outline_of_document, outline_of_example

        settings: dict[str, Any] = {**dict(self.settings), **values}
        if self.path.startswith(EXAMPLE):
            return changed(outline_of_example(self.path, settings), self.changes)
        source = open_source(self.path, self.limits)
        if self.beside or source.text.lstrip().startswith("<"):
            raise TypeError("XML files are not traced")
        from vincula.files.treefile import read_tree

        document = read_tree(source, self.limits)
        return changed(outline_of_document(document, self.path, settings, self.limits), self.changes)

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """The declared parameters with the values they have when nothing else is asked for."""
        units = Units()
        fixed = {
            name: setting(value, units, f"parameter {name!r}", {}).value for name, value in self.settings
        }
        return {**declared_values(self.path, self.limits), **fixed}

    def with_active(self, names: Any) -> FileBuilder:
        """With other motors: see `Mechanism.with_active`."""
        return self._then("with_active", names)

    def with_lock(self, names: Any) -> FileBuilder:
        """With joints held still: see `Mechanism.with_lock`."""
        return self._then("with_lock", names)

    def with_reference(self, body: str, origin: Sequence[float] | None = None, **how: Any) -> FileBuilder:
        """With another reference member: see `Mechanism.with_reference`."""
        return self._then("with_reference", body, origin, **how)

    def with_weights(self, weights: Any) -> FileBuilder:
        """With other weights: see `Mechanism.with_weights`."""
        return self._then("with_weights", weights)

    def with_ground(self, body: str) -> FileBuilder:
        """Seen from another body: see `Mechanism.with_ground`."""
        return self._then("with_ground", body)

    def with_configuration(self, values: Mapping[str, Any]) -> FileBuilder:
        """With another home configuration: see `Mechanism.with_configuration`."""
        return self._then("with_configuration", dict(values))

    def with_tolerance(self, length: float = 0.0, angle: float = 0.0) -> FileBuilder:
        """With manufacturing tolerances: see `Mechanism.with_tolerance`."""
        return self._then("with_tolerance", length, angle)

    def _then(self, method: str, *arguments: Any, **named: Any) -> FileBuilder:
        return replace(self, changes=(*self.changes, (method, arguments, tuple(named.items()))))


def builder(
    path: str | os.PathLike[str],
    parameters: Mapping[str, float | str] | None = None,
    *,
    beside: Sequence[str | os.PathLike[str]] = (),
    limits: Limits = DEFAULT_LIMITS,
) -> FileBuilder:
    """A file or an example as a function of its declared parameters, for `vincula.compile`.

    Args:
        path: As for `vincula.load`.
        parameters: Parameters that are fixed at other values than the declared ones.
        beside: Side files of a URDF file.
        limits: How much a file may hold.

    Raises:
        FileError: The file cannot be read.
        UnknownNameError: No such example or parameter.
        ModelError: A parameter that is no number.
    """
    file = os.fspath(path)
    if not file.startswith(EXAMPLE):
        file = str(Path(file).resolve())
    made = FileBuilder(
        file, tuple((parameters or {}).items()), tuple(os.fspath(side) for side in beside), limits
    )
    made()  # what cannot be read is told here, not at the first evaluation
    return made


def declared_values(path: str, limits: Limits = DEFAULT_LIMITS) -> dict[str, float]:
    """Declared parameters with their default values, in the units of the file; those of its base too.

    Raises:
        FileError: The file cannot be read.
    """
    if path.startswith(EXAMPLE):
        from vincula.mechanism.catalog.registry import entry

        return {p.name: p.value for p in entry(path[len(EXAMPLE) :].strip()).parameters}
    source = open_source(path, limits)
    if source.text.lstrip().startswith("<"):
        return {}
    from vincula.files.treefile import read_tree

    document = read_tree(source, limits)
    base = document.node(["base"])
    found: dict[str, float] = {}
    if isinstance(base, Leaf) and isinstance(base.value, str):
        inner = base.value if base.value.startswith(EXAMPLE) else str(Path(path).parent / base.value)
        found = declared_values(inner, limits)
    own = parameter_values(document, {}, Units())
    return {**found, **{name: measured.value for name, measured in own.items()}}
