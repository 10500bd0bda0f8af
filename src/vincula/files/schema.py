"""The native file, version 1, as pydantic models: the schema that is published and checked.

Read only where a file is: importing pydantic takes longer than most analyses.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, RootModel, Tag

from vincula.files.schema_values import Name, Number, Placed, Strict, Text


class UnitsEntry(Strict):
    """Units of the numbers in this file; inside, everything is in m and rad."""

    length: Literal["m", "mm", "cm", "in"] = "m"
    angle: Literal["rad", "deg"] = "rad"


class BodyEntry(Strict):
    """A body; bodies need no entry unless they are fixed to another."""

    fixed_to: Name | None = None
    at: Placed | None = None


class FrameEntry(Strict):
    """A named frame on a body: its point, its z direction and, near it, its x direction."""

    body: Name
    at: Placed
    z: Placed | None = None
    x: Placed | None = None


class LimitsEntry(Strict):
    """Limits of one joint axis: values in the file's units, rates in units a second, efforts in N or N m."""

    lower: Number | None = None
    upper: Number | None = None
    rate: Number | None = None
    effort: Number | None = None


class _JointEntry(Strict):
    name: Name
    bodies: Annotated[list[Name], Field(min_length=2, max_length=2)]


class RevoluteEntry(_JointEntry):
    """Rotation about an axis (in the plane about its normal)."""

    type: Literal["revolute"]
    at: Placed
    axis: Placed | None = None
    limits: LimitsEntry | None = None


class PrismaticEntry(_JointEntry):
    """Translation along an axis; the point only places it in pictures."""

    type: Literal["prismatic"]
    axis: Placed
    at: Placed | None = None
    limits: LimitsEntry | None = None


class ScrewEntry(_JointEntry):
    """Rotation about and proportional translation along an axis; `lead` is the length a turn."""

    type: Literal["screw"]
    at: Placed
    axis: Placed
    lead: Number
    limits: LimitsEntry | None = None


class CylindricalEntry(_JointEntry):
    """Rotation about and translation along an axis."""

    type: Literal["cylindrical"]
    at: Placed
    axis: Placed
    limits: Annotated[list[LimitsEntry], Field(max_length=2)] | None = None


class UniversalEntry(_JointEntry):
    """Two rotations: the first axis on the first body, the second on the second."""

    type: Literal["universal"]
    at: Placed
    axes: Annotated[list[Placed], Field(min_length=2, max_length=2)]
    limits: Annotated[list[LimitsEntry], Field(max_length=2)] | None = None


class SphericalEntry(_JointEntry):
    """All rotations about a point."""

    type: Literal["spherical"]
    at: Placed


class PlanarEntry(_JointEntry):
    """Two translations in a plane and the rotation about its normal `axis`."""

    type: Literal["planar"]
    at: Placed
    axis: Placed


class FixedEntry(_JointEntry):
    """No relative motion."""

    type: Literal["fixed"]
    at: Placed | None = None


class FreeEntry(_JointEntry):
    """All motions: a floating base when the first body is the ground."""

    type: Literal["free"]
    at: Placed | None = None


JointEntry = Annotated[
    RevoluteEntry
    | PrismaticEntry
    | ScrewEntry
    | CylindricalEntry
    | UniversalEntry
    | SphericalEntry
    | PlanarEntry
    | FixedEntry
    | FreeEntry,
    Field(discriminator="type"),
]


class ContactEntry(Strict):
    """A contact; the normal points from the first body into the second."""

    name: Name
    type: Literal["point", "hard-finger", "line", "line-friction", "plane", "complete", "soft-finger"]
    bodies: Annotated[list[Name], Field(min_length=2, max_length=2)]
    at: Placed
    normal: Placed
    line: Placed | None = None
    friction: Number | None = None


class ClosureEntry(Strict):
    """A loop joint between two named frames; its axis is z of the first.

    With `cut: contact` it stands for its constraint rows only and has no axes of its own.
    """

    name: Name
    type: Literal["revolute", "prismatic", "cylindrical", "spherical", "planar", "fixed"]
    frames: Annotated[list[Name], Field(min_length=2, max_length=2)]
    cut: Literal["kept", "contact"] | None = None


class CouplingEntry(Strict):
    """Sum of coefficient x rate = 0; with a driver  sum rates (q - ref) = p(sum driver (q - ref))."""

    name: Name
    rates: Annotated[dict[Name, Number], Field(min_length=1)]
    driver: dict[Name, Number] = Field(default_factory=dict)
    polynomial: list[Number] = Field(default_factory=list)
    references: dict[Name, Number] = Field(default_factory=dict)


class DriveEntry(Strict):
    """A motor that drives several axes: motor rate = sum of coefficient x axis rate."""

    name: Name
    drives: Annotated[dict[Name, Number], Field(min_length=1)]


class NamedMotorEntry(Strict):
    """A motor with a name of its own on one axis."""

    name: Name
    axis: Name


def _motor_form(value: Any) -> str:
    if isinstance(value, dict):
        return "named" if "axis" in value else "combining"
    return "axis"


MotorEntry = Annotated[
    Annotated[Name, Tag("axis")]
    | Annotated[DriveEntry, Tag("combining")]
    | Annotated[NamedMotorEntry, Tag("named")],
    Discriminator(_motor_form),
]


class CutEntry(Strict):
    """How a joint is cut when the graph is opened."""

    kind: Literal["kept", "contact"] = "kept"
    at: Placed | None = None


class ReferenceEntry(Strict):
    """The reference member: the body whose motion and forces are asked for."""

    body: Name
    origin: Placed | None = None
    axes: Literal["ground", "body"] = "ground"
    cuts: dict[Name, CutEntry] = Field(default_factory=dict)


def _weight_form(value: Any) -> str:
    if isinstance(value, dict):
        return "table"
    if isinstance(value, str):
        return "word"
    if isinstance(value, list):
        return "matrix" if value and isinstance(value[0], list) else "list"
    return "number"


Weight = Annotated[
    Annotated[Number, Tag("number")]
    | Annotated[list[Number], Tag("list")]
    | Annotated[dict[Name, Number], Tag("table")]
    | Annotated[list[list[Number]], Tag("matrix")],
    Discriminator(lambda value: "number" if isinstance(value, str) else _weight_form(value)),
]
"""A number, one number a component, numbers by name (what is not named weighs 1), or a matrix."""

ForceWeight = Annotated[
    Annotated[Number, Tag("number")]
    | Annotated[list[Number], Tag("list")]
    | Annotated[dict[Name, Number], Tag("table")]
    | Annotated[list[list[Number]], Tag("matrix")]
    | Annotated[Literal["all rows"], Tag("word")],
    Discriminator(_weight_form),
]


class WeightsEntry(Strict):
    """The five weights, in m, rad, N and N m whatever the units of the file."""

    rate: Weight | None = None
    twist: Weight | None = None
    torque: Weight | None = None
    wrench: Weight | None = None
    contact_force: ForceWeight | None = None
    reciprocal: bool = False


def _weights_form(value: Any) -> str:
    return "table" if isinstance(value, dict) else "limits"


Values = Annotated[
    Annotated[Number, Tag("number")] | Annotated[list[Number], Tag("list")],
    Discriminator(lambda value: "list" if isinstance(value, list) else "number"),
]
"""The value of a joint with one, or the list of values of one with several."""

Weighting = Annotated[
    Annotated[WeightsEntry, Tag("table")] | Annotated[Literal["limits"], Tag("limits")],
    Discriminator(_weights_form),
]


class PrecisionEntry(Strict):
    """How far lengths and angles may be off; without it, half a unit of the digits they are typed with."""

    length: Number | None = None
    angle: Number | None = None


class NativeFile(Strict):
    """A vincula native file, version 1."""

    vincula: Literal[1]
    name: Name | None = None
    space: Literal["planar", "spatial"] | None = None
    units: UnitsEntry = UnitsEntry()
    parameters: dict[Name, Number] = Field(default_factory=dict)
    base: Name | None = None
    bodies: dict[Name, BodyEntry | None] = Field(default_factory=dict)
    frames: dict[Name, FrameEntry] = Field(default_factory=dict)
    joints: list[JointEntry] = Field(default_factory=list)
    contacts: list[ContactEntry] = Field(default_factory=list)
    closures: list[ClosureEntry] = Field(default_factory=list)
    couplings: list[CouplingEntry] = Field(default_factory=list)
    motors: list[MotorEntry] | None = None
    lock: list[Name] | None = None
    reference: ReferenceEntry | None = None
    weights: Weighting | None = None
    configuration: dict[Name, Values] = Field(default_factory=dict)
    keyframes: dict[Name, dict[Name, Values]] = Field(default_factory=dict)
    precision: PrecisionEntry | None = None
    notes: list[Text] = Field(default_factory=list)


class ConfigurationFile(RootModel[dict[Name, Values]]):
    """A configuration in a file: values by joint."""
