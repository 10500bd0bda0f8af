"""YAML and JSON as trees: positions, digits, the core schema, and no surprise on any input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR, write

import vincula as vc
from vincula.files.jsontree import read_json
from vincula.files.source import decode
from vincula.files.tree import Document, TypedNumber
from vincula.files.yamltree import read_yaml


def yaml(text: str) -> Document:
    return read_yaml(decode(text.encode(), "f.yaml"))


def jsons(text: str) -> Document:
    return read_json(decode(text.encode(), "f.json"))


def test_core_schema_of_yaml_1_2() -> None:
    texts = ["yes", "off", "010", "0x10", "1_0", "1:30", ".inf", "2020-01-01"]
    found = yaml(f"[1, 1.5, 1e-5, true, False, ~, null, '1', {', '.join(texts)}]").plain()
    assert found == [1, 1.5, 1e-5, True, False, None, None, "1", *texts]
    assert yaml('["x\\n", "\\u00e9"]').plain() == ["x\n", "é"]


def test_places() -> None:
    document = yaml("a: 1\njoints:\n  - {name: o1, at: [1, 2]}\n  - at: [3,\n      4]\n")
    assert document.place(["joints", 0, "at", 1]).text() == "f.yaml:3:24: joints[o1]/at[1]"
    assert document.place(["joints", 1, "at", 1]).text() == "f.yaml:5:7: joints[1]/at[1]"
    assert document.place(["joints", 0, "axis"]).text() == "f.yaml:3:5: joints[o1]/axis"
    assert document.place(["joints", 0, "at"], at_key=True).text() == "f.yaml:3:16: joints[o1]/at"
    document = jsons('{"a": 1,\n "b": [true,\n  {"name": "n", "c": null}]}')
    assert document.place(["b", 1, "c"]).text() == "f.json:3:22: b[n]/c"


def test_typed_numbers_keep_their_digits() -> None:
    for document in (yaml("[1.5708, 0.7071e-2, 1.57]"), jsons("[1.5708, 0.7071e-2, 1.57]")):
        found = document.plain()
        assert all(isinstance(value, TypedNumber) for value in found)
        assert [value.half_unit for value in found] == pytest.approx([5e-5, 5e-7, 0.0])
        assert repr(found) == "[1.5708, 0.7071e-2, 1.57]"


def test_aliases_stand_for_what_they_name() -> None:
    assert yaml("a: &p [1, 2]\nb: *p\nc: &k key\n*k : 3\n").plain() == {
        "a": [1, 2],
        "b": [1, 2],
        "c": "key",
        "key": 3,
    }


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("{", "1:2"), ("[1,]", "1:4"), ('{"a" 1}', "1:6"), ("{'a': 1}", "1:2"), ("[1] 2", "1:5"),
        ("[NaN]", "1:2"), ("[-Infinity]", "1:2"), ("[01]", "1:2"), ("[+1]", "1:2"), ("[.5]", "1:2"),
        ('["\t"]', "1:2"), ('["\\x"]', "1:2"), ('["a', "1:2"), ("\n[1,\n 2 3]", "3:4"),
        ("[1 // one\n]", "1:4"), ("nul", "1:1"),
    ],
)  # fmt: skip
def test_json_is_strict(text: str, place: str) -> None:
    with pytest.raises(vc.FileError, match=f"^f.json:{place}: "):
        jsons(text)


values = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**12), 10**12)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cc", "Cs"]), max_size=8),
    lambda inner: st.lists(inner, max_size=4)
    | st.dictionaries(st.text(st.characters(exclude_categories=["Cc", "Cs"]), max_size=5), inner, max_size=4),
    max_leaves=20,
)  # fmt: skip


@given(values)
def test_json_reads_what_the_standard_library_writes(value: Any) -> None:
    for ascii_only in (True, False):
        assert jsons(json.dumps(value, ensure_ascii=ascii_only, indent=1)).plain() == value


@given(st.dictionaries(st.sampled_from("abc"), values, max_size=3))
def test_yaml_reads_json(value: Any) -> None:
    """JSON is a part of YAML; texts escaped, since YAML allows fewer characters as they are."""
    assert yaml(json.dumps(value)).plain() == value


def refused_or_read(path: Path) -> None:
    """Whatever the file holds, it is read or refused with an error of ours that can be printed."""
    message = ""
    try:
        vc.load(path)
    except vc.VinculaError as error:
        message = str(error).replace("\n", "")
    assert message.isprintable()


@given(st.binary(max_size=200))
def test_any_bytes(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.bin"
    path.write_bytes(data)
    refused_or_read(path)


@given(st.text(st.sampled_from("[]{}:,-? \n\t&*!|>'\"%@`#ab1.e\\$"), max_size=60))
def test_any_yaml_characters(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.yaml"
    path.write_text("vincula: 1\n" + text, encoding="utf-8")
    refused_or_read(path)


@settings(max_examples=300)
@given(st.data())
def test_damaged_files(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Good files with words cut out, doubled, swapped or replaced by what people and attackers type."""
    words = data.draw(st.sampled_from([FIVE_BAR, ALL_JOINTS])).replace(",", " , ").split(" ")
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(words) - 1))
        change = data.draw(st.sampled_from(["cut", "double", "swap", "replace"]))
        if change == "cut":
            del words[place]
        elif change == "double":
            words.insert(place, words[place])
        elif change == "swap":
            other = data.draw(st.integers(0, len(words) - 1))
            words[place], words[other] = words[other], words[place]
        else:
            strange = [
                "~",
                "0",
                "-1",
                "1e300",
                ".nan",
                "[]",
                "{}",
                "ground",
                "''",
                "$l",
                "$l/0",
                "true",
                "&a",
                "*a",
                "o1",
                "1e-320",
            ]
            words[place] = data.draw(st.sampled_from(strange))
    refused_or_read(write(tmp_path_factory.getbasetemp(), " ".join(words), "damaged.yaml"))


keys = st.sampled_from([
    "vincula", "space", "units", "bodies", "frames", "joints", "contacts", "closures", "couplings", "motors",
    "lock", "reference", "weights", "configuration", "keyframes", "precision", "notes", "parameters", "name",
    "base",
])  # fmt: skip


@settings(max_examples=200)
@given(st.dictionaries(keys, values, max_size=6))
def test_any_values_under_known_keys(
    tmp_path_factory: pytest.TempPathFactory, content: dict[str, Any]
) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.json"
    path.write_text(json.dumps({"vincula": 1, "space": "planar"} | content), encoding="utf-8")
    refused_or_read(path)
