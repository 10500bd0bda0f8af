"""Side by side in one run: our kernels, our reference path, and what else can do the job.

    python benchmarks/bench.py [--rounds 7] [--cases stewart five_bar ladder ...] [--scale 1.0]

Every case is measured in turns, peer after peer, round after round; medians are printed with their ratios
and written to benchmarks/out/latest.json.  A peer that is not installed is left out with a line that says
why, one that cannot do a case is null.  docs/benchmarks.md tells what each case and peer is.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from peers import cases
from peers.capacity import capacity_form
from peers.closed_form import jax_form
from peers.engine import Engine
from peers.floor import Floor, difference, efficiencies
from peers.ours import EVERYTHING, SHARED, Ours
from peers.timing import Peer, exponent, interleaved, machine

import vincula as vc

OUT = Path(__file__).resolve().parent / "out"
PEERS = ("ours", "reference", "mujoco", "jax", "floor", "pycapacity")
LEGS = (6, 12, 24, 48, 96)
LOOPS = (1, 2, 5, 10, 20, 50, 100)
T = TypeVar("T")
Row = dict[str, float | None]


def affordable(run: Callable[[cases.Array], object], numbers: cases.Array) -> int:
    """How many configurations take about two seconds, judged by ever larger calls."""
    count = min(16, len(numbers))
    while True:
        start = time.perf_counter()
        run(numbers[:count])
        spent = time.perf_counter() - start
        if count == len(numbers) or spent > 0.5:
            return min(len(numbers), max(16, int(count * 2.0 / spent)))
        count = min(8 * count, len(numbers))


class Bench:
    """The peers of this run and what they measured.

    Args:
        rounds: How often each peer is measured.
        scale: Sizes of the batches against the usual ones.
    """

    def __init__(self, rounds: int, scale: float) -> None:
        self.rounds, self.scale = rounds, scale
        self.rows: dict[str, Row] = {}
        self.notes: list[str] = []
        self.stewart = cases.stewart()
        self.engine = self._there("MuJoCo", lambda: Engine(self.count(2000)))
        self.floor = self._there("the C++ floor", lambda: Floor(self.stewart, OUT))
        self.jax = self._there("JAX", lambda: jax_form(self.stewart))
        sample = cases.random_poses(100)
        self.capacity = self._there("pycapacity", lambda: capacity_form(self.stewart, sample))
        self._check(sample)

    def count(self, usual: int) -> int:
        """Size of a batch."""
        return max(16, int(usual * self.scale))

    def _there(self, name: str, make: Callable[[], T]) -> T | None:
        try:
            return make()
        except (ImportError, RuntimeError, OSError) as error:
            self.note(f"{name} is left out: {error}")
            return None

    def note(self, text: str) -> None:
        """Say something, now and in the record."""
        self.notes.append(text)
        print(text, flush=True)

    def _check(self, poses: cases.Array) -> None:
        """Every peer computes the same before anything is timed."""
        if self.floor is not None:
            found = self.floor.run(poses, np.empty((len(poses), 84)))
            self.note(f"floor against LAPACK: {difference(self.stewart, poses, found[:, :6]):.1e}")
        if self.jax is not None:
            found = np.array(self.jax(poses)[0])
            self.note(f"JAX against LAPACK: {difference(self.stewart, poses, found):.1e}")
        if self.engine is not None:
            self.note(f"MuJoCo against LAPACK: {self.engine.difference:.1e}")

    def ours(
        self, ours: Ours, batch: cases.Array, small: int, expected: cases.Array | None = None
    ) -> dict[str, Peer]:
        """Our kernels on a batch, and our reference path on its first few."""
        peers: dict[str, Peer] = {}
        for name, path, numbers in (("ours", "lanes", batch), ("reference", "reference", batch[:small])):
            one = Ours(ours.mechanism, ours.quantities, ours.given, path)
            try:
                if expected is not None:
                    worst = one.check(numbers[: len(expected)], expected[: len(numbers)])
                    self.note(f"{name} against LAPACK: {worst:.1e}")
                else:
                    one.run(numbers)
            except (vc.VinculaError, RuntimeError) as error:
                self.note(f"{name} is left out: {error}")
                continue
            few = numbers[: affordable(one.run, numbers)]
            peers[name] = Peer(lambda one=one, few=few: one.run(few), len(few))
        return peers

    def record(self, case: str, peers: dict[str, Peer], *, rounds: int = 0, **more: float) -> Row:
        """Measure a case, print its line, keep it."""
        found = interleaved(peers, rounds or self.rounds)
        row: Row = {f"{name}_us": found.get(name) for name in PEERS}
        row.update({f"{name}_us": time for name, time in found.items()})
        row.update(more)
        self.rows[case] = row
        mine = row["ours_us"]
        cells = []
        for name in PEERS:
            time = row[f"{name}_us"]
            ratio = f" ({time / mine:8.2f})" if time is not None and mine else " " * 11
            cells.append((f"{time:10.3f}" if time is not None else f"{'-':>10}") + ratio)
        print(f"{case:26}" + "".join(cells), flush=True)
        return row


def stewart_closed(bench: Bench) -> None:
    """Closed configurations: spectra and axes of motions and forces."""
    poses = cases.random_poses(bench.count(200_000))
    expected = efficiencies(bench.stewart, poses[:20])
    batch = bench.stewart.configurations(poses)
    for case, quantities, width in (
        ("stewart_closed", EVERYTHING, 156),
        ("stewart_closed_one_set", SHARED, 84),
    ):
        peers = bench.ours(Ours(bench.stewart.mechanism, quantities), batch, bench.count(100), expected)
        if bench.engine is not None:
            peers["mujoco"] = Peer(bench.engine.run, bench.engine.count)
        _of_poses(bench, peers, poses, width)
        if bench.capacity is not None:
            peers["pycapacity"] = Peer(bench.capacity, 100)
        bench.record(case, peers)


def stewart_closure(bench: Bench) -> None:
    """Poses along a path: loops are closed from the neighbouring configuration first."""
    poses = cases.path_poses(bench.count(200_000))
    ours = Ours(bench.stewart.mechanism, EVERYTHING, given="reference")
    peers = bench.ours(ours, poses, bench.count(30), efficiencies(bench.stewart, poses[:20]))
    engine = bench.engine
    if engine is not None:
        peers["mujoco"] = Peer(lambda: engine.run(posed=True), engine.count)
    _of_poses(bench, peers, poses, 156)
    bench.record("stewart_closure", peers)


def _of_poses(bench: Bench, peers: dict[str, Peer], poses: cases.Array, width: int) -> None:
    """The two peers that need the pose alone."""
    jax, floor = bench.jax, bench.floor
    if jax is not None:
        few = poses[: bench.count(20_000)]
        peers["jax"] = Peer(lambda: jax(few), len(few))
    if floor is not None:
        out = np.empty((len(poses), width))
        peers["floor"] = Peer(lambda: floor.run(poses, out), len(poses))


def five_bar(bench: Bench) -> None:
    """The five-bar, motors driven along a path, closure included; kinematic spectrum."""
    ours = Ours(vc.load("example:five-bar"), ("kinematic.efficiencies",), given="motors")
    peers = bench.ours(ours, cases.path_motors(bench.count(400_000)), bench.count(30))
    row = bench.record("five_bar", peers)
    if row["ours_us"]:
        bench.note(f"five-bar, closure included: {1.0 / row['ours_us']:.2f} million configurations a second")


def stewart_single(bench: Bench) -> None:
    """One prepared configuration from Python: kinematic efficiencies and axes; then with cold closure."""
    poses = cases.random_poses(50)
    quantities = ("kinematic.efficiencies", "kinematic.task_directions", "kinematic.motor_directions")
    closed = list(bench.stewart.configurations(poses))
    mechanism = bench.stewart.mechanism
    peers = _one_by_one(bench, Ours(mechanism, quantities), closed)
    jax, floor, out = bench.jax, bench.floor, np.empty((1, 84))
    if jax is not None:
        peers["jax"] = Peer(lambda: [jax(pose) for pose in poses[:, None]], len(poses))
    if floor is not None:
        peers["floor"] = Peer(lambda: [floor.run(pose, out, 1) for pose in poses[:, None]], len(poses))
    bench.record("stewart_single", peers, rounds=10 * bench.rounds)
    cold = _one_by_one(bench, Ours(mechanism, quantities, given="reference"), list(poses))
    bench.record("stewart_single_closure", cold, rounds=10 * bench.rounds)


def _one_by_one(bench: Bench, ours: Ours, single: list[cases.Array]) -> dict[str, Peer]:
    peers = {}
    for name, path, few in (("ours", "lanes", single), ("reference", "reference", single[:3])):
        one = Ours(ours.mechanism, ours.quantities, ours.given, path)
        try:
            one.run(few[0])
        except vc.VinculaError as error:
            bench.note(f"{name} is left out: {error}")
            continue
        peers[name] = Peer(lambda one=one, few=few: [one.run(numbers) for numbers in few], len(few))
    return peers


def legs(bench: Bench) -> None:
    """Platforms on ever more legs: kinematic and force efficiencies and axes."""
    times: list[float | None] = []
    for count in LEGS:
        platform = cases.many_legs(count)
        poses = cases.random_poses(bench.count(120_000 // count), reach=0.1)
        ours = Ours(platform.mechanism, SHARED)
        peers = bench.ours(ours, platform.configurations(poses), bench.count(10))
        times.append(bench.record(f"legs_{count}", peers)["ours_us"])
    _exponent(bench, "legs", LEGS, times)


def ladder(bench: Bench) -> None:
    """Rows of ever more four-bar loops: kinematic efficiency and its axes."""
    times: list[float | None] = []
    quantities = ("kinematic.efficiencies", "kinematic.task_directions", "kinematic.motor_directions")
    for loops in LOOPS:
        batch = cases.ladder_configurations(loops, bench.count(200_000 // (loops + 4)))
        peers = bench.ours(Ours(cases.ladder(loops), quantities), batch, bench.count(10))
        times.append(bench.record(f"ladder_{loops}", peers)["ours_us"])
    _exponent(bench, "ladder", LOOPS, times)


def _exponent(bench: Bench, name: str, sizes: tuple[int, ...], times: list[float | None]) -> None:
    known = [(size, time) for size, time in zip(sizes, times, strict=True) if time]
    if len(known) > 1:
        slope = exponent(*zip(*known, strict=True))
        bench.rows[f"{name}_exponent"] = {"ours": slope}
        bench.note(f"{name}: cost grows like size to the power {slope:.2f}")


CASES: dict[str, Callable[[Bench], None]] = {
    "stewart_closed": stewart_closed,
    "stewart_closure": stewart_closure,
    "five_bar": five_bar,
    "stewart_single": stewart_single,
    "legs": legs,
    "ladder": ladder,
}


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument(
        "--scale", type=float, default=1.0, help="sizes of the batches against the usual ones"
    )
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    asked = parser.parse_args()
    facts = machine()
    print(", ".join(str(fact) for fact in facts.values()))
    bench = Bench(asked.rounds, asked.scale)
    print(f"\nus a configuration (times ours)\n{'':26}" + "".join(f"{name:>10}{'':11}" for name in PEERS))
    try:
        for case in asked.cases:
            CASES[case](bench)
    finally:
        if bench.engine is not None:
            bench.engine.close()
    OUT.mkdir(exist_ok=True)
    record = {**bench.rows, "machine": facts, "notes": bench.notes}
    (OUT / "latest.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
