"""Known mechanisms with known answers: `example("five-bar")`, `examples()`; one file an example.

Each is drawn with the ordinary constructors and carries its motors, its reference member and explicit
unit weights, so that every analysis runs on it as it is.
"""

from vincula.mechanism.catalog.registry import example, examples

__all__ = ["example", "examples"]
