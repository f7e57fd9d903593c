"""What a page may ask an editor for."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.robot.joint_types import JointKind
from stepbot.serving.edits import changes_of
from stepbot.serving.local_server import Refused
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.draft_comments import DraftedStop, drafted_reviews, drafted_stops
from stepbot.sidecar.editing import Append, CannotEdit, Put, Remove, edited
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import Sidecar

TEXT = """version: 1
robot: arm
step: arm.step
links:
  base: {rest: true}
  forearm: {parts: [forearm, cover]}
  hand: {parts: [hand]}
joints:
  elbow: {type: revolute, parent: base, child: forearm, limits: {lower: -90 deg, upper: 90 deg}}
  lift: {type: prismatic, parent: forearm, child: hand, axis: [0, 0.6, 0.8], limits: todo}
"""


@pytest.fixture(scope="module")
def sidecar() -> Sidecar:
    """A sidecar."""
    return parsed(TEXT)


def parsed(text: str) -> Sidecar:
    """A sidecar without errors."""
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), Diagnostics())
    assert sidecar is not None
    return sidecar


def after(text: str, **question: Any) -> str:
    """The text of a sidecar after an edit."""
    return edited(text, changes_of(parsed(text), question))


def test_limits(sidecar: Sidecar) -> None:
    """Angles in degrees, lengths in millimetres; a placeholder is replaced as a whole."""
    question = {"action": "limits", "joint": "elbow", "lower": -0.5, "upper": 1.5707963267948966}
    assert changes_of(sidecar, question) == [
        Put(("joints", "elbow", "limits", "lower"), "-28.648 deg"),
        Put(("joints", "elbow", "limits", "upper"), "90 deg"),
    ]
    question = {"action": "limits", "joint": "lift", "lower": 0, "upper": 0.1205}
    assert changes_of(sidecar, question) == [Put(("joints", "lift", "limits"), {"lower": "0 mm", "upper": "120.5 mm"})]
    for lower, upper in ((1, 1), (2, 1), (float("nan"), 1), ("0", 1), (None, 1), (True, 2)):
        with pytest.raises(Refused):
            changes_of(sidecar, {"action": "limits", "joint": "elbow", "lower": lower, "upper": upper})


def test_flip(sidecar: Sidecar) -> None:
    """An axis of the frame keeps its letter; another one is negated without minus zero."""
    assert changes_of(sidecar, {"action": "flip", "joint": "elbow"})[0] == Put(("joints", "elbow", "axis"), "-z")
    (change,) = changes_of(sidecar, {"action": "flip", "joint": "lift"})
    assert change == Put(("joints", "lift", "axis"), [0.0, -0.6, -0.8])
    assert "-0.0," not in edited(TEXT, [change])
    with pytest.raises(Refused, match="no joint 'wrist'"):
        changes_of(sidecar, {"action": "flip", "joint": "wrist"})


def test_flip_keeps_the_physical_range() -> None:
    """Limits and zero are mirrored as they are written, with their units; effort and a missing bound stay."""
    text = TEXT.replace("{lower: -90 deg, upper: 90 deg}", "{lower: -91 deg, upper: 1.5 rad, effort: 3}, zero: 2 deg")
    flipped = after(text, action="flip", joint="elbow")
    assert "limits: {lower: -1.5 rad, upper: 91 deg, effort: 3}, zero: -2 deg, axis: -z}" in flipped
    assert after(flipped, action="flip", joint="elbow") == text.replace("2 deg}", "2 deg, axis: z}")
    half = TEXT.replace("{lower: -90 deg, upper: 90 deg}", "{lower: -90 deg}")
    assert "limits: {upper: 90 deg}" in after(half, action="flip", joint="elbow")


def test_type() -> None:
    """Limits stay where they fit; otherwise they go, or a placeholder takes their place."""
    assert "elbow: {type: continuous, parent: base, child: forearm}" in after(
        TEXT, action="type", joint="elbow", kind="continuous"
    )
    assert "elbow: {type: prismatic, parent: base, child: forearm, limits: todo}" in after(
        TEXT, action="type", joint="elbow", kind="prismatic"
    )
    assert "lift: {type: fixed, parent: forearm, child: hand}" in after(TEXT, action="type", joint="lift", kind="fixed")
    assert after(TEXT, action="type", joint="lift", kind="prismatic") == TEXT
    strong = TEXT.replace("upper: 90 deg}", "upper: 90 deg, effort: 3}")
    assert "limits: {effort: 3}" in after(strong, action="type", joint="elbow", kind="continuous")
    with pytest.raises(Refused, match="`effort` of 'elbow' does not fit"):
        after(strong, action="type", joint="elbow", kind="prismatic")


def test_another_line() -> None:
    """The selectors of an origin are replaced, its parts and its offset stay."""
    text = TEXT.replace(
        "limits: todo", 'origin: {mate: ["a:1", b], radius: 3 mm, offset: {rpy: [0, 0, 1]}}, limits: todo'
    )
    near = after(text, action="origin", joint="lift", near=[0.001, 0.0, -0.0125])
    assert 'origin: {mate: ["a:1", b], offset: {rpy: [0, 0, 1]}, near: [1 mm, 0 mm, -12.5 mm]}' in near
    assert "origin: {auto: true, radius: 8 mm}" in after(TEXT, action="origin", joint="elbow", radius=0.008)
    given = TEXT.replace("limits: todo", "origin: {xyz: [0, 0, 1]}, limits: todo")
    with pytest.raises(Refused, match="not a line of faces"):
        after(given, action="origin", joint="lift", radius=0.008)


REFERENCES = """version: 1
robot: arm
step: arm.step
root: {link: base}
links:
  base: {rest: true}  # the base
  forearm: {parts: [forearm]}
  hand: {parts: [base, elbow]}
joint_defaults:
  elbow: {limits: {velocity: 1}}
joints:
  elbow: {type: revolute, parent: base, child: forearm, limits: {lower: -90 deg, upper: 90 deg}}
  wrist:
    type: continuous
    parent: forearm
    child: hand
    mimic: {joint: elbow}
    origin: {xyz: [0, 0, 1], relative_to: base}
closures:
  loop: {type: ball, link_a: hand, link_b: base, origin: {center: base}}
frames:
  tip: {link: base, origin: {xyz: [0, 0, 0], relative_to: base}}
actuators:
  motor: {joint: elbow}
sensors:
  encoder: {type: joint, joint: elbow}
  imu: {type: imu, link: base}
excluded_contacts: [[base, hand]]
"""


def test_names_and_all_references() -> None:
    """A new name of a joint or link is in every reference; parts, comments and order stay."""
    joint = after(REFERENCES, action="rename", what="joint", **{"from": "elbow", "to": "shoulder"})
    assert joint == REFERENCES.replace("elbow", "shoulder").replace("[base, shoulder]", "[base, elbow]")
    link = after(REFERENCES, action="rename", what="link", **{"from": "base", "to": "torso"})
    expected = REFERENCES.replace("base", "torso").replace("# the torso", "# the base")
    assert link == expected.replace("[torso, elbow]", "[base, elbow]").replace("{center: torso}", "{center: base}")
    for changed in (joint, link):
        diagnostics = Diagnostics()
        check_sidecar(parsed(changed), diagnostics)
        assert not diagnostics.has_errors, list(diagnostics)
    with pytest.raises(Refused, match="there is a joint 'wrist' already"):
        after(REFERENCES, action="rename", what="joint", **{"from": "elbow", "to": "wrist"})
    several = REFERENCES.replace("  elbow: {limits: {velocity: 1}}", '  "elb*": {limits: {velocity: 1}}')
    with pytest.raises(Refused, match="'elb\\*' would apply to only one"):
        after(several, action="rename", what="joint", **{"from": "elbow", "to": "shoulder"})
    assert "elbow_2:" in after(several, action="rename", what="joint", **{"from": "elbow", "to": "elbow_2"})


def test_names_of_other_kinds_are_taken() -> None:
    """A joint must not have the name of a link, nor a link that of a joint; a free name is proposed."""
    with pytest.raises(Refused, match="a joint and a link cannot have one name; try 'hand_joint'"):
        after(REFERENCES, action="rename", what="joint", **{"from": "elbow", "to": "hand"})
    with pytest.raises(Refused, match="a link and a joint cannot have one name; try 'wrist_link'"):
        after(REFERENCES, action="rename", what="link", **{"from": "base", "to": "wrist"})
    taken = REFERENCES.replace("  tip: {link", "  hand_joint: {link")
    joint = {"kind": "fixed", "parent": "base", "child": "jaw", "paths": ["jaw"]}
    with pytest.raises(Refused, match="try 'hand_joint_2'"):
        after(taken, action="add_joint", name="hand", **joint)
    with pytest.raises(Refused, match="a closure and a joint cannot have one name; try 'wrist_closure'"):
        after(REFERENCES, action="add_closure", name="wrist", kind="ball", parent="base", child="hand")


def test_a_removed_joint_takes_the_comments_of_the_draft() -> None:
    """The evidence, the REVIEW and the alternatives that `init` wrote go with a joint; comments of the user stay."""
    links = "  # REVIEW: which parts move as one here (score 0.40): a\n  jaw: {parts: [jaw]}\n"
    mine = "  # mine: keep\n"
    joint = (
        "  # score 0.95: output of the motor 'm'\n  # stop found by collision at 1 rad: 'a' and 'b'; a limit\n"
        "  #   may be closer\n  # REVIEW: could also be prismatic\n  grip:\n    type: continuous\n    parent: hand\n"
        "    child: jaw\n  # grip: {type: fixed, parent: hand, child: jaw}  # alternative, score 0.20: a\n"
    )
    text = TEXT.replace("joints:\n", f"{links}joints:\n") + mine + joint
    assert drafted_reviews(text) == {"grip": "could also be prismatic"}
    assert after(text, action="remove_joint", joint="grip") == TEXT + mine


STOPS = """version: 1
robot: arm
step: arm.step
links:
  base: {rest: true}
  hand: {parts: [hand]}
joints:
  # mine
  # score 0.95: output of the motor 'm'
  # stop found by collision at -3.9652 rad: 'base/a' and 'a long
  #   name/b'; a limit may be closer
  # stop found by collision at 0.7001 rad: 'c' and 'd'; a limit may be closer
  # stops: pairs of parts not compared, because of their many faces: 6
  # REVIEW: could also be
  #   prismatic
  turn:
    type: revolute
    parent: base
    child: hand
    origin: {mate: [base, hand]}
    limits: todo
"""


def test_stops_of_the_draft() -> None:
    """Positions and parts are read from the comments; they follow the axis: mirrored with it, gone with another one."""
    both = (DraftedStop(-3.9652, "'base/a' and 'a long name/b'"), DraftedStop(0.7001, "'c' and 'd'"))
    assert drafted_stops(STOPS) == {"turn": both}
    assert drafted_stops(STOPS.replace("0.7001 rad", "45 deg"))["turn"][1].position == pytest.approx(math.pi / 4)
    slide = STOPS.replace("0.7001 rad", "12.5 mm").replace("type: revolute", "type: prismatic")
    assert drafted_stops(slide)["turn"][1] == DraftedStop(0.0125, "'c' and 'd'")
    assert drafted_stops(STOPS.replace("0.7001 rad", "once rad"))["turn"] == both[:1]
    assert drafted_stops(STOPS.replace("score 0.95", "mine")) == {}
    flipped = after(STOPS, action="flip", joint="turn")
    mirrored = STOPS.replace("at -3.9652", "at 3.9652").replace("at 0.7001", "at -0.7001")
    assert flipped == mirrored.replace("limits: todo\n", "limits: todo\n    axis: -z\n")
    assert after(flipped, action="flip", joint="turn") == STOPS.replace("todo\n", "todo\n    axis: z\n")
    start, stop = STOPS.index("  # stop found"), STOPS.index("  # stops: ")
    without = STOPS[:start] + STOPS[stop:]
    other = after(STOPS, action="origin", joint="turn", radius=0.008)
    assert other == without.replace("[base, hand]}", "[base, hand], radius: 8 mm}")
    assert after(STOPS, action="type", joint="turn", kind="prismatic") == without.replace("revolute", "prismatic")
    assert drafted_stops(after(STOPS, action="type", joint="turn", kind="continuous")) == {"turn": both}


def test_an_axis_is_confirmed() -> None:
    """The selectors of the axis are written, and REVIEW comments go; stops, score and comments of the user stay."""
    start, stop = STOPS.index("  # REVIEW"), STOPS.index("  turn:")
    reviewed = STOPS[:start] + STOPS[stop:]
    assert after(STOPS, action="confirm", joint="turn") == reviewed
    text = after(STOPS, action="confirm", joint="turn", radius=0.008)
    assert text == reviewed.replace("[base, hand]}", "[base, hand], radius: 8 mm}")
    assert drafted_reviews(text) == {"turn": ""}
    assert after(text, action="confirm", joint="turn", near=[0, 0, 1]) == text


def test_assign(sidecar: Sidecar) -> None:
    """A part leaves the list that names it; a link must not lose its last part."""
    question: dict[str, Any] = {"action": "assign", "paths": ["cover", "screw"], "link": "hand"}
    assert changes_of(sidecar, question) == [
        Remove(("links", "forearm", "parts", 1)),
        Append(("links", "hand", "parts"), "cover"),
        Append(("links", "hand", "parts"), "screw"),
    ]
    with pytest.raises(Refused, match="no link 'palm'"):
        changes_of(sidecar, {"action": "assign", "paths": ["hand"], "link": "palm"})
    with pytest.raises(Refused, match="no part left"):
        changes_of(sidecar, {"action": "assign", "paths": ["hand"], "link": "base"})


def test_joints_come_and_go(sidecar: Sidecar) -> None:
    """A joint with a new link; the last of a chain can be removed with its link, one in the middle cannot."""
    question = {
        "action": "add_joint",
        "name": "grip",
        "kind": "revolute",
        "parent": "hand",
        "child": "jaw",
        "paths": ["jaw"],
        "origin": {"mate": ["hand", "jaw"], "radius": 0.008, "near": None},
        "lower": 0.0,
        "upper": 1.0,
    }
    text = edited(TEXT, changes_of(sidecar, question))
    assert "origin: {mate: [hand, jaw], radius: 8 mm}" in text
    assert after(text, action="remove_joint", joint="grip") == TEXT
    with pytest.raises(Refused, match="'lift' needs link 'forearm'"):
        changes_of(sidecar, {"action": "remove_joint", "joint": "elbow"})


def test_a_type_comes_with_what_it_needs(sidecar: Sidecar) -> None:
    """A screw gets its pitch and a universal joint its second axis with the type, and other types lose them."""
    screw = after(TEXT, action="type", joint="lift", kind="screw", needed="2 mm/rev")
    joint = parsed(screw).document.joints["lift"]
    assert (joint.type, joint.pitch) == (JointKind.SCREW, pytest.approx(2e-3 / math.tau))
    assert "limits" not in screw.split("lift")[1]
    universal = after(screw, action="type", joint="lift", kind="universal", needed="[1, 0, 0]")
    joint = parsed(universal).document.joints["lift"]
    assert (joint.type, joint.pitch, joint.axis2) == (JointKind.UNIVERSAL, None, (1.0, 0.0, 0.0))
    assert after(universal, action="type", joint="lift", kind="prismatic") == TEXT
    made = {"parent": "hand", "child": "jaw", "paths": ["jaw"], "kind": "screw"}
    added = parsed(after(TEXT, action="add_joint", name="nut", needed="-1 mm/rev", **made)).document.joints["nut"]
    assert added.pitch == pytest.approx(-1e-3 / math.tau)
    for needed in (None, " "):
        with pytest.raises(Refused, match="a screw joint needs `pitch`"):
            changes_of(sidecar, {"action": "type", "joint": "lift", "kind": "screw", "needed": needed})
    with pytest.raises(Refused, match="no joint type 'hinge'"):
        changes_of(sidecar, {"action": "type", "joint": "lift", "kind": "hinge"})


_JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.floats(allow_nan=False)
    | st.sampled_from(["elbow", "lift", "base", "hand", "revolute", "cover", "a", "", "\n", "x: y"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["mate", "axis_of", "near"]), inner),
    max_leaves=5,
)
_KEYS = (
    "joint",
    "what",
    "from",
    "to",
    "radius",
    "near",
    "name",
    "kind",
    "needed",
    "parent",
    "child",
    "paths",
    "link",
    "origin",
    "lower",
    "upper",
)
_ACTIONS = (
    "limits",
    "flip",
    "type",
    "origin",
    "confirm",
    "rename",
    "assign",
    "add_joint",
    "add_closure",
    "remove_joint",
    "other",
)


@pytest.mark.slow
@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(_ACTIONS), st.dictionaries(st.sampled_from(_KEYS), _JSON))
def test_any_question_is_answered_or_refused(sidecar: Sidecar, action: str, question: dict[str, Any]) -> None:
    """Whatever a page sends is refused, or gives a sidecar that can be read."""
    try:
        text = edited(TEXT, changes_of(sidecar, {**question, "action": action}))
    except (Refused, CannotEdit):
        return
    assert parse_sidecar(text, Path("arm.robot.yaml"), Diagnostics()) is not None
