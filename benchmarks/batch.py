"""Batch = loop, by hand: `python -m benchmarks.batch [configurations] [mechanism ...]`.

Random closed configurations, a third of them in or near singularities, are evaluated in lanes and one by
one.  A mechanism is the name of an example (by default all of them), FILE@REFERENCE-BODY or random:SEED.
Counts, classes and status must be the same, efficiencies within 1e-10 where they are well
conditioned and within the reported bound elsewhere, and lanes must give the same bits for any batch
size, chunking and number of threads.  100 000 configurations take about an hour.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from tests.laws.batch_and_loop import COMPARED, compared
from tests.laws.random_configurations import random_configurations
from tests.laws.random_mechanisms import random_mechanism

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


def mechanism_of(word: str) -> vc.Mechanism:
    """An example by name, FILE@BODY with its reference member, or random:SEED."""
    if word.startswith("random:"):
        return random_mechanism(int(word.removeprefix("random:")))
    path, at, body = word.rpartition("@")
    return vc.load(path).with_reference(body) if at else vc.load(f"example:{word}")


def main(count: int, names: list[str]) -> int:
    """Print one line an example; 1 if anything differs."""
    print(f"{'example':20}{'lanes':>8}{'special':>9}{'status':>8}{'integers':>10}{'values':>8}"
          f"{'largest':>10}{'turned':>10}  bits   seconds")  # fmt: skip
    bad = 0
    for name in names:
        began = time.perf_counter()
        compiled = vc.compile(mechanism_of(name))
        lanes = random_configurations(compiled.mechanism, count // len(names))
        found = compared(compiled, lanes)
        same = identical(compiled, lanes)
        bad += not (found.same and same)
        print(f"{Path(name).name[-19:]:20}{found.lanes:8}{found.special:9}{found.status:8}{found.integers:10}{found.values:8}"
              f"{found.largest:10.1e}{found.turned:10.1e}  {'same' if same else 'DIFFER'}"
              f"{time.perf_counter() - began:9.0f}", flush=True)  # fmt: skip
        for note in found.notes:
            print("   ", note)
    return 1 if bad else 0


if __name__ == "__main__":
    words = sys.argv[1:]
    number = int(words[0]) if words else 100_000
    sys.exit(main(number, words[1:] or [entry.name for entry in examples()]))
