"""What leaves the program: one JSON object on stdout, warnings on stderr."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import click

from vincula.errors import MixedUnitsWarning, RankAmbiguityWarning


def print_json(value: Mapping[str, Any]) -> None:
    """One object on stdout, plain ASCII, never NaN."""
    click.echo(json.dumps(value, indent=2, allow_nan=False))


@contextmanager
def warnings_on_stderr(*, quiet: bool = False) -> Iterator[None]:
    """Warnings as single lines on stderr, each once.

    Args:
        quiet: Leave out those of vincula itself, where the page shows them in their place.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        warnings.simplefilter("always", RankAmbiguityWarning)
        warnings.simplefilter("always", MixedUnitsWarning)
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        try:
            yield
        finally:
            own = (RankAmbiguityWarning, MixedUnitsWarning)
            texts = [
                str(warning.message)
                for warning in caught
                if not (quiet and issubclass(warning.category, own))
            ]
            for text in dict.fromkeys(texts):
                click.echo(f"warning: {text}", err=True)
