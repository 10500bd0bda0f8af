"""Closing random mechanisms from 0.5 rad away, by hand: `python -m benchmarks.closure [count]`.

Mechanisms are planar and spatial, with one to four loops, closed as drawn; every joint value is moved
by up to 0.5 rad (m).  Half of them are closed freely, half with as many motors held at their drawn
values as the mechanism has freedoms.  Every answer is checked by the residuals of the mechanism, which
are computed apart from the solver.  Prints counts by reason.
"""

from __future__ import annotations

import sys
import time
from collections import Counter

import numpy as np
from tests.laws.random_closed import displaced, holdable_motors, random_closed

from vincula.errors import ClosureError
from vincula.mechanism.mechanism import Mechanism

FAR = 0.5
CLOSED = 1e-10


def outcome(number: int) -> tuple[str, str]:
    """Kind of the mechanism with a number, and what came of closing it."""
    rng = np.random.default_rng(number)
    planar, loops, held = number % 2 == 0, 1 + (number // 2) % 4, (number // 8) % 2 == 1
    mechanism = random_closed(rng, planar=planar, loops=loops)
    motors = holdable_motors(rng, mechanism) if held else {}
    start = displaced(rng, mechanism, FAR)
    kind = f"{'planar' if planar else 'spatial'}, {loops} loop{'s' if loops > 1 else ''}"
    return f"{kind}, {'motors held' if held else 'free'}", _closed(mechanism, start, motors)


def _closed(mechanism: Mechanism, start: dict[str, list[float]], motors: dict[str, float]) -> str:
    try:
        q = mechanism.close(start, motors=motors)
    except ClosureError as error:
        return "refused: lengths" if error.details.get("lengths") else "refused: not found"
    worst = max(r.gap for r in mechanism.residuals(dict(q)))
    if worst > CLOSED * mechanism.length:
        return "SILENTLY OPEN"
    if any(abs(float(q[name][0]) - value) > 0.0 for name, value in motors.items()):
        return "SILENTLY MOVED A MOTOR"
    return "closed" if q.attempts == 1 else "closed from a further start"


def main(count: int) -> None:
    """Run mechanisms 0 to count - 1 and print the table."""
    found: Counter[str] = Counter()
    by_kind: dict[str, Counter[str]] = {}
    began = time.perf_counter()
    for number in range(count):
        kind, what = outcome(number)
        found[what] += 1
        by_kind.setdefault(kind, Counter())[what] += 1
        if number % 500 == 499:
            print(f"{number + 1} in {time.perf_counter() - began:.0f} s: {dict(found)}", flush=True)
    for kind in sorted(by_kind):
        print(f"{kind:32s} {dict(by_kind[kind])}")
    closed = sum(n for what, n in found.items() if what.startswith("closed"))
    print(f"closed {closed} of {count} ({100.0 * closed / count:.2f} %): {dict(found)}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
