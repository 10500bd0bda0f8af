"""The mechanism: a frozen graph of bodies, joints and contacts, validated when made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.arrays import Vector
from vincula.errors import MissingReferenceError
from vincula.mechanism import names as naming
from vincula.mechanism import validation
from vincula.mechanism.closable import Closable
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import JointType, joint_type
from vincula.mechanism.parts import (
    Body,
    ContactPart,
    Coupling,
    Cut,
    Drive,
    Frame,
    Joint,
    Precision,
    ReferenceMember,
    _All,
)
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL, Space

if TYPE_CHECKING:
    from vincula.mechanism.drawing import Contact, DrawnBody, DrawnJoint, Reference
    from vincula.mechanism.frames import FrameTable
    from vincula.mechanism.layout import Layout
    from vincula.mechanism.reduction import Reduction
    from vincula.mechanism.residuals import LoopResidual
    from vincula.model import LinearModel
    from vincula.weights import Weights


@dataclass(frozen=True, eq=False)
class Mechanism(Closable):
    """Any mechanism with loops, passive joints and contacts.

    Draw one with `Mechanism.planar` or `Mechanism.spatial`, or load one with `vincula.load`.

    Attributes:
        space: PLANAR or SPATIAL.
        bodies: Bodies, with their home poses; the ground is not among them.
        joints: Joints.
        contacts: Contacts.
        couplings: Linear and polynomial couplings between joint axes.
        drives: Motors that drive a combination of axes.
        frames: Named frames (sites) on bodies.
        active: Names of the active axes and drives.
        lock: Names of the axes held still for the analysis.
        reference: The reference member; None until one is named.
        weights: Weights declared with the mechanism.
        name: Name for results.
        precision: Typed digits and tolerances.
        notes: Facts that a reader of a result must know.
        motors: Axes or drives by motor name, for motors that a file names.
        keyframes: Named configurations: values by joint.
    """

    space: Space
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    contacts: tuple[ContactPart, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    drives: tuple[Drive, ...] = ()
    frames: tuple[Frame, ...] = ()
    active: tuple[str, ...] = ()
    lock: tuple[str, ...] = ()
    reference: ReferenceMember | None = None
    weights: Weights | None = None
    name: str = "mechanism"
    precision: Precision = field(default_factory=Precision)
    notes: tuple[str, ...] = ()
    motors: Mapping[str, str] = field(default_factory=dict)
    keyframes: Mapping[str, Mapping[str, Sequence[float]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        validation.validate(self)

    # Making one -----------------------------------------------------------------------------

    @staticmethod
    def planar(
        joints: Sequence[DrawnJoint],
        *,
        contacts: Sequence[Contact] = (),
        couplings: Sequence[Coupling] = (),
        drives: Sequence[Drive] = (),
        bodies: Sequence[DrawnBody] = (),
        reference: Reference | None = None,
        active: Iterable[str] | str | _All = (),
        lock: Iterable[str] | str = (),
        weights: Weights | None = None,
        name: str = "mechanism",
    ) -> Mechanism:
        """A mechanism in the plane (two translations, one rotation), drawn in ground axes.

        Raises:
            ModelError: Any part that cannot be used; see the subclasses.
        """
        from vincula.mechanism.drawn_mechanism import draw

        return draw(
            PLANAR, joints, contacts, couplings, drives, bodies, reference, active, lock, weights, name
        )

    @staticmethod
    def spatial(
        joints: Sequence[DrawnJoint],
        *,
        contacts: Sequence[Contact] = (),
        couplings: Sequence[Coupling] = (),
        drives: Sequence[Drive] = (),
        bodies: Sequence[DrawnBody] = (),
        reference: Reference | None = None,
        active: Iterable[str] | str | _All = (),
        lock: Iterable[str] | str = (),
        weights: Weights | None = None,
        name: str = "mechanism",
    ) -> Mechanism:
        """A mechanism in space, drawn in ground axes; arguments as for `planar`.

        Raises:
            ModelError: Any part that cannot be used; see the subclasses.
        """
        from vincula.mechanism.drawn_mechanism import draw

        return draw(
            SPATIAL, joints, contacts, couplings, drives, bodies, reference, active, lock, weights, name
        )

    # Looking things up ----------------------------------------------------------------------

    @cached_property
    def implicit_joints(self) -> tuple[Joint, ...]:
        """Free joints given to bodies that only contacts or closures hold (grasped objects)."""
        return validation.implicit_free_joints(self)

    @cached_property
    def all_joints(self) -> tuple[Joint, ...]:
        """The joints, the implicit free ones included."""
        return (*self.joints, *self.implicit_joints)

    @cached_property
    def body(self) -> dict[str, Body]:
        """Bodies by name."""
        return {body.name: body for body in self.bodies}

    @cached_property
    def joint(self) -> dict[str, Joint]:
        """Joints by name."""
        return {joint.name: joint for joint in self.all_joints}

    def type_of(self, joint: Joint) -> JointType:
        """The type of a joint in this mechanism's space."""
        return joint_type(joint.type, self.space)

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """Names of all joint axes, implicit free joints included."""
        return tuple(name for j in self.all_joints for name in self.type_of(j).axis_names(j.name))

    def resolve_motors(self, names: Iterable[str] | str | _All) -> tuple[str, ...]:
        """Axis and drive names for motor, joint and axis names; `ALL` or "all" for every free axis.

        Raises:
            UnknownNameError: A name that is none of these.
        """
        return naming.resolve_motors(self, names)

    def resolve_axes(self, names: Iterable[str] | str) -> tuple[str, ...]:
        """Axis names for joint and axis names.

        Raises:
            UnknownNameError: A name that is neither.
        """
        return naming.resolve_axes(self, names)

    # Variants -------------------------------------------------------------------------------

    def with_active(self, names: Iterable[str] | str | _All) -> Mechanism:
        """The same mechanism with other motors (joint, axis or motor names, or `ALL`).

        Raises:
            UnknownNameError: A name that does not exist.
            ModelError: A locked axis among them.
        """
        return replace(self, active=self.resolve_motors(names))

    def with_lock(self, names: Iterable[str] | str) -> Mechanism:
        """The same mechanism with these joints or axes held still; their own motors are dropped.

        Raises:
            UnknownNameError: A name that does not exist.
        """
        locked = self.resolve_axes(names)
        active = tuple(a for a in self.active if a not in locked)
        return replace(self, lock=locked, active=active)

    def with_reference(
        self,
        body: str,
        origin: Sequence[float] | Vector | None = None,
        *,
        frame: str | None = None,
        axes: Literal["ground", "body"] = "ground",
        cuts: Mapping[str, Cut] | None = None,
    ) -> Mechanism:
        """The same mechanism with another reference member.

        Args:
            body: Its name.
            origin: Reference point in the body's axes [m]; by default the body's origin, for a drawn
                body the mean of its joint and contact points.
            frame: Name of a frame (site) on the body whose origin is the reference point.
            axes: Axes of twist and wrench.
            cuts: How joints are cut, by joint name; by default as before for the same body.

        Raises:
            UnknownNameError: No such body or frame.
        """
        point, label = naming.reference_point(self, body, origin, frame)
        old = self.reference
        kept = cuts if cuts is not None else (old.cuts if old is not None and old.body == body else {})
        return replace(self, reference=ReferenceMember(body, point, axes, kept, label))

    def with_weights(self, weights: Weights | None) -> Mechanism:
        """The same mechanism with other weights."""
        return replace(self, weights=weights)

    def with_configuration(self, values: Mapping[str, float | Sequence[float] | Vector]) -> Mechanism:
        """The same mechanism with another home configuration; bodies and cut points move along.

        Raises:
            UnknownNameError: A joint that does not exist.
            ShapeError: The wrong number of values.
        """
        from vincula.mechanism.home import at_home

        return at_home(self, self.configuration(values))

    def with_tolerance(self, length: float = 0.0, angle: float = 0.0) -> Mechanism:
        """The same mechanism made with manufacturing tolerances [m, rad]."""
        return replace(
            self, precision=replace(self.precision, tolerance_length=length, tolerance_angle=angle)
        )

    # Configurations -------------------------------------------------------------------------

    @cached_property
    def home(self) -> Configuration:
        """The configuration that the mechanism is drawn or stored in."""
        return Configuration({j.name: np.array(j.home, float) for j in self.all_joints if not j.closure})

    def configuration(
        self, values: Mapping[str, float | Sequence[float] | Vector] | None = None
    ) -> Configuration:
        """The home configuration with some joints at other values.

        Raises:
            UnknownNameError: A joint that does not exist.
            ShapeError: The wrong number of values.
            NonFiniteError: NaN or infinity.
        """
        if values is None:
            return self.home
        if isinstance(values, Configuration) and set(values) == set(self.home):
            return values
        return self.home.replaced(values)

    def body_poses(self, q: Mapping[str, float | Sequence[float] | Vector] | None = None) -> dict[str, Pose]:
        """Pose of every body (and the ground) in ground axes, through the kinematic tree."""
        from vincula.mechanism.kinematics import body_poses

        return body_poses(self, self.configuration(q))

    def residuals(
        self, q: Mapping[str, float | Sequence[float] | Vector] | None = None
    ) -> tuple[LoopResidual, ...]:
        """How far every loop, contact and coupling is from being closed."""
        from vincula.mechanism.residuals import residuals_of_frames

        configuration = self.configuration(q)
        frames = self.frame_table.placed(self.body_poses(configuration))
        return residuals_of_frames(self, configuration, frames)

    @cached_property
    def tree(self) -> tuple[tuple[Joint, bool], ...]:
        """The kinematic tree: joints from the ground outwards, with the direction they are walked in."""
        from vincula.mechanism.kinematics import grow_tree

        return grow_tree(self)

    @cached_property
    def frame_table(self) -> FrameTable:
        """All frames of joints and contacts, with the bodies that carry them."""
        from vincula.mechanism.frames import FrameTable

        return FrameTable.of_mechanism(self)

    @cached_property
    def reduction(self) -> Reduction:
        """How the graph is opened into J_a, J_p, G: roots, trees, cuts, rows and columns.

        Raises:
            MissingReferenceError: No reference member is named.
        """
        from vincula.mechanism.reduction import reduce_graph

        if self.reference is None:
            raise MissingReferenceError(body.name for body in self.bodies)
        return reduce_graph(self)

    @cached_property
    def layout(self) -> Layout:
        """Rows, columns and signs of J_a, J_p and G: all of them that does not depend on a configuration.

        Raises:
            MissingReferenceError: No reference member is named.
        """
        from vincula.mechanism.assembly import lay_out

        return lay_out(self)

    @cached_property
    def length(self) -> float:
        """Characteristic length L [m]: rms distance of joint and contact points, a power of two."""
        from vincula.mechanism.kinematics import characteristic_length

        return characteristic_length(self)

    def linearize(self, q: Mapping[str, float | Sequence[float] | Vector] | None = None) -> LinearModel:
        """J_a, J_p and G at a configuration (the home configuration by default).

        Raises:
            ClosureError: A loop or contact is open by more than 1e-8 L; names it and its gap.
            MissingReferenceError: No reference member is named.
        """
        from vincula.mechanism.jacobians import linearize

        return linearize(self, self.configuration(q))
