"""A ranking of motor choices as a JSON object (schema vincula/placement/1) and as text for people."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from vincula.analysis.ranking import CRITERIA
from vincula.analysis.wording import number
from vincula.design.motor_choice import MotorChoice, OverConfigurations
from vincula.design.placement_words import how_looked

if TYPE_CHECKING:
    from vincula.design.placement import Placement

SCHEMA = "vincula/placement/1"
COUNTS = (
    "indeterminacy", "redundancy", "coordinated", "passive_redundancy", "internal_torques",
    "structural_wrenches", "static_indeterminacy",
)  # fmt: skip
"""Summary counts of a choice, each the largest over the configurations."""
LINES = 60
"""Choices that the text shows; the object holds all."""


def as_object(placement: Placement) -> dict[str, Any]:
    """The JSON object: numbers at full precision, infinity as "inf", undefined as null."""
    admissible, looked = placement.admissible, placement.looked
    first = looked.models[0]
    ranks = {id(choice): rank for rank, choice in enumerate(placement.choices, start=1)}
    return {
        "schema": SCHEMA,
        "mechanism": first.mechanism,
        "reference": first.reference,
        "frame": first.frame,
        "rank_by": placement.rank_by,
        "on": placement.on,
        "candidates": [{"name": name, "cost": admissible.cost[name]} for name in admissible.candidates],
        "required": list(admissible.required),
        "motors": list(admissible.sizes),
        "configurations": {
            "count": len(looked.models),
            "left_out": [{"point": point, "reason": reason} for point, reason in looked.left_out],
        },
        "admissible": admissible.count,
        "exhaustive": placement.exhaustive,
        "seed": placement.seed,
        "controlling": len(placement.controlling),
        "fewest_motors": placement.fewest,
        "all_candidates_control": placement.limit.controls,
        "explanation": list(placement.explanation),
        "front": {
            "criteria": list(placement.front_criteria),
            "ranks": [ranks[id(choice)] for choice in placement.front],
        },
        "choices": [_choice(rank, choice) for rank, choice in enumerate(placement.choices, start=1)],
        "warnings": list(placement.warnings),
    }


def _choice(rank: int, choice: MotorChoice) -> dict[str, Any]:
    return {
        "rank": rank,
        "motors": list(choice.motors),
        "cost": choice.cost,
        "controls": choice.controls,
        "index": json_number(choice.index),
        "mean": json_number(choice.mean),
        "reason": choice.reason or None,
        "why": list(choice.why),
        "counts": {name: choice.largest(name) for name in COUNTS},
        "indices": {name: _over(found) for name, found in choice.indices.items()},
        "fails_at": list(choice.fails_at),
        "doubtful_at": list(choice.doubtful_at),
        "status": "doubtful" if choice.doubtful_at else "certain",
    }


def _over(found: OverConfigurations) -> dict[str, Any]:
    return {"worst": json_number(found.worst), "mean": json_number(found.mean), "at": found.at}


def json_number(value: float | None) -> float | str | None:
    """A number as JSON can hold it: infinity as a text, what does not exist as null."""
    if value is None or math.isnan(value):
        return None
    return "inf" if value == math.inf else value


def as_text(placement: Placement) -> str:
    """The ranking as lines of text."""
    first = placement.looked.models[0]
    lines = [
        f"{first.mechanism}: motors for {first.reference}, {first.frame}",
        f"{how_looked(placement)}, best first by {CRITERIA[placement.rank_by]}",
        "",
    ]
    on_front = {id(choice) for choice in placement.front}
    for rank, choice in enumerate(placement.choices[:LINES], start=1):
        index = "-" if choice.index is None else number(choice.index)
        star = "*" if id(choice) in on_front else " "
        because = f"   {choice.reason}" if choice.reason else ""
        lines.append(f"{rank:>5}{star} {index:>10}   {', '.join(choice.motors)}{because}")
    if len(placement.choices) > LINES:
        lines.append(f"      {len(placement.choices) - LINES} more behind these")
    lines += ["", *placement.explanation, *(f"warning: {text}" for text in placement.warnings)]
    return "\n".join(lines)
