"""Batch = loop, by hand: `python -m benchmarks.batch [configurations] [mechanism ...]`.

Random closed configurations, a third of them in or near singularities, are evaluated in lanes and one by
one.  A mechanism is the name of an example (by default all of them), FILE@REFERENCE-BODY or random:SEED.
Counts, classes and status must be the same, efficiencies within 1e-10 where they are well
conditioned and within the reported bound elsewhere, and lanes must give the same bits for any batch
size, chunking and number of threads.  100 000 configurations take about half an hour.
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
from vincula.kernels.lanes.closing import given_at
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


def many_configurations(compiled: vc.CompiledMechanism, count: int) -> np.ndarray:
    """count x coordinates: some closed one by one, the others in batches near them.

    Half of these are 1e-15 to 0.1 away from where they come from: near singularities at all distances.
    """
    mechanism = compiled.mechanism
    bases = random_configurations(mechanism, max(count // 8, 24))
    try:
        motors = np.array([given_at(mechanism, "motors", compiled.configuration(flat)) for flat in bases])
        rng = np.random.default_rng(count)
        picked = rng.integers(0, len(bases), max(0, count - len(bases)))
        near = rng.random(len(picked)) < 0.5
        reach = np.where(
            near, 10.0 ** -rng.uniform(1.0, 15.0, len(picked)), rng.uniform(0.02, 0.4, len(picked))
        )
        wanted = motors[picked] + reach[:, None] * rng.uniform(-1.0, 1.0, (len(picked), motors.shape[1]))
        found = compiled.evaluate(wanted, ("configuration",), given="motors", start=bases[picked])
    except (vc.VinculaError, KeyError):  # motors of balls have no values of their own
        return random_configurations(mechanism, count)
    closed = np.isfinite(found["configuration"]).all(axis=1)
    return np.concatenate([bases, found["configuration"][closed]])


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
        lanes = many_configurations(compiled, count // len(names))
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
