"""Mechanisms of planted structure: the twelve integers first, the matrices made from them.

Canonical blocks (one direction a type, two for g) are mixed by random invertible matrices: the rows
among each other, and the columns of every group among each other.  Neither changes a count.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vincula.labels import Column, Row
from vincula.model import LinearModel

Matrix = NDArray[np.float64]
KERNELS = {"ar": "A", "pr": "P", "oi": "O"}
RANGES = {"t": "APO", "ap": "AP", "ao": "AO", "po": "PO", "a": "A", "p": "P", "o": "O", "none": ""}
NAMES = ("ar", "pr", "oi", "t", "ap", "ao", "po", "g", "a", "p", "o", "none")


@dataclass(frozen=True, eq=False)
class Planted:
    """A random mechanism whose counts are known.

    Attributes:
        counts: The twelve integers.
        active: J_a.
        passive: J_p.
        member: G^T.
        kernel: An exact basis of all motions (q_a, q_p, u), before rounding.
    """

    counts: dict[str, int]
    active: Matrix
    passive: Matrix
    member: Matrix
    kernel: Matrix
    model: LinearModel = field(repr=False)


def planted(rng: np.random.Generator, most: int = 2) -> Planted:
    """Draw a mechanism; every count is 0 to `most`."""
    counts = {name: int(n) for name, n in zip(NAMES, rng.integers(0, most + 1, len(NAMES)), strict=True)}
    if not (counts["oi"] or any(counts[n] for n in ("t", "ao", "po", "g", "o"))):
        counts["o"] = 1  # a member needs at least one twist component
    return from_counts(counts, rng)


def from_counts(counts: dict[str, int], rng: np.random.Generator) -> Planted:
    """A random mechanism with these counts."""
    groups, m, free = _canonical(counts)
    row_mix = _mix(m, rng)
    column_mix = {name: _mix(block.shape[1], rng) for name, block in groups.items()}
    mixed = {name: row_mix @ block @ column_mix[name] for name, block in groups.items()}
    undone = [np.linalg.inv(column_mix[name]) for name in "APO"]
    starts = np.cumsum([0, *(groups[name].shape[1] for name in "APO")])
    kernel = np.vstack([undo @ free[a:b] for undo, a, b in zip(undone, starts[:-1], starts[1:], strict=True)])
    return Planted(
        counts, mixed["A"], mixed["P"], -mixed["O"], kernel, model(mixed["A"], mixed["P"], -mixed["O"])
    )


def model(active: Matrix, passive: Matrix, member: Matrix) -> LinearModel:
    """A linear model of bare J_a, J_p and G^T."""
    rows = tuple(Row(f"r{i}", "contact", f"r{i}", True) for i in range(active.shape[0]))
    motors = tuple(Column(f"a{i}", f"a{i}", False) for i in range(active.shape[1]))
    passives = tuple(Column(f"p{i}", f"p{i}", False) for i in range(passive.shape[1]))
    return LinearModel(active, passive, member.T, rows, motors, passives, space=None)


def _canonical(counts: dict[str, int]) -> tuple[dict[str, Matrix], int, Matrix]:
    """Canonical blocks of J_a, J_p and -G^T, the number of rows, and the kernel of all three."""
    columns: dict[str, list[tuple[int, ...]]] = {"A": [], "P": [], "O": []}
    motions: list[dict[tuple[str, int], float]] = []
    row = 0

    def add(group: str, *rows: int) -> tuple[str, int]:
        columns[group].append(rows)
        return group, len(columns[group]) - 1

    for name, group in KERNELS.items():
        motions += [{add(group): 1.0} for _ in range(counts[name])]
    for name, members in RANGES.items():
        for _ in range(counts[name]):
            first, *others = [add(group, row) for group in members] or [None]
            motions += [{first: 1.0, other: -1.0} for other in others if first]
            row += 1
    for _ in range(counts["g"]):
        a, p, o = add("A", row), add("P", row + 1), add("O", row, row + 1)
        motions.append({a: 1.0, p: 1.0, o: -1.0})
        row += 2
    blocks = {}
    for group, found in columns.items():
        blocks[group] = np.zeros((row, len(found)))
        for j, rows in enumerate(found):
            blocks[group][list(rows), j] = 1.0
    starts = {"A": 0, "P": len(columns["A"]), "O": len(columns["A"]) + len(columns["P"])}
    kernel = np.zeros((sum(map(len, columns.values())), len(motions)))
    for k, motion in enumerate(motions):
        for (group, j), value in motion.items():
            kernel[starts[group] + j, k] = value
    return blocks, row, kernel


def _mix(size: int, rng: np.random.Generator) -> Matrix:
    """A random invertible matrix with singular values from 0.2 to 5."""
    left, right = (np.linalg.qr(rng.standard_normal((size, size)))[0] for _ in range(2))
    return left * 5.0 ** rng.uniform(-1.0, 1.0, size) @ right
