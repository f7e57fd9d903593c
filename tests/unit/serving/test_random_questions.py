"""Whatever a page asks, it gets an answer or a refusal: no other error, and the sidecar stays one."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import Shown
from stepbot.runtime.cache import Cache
from stepbot.serving import editor
from stepbot.serving.local_server import Refused
from stepbot.serving.session import Session
from stepbot.sidecar.load import load_sidecar

NAMES = ("face", "contacts", "edit", "undo", "redo", "between", "lines", "written")
KEYS = (
    "action", "joint", "link", "keys", "value", "text", "paths", "a", "b", "component", "triangle", "q", "origin",
    "lower", "upper", "kind", "name", "parent", "child", "from", "to", "what", "radius", "near", "code", "edits",
)  # fmt: skip
WORDS = (
    "set", "append", "settle", "ignore", "merge", "root", "all", "limits", "flip", "type", "origin", "confirm",
    "rename", "assign", "add_joint", "add_closure", "remove_joint", "crank", "ground", "crank_turn", "rocker_pin",
    "links", "joints", "revolute", "fixed", "mate", "axis_of", "auto", "xyz", "todo", "parts", "tip", "closures",
    "frame",
)  # fmt: skip
SIMPLE = st.none() | st.booleans() | st.integers(-2, 3) | st.floats() | st.sampled_from(WORDS) | st.text(max_size=5)
ANYTHING = st.recursive(
    SIMPLE,
    lambda one: st.lists(one, max_size=3) | st.dictionaries(st.sampled_from((*KEYS, *WORDS)), one, max_size=3),
    max_leaves=8,
)


@pytest.fixture(scope="module")
def session(robot_library: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    """The four-bar linkage, open for editing; what an edit gives is not built."""
    folder = tmp_path_factory.mktemp("asked")
    for name in ("four_bar.step", "four_bar.robot.yaml"):
        shutil.copy(robot_library / "stepbot_four_bar" / name, folder)
    session = Session(
        folder / "four_bar.robot.yaml", Options(folder / "out", cache=Cache(folder / "cache")), edits=True
    )
    shown = session.load()

    def passed(path: Path, text: str, options: Options) -> Shown:
        return shown

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(editor, "show_text", passed)
        yield session
    session.close()


@settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck))
@given(name=st.sampled_from(NAMES), question=st.dictionaries(st.sampled_from(KEYS), ANYTHING, max_size=7))
def test_every_question_is_answered_or_refused(session: Session, name: str, question: dict[str, Any]) -> None:
    """The errors that the server turns into status 400 are the only ones."""
    try:
        answer = session.server._answers[name](question)
    except (Refused, ValueError, OverflowError, RecursionError):
        return
    assert isinstance(answer, dict)
    assert load_sidecar(session.target, Diagnostics()) is not None
