"""Damaged files by the hundred thousand, by hand: `python -m benchmarks.fuzz [reader ...] --count 100000`.

Every reader gets damaged copies of the fixtures and of the shared models, changed in their bytes or in
their structure.  Whatever is not read must be refused by one of our errors, in printable words, within
5 s of computing and 256 MiB.  Anything else is written to the folder of `--out`: the smallest input that
shows it, and why.  MuJoCo's parser runs in a child process here as it does for users; a death of that
process is a refusal.  Files above VINCULA_FUZZ_LARGEST bytes (40000) are left out: small
ones are damaged many more times a minute.  Exit code 1 when something was found.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from tests.files.fuzzing.hunting import Tally, hunt
from tests.files.fuzzing.readers import READERS

_SHARE = 5_000


def share(name: str, count: int, seed: int, out: Path) -> tuple[str, Tally]:
    """One process's share of inputs; findings are saved as they come."""
    tally, saved = Tally(), 0
    for tally in hunt(name, count, seed):
        for finding in list(tally.findings.values())[saved:]:
            finding.save(out)
        saved = len(tally.findings)
    return name, tally


def main(arguments: list[str]) -> int:
    """Fuzz readers and print a line for each share."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("readers", nargs="*", default=[], help=f"of {', '.join(READERS)}; all by default")
    parser.add_argument("--count", type=int, default=100_000, help="inputs for each reader")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--out", type=Path, default=Path("build/fuzz"), help="folder for what is found")
    asked = parser.parse_args(arguments)
    names = asked.readers or list(READERS)
    unknown = sorted(set(names) - set(READERS))
    if unknown:
        parser.error(f"no reader is named {', '.join(unknown)}; readers: {', '.join(READERS)}")
    totals = {name: Tally() for name in names}
    began = time.perf_counter()
    with ProcessPoolExecutor(asked.jobs) as pool:
        waiting = [
            pool.submit(share, name, min(_SHARE, asked.count - at), asked.seed + at // _SHARE, asked.out)
            for name in names
            for at in range(0, asked.count, _SHARE)
        ]
        for done in as_completed(waiting):
            name, tally = done.result()
            total = totals[name]
            total.inputs, total.accepted = total.inputs + tally.inputs, total.accepted + tally.accepted
            total.slowest = max(total.slowest, tally.slowest)
            total.findings.update(tally.findings)
            found = f"; FOUND {', '.join(total.findings)}" if total.findings else ""
            print(
                f"{time.perf_counter() - began:6.0f} s  {name}: {total.inputs} inputs, "
                f"{total.accepted} read, slowest {total.slowest:.2f} s{found}",
                flush=True,
            )
    return 1 if any(total.findings for total in totals.values()) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
