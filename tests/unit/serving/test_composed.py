"""A sidecar that composes modules is edited in the page; elements of a module are edited in the module's file."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache
from stepbot.serving.local_server import Refused
from stepbot.serving.session import Session

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
MODULE = f"""<robot name="finger">
  <link name="palm">{INERTIAL}</link>
  <link name="tip">{INERTIAL}</link>
  <joint name="bend" type="revolute"><parent link="palm"/><child link="tip"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""
TEXT = """version: 1
robot: hand
modules:
  left: {file: finger.urdf}
  right: {mirror_of: left}
links:
  base: {inertial: {mass: 1 kg, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}}
joints:
  turn: {type: continuous, parent: base, child: left/palm}
  slide: {type: prismatic, parent: base, child: right/palm, limits: {lower: 0 mm, upper: 9 mm}}
"""


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    """The page's server of the hand, not started."""
    (tmp_path / "finger.urdf").write_text(MODULE, encoding="utf-8")
    sidecar = tmp_path / "hand.robot.yaml"
    sidecar.write_text(TEXT, encoding="utf-8")
    options = Options(output=tmp_path / "out", cache=Cache(tmp_path / "cache"))
    session = Session(sidecar, options, edits=True)
    try:
        shown = session.load()
        assert shown.robot is not None, list(shown.diagnostics)
        yield session
    finally:
        session.close()


@pytest.mark.parametrize(
    "question",
    [
        {"action": "limits", "joint": "left_bend", "lower": 0.0, "upper": 1.0},
        {"action": "set", "keys": ["joints", "right_bend", "limits", "upper"], "text": "0.5 rad"},
        {"action": "set", "keys": ["links", "right_tip", "collision"], "text": "hull"},
        {"action": "rename", "what": "link", "from": "left_tip", "to": "nail"},
        {"action": "all", "edits": [{"action": "merge", "joint": "left_bend"}]},
        {"action": "root", "link": "right_palm"},
    ],
)
def test_an_element_of_a_module_leads_to_its_file(session: Session, tmp_path: Path, question: dict[str, Any]) -> None:
    """Nothing is written; the message names the module and the command that edits its file, a mirrored one's too."""
    editor = session._editor
    assert editor is not None
    with pytest.raises(Refused, match=r"in module '(left|right)'.*`stepbot view --edit .*/finger\.urdf`"):
        editor.edit(question)
    assert session.target.read_text(encoding="utf-8") == TEXT


def test_own_elements_are_edited(session: Session) -> None:
    """Links and joints of the file change, also joints that a module is below; the page gets each module's links."""
    editor = session._editor
    assert editor is not None
    editor.edit({"action": "limits", "joint": "slide", "lower": 0.0, "upper": 0.012})
    editor.edit({"action": "rename", "what": "joint", "from": "turn", "to": "wrist"})
    assert session.target.read_text(encoding="utf-8") == TEXT.replace("9 mm", "12 mm").replace("turn:", "wrist:")
    modules = session._written(editor)["modules"]
    assert [(one["name"], list(one["links"])) for one in modules] == [
        ("left", ["left_palm", "left_tip"]),
        ("right", ["right_palm", "right_tip"]),
    ]
