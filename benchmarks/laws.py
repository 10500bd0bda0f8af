"""The laws of planted mechanisms on as many as one likes: 100 000 by hand, 0 failures expected.

python benchmarks/laws.py [--mechanisms 100000] [--start 0]
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.laws.planted_laws import broken_laws


def main() -> int:
    """Run and count; exit status 1 when a law is broken."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mechanisms", type=int, default=100_000)
    parser.add_argument("--start", type=int, default=0, help="first seed")
    options = parser.parse_args()
    failures, began = 0, time.perf_counter()
    for done, seed in enumerate(range(options.start, options.start + options.mechanisms), start=1):
        broken = broken_laws(seed)
        failures += bool(broken)
        for line in broken:
            print(line, flush=True)
        if done % 1000 == 0 or done == options.mechanisms:
            seconds = time.perf_counter() - began
            print(f"{done} mechanisms, {failures} failures, {seconds:.0f} s", file=sys.stderr, flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    raise SystemExit(main())
