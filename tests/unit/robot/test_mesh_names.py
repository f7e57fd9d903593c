"""Mesh names are valid file names, unique, and readable."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.robot.mesh_names import UniqueNames, ascii_name


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Simple Base", "Simple_Base"),
        ("XL,XC-330", "XL_XC-330"),
        ("Gehäuse Größe 3", "Gehause_Grosse_3"),
        ("Корпус", "Korpus"),
        ("Щит ёж", "Shchit_ezh"),
        ("手臂", "part"),
        ("", "part"),
        ("../../etc/passwd", "etc_passwd"),
        ("con", "con_part"),
        ("LPT1", "LPT1_part"),
        ("a" * 200, "a" * 60),
        ("½ inch", "1_2_inch"),
    ],
)
def test_names_read_like_their_source(name: str, expected: str) -> None:
    """Accents are dropped, Cyrillic is transliterated, other characters become underscores; no Windows devices."""
    assert ascii_name(name) == expected


@given(st.text(max_size=100))
def test_any_text_gives_a_valid_name(text: str) -> None:
    """The name for any CAD name has letters, digits, underscores and hyphens only."""
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", ascii_name(text))


def test_unique_whatever_the_case() -> None:
    """Names that differ only in case are numbered."""
    names = UniqueNames()
    assert [names.unique(name) for name in ("Bolt", "bolt", "bolt_2", "BOLT")] == [
        "Bolt",
        "bolt_2",
        "bolt_2_2",
        "BOLT_3",
    ]
