"""Random damage to files: to their bytes, and to the structure of XML, YAML and JSON trees."""

from __future__ import annotations

import json
import random
import re
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import escape, quoteattr

NUMBERS = (
    "0", "-0", "-1", "1", "2", "0.5", "1e-5", "1e-200", "1e-320", "1e200", "1e308", "1e400", "-1e300", "nan",
    "inf", "-inf", ".nan", ".inf", "NaN", "Infinity", "010", "0x10", "1_000", "12:30:45", "1,5", "+.5", "1e",
    "1e999999999", "9" * 30, "9" * 500, "3.14159", "6.2831853", "360", "٣", "½", "１２", "1 2 3", "0 0 0",
    "1 0 0", "0 0 0 0", "1 2 3 4 5 6 7", "1 nan 0", "1e154 1e154 1e154", "1e-170 0 0", "true", "0.70710678",
)  # fmt: skip
"""Numbers, and what looks like some."""

WORDS = (
    "", " ", "\n", "\t", "world", "ground", "base", "__model__", "name", "fixed", "ball", "free", "floating",
    "universal", "screw", "planar", "revolute", "continuous", "prismatic", "spherical", "cylindrical",
    "gearbox",
    "hinge", "slide", "yes", "no", "null", "~", "true", "é", "a.b", "a.b.c", "j.1", "o1", "o1.x", "limits",
    "rate", "twist", "all", "all rows", "key:home", "../../../../etc/passwd", "file:///etc/passwd",
    "package://x/../../y", "http://example.org/a", "example:five-bar", "example:nothing", "<script>", "&amp;",
    "\u202eabc", "a\u0000b", "\ud800", "a" * 300, "é" * 70000, "$l", "$l/0", "sqrt(-1)", "pi", "-" * 2000,
    "(" * 300,
    "__import__('os')", "${x}", "xacro:macro", "!!python/object:os.system", "&a", "*a", "<<", "1.2.3",
    "6d", "3d",
    "SPHERICAL", "contact", "kept", "body", "mm", "deg", "spatial", "reciprocal",
)  # fmt: skip
"""Words that mean something in some file, and words that mean harm."""

TAGS = (
    "joint", "link", "loop", "loop_joint", "coupling", "mimic", "parent", "child", "axis", "limit",
    "origin", "pose",
    "frame", "model", "body", "site", "geom", "equality", "connect", "weld", "tendon", "fixed", "actuator",
    "motor",
    "default", "replicate", "include", "transmission", "gazebo", "constraint", "ros2_control", "drake:joint",
    "drake:ball_constraint", "axis2", "inertial", "freejoint", "composite", "attach", "compiler", "x:y",
    "zzz",
    "passive_joint", "screw_thread_pitch", "thread_pitch", "key", "general", "plugin", "world", "predecessor",
)  # fmt: skip
"""Tags of the formats, and strange ones."""

BYTES = (
    b"\x00", b"\xff", b"\xfe\xff", b"\xef\xbb\xbf", b"\x1b[31m", b"\r", b"\r\n", b"<", b">", b"</", b"/>",
    b"<!--",
    b"-->", b"<![CDATA[", b"]]>", b"<!DOCTYPE a [", b"<?xml version='1.1'?>", b"<?", b"&", b"&#0;",
    b"&#x110000;",
    b"&lt;", b"'", b'"', b"{", b"}", b"[", b"]", b": ", b", ", b"- ", b"? ", b"|\n", b">\n", b"&a ", b"*a",
    b"!!",
    b"%YAML 9.9\n---\n", b"---\n", b"...\n", b"#", b"\t", b"\\u0000", b"\\ud800", b'"\\x41"', b"\xc2\x85",
    b"\xe2\x80\xa8",
    b"@", b"`", b"[" * 70, b"{" * 70, b"- " * 70, b"<a>" * 70, b"(" * 70, b"9" * 500, b"=", b";",
    b"\xf0\x9f\xa6\xbe",
)  # fmt: skip
"""Pieces that mean something to a parser."""


def damaged_bytes(data: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    """A file with one to four random changes of bytes, pieces, words or lines."""
    for _ in range(chance.choice((1, 1, 1, 1, 2, 3))):
        data = chance.choice(_BYTE_CHANGES)(data, chance, others)
    return data


def _insert(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    at = chance.randint(0, len(data))
    return data[:at] + chance.choice(BYTES) + data[at:]


def _flip(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    if not data:
        return b"\x00"
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << chance.randrange(8))]) + data[at + 1 :]


def _cut(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    begin = chance.randint(0, len(data))
    return data[:begin] + data[min(len(data), begin + chance.choice((1, 2, 8, 40, 10**9))) :]


def _double(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    begin = chance.randint(0, len(data))
    piece = data[begin : begin + chance.choice((1, 5, 30, 200))]
    at = chance.randint(0, len(data))
    return data[:at] + piece * chance.choice((1, 1, 2, 20)) + data[at:]


def _splice(data: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    other = chance.choice(others)
    begin, at = chance.randint(0, len(other)), chance.randint(0, len(data))
    return data[:at] + other[begin : begin + chance.choice((10, 100, 1000))] + data[at:]


def _word(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    """One word or number exchanged for another of the file or of the lists above."""
    found = list(re.finditer(rb"[\w.+-]+", data))
    if not found:
        return data
    match = chance.choice(found)
    kinds: tuple[Any, ...] = (NUMBERS, WORDS, [chance.choice(found).group().decode("utf-8", "replace")])
    other = chance.choice(chance.choice(kinds)).encode("utf-8", "surrogatepass")
    return data[: match.start()] + other + data[match.end() :]


def _line(data: bytes, chance: random.Random, _others: list[bytes]) -> bytes:
    """One line lost, doubled or moved."""
    lines = data.split(b"\n")
    at = chance.randrange(len(lines))
    line = lines[at]
    if chance.random() < 0.6:
        del lines[at]
    if chance.random() < 0.6:
        lines.insert(chance.randint(0, len(lines)), line)
    return b"\n".join(lines)


_BYTE_CHANGES = (_insert, _flip, _cut, _double, _splice, _word, _word, _word, _line, _line)


def damaged_xml(text: str, chance: random.Random) -> str | None:
    """An XML file with one to three changes of elements and attributes; None where it is no XML."""
    try:
        root = ElementTree.fromstring(re.sub(r"<(/?)drake:", r"<\1drake__", text))
    except ElementTree.ParseError:
        return None
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        _change_element(root, chance)
    return _xml_text(root)


def _change_element(root: ElementTree.Element, chance: random.Random) -> None:
    elements = list(root.iter())
    element, other = chance.choice(elements), chance.choice(elements)
    parents = [e for e in elements if len(e)]
    around = chance.choice(parents) if parents else root
    kind = chance.randrange(9)
    if kind == 0 and len(around):
        around.remove(chance.choice(list(around)))
    elif kind == 1 and len(around):
        around.append(_copy(chance.choice(list(around))))
    elif kind == 2 and element is not other:
        element.attrib, other.attrib = other.attrib, element.attrib
    elif kind == 3:
        around.insert(chance.randint(0, len(around)), _copy(other))
    elif kind == 4:
        element.tag = chance.choice(TAGS).replace(":", "__")
    elif kind == 5 and element.text and element.text.strip():
        element.text = _value(elements, chance)
    elif kind == 6 and element.attrib:
        del element.attrib[chance.choice(list(element.attrib))]
    elif kind == 7:
        names = [name for e in elements for name in e.attrib] or ["name"]
        element.set(chance.choice(names), _value(elements, chance))
    elif element.attrib:
        element.set(chance.choice(list(element.attrib)), _value(elements, chance))


def _value(elements: list[ElementTree.Element], chance: random.Random) -> str:
    values = [value for e in elements for value in (*e.attrib.values(), (e.text or "").strip()) if value] or [
        "x"
    ]
    value = chance.choice(chance.choice((NUMBERS, WORDS, values)))
    if chance.random() < 0.3:
        numbers = chance.choice(values).split() or [""]
        numbers[chance.randrange(len(numbers))] = chance.choice(NUMBERS)
        value = " ".join(numbers)
    return value


def _copy(element: ElementTree.Element, most: int = 400) -> ElementTree.Element:
    copied = ElementTree.Element(element.tag, dict(element.attrib))
    copied.text = element.text
    if most > 0:
        copied.extend(_copy(child, most - len(element)) for child in element)
    return copied


def _xml_text(element: ElementTree.Element) -> str:
    """The element as text; names with a prefix are written as they were read, whatever is in them."""
    tag = str(element.tag).replace("drake__", "drake:").replace("__", ":")
    tag = re.sub(r"^\{[^}]*\}", "drake:", tag)
    words = "".join(f" {re.sub(r'^{[^}]*}', 'drake:', name)}={quoteattr(value)}"
                    for name, value in element.attrib.items())  # fmt: skip
    inside = escape(element.text or "") + "\n".join(_xml_text(child) for child in element)
    return f"<{tag}{words}>{inside}</{tag}>" if inside else f"<{tag}{words}/>"


def damaged_tree(tree: Any, chance: random.Random, *, as_json: bool) -> str:
    """A YAML or JSON file with one to three changes of keys, values and items."""
    tree = json.loads(json.dumps(tree))
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        _change_tree(tree, chance)
    return json.dumps(tree) if as_json else flow_text(tree)


def _change_tree(tree: Any, chance: random.Random) -> None:
    holders = list(_holders(tree))
    if not holders:
        return
    holder, other = chance.choice(holders), chance.choice(holders)
    keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
    if not keys:
        return
    key, kind = chance.choice(keys), chance.randrange(8)
    if kind == 0:
        del holder[key]
    elif kind == 1 and isinstance(holder, list):
        holder.insert(chance.randint(0, len(holder)), json.loads(json.dumps(holder[key])))
    elif kind == 2:
        leaves = [value for h in holders for value in (h.values() if isinstance(h, dict) else h)]
        holder[key] = json.loads(json.dumps(chance.choice(leaves)))
    elif kind == 3 and len(json.dumps(other)) < 10_000:
        holder[key] = json.loads(json.dumps(other))
    elif kind == 4 and isinstance(holder, dict):
        holder[chance.choice([*WORDS, *(k for h in holders if isinstance(h, dict) for k in h)])] = holder.pop(
            key
        )
    elif kind == 5:
        holder[key] = chance.choice((None, True, [], {}, [[]], {"a": {}}, [1, 2], [None], 0, -1, 10**400))
    else:
        holder[key] = Raw(chance.choice(chance.choice((NUMBERS, WORDS))))


class Raw(str):
    """A text that is written as it is, without quotes where YAML allows it."""

    __slots__ = ()


def _holders(tree: Any) -> Any:
    if isinstance(tree, dict | list):
        yield tree
        for value in list(tree.values() if isinstance(tree, dict) else tree):
            yield from _holders(value)


def flow_text(tree: Any, depth: int = 0) -> str:
    """A tree as YAML, blocks outside and flow style inside; `Raw` texts without quotes."""
    if isinstance(tree, dict):
        if depth == 0 and tree:
            return "\n".join(f"{_key(key)}: {flow_text(value, 1)}" for key, value in tree.items()) + "\n"
        return (
            "{"
            + ", ".join(f"{_key(key)}: {flow_text(value, depth + 1)}" for key, value in tree.items())
            + "}"
        )
    if isinstance(tree, list):
        return "[" + ", ".join(flow_text(value, depth + 1) for value in tree) + "]"
    return tree if isinstance(tree, Raw) else json.dumps(tree)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z_][\w.]*", key) else json.dumps(key)
