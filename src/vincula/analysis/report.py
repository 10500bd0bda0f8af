"""An analysis as a JSON object (schema vincula/analysis/1) and as text for people."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.analysis.diagnosis import contradictions
from vincula.analysis.doubt import doubt_messages, participation
from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.equilibrium import balances_every_wrench
from vincula.analysis.readings import as_typed, nearest_words
from vincula.analysis.recipes import motor_quantity, motor_units, task_quantity
from vincula.analysis.wording import components
from vincula.arrays import Vector
from vincula.model import LinearModel
from vincula.numerics.evidence import NearestSingular
from vincula.numerics.ledger import MatrixName
from vincula.numerics.metric import Metric

if TYPE_CHECKING:
    from vincula.analysis.maps import LinearMap
    from vincula.analysis.result import Analysis

SCHEMA = "vincula/analysis/1"


def as_object(analysis: Analysis) -> dict[str, Any]:
    """The JSON object: numbers at full precision, infinity as "inf", undefined as null."""
    model = analysis.model
    maps = {
        "twist_from_rates": analysis.twist_from_rates,
        "torque_from_wrench": analysis.torque_from_wrench,
    }
    return {
        "schema": SCHEMA,
        "mechanism": model.mechanism,
        "reference": model.reference,
        "reference_point": None if model.motions is None else model.motions.origin.tolist(),
        "frame": model.frame,
        "active": [c.name for c in model.motors],
        "passive": [c.name for c in model.passives],
        "viewpoint": analysis.viewpoint,
        "convention": analysis.convention,
        "model": _model(model),
        "components": {
            "task": list(model.twist_components),
            "task_units": list(model.twist_units),
            "wrench": list(model.wrench_components),
            "wrench_units": list(model.wrench_units),
            "motors": [c.name for c in model.motors],
            "rate_units": list(motor_units(model, "rate")),
            "torque_units": list(motor_units(model, "torque")),
        },
        "mobility": {
            "counts": model.ledger.counts.as_dict(),
            "nullity": model.ledger.counts.nullity,
            "summary": model.ledger.summary.as_dict(),
            "verdicts": list(analysis.verdicts),
            "blocks": {
                block.name: {
                    "meaning": block.meaning,
                    "motors": _columns(block.motors),
                    "passives": _columns(block.passives),
                    "twist": _columns(block.twist),
                    "residual": block.residual,
                }
                for block in analysis.motions
            },
        },
        "statics": {
            "balances_every_wrench": balances_every_wrench(model),
            "structural_wrenches": _columns(analysis.forces.structural.wrench),
            "internal_torques": _columns(analysis.forces.internal.torque),
            "residual": max(block.residual for block in analysis.forces),
        },
        **{e.kind.replace(" ", "_"): _ellipsoid(e) for e in analysis.ellipsoids},
        "maps": {
            **{name: _matrix(found) for name, found in maps.items()},
            "reasons": {name: found.reason for name, found in maps.items() if found.reason},
            "notes": {name: found.note for name, found in maps.items() if found.note},
        },
        "rank": _rank(analysis),
        "closure": {"residual": model.uncertainty.residual},
        "warnings": list(analysis.warnings),
        "notes": list(model.notes),
    }


def as_text(analysis: Analysis) -> str:
    """Words, numbers and units, for reading."""
    model = analysis.model
    lines = [
        f"{model.mechanism}: member {model.reference}, {model.frame}",
        f"  motors:  {', '.join(c.name for c in model.motors) or '(none)'}",
        f"  passive: {', '.join(c.name for c in model.passives) or '(none)'}",
        "",
        *(f"  {verdict}" for verdict in analysis.verdicts),
    ]
    for ellipsoid in analysis.ellipsoids:
        lines += ["", f"{ellipsoid.kind} ({_per(ellipsoid)})", *_table(ellipsoid)]
    lines += ["", f"rank: {model.ledger.status}; closure residual {model.uncertainty.residual:.2g} m"]
    if analysis.nearest_singular is not None:
        lines.append(nearest_words(analysis.nearest_singular))
    lines += [f"note: {note}" for note in model.notes]
    lines += [f"warning: {message}" for message in analysis.warnings]
    return "\n".join(lines)


def _table(ellipsoid: Ellipsoid) -> list[str]:
    if not ellipsoid.classes:
        return ["  (none)"]
    lines = []
    for value, kind, task, motor in zip(
        ellipsoid.efficiencies,
        ellipsoid.classes,
        ellipsoid.task_directions,
        ellipsoid.motor_directions,
        strict=True,
    ):
        said = {"infinite": "inf", "undefined": "undefined"}.get(kind, f"{value:.5g}")
        direction = "-" if task is None else components(task, ellipsoid.components)
        by = "-" if motor is None else components(motor, ellipsoid.motors)
        lines.append(f"  {said:>10}   {direction}   by {by}")
    return lines


def _per(ellipsoid: Ellipsoid) -> str:
    units = "/".join(dict.fromkeys(ellipsoid.units)) or "1"
    motors = "/".join(dict.fromkeys(ellipsoid.motor_units)) or "1"
    return f"{units} squared per {motors} squared, weighted"


def _model(model: LinearModel) -> dict[str, Any]:
    return {
        "rows": [
            {"name": r.name, "kind": r.kind, "source": r.source, "unit": "m/s" if r.linear else "rad/s"}
            for r in model.rows
        ],
        "columns": [c.name for c in model.columns],
        "cuts": [{"joint": c.joint, "kind": c.kind, "role": c.role, "at": list(c.at)} for c in model.cuts],
        "length": model.length,
    }


def _ellipsoid(ellipsoid: Ellipsoid) -> dict[str, Any]:
    return {
        "efficiencies": [_number(v) for v in ellipsoid.efficiencies],
        "classes": list(ellipsoid.classes),
        "task_directions": [_vector(d) for d in ellipsoid.task_directions],
        "motor_directions": [_vector(d) for d in ellipsoid.motor_directions],
        "bounds": [[_number(low), _number(high)] for low, high in ellipsoid.bounds],
        "clusters": [list(cluster) for cluster in ellipsoid.clusters],
        "weights": {
            task_quantity(ellipsoid.kind): _weight(ellipsoid.task_weight),
            motor_quantity(ellipsoid.kind): _weight(ellipsoid.motor_weight),
        },
    }


def _readings(model: LinearModel) -> dict[str, Any] | None:
    """Summary counts of the numbers as typed, and of what they may mean."""
    reading = model.evidence.reading
    if reading is None:
        return None
    return {
        "typed": as_typed(model).as_dict(),
        "meant": None if reading.summary is None else reading.summary.as_dict(),
        "numbers": list(reading.snapped),
        "refused": reading.refused or None,
    }


def _nearest(found: NearestSingular | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "distance": found.distance,
        "unit": "rad and m/L",
        "largest": {"axis": found.largest[0], "moved": found.largest[1]},
        "residual": found.residual,
        "kantorovich": _number(found.kantorovich),
        "configuration": {joint: list(values) for joint, values in found.configuration.items()},
        "joints": dict(found.joints),
    }


def _rank(analysis: Analysis) -> dict[str, Any]:
    model = analysis.model
    ledger, known = model.ledger, model.evidence
    low, high = ledger.scenarios
    return {
        "status": ledger.status,
        "basis": known.basis or None,
        "assumed_singular": known.assume_singular,
        "snapped": list(known.snapped),
        "readings": _readings(model),
        "nearest_singular": _nearest(analysis.nearest_singular),
        "decisions": [_decision(model, name) for name in ledger.names],
        "scenarios": {"all_doubtful_zero": low.as_dict(), "none_zero": high.as_dict()},
        "contradictions": contradictions(model),
        "messages": doubt_messages(model),
    }


def _decision(model: LinearModel, name: MatrixName) -> dict[str, Any]:
    decision = model.ledger.decision(name)
    proved = decision.certificate
    doubtful = decision.rank_min != decision.rank_max
    return {
        "matrix": decision.name,
        "shape": list(decision.shape),
        "rank": decision.rank,
        "rank_min": decision.rank_min,
        "rank_max": decision.rank_max,
        "status": decision.status,
        "cutoff": decision.cutoff,
        "cutoffs": dict(decision.cutoffs),
        "deciding": decision.deciding,
        "gap": _number(decision.gap),
        "singular_values": [float(v) for v in decision.singular_values],
        "kept": _number(decision.kept),
        "dropped": decision.dropped,
        "participation": dict(participation(model, name, decision)) if doubtful else None,
        "certificate": None
        if proved is None
        else {
            "rank": proved.rank,
            "exact": proved.exact,
            "enclosures": [list(bounds) for bounds in proved.singular_values],
        },
    }


def _matrix(found: LinearMap) -> list[list[float]] | None:
    return None if found.matrix is None else [[float(x) for x in row] for row in found.matrix]


def _weight(metric: Metric) -> list[Any]:
    diagonal = metric.diagonal
    if diagonal is not None:
        return [_number(w) for w in diagonal]
    return [[float(x) for x in row] for row in metric.matrix]


def _columns(columns: Any) -> list[list[float]]:
    return [[float(x) for x in column] for column in np.asarray(columns).T]


def _vector(direction: Vector | None) -> list[float] | None:
    return None if direction is None else [float(x) for x in direction]


def _number(value: float) -> float | str | None:
    value = float(value)
    if math.isnan(value):
        return None
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return value
