"""From a sweep file to the sweep: its model with everything asked for, its points, its output."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from inspect import Parameter, Signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from vincula.errors import FileError, SweepError, VinculaError
from vincula.files.load import EXAMPLE

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.files.sweep_file import SweepFile
    from vincula.mechanism.mechanism import Mechanism
    from vincula.sweep.sweep import Sweep


_OPTION: Final = re.compile(r"--([a-z]+):? ")
"""How messages about the common options begin; the keys of a sweep file have their names."""


@dataclass(frozen=True, slots=True)
class SubjectBuilder:
    """Makes the mechanism of a sweep file, with parameters at other values; other processes can import it.

    Attributes:
        file: The model file, or example:NAME.
        settings: Parameters that the sweep file sets.
        options: The common options, by name.
        active: Motors; None for those of the model file.
        weights: Weights; None for those of the model file.
        names: Parameters that the model declares.
    """

    file: str
    settings: tuple[tuple[str, float | str], ...]
    options: tuple[tuple[str, Any], ...]
    active: str | None
    weights: str | None
    names: tuple[str, ...] = field(default=())

    def __call__(self, **values: float) -> Mechanism:
        """The mechanism with these parameter values, in the units of the model file."""
        return self.subject(**values).mechanism

    @property
    def __signature__(self) -> Signature:
        """The parameters by name, as a function of them would have."""
        return Signature([Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in self.names])

    def subject(self, **values: float) -> Subject:
        """The mechanism and the configuration of `at`."""
        from vincula.cli.subject import read_subject

        parameters: dict[str, Any] = {**dict(self.settings), **values}
        subject = read_subject(self.file, parameters=parameters, **dict(self.options))
        return subject.with_active(self.active).with_weights(self.weights)


def sweep_of(file: SweepFile) -> Sweep:
    """The sweep that a sweep file describes.

    Raises:
        FileError: Something in it cannot be used, with its place.
    """
    from vincula.kernels.compiled import compile_mechanism
    from vincula.sweep.inputs import inputs_for
    from vincula.sweep.sweep import Sweep

    entry = file.entry
    builder = _builder(file)
    subject = _placed(file, "model", builder.subject)
    build = builder if builder.names else None
    compiled = _placed(file, "model", lambda: compile_mechanism(subject.mechanism, build=build))
    start = subject.configuration if entry.at is not None else None
    inputs = _placed(file, file.kind, lambda: inputs_for(compiled, file.variables(), entry.given, start))
    units = {variable.name: variable.unit for variable in inputs.variables}
    points = file.points(units.__getitem__, subject.report.units)
    sweep: Sweep = _placed(
        file,
        "quantities",
        lambda: Sweep(
            compiled,
            points,
            entry.quantities,
            given=entry.given,
            start=start,
            chunk=entry.chunk,
            name=entry.name,
        ),
    )
    sweep.source = {"sweep_file": str(Path(file.document.file).absolute())}
    return sweep


def output_of(file: SweepFile, asked: str | None) -> Path:
    """The folder of the data set: `--output`, the file's own `output`, or the file's name with `.zarr`."""
    if asked is not None:
        return Path(asked)
    if file.entry.output is not None:
        return file.path(file.entry.output)
    return Path(file.document.file).with_suffix(".zarr")


def sweep_file_of(target: str) -> tuple[str, str | None]:
    """The sweep file of TARGET, and the data set when TARGET is one.

    Raises:
        SweepError: There is no such thing, or the sweep was not begun from a file.
    """
    from vincula.sweep.ledger import Ledger
    from vincula.sweep.running import Places

    path = Path(target)
    if not path.is_dir() and not Places(path).ledger.exists():
        return target, None
    with Ledger(Places(path.absolute()).ledger) as ledger:
        file = ledger.manifest.get("source", {}).get("sweep_file")
    if file is None:
        raise SweepError(
            f"{target}: the sweep was begun in Python; go on there with run(..., resume=True)", kind="usage"
        )
    if not Path(file).is_file():
        raise SweepError(
            f"{target}: its sweep file {file} is gone; go on with: "
            f"vincula sweep resume SWEEP.yaml -o {target}",
            kind="usage",
        )
    return file, target


def _builder(file: SweepFile) -> SubjectBuilder:
    from vincula.files.load import declared_parameters

    entry = file.entry
    model = entry.model if entry.model.startswith(EXAMPLE) else str(file.path(entry.model).absolute())
    options: dict[str, Any] = {
        "lock": _text(entry.lock),
        "reference": entry.reference,
        "axes": entry.axes,
        "at": entry.at,
        "tolerance": entry.tolerance,
        "loops": tuple(str(file.path(text).absolute()) for text in entry.loops),
        "ground": entry.ground,
    }
    names = _placed(file, "model", lambda: declared_parameters(model))
    settings = tuple((name, value) for name, value in entry.set.items())
    return SubjectBuilder(model, settings, tuple(options.items()), _text(entry.active), entry.weights, names)


def _text(names: str | Sequence[str] | None) -> str | None:
    return names if names is None or isinstance(names, str) else ",".join(_quoted(name) for name in names)


def _quoted(name: str) -> str:
    return f'"{name}"' if "," in name else name


def _placed(file: SweepFile, key: str, action: Any) -> Any:
    """What the action returns; what it refuses is told with the place of the key in the sweep file."""
    try:
        return action()
    except FileError:
        raise
    except VinculaError as error:
        option = _OPTION.match(str(error))
        if option is None:
            file.refuse((key,), error)
        file.refuse((option[1],), VinculaError(str(error)[option.end() :]))
