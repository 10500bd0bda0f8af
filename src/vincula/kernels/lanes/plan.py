"""The plan of a mechanism as tables: structure, ranks and orders behind its flat arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.elimination_plan import Eliminator, Front, Samples
from vincula.kernels.lanes.flatten import Flat, Unsupported
from vincula.kernels.lanes.relation_plan import LimbPlan, RelationPlan, plan_relation
from vincula.kernels.lanes.structure import Structure
from vincula.mechanism.layout import Layout
from vincula.numerics.counts import SummaryCounts


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Tables with the plan in them, and what it says.

    Attributes:
        code: `Flat.code` with the plan behind it.
        counts: The summary counts that certain lanes have.
        finite: Number of finite efficiencies.
    """

    code: NDArray[np.int64]
    counts: SummaryCounts
    finite: int


def make_plan(
    flat: Flat, layout: Layout, matrices: Sequence[Matrix], counts: SummaryCounts, constants: dict[str, int]
) -> Plan:
    """The plan of a mechanism whose matrices are known at samples.

    Args:
        flat: Its flat arrays.
        layout: Its layout.
        matrices: [J_a J_p -G^T] at samples of equal, certain ranks.
        counts: The summary counts there.
        constants: Where the constants of metrics (`metric`) and doubts (`doubt`) begin.

    Raises:
        Unsupported: The ranks found limb by limb are not those of the whole.
    """
    structure, samples = Structure.of(layout), Samples.of(matrices)
    eliminator = Eliminator(structure, samples)
    reduced = [eliminator.limb(k) for k in range(len(structure.limbs))]
    motors = [[c for c in columns if c < structure.motors] for _, columns in structure.limbs]
    twist = int(flat.code[t.TWIST])
    relation = plan_relation(reduced, motors, twist, samples.scales)
    _refuse_other_ranks(eliminator.fronts, relation, structure, twist, counts)
    writer = _Writer(flat, structure)
    writer.fronts(eliminator.fronts)
    writer.limbs(eliminator.fronts, relation)
    writer.header(relation, counts, constants)
    return Plan(np.array(writer.code, dtype=np.int64), counts, counts.coordinated)


def _refuse_other_ranks(
    fronts: list[Front], relation: RelationPlan, structure: Structure, twist: int, counts: SummaryCounts
) -> None:
    n_p = len(structure.occurs[0]) - structure.motors if structure.occurs.size else 0
    passive = sum(front.rank for front in fronts)
    driven = sum(limb.motor_rank for limb in relation.limbs)
    found = {
        "passive redundancy": (n_p - passive, counts.passive_redundancy),
        "redundancy": (structure.motors - driven, counts.redundancy),
        "indeterminacy": (twist - relation.object_rank, counts.indeterminacy),
        "mobility": (relation.freedom, counts.mobility - counts.passive_redundancy),
        "rest": (driven + relation.rest_rank, sum(limb.rank for limb in relation.limbs)),
    }
    wrong = [name for name, (ours, theirs) in found.items() if ours != theirs]
    if wrong:
        raise Unsupported(f"ranks limb by limb do not add up ({', '.join(wrong)})")


class _Writer:
    """Appends the plan to the tables of a mechanism."""

    def __init__(self, flat: Flat, structure: Structure) -> None:
        self.code = [int(c) for c in flat.code]
        self.structure = structure
        self.slots = self.code[t.SLOTS]
        self.twist = self.code[t.TWIST]
        self.buffer = self.side = 1
        self.place: dict[int, int] = {}

    def slot(self, count: int) -> int:
        """The first of `count` new slots."""
        self.slots += count
        return self.slots - count

    def listed(self, numbers: Sequence[int]) -> int:
        """Append whole numbers; where they begin."""
        self.code.extend(int(n) for n in numbers)
        return len(self.code) - len(numbers)

    def fronts(self, fronts: list[Front]) -> None:
        """Entries of all fronts."""
        entries: list[int] = []
        for k, front in enumerate(fronts):
            others = len(front.columns) - front.pivots
            width = others + (self.twist if front.member else 0)
            self.place[k] = self.slot(front.handed * width)
            self._room(front.rows, front.pivots + width)
            entries += [
                front.rows, front.pivots, front.rank, others, front.handed,
                t.BY_LEFT if front.left else t.BY_REFLECTION, int(front.member), self.place[k],
                self.listed(front.blocks), len(front.blocks), self.listed(front.columns),
                self.listed([n for child in front.children for n in self._child(fronts, child, front)]),
                len(front.children), self.listed(front.order), front.reflections, front.limb,
            ]  # fmt: skip
        self.code[t.FRONTS], self.code[t.FRONT] = len(fronts), self.listed(entries)

    def _room(self, rows: int, columns: int) -> None:
        self.buffer = max(self.buffer, rows * columns)
        self.side = max(self.side, rows, columns)

    def _child(self, fronts: list[Front], child: int, parent: Front) -> list[int]:
        """Slot, rows and width of a child's rows, and where they have the columns of the parent."""
        front = fronts[child]
        others = front.columns[front.pivots :]
        width = len(others) + (self.twist if front.member else 0)
        where = {column: k for k, column in enumerate(others)}
        columns = [where.get(column, -1) for column in parent.columns]
        if parent.member:
            columns += [len(others) + k if front.member else -1 for k in range(self.twist)]
        return [self.place[child], front.handed, width, *columns]

    def limbs(self, fronts: list[Front], relation: RelationPlan) -> None:
        """Entries of all limbs, in the order in which they enter the relation."""
        root = {front.limb: k for k, front in enumerate(fronts) if front.root}
        entries: list[int] = []
        for limb in relation.limbs:
            entries += self._limb(limb, self.place[root[limb.limb]] if limb.limb in root else 0)
        self.code[t.LIMBS], self.code[t.LIMB] = len(relation.limbs), self.listed(entries)

    def _limb(self, limb: LimbPlan, place: int) -> list[int]:
        length = len(limb.motors) + limb.before
        reflections = self.slot(limb.rows * length + 3 * limb.rows)
        self._room(limb.rows, len(limb.motors) + self.twist)
        self.side = max(self.side, length)
        return [
            place, limb.rows, len(limb.motors), self.listed(limb.motors), limb.motor_rank,
            self.listed(limb.motor_order), limb.rank, self.listed(limb.row_order), reflections, limb.before,
        ]  # fmt: skip

    def header(self, relation: RelationPlan, counts: SummaryCounts, constants: dict[str, int]) -> None:
        """Sizes, places and what is left."""
        code, d = self.code, self.twist
        reduced = sum(limb.rows for limb in relation.limbs)
        widest = max([d, relation.freedom, *(limb.before for limb in relation.limbs)])
        self.side = max(self.side, reduced, code[t.MOTORS] + d)
        sizes = {
            t.BUFFER: self.buffer,
            t.FACTORS: 3 * self.side,
            t.VECTOR: self.side + widest,
            t.STACK: reduced * d,
            t.BASIS: d * widest,
            t.MOTIONS: relation.freedom * (code[t.MOTORS] + d),
            t.SQUARES: 2 * relation.freedom,
            t.NOTES: t.NOTE_COUNT,
            t.OUTPUT: output_size(counts.coordinated, code[t.MOTORS], d, 3),
        }
        for entry, count in sizes.items():
            code[entry] = self.slot(count)
        code[t.WIDEST], code[t.FREEDOM] = widest, relation.freedom
        code[t.FREE], code[t.IDLE] = counts.indeterminacy, counts.redundancy
        code[t.REDUCED], code[t.METRIC], code[t.DOUBT] = reduced, constants["metric"], constants["doubt"]
        code[t.OBJECT_RANK], code[t.OBJECT_ORDER] = relation.object_rank, self.listed(relation.object_order)
        code[t.REST_ROWS], code[t.REST_RANK] = relation.rest_rows, relation.rest_rank
        code[t.REST_ORDER] = self.listed(relation.rest_order)
        code[t.TOTAL] = self.slots


def output_size(finite: int, motors: int, twist: int, want: int) -> int:
    """Number of results of one configuration: see `results.finish`."""
    directions = (want & 1) + (want >> 1)
    return 3 + 2 * finite + directions * finite * (motors + twist)
