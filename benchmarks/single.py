"""One configuration: time of linearising and analysing the Stewart platform, and of starting up.

    python benchmarks/single.py [--repeats 200]

Prints medians with their quartiles, each beside its yardstick (numpy's import time for start-up), and
the machine.  Nothing here is a test: a busy machine gives other numbers, ratios are what to compare.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import vincula as vc

FIVE = (
    vc.kinematic_ellipsoid,
    vc.active_force_ellipsoid,
    vc.passive_force_ellipsoid,
    vc.internal_force_ellipsoid,
    vc.dual_force_ellipsoid,
)


def measured(work: Callable[[], object], repeats: int) -> tuple[float, float, float]:
    """Lower quartile, median and upper quartile of `repeats` runs after three warm ones [s]."""
    for _ in range(3):
        work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    low, middle, high = statistics.quantiles(times, n=4)
    return low, middle, high


def process(code: list[str], repeats: int) -> tuple[float, float, float]:
    """The same for a whole process."""
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    return measured(lambda: subprocess.run(code, check=True, capture_output=True, env=environment), repeats)


def line(what: str, times: tuple[float, float, float], unit: float, name: str, note: str = "") -> None:
    """One printed row."""
    low, middle, high = (t / unit for t in times)
    print(f"{what:58} {middle:9.1f} {name:3} ({low:.1f} - {high:.1f})  {note}")


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=200)
    repeats = parser.parse_args().repeats
    processor = platform.processor() or platform.machine()
    print(f"{processor}, {os.cpu_count()} cores, Python {platform.python_version()}")

    platform_ = vc.load("example:stewart")
    model = platform_.linearize()

    def everything() -> None:
        fresh = platform_.linearize()
        _ = fresh.ledger.counts
        for ellipsoid in FIVE:
            ellipsoid(fresh)

    def kinematic() -> None:
        object.__getattribute__(model, "__dict__").pop("ledger", None)
        vc.kinematic_ellipsoid(model)

    line("Stewart: linearize", measured(platform_.linearize, repeats), 1e-6, "us")
    line(
        "Stewart: linearize + ledger + five ellipsoids", measured(everything, repeats), 1e-6, "us", "aim 3000"
    )
    line(
        "Stewart: kinematic ellipsoid of a linear model", measured(kinematic, repeats), 1e-6, "us", "aim 300"
    )

    runs = max(5, repeats // 20)
    python = sys.executable
    bare = process([python, "-c", "pass"], runs)
    numpy = process([python, "-c", "import numpy"], runs)
    ours = process([python, "-c", "import numpy, vincula"], runs)
    command = str(Path(python).with_name("vincula"))
    analyze = process([command, "analyze", "example:five-bar"], runs)
    analyze_json = process([command, "analyze", "example:five-bar", "--json"], runs)
    line("process: python", bare, 1e-3, "ms")
    line("process: import numpy", numpy, 1e-3, "ms")
    line("process: import numpy, vincula", ours, 1e-3, "ms", f"+{1e3 * (ours[1] - numpy[1]):.0f} ms, aim +60")
    net = numpy[1]
    line(
        "process: vincula analyze example:five-bar",
        analyze,
        1e-3,
        "ms",
        f"{analyze[1] / net:.1f} x numpy, aim 8",
    )
    line("process: the same with --json", analyze_json, 1e-3, "ms", f"{analyze_json[1] / net:.1f} x numpy")


if __name__ == "__main__":
    main()
