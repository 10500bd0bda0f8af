"""Mobility, statics and manipulability of closed-chain mechanisms with active and passive joints.

The public names live here and are imported on first use, so that `import vincula` stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from vincula.errors import (
        ClosureError,
        DuplicateNameError,
        FileError,
        MissingExtraError,
        MissingReferenceError,
        MixedUnitsError,
        MixedUnitsWarning,
        ModelError,
        NonFiniteError,
        RankAmbiguityWarning,
        ShapeError,
        TopologyError,
        UnknownNameError,
        UnsupportedFeatureError,
        VinculaError,
        WeightError,
    )
    from vincula.model import LinearModel

__all__ = [
    "ClosureError",
    "DuplicateNameError",
    "FileError",
    "LinearModel",
    "MissingExtraError",
    "MissingReferenceError",
    "MixedUnitsError",
    "MixedUnitsWarning",
    "ModelError",
    "NonFiniteError",
    "RankAmbiguityWarning",
    "ShapeError",
    "TopologyError",
    "UnknownNameError",
    "UnsupportedFeatureError",
    "VinculaError",
    "WeightError",
]

_MODULES = {
    "vincula.errors": (
        "ClosureError DuplicateNameError FileError MissingExtraError MissingReferenceError MixedUnitsError "
        "MixedUnitsWarning ModelError NonFiniteError RankAmbiguityWarning ShapeError TopologyError "
        "UnknownNameError UnsupportedFeatureError VinculaError WeightError"
    ),
    "vincula.model": "LinearModel",
}
_HOME = {name: module for module, names in _MODULES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    """The public name, imported from its module now and kept."""
    module = _HOME.get(name)
    if module is None:
        raise AttributeError(f"module 'vincula' has no attribute {name!r}")
    value = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
