"""Ten million poses of a Stewart platform to disk: `python benchmarks/sweep.py [--points N] [--jobs N]`.

Loops are closed at every pose; three indices and the status are stored.  A second process watches memory.
Afterwards some points are computed again one by one, from the pose alone, and compared with what was stored.
Writes benchmarks/out/sweep.json.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import vincula as vc

OUT = Path(__file__).parent / "out" / "sweep.json"
QUANTITIES = (
    "kinematic.condition:translation",
    "kinematic.yoshikawa_volume:translation",
    "active_force.smallest",
)
WATCH = """
import os, sys, time
from pathlib import Path
page = os.sysconf("SC_PAGE_SIZE")
top = int(sys.argv[1])

def parent(entry):
    return int((entry / "stat").read_text().rpartition(")")[2].split()[1])

def resident(pid):
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * page

began = time.monotonic()
while Path(f"/proc/{top}").exists():
    total = 0
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and int(entry.name) != os.getpid():
                if int(entry.name) == top or parent(entry) == top:
                    total += resident(entry.name)
        except (OSError, ValueError, IndexError):
            pass
    print(f"{time.monotonic() - began:.1f} {total}", flush=True)
    time.sleep(0.5)
"""


def the_sweep(points: int) -> vc.Sweep:
    """So many poses about the middle of the workspace: three positions, two turns."""
    platform = vc.load("example:stewart")
    share = (points / 10_000_000) ** 0.2
    sizes = [max(2, round(n * share)) for n in (40, 40, 25, 25, 10)]
    ranges = {"x": (-0.3, 0.3), "y": (-0.3, 0.3), "z": (1.7, 2.3), "roll": (-0.25, 0.25), "yaw": (-0.3, 0.3)}
    over = {
        f"reference.{name}": np.linspace(*ends, size)
        for (name, ends), size in zip(ranges.items(), sizes, strict=True)
    }
    return vc.Sweep(platform, over, QUANTITIES)


def checked(sweep: vc.Sweep, result: vc.SweepData, count: int) -> float:
    """Largest relative difference at some points from what the reference path says there."""
    data = result.to_xarray()
    places = np.random.default_rng(0).integers(0, sweep.points.count, count)
    rows, _ = sweep.inputs.rows(sweep.points.at(places))
    largest = 0.0
    for place, row in zip(places, rows, strict=True):
        one = sweep.compiled.evaluate(row, QUANTITIES, given="reference", path="reference")
        at = np.unravel_index(place, sweep.points.shape)
        assert int(data["status"].values[at]) == int(one.status) == 0
        for name in QUANTITIES:
            stored = float(data.vincula.index(name)[at])
            largest = max(largest, abs(stored - float(one[name])) / abs(float(one[name])))
    return largest


def main() -> None:
    """Run, watch, check, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=10_000_000)
    parser.add_argument("--jobs", type=int, help="worker processes instead of threads")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--folder", help="where the data set goes; a temporary folder by default")
    parser.add_argument("--check", type=int, default=20, help="points computed again one by one")
    asked = parser.parse_args()
    began = time.perf_counter()
    sweep = the_sweep(asked.points)
    sweep.compiled.evaluate(sweep.inputs.rows(sweep.values(0)[:64])[0], QUANTITIES, given="reference")
    print(f"{sweep!r}; kernels loaded or compiled in {time.perf_counter() - began:.1f} s", flush=True)
    folder = Path(tempfile.mkdtemp(dir=asked.folder))
    watch = subprocess.Popen(
        [sys.executable, "-c", WATCH, str(os.getpid())], stdout=subprocess.PIPE, text=True
    )
    before, clock = _cpu(), time.perf_counter()
    result = sweep.run(folder / "poses.zarr", jobs=asked.jobs, threads=asked.threads)
    wall, cpu = time.perf_counter() - clock, _cpu() - before
    watch.kill()
    seen = [line.split() for line in watch.communicate()[0].splitlines()]
    memory = [int(size) / 2**20 for _, size in seen]
    status = result.status()
    stored = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    told = {
        "points": sweep.points.count,
        "chunks": sweep.chunking.count,
        "counts": {name: count for name, count in status.counts.items() if count},
        "wall_s": round(wall, 2),
        "cpu_s": round(cpu, 2),
        "us_per_point": round(wall / sweep.points.count * 1e6, 3),
        "cpu_us_per_point": round(cpu / sweep.points.count * 1e6, 3),
        "peak_mib": round(max(memory, default=0.0), 1),
        "mib_by_tenths": [round(memory[len(memory) * k // 10], 1) for k in range(10)] if memory else [],
        "stored_mib": round(stored / 2**20, 1),
        "largest_difference": checked(sweep, result, asked.check),
        "jobs": asked.jobs,
    }
    shutil.rmtree(folder)
    print(json.dumps(told, indent=2))
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps(told, indent=2))


def _cpu() -> float:
    """Processor seconds of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


if __name__ == "__main__":
    main()
