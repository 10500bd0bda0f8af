"""Compiling the kernels before they are needed: once a machine, kept on disk."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import MissingExtraError, VinculaError
from vincula.kernels.compiled import CompiledMechanism, compile_mechanism
from vincula.kernels.lane_path import numba_is_installed
from vincula.mechanism.catalog.registry import entry
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.inputs import Given
    from vincula.mechanism.mechanism import Mechanism

EXAMPLE: Final = "stewart"
"""Kernels do not depend on the mechanism: one that has closing, contacts and parameters stands for all."""
_QUANTITIES: Final = ("kinematic.efficiencies", "reference.pose")
SQUEEZING: Final = "two-finger-grasp"
"""One with internal forces and structural wrenches, for what is computed from the results of kernels."""
_REST: Final = (
    "internal_force.task_directions",
    "passive_force.task_directions",
    "kinematic.condition:translation",
    "singularity.distance",
)


def warm_up() -> dict[str, float]:
    """Compile every kernel, or load it from the disk, by running it once.

    Whatever is evaluated afterwards on this machine finds them ready.

    Returns:
        Seconds by what was run.

    Raises:
        MissingExtraError: numba is not installed.
        VinculaError: A kernel did not run.
    """
    if not numba_is_installed():
        raise MissingExtraError("numba", "fast", "compiling kernels")
    compiled = compile_mechanism(_made, build=_made)
    motors = np.array([compiled.mechanism.home[name][0] for name in compiled.mechanism.active])
    pose = compiled.evaluate(None, ("reference.pose",), path="reference")["reference.pose"]
    other = compile_mechanism(entry(SQUEEZING).mechanism({}), weights=Weights(twist=[1.0, 1.0, 0.0]))
    works: dict[str, Callable[[], int]] = {}
    for many in (False, True):
        words = "many at a time" if many else "one at a time"
        works[f"configurations, {words}"] = partial(_run, compiled, compiled.flat(), "configuration", many)
        works[f"motors, {words}"] = partial(_run, compiled, motors, "motors", many)
        works[f"poses, {words}"] = partial(_run, compiled, pose, "reference", many)
        works[f"dimensions a lane, {words}"] = partial(_dimensions, compiled, many)
        works[f"forces and distances, {words}"] = partial(
            _run, other, other.flat(), "configuration", many, _REST
        )
    seconds = {}
    for words, work in works.items():
        began = time.perf_counter()
        if work():
            raise VinculaError(f"the kernel for {words} did not give what it should")
        seconds[words] = time.perf_counter() - began
    return seconds


def first_wait() -> str:
    """What to tell somebody whose first batch has to wait for the compiler; empty where none has to."""
    if not numba_is_installed() or any(cache_folder().glob("**/entries.spectra_entry.*.nbi")):
        return ""
    return (
        "the kernels of batches are compiled first, once on this machine: some minutes "
        "(`vincula warm-up` does it beforehand)"
    )


def cache_folder() -> Path:
    """Where compiled kernels are kept: beside their source, or for the user where that is read-only."""
    own = Path(__file__).parent / "lanes"
    asked = os.environ.get("NUMBA_CACHE_DIR")
    if asked:
        return Path(asked)
    if os.access(own, os.W_OK):
        return own / "__pycache__"
    from numba.misc.appdirs import AppDirs

    return Path(AppDirs(appname="numba", appauthor=False).user_cache_dir)


def _made(**values: float) -> Mechanism:
    return entry(EXAMPLE).mechanism(values)


def _run(
    compiled: CompiledMechanism,
    values: Vector,
    given: Given,
    many: bool,
    quantities: tuple[str, ...] = _QUANTITIES,
) -> int:
    lanes = np.stack([values] * 64) if many else values
    return int(compiled.evaluate(lanes, quantities, given=given, path="lanes").status.max())


def _dimensions(compiled: CompiledMechanism, many: bool) -> int:
    heights = np.full(64, 2.0) if many else np.array(2.0)
    found = compiled.evaluate(None, _QUANTITIES, parameters={"height": heights}, path="lanes")
    return int(found.status.max())
