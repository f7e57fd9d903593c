"""Canonical names of components, as documented."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepbot.step.structure.naming import NamedComponent, assign_paths, is_machine_made

Names = list[tuple[str, str]]


def paths(children: Names) -> list[str]:
    """Paths of siblings (product, occurrence) directly below the root."""
    components = [NamedComponent(-1, "root", ""), *(NamedComponent(0, *names) for names in children)]
    return [name.path for name in assign_paths(components)][1:]


@pytest.mark.parametrize(
    ("children", "expected"),
    [
        ([("plate", "plate:1"), ("bolt", "bolt:1")], ["plate", "bolt"]),
        ([("bolt", "bolt:1"), ("bolt", "bolt:2")], ["bolt:1", "bolt:2"]),
        ([("gusset", "NAUO6"), ("gusset", "NAUO7")], ["gusset#1", "gusset#2"]),
        ([("pin", "pin"), ("pin", "pin"), ("pin", "left")], ["pin#1", "pin#2", "left"]),
        ([("XL-430 v1", "XL-430 v1:1"), ("XL-430 v1", "XL-430 v1:2")], ["XL-430:1", "XL-430:2"]),
        ([("Robot v14", "")], ["Robot"]),
        ([("Holder v1 (1)", "Holder v1 (1):1")], ["Holder v1 (1)"]),
        ([("SOLID", "1")], ["body"]),
        ([("", ""), ("", "")], ["body#1", "body#2"]),
        ([("SOLID", "finger")], ["finger"]),
        ([("a/b", ""), ("x*y", ""), ("n#1", "")], [r"a\/b", r"x\*y", r"n\#1"]),
        ([("bolt", "x"), ("bolt", "x v3")], ["bolt#1", "bolt#2"]),
    ],
)
def test_siblings(children: Names, expected: list[str]) -> None:
    """The name is the product's, else a unique occurrence name given by a user, else the order in the file."""
    assert paths(children) == expected


def test_an_occurrence_named_like_a_sibling_does_not_serve() -> None:
    """An occurrence name equal to a sibling's name is not used."""
    assert paths([("bolt", "screw"), ("bolt", "left"), ("screw", "screw:1")]) == ["bolt#1", "left", "screw"]


def test_paths_go_down_from_below_the_root() -> None:
    """Segments are joined by slashes, the root is a dot, and equal names are numbered."""
    names = assign_paths(
        [
            NamedComponent(-1, "arm v3", ""),
            NamedComponent(0, "motor", "motor:1"),
            NamedComponent(1, "horn", "horn:1"),
            NamedComponent(0, "motor", "motor:2"),
            NamedComponent(3, "horn", "horn:1"),
        ]
    )
    assert [name.path for name in names] == [".", "motor:1", "motor:1/horn", "motor:2", "motor:2/horn"]
    assert [name.ordinal for name in names] == [1, 1, 1, 2, 1]
    assert not any(name.by_ordinal_only for name in names)


@pytest.mark.parametrize(
    "name", ["NAUO9", "12", "ID #71", "*DIT36", "=>[0:1:1:2]", "", " ", "SOLID", "Open CASCADE STEP translator 7.8 3.1"]
)
def test_machine_made(name: str) -> None:
    """Generated names are ignored."""
    assert is_machine_made(name)


@pytest.mark.parametrize("name", ["bolt:1", "left", "NAUO left", "M3x8", "-> Rod"])
def test_made_by_people(name: str) -> None:
    """Names given by users are kept."""
    assert not is_machine_made(name)


NAME = st.sampled_from(["", "SOLID", "a", "b", "a v1", "a:1", "a v2:1", "a/b", "x#1", "NAUO1", "7", "body", "body#1"])


@given(st.lists(st.tuples(NAME, NAME), max_size=8))
def test_paths_are_unique(children: Names) -> None:
    """For any names, siblings have distinct paths."""
    found = paths(children)
    assert len(set(found)) == len(found)
