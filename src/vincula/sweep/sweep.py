"""`vincula.Sweep`: what to compute where, as a value; running it is in `running`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from vincula import __version__
from vincula.errors import ModelError
from vincula.kernels.compiled import CompiledMechanism, compile_mechanism
from vincula.kernels.inputs import Given
from vincula.kernels.lane_closing import lane_closing
from vincula.kernels.quantities import Quantity, chosen
from vincula.mechanism.mechanism import Mechanism
from vincula.sweep.chunks import Chunking
from vincula.sweep.fingerprint import fingerprint
from vincula.sweep.inputs import Inputs, inputs_for
from vincula.sweep.layout import SCHEMA, Layout, layout_of
from vincula.sweep.ledger import FORMAT
from vincula.sweep.points import Grid, Points
from vincula.sweep.scattered import LowDiscrepancyPoints, RandomPoints
from vincula.sweep.work import Block, Work
from vincula.weights import Weights

if TYPE_CHECKING:
    import xarray

    from vincula.kernels.lanes.closing import LaneClosing
    from vincula.sweep.dataset import SweepData
    from vincula.sweep.progress import Tell

IN_MEMORY: Final = 10_000_000
"""Most points that `to_xarray` computes without a file."""


class Sweep:
    """Chosen quantities of a mechanism over many points.

    Args:
        mechanism: The mechanism, a function of parameters that makes it, or a compiled one.
        over: Where to go: `Grid`, `Polyline`, `RandomPoints`, `LowDiscrepancyPoints`, `PointTable`, or
            values by variable for a grid.  Variables are motors, joints or axes by name, components of the
            reference member's pose (`reference.x` ... `reference.yaw`, in the plane `reference.angle`), and
            parameters [m, rad].
        quantities: What to compute, by name (see `vincula.compile(...).quantities`).
        given: What the points are: `motors` and `reference` close the loops for motor values or a pose,
            `configuration` takes joint values as they are.  By default poses where a component of
            one is a variable, motor values where there are loops to close, else configurations.
        start: Configuration that the sweep starts from, home for joints not named; it decides the assembly
            branch.  Closed first when it is open.
        weights: Weights; by default those of the mechanism.
        build: A function of the parameters that makes the mechanism.
        chunk: Points of a chunk, or its shape; a work unit, and what is lost at most when a run is killed.
        name: What the data set is called; by default as the mechanism.

    Raises:
        ModelError: Variables, points or sizes that cannot be used; see the subclasses.
        UnknownNameError: A variable or quantity that does not exist.
        ClosureError: The start cannot be closed.
    """

    def __init__(
        self,
        mechanism: Mechanism | CompiledMechanism | Callable[..., Mechanism],
        over: Points | Mapping[str, ArrayLike],
        quantities: Iterable[str] = ("kinematic.efficiencies",),
        *,
        given: Given | None = None,
        start: Mapping[str, Any] | None = None,
        weights: Weights | None = None,
        build: Callable[..., Mechanism] | None = None,
        chunk: int | Sequence[int] | None = None,
        name: str | None = None,
    ) -> None:
        if not isinstance(mechanism, CompiledMechanism):
            mechanism = compile_mechanism(mechanism, weights=weights, build=build)
        elif weights is not None or build is not None:
            raise ModelError("weights and build belong to vincula.compile when a compiled mechanism is given")
        self.compiled = mechanism
        self.points = over if isinstance(over, Points) else Grid(over)
        self.name = name or self.mechanism.name
        self.quantities: tuple[Quantity, ...] = chosen(self.compiled.quantities, quantities)
        self.chunking = Chunking.of(self.points.shape, chunk)
        self.inputs: Inputs = inputs_for(self.compiled, self.points.variables, given, start)
        self.source: Mapping[str, Any] = {}
        # Refuses bad weights and indices over mixed units now, not in the middle of a run.
        self.compiled.evaluate(np.empty((0, len(self.compiled.coordinates))), self._asked)

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.points.shape))
        return (
            f"Sweep({self.name}: {shape} points over {', '.join(self.points.variables)}; "
            f"{self.chunking.count} chunks)"
        )

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.compiled.mechanism

    @property
    def _asked(self) -> tuple[str, ...]:
        return tuple(quantity.name for quantity in self.quantities)

    @cached_property
    def work(self) -> Work:
        """What all chunks have in common."""
        scattered = isinstance(self.points, (RandomPoints, LowDiscrepancyPoints))
        return Work(self.compiled, self.inputs, self._asked, scattered)

    @cached_property
    def closing(self) -> LaneClosing | str:
        """The closing of its points in lanes; or why they are closed one by one."""
        return lane_closing(self.mechanism, self.inputs.given)

    @cached_property
    def layout(self) -> Layout:
        """The data set: arrays, dimensions, attributes."""
        about = {
            "schema": SCHEMA,
            "title": self.name,
            "vincula_version": __version__,
            "mechanism": self.mechanism.name,
            "model_hash": self.manifest["model"],
            "sweep_hash": self.manifest["points"],
            "given": self.inputs.given,
            "reference": self.mechanism.reference.label if self.mechanism.reference else "",
            "motors": list(self.mechanism.active),
        }
        return layout_of(self.points, self.chunking, self.inputs.variables, self.quantities, about)

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """Everything that makes this sweep what it is; a resumed sweep must have the same."""
        reference = self.mechanism.reference
        model = {
            "mechanism": self.mechanism,
            "weights": self.compiled.weights,
            "builder": _name_of(self.compiled.build),
            "reference": reference,
        }
        return {
            "format": FORMAT,
            "name": self.name,
            "mechanism": self.mechanism.name,
            "model": fingerprint(model),
            "points": fingerprint(self.points.description()),
            "seed": getattr(self.points, "seed", None),
            "variables": [[v.name, v.kind, v.target] for v in self.inputs.variables],
            "given": self.inputs.given,
            "start": fingerprint({**self.inputs.start}) if self.inputs.given != "configuration" else "",
            "base": fingerprint(self.inputs.base),
            "quantities": list(self._asked),
            "shape": list(self.points.shape),
            "block": list(self.chunking.block),
            "chunks": self.chunking.count,
            "bytes": self.layout_bytes,
            "code": code_version(),
        }

    @property
    def layout_bytes(self) -> int:
        """Bytes of one chunk, all arrays together."""
        about = layout_of(self.points, self.chunking, self.inputs.variables, self.quantities, {})
        return about.chunk_bytes()

    def run(
        self,
        output: str | os.PathLike[str] | None = None,
        *,
        jobs: int | None = None,
        threads: int | None = None,
        scheduler: str | None = None,
        shard: tuple[int, int] | None = None,
        resume: bool = False,
        overwrite: bool = False,
        hang_after: float | None = None,
        progress: Tell | None = None,
    ) -> SweepData:
        """Compute everything and store it; what is stored survives whatever happens to this process.

        Args:
            output: Folder of the data set (zarr); by default `NAME.zarr`.  The ledger is the file
                `OUTPUT.ledger` beside it.
            jobs: Worker processes; by default threads of this process.
            threads: Threads, when there are no worker processes; by default one a core.
            scheduler: Address of a dask scheduler, whose workers then do the work (extra `dask`).
            shard: `(i, n)`: compute the i-th of n shares only, in files of its own; `vincula.merge_shards`
                makes one data set of them.
            resume: Go on with what is there.
            overwrite: Remove an earlier sweep of that name first.
            hang_after: Seconds after which the worker of a chunk counts as hung; by default five minutes
                and twenty times the slowest chunk so far.
            progress: Called with what is done.

        Returns:
            The data set.

        Raises:
            SweepError: Another process is at it, there is something else, no room, a damaged ledger.
            MissingExtraError: A package is missing.
            KeyboardInterrupt: Interrupted; running chunks were finished or dropped, `resume` goes on.
        """
        from vincula.sweep.executors import executor_for
        from vincula.sweep.running import run

        target = Path(output if output is not None else f"{self.name}.zarr")
        executor = executor_for(self.work, jobs, threads, scheduler, hang_after)
        return run(self, target, executor, shard=shard, resume=resume, overwrite=overwrite, tell=progress)

    def block(self, chunk: int, threads: int | None = None) -> Block:
        """The numbers of one chunk, computed here and now.

        Args:
            chunk: Its number.
            threads: Threads to use; by default one a core.
        """
        from vincula.sweep.starts import all_starts

        start = all_starts(self, upto=chunk)[chunk] if self.work.closes else None
        return self.work.evaluate(self.values(chunk), self.chunking.extent(chunk), start, threads)

    def values(self, chunk: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The points of a chunk: one row a point, one column a variable."""
        return self.points.at(self.chunking.indices(chunk))

    def to_xarray(self) -> xarray.Dataset:
        """Everything computed here and now, in memory: for small sweeps.

        Raises:
            ModelError: More than ten million points.
            MissingExtraError: xarray is not installed.
        """
        from vincula.sweep.dataset import in_memory

        if self.points.count > IN_MEMORY:
            raise ModelError(
                f"{self.points.count} points are too many to compute without a file: run(...) stores them"
            )
        return in_memory(self)


def code_version() -> str:
    """What computes: results of other versions may differ in their last digits."""
    import scipy

    try:
        import numba

        fast = f"numba {numba.__version__}"
    except ImportError:
        fast = "no numba"
    return f"vincula {__version__}, numpy {np.__version__}, scipy {scipy.__version__}, {fast}"


def _name_of(build: Callable[..., Mechanism] | None) -> str:
    return (
        "" if build is None else f"{build.__module__}.{getattr(build, '__qualname__', type(build).__name__)}"
    )
