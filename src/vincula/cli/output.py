"""What leaves the program: one JSON object on stdout, warnings on stderr."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from vincula.errors import MixedUnitsWarning, RankAmbiguityWarning

if TYPE_CHECKING:
    from vincula.analysis.result import Analysis
    from vincula.model import LinearModel


def print_json(value: Mapping[str, Any]) -> None:
    """One object on stdout, plain ASCII, never NaN."""
    click.echo(json.dumps(value, indent=2, allow_nan=False))


def said_warnings(analyses: Iterable[Analysis]) -> list[str]:
    """The warnings of analyses for somebody at the command line, each once.

    What the library says about mixed units speaks of Python; here one sentence names the option.
    """
    texts: list[str] = []
    for analysis in analyses:
        kinds = analysis.classified_warnings
        texts += [text for text, kind in kinds if not issubclass(kind, MixedUnitsWarning)]
        if any(issubclass(kind, MixedUnitsWarning) for _, kind in kinds):
            texts.append(mixed_units_advice(analysis.model))
    return list(dict.fromkeys(texts))


def mixed_units_advice(model: LinearModel) -> str:
    """What to do about unit weights over metres and radians, at the command line."""
    length = model.length or 1.0
    square = f"{length * length:.3g}"
    twist = ",".join("1" if linear else square for linear in model.twist_linear)
    return (
        "metres and radians are added with unit weights: the efficiencies depend on the unit of length. "
        f"Give --weights, for example 'twist={twist};reciprocal', where a radian counts as the arc at "
        f"{length:g} m"
    )


def tell(texts: Iterable[str]) -> None:
    """Warnings as lines on stderr."""
    for text in texts:
        click.echo(f"warning: {text}", err=True)


@contextmanager
def warnings_on_stderr(*, quiet: bool = False) -> Iterator[list[str]]:
    """Warnings as single lines on stderr, each once.

    What is put into the list that it gives is told instead of the library's advice on mixed units.

    Args:
        quiet: Leave out doubt and mixed units, which the command tells itself (`said_warnings`).
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        warnings.simplefilter("always", RankAmbiguityWarning)
        warnings.simplefilter("always", MixedUnitsWarning)
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        advice: list[str] = []
        try:
            yield advice
        finally:
            own = (RankAmbiguityWarning, MixedUnitsWarning)
            texts: list[str] = []
            for warning in caught:
                if quiet and issubclass(warning.category, own):
                    continue
                instead = advice if issubclass(warning.category, MixedUnitsWarning) else []
                texts += instead or [str(warning.message)]
            tell(dict.fromkeys(texts))
