"""``stepbot view --edit``: what the page says, and where things are in it."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest

from stepbot.pipeline.scenes import ShownScene
from stepbot.serving.session import Session
from stepbot.serving.watching import follow

from .page import Page
from .test_edit import component, press

pytestmark = pytest.mark.slow


@pytest.fixture
def opened(edited: Callable[[str], Session], robot_library: Path) -> Session:
    """The four-bar linkage, open for editing."""
    return edited((robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8"))


@pytest.fixture
def followed(opened: Session) -> Iterator[tuple[Session, list[ShownScene]]]:
    """The same, with saves of other programs followed, and what was read."""
    ended = Event()
    heard: list[ShownScene] = []
    thread = Thread(target=follow, args=(opened, heard.append, ended))
    thread.start()
    yield opened, heard
    ended.set()
    thread.join(timeout=20)
    assert not thread.is_alive()


def test_saves_of_other_programs_are_shown(page: Page, followed: tuple[Session, list[ShownScene]]) -> None:
    """Saves of other programs are on the page, with errors or without; edits of the page are not read again."""
    session, heard = followed
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    press(page, "flip")
    page.wait("return stepbot.state.scene.connections.find(one => one.name === 'rocker_swing').axis[2] === 1")
    page.element("#undo").click()
    page.wait("return stepbot.state.scene.connections.find(one => one.name === 'rocker_swing').axis[2] === -1")
    page.wait("return !document.body.classList.contains('checking')")
    assert not heard
    text = session.target.read_text(encoding="utf-8")
    session.target.write_text(text.replace("links:", "lnks:"), encoding="utf-8")
    page.wait("return document.querySelector('#live').textContent.startsWith('errors')")
    session.target.write_text(text.replace("upper: 70 deg", "upper: 71 deg"), encoding="utf-8")
    page.wait("return document.querySelector('#live').textContent === 'live'")
    assert page.run("return stepbot.state.find({connection: 'rocker_swing'}).limits.upper") == pytest.approx(1.2391838)
    page.run("stepbot.state.select(null)")
    page.element("#redo").click()
    page.wait("return document.querySelector('#notice').textContent.includes('changed elsewhere')")
    assert page.element("#notice").is_displayed()


def settled_rect(page: Page) -> object:
    """Place and size of the card, once what it asks the server for has arrived."""
    page.wait("return stepbot.state.writtenOf === stepbot.state.scene")
    last = None
    while (now := page.element("#card").rect) != last:
        last = now
        time.sleep(0.5)
    return now


def test_messages(page: Page, opened: Session) -> None:
    """The page says that it edits; a refusal moves nothing in the card and does not stay on the next one."""
    page.wait("return document.querySelector('#hint').textContent.includes('edits the sidecar')")
    assert page.element("#hint").is_displayed()
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    assert not page.element("#hint").is_displayed()
    before = settled_rect(page)
    press(page, "remove")
    assert page.text("#notice").startswith(("checking", "'coupler_turn' needs"))  # an answer may be faster
    page.wait("return document.querySelector('#notice').className === 'bad'")
    assert "needs link 'crank'" in page.text("#notice")
    assert page.element("#card").rect == before
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    assert not page.element("#notice").is_displayed()


def test_a_new_scene_keeps_the_fields(page: Page, opened: Session) -> None:
    """A new scene does not replace a field, and keeps what is dragged or typed in it."""
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    page.run(
        "const bar = document.querySelector('#card [data-limit=upper]'); bar.id = 'dragged';"
        "bar.dispatchEvent(new PointerEvent('pointerdown', {bubbles: true}));"
        "bar.value = 33; bar.dispatchEvent(new Event('input'));"
    )
    page.run("stepbot.state.load(stepbot.state.scene)")
    assert page.run("return document.querySelector('#dragged').value") == "33"
    page.element("#card [data-edit=joint-name]").send_keys("x")
    page.run("stepbot.state.load(stepbot.state.scene)")
    assert page.run("return document.querySelector('#card [data-edit=joint-name]').value") == "rocker_swingx"


def test_the_list_of_parts(page: Page, opened: Session) -> None:
    """The list stays open when the card is closed, and can be searched; long names keep their ends."""
    page.tab("parts")
    page.run("stepbot.state.select({link: 'ground', component: arguments[0]})", component(page, "pillar"))
    shown = (
        "return [...document.querySelectorAll('#parts details[open] [data-component]')].map(o => o.dataset.component)"
    )
    before = page.run(shown)
    assert len(before) == 4
    page.element("#card .close").click()
    assert page.run(shown) == before
    page.element("#search").send_keys("PILLAR")
    assert page.run(shown) == [path for path in before if "pillar" in path]
    assert page.run("return document.querySelector('#parts [data-component]').title") == page.run(shown)[0]


def test_two_parts_have_their_subassemblies(page: Page, opened: Session) -> None:
    """With two parts picked, a subassembly of either can take its place."""
    page.run("stepbot.state.select({link: 'ground', component: arguments[0]})", component(page, "pillar"))
    page.run("stepbot.state.select({link: 'crank', component: arguments[0], add: true})", component(page, "crank"))
    page.element("#card [data-above=frame]").click()
    assert page.run("return stepbot.state.selection.picked") == ["frame", "crank"]


def test_zoom_to_the_pointer(page: Page, opened: Session) -> None:
    """What is under the pointer stays there when the wheel zooms."""
    at = page.pixel_of("rocker")
    script = (
        "const {view} = stepbot; const b = view.canvas.getBoundingClientRect();"
        "const p = view.camera.project(arguments[0]); return [b.left + p.x * b.width, b.top + p.y * b.height];"
    )
    plane = page.run(
        """const {view} = stepbot, {camera} = view, b = view.canvas.getBoundingClientRect();
        const ray = camera.ray((arguments[0] - b.left) / b.width, (arguments[1] - b.top) / b.height);
        const back = camera.axes().back, dot = (u, v) => u.reduce((sum, x, i) => sum + x * v[i], 0);
        const t = -camera.distance / dot(ray.direction, back);
        return ray.origin.map((x, i) => x + t * ray.direction[i]);""",
        *at,
    )
    before = page.run("return stepbot.view.camera.distance")
    page.run(
        "const [clientX, clientY] = arguments;"
        "stepbot.view.canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: -300, clientX, clientY}));",
        *at,
    )
    assert page.run("return stepbot.view.camera.distance") < 0.8 * before
    assert np.allclose(page.run(script, plane), at, atol=0.5)
