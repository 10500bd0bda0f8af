"""An MJCF file with everything it includes, as one tree of elements; nothing else is opened.

Included files must lie in the model's own folder or an allowed one, after links are resolved.  Files
of attached models (`asset/model`) are read by the same rules, each as a document of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.source import Source, decode, read_bytes, shown_path
from vincula.files.xmltree import Element, parse_xml, refuse_element


@dataclass(slots=True)
class Document:
    """One MJCF file, its includes expanded.

    Attributes:
        root: The `mujoco` element.
        file: The file as shown to the user.
        models: Documents of attached models by the `asset/model` element that names them.
        includes: Files that were included, as shown to the user.
        holders: The include elements, and the root elements of the files in their places.
    """

    root: Element
    file: str
    models: list[tuple[Element, Document]] = field(default_factory=list)
    includes: list[str] = field(default_factory=list)
    holders: list[Element] = field(default_factory=list)

    def all_documents(self) -> list[Document]:
        """The document and those of its attached models, inner ones too."""
        found = [self]
        for _, model in self.models:
            found.extend(model.all_documents())
        return found


def read_document(
    source: Source,
    limits: Limits = DEFAULT_LIMITS,
    roots: Sequence[str | Path] = (),
    report: LoadReport | None = None,
) -> Document:
    """The document of an MJCF file.

    Args:
        source: The text of the file.
        limits: Limits on files, elements and includes.
        roots: Further folders that included files may lie in.
        report: Where repairs of the text are recorded.

    Raises:
        FileError: The file or an included one cannot be read, or lies outside the allowed folders.
    """
    folder = source.path.parent if source.path is not None else Path()
    return _Reader(folder, limits, [folder, *map(Path, roots)], report).read(source, ())


class _Reader:
    """Opens files and counts them against the limits."""

    def __init__(
        self, folder: Path, limits: Limits, roots: Sequence[Path], report: LoadReport | None
    ) -> None:
        self._folder, self._limits, self._report = folder, limits, report
        self._roots = [root.resolve() for root in roots]
        self._opened = 0
        self._elements = 0

    def read(self, source: Source, chain: tuple[Path, ...]) -> Document:
        root = parse_xml(source, self._limits, self._report)
        if root.tag != "mujoco":
            hint = "; load the file that includes this one" if root.tag == "mujocoinclude" else ""
            expected = f"expected <mujoco>, the root of an MJCF file{hint}"
            refuse_element(root, f"got <{root.tag[:40]}>, {expected}")
        document = Document(root, source.file)
        if source.path is not None:
            chain = (*chain, source.path.resolve())
        self._expand(root, source, document, set(chain), 1)
        for element in list(root.walk()):
            if element.tag == "model" and element.parent is not None and element.parent.tag == "asset":
                child, path = self._open(element, source)
                if path in chain:
                    refuse_element(element, f"the model {shown(element.attributes['file'])} contains itself")
                document.models.append((element, self.read(child, (*chain, path))))
        return document

    def _expand(
        self, element: Element, source: Source, document: Document, seen: set[Path], depth: int
    ) -> None:
        """Put the children of included files in the place of the include elements."""
        self._elements += 1
        if depth > self._limits.depth:
            refuse_element(element, f"elements are nested more than {self._limits.depth} deep")
        if self._elements > self._limits.nodes:
            refuse_element(element, f"more than {self._limits.nodes} elements in all files together")
        children: list[Element] = []
        for child in element.children:
            if child.tag != "include":
                self._expand(child, source, document, seen, depth + 1)
                children.append(child)
                continue
            included, path = self._open(child, source)
            if path in seen:
                refuse_element(child, f"{shown(included.file)} is included twice; once is allowed")
            seen.add(path)
            document.includes.append(included.file)
            holder = parse_xml(included, self._limits, self._report)
            if not holder.children:
                refuse_element(child, f"{shown(child.attributes['file'])} holds no element")
            self._expand(holder, included, document, seen, depth)
            for inner in holder.children:
                inner.parent = element
            children.extend(holder.children)
            document.holders += [child, holder]
        element.children = children

    def _open(self, element: Element, source: Source) -> tuple[Source, Path]:
        """The file that an element names, looked for in the model's folder, then beside the file."""
        named = element.attributes.get("file", "").replace("\\", "/")
        if not named:
            refuse_element(element, "the attribute 'file' is missing")
        if "://" in named:
            refuse_element(element, f"got {shown(named)}, expected the path of a file beside the model")
        self._opened += 1
        if self._opened > self._limits.includes:
            refuse_element(element, f"more than {self._limits.includes} included files")
        beside = source.path.parent if source.path is not None else self._folder
        try:
            candidates = [self._folder / named, beside / named]
            path = next((c for c in candidates if c.exists()), candidates[0])
            resolved = path.resolve()
        except (OSError, RuntimeError, ValueError):
            refuse_element(element, f"got {shown(named)}, expected the path of a file beside the model")
        if not any(resolved.is_relative_to(root) for root in self._roots):
            refuse_element(
                element,
                f"{shown(named)} lies outside the folder of the model: it is not opened "
                "(--package-dir names further folders that may be)",
            )
        try:
            data = read_bytes(resolved, self._limits.xml_bytes)
        except FileError as error:
            detail = str(error).removeprefix(f"{shown_path(str(resolved))}: ")
            refuse_element(element, f"{shown(named)} cannot be read: {detail}")
        return decode(data, shown_path(str(path)), path), resolved
