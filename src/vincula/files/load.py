"""`vincula.load`: any file that can be read, recognised by what is in it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from vincula.errors import FileError, ModelError, UnknownNameError, listing
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.packages import Packages
from vincula.files.problems import shown
from vincula.files.source import Source, open_source

if TYPE_CHECKING:
    from vincula.files.native import Loaded
    from vincula.files.parameters import Settings
    from vincula.files.report import LoadReport
    from vincula.files.snapping import Snapping
    from vincula.mechanism.mechanism import Mechanism

EXAMPLE: Final = "example:"
"""What stands before the name of an example of the catalog."""

_PROLOGUE: Final = re.compile(r"\s*(?:<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^<>]*>)", re.DOTALL)
_COMMENT: Final = re.compile(r"<!--.*?-->", re.DOTALL)
_ROOT: Final = re.compile(r"\s*<([A-Za-z_][\w.:-]*)([^<>]*)")


def load(
    path: str | os.PathLike[str],
    parameters: Mapping[str, float | str] | None = None,
    *,
    beside: Sequence[str | os.PathLike[str]] = (),
    limits: Limits = DEFAULT_LIMITS,
    snap: bool = False,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
) -> Mechanism:
    """The mechanism of a file or an example.

    Args:
        path: A vincula native file (YAML or JSON), a URDF, SDF or MJCF file, or `example:NAME`.
        parameters: New values for declared parameters: numbers in the units of the file (examples: m
            and rad), or texts with a unit such as `"1deg"`.
        beside: Side files of a URDF file (Gepetto loops, SRDF); by default those found beside it.
        limits: How much a file may hold.
        snap: Read numbers of the file as what they probably mean (1.57 as pi/2); the notes of the
            mechanism list every number that was read so.
        package_dirs: Folders of packages, or packages: where `package://` and `$(find NAME)` lead,
            before ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and where MJCF files may be included from.

    Raises:
        FileError: The file cannot be read; every independent problem with file, line and column.
        UnknownNameError: No such example or parameter.
        ModelError: A parameter that is no number.
        MissingExtraError: MJCF without MuJoCo.
    """
    return load_with_report(
        path, parameters, beside=beside, limits=limits, snap=snap, package_dirs=package_dirs
    )[0]


def load_with_report(
    path: str | os.PathLike[str],
    parameters: Mapping[str, float | str] | None = None,
    *,
    beside: Sequence[str | os.PathLike[str]] = (),
    limits: Limits = DEFAULT_LIMITS,
    snap: bool = False,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
) -> tuple[Mechanism, LoadReport]:
    """As `load`, with the report of everything used, ignored and repaired."""
    if not isinstance(path, str | os.PathLike):
        raise ModelError(f"load: got {path!r}, expected a path or example:NAME")
    if parameters is not None and not isinstance(parameters, Mapping):
        raise ModelError(f"load: parameters: got {parameters!r}, expected numbers by name, {{'l': 0.5}}")
    file, settings = os.fspath(path), dict(parameters or {})
    if file.startswith(EXAMPLE):
        if beside:
            raise FileError(_NO_SIDE_FILES.format(shown(file)))
        return _example(file, settings)
    from vincula.files.snapping import Snapping, snapped_words

    snapping = Snapping() if snap else None
    loader = _Loader(settings, limits, beside, snapping, package_dirs)
    loaded = loader.load(file)
    if beside and not loader.beside_was_read:
        raise FileError(_NO_SIDE_FILES.format(loaded.report.file))
    for name in settings:
        if name not in loaded.parameters:
            raise UnknownNameError("parameter", name, loaded.parameters)
    mechanism = loaded.mechanism
    if snapping is not None:
        from vincula.files.snapping_axes import snapped_axes

        mechanism, changes = snapped_axes(mechanism, loaded.report.file)
        snapping.found += changes
    if snapping is not None and snapping.found:
        note = f"numbers of the file were read as what they probably mean: {snapped_words(snapping.found)}"
        loaded.report.snapped += [str(snap) for snap in snapping.found]
        loaded.report.note(note)
        return replace(mechanism, notes=(*mechanism.notes, note)), loaded.report
    return mechanism, loaded.report


def declared_parameters(path: str | os.PathLike[str], *, limits: Limits = DEFAULT_LIMITS) -> tuple[str, ...]:
    """Names of the parameters that a file, or an example, declares.

    Raises:
        FileError: The file cannot be read.
        UnknownNameError: No such example.
    """
    file = os.fspath(path)
    if file.startswith(EXAMPLE):
        from vincula.mechanism.catalog.registry import entry

        return tuple(parameter.name for parameter in entry(file[len(EXAMPLE) :].strip()).parameters)
    return _Loader({}, limits).load(file).parameters


def _example(file: str, settings: Mapping[str, float | str]) -> tuple[Mechanism, LoadReport]:
    from vincula.files.report import LoadReport
    from vincula.mechanism.catalog.registry import example

    mechanism = example(file[len(EXAMPLE) :].strip(), **settings)
    report = LoadReport(file, "example")
    for joint in mechanism.joints:
        report.used("joint", joint.name, joint.type)
    for contact in mechanism.contacts:
        report.used("contact", contact.name, contact.type)
    for coupling in mechanism.couplings:
        report.used("coupling", coupling.name)
    for motor in mechanism.active:
        report.used("motor", motor)
    return mechanism, report


_NO_SIDE_FILES: Final = "{}: side files (loops, SRDF) belong to URDF files; this is none"


class _Loader:
    """Loads a file and the files below it."""

    def __init__(
        self,
        settings: Settings,
        limits: Limits,
        beside: Sequence[str | os.PathLike[str]] = (),
        snapping: Snapping | None = None,
        package_dirs: Sequence[str | os.PathLike[str]] = (),
    ) -> None:
        self._settings, self._limits, self._beside = settings, limits, beside
        self._snapping = snapping
        self._roots = [Path(folder) for folder in package_dirs]
        self._packages = Packages.of(package_dirs)
        self.beside_was_read = False
        self._above: list[Path] = []

    def load(self, file: str) -> Loaded:
        """What the file gives."""
        source = open_source(file, self._limits)
        resolved = Path(file).resolve()
        if resolved in self._above:
            raise FileError(f"{source.file}: the file is its own base")
        if len(self._above) >= self._limits.includes:
            raise FileError(f"{source.file}: more than {self._limits.includes} files below each other")
        self._above.append(resolved)
        try:
            return self._read(source)
        finally:
            self._above.pop()

    def _read(self, source: Source) -> Loaded:
        if source.text.lstrip().startswith("<"):
            return self._xml(source)
        from vincula.files.native import read_native
        from vincula.files.treefile import read_tree

        folder = Path(source.file).parent
        return read_native(
            read_tree(source, self._limits),
            Path(source.file).stem,
            lambda base: self._base(base, folder),
            self._settings,
            self._limits,
            self._snapping,
        )

    def _base(self, base: str, folder: Path) -> Loaded:
        from vincula.files.native import Loaded

        if base.startswith(EXAMPLE):
            from vincula.mechanism.catalog.registry import entry

            names = [parameter.name for parameter in entry(base[len(EXAMPLE) :].strip()).parameters]
            own = {name: value for name, value in self._settings.items() if name in names}
            return Loaded(*_example(base, own), tuple(names))
        if "://" in base:
            raise FileError(f"{shown(base)}: expected a file on this machine; network addresses are not read")
        return self.load(str(folder / base))

    def _xml(self, source: Source) -> Loaded:
        from vincula.files.native import Loaded

        arguments: tuple[str, ...] = ()
        if is_xacro(source):
            from vincula.files.xacro import EXPANDED, expand

            source, arguments = expand(source, self._settings, self._limits, self._packages)
            loaded = self._robot(source)
            loaded.report.note(f"{EXPANDED}: lines in messages are those of what it expands to")
        else:
            loaded = self._robot(source)
        return Loaded(loaded.mechanism, loaded.report, (*loaded.parameters, *arguments))

    def _robot(self, source: Source) -> Loaded:
        from vincula.files.native import Loaded
        from vincula.files.xmltree import parse_xml

        root = xml_root(source)
        if root in ("mujoco", "mujocoinclude"):
            from vincula.files.mjcf import load_mjcf

            return Loaded(*load_mjcf(source, self._limits, roots=self._roots, snapping=self._snapping))
        if root == "robot":
            from vincula.files.urdf import load_urdf

            self.beside_was_read = True
            return Loaded(
                *load_urdf(
                    source,
                    self._limits,
                    beside=self._beside,
                    snapping=self._snapping,
                    packages=self._packages,
                )
            )
        if root == "sdf":
            from vincula.files.sdf import load_sdf

            return Loaded(*load_sdf(source, self._limits, snapping=self._snapping, packages=self._packages))
        if not root:
            parse_xml(source, self._limits)  # refuses document types, broken XML and files without elements
        raise FileError(f"{source.file}: {_other_xml(root)}; files that can be read: {listing(FORMATS)}")


FORMATS: Final = ("vincula native (YAML or JSON)", "MJCF", "URDF", "SDF")
"""The formats that can be read."""

_OTHER_XML: Final = {
    "COLLADA": "got a mesh (COLLADA)",
    "html": "got a web page",
    "svg": "got a picture (SVG)",
}


def is_xacro(source: Source) -> bool:
    """Whether an XML file is a xacro that has to be expanded: it is of the namespace, and uses it."""
    root = _first_element(source.text)
    if root is None:
        return False
    if root[1].startswith("xacro:"):
        return True
    if "xacro" not in root[2]:
        return False
    # What xacro has expanded keeps the namespace, and the comments of what it was made from.
    written = _COMMENT.sub("", source.text)
    return any(sign in written for sign in ("<xacro:", "${", "$("))


def xml_root(source: Source) -> str:
    """Tag of the first element of an XML file; empty when there is none.

    Raises:
        FileError: The file is an ERB template that has not been expanded.
    """
    if source.text.lstrip().startswith("<%") or source.file.endswith(".erb"):
        raise FileError(f"{source.file}: got a template (ERB); expand it first: erb -T 1 FILE > model.sdf")
    root = _first_element(source.text)
    if root is None:
        # Whatever this is, the XML reader says best what is wrong with it.
        return "mujoco" if "<mujoco" in source.text else ""
    return root[1]


def _first_element(text: str) -> re.Match[str] | None:
    at = 0
    while (match := _PROLOGUE.match(text, at)) is not None:
        at = match.end()
    return _ROOT.match(text, at)


def _other_xml(root: str) -> str:
    return _OTHER_XML.get(root, f"got XML with the root {shown(root)}" if root else "got something like XML")
