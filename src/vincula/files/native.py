"""The native format: a tree of a YAML or JSON file as a mechanism, alone or on top of another file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from vincula.errors import DuplicateNameError, FileError, ModelError, UnknownNameError
from vincula.files.contents import account_values
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.native_drawing import draw
from vincula.files.native_names import joint_values
from vincula.files.native_notes import note_oddities, record_entries
from vincula.files.native_parts import position
from vincula.files.native_rest import STEPS, tell_rest
from vincula.files.parameters import Settings, declared, parameter_values
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.schema import NativeFile
from vincula.files.schema_problems import validated
from vincula.files.schema_values import Context, mentions_traced
from vincula.files.sketch import Sketch
from vincula.files.snapping import Snapping
from vincula.files.snapping_native import snapped_tree
from vincula.files.tree import Document, Leaf, Location, Table
from vincula.files.units import Scale, Units
from vincula.files.versions import check_version
from vincula.mechanism.drawing import In, Reference
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Precision
from vincula.spatial.space import Space, space_named
from vincula.spatial.units import UNITS, Dimension

if TYPE_CHECKING:
    from vincula.files.schema_rest import Touched


@dataclass(frozen=True, slots=True)
class Loaded:
    """What a file gives.

    Attributes:
        mechanism: The mechanism.
        report: What was used, ignored and repaired.
        parameters: Names of the parameters that the file, or a file below it, declares.
    """

    mechanism: Mechanism
    report: LoadReport
    parameters: tuple[str, ...] = ()


LoadBase = Callable[[str], Loaded]
"""Loads the file that `base:` names."""


def read_native(
    document: Document,
    name: str,
    load_base: LoadBase,
    settings: Settings | None = None,
    limits: Limits = DEFAULT_LIMITS,
    snapping: Snapping | None = None,
) -> Loaded:
    """The mechanism of a native file.

    Args:
        document: The parsed file.
        name: Name of the mechanism where the file gives none.
        load_base: Loads the base, if there is one.
        settings: New values of parameters; names that the file does not declare are left to others.
        limits: Limits of the file.
        snapping: Replaces numbers of the file by what they mean.

    Raises:
        FileError: All independent problems at once, each with file, line, column, path and value.
        ModelError: A setting that is no number.
    """
    check_version(document, "vincula", "vincula native file")
    if snapping is not None:
        document = snapped_tree(document, snapping)
    base = _base(document, load_base)
    units = _units(document)
    parameters = parameter_values(document, settings or {}, units)
    space = _space(document, base)
    context = Context(parameters, space.translations if space else None, limits)
    entry = validated(document, NativeFile, context)
    if entry is None or space is None:
        if space is not None:
            _tell_rest(document, context, space, Scale(units), base, limits)
        document.problems.refuse()
    mechanism = _Builder(document, entry, space, Scale(units), base, name, limits).mechanism()
    document.problems.refuse_if_any()
    report = LoadReport(document.file, f"vincula native, {document.syntax}", units=units)
    record_entries(entry, report)
    account_values(document.root, report)
    note_oddities(entry, mechanism, base.mechanism if base else None, report)
    if base is not None:
        report.extend(base.report, new_motors=entry.motors is not None)
    every = (*declared(document), *(base.parameters if base else ()))
    return Loaded(mechanism, report, tuple(dict.fromkeys(every)))


def outline_native(
    document: Document, load_base: LoadBase, settings: Settings, limits: Limits = DEFAULT_LIMITS
) -> Outline:
    """What a native file draws with traced numbers.

    Args:
        document: The parsed file; its numbers may be traced.
        load_base: Loads the base, if there is one, with the numbers that it has.
        settings: New values of parameters, traced or not.
        limits: Limits of the file.

    Raises:
        TypeError: More than what is drawn depends on traced numbers.
        FileError: The file is refused with these numbers.
    """
    check_version(document, "vincula", "vincula native file")
    base = _base(document, load_base)
    units = _units(document)
    space = _space(document, base)
    context = Context(
        parameter_values(document, settings, units), space.translations if space else None, limits
    )
    entry = validated(document, NativeFile, context)
    if entry is None or space is None:
        document.problems.refuse()
    rest = (entry.couplings, entry.motors, entry.weights, entry.precision, entry.configuration)
    if any(mentions_traced(part) for part in rest) or entry.configuration:
        raise TypeError("more than what is drawn depends on the parameters")
    scale = Scale(units)
    below = base.mechanism if base else None
    sketch = draw(document, entry, space, scale, below, limits)
    document.problems.refuse_if_any()
    precision = scale.precision(below.precision if below else Precision(), entry.precision)
    return Outline(sketch.drawing, _drawn_reference(entry, units, below), None, precision)


def _drawn_reference(entry: NativeFile, units: Units, base: Mechanism | None) -> Reference | None:
    """The member as it is drawn; that of the base where the file names none."""
    own = entry.reference
    if own is not None:
        return Reference(
            own.body, None if own.origin is None else position(own.origin, Scale(units)), own.axes
        )
    known = base.reference if base else None
    return None if known is None else Reference(known.body, In(known.body, list(known.origin)), known.axes)


def _base(document: Document, load_base: LoadBase) -> Loaded | None:
    node = document.node(["base"])
    if isinstance(node, Leaf) and isinstance(node.value, str) and node.value:
        try:
            return load_base(node.value)
        except FileError as error:
            place = document.place(["base"]).text()
            raise type(error)(f"{error}\n{place}: the file above is the base here", error.problems) from None
        except ModelError as error:
            raise FileError(f"{document.place(['base']).text()}: {error}") from error
    return None


def _units(document: Document) -> Units:
    """The declared units, before the schema is checked: parameters need them."""
    found: dict[str, str] = {}
    dimensions: tuple[Dimension, ...] = ("length", "angle")
    for dimension in dimensions:
        node = document.node(["units", dimension])
        known = UNITS[dimension]
        if isinstance(node, Leaf) and isinstance(node.value, str) and node.value in known:
            found[dimension] = node.value
    return Units(**found)  # type: ignore[arg-type]


def _space(document: Document, base: Loaded | None) -> Space | None:
    """The space of the file: its own word, or the base's; None when the word is not known."""
    node = document.node(["space"])
    word = node.value if isinstance(node, Leaf) else None
    known = word in ("planar", "spatial")
    if base is None:
        if node is None and isinstance(document.root, Table):
            document.problems.add(document.place([]), "the key 'space' is missing: planar or spatial")
        return space_named(str(word)) if known else None
    space = base.mechanism.space
    if known and word != space.name:
        document.problems.add(
            document.place(["space"]), got=shown(word), expected=f"{space.name}, which the base is"
        )
    return space if known or node is None else None


def _tell_rest(
    document: Document, context: Context, space: Space, scale: Scale, base: Loaded | None, limits: Limits
) -> None:
    """Add what is wrong with the parts of a file that fit the schema, where others do not."""
    from vincula.files.schema_rest import rest_of

    rest, touched = rest_of(document, context, space)
    if rest is not None:
        _Builder(document, rest, space, scale, base, "", limits, touched).mechanism()


class _Builder:
    """Puts the parts together in the order in which they need each other."""

    def __init__(
        self,
        document: Document,
        entry: NativeFile,
        space: Space,
        scale: Scale,
        base: Loaded | None,
        name: str,
        limits: Limits,
        touched: Touched | None = None,
    ) -> None:
        self._document, self._entry, self._space, self._scale = document, entry, space, scale
        self._base = base.mechanism if base else None
        self._name, self._limits, self._touched = entry.name or name, limits, touched

    def mechanism(self) -> Mechanism:
        """The mechanism, at the configuration of the file; check the problems of the document."""
        before, after = self._configuration_of_base()
        sketch = draw(
            self._document, self._entry, self._space, self._scale, before, self._limits, self._touched
        )
        if self._document.problems:
            tell_rest(sketch, _place_of)
            self._document.problems.refuse()
        mechanism = self._whole(sketch)
        for step in STEPS:
            mechanism = step(sketch, mechanism)
        return self._moved(sketch, mechanism, after)

    def _configuration_of_base(self) -> tuple[Mechanism | None, Mapping[str, object]]:
        """The base where the overlay is drawn, and the values of joints that the base does not have."""
        base, given = self._base, dict(self._entry.configuration)
        if base is None or not given:
            return base, given
        own = [name for name in given if name in base.home or name in base.axis_names]
        here = {name: given.pop(name) for name in own}
        from vincula.mechanism.drawing import Drawing

        drawing = Drawing(self._space, base)
        sketch = Sketch(self._document, self._entry, drawing, self._scale, base, touched=self._touched)
        values = joint_values(sketch, base, ["configuration"], here)
        return base.with_configuration(values.values), given

    def _whole(self, sketch: Sketch) -> Mechanism:
        drawing, base = sketch.drawing, sketch.base
        precision = self._scale.precision(base.precision if base else Precision(), self._entry.precision)
        parts = {
            "bodies": drawing.bodies,
            "joints": drawing.joints,
            "contacts": drawing.contacts,
            "frames": drawing.frames,
            "precision": precision,
            "name": self._name,
            "notes": (*(base.notes if base else ()), *self._entry.notes),
        }
        try:
            if base is not None:
                return replace(base, **parts)  # type: ignore[arg-type]
            return Mechanism(space=self._space, **parts)  # type: ignore[arg-type]
        except ModelError as error:
            sketch.problem(_place_of(error, sketch), str(error))
            tell_rest(sketch, _place_of)
            self._document.problems.refuse()

    def _moved(self, sketch: Sketch, mechanism: Mechanism, values: Mapping[str, object]) -> Mechanism:
        if not values:
            return mechanism
        found = joint_values(sketch, mechanism, ["configuration"], values)
        self._document.problems.refuse_if_any()
        return mechanism.with_configuration(found.values)


def _place_of(error: ModelError, sketch: Sketch) -> Location:
    """Where the thing that a refusal of the whole names is written first."""
    if isinstance(error, (UnknownNameError, DuplicateNameError)) and error.name in sketch.first_use:
        return sketch.first_use[error.name]
    text = str(error)
    named = [name for name in sketch.first_use if repr(name) in text]
    return sketch.first_use[min(named, key=lambda name: text.index(repr(name)))] if named else []
