"""Batch = loop on every example, by hand: `python -m benchmarks.batch [configurations] [example ...]`.

Random closed configurations, a third of them in or near singularities, are evaluated in lanes and one by
one.  Counts, classes and status must be the same, efficiencies within 1e-10 where they are well
conditioned and within the reported bound elsewhere, and lanes must give the same bits for any batch
size, chunking and number of threads.  100 000 configurations take about an hour.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from tests.laws.batch_and_loop import COMPARED, compared
from tests.laws.random_configurations import random_configurations

import vincula as vc
from vincula.mechanism.catalog import examples


def identical(compiled: vc.CompiledMechanism, lanes: np.ndarray) -> bool:
    """Whether every way to cut the batch gives the same bits."""
    whole = compiled.evaluate(lanes, COMPARED)
    for threads, chunk in ((1, 7), (2, 64), (3, 1000), (2, len(lanes))):
        for start in range(0, min(len(lanes), 50 * chunk), chunk):
            part = compiled.evaluate(lanes[start : start + chunk], COMPARED, threads=threads)
            for name in part:
                if not np.array_equal(
                    part[name], whole[name][start : start + chunk], equal_nan=part[name].dtype.kind == "f"
                ):
                    return False
    return True


def main(count: int, names: list[str]) -> int:
    """Print one line an example; 1 if anything differs."""
    print(f"{'example':20}{'lanes':>8}{'special':>9}{'status':>8}{'integers':>10}{'values':>8}"
          f"{'largest':>10}{'turned':>10}  bits   seconds")  # fmt: skip
    bad = 0
    for name in names:
        began = time.perf_counter()
        compiled = vc.compile(vc.load(f"example:{name}"))
        lanes = random_configurations(compiled.mechanism, count // len(names))
        found = compared(compiled, lanes)
        same = identical(compiled, lanes)
        bad += not (found.same and same)
        print(f"{name:20}{found.lanes:8}{found.special:9}{found.status:8}{found.integers:10}{found.values:8}"
              f"{found.largest:10.1e}{found.turned:10.1e}  {'same' if same else 'DIFFER'}"
              f"{time.perf_counter() - began:9.0f}", flush=True)  # fmt: skip
        for note in found.notes:
            print("   ", note)
    return 1 if bad else 0


if __name__ == "__main__":
    words = sys.argv[1:]
    number = int(words[0]) if words else 100_000
    sys.exit(main(number, words[1:] or [entry.name for entry in examples()]))
