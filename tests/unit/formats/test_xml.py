"""The XML that writers make, against lxml's serializer."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from stepbot.formats.xml import Element, Patterns, document, element, number, root, text_of

TEXT = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc", "Cn"), include_characters="\n\t\r&<>\"'{}"))
TREES: st.SearchStrategy[Any] = st.recursive(
    st.tuples(st.sampled_from("abc"), st.dictionaries(st.sampled_from("xyz"), TEXT), st.none() | TEXT),
    lambda below: st.tuples(
        st.sampled_from("abc"), st.dictionaries(st.sampled_from("xyz"), TEXT), st.lists(below, min_size=1, max_size=4)
    ),
)


def add_to_ours(parent: Element, tree: Any) -> None:
    """Add a tree to an element."""
    tag, attributes, content = tree
    child = element(parent, tag, content if isinstance(content, str) else None, **attributes)
    for one in content if isinstance(content, list) else ():
        add_to_ours(child, one)


def add_to_theirs(parent: Any, tree: Any) -> None:
    """Add the same tree to an element of lxml."""
    tag, attributes, content = tree
    child = etree.SubElement(parent, tag, attributes)
    child.text = content if isinstance(content, str) else None
    for one in content if isinstance(content, list) else ():
        add_to_theirs(child, one)


@pytest.mark.slow
@given(TREES)
def test_documents_are_those_of_lxml(tree: Any) -> None:
    """Elements, texts, attributes and indentation are written as lxml writes them."""
    ours, theirs = root("robot", ""), etree.Element("robot")
    add_to_ours(ours, tree)
    add_to_theirs(theirs, tree)
    head, remark, body = document(ours).split(b"\n", 2)
    assert (head, remark[:4]) == (b'<?xml version="1.0" encoding="UTF-8"?>', b"<!--")
    assert body == etree.tostring(theirs, encoding="UTF-8", pretty_print=True, xml_declaration=False)


def test_chains_of_any_depth() -> None:
    """A chain deeper than Python's recursion limit is written as lxml writes it."""
    ours, theirs = root("robot", ""), etree.Element("robot")
    at, there = ours, theirs
    for _ in range(2000):
        at, there = element(at, "body"), etree.SubElement(there, "body")
    assert document(ours).split(b"\n", 2)[2] == etree.tostring(theirs, pretty_print=True)


def test_namespaces() -> None:
    """Tags in a namespace have its prefix, which the root declares."""
    top = root("sdf", "", {"drake": "http://drake.mit.edu"}, version="1.9")
    element(top, "{http://drake.mit.edu}point", (1.0, 2.5))
    assert document(top).endswith(
        b'<sdf xmlns:drake="http://drake.mit.edu" version="1.9">\n  <drake:point>1 2.5</drake:point>\n</sdf>\n'
    )


@pytest.mark.parametrize("text", ["\x00", "a\x01b", "\x02", "\x1f", "\ufffe", "\ud800"])
def test_characters_that_xml_does_not_allow(text: str) -> None:
    """A text with a character that no XML document can contain is an error, in plain elements and in patterns."""
    top = root("robot", "")
    element(top, "link", name=text)
    with pytest.raises(ValueError, match=r"U\+"):
        document(top)
    top = root("robot", "")
    with pytest.raises(ValueError, match=r"U\+"):  # noqa: PT012
        Patterns().add(top, "key", _visual, text, (0.0,))
        document(top)


def test_patterns_write_what_their_elements_would() -> None:
    """Elements from a pattern have the bytes of elements made one by one, at any level, with any name."""
    plain, repeated = root("robot", ""), root("robot", "")
    patterns = Patterns()
    names = ["a", "<&>\"'", "{0} {}", "%s", "naïve\n"]
    for top, uses_patterns in ((plain, False), (repeated, True)):
        link = element(top, "link")
        for parent in (link, top):
            for i, name in enumerate(names):
                position = (0.1 * i, -0.0, 1e300)
                if uses_patterns:
                    patterns.add(parent, "key", _visual, name, position)
                else:
                    _visual(parent, name, position)
    assert document(repeated) == document(plain)


def _visual(parent: Element, name: str, position: str | Sequence[float]) -> Element:
    visual = element(parent, "visual", name=name)
    element(visual, "pose", f"{text_of(position)} 0 0 {{}} &")
    element(visual, "material", name=name)
    return visual


def test_numbers_are_the_shortest_that_read_back() -> None:
    """Numbers are written as Python's shortest repr, whole ones without a point, zero without a sign."""
    assert [number(value) for value in (1, 1.0, -0.0, 0.1, 1e22, 5e-324)] == ["1", "1", "0", "0.1", "1e+22", "5e-324"]
    with pytest.raises(ValueError, match="NaN"):
        number(float("nan"))
