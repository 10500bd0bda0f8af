"""Damages MJCF files at random and reads them: run in a process of its own, because MuJoCo might die.

Prints every exception that is not one of ours; called with the folder of the files and a count.
"""

from __future__ import annotations

import random
import re
import sys
import tempfile
from pathlib import Path

from vincula.errors import VinculaError
from vincula.files.mjcf import load_mjcf

WORDS = (
    "nan", "-1", "1e300", "1e-300", "0", "", "<", ">", "<body/>", "</body>", "inf", "false", "joint", "free",
    "ball", '<replicate count="3">', "1 2 3 4 5 6 7 8 9", "99999999999", '<include file="m.xml"/>', "name=",
    "&lt;", "é",
)  # fmt: skip


def damaged(text: str, chance: random.Random) -> str:
    """A text with one value, piece or line exchanged, lost or doubled."""
    kind = chance.randrange(4)
    if kind == 0:
        at = chance.randrange(len(text))
        return text[:at] + chance.choice(WORDS) + text[at:]
    if kind == 1:
        value = chance.choice(list(re.finditer(r'"[^"]*"', text)))
        other = re.sub('[<"]', "", chance.choice(WORDS))
        return f'{text[: value.start()]}"{other}"{text[value.end() :]}'
    lines = text.splitlines()
    at = chance.randrange(len(lines))
    if kind == 2:
        return "\n".join(lines[:at] + lines[at + 1 :])
    lines.insert(chance.randrange(len(lines)), lines[at])
    return "\n".join(lines)


def main(folder: str, count: int) -> None:
    chance = random.Random(7)
    texts = [path.read_text(encoding="utf-8") for path in sorted(Path(folder).glob("*.xml"))]
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "m.xml"
        for _ in range(count):
            path.write_text(damaged(chance.choice(texts), chance), encoding="utf-8")
            try:
                load_mjcf(path)
            except VinculaError:
                continue
            except Exception as error:  # noqa: BLE001  (every other kind is what is looked for)
                sys.stdout.write(f"{type(error).__name__}: {error}\n{path.read_text(encoding='utf-8')}\n")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
