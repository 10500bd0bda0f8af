"""XML as a tree that knows where every element stands."""

from __future__ import annotations

import pytest

import vincula as vc
from vincula.files.limits import Limits
from vincula.files.report import LoadReport
from vincula.files.source import decode
from vincula.files.xmltree import parse_xml

TEXT = """<?xml version="1.0"?>
<robot name="ä">
  <!-- <link name="none"/> -->
  <link name="a&amp;b"><visual/> some
    <origin xyz="0 0
 1"/>text </link><link/>
</robot>
"""


def test_places_paths_and_texts() -> None:
    root = parse_xml(decode(TEXT.encode(), "r.urdf"))
    link, last = root.find_all("link")
    origin = link.children[1]
    assert [e.tag for e in root.walk()] == ["robot", "link", "visual", "origin", "link"]
    assert (link.line, link.column, origin.line, origin.column) == (4, 3, 5, 5)
    assert (last.line, last.column) == (6, 18)
    assert origin.place.text() == "r.urdf:5:5: robot[@name='ä']/link[@name='a&b']/origin"
    assert link.text == "some\n    text"
    assert origin.attributes["xyz"] == "0 0  1"
    assert origin.parent is link
    assert root.parent is None


def test_columns_are_characters() -> None:
    root = parse_xml(decode('<a x="äöü€"><b/></a>'.encode(), "f.xml"))
    assert root.children[0].column == 13


def test_the_middle_of_a_long_path_is_left_out() -> None:
    names = [f"{'n' * 30}{k}" for k in range(12)]
    text = "".join(f'<body name="{n}">' for n in names) + "</body>" * len(names)
    element = list(parse_xml(decode(text.encode(), "f.xml")).walk())[-1]
    assert element.path.startswith(f"body[@name='{names[0]}']/.../")
    assert element.path.endswith(f"/body[@name='{names[-1]}']")
    assert len(element.path) < 200


def test_limits_are_those_given() -> None:
    source = decode(b"<a><b><c/></b></a>", "f.xml")
    assert parse_xml(source, Limits(depth=3, nodes=3)).tag == "a"
    with pytest.raises(vc.FileError, match=r"^f\.xml:1:7: elements are nested more than 2 deep"):
        parse_xml(source, Limits(depth=2))
    with pytest.raises(vc.FileError, match="more than 2 elements"):
        parse_xml(source, Limits(nodes=2))
    with pytest.raises(vc.FileError, match="18 bytes, at most 10"):
        parse_xml(source, Limits(xml_bytes=10))
    with pytest.raises(vc.FileError, match="took more than 0 s"):
        parse_xml(decode(b"<a>" + b"<b/>" * 2000 + b"</a>", "f.xml"), Limits(seconds=0.0))


def test_comments_with_hyphens_are_skipped_and_reported() -> None:
    text = "<a>\n<!-- x --- y\n-- --><b/><![CDATA[<!-- -- -->]]><!---->\n<!-- z --->é<c/></a>"
    report = LoadReport("f.xml", "XML")
    root = parse_xml(decode(text.encode(), "f.xml"), report=report)
    b, c = root.children
    assert (b.line, b.column, c.line, c.column) == (3, 7, 4, 13)
    assert root.text.split() == ["<!--", "--", "-->", "é"]
    assert report.counts()["comment"] == {"total": 2, "used": 0, "ignored": 0, "repaired": 2}
    assert [entry.detail.split(":")[0] for entry in report.entries] == ["line 2", "line 4"]


def test_an_unfinished_comment_is_refused_quickly() -> None:
    with pytest.raises(vc.FileError, match=r"f\.xml:1:11: not well-formed"):
        parse_xml(decode(b"<a>" + b"<!-- --" * 400_000, "f.xml"))
