"""MJCF files as mechanisms, through MuJoCo's own compiler."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from vincula.errors import FileError, MissingExtraError, ModelError, UnsupportedFeatureError
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.mjcf_checks import angle_unit, check_document
from vincula.files.mjcf_contents import account_document
from vincula.files.mjcf_digits import typed_precision
from vincula.files.mjcf_document import Document, read_document
from vincula.files.mjcf_report import record_elements
from vincula.files.report import LoadReport
from vincula.files.snapping import Snapping
from vincula.files.source import Source, open_source
from vincula.mechanism.mechanism import Mechanism


def load_mjcf(
    path: str | os.PathLike[str] | Source,
    limits: Limits = DEFAULT_LIMITS,
    *,
    roots: Sequence[str | Path] = (),
    snapping: Snapping | None = None,
) -> tuple[Mechanism, LoadReport]:
    """The mechanism of an MJCF file, at its home configuration `qpos0`.

    The file's motors are active, its sites are frames, its keyframes are configurations; no body is
    the reference member yet.

    Args:
        path: The file, or its text where it is open already.
        limits: How much the file may hold.
        roots: Further folders that included files may lie in; by default only the file's own.
        snapping: Replaces numbers of the file and what it includes by what they mean.

    Returns:
        The mechanism, and the report of everything used and ignored.

    Raises:
        FileError: The file cannot be read, or is no mechanism; with file, line, column and element.
        UnsupportedFeatureError: The file holds a loop or a part that cannot be represented.
        MissingExtraError: MuJoCo is not installed.
    """
    source = path if isinstance(path, Source) else open_source(path, limits)
    report = LoadReport(source.file, "MJCF")
    document = read_document(source, limits, roots, report)
    check_document(document, limits)
    if snapping is not None:
        for part in document.all_documents():
            snapping.mjcf(part.root, angle_unit(part))
    return _mechanism(document, source, report, limits), report


def _mechanism(document: Document, source: Source, report: LoadReport, limits: Limits) -> Mechanism:
    if find_spec("mujoco") is None:
        raise MissingExtraError("MuJoCo", "mujoco", "reading MJCF files")
    if limits.isolated:
        from vincula.files.mjcf_child import CHILD

        CHILD.start()  # it starts while MuJoCo is imported here
    from vincula.adapters.mujoco_graph import mechanism_of
    from vincula.adapters.mujoco_names import ModelNames
    from vincula.files.mjcf_compile import compile_document

    model, warnings = compile_document(document, limits)
    stem = source.path.stem if source.path is not None else "mechanism"
    try:
        mechanism = mechanism_of(
            model,
            ModelNames(model),
            report,
            name=document.root.attributes.get("model") or stem,
            precision=typed_precision(document),
        )
    except UnsupportedFeatureError as error:
        raise UnsupportedFeatureError(f"{source.file}: {error}") from None
    except ModelError as error:
        raise FileError(f"{source.file}: {error}") from error
    record_elements(document, report)
    account_document(document, report)
    for warning in warnings:
        report.note(f"MuJoCo: {warning}")
    return mechanism
