"""What of an XML document is not read: everything that a vocabulary does not list."""

import pytest
from lxml import etree

from stepbot.engines.description.urdf_vocabulary import URDF
from stepbot.engines.description.vocabulary import Unread, Vocabulary

WORDS = Vocabulary(
    read={"a": "x", "a/b": "y", "a/plugin[known]": "file", "a/s": "", "a/s/*": "*", "a/same": ""},
    neutral={"a@z": ("0",), "a/n": ("false",)},
    effects={"y2": "it is slower", "lost": "it is heavier"},
    nests=("b",),
    holders={"frame": "pos"},
    kinds={"a/plugin": "file"},
    twins={"a/twin": "same"},
)


def unread(text: str) -> list[tuple[str, int, str]]:
    """What is not read of a text, how often, and with which consequence."""
    return [(one.what, one.count, one.effect) for one in WORDS.unread(etree.fromstring(text))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<a x='1'><b y='2'><b y='3'/></b></a>", []),
        ("<a><lost><deep/></lost><lost/></a>", [("<lost> in <a>", 2, "it is heavier")]),
        ("<a><b y2='1' y3='1'/><b y2='2'/></a>", [("attributes 'y2', 'y3' of <b>", 3, "it is slower")]),
        ("<a z='0'><n>false</n></a>", []),
        ("<a z='1'><n>true</n></a>", [("<n> in <a>", 1, ""), ("attribute 'z' of <a>", 1, "")]),
        ("<a><frame pos='1'><b y='1'/></frame></a>", []),
        ("<a><frame pos='1' w='2'/></a>", [("attribute 'w' of <frame>", 1, "")]),
        ("<a><plugin file='known'/><plugin file='other'/></a>", [("<plugin> in <a>", 1, "")]),
        ("<a><s><whatever any='1'/></s></a>", []),
        ("<a><same>1 2</same><twin>1  2</twin></a>", []),
        ("<a><same>1 2</same><twin>1 3</twin></a>", [("<twin> in <a>", 1, "")]),
        ("<a><!-- a comment --><?pi?></a>", []),
    ],
)
def test_what_is_not_listed_is_reported(text: str, expected: list[tuple[str, int, str]]) -> None:
    """Elements and attributes that are not listed, unless their value has no effect."""
    assert unread(text) == expected


def test_lines_are_those_of_the_first_occurrence() -> None:
    """A loss is reported where it first occurs, losses in the order of the document."""
    text = (
        "<robot name='r'>\n<link name='a'>\n<texture/>\n</link>\n<sensor/>\n<link name='b'>\n<texture/></link></robot>"
    )
    effect = "the visual has its plain colour"
    assert URDF.unread(etree.fromstring(text)) == (
        Unread("<texture> in <link>", 2, 3, "", effect),
        Unread("<sensor> in <robot>", 1, 5, "", ""),
    )
