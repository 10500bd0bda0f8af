"""DESIGN.yaml: a design problem, with every problem of the file told at its line and column."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NoReturn, TypeVar

import numpy as np

from vincula.design.capabilities import Force, Speed, Stiffness
from vincula.design.constraints import Bound, Constraint, JointLimits, NoSingularity, Relation
from vincula.design.lengths import Clearance, Distance
from vincula.design.measures import Index, Measure, SingularityDistance, SphereDistance, WorkspaceShare
from vincula.design.problem import DesignProblem
from vincula.design.variables import DesignVariable, Tie
from vincula.errors import FileError, UnknownNameError, VinculaError
from vincula.files.design_builder import Expression, NumbersBuilder, near
from vincula.files.design_schema import ConstraintEntry, DesignEntry, MeasureEntry, VariableEntry
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.load import EXAMPLE
from vincula.files.problems import shown
from vincula.files.schema_problems import validated
from vincula.files.schema_values import Context
from vincula.files.source import open_source
from vincula.files.sweep_file import SweepFile
from vincula.files.sweep_schema import Amount
from vincula.files.tree import Document, Location
from vincula.files.treefile import read_tree
from vincula.files.versions import check_version
from vincula.files.weights import read_weights
from vincula.spatial.units import UNITS

if TYPE_CHECKING:
    from vincula.weights import Weights

Made = TypeVar("Made")
WHERE: Final = ("grid", "path", "random", "low-discrepancy", "table")
KINDS: Final = ("value", "limits", "no-singularity", "distance", "clearance", "measure", "quantity")
"""Keys that say what a constraint is; each has one of them."""


@dataclass(frozen=True, slots=True)
class DesignFile:
    """A design file that fits its schema, and its problem.

    Attributes:
        document: The file, for messages.
        entry: Its content.
        problem: The problem that it describes.
    """

    document: Document
    entry: DesignEntry
    problem: DesignProblem


def read_design(path: str | os.PathLike[str], limits: Limits = DEFAULT_LIMITS) -> DesignFile:
    """The problem of a design file, YAML or JSON.

    Args:
        path: The file; paths in it start from its folder.
        limits: How much a file may hold.

    Raises:
        FileError: It cannot be read or does not fit; every problem with file, line and column.
    """
    document = read_tree(open_source(path, limits), limits)
    check_version(document, "design", "design file")
    entry = validated(document, DesignEntry, Context(limits=limits))
    if entry is None:
        document.problems.refuse()
    document.problems.refuse_if_any()
    return DesignFile(document, entry, _Maker(document, entry).problem())


class _Maker:
    """Turns the entries of a file into a problem; what is refused is told with its place."""

    def __init__(self, document: Document, entry: DesignEntry) -> None:
        self._document, self._entry = document, entry
        self._folder = Path(document.file).parent
        self._builder = self._model()
        self._units = self._placed(("model",), lambda: self._builder.units)

    def problem(self) -> DesignProblem:
        entry = self._entry
        variables = [self._variable(name, one) for name, one in entry.variables.items()]
        ties = self._ties(variables)
        many = entry.objectives if isinstance(entry.objectives, list) else [entry.objectives]
        listed = isinstance(entry.objectives, list)
        objectives = [
            self._measure(one, ("objectives", k) if listed else ("objectives",)) for k, one in enumerate(many)
        ]
        constraints = [self._constraint(one, ("constraints", k)) for k, one in enumerate(entry.constraints)]
        reach = 1.0 if entry.reach is None else entry.reach.value
        configurations, given = self._configurations()
        return self._placed(
            ("design",),
            lambda: DesignProblem(
                self._builder,
                variables,
                objectives,
                constraints=constraints,
                ties=ties,
                configurations=configurations,
                given=given,
                weights=self._weights(entry.weights, ("weights",)),
                reach=reach,
                name=entry.name or Path(self._document.file).stem,
            ),
        )

    def _model(self) -> NumbersBuilder:
        entry = self._entry
        model = (
            entry.model if entry.model.startswith(EXAMPLE) else str((self._folder / entry.model).resolve())
        )
        drawn = NumbersBuilder(model, tuple(entry.set.items()))
        self._placed(("model",), drawn)
        changes: list[Any] = []
        if entry.active is not None:
            words = entry.active.split(",") if isinstance(entry.active, str) else entry.active
            names = tuple(word.strip() for word in words if word.strip())
            if not names:
                self._refuse(("active",), VinculaError("no motors: name at least one joint, or `all`"))
            changes.append(("with_active", (names,), ()))
            self._placed(("active",), replace(drawn, changes=tuple(changes)))
        if entry.reference is not None:
            changes.append(("with_reference", (entry.reference,), ()))
            self._placed(("reference",), replace(drawn, changes=tuple(changes)))
        return replace(drawn, changes=tuple(changes))

    def _inside(self, amount: Amount) -> float:
        """A number in the units of the model file."""
        if not amount.unit:
            return amount.value
        linear = amount.unit in UNITS["length"]
        return amount.value * UNITS["length" if linear else "angle"][amount.unit] / self._units.size(linear)

    def _variable(self, name: str, entry: VariableEntry) -> DesignVariable:
        unit = entry.from_.unit or entry.to.unit
        self._refuse_units(name, entry)
        return self._placed(
            ("variables", name),
            lambda: DesignVariable(
                name,
                self._inside(entry.from_),
                self._inside(entry.to),
                None if entry.start is None else self._inside(entry.start),
                0.0 if entry.tolerance is None else self._inside(entry.tolerance),
                unit,
                self._inside(Amount(1.0, unit)),
            ),
        )

    def _refuse_units(self, name: str, entry: VariableEntry) -> None:
        """Refuse bounds that cannot be meant together: an angle and a length, or one without its unit."""
        given = {"from": entry.from_, "to": entry.to, "start": entry.start, "tolerance": entry.tolerance}
        amounts = {key: amount for key, amount in given.items() if amount is not None}
        first = next((amount.unit for amount in amounts.values() if amount.unit), "")
        for key, amount in amounts.items():
            if amount.unit and (amount.unit in UNITS["length"]) != (first in UNITS["length"]):
                told = f"got {amount.value:g}{amount.unit} beside values in {first}: a length is no angle"
                self._refuse(("variables", name, key), VinculaError(told))
        for key, amount in (("from", entry.from_), ("to", entry.to)):
            if amount.value and not amount.unit and (entry.from_.unit or entry.to.unit):
                own = f"{amount.value:g}{first}"
                told = f"got {amount.value:g} beside a bound in {first}: give it a unit too ({own})"
                self._refuse(("variables", name, key), VinculaError(told))
        targets = [entry.sets] if isinstance(entry.sets, str) else entry.sets or [name]
        for target in targets:
            if first in UNITS["angle"] and re.search(r"/(at|origin|xyz)\[\d\]$", target):
                told = f"{shown(target)} is a length, and the bounds are in {first}"
                self._refuse(("variables", name), VinculaError(told))

    def _ties(self, variables: list[DesignVariable]) -> dict[str, Tie]:
        known = self._builder.parameters
        found: dict[str, Tie] = {}
        middle = {v.name: 0.5 * (v.low + v.high) for v in variables}

        def tie(target: str, text: str, place: Location) -> None:
            if target not in known:
                self._refuse(
                    place, UnknownNameError("parameter or number of the model", target, near(target, known))
                )
            if target in found:
                self._refuse(place, VinculaError(f"{shown(target)} is set twice"))
            found[target] = expression = Expression(text)
            self._placed(place, lambda: expression(middle))

        for name, entry in self._entry.variables.items():
            targets = [entry.sets] if isinstance(entry.sets, str) else entry.sets or []
            for target in targets:
                tie(target, f"${name}", ("variables", name, "sets"))
        for target, text in self._entry.ties.items():
            tie(target, text, ("ties", target))
        used = " ".join(str(getattr(one, "text", "")) for one in found.values())
        for name in middle:
            if name not in known and f"${name}" not in used:
                place = ("variables", name)
                self._refuse(
                    place, UnknownNameError("parameter or number of the model", name, near(name, known))
                )
        return found

    def _weights(self, text: str | None, place: Location) -> Weights | None:
        if text is None:
            return None
        return self._placed(place, lambda: read_weights(text, self._builder()))

    def _measure(self, entry: MeasureEntry, place: Location) -> Measure:
        if (entry.measure is None) == (entry.quantity is None):
            self._refuse(place, VinculaError("expected one of the keys measure and quantity"))
        how: dict[str, Any] = {
            "weights": self._weights(entry.weights, (*place, "weights")),
            "label": entry.label,
        }
        if entry.over is not None:
            how["over"] = entry.over
        if entry.quantity is not None:
            quantity = entry.quantity
            known = self._builder()
            return self._placed((*place, "quantity"), lambda: _index(quantity, entry.better, how, known))
        if entry.against is not None and entry.measure != "stiffness":
            self._refuse((*place, "against"), VinculaError("only stiffness has another direction to compare"))
        if entry.measure in ("speed", "stiffness", "force"):
            if entry.along is None:
                self._refuse(place, VinculaError("the key along is missing: a direction"))
            how["direction"] = tuple(amount.value for amount in entry.along)
            if entry.against is not None:
                how["against"] = tuple(amount.value for amount in entry.against)
            directed: dict[str, Any] = {"speed": Speed, "stiffness": Stiffness, "force": Force}
            one: Measure = directed[str(entry.measure)](**how)
            return one
        simple: dict[str, Any] = {
            "sphere": SphereDistance,
            "workspace": WorkspaceShare,
            "singularity": SingularityDistance,
        }
        made: Measure = simple[str(entry.measure)](**how)
        return made

    def _constraint(self, entry: ConstraintEntry, place: Location) -> Constraint:
        given = [key for key in KINDS if getattr(entry, key.replace("-", "_")) not in (None, False)]
        if len(given) != 1:
            told = " and ".join(given) or "nothing that says what it is"
            self._refuse(place, VinculaError(f"got {told}, expected one of the keys {', '.join(KINDS)}"))
        bounds = {
            "least": None if entry.least is None else self._bound(entry.least),
            "most": None if entry.most is None else self._bound(entry.most),
            "label": entry.label,
        }
        return self._placed(place, lambda: self._made(given[0], entry, place, bounds))

    def _bound(self, amount: Amount) -> float:
        """Bounds are in metres, radians or plain numbers."""
        if not amount.unit:
            return amount.value
        return amount.value * UNITS["length" if amount.unit in UNITS["length"] else "angle"][amount.unit]

    def _made(self, kind: str, entry: ConstraintEntry, place: Location, bounds: dict[str, Any]) -> Constraint:
        label = entry.label
        if kind == "value":
            expression = Expression(str(entry.value))
            middle = {
                n: 0.5 * (self._inside(v.from_) + self._inside(v.to))
                for n, v in self._entry.variables.items()
            }
            expression(middle)
            return Relation(value=expression, **bounds)
        if kind == "limits":
            return JointLimits(label=label)
        if kind == "no-singularity":
            return NoSingularity(margin=entry.margin.value if entry.margin else 0.0, label=label)
        if kind == "distance":
            first, second = entry.distance or ("", "")
            return Distance(first=first, second=second, **bounds)
        if kind == "clearance":
            one, two = entry.clearance or ([], [])
            least = self._bound(entry.least) if entry.least is not None else 0.0
            return Clearance(legs=((one[0], one[1]), (two[0], two[1])), least=least, label=label)
        return Bound(measure=replace(self._measure(entry, place), label=None), **bounds)

    def _configurations(self) -> tuple[Any, Any]:
        """Where the designs are judged, and what these numbers are; home where the file says nothing."""
        from vincula.kernels.compiled import compile_mechanism
        from vincula.sweep.inputs import inputs_for

        workspace = self._entry.workspace
        if workspace is None:
            return None, "configuration"
        node = self._document.node(["workspace"])
        present = [key for key in WHERE if getattr(workspace, key.replace("-", "_")) is not None]
        if len(present) != 1 or node is None:
            told = " and ".join(present) or "nothing that says where"
            self._refuse(
                ("workspace",), VinculaError(f"got {told}, expected one of the keys {', '.join(WHERE)}")
            )
        inner = replace(self._document, root=node)
        file: Any = SweepFile(inner, workspace, self._folder)  # type: ignore[arg-type]
        compiled = self._placed(("model",), lambda: compile_mechanism(self._builder()))
        names = file.variables()
        inputs = self._placed(("workspace",), lambda: inputs_for(compiled, names, workspace.given))
        units = {variable.name: variable.unit for variable in inputs.variables}
        points = file.points(units.__getitem__, self._units)
        rows, parameters = inputs.rows(points.at(np.arange(points.count)))
        if parameters:
            self._refuse(("workspace",), VinculaError("a parameter is no place: name motors or poses"))
        return rows, inputs.given

    def _placed(self, location: Location, action: Callable[[], Made]) -> Made:
        """What the action returns; what it refuses is told with its place."""
        try:
            return action()
        except FileError:
            raise
        except VinculaError as error:
            self._refuse(location, error)

    def _refuse(self, location: Location, error: VinculaError) -> NoReturn:
        raise FileError(f"{self._document.place(location).text()}: {error}") from error


def _index(quantity: str, better: Any, how: dict[str, Any], mechanism: Any) -> Index:
    from vincula.kernels.quantities import available, chosen

    chosen(available(mechanism), [quantity])
    return Index(quantity=quantity, sense=better, **how)
