"""Doubt said aloud: which ranks are not decided, why, and what follows either way.

Source: numerics page, "What a result says".
"""

from __future__ import annotations

import warnings

from vincula.analysis.readings import reading_message, settled_messages
from vincula.errors import MixedUnitsWarning, RankAmbiguityWarning
from vincula.model import LinearModel
from vincula.numerics.lapack import svd
from vincula.numerics.ledger import MATRIX_NAMES, MatrixName
from vincula.numerics.rank import RankDecision
from vincula.weights import Quantity, Weights


def warn_of_doubt(model: LinearModel) -> None:
    """Emit one `RankAmbiguityWarning` for every rank that the summary counts rest on in doubt."""
    if model.ledger.status == "doubtful":
        for message in doubt_messages(model):
            warnings.warn(message, RankAmbiguityWarning, stacklevel=4)


def doubt_messages(model: LinearModel) -> list[str]:
    """Every doubtful rank in words, why and what follows either way; then readings and assumptions."""
    ledger = model.ledger
    said = [_said(model, name, ledger.decision(name)) for name in MATRIX_NAMES
            if ledger.decided(name) and ledger.decision(name).status == "doubtful"]  # fmt: skip
    both = reading_message(model)
    return [*said, *([both] if both else []), *settled_messages(model)]


def warn_of_mixed_units(model: LinearModel, weights: Weights, task: Quantity) -> None:
    """Emit a `MixedUnitsWarning` if weights that nobody chose add metres and radians."""
    message = mixed_units_message(model, weights, task)
    if message:
        warnings.warn(message, MixedUnitsWarning, stacklevel=4)


def mixed_units_message(model: LinearModel, weights: Weights, task: Quantity) -> str | None:
    """Why a result over this task side depends on the unit of length; None if it does not."""
    if weights.explicit:
        return None
    if task == "contact_force":
        sides = {row.linear for row in model.rows if row.kind in ("contact", "member cut")}
    else:
        sides = set(model.twist_linear) if model.space else set()
    motors = {column.linear for column in model.motors}
    mixed = [name for name, kinds in ((_SAID[task], sides), ("motors", motors)) if len(kinds) > 1]
    if not mixed:
        return None
    length = model.length or 1.0
    return (
        f"unit weights add metres and radians in {' and '.join(mixed)}: efficiencies depend on the unit of "
        f"length. Give weights, for example characteristic_length_weights({length:g}, model), or Weights() "
        "to keep these"
    )


_SAID: dict[Quantity, str] = {
    "twist": "the twist",
    "wrench": "the wrench",
    "contact_force": "the contact forces",
}

_CAUSES = {
    "rounding": "rounding",
    "closure": "loop closure to {residual:.2g} m",
    "digits": "the digits typed in the file",
    "tolerance": "the manufacturing tolerance",
}
_REMEDIES = {
    "rounding": "move away from this configuration, or give exact dimensions and use --exact, or "
    "--assume-singular",
    "closure": "close the loops more tightly, or --assume-singular",
    "digits": "type more digits (pi/2 instead of 1.5708), or take the numbers as typed by --exact, as what "
    "they may mean by --snap, or --assume-singular",
    "tolerance": "the tolerance allows both: design for the worse one",
}
_CONSEQUENCES: dict[MatrixName, tuple[str, str]] = {
    "active": ("motors can move with everything else at rest", "they cannot"),
    "passive": ("passive joints can move with motors and member at rest", "they cannot"),
    "member": ("the {member} can move with all joints at rest", "it cannot"),
    "active+passive": ("motors can move with the {member} at rest", "they cannot"),
    "active+member": ("motors and {member} can move with the passive joints at rest", "they cannot"),
    "passive+member": ("the {member} can move with all motors locked", "it cannot"),
    "all": ("there is one more motion, and forces that neither motors nor loads determine", "there is not"),
    "triple": ("two kinds of motion coincide", "they are different"),
}


def _said(model: LinearModel, name: MatrixName, decision: RankDecision) -> str:
    low, high = decision.rank_min, decision.rank_max
    between = "or" if high == low + 1 else "to"
    if_low, if_high = (text.format(member=repr(model.reference)) for text in _CONSEQUENCES[name])
    shares = participation_words(model, name, decision)
    return (
        f"Rank of the {decision.name} is {low} {between} {high}: not decided.  "
        f"{_position(model, decision)}.  If {low}: {if_low} ({shares}).  If {high}: {if_high}.  "
        f"Taken as {decision.rank}.  To decide: {_REMEDIES[decision.deciding]}."
    )


def _position(model: LinearModel, decision: RankDecision) -> str:
    """Where the smallest doubtful singular value lies among the uncertainties."""
    smallest, rounding = decision.doubtful_values[-1], decision.cutoffs["rounding"]
    value = f"The singular value {smallest:.2g}"
    if decision.deciding == "rounding":
        return f"{value} is of the size of rounding errors ({rounding:.1g}): it may be one of them, or not"
    above = "above" if smallest > rounding else "hardly above"
    side = "below" if smallest <= decision.cutoff else "not safely above"
    cause = _CAUSES[decision.deciding].format(residual=model.uncertainty.residual)
    told = f"{side} what {cause} can tell from zero ({decision.cutoff:.1g})"
    return f"{value} is {above} rounding ({rounding:.1g}) but {told}"


def participation_words(model: LinearModel, name: MatrixName, decision: RankDecision) -> str:
    """The joints that take part in the doubtful motion, largest shares first."""
    shares = participation(model, name, decision)
    return "shares: " + ", ".join(f"{joint} {share:.2f}" for joint, share in shares[:4])


def participation(model: LinearModel, name: MatrixName, decision: RankDecision) -> list[tuple[str, float]]:
    """Squared shares of joints and member in the direction of the smallest doubtful singular value."""
    right = svd(model.ledger.matrix(name))[2][:, decision.rank_max - 1]
    owners: list[str] = []
    for part in _PARTS[name]:
        if part == "member":
            owners += [model.reference] * model.dimension
        else:
            owners += [c.joint for c in (model.motors if part == "active" else model.passives)]
    total: dict[str, float] = {}
    for owner, value in zip(owners, right, strict=True):
        total[owner] = total.get(owner, 0.0) + float(value * value)
    return sorted(((o, v) for o, v in total.items() if v >= 0.005), key=lambda pair: -pair[1])


_PARTS: dict[MatrixName, tuple[str, ...]] = {
    "active": ("active",),
    "passive": ("passive",),
    "member": ("member",),
    "active+passive": ("active", "passive"),
    "active+member": ("active", "member"),
    "passive+member": ("passive", "member"),
    "all": ("active", "passive", "member"),
    "triple": ("active", "passive", "member"),
}
