"""The plan of a mechanism as tables: structure, ranks and orders behind its flat arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.elimination_plan import Eliminator, Front, Samples, ordered
from vincula.kernels.lanes.flatten import Flat, Unsupported
from vincula.kernels.lanes.outputs import output_slots
from vincula.kernels.lanes.relation_plan import LimbPlan, RelationPlan, plan_relation
from vincula.kernels.lanes.structure import Structure
from vincula.mechanism.layout import Layout
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.numerics.ledger import MatrixName, RankLedger


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Tables with the plan in them, and what it says.

    Attributes:
        code: `Flat.code` with the plan behind it.
        counts: The summary counts that certain lanes have.
        twelve: The twelve counts that lanes have which are certain of these; None if no sample is.
    """

    code: NDArray[np.int64]
    counts: SummaryCounts
    twelve: TwelveCounts | None


def make_plan(flat: Flat, layout: Layout, ledgers: Sequence[RankLedger], constants: dict[str, int]) -> Plan:
    """The plan of a mechanism whose matrices are known at samples.

    Args:
        flat: Its flat arrays.
        layout: Its layout.
        ledgers: Ledgers of samples of equal, certain ranks.
        constants: Where the constants of metrics (`metric`) and doubts (`doubt`) begin.

    Raises:
        Unsupported: The ranks found limb by limb are not those of the whole.
    """
    counts = ledgers[0].summary
    structure, samples = Structure.of(layout), Samples.of([one.matrix("all") for one in ledgers])
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
    certain = [one for one in ledgers if one.counts and one.status == "certain"]
    writer.ranks(certain)
    return Plan(np.array(writer.code, dtype=np.int64), counts, certain[0].counts if certain else None)


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
        chained = _chained(fronts)
        for k, front in enumerate(fronts):
            others = len(front.columns) - front.pivots
            width = others + (self.twist if front.member else 0)
            self.place[k] = self.slot(front.handed * width)
            self._room(front.rows, front.pivots + width)
            mode = t.BY_LEFT if front.left and k not in chained else t.BY_REFLECTION
            entries += [
                front.rows, front.pivots, front.rank, others, front.handed,
                mode, int(front.member), self.place[k],
                self.listed(front.blocks), len(front.blocks), self.listed(front.columns),
                self.listed([n for c in front.children for n in self._child(fronts, c, front)]),
                len(front.children), self.listed(front.order), front.reflections, front.limb,
                *(self._chain(fronts, k) if k in chained else (-1, 0, 0, -1, 0, 0)),
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

    def _chain(self, fronts: list[Front], index: int) -> list[int]:
        """Slot of inverses, passive columns among the others, and the front that takes what is handed on."""
        front, motors = fronts[index], self.structure.motors
        after = [k for k, other in enumerate(fronts) if index in other.children]
        rest = [c for c in front.columns[front.pivots :] if c >= motors]
        own = [c for c in self.structure.limbs[front.limb][1] if c < motors]
        where = {column: k for k, column in enumerate(front.columns)}
        positions = [where.get(column, -1) for column in own]
        first = len(front.columns)
        positions += [first + k if front.member else -1 for k in range(self.twist)]
        size, width = front.rank + len(rest), len(positions)
        place = self.slot(front.rank * (size + width) + size * size + size * width)
        numbers: list[int] = []
        for column in rest:
            numbers += [front.columns.index(column), _index_in(fronts[after[0]], column, motors)]
        behind = after[0] if after else -1
        return [place, len(rest), self.listed(numbers), behind, width, self.listed(positions)]

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
        widest = max([d, relation.freedom, *(limb.before + len(limb.motors) for limb in relation.limbs)])
        self.side = max(self.side, reduced, code[t.MOTORS] + d)
        sizes = {
            t.BUFFER: self.buffer,
            t.FACTORS: 3 * self.side,
            t.VECTOR: max(self.side + widest, relation.freedom * widest),
            t.STACK: reduced * d,
            t.BASIS: d * widest,
            t.MOTIONS: relation.freedom * (code[t.MOTORS] + d),
            t.SQUARES: 2 * relation.freedom,
            t.NOTES: t.NOTE_COUNT,
            t.OUTPUT: output_slots(counts, code[t.MOTORS], d),
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

    def ranks(self, ledgers: Sequence[RankLedger]) -> None:
        """The four matrices beyond the summary: shapes, ranks, orders."""
        code, d = self.code, self.twist
        m, n, n_a = code[t.ROWS], code[t.COLUMNS], code[t.MOTORS]
        member, motors = list(range(n, n + d)), list(range(n_a))
        code[t.EVERY_COLUMN] = self.listed(range(n))
        names: dict[MatrixName, tuple[int, list[int]]] = {
            "active": (m, motors), "member": (m, member), "active+member": (m, motors + member),
            "triple": (2 * m, list(range(n + d))),
        }  # fmt: skip
        entries: list[int] = []
        for name, (rows, columns) in names.items():
            of_samples = [one.matrix(name) for one in ledgers]
            rank, order = ordered(of_samples, [one.scale for one in ledgers]) if ledgers else (0, [])
            entry = [rows, rank, len(columns), self.listed(order), *columns]
            entries += entry + [0] * (4 + n + d - len(entry))
        code[t.RANKS], code[t.RANK_SPACE] = self.listed(entries), 4 + n + d
        code[t.WHOLE] = self.slot(3 * m * (n + d))
        code[t.WHOLE_FACTORS] = self.slot(4 * max(2 * m, n + d) + 1)
        code[t.TOTAL_WITH_COUNTS] = self.slots


def _chained(fronts: list[Front]) -> set[int]:
    """Fronts of limbs in which more than one front eliminates something."""
    count: dict[int, int] = {}
    for front in fronts:
        count[front.limb] = count.get(front.limb, 0) + (front.pivots > 0)
    return {k for k, front in enumerate(fronts) if count[front.limb] > 1}


def _index_in(front: Front, column: int, motors: int) -> int:
    """Index of a passive column among the independent pivots and passive others of a front; -1: dropped."""
    position = front.columns.index(column)
    if position >= front.pivots:
        return front.rank + [c for c in front.columns[front.pivots :] if c >= motors].index(column)
    kept = front.order[: front.rank]
    return kept.index(position) if position in kept else -1
