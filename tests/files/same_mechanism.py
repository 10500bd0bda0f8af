"""Whether a file that was written reads back to the same mechanism: counts, efficiencies, poses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vincula as vc
from vincula.files.save import Saved, save

ROBOTS = {"mjcf": ".xml", "sdf": ".sdf", "urdf-plus": ".urdf", "urdf-gepetto": ".urdf"}
"""The formats of robot files that can be written, and how their names end."""
COUNTS = ("ar", "pr", "oi", "t", "ap", "ao", "po")
ELLIPSOIDS = ("kinematic", "active_force", "passive_force", "dual_force")


def numbers(mechanism: vc.Mechanism) -> tuple[dict[str, int], dict[str, int], dict[str, list[float]]]:
    """The seven counts, the summary without static indeterminacy, the efficiencies."""
    found: dict[str, Any] = vc.analyze(mechanism.linearize(), vc.Weights()).to_dict()
    summary = {k: v for k, v in found["mobility"]["summary"].items() if k != "static_indeterminacy"}
    counts = {key: found["mobility"]["counts"][key] for key in COUNTS}
    return counts, summary, {key: [float(e) for e in found[key]["efficiencies"]] for key in ELLIPSOIDS}


def same_numbers(one: vc.Mechanism, other: vc.Mechanism, *, counts: bool = True) -> None:
    """Without `counts` the parts of the space of motions may differ: a ball that has become rows has no
    rates of its own, so it no longer counts as a passive joint that moves."""
    first, second = numbers(one), numbers(other)
    assert second[1] == first[1]
    assert second[0] == first[0] or not counts
    for key, efficiencies in first[2].items():
        assert second[2][key] == pytest.approx(efficiencies, rel=1e-9, abs=1e-300), key


def with_reference_of(saved: Saved, mechanism: vc.Mechanism, again: vc.Mechanism) -> vc.Mechanism:
    """The mechanism read back, with the reference member that `save` says to give."""
    assert mechanism.reference is not None
    said = [text for text in saved.changed if "--reference" in text]
    assert len(said) == 1
    body, _, frame = said[0].partition("--reference ")[2].split(" ")[0].partition("@")
    return again.with_reference(body, frame=frame or None, axes=mechanism.reference.axes)


def read_back(
    mechanism: vc.Mechanism, path: Path, to: str | None = None, **how: bool
) -> tuple[vc.Mechanism, Saved]:
    """What is read of what was written, with the same reference member."""
    saved = save(mechanism, path, to, **how)
    again = vc.load(path)
    if mechanism.reference is not None and saved.format != "native":
        again = with_reference_of(saved, mechanism, again)
    return again, saved


def same_poses(one: vc.Mechanism, other: vc.Mechanism, *, origins: bool = True) -> None:
    """Every body of the one stands in the other as before; without `origins` its axes are the same."""
    there = {body.name: body.pose for body in other.bodies}
    size = max(1.0, one.length)
    for body in one.bodies:
        pose = there[body.name]
        assert np.abs(pose.rotation - body.pose.rotation).max() < 1e-14
        if origins:
            assert np.abs(pose.position - body.pose.position).max() < 1e-14 * size
