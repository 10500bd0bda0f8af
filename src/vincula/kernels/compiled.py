"""`vincula.compile`: a mechanism prepared once, evaluated at as many configurations as one likes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.arrays import Vector
from vincula.errors import ModelError, ShapeError, listing
from vincula.kernels.evaluation import Evaluation
from vincula.kernels.inputs import Batch, Given, batch_of
from vincula.kernels.plans import Plan, plan_for, refuse_bad_weights
from vincula.kernels.quantities import Quantity, available, chosen, coordinates
from vincula.kernels.reference_path import ReferencePath
from vincula.kernels.runner import Runner
from vincula.kernels.samples import general_ranks
from vincula.kernels.variants import Builder, Variants
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.gradients import Gradient

PathName = Literal["auto", "lanes", "reference"]
"""How a batch is computed: in lanes where that is certain, in lanes or not at all, or one by one."""

_PATHS: Final = get_args(PathName)

Values = ArrayLike | Mapping[str, Any] | None


class CompiledMechanism:
    """A mechanism prepared for many configurations; make one with `vincula.compile`.

    It may be used from several threads, and pickles.

    Attributes:
        mechanism: The mechanism.
        weights: Weights of all evaluations; None for those of the mechanism.
        build: What makes the mechanism from parameters; None where it has none.
        variants: The mechanisms by parameter values.
        coordinates: Names of the numbers of one configuration, in order [m, rad, quaternions w x y z].
    """

    def __init__(self, mechanism: Mechanism, weights: Weights | None, build: Builder | None) -> None:
        self.mechanism, self.weights, self.build = mechanism, weights, build
        self.coordinates = coordinates(mechanism)
        self._quantities = available(mechanism)
        self.variants = Variants(mechanism, build)
        self._plans: dict[tuple[str, ...], Plan] = {}
        self._runner = Runner(mechanism, weights, self.variants)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.mechanism, self.weights, self.build)

    def __repr__(self) -> str:
        return f"CompiledMechanism({self.mechanism.name}: {len(self.coordinates)} coordinates)"

    @cached_property
    def general_ranks(self) -> tuple[int, ...]:
        """Ranks of the watched matrices away from singularities."""
        return general_ranks(self.mechanism)

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Everything that can be asked for, by name."""
        return self._quantities

    def flat(self, values: Mapping[str, Any] | None = None) -> Vector:
        """One configuration as a vector in the order of `coordinates`; joints not named are at home.

        Raises:
            UnknownNameError: A joint that does not exist.
            ShapeError: The wrong number of values.
        """
        return self.mechanism.configuration(values).flat

    def configuration(self, flat: ArrayLike) -> Configuration:
        """The configuration of one vector in the order of `coordinates`.

        Raises:
            ShapeError: The wrong number of values.
            NonFiniteError: NaN or infinity.
        """
        return self.mechanism.home.from_flat(np.asarray(flat, dtype=float))

    def evaluate(
        self,
        configurations: Values = None,
        quantities: Iterable[str] = ("kinematic.efficiencies",),
        *,
        given: Given = "configuration",
        start: Values = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        threads: int | None = None,
        path: PathName = "auto",
        alike: bool = False,
    ) -> Evaluation:
        """Chosen quantities over a batch of configurations.

        Leading dimensions may be anything, none and zero included; configurations, starts and
        parameters are broadcast together.  What one configuration gives does not depend on the others,
        with one exception that is wanted: for motors and poses a configuration is closed from the one
        before it along the last dimension (the first from `start`, home by default), unless `start`
        has dimensions of its own; then every one is closed from its own start.

        Args:
            configurations: (..., numbers) array or a mapping for a single one.  For
                `given="configuration"` joint values in the order of `coordinates`, or None for home;
                for "motors" one value a motor in the order of `mechanism.active`; for "reference" the
                pose of the reference point and body axes, x y z qw qx qy qz or x y angle [m, rad].
            quantities: Names out of `quantities`; `status` is always there.
            given: What `configurations` are.
            start: Where closing starts: one configuration, or one a lane.
            parameters: Values of the parameters that the mechanism is built from, one a lane.
            threads: Threads to use; by default one a core.
            path: `auto`, `lanes` or `reference`.
            alike: Whether configurations of other ranks than usual may be computed together, where
                parameters are given: quicker where singular ones are many.  The last digits of theirs then
                depend on what else is in the batch.

        Returns:
            Named arrays and a status; nothing is raised for a configuration that is open, does not
            close, is singular or not finite.

        Raises:
            UnknownNameError: A quantity or parameter that does not exist.
            ShapeError: Arrays of the wrong size, or that do not fit together.
            MixedUnitsError: An index over metres and radians with weights that nobody chose.
            ModelError: Parameters without a builder, or another structure for other parameters.
            MissingExtraError: `path="lanes"` without numba.

        Warns:
            MixedUnitsWarning: Metres and radians are added with weights that nobody chose.
        """
        _refuse_unknown(path, threads)
        plan = self._plan(quantities)
        if type(configurations) is np.ndarray and configurations.ndim == 1 and path != "reference":
            quick = None
            if start is None and not parameters and given == "configuration":
                quick = self._runner.single(plan, configurations)
            elif start is None and not parameters:
                quick = self._runner.single_closed(plan, given, configurations)
            if quick is not None:
                return quick
        settings = parameters or {}
        self.variants.names_checked(settings)
        batch = replace(batch_of(self.mechanism, given, configurations, start, settings), alike=alike)
        arrays, reasons = self._runner.run(plan, batch, path, threads)
        shaped = {name: array.reshape(batch.shape + array.shape[1:]) for name, array in arrays.items()}
        return Evaluation(batch.shape, plan.by_name, shaped, reasons)

    def at(
        self,
        configuration: Values = None,
        quantities: Iterable[str] = ("kinematic.efficiencies",),
        *,
        given: Given = "configuration",
        start: Values = None,
    ) -> Evaluation:
        """Chosen quantities at one configuration: `evaluate` for a control loop.

        Args:
            configuration: One vector, or a mapping; None for home.
            quantities: Names out of `quantities`; quickest when the same tuple is given every time.
            given: What the vector is, as for `evaluate`.
            start: The configuration where closing starts.

        Raises:
            ShapeError: Not one vector of the right size.
            UnknownNameError: A quantity or joint that does not exist.
        """
        found = self.evaluate(configuration, quantities, given=given, start=start)
        if found.shape:
            raise ShapeError("configuration", found.shape, "one configuration; evaluate takes several")
        return found

    def gradient(
        self,
        configurations: Values,
        quantity: str,
        *,
        wrt: str | Sequence[str] = "motors",
        parameters: Mapping[str, ArrayLike] | None = None,
    ) -> Gradient:
        """Exact derivatives of a smooth index or of efficiencies; see `kernels.gradients.gradient`.

        Args:
            configurations: (..., numbers) closed joint values in the order of `coordinates`; None: home.
            quantity: `<ellipsoid>.efficiencies`, `.smallest`, `.largest`, an index, `singularity.distance`.
            wrt: `motors` (passive joints follow), `joints`, or names of parameters (motors stand still).
            parameters: Values of parameters, one a lane.

        Raises:
            ModelError: A quantity that has no derivatives, or parameters without a builder.
            UnknownNameError: A quantity or parameter that does not exist.
            ShapeError: Arrays that do not fit.
        """
        from vincula.kernels.gradients import gradient

        return gradient(self, configurations, quantity, wrt=wrt, parameters=parameters)

    def arrays(self, names: tuple[str, ...], batch: Batch) -> Mapping[str, NDArray[Any]]:
        """Quantities of a batch without a word about their units: what gradients are made from.

        Args:
            names: Names out of `quantities`.
            batch: The batch.
        """
        key = "", *names
        if key not in self._plans:
            quantities = chosen(self._quantities, names)
            self._plans[key] = Plan(quantities, ReferencePath(quantities, self.weights))
        return self._runner.run(self._plans[key], batch, "auto", None)[0]

    def _plan(self, quantities: Iterable[str]) -> Plan:
        if isinstance(quantities, str):
            raise ModelError(
                f"quantities are {quantities!r}: give a list of names, for example [{quantities!r}]"
            )
        names = quantities if type(quantities) is tuple else tuple(quantities)
        found = self._plans.get(names)
        if found is None:
            found = plan_for(self.mechanism, self._quantities, names, self.weights)
            self._plans[names] = found
        return found


def compile_mechanism(
    mechanism: Mechanism | Builder, *, weights: Weights | None = None, build: Builder | None = None
) -> CompiledMechanism:
    """A mechanism prepared for many configurations.

    Args:
        mechanism: The mechanism, with its motors and reference member; or a function of parameters
            with default values that makes it.
        weights: Weights of all evaluations; by default those of the mechanism, else the identity.
        build: A function of the parameters that may differ from lane to lane: called with keyword
            arguments, it makes mechanisms of the same structure (joints, motors, cuts).

    Raises:
        MissingReferenceError: No reference member is named.
        WeightError: Weights that do not fit the mechanism.
        ModelError: Neither a mechanism nor a function that makes one.
    """
    if not isinstance(mechanism, Mechanism):
        if not callable(mechanism):
            raise ModelError(
                f"a mechanism is needed, got {type(mechanism).__name__}: give a Mechanism, or a function "
                "that makes one from parameters"
            )
        build, mechanism = mechanism, mechanism()
        if not isinstance(mechanism, Mechanism):
            raise ModelError(f"the function made {type(mechanism).__name__}, expected a Mechanism")
    refuse_bad_weights(mechanism, weights)
    return CompiledMechanism(mechanism, weights, build)


def _restored(mechanism: Mechanism, weights: Weights | None, build: Builder | None) -> CompiledMechanism:
    """What a pickle of a compiled mechanism makes."""
    return CompiledMechanism(mechanism, weights, build)


def _refuse_unknown(path: str, threads: int | None) -> None:
    if path not in _PATHS:
        raise ModelError(f"path is {path!r}: choose {listing(_PATHS)}")
    if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
        raise ModelError(f"threads is {threads!r}: give a whole number of at least 1, or None for one a core")
