"""Tables of points for a sweep: CSV, npz without objects, Parquet where pyarrow is installed."""

from __future__ import annotations

import csv
import zipfile
import zlib
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import FileError, MissingExtraError
from vincula.files.problems import shown
from vincula.files.source import decode, read_bytes, shown_path
from vincula.files.tree import number

LARGEST_TABLE: Final = 2 * 2**30
"""Bytes of a table file, at most."""
MOST_NUMBERS: Final = 200_000_000
"""Numbers of a table, at most."""
_BROKEN: Final = (
    ValueError,
    OSError,
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    KeyError,
    RuntimeError,
    MemoryError,
)
"""What damaged archives end with inside numpy and zipfile."""


def read_columns(path: Path) -> dict[str, Vector]:
    """Columns of a table by name, in the units of whoever wrote it.

    Args:
        path: A CSV file whose first row holds names, an npz file with one array a column, or a Parquet
            file.

    Raises:
        FileError: It cannot be read, is no such table, or holds something that is no finite number.
        MissingExtraError: Parquet without pyarrow.
    """
    ending = path.suffix.lower()
    if ending == ".npz":
        columns = _npz(path)
    elif ending in (".parquet", ".pq"):
        columns = _parquet(path)
    elif ending in (".csv", ".txt"):
        columns = _csv(path)
    else:
        raise FileError(f"{shown_path(str(path))}: expected a table that ends in .csv, .npz or .parquet")
    return _checked(path, columns)


def _checked(path: Path, columns: dict[str, Vector]) -> dict[str, Vector]:
    file = shown_path(str(path))
    lengths = {name: len(column) for name, column in columns.items()}
    if not lengths or not min(lengths.values()):
        raise FileError(f"{file}: the table has no rows")
    if len(set(lengths.values())) > 1:
        raise FileError(f"{file}: its columns have different lengths: {lengths}")
    for name, column in columns.items():
        bad = np.flatnonzero(~np.isfinite(column))
        if len(bad):
            value = column[bad[0]]
            raise FileError(
                f"{file}: column {shown(name)}, row {bad[0] + 1}: got {value}, expected a finite number"
            )
    return columns


def _csv(path: Path) -> dict[str, Vector]:
    source = decode(read_bytes(path, LARGEST_TABLE), shown_path(str(path)), path)
    reader = csv.reader(source.text.splitlines(), skipinitialspace=True)
    names: list[str] = []
    rows: list[list[float]] = []
    try:
        for row in reader:
            if not row:
                continue
            if not names:
                names = _header(source.file, reader.line_num, row)
                continue
            rows.append(list(_numbers(source.file, reader.line_num, row, names)))
            if len(rows) * len(names) > MOST_NUMBERS:
                raise FileError(f"{source.file}: the table has more than {MOST_NUMBERS} numbers")
    except csv.Error as error:
        raise FileError(f"{source.file}:{reader.line_num}:1: not CSV: {error}") from None
    table = np.array(rows, dtype=float).reshape(-1, len(names))
    return {name: table[:, k].copy() for k, name in enumerate(names)}


def _header(file: str, line: int, row: list[str]) -> list[str]:
    names = [name.strip() for name in row]
    for k, name in enumerate(names):
        if not name or number(name) is not None:
            raise FileError(f"{file}:{line}:{k + 1}: got {shown(name)}, expected a row of names of variables")
        if name in names[:k]:
            raise FileError(f"{file}:{line}:{k + 1}: two columns are named {shown(name)}")
    return names


def _numbers(file: str, line: int, row: list[str], names: list[str]) -> Iterator[float]:
    if len(row) != len(names):
        raise FileError(f"{file}:{line}:1: got {len(row)} values, expected {len(names)} as the row of names")
    for k, text in enumerate(row):
        found = number(text.strip())
        if found is None:
            raise FileError(f"{file}:{line}:{k + 1}: {names[k]}: got {shown(text)}, expected a number")
        yield float(found)


def _npz(path: Path) -> dict[str, Vector]:
    file = shown_path(str(path))
    read_bytes(path, LARGEST_TABLE)  # refuses what is no regular file, or too large
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > LARGEST_TABLE:
                raise FileError(f"{file}: unpacked it has more than {LARGEST_TABLE} bytes")
        with np.load(path, allow_pickle=False) as arrays:
            return {name: _column(file, name, arrays[name]) for name in arrays.files}
    except _BROKEN as error:
        if "pickle" in str(error) or "Object arrays" in str(error):
            raise FileError(f"{file}: it holds Python objects; pickles are never read") from None
        raise FileError(f"{file}: not an npz file with plain arrays ({error})") from None


def _column(file: str, name: str, array: np.ndarray[Any, Any]) -> Vector:
    if array.ndim != 1 or array.dtype.kind not in "iuf":
        raise FileError(
            f"{file}: array {shown(name)} has shape {array.shape} and type {array.dtype}, expected a row of "
            "numbers"
        )
    return array.astype(float)


def _parquet(path: Path) -> dict[str, Vector]:
    file = shown_path(str(path))
    try:
        pyarrow: Any = import_module("pyarrow")
        parquet: Any = import_module("pyarrow.parquet")
    except ImportError:
        raise MissingExtraError("pyarrow", "parquet", "reading a Parquet table") from None
    read_bytes(path, LARGEST_TABLE)
    try:
        table = parquet.read_table(path, memory_map=False)
    except (pyarrow.ArrowException, OSError) as error:
        raise FileError(f"{file}: not a Parquet file ({error})") from None
    return {name: _column(file, name, table[name].to_numpy()) for name in table.column_names}
