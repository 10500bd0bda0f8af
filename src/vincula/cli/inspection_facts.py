"""What `vincula inspect` knows about a file, as one plain object: the JSON, and what the page shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vincula.errors import ClosureError, TopologyError
from vincula.mechanism.loops import independent_loops
from vincula.mechanism.residuals import CLOSED

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.parts import Joint, Limits


def inspection(subject: Subject) -> dict[str, Any]:
    """Everything that `inspect --json` prints; see docs for the keys."""
    mechanism = subject.mechanism
    implicit = {joint.name for joint in mechanism.implicit_joints}
    poses = mechanism.body_poses(subject.configuration)
    return {
        "schema": "vincula/inspection/1",
        "mechanism": mechanism.name,
        "file": subject.file,
        "space": mechanism.space.name,
        "length": mechanism.length,
        "bodies": [
            {"name": body.name, "position": poses[body.name].position.tolist()} for body in mechanism.bodies
        ],
        "joints": [_joint(subject, joint) for joint in mechanism.all_joints if joint.name not in implicit],
        "contacts": [
            {"name": c.name, "type": c.type, "between": [c.first, c.second]} for c in mechanism.contacts
        ],
        "couplings": [
            {
                "name": coupling.name,
                "rates": dict(coupling.rates),
                "driver": dict(coupling.driver),
                "polynomial": list(coupling.polynomial),
            }
            for coupling in mechanism.couplings
        ],
        "active": list(mechanism.active),
        "locked": list(mechanism.lock),
        "motors": _motors(mechanism),
        "frames": [{"name": frame.name, "body": frame.body} for frame in mechanism.frames],
        "keyframes": list(mechanism.keyframes),
        "loops": [
            {"closed_by": loop.closed_by, "bodies": list(loop.bodies), "parts": list(loop.parts)}
            for loop in independent_loops(mechanism)
        ],
        "closure": _closure(subject),
        "reference": _reference(mechanism),
        "mobility": _mobility(subject),
        "load": subject.report.to_dict(),
        "notes": list(mechanism.notes),
    }


def _joint(subject: Subject, joint: Joint) -> dict[str, Any]:
    mechanism = subject.mechanism
    kind = mechanism.type_of(joint)
    driven = {axis for drive in mechanism.drives if drive.name in mechanism.active for axis in drive.drives}
    states = dict.fromkeys(mechanism.lock, "locked") | dict.fromkeys(mechanism.active, "motor")
    axes = [
        {
            "name": name,
            "state": states.get(name, "driven" if name in driven else "passive"),
            "unit": "m" if linear else "rad",
        }
        for name, linear in zip(kind.axis_names(joint.name), kind.linear, strict=True)
        if not (joint.closure and joint.cut == "contact")  # rows only: its axes are no columns
    ]
    return {
        "name": joint.name,
        "type": joint.type,
        "between": [joint.first, joint.second],
        "closes_loop": joint.closure,
        "axes": axes,
        "values": [] if joint.closure else subject.configuration[joint.name].tolist(),
        "limits": [_limits(limits) for limits in joint.limits],
    }


def _limits(limits: Limits) -> dict[str, float | None]:
    return {"lower": limits.lower, "upper": limits.upper, "rate": limits.rate, "effort": limits.effort}


def _motors(mechanism: Mechanism) -> list[dict[str, Any]]:
    """Motors that have a name of their own: those of the file, and drives."""
    named = [{"name": name, "drives": {axis: 1.0}} for name, axis in mechanism.motors.items()]
    return [*named, *({"name": drive.name, "drives": dict(drive.drives)} for drive in mechanism.drives)]


def _closure(subject: Subject) -> dict[str, Any]:
    mechanism = subject.mechanism
    residuals = mechanism.residuals(subject.configuration)
    allowed = CLOSED * mechanism.length
    return {
        "residual": max((residual.gap for residual in residuals), default=0.0),
        "allowed": allowed,
        "open": [
            {"name": r.name, "kind": r.kind, "linear": r.linear, "angular": r.angular, "gap": r.gap}
            for r in residuals
            if not r.gap < allowed
        ],
    }


def _reference(mechanism: Mechanism) -> dict[str, Any] | None:
    reference = mechanism.reference
    if reference is None:
        return None
    return {"body": reference.body, "point": reference.origin.tolist(), "axes": reference.axes}


def _mobility(subject: Subject) -> dict[str, Any]:
    """Number of independent motions, which does not depend on the reference member."""
    mechanism = subject.mechanism
    if mechanism.reference is None:
        candidate = _any_member(mechanism)
        if candidate is None:
            return {"motions": None, "status": None, "reason": "no body can move"}
        mechanism = candidate
    try:
        ledger = mechanism.linearize(subject.configuration).ledger
    except ClosureError:
        return {"motions": None, "status": None, "reason": "loops are open at this configuration"}
    decision = ledger.decision("all")
    return {"motions": decision.shape[1] - decision.rank, "status": decision.status, "reason": None}


def _any_member(mechanism: Mechanism) -> Mechanism | None:
    """The mechanism with some body as reference member that is not fixed to the ground."""
    for body in reversed(mechanism.bodies):
        candidate = mechanism.with_reference(body.name)
        try:
            _ = candidate.reduction
        except TopologyError:
            continue
        return candidate
    return None
