"""CONFIG: a configuration as `name=value,...`, as a JSON or YAML file, or as `key:NAME`."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import TYPE_CHECKING, Final

from vincula.errors import FileError, ModelError, UnknownNameError
from vincula.files.digits import is_number
from vincula.files.expressions import evaluate, is_expression
from vincula.files.joint_values import JointValues
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.problems import shown
from vincula.files.units import SI, Units
from vincula.spatial.units import quantity

if TYPE_CHECKING:
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism

_KEY: Final = "key:"
_LONGEST: Final = 10_000
_ASSIGNMENT: Final = re.compile(
    r"""\s*(?:"(?P<double>[^"]+)"|'(?P<single>[^']+)'|(?P<plain>[^"'=,\s][^=,]*?))\s*=\s*"""
    r"""(?P<value>\[[^\]]*\]|[^,\[\]=]+?)\s*(?:,|$)"""
)


def read_configuration(
    text: str, mechanism: Mechanism, units: Units = SI, limits: Limits = DEFAULT_LIMITS
) -> Configuration:
    """The configuration that a CONFIG text describes.

    Args:
        text: `name=value,...` (several values in brackets, names with a comma in quotes, a unit or
            an expression where wanted: `b=30deg`, `b=pi/6`), the path of a JSON or YAML file, or
            `key:NAME` for a keyframe.
        mechanism: Joints that are not named keep its home values.
        units: Units of the model file.
        limits: Limits of the file.

    Raises:
        FileError: A file that cannot be read, or does not fit the mechanism.
        ModelError: A text, a name or a value that cannot be used.
    """
    if text.startswith(_KEY):
        return _keyframe(text[len(_KEY) :], mechanism)
    if is_text(text):
        return _from_text(text, mechanism, units)
    return _from_file(text, mechanism, units, limits)


def is_text(text: str) -> bool:
    """Whether a CONFIG is `name=value,...` and no keyframe or file."""
    ending = PurePath(text).suffix.lower()
    return not text.startswith(_KEY) and "=" in text and ending not in (".json", ".yaml", ".yml")


def _keyframe(name: str, mechanism: Mechanism) -> Configuration:
    if name not in mechanism.keyframes:
        raise UnknownNameError("keyframe", name, mechanism.keyframes)
    return mechanism.configuration(dict(mechanism.keyframes[name]))


def _from_text(text: str, mechanism: Mechanism, units: Units) -> Configuration:
    values = JointValues(mechanism, units)
    for name, words in assignments(text).items():
        flags = values.linear(name)
        if len(words) != len(flags):
            raise ModelError(
                f"{name} has {len(flags)} values, got {len(words)}: {_example(name, len(flags))}"
            )
        plain = [_plain(word, f"value of {name!r}") for word in words]
        if all(number is not None for number in plain):
            values.put(name, [number for number in plain if number is not None])
            continue
        numbers = []
        for word, number, flag in zip(words, plain, flags, strict=True):
            if flag is None:
                numbers.append(quantity(word, "number", f"value of {name!r}"))
            elif number is None:
                numbers.append(quantity(word, "length" if flag else "angle", f"value of {name!r}"))
            else:
                numbers.append(units.inside(number, flag))
        values.put_inside(name, numbers)
    return mechanism.configuration(values.values)


def assignments(text: str) -> dict[str, list[str]]:
    """Names and value words of `name=value,...`.

    Raises:
        ModelError: Another form, or a name given twice.
    """
    found: dict[str, list[str]] = {}
    text, at = text.strip(), 0
    if len(text) > _LONGEST:
        raise ModelError(f"cannot read {shown(text)}: longer than {_LONGEST} characters; put it in a file")
    while at < len(text) or not found:
        match = _ASSIGNMENT.match(text, at)
        if match is None:
            raise ModelError(
                f"cannot read {shown(text[at:].strip())}: expected name=value,name=value (several values in "
                "brackets, a name with a comma in quotes)"
            )
        name = match["double"] or match["single"] or match["plain"]
        if name in found:
            raise ModelError(f"{shown(name)} is given twice")
        value = match["value"]
        separator = r"[\s,]+" if value.startswith("[") else r"\s+"
        words = [word for word in re.split(separator, value.strip("[]").strip()) if word]
        found[name] = _joined_units(words)
        at = match.end()
    return found


def _joined_units(words: list[str]) -> list[str]:
    """Words with a unit after a blank (`30 deg`) put together again."""
    joined: list[str] = []
    for word in words:
        if joined and word in ("m", "mm", "cm", "in", "rad", "deg") and is_number(joined[-1]):
            joined[-1] += word
        else:
            joined.append(word)
    return joined


def _plain(word: str, what: str) -> float | None:
    """The value of a number or expression without a unit; None for anything with one."""
    if is_number(word):
        return quantity(word, "number", what)
    return evaluate(word, {}).value if is_expression(word) else None


def _example(name: str, count: int) -> str:
    if count == 1:
        return f"write {name}=0.5"
    return (
        f"write {name}=[{','.join('1' if i == count - 4 and count in (4, 7) else '0' for i in range(count))}]"
    )


def _from_file(path: str, mechanism: Mechanism, units: Units, limits: Limits) -> Configuration:
    from vincula.files.schema import ConfigurationFile
    from vincula.files.schema_problems import validated
    from vincula.files.schema_values import Context
    from vincula.files.source import open_source
    from vincula.files.treefile import read_tree

    try:
        source = open_source(path, limits)
    except FileError as error:
        raise FileError(
            f"{error} (a configuration is name=value,..., a JSON or YAML file, or key:NAME)"
        ) from None
    document = read_tree(source, limits)
    content = validated(document, ConfigurationFile, Context(limits=limits))
    values = JointValues(mechanism, units)
    for name, given in content.root.items() if content else ():
        numbers = [n.value for n in given] if isinstance(given, list) else [given.value]
        try:
            values.put(name, numbers)
        except ModelError as error:
            document.problems.add(document.place([name]), str(error))
    document.problems.refuse_if_any()
    return mechanism.configuration(values.values)
