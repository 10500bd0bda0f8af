"""Times of several peers in turns: a slow moment of the machine meets all of them."""

from __future__ import annotations

import math
import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Peer:
    """Something that can be timed.

    Attributes:
        run: One call.
        configurations: How many configurations it does.
    """

    run: Callable[[], object]
    configurations: int


def interleaved(peers: Mapping[str, Peer], rounds: int) -> dict[str, float]:
    """Median time of every peer, in turns [us a configuration]."""
    times: dict[str, list[float]] = {name: [] for name in peers}
    for peer in peers.values():
        peer.run()
    for _ in range(rounds):
        for name, peer in peers.items():
            start = time.perf_counter()
            peer.run()
            times[name].append(time.perf_counter() - start)
    return {name: 1e6 * statistics.median(times[name]) / peer.configurations for name, peer in peers.items()}


def exponent(sizes: Sequence[int], times: Sequence[float]) -> float:
    """Slope of a straight line through the logarithms: how cost grows with size."""
    x, y = [math.log(n) for n in sizes], [math.log(t) for t in times]
    return statistics.linear_regression(x, y).slope


def machine() -> dict[str, object]:
    """Processor and cores."""
    name = platform.processor() or platform.machine()
    facts = Path("/proc/cpuinfo")
    if facts.exists():
        for line in facts.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    return {"processor": name, "cores": os.cpu_count() or 1, "python": platform.python_version()}
