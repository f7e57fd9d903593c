"""``stepbot watch``: a save is on the screen, errors keep the last good robot."""

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from stepbot.pipeline.scenes import ShownScene
from stepbot.serving.session import Session

from .page import Page

watching = pytest.importorskip("stepbot.serving.watching")
pytest.importorskip("watchfiles", reason="needs watchfiles: `pip install stepbot[view]`")


@pytest.fixture
def edited(session: Callable[[Path], Session], robot_library: Path, tmp_path: Path) -> Iterator[Session]:
    """A copy of the small arm, served and watched."""
    folder = tmp_path / "arm"
    shutil.copytree(robot_library / "stepbot_arm2", folder)
    served = session(folder / "arm2.robot.yaml")
    ended = Event()
    heard: list[ShownScene] = []
    thread = Thread(target=watching.watch, args=([served], lambda _, shown: heard.append(shown), ended))
    thread.start()
    yield served
    ended.set()
    thread.join(timeout=20)
    assert not thread.is_alive()


def save(path: Path, text: str) -> None:
    """Save as editors do: write beside, then replace."""
    beside = path.with_suffix(".tmp")
    beside.write_text(text, encoding="utf-8")
    beside.replace(path)


@pytest.mark.slow
def test_saves_errors_and_repairs(page: Page, edited: Session) -> None:
    """A save changes the limits of a slider in the open page, which keeps its position; errors keep the robot."""
    page.open(edited.server.url)
    sidecar = edited.target
    good = sidecar.read_text(encoding="utf-8")
    joint = page.run("return stepbot.state.scene.motion.driven[0].name")
    low, high = page.run("return stepbot.state.scene.motion.driven[0].range")
    page.run("stepbot.state.drive(...arguments)", joint, 0.25 * (low + high))
    position = page.positions()[joint]

    changed = re.sub(rf"(\n  {joint}:.*?upper: )[^,}}]+", r"\g<1>44 deg", good, count=1, flags=re.DOTALL)
    assert changed != good
    save(sidecar, changed)
    page.wait("return Math.abs(stepbot.state.scene.motion.driven[0].range[1] - 44 * Math.PI / 180) < 1e-9")
    assert page.positions()[joint] == pytest.approx(position)

    save(sidecar, good.replace("links:", "lnks:"))
    page.wait("return document.querySelector('#live').textContent.startsWith('errors')")
    page.tab("findings")
    assert "SB120" in page.text("#findings")
    assert page.positions()[joint] == pytest.approx(position)
    assert page.run("return stepbot.state.scene.connections.length") > 1

    save(sidecar, good)
    page.wait("return document.querySelector('#live').textContent === 'live'")
    page.wait("return Math.abs(stepbot.state.scene.motion.driven[0].range[1] - arguments[0]) < 1e-9", high)
    assert "SB120" not in page.text("#findings")
