"""A Pinocchio model, a configuration and constraint models as a mechanism and a linear model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import count, takewhile
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from vincula.adapters.members import member_named
from vincula.adapters.pinocchio_joints import Element, elements, follower, pose_of
from vincula.adapters.pinocchio_loops import loops
from vincula.adapters.pinocchio_values import put
from vincula.arrays import Vector, checked
from vincula.errors import MissingExtraError, ModelError
from vincula.mechanism.joint_types import joint_type, motion
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, Body, Coupling, Frame, Joint, _All
from vincula.model import LinearModel
from vincula.spatial.poses import Pose
from vincula.spatial.space import SPATIAL


def linear_model(
    model: Any,
    q: ArrayLike,
    reference: str,
    constraints: Iterable[Any] = (),
    *,
    active: Iterable[str] | str | _All,
    lock: Iterable[str] | str = (),
    axes: Literal["ground", "body"] = "ground",
) -> LinearModel:
    """J_a, J_p and G of a Pinocchio model whose loops are constraint models.

    Args:
        model: A `pinocchio.Model`.
        q: Its configuration, nq numbers in Pinocchio's order.
        reference: The reference member: a body, a frame, or `BODY@FRAME`; see `mechanism_of`.
        constraints: Constraint models that close loops.
        active: Joints or axes with motors (a Pinocchio model does not say which), or `ALL`.
        lock: Joints or axes held still.
        axes: Axes of twist and wrench.

    Raises:
        ClosureError: A loop is open at q; `mechanism_of(...).close()` finds a configuration that is not.
        ShapeError: q does not have nq numbers.
        UnknownNameError: A name that the model does not have.
        UnsupportedFeatureError: A kind of joint or constraint that cannot be represented.
        ModelError: No `pinocchio.Model`, or a member that cannot be one.
        MissingExtraError: Pinocchio is not installed.
    """
    mechanism = mechanism_of(model, q, constraints)
    body, frame = member_named(mechanism, reference)
    mechanism = mechanism.with_lock(_whole(mechanism, lock))
    if isinstance(active, _All) or active == "all":
        mechanism = mechanism.with_active(active)
    else:
        mechanism = mechanism.with_active(_whole(mechanism, active))
    return mechanism.with_reference(body, frame=frame, axes=axes).linearize()


def mechanism_of(model: Any, q: ArrayLike | None = None, constraints: Iterable[Any] = ()) -> Mechanism:
    """The mechanism of a Pinocchio model, its home configuration being q.

    Bodies are Pinocchio's moving frames (one a joint), called by the body frame that coincides with
    them, else by the joint; all frames are named frames.  A composite joint `j` is a chain of joints
    `j.1`, `j.2` ...; so are three Euler angles and three translations.  Mimic joints are coupled to
    their leader, if the model was built with them (`mimic=True`).  No joint has a motor.

    Args:
        model: A `pinocchio.Model`.
        q: Its configuration, nq numbers in Pinocchio's order; the neutral one by default.
        constraints: Constraint models that close loops.

    Raises:
        ShapeError: q does not have nq numbers.
        NonFiniteError: NaN or infinity in q.
        UnsupportedFeatureError: A kind of joint or constraint that cannot be represented.
        ModelError: No `pinocchio.Model`.
        MissingExtraError: Pinocchio is not installed.
    """
    configuration = _checked(model, q)
    names = _body_names(model)
    graph = _Graph(model, configuration, names)
    return Mechanism(
        space=SPATIAL,
        bodies=tuple(graph.bodies),
        joints=(*graph.joints, *loops(constraints, names, [j.name for j in graph.joints])),
        couplings=tuple(graph.couplings),
        frames=_frames(model, names),
        name=str(model.name) or "pinocchio",
    )


def positions_of(model: Any, configuration: Mapping[str, float | Sequence[float] | Vector]) -> Vector:
    """The vector q of a configuration, such as one that `mechanism_of(...).close()` has found.

    Mimic joints have no numbers of their own in q.

    Args:
        model: A `pinocchio.Model`.
        configuration: Values by joint; joints not named are at the neutral ones.

    Raises:
        UnknownNameError: A joint that does not exist.
        ShapeError: The wrong number of values.
        UnsupportedFeatureError: A kind of joint that cannot be represented.
        ModelError: No `pinocchio.Model`.
        MissingExtraError: Pinocchio is not installed.
    """
    q = np.array(_checked(model, None))
    mechanism = mechanism_of(model)
    values = iter(mechanism.configuration(configuration).values())
    for joint in list(model.joints)[1:]:
        put(joint, values, q)
    return q


def _checked(model: Any, q: ArrayLike | None) -> Vector:
    try:
        import pinocchio
    except ImportError:
        raise MissingExtraError("Pinocchio", "pinocchio", "a Pinocchio model") from None
    if not isinstance(model, pinocchio.Model):
        raise ModelError(f"expected a pinocchio.Model, got {type(model).__name__}")
    given = pinocchio.neutral(model) if q is None else q
    return checked(given, "configuration q", (int(model.nq),))


class _Graph:
    """Bodies, joints and couplings in the order of the model's joints."""

    def __init__(self, model: Any, q: Vector, names: Sequence[str]) -> None:
        self._poses = {GROUND: Pose.identity()}
        self._joint_names: set[str] = set(model.names)
        self._names, self._taken = names, set(names)
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.couplings: list[Coupling] = []
        for index in range(1, int(model.njoints)):
            self._add_joint(model, index, q)

    def _add_joint(self, model: Any, index: int, q: Vector) -> None:
        joint, name = model.joints[index], str(model.names[index])
        chain = list(elements(model, joint, pose_of(model.jointPlacements[index]), q, name))
        first = self._names[int(model.parents[index])]
        for number, element in enumerate(chain, start=1):
            own = name if len(chain) == 1 else self._new(f"{name}.{number}", self._joint_names)
            last = number == len(chain)
            second = self._names[index] if last else self._new(f"{self._names[index]}:{own}", self._taken)
            self._add(own, element, first, second)
            first = second
        mimic = follower(model, joint)
        if mimic is not None:
            leader = str(model.names[mimic.leader])
            self.couplings.append(
                Coupling(
                    f"mimic:{name}",
                    rates={name: 1.0, leader: -mimic.scaling},
                    references={name: mimic.offset, leader: 0.0},
                )
            )

    def _add(self, name: str, element: Element, first: str, second: str) -> None:
        on_first, values = element.offset @ element.turn, np.array(element.values)
        kind = joint_type(element.type, SPATIAL)
        step = on_first @ motion(kind, values, element.lead, element.second_axis) @ element.turn.inverse()
        self._poses[second] = self._poses[first] @ step
        self.bodies.append(Body(second, self._poses[second]))
        self.joints.append(
            Joint(
                name,
                element.type,
                first,
                second,
                on_first,
                element.turn,
                home=element.values,
                lead=element.lead,
                second_axis=element.second_axis,
                limits=element.limits,
            )
        )

    @staticmethod
    def _new(name: str, taken: set[str]) -> str:
        while name in taken:
            name += "_"
        taken.add(name)
        return name


def _body_names(model: Any) -> list[str]:
    """A name for every moving frame: the body frame that coincides with it, else the joint's."""
    names = [GROUND, *(str(name) for name in list(model.names)[1:])]
    coinciding: dict[int, str] = {}
    for frame in model.frames:
        joint = int(frame.parentJoint)
        if joint and _is_body(frame) and frame.placement.isIdentity(0.0):
            coinciding.setdefault(joint, str(frame.name))
    taken = {GROUND}
    for index in range(1, len(names)):
        name = coinciding.get(index, names[index])
        while name in taken:
            name += "_"
        taken.add(name)
        names[index] = name
    return names


def _frames(model: Any, names: Sequence[str]) -> tuple[Frame, ...]:
    """Frames by name, bodies first where kinds share one; those called like a body are left out."""
    found: dict[str, Frame] = {}
    for frame in sorted(model.frames, key=lambda frame: not _is_body(frame)):
        name = str(frame.name)
        if name not in names and name not in found:
            found[name] = Frame(name, names[int(frame.parentJoint)], pose_of(frame.placement))
    return tuple(found.values())


def _is_body(frame: Any) -> bool:
    return str(frame.type) == "BODY"


def _whole(mechanism: Mechanism, names: Iterable[str] | str) -> list[str]:
    """The names given, a joint that became a chain standing for all its elements."""
    from vincula.mechanism.names import split_names

    found: list[str] = []
    for name in split_names(names) if isinstance(names, str) else names:
        parts = list(takewhile(mechanism.joint.__contains__, (f"{name}.{k}" for k in count(1))))
        found.extend(parts if name not in mechanism.joint and parts else [name])
    return found
