"""The five-bar with any part changed, and the reduction of a mechanism in short form."""

from __future__ import annotations

from typing import Any

import vincula as vc
from vincula.mechanism.mechanism import Mechanism


def five_bar(**changes: Any) -> Mechanism:
    parts: dict[str, Any] = {
        "joints": [
            vc.Revolute("o1", "ground", "crank", at=(-1, -2)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0)),
            vc.Revolute("o4", "link", "rocker", at=(1, -1)),
            vc.Revolute("o5", "rocker", "ground", at=(1, -2)),
        ],
        "reference": vc.Reference("coupler", origin=(-0.5, 0)),
        "active": ["o1", "o5"],
    }
    return Mechanism.planar(**{**parts, **changes})


def cuts_of(mechanism: Mechanism) -> dict[str, tuple[str, str]]:
    return {cut.joint: (cut.kind, cut.role) for cut in mechanism.linearize().cuts}


def rows_of(mechanism: Mechanism) -> list[tuple[str, str]]:
    return [(row.name, row.kind) for row in mechanism.linearize().rows]


def summary(mechanism: Mechanism) -> tuple[int, ...]:
    """Mobility, passive redundancy, redundancy, indeterminacy, coordinated, internal torques,
    structural wrenches, static indeterminacy."""
    s = mechanism.linearize().ledger.summary
    return (
        s.mobility, s.passive_redundancy, s.redundancy, s.indeterminacy, s.coordinated,
        s.internal_torques, s.structural_wrenches, s.static_indeterminacy,
    )  # fmt: skip
