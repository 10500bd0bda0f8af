"""The keys of a design file, version 1, for pydantic."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from vincula.files.schema_values import Name, Strict, Text
from vincula.files.sweep_schema import (
    Axis,
    LowDiscrepancyEntry,
    Names,
    PathEntry,
    Quantity,
    RandomEntry,
    Setting,
    Whole,
)

Over = Literal["worst", "mean"]


class VariableEntry(Strict):
    """One variable: its bounds, and what it sets where that has another name."""

    from_: Quantity = Field(alias="from")
    to: Quantity
    start: Quantity | None = None
    tolerance: Quantity | None = None
    sets: Text | Annotated[list[Text], Field(min_length=1)] | None = None


class MeasureEntry(Strict):
    """What designs are judged by: one of `measure` and `quantity`."""

    measure: Literal["sphere", "speed", "stiffness", "force", "workspace", "singularity"] | None = None
    quantity: Text | None = None
    along: Annotated[list[Quantity], Field(min_length=3, max_length=6)] | None = None
    against: Annotated[list[Quantity], Field(min_length=3, max_length=6)] | None = None
    better: Literal["smaller", "larger"] | None = None
    over: Over | None = None
    weights: Text | None = None
    label: Text | None = None


class ConstraintEntry(MeasureEntry):
    """What a design must keep."""

    value: Text | None = None
    limits: bool | None = None
    no_singularity: bool | None = Field(default=None, alias="no-singularity")
    margin: Quantity | None = None
    distance: Annotated[list[Name], Field(min_length=2, max_length=2)] | None = None
    clearance: (
        Annotated[
            list[Annotated[list[Name], Field(min_length=2, max_length=2)]], Field(min_length=2, max_length=2)
        ]
        | None
    ) = None
    least: Quantity | None = None
    most: Quantity | None = None


class WorkspaceEntry(Strict):
    """Where every design is judged: a grid, a path, random or evenly filling points."""

    given: Literal["motors", "reference", "configuration"] | None = None
    grid: Annotated[dict[Name, Axis], Field(min_length=1)] | None = None
    path: PathEntry | None = None
    random: RandomEntry | None = None
    low_discrepancy: LowDiscrepancyEntry | None = Field(default=None, alias="low-discrepancy")
    table: Text | None = None


class SearchEntry(Strict):
    """How to search."""

    seed: Whole = 0
    population: Whole | None = None
    generations: Whole | None = None
    method: Literal["nsga2", "nsga3"] | None = None
    samples: Whole = 200
    polish: bool = True


class ScanEntry(Strict):
    """A landscape over one or two variables."""

    over: Annotated[list[Name], Field(min_length=1, max_length=2)]
    points: Annotated[list[Whole], Field(min_length=1, max_length=2)] | None = None


def _many(value: Any) -> str:
    return "list" if isinstance(value, list) else "table"


Objectives = Annotated[
    Annotated[list[MeasureEntry], Field(min_length=1), Tag("list")] | Annotated[MeasureEntry, Tag("table")],
    Discriminator(_many),
]
"""One objective, or a list of them."""


class DesignEntry(Strict):
    """A design file, version 1."""

    design: Literal[1]
    model: Text
    set: dict[Name, Setting] = Field(default_factory=dict)
    active: Names | None = None
    reference: Text | None = None
    weights: Text | None = None
    variables: Annotated[dict[Name, VariableEntry], Field(min_length=1)]
    ties: dict[Text, Text] = Field(default_factory=dict)
    objectives: Objectives
    constraints: list[ConstraintEntry] = Field(default_factory=list)
    workspace: WorkspaceEntry | None = None
    reach: Quantity | None = None
    search: SearchEntry = Field(default_factory=SearchEntry)
    scan: ScanEntry | None = None
    name: Name | None = None
