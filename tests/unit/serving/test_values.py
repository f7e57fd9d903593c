"""Any value of a sidecar set from the page, links merged and re-rooted, and what is left to decide."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import show_text
from stepbot.runtime.cache import Cache
from stepbot.serving.decisions import EditedSidecar, decisions, written
from stepbot.serving.edits import changes_of
from stepbot.serving.local_server import Refused
from stepbot.sidecar.editing import CannotEdit, edited
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import Sidecar

TEXT = """version: 1
robot: arm
step: arm.step
defaults: {density: todo, collision: hull}  # REVIEW: weigh one
# REVIEW: drawn with y up?
root: {up: y}
links:
  # which one it stands on: a note
  # REVIEW: which parts move as one here
  base: {rest: true}
  forearm: {parts: [forearm, cover]}  # two
  hand: {parts: [hand], collision: hull}
joints:
  # score 0.50: shapes
  # REVIEW: weak
  elbow: {type: revolute, parent: base, child: forearm, limits: todo}
  lift: {type: prismatic, parent: forearm, child: hand, limits: {lower: 0 mm, upper: 9 mm}}
frames:
  tip: {link: hand, origin: {xyz: [0, 0, 1]}}
"""


def parsed(text: str) -> Sidecar:
    """A sidecar without errors."""
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), diagnostics := Diagnostics())
    assert sidecar is not None, list(diagnostics)
    return sidecar


def after(former: str, **question: Any) -> str:
    """The text of a sidecar after an edit."""
    return edited(former, changes_of(parsed(former), question))


def put(text: str, keys: list[str | int], value: str) -> str:
    """The text of a sidecar with another value, as typed into a field."""
    return after(text, action="set", keys=keys, text=value)


@pytest.mark.parametrize(
    ("keys", "typed", "line"),
    [
        (["joints", "lift", "limits", "effort"], "12.5 N", "upper: 9 mm, effort: 12.5 N}}"),
        (["joints", "elbow", "limits", "velocity"], "60 rpm", "child: forearm, limits: {velocity: 60 rpm}}"),
        (["joints", "elbow", "dynamics", "damping"], "0.1 N*m*s/rad", "dynamics: {damping: 0.1 N*m*s/rad}}"),
        (
            ["joints", "lift", "mimic"],
            "{joint: elbow, multiplier: 3 mm/rad}",
            "mimic: {joint: elbow, multiplier: 3 mm/rad}}",
        ),
        (["parts", "**/M3*", "density"], "7.85 g/cm^3", '\nparts:\n  "**/M3*": {density: 7.85 g/cm^3}\n'),
        (["base"], "floating", "\nbase: floating\n"),
        (["excluded_contacts"], "[[base, hand]]", "\nexcluded_contacts: [[base, hand]]\n"),
        (
            ["links", "hand", "collision"],
            "{shape: hull, max_vertices: 32}",
            "collision: {shape: hull, max_vertices: 32}}",
        ),
        (["links", "hand", "collision"], "", "  hand: {parts: [hand]}\n"),
        (["ignore_findings"], "[SB512]", "\nignore_findings: [SB512]\n"),
    ],
)
def test_any_value_is_set_as_a_person_writes_it(keys: list[str | int], typed: str, line: str) -> None:
    """Units stay without quotes, a placeholder gives way to settings, comments and all other lines stay."""
    changed = put(TEXT, keys, typed)
    assert line in changed
    lines = changed.split("\n")
    assert sum(one not in lines for one in TEXT.split("\n")) <= 1


def test_a_value_that_answers_a_mark_of_the_draft_removes_it() -> None:
    """The density of `defaults` and the root's axis end their REVIEW comments; those of others stay."""
    changed = put(TEXT, ["defaults", "density"], "2700 kg/m^3")
    assert "defaults: {density: 2700 kg/m^3, collision: hull}\n" in changed
    assert "drawn with y up?" in changed
    changed = put(changed, ["root", "up"], "z")
    assert changed.count("REVIEW") == 2
    changed = after(changed, action="settle", keys=["links", "base"])
    assert "a note\n  base:" in changed
    assert "defaults" not in put(TEXT.replace(", collision: hull}  #", "}  #"), ["defaults", "density"], "")


@pytest.mark.parametrize(
    "question",
    [
        {"keys": ["joints", "a b", "type"], "text": "fixed"},
        {"keys": ["frames", "1st", "link"], "text": "hand"},
        {"keys": ["frames", "elbow", "link"], "text": "hand"},
        {"keys": ["base"], "text": "[1, 2"},
        {"keys": ["base"], "text": "a: b"},
        {"keys": ["base"], "text": "a\nrobot: b"},
        {"keys": ["base"], "text": "*alias"},
        {"keys": [], "text": "1"},
        {"keys": ["base", True], "text": "1"},
        {"keys": "base", "text": "1"},
        {"keys": ["base"], "text": "!!python/object:os.system x"},
    ],
)
def test_what_is_no_value_or_name_is_refused(question: dict[str, Any]) -> None:
    """Unportable and taken names, broken YAML, several lines, aliases and tags change nothing."""
    with pytest.raises((Refused, CannotEdit)):
        after(TEXT, action="set", **question)


def test_unportable_names_have_a_remedy() -> None:
    """A new name that ROS refuses is refused, with one that it accepts."""
    for name, other in (("my hand", "my_hand"), ("2nd", "link_2nd"), ("手", "part"), ("a/b", "a_b")):
        with pytest.raises(Refused, match=f"portable.*{other}"):
            after(TEXT, action="rename", what="link", **{"from": "hand", "to": name})


def test_merged_links() -> None:
    """A joint that does not move: parts, joints and frames of its child are the parent's; the last link can go."""
    changed = after(TEXT, action="merge", joint="lift")
    assert "  forearm: {parts: [forearm, cover, hand]}  # two\n" in changed
    assert "hand:" not in changed
    assert "tip: {link: forearm" in changed
    changed = after(TEXT, action="merge", joint="elbow")
    assert "lift: {type: prismatic, parent: base, child: hand" in changed
    assert "forearm" not in changed
    assert "score" not in changed


FOUR_BAR = "stepbot_four_bar"


@pytest.mark.slow
def test_another_root_moves_the_same(robot_library: Path, tmp_path: Path) -> None:
    """With another root a joint's axis in the world is opposite, about the same line, and its limits stay."""
    path = robot_library / FOUR_BAR / "four_bar.robot.yaml"
    text = path.read_text(encoding="utf-8")
    changed = after(text, action="root", link="crank")
    options = Options(output=tmp_path, cache=Cache(tmp_path / "cache"))
    before, now = (show_text(path, one, options) for one in (text, changed))
    assert before.robot is not None
    assert now.robot is not None, list(now.diagnostics)
    assert now.robot.links[0].name == "crank"
    ends = {joint.name: (joint.parent, joint.child, joint.limit) for joint in now.robot.joints}
    (turned,) = [joint for joint in before.robot.joints if joint.child == "crank"]
    assert ends[turned.name] == (turned.child, turned.parent, turned.limit)

    def world_axis(shown: Any) -> Any:
        assert shown.scene is not None
        (one,) = [one for one in shown.scene["connections"] if one["name"] == turned.name]
        return one["along"], one["at"]

    (was, at), (is_now, still) = world_axis(before), world_axis(now)
    assert at == still
    assert {was[0], is_now[0]} == {"+", "-"}
    assert was[1:] == is_now[1:]
    assert after(changed, action="root", link="ground").count("\n") == text.count("\n")


def test_what_is_left_to_decide() -> None:
    """Marks, placeholders and findings, the most decisive first; equal doubts are one with several places."""
    sidecar = parsed(TEXT)
    doubt = {"kind": "revolute", "closes": False, "doubt": "weak"}
    finding = {"code": "SB512", "severity": "warning", "message": "overlap", "file": "arm.robot.yaml", "line": 12}
    scene = {
        "connections": [{"name": "elbow", **doubt}, {"name": "wrist", **doubt}, {**doubt, "name": "lift", "doubt": ""}],
        "diagnostics": [{**finding, "help": []}, {**finding, "code": "SB407", "line": 16, "help": []}],
    }
    found = [(one["kind"], one["keys"]) for one in decisions(sidecar, scene)]
    assert found == [
        ("review", [["root"]]),
        ("review", [["links", "base"]]),
        ("axis", [["joints", "elbow"], ["joints", "wrist"]]),
        ("todo", [["joints", "elbow", "limits"]]),
        ("review", [["defaults"]]),
        ("finding", [["links", "hand"]]),
    ]
    shown = written(EditedSidecar(sidecar, sidecar.root), scene)
    assert [first for keys, first, _ in shown["places"] if keys == ["joints", "elbow"]] == [16]
    assert shown["data"]["joints"]["elbow"]["limits"] == "todo"


def test_friction_is_asked_last_and_with_the_other_marks_of_its_element() -> None:
    """A mark of friction decides least; one question has all marks of an element, which its answer settles."""
    hand = "  hand: {parts: [hand], collision: hull}\n"
    text = TEXT.replace(
        hand, "  hand:\n    parts: [hand]\n    contact: rubber-on-floor  # REVIEW: a tyre; friction 0.7\n"
    )
    found = decisions(parsed(text), {"connections": [], "diagnostics": []})
    assert (found[-1]["kind"], found[-1]["keys"]) == ("review", [["links", "hand"]])
    both = text.replace("  hand:\n", "  # REVIEW: which parts move as one\n  hand:\n", 1)
    asked = [one for one in decisions(parsed(both), {"connections": []}) if one["keys"] == [["links", "hand"]]]
    assert [one["text"] for one in asked] == ["which parts move as one; a tyre; friction 0.7"]
    assert asked[0]["rank"] < found[-1]["rank"]


ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-3, 9)
    | st.floats(allow_nan=False)
    | st.text(max_size=8)
    | st.sampled_from(["base", "hand", "elbow", "links", "joints", "limits", "todo", "[", "{a: 1}", "*x", "# x"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=8,
)
KEYS = st.lists(
    st.sampled_from(["links", "joints", "defaults", "base", "elbow", "parts", "limits", 0, "x"]), max_size=5
)


@pytest.mark.slow
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.fixed_dictionaries(
        {"action": st.sampled_from(["set", "append", "settle", "ignore", "merge", "root", "all"])},
        optional={
            "keys": KEYS | ANYTHING,
            "value": ANYTHING,
            "text": st.text(max_size=12) | ANYTHING,
            "code": ANYTHING,
            "joint": ANYTHING,
            "link": ANYTHING,
            "edits": st.lists(st.dictionaries(st.text(max_size=4), ANYTHING)),
        },
    )
)
def test_random_questions_change_the_sidecar_or_are_refused(question: dict[str, Any]) -> None:
    """Whatever a page asks for, the result is a sidecar, or a refusal."""
    try:
        changed = edited(TEXT, changes_of(parsed(TEXT), question))
    except (Refused, CannotEdit):
        return
    parsed(changed)
