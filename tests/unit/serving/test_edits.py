"""What a page may ask an editor for."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.serving.edits import changes_of
from stepbot.serving.local_server import Refused
from stepbot.sidecar.document import Document
from stepbot.sidecar.editing import Append, CannotEdit, Put, Remove, edited
from stepbot.sidecar.load import parse_sidecar

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
def document() -> Document:
    """A sidecar."""
    sidecar = parse_sidecar(TEXT, Path("arm.robot.yaml"), Diagnostics())
    assert sidecar is not None
    return sidecar.document


def test_limits(document: Document) -> None:
    """Angles in degrees, lengths in millimetres; a placeholder is replaced as a whole."""
    question = {"action": "limits", "joint": "elbow", "lower": -0.5, "upper": 1.5707963267948966}
    assert changes_of(document, question) == [
        Put(("joints", "elbow", "limits", "lower"), "-28.648 deg"),
        Put(("joints", "elbow", "limits", "upper"), "90 deg"),
    ]
    question = {"action": "limits", "joint": "lift", "lower": 0, "upper": 0.1205}
    assert changes_of(document, question) == [Put(("joints", "lift", "limits"), {"lower": "0 mm", "upper": "120.5 mm"})]
    for lower, upper in ((1, 1), (2, 1), (float("nan"), 1), ("0", 1), (None, 1), (True, 2)):
        with pytest.raises(Refused):
            changes_of(document, {"action": "limits", "joint": "elbow", "lower": lower, "upper": upper})


def test_flip(document: Document) -> None:
    """An axis of the frame keeps its letter; another one is negated without minus zero."""
    assert changes_of(document, {"action": "flip", "joint": "elbow"}) == [Put(("joints", "elbow", "axis"), "-z")]
    (change,) = changes_of(document, {"action": "flip", "joint": "lift"})
    assert change == Put(("joints", "lift", "axis"), [0.0, -0.6, -0.8])
    assert "-0.0," not in edited(TEXT, [change])
    with pytest.raises(Refused, match="no joint 'wrist'"):
        changes_of(document, {"action": "flip", "joint": "wrist"})


def test_assign(document: Document) -> None:
    """A part leaves the list that names it; a link must not lose its last part."""
    question: dict[str, Any] = {"action": "assign", "paths": ["cover", "screw"], "link": "hand"}
    assert changes_of(document, question) == [
        Remove(("links", "forearm", "parts", 1)),
        Append(("links", "hand", "parts"), "cover"),
        Append(("links", "hand", "parts"), "screw"),
    ]
    with pytest.raises(Refused, match="no part left"):
        changes_of(document, {"action": "assign", "paths": ["hand"], "link": "base"})


def test_joints_come_and_go(document: Document) -> None:
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
    text = edited(TEXT, changes_of(document, question))
    assert "origin: {mate: [hand, jaw], radius: 8 mm}" in text
    sidecar = parse_sidecar(text, Path("arm.robot.yaml"), Diagnostics())
    assert sidecar is not None
    assert edited(text, changes_of(sidecar.document, {"action": "remove_joint", "joint": "grip"})) == TEXT
    with pytest.raises(Refused, match="'lift' needs link 'forearm'"):
        changes_of(document, {"action": "remove_joint", "joint": "elbow"})


_JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.floats(allow_nan=False)
    | st.sampled_from(["elbow", "lift", "base", "hand", "revolute", "cover", "a", "", "\n", "x: y"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["mate", "axis_of", "near"]), inner),
    max_leaves=5,
)
_KEYS = ("joint", "name", "kind", "parent", "child", "paths", "link", "origin", "lower", "upper")
_ACTIONS = ("limits", "flip", "assign", "add_joint", "add_closure", "remove_joint", "other")


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(_ACTIONS), st.dictionaries(st.sampled_from(_KEYS), _JSON))
def test_any_question_is_answered_or_refused(document: Document, action: str, question: dict[str, Any]) -> None:
    """Whatever a page sends is refused, or gives a sidecar that can be read."""
    try:
        text = edited(TEXT, changes_of(document, {**question, "action": action}))
    except (Refused, CannotEdit):
        return
    assert parse_sidecar(text, Path("arm.robot.yaml"), Diagnostics()) is not None
