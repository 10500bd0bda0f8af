"""The quicker scanner gives the events of ruamel.yaml: the same values, the same places, the same errors."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import pytest
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from tests.files.fuzzing.hunting import inputs
from tests.files.fuzzing.readers import reader

from vincula.files.yamlscanner import yaml_events

TRICKY = (
    "a: b c\nd: e:f\n", "a: [b c, d:e, f#g, h #i\n]", "{a: 1, b : 2, c:3, d}", "{a:1}",
    "[a: b]", "a:\n  b\n  c\n",
    "a: b\n c: d", "- a\n- b:\n- c: d\n", "word", "word:", "a: b: c", "? a\n: b",
    "{? a : b}", "a: .5e+3\n",
    "x: $l/2*(3-1)\n", "a: b#c\n", "a: b #c\n", "{a: b\n, c: d\n}", "{a\n: b}", "[a\n, b]",
    "a.b/c: 1", "a:\tb",
    "{a: 1,\n\tb: 2}", "a: 'b'\n", "[a]: b", "{[a, b]: c}", "a: |\n  b: c\n", "&x a: *x\n",
    "[a,b,c]", "{a: b}: c",
    "é: 1\n", "a: é\n", "---\na: 1\n...\n", "%YAML 1.2\n---\na: 1\n",
    "a: 1\na: 2\n", ("k" * 1030) + ": 1\n",
    "{" + "k" * 1030 + ": 1}", "a: b\n  - c\n", "a: [1,\n2]: 3\n",
)  # fmt: skip


def told(events: Iterator[Any]) -> list[str]:
    """Events with their places, ending in the error if there is one."""
    found = []
    try:
        for event in events:
            places = [(mark.line, mark.column, mark.index) for mark in (event.start_mark, event.end_mark)]
            found.append(f"{event} {places}")
    except (YAMLError, ValueError, IndexError, AttributeError, TypeError, AssertionError) as error:
        mark = error.problem_mark if isinstance(error, MarkedYAMLError) else None
        place = (mark.line, mark.column) if mark else None
        found.append(f"{type(error).__name__} {getattr(error, 'problem', error)} {place}")
    return found


@pytest.mark.parametrize("text", TRICKY)
def test_tricky_texts(text: str) -> None:
    assert told(yaml_events(text)) == told(YAML(typ="safe", pure=True).parse(text))


def test_files_and_damaged_files() -> None:
    whole = [seed.data for seed in reader("native-yaml").seeds]
    damaged = [data for data, _ in itertools.islice(inputs("native-yaml", 5), 250)]
    for data in (*whole, *damaged):
        text = data.decode("utf-8", "replace")
        if len(text) < 5_000:
            assert told(yaml_events(text)) == told(YAML(typ="safe", pure=True).parse(text)), text
