"""`--weights`: a weights file, a text like `twist=1,1,1,5,5,5`, or `limits`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from vincula.errors import FileError, ModelError, UnknownNameError, WeightError
from vincula.files.expressions import Measured
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.mechanism.motor_weights import refuse_misfit, weights_from_limits
from vincula.spatial.units import quantity
from vincula.weights import QUANTITIES, Weights

if TYPE_CHECKING:
    from vincula.files.schema import WeightsEntry
    from vincula.mechanism.mechanism import Mechanism

LIMITS = "limits"
"""The word for weights 1/limit^2 from the limits in the model file."""


def read_weights(text: str, mechanism: Mechanism, limits: Limits = DEFAULT_LIMITS) -> Weights:
    """The weights that a text describes; always in m, rad, N and N m.

    Args:
        text: `limits`; `twist=1,1,1,5,5,5` (several quantities separated by `;`, names as
            `rate=o1:4,o5:1`, `reciprocal` alone); or the path of a YAML or JSON file with the keys
            rate, twist, torque, wrench, contact_force, reciprocal.
        mechanism: Whose limits `limits` takes.
        limits: Limits of the file.

    Raises:
        FileError: A file that cannot be read.
        ModelError: A text that is no weight.
    """
    if text.strip() == LIMITS:
        return weights_from_limits(mechanism)
    if "=" in text and PurePath(text).suffix.lower() not in (".json", ".yaml", ".yml"):
        return _from_text(text)
    return _from_file(text, mechanism, limits)


def _from_text(text: str) -> Weights:
    found: dict[str, object] = {}
    for part in filter(None, (part.strip() for part in text.split(";"))):
        name, equals, value = (word.strip() for word in part.partition("="))
        if name not in (*QUANTITIES, "reciprocal"):
            raise UnknownNameError("weight", name[:80], (*QUANTITIES, "reciprocal"))
        if name in found:
            raise WeightError(f"weight {name!r} is given twice")
        if name == "reciprocal" and (not equals or value in ("true", "false")):
            found[name] = value != "false"
            continue
        if not value:
            raise WeightError(f"cannot read {part!r}: expected a weight like twist=1,1,1,5,5,5")
        found[name] = value if value == "all rows" else _numbers(value, name)
    return Weights.from_mapping(found)


def _numbers(text: str, name: str) -> object:
    words = [word.strip() for word in text.split(",")]
    if any(":" in word for word in words):
        named = {}
        for word in words:
            key, _, value = word.rpartition(":")
            if key.strip() in named or not key.strip():
                raise WeightError(
                    f"weight {name}: cannot read {word!r}, expected each name once, as name:number"
                )
            named[key.strip()] = quantity(value, "number", f"weight {name}[{key.strip()!r}]")
        return named
    numbers = [quantity(word, "number", f"weight {name}") for word in words]
    return numbers[0] if len(numbers) == 1 else numbers


def _from_file(path: str, mechanism: Mechanism, limits: Limits) -> Weights:
    from vincula.files.schema import WeightsEntry
    from vincula.files.schema_problems import validated
    from vincula.files.schema_values import Context
    from vincula.files.source import open_source
    from vincula.files.treefile import read_tree

    try:
        source = open_source(path, limits)
    except FileError as error:
        raise FileError(f"{error} (weights are a file, a text like twist=1,1,1,5,5,5, or limits)") from None
    document = read_tree(source, limits)
    entry = validated(document, WeightsEntry, Context(limits=limits))
    weights = None
    wrong = list(weight_problems(entry, mechanism)) if entry is not None else []
    for key, message in wrong:
        document.problems.add(document.place([key]), message)
    if entry is not None and not wrong:
        try:
            weights = weights_of_entry(entry)
        except ModelError as error:
            document.problems.add(document.place([]), str(error))
    if weights is None:
        document.problems.refuse()
    document.problems.refuse_if_any()
    return weights


def weight_problems(entry: WeightsEntry, mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """What is wrong with each weight of a validated table, as its key and words.

    Args:
        entry: The table.
        mechanism: Whose motors, twists and wrenches are weighed.
    """
    for key in QUANTITIES:
        value = _values(getattr(entry, key))
        if value is None:
            continue
        try:
            refuse_misfit(Weights.from_mapping({key: value}), key, mechanism)
        except ModelError as error:
            yield key, str(error)


def weights_of_entry(entry: WeightsEntry) -> Weights:
    """The weights of a validated table.

    Raises:
        ModelError: Numbers that are no weights.
    """
    given = {name: _values(getattr(entry, name)) for name in type(entry).model_fields}
    return Weights.from_mapping({name: value for name, value in given.items() if value is not None})


def _values(given: Any) -> Any:
    """Numbers without their digits, in whatever they are put together."""
    if isinstance(given, Measured):
        return given.value
    if isinstance(given, list):
        return [_values(item) for item in given]
    if isinstance(given, dict):
        return {name: _values(item) for name, item in given.items()}
    return given
