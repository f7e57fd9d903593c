"""Whatever a page asks, it gets an answer or a refusal: no other error, and the sidecar stays one."""

import json
import shutil
import socket
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.scenes import ShownScene
from stepbot.runtime.cache import Cache
from stepbot.serving import editor
from stepbot.serving.local_server import Refused
from stepbot.serving.session import Session
from stepbot.sidecar.load import load_sidecar

pytestmark = pytest.mark.slow

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

    def passed(path: Path, text: str, options: Options) -> ShownScene:
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


def _request(random: Random, session: Session) -> bytes:
    """A request as a page, a broken page or another program may send it."""
    token = session.server.token if random.random() < 0.9 else random.choice(("", "x" * 32, "%00"))
    host = f"127.0.0.1:{session.server.port}" if random.random() < 0.9 else random.choice(("evil.example", "", "é"))
    question: dict[str, Any] = {
        random.choice(KEYS): random.choice((*WORDS, 1, -1.5, None, True, [], ["crank"], {"auto": True}))
        for _ in range(random.randrange(6))
    }
    if random.random() < 0.3:
        at = random.uniform(-1.5, 1.0)
        question = {"action": "limits", "joint": "crank_turn", "lower": at, "upper": at + 1.0}
    body = json.dumps(question).encode()
    if random.random() < 0.2:
        body = random.randbytes(random.randrange(80))
    length = str(len(body)) if random.random() < 0.9 else random.choice(("-1", "9" * 30, "x", str(len(body) + 5)))
    kind = random.choice(("application/json",) * 5 + ("text/plain",))
    path = random.choice(
        (*(f"ask/{name}" for name in NAMES), "ask/vocabulary", "ask/none", "scene", "", "files/a", "?")
    )
    method = "POST" if path.startswith("ask/") else random.choice(("GET", "HEAD", "PUT"))
    head = f"{method} /{token}/{path} HTTP/1.1\r\nHost: {host}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n"
    whole = head.encode() + b"Connection: close\r\n\r\n" + body
    return whole[: random.randrange(len(whole))] if random.random() < 0.1 else whole


@pytest.mark.parametrize("count", [300, pytest.param(10_000, marks=pytest.mark.long)])
def test_requests_leave_the_server_and_every_save_as_they_are(
    session: Session, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever arrives, no handler fails, what another program saves meanwhile stays, and nothing is left open."""
    random, faults, saved = Random(count), list[BaseException | None](), list[str]()
    server = session.server
    monkeypatch.setattr(server._http, "handle_error", lambda *about: faults.append(sys.exc_info()[1]))
    if not server._thread.is_alive():
        server.start()
    before = threading.active_count()
    files = Path("/proc/self/fd")
    opened = len(list(files.iterdir())) if files.is_dir() else 0
    for number in range(count):
        if number % 25 == 0:
            saved.append(f"# saved {count}.{number}")
            text = session.target.read_text(encoding="utf-8")
            session.target.write_text(f"{text}{saved[-1]}\n", encoding="utf-8")
        with socket.create_connection(("127.0.0.1", server.port), timeout=30.0) as connection:
            connection.sendall(_request(random, session))
            connection.shutdown(socket.SHUT_WR)
            if random.random() < 0.9:
                while connection.recv(1 << 16):
                    pass
    assert faults == []
    lines = session.target.read_text(encoding="utf-8").split("\n")
    assert [line for line in saved if line not in lines] == []
    assert load_sidecar(session.target, Diagnostics()) is not None
    end = time.monotonic() + 60.0
    while threading.active_count() > before and time.monotonic() < end:
        time.sleep(0.05)
    assert threading.active_count() <= before
    assert not files.is_dir() or len(list(files.iterdir())) <= opened
