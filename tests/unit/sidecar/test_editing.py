"""Changes to single values in the text of a sidecar."""

import difflib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.sidecar.editing import Append, CannotEdit, Change, Put, Remove, edited
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.tree import plain_data

TEXT = """# A robot.
version: 1
robot: arm   # its name
step: arm.step

links:
  base: {rest: true}
  forearm: {parts: [forearm, "motor:1/horn"]}   # moves
  hand:
    parts:
      - "hand"   # palm
      - "finger"

# Every axis is found by itself.
joints:
  elbow: {type: revolute, parent: base, child: forearm, limits: {lower: -90 deg, upper: 90 deg}}
  wrist:
    type: revolute   # turns
    parent: forearm
    child: hand
    limits: todo
"""

ELBOW, FOREARM = (
    next(" " + line for line in TEXT.splitlines() if f"  {name}: {{" in line) for name in ("elbow", "forearm")
)


def values(text: str) -> object:
    """The values of a sidecar."""
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), diagnostics)
    assert sidecar is not None, list(diagnostics)
    return plain_data(sidecar.root)


def difference(new: str) -> list[str]:
    """Lines that were removed and added."""
    lines = difflib.ndiff(TEXT.splitlines(), new.splitlines())
    return [line for line in lines if line[0] in "+-"]


@pytest.mark.parametrize(
    ("change", "lines"),
    [
        (
            Put(("joints", "elbow", "limits", "upper"), "45 deg"),
            ["-" + ELBOW, "+" + ELBOW.replace("90 deg}", "45 deg}")],
        ),
        (
            Put(("joints", "wrist", "limits"), {"lower": "-10 deg", "upper": "20.5 deg"}),
            ["-     limits: todo", "+     limits: {lower: -10 deg, upper: 20.5 deg}"],
        ),
        (Put(("joints", "wrist", "axis"), "-z"), ["+     axis: -z"]),
        (
            Append(("links", "forearm", "parts"), "arm/cover: left"),
            ["-" + FOREARM, "+" + FOREARM.replace("]", ', "arm/cover: left"]')],
        ),
        (Append(("links", "hand", "parts"), "thumb"), ["+       - thumb"]),
        (Append(("links", "base", "parts"), "x"), ["-   base: {rest: true}", "+   base: {rest: true, parts: [x]}"]),
        (Put(("links", "jaw"), {"parts": ["moving side"]}), ["+   jaw: {parts: [moving side]}"]),
        (Remove(("links", "hand", "parts", 0)), ['-       - "hand"   # palm']),
        (Remove(("links", "forearm", "parts", 0)), ["-" + FOREARM, "+" + FOREARM.replace("[forearm, ", "[")]),
        (Remove(("joints", "wrist", "limits")), ["-     limits: todo"]),
        (Put(("defaults", "density"), "1240 kg/m^3"), ["+ defaults: {density: 1240 kg/m^3}"]),
    ],
)
def test_only_the_change_changes(change: Change, lines: list[str]) -> None:
    """Each change touches the lines that it must, and keeps comments, order and quotes of all others."""
    assert sorted(difference(edited(TEXT, [change]))) == sorted(lines)


def test_a_new_joint_is_below_the_others() -> None:
    """A new entry that is too long for a line has one line per key; the new section is at the end."""
    joint = {
        "type": "revolute",
        "parent": "hand",
        "child": "jaw",
        "origin": {"mate": ["hand/a very long name of a part", "jaw/b"]},
    }
    new = edited(TEXT, [Put(("links", "jaw"), {"parts": ["jaw"]}), Put(("joints", "jaw_joint"), joint)])
    assert (
        new.endswith(
            "    limits: todo\n  jaw_joint:\n    type: revolute\n    parent: hand\n    child: jaw\n"
            "    origin: {mate: [hand/a very long name of a part, jaw/b]}\n"
        )
        or "jaw_joint: {" in new
    )
    assert values(new)["joints"]["jaw_joint"] == joint  # type: ignore[index]
    assert new.index("jaw: {parts") < new.index("# Every axis")


def test_new_sections_are_in_the_order_of_the_keys() -> None:
    """Settings are in the head of the file, sections between the others, each with its comments kept below it."""
    text = TEXT + "  # wrist: {type: fixed}  # alternative, score 0.3\n"
    tool = Put(("frames", "tool"), {"link": "hand", "origin": "auto"})
    new = edited(text, [Put(("root", "up"), "y"), tool, Put(("base",), "floating")])
    assert "step: arm.step\nbase: floating\nroot: {up: y}\n\nlinks:\n" in new
    assert new.endswith("score 0.3\n\nframes:\n  tool: {link: hand, origin: auto}\n")
    loop = Put(("closures", "loop"), {"type": "ball", "link_a": "base", "link_b": "hand", "origin": "auto"})
    new = edited(new, [loop, Put(("joints", "grip"), {"type": "fixed", "parent": "base", "child": "hand"})])
    assert "score 0.3\n  grip: {type: fixed, parent: base, child: hand}\n\nclosures:\n  loop: {" in new
    assert new.endswith("origin: auto}\n\nframes:\n  tool: {link: hand, origin: auto}\n")


def test_a_list_that_becomes_empty_goes_with_its_key() -> None:
    """Removing the only item of a list, or the only entry of a mapping, removes the list."""
    text = TEXT.replace("[forearm, ", "[")
    new = edited(text, [Append(("links", "base", "parts"), "x"), Remove(("links", "forearm"))])
    assert "forearm: {parts" not in new
    with pytest.raises(CannotEdit, match=r"no links\.arm"):
        edited(TEXT, [Remove(("links", "arm"))])


def test_aliases_are_refused() -> None:
    """A value that an alias shares with another place would change there, too."""
    text = TEXT.replace("limits: {lower: -90 deg, upper: 90 deg}", "limits: &range {lower: -90 deg, upper: 90 deg}")
    text = text.replace("limits: todo", "limits: *range")
    with pytest.raises(CannotEdit, match="edit it in an editor"):
        edited(text, [Put(("joints", "wrist", "limits", "upper"), "1 deg")])


def test_text_without_a_line_end() -> None:
    """The last line need not end with a line feed."""
    assert edited(TEXT.rstrip("\n"), [Put(("joints", "wrist", "axis"), "-z")]).endswith("limits: todo\n    axis: -z\n")


@pytest.mark.slow
@settings(max_examples=25)
@given(st.lists(st.text(st.characters(exclude_categories=("C", "Zl", "Zp")), min_size=1, max_size=12), max_size=4))
def test_any_path_comes_back(paths: list[str]) -> None:
    """Whatever characters a path has, it is read back as it was written."""
    changes = [Append(("links", "hand", "parts"), path) for path in paths]
    changes += [Append(("links", "forearm", "parts"), path) for path in paths]
    new = values(edited(TEXT, changes))
    assert new["links"]["hand"]["parts"] == ["hand", "finger", *paths]  # type: ignore[index]
