"""Traced arithmetic as a list of instructions for lanes: what the results need, in few slots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.traced import CONSTANT, INPUT, Number, Trace, Traced


@dataclass(frozen=True, slots=True, eq=False)
class Formulas:
    """Results as functions of parameters.

    Attributes:
        code: Instructions, see `lanes.formulas`.
        constants: What stands in the first slots.
        slots: Number of slots.
        fixed: All results, right where they do not depend on the parameters.
        columns: Results that do depend on them.
        places: Their slots.
    """

    code: NDArray[np.int64]
    constants: Vector
    slots: int
    fixed: Vector
    columns: NDArray[np.int64]
    places: NDArray[np.int64]

    @staticmethod
    def of(trace: Trace, results: Sequence[Number]) -> Formulas:
        """The formulas of results, with the guards of their trace.

        Args:
            trace: The trace.
            results: Floats and traced numbers.
        """
        return _Writer(trace, results).formulas()

    def evaluate(self, parameters: Matrix, threads: int | None = None) -> tuple[Matrix, NDArray[np.bool_]]:
        """Results of many sets of parameters, and where they hold: all guards come out as in the trace.

        The bits of a row do not depend on the other rows, nor on the number of threads.

        Args:
            parameters: N x parameters, in the order of the trace.
            threads: Threads to use; None for one a core.
        """
        from vincula.kernels.lanes.formulas import WIDTH, formula_entry
        from vincula.kernels.lanes.threads import in_shares

        inputs = np.require(parameters, np.float64, ["C", "W"])
        out = np.empty((len(inputs), len(self.fixed)))
        kept = np.zeros(len(inputs), dtype=np.bool_)
        run = formula_entry()

        def share(first: int, last: int) -> None:
            run(self.code, self.constants, self.slots, self.fixed, self.columns, self.places, inputs,
                first, last, out, kept)  # fmt: skip

        if len(inputs):
            in_shares(share, -(-len(inputs) // WIDTH), threads, least=SHARE)
        return out, kept


SHARE = 32
"""Blocks that are worth a thread."""


class _Writer:
    """Lays out instructions: only what is needed, slots used again as soon as they are free."""

    def __init__(self, trace: Trace, results: Sequence[Number]) -> None:
        self.trace, self.results = trace, results
        self.columns: dict[int, list[int]] = {}
        for column, x in enumerate(results):
            if isinstance(x, Traced):
                self.columns.setdefault(x.place, []).append(column)
        self.guards: dict[int, list[tuple[int, int, int, int]]] = {}
        for (comparison, a, b), outcome in trace.guards.items():
            self.guards.setdefault(max(a, b), []).append((comparison, int(outcome), a, b))
        self.last = self._last_uses()
        self.slot: dict[int, int] = {}
        self.code: list[tuple[int, ...]] = []

    def _operands(self, place: int) -> tuple[int, ...]:
        node = self.trace.nodes[place]
        return () if node[0] in (INPUT, CONSTANT) else node[1:]

    def _last_uses(self) -> dict[int, int]:
        """For every node that is needed, the last one that needs it."""
        # Results stay until the end of the block: it is written row by row.
        last = dict.fromkeys(self.columns, len(self.trace.nodes))
        for place, guards in self.guards.items():
            for _, _, a, b in guards:
                for side in (a, b):
                    last[side] = max(last.get(side, side), place)
        for place in range(len(self.trace.nodes) - 1, -1, -1):
            if place in last:
                for operand in self._operands(place):
                    last[operand] = max(last.get(operand, operand), place)
        return last

    def formulas(self) -> Formulas:
        """Everything as arrays."""
        nodes = self.trace.nodes
        needed = sorted(self.last)
        fixed = [place for place in needed if nodes[place][0] == CONSTANT]
        self.slot = {place: k for k, place in enumerate(fixed)}
        free: list[int] = []
        slots = len(fixed)
        ends: dict[int, list[int]] = {}
        for place, end in self.last.items():
            if place not in self.slot:
                ends.setdefault(end, []).append(place)
        for place in needed:
            if nodes[place][0] != CONSTANT:
                if not free:
                    free.append(slots)
                    slots += 1
                # Operands are still occupied, so that no instruction overwrites what it reads.
                self.slot[place] = free.pop()
                self._write(place)
            self._compare(place)
            free += [self.slot[done] for done in ends.get(place, ())]
        pairs = [(column, self.slot[place]) for place, own in self.columns.items() for column in own]
        pairs.sort()
        values = [x.value if isinstance(x, Traced) else float(x) for x in self.results]
        return Formulas(
            np.array(self.code, dtype=np.int64).reshape(-1, 5),
            np.array([self.trace.constants[nodes[place][1]] for place in fixed], dtype=np.float64),
            max(slots, 1),
            np.array(values, dtype=np.float64),
            np.array([column for column, _ in pairs], dtype=np.int64),
            np.array([slot for _, slot in pairs], dtype=np.int64),
        )

    def _write(self, place: int) -> None:
        operation, *operands = self.trace.nodes[place]
        sides = operands if operation == INPUT else [self.slot[k] for k in operands]
        self.code.append((operation, self.slot[place], *sides, *[0] * (3 - len(sides))))

    def _compare(self, place: int) -> None:
        """Guards that wait for a node."""
        for comparison, outcome, a, b in self.guards.get(place, ()):
            self.code.append((comparison, outcome, self.slot[a], self.slot[b], 0))
