"""Where `package://` and `$(find NAME)` lead, and which paths of meshes are safe.

Meshes say nothing about a mechanism and are never opened.  What their paths lead to is looked up and
told in the load report, so that a missing or dangerous path is seen before another program follows it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from urllib.parse import unquote

from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.xmltree import Element

_NAME: Final = re.compile(r"[A-Za-z0-9][\w.+-]*\Z")
_SCHEME: Final = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*):/")
_PACKAGE: Final = ("package", "model")
_ANCESTORS: Final = 8
"""How many folders above a file are looked at for the package that it lies in."""


@dataclass(frozen=True, slots=True)
class Packages:
    """Folders in which packages are looked for.

    Attributes:
        folders: Folders of packages, or packages themselves, which are called as their folders are.
    """

    folders: tuple[Path, ...] = ()

    @staticmethod
    def of(
        given: Iterable[str | os.PathLike[str]] = (), environment: Mapping[str, str] | None = None
    ) -> Packages:
        """The folders that are given, then those of ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.

        Args:
            given: Folders named by the user, looked at first.
            environment: Environment variables; by default those of the process.
        """
        words = os.environ if environment is None else environment
        folders = [Path(folder) for folder in given]
        folders += [Path(f) for f in words.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if f]
        folders += [Path(f) / "share" for f in words.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if f]
        return Packages(tuple(folders))

    def find(self, name: str, near: Path | None = None) -> Path | None:
        """The folder of a package; None if it is not found or no name of a package.

        Args:
            name: Its name.
            near: A file that may lie in the package.
        """
        if not _NAME.match(name):
            return None
        for folder in self.folders:
            for candidate in (folder / name, folder):
                if candidate.name == name and candidate.is_dir():
                    return candidate
        above = [] if near is None else list(near.absolute().parents)[:_ANCESTORS]
        return next((folder for folder in above if folder.name == name), None)

    def resolve(self, uri: str, near: Path | None) -> tuple[Path | None, str]:
        """Where the path of a mesh leads: the file that is there, and in words what was found.

        Args:
            uri: The path as it is written: relative, `package://NAME/...` or `model://NAME/...`.
            near: The file that it is written in; None for text that is in no file.
        """
        text = uri.strip()
        scheme = _SCHEME.match(text)
        if "\x00" in text or (scheme is not None and scheme[1] not in _PACKAGE):
            return None, "refused: only relative paths and package:// are followed"
        if scheme is not None:
            name, _, rest = text[scheme.end() :].lstrip("/").partition("/")
            root = self.find(name, near)
            if root is None:
                return None, f"not found: there is no package {shown(name)} (--package-dir names its folder)"
            path = root / unquote(rest)
        else:
            root, path = (None if near is None else near.parent), Path(text)
            if path.is_absolute() or root is None:
                return None, "refused: only relative paths and package:// are followed"
            path = root / path
        return _inside(path, root)


def _inside(path: Path, root: Path) -> tuple[Path | None, str]:
    """The file at a path, if it lies below the root after every link is resolved."""
    try:
        real, base = path.resolve(), root.resolve()
        if not real.is_relative_to(base):
            return None, f"refused: it leads out of {shown(root.name or '.')}"
        return (real, "found") if real.is_file() else (None, "not found")
    except (OSError, RuntimeError, ValueError):
        return None, "refused: no path that can be followed"


def record_meshes(root: Element, near: Path | None, packages: Packages, report: LoadReport) -> None:
    """Record every mesh of a URDF or SDF document: found, not found or refused; none is opened."""
    for element in root.walk():
        if element.tag != "mesh":
            continue
        inside = (part.characters for part in element.children if part.tag == "uri")
        written = element.attributes.get("filename", "") or next(inside, "")
        if written:
            found = packages.resolve(written, near)[1]
            report.ignored("mesh", shown(written).strip("'"), f"never opened; {found}", of=element)
