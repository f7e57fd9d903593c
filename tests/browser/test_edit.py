"""``stepbot view --edit``: every edit is a small, checked, undoable change of the sidecar."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.api import check
from stepbot.serving.session import Session

from .page import Page

pytestmark = pytest.mark.slow

BARE = """# Nothing but the parts.
version: 1
robot: four_bar
step: four_bar.step

defaults: {density: 2700 kg/m^3}
links:
  ground: {rest: true}   # everything so far
"""


def text_of(session: Session, cache: Path) -> str:
    """The sidecar on disk; it passes `check --step`."""
    result = check(session.target, open_step=True, cache=cache)
    assert not result.diagnostics.has_errors, list(result.diagnostics)
    return session.target.read_text(encoding="utf-8")


def press(page: Page, name: str) -> None:
    """Press a button of the card."""
    page.run("document.querySelector(`#card [data-edit='${arguments[0]}']`).click()", name)


def component(page: Page, name: str) -> str:
    """Path of the first component with a body whose path has a name in it."""
    script = "return stepbot.state.scene.components.find(one => one.has_body && one.path.includes(arguments[0])).path"
    return str(page.run(script, name))


def test_from_parts_to_a_mechanism(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """Two clicks and `joint here` make a joint that moves; the YAML has it, comments stay, undo takes it back."""
    session = edited(BARE)
    paths = {name: component(page, name) for name in ("ground bar", "crank")}
    page.click(page.pixel_of("ground", paths["ground bar"]))
    page.wait("return stepbot.state.selection?.component === arguments[0]", paths["ground bar"])
    page.click(page.pixel_of("ground", paths["crank"]), with_control=True)
    page.wait("return stepbot.state.selection?.picked?.length === 2")
    page.wait("return document.querySelector('#joint-form select[data-edit=origin]').value !== ''")
    page.run("document.querySelector('#joint-form [data-edit=name]').value = 'crank_turn'")
    page.run("document.querySelector('#joint-form [data-edit=child]').value = 'crank'")
    press(page, "add")
    page.wait("return stepbot.state.scene.connections.some(one => one.name === 'crank_turn')")
    text = text_of(session, cache)
    assert text.startswith(BARE.rstrip().removesuffix("  ground: {rest: true}   # everything so far"))
    assert "  ground: {rest: true}   # everything so far\n" in text
    assert "crank_turn:" in text
    assert "mate: [" in text
    page.slide("crank_turn", 45.0)
    assert page.positions()["crank_turn"] == pytest.approx(0.7853981633974483)
    assert page.text("#undo") == "Undo"
    page.element("#undo").click()
    page.wait("return stepbot.state.scene.connections.length === 0")
    assert text_of(session, cache) == BARE
    page.element("#redo").click()
    page.wait("return stepbot.state.scene.connections.length === 1")
    assert text_of(session, cache) == text


def flipped_text(good: str) -> str:
    """The four-bar's sidecar with the axis of its rocker turned round, and its limits with it."""
    found = good.replace("child: rocker, axis: -z,", "child: rocker, axis: z,")
    found = found.replace("lower: -15 deg, upper: 70 deg", "lower: -70 deg, upper: 15 deg")
    assert found.count("axis: z,") > good.count("axis: z,")
    return found


def test_axis_and_limits(page: Page, edited: Callable[[str], Session], robot_library: Path) -> None:
    """`flip axis` and the sliders of limits change their values alone; each is one step back."""
    good = (robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8")
    session = edited(good)
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    press(page, "flip")
    page.wait("return stepbot.state.scene.connections.find(one => one.name === 'rocker_swing').axis[2] === 1")
    flipped = flipped_text(good)
    assert session.target.read_text(encoding="utf-8") == flipped
    page.run(
        "const bar = document.querySelector('#card [data-limit=upper]'); bar.value = 75;"
        "bar.dispatchEvent(new Event('input')); bar.dispatchEvent(new Event('change'));"
    )
    page.until(lambda: session.target.read_text(encoding="utf-8") != flipped, "the limit is written")
    changed = flipped.replace("lower: -70 deg, upper: 15 deg", "lower: -70 deg, upper: 75 deg")
    assert session.target.read_text(encoding="utf-8") == changed
    for expected in (flipped, good):
        page.element("#undo").click()
        page.until(lambda expected=expected: session.target.read_text(encoding="utf-8") == expected, "undone")


def test_parts_to_links(page: Page, edited: Callable[[str], Session], robot_library: Path, cache: Path) -> None:
    """A part moves to another link, as the card shows; a new link gets a joint."""
    good = (robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8")
    session = edited(good)
    path = component(page, "pillar")
    former = page.run("return stepbot.state.scene.components.find(one => one.path === arguments[0]).link", path)
    target = "rocker"
    assert former != target
    page.run("stepbot.state.select({link: arguments[0], component: arguments[1]})", former, path)
    assert not page.element("#card [data-edit=new-link]").is_displayed()
    press(page, "assign")
    page.wait("return document.querySelector('#notice').textContent.includes('already')")
    page.run("document.querySelector('#card [data-edit=link]').value = arguments[0]", target)
    press(page, "assign")
    page.wait("return stepbot.state.selection.link === arguments[0]", target)
    page.wait("return document.querySelector('#notice').textContent.includes('saved')")
    card = page.text("#card")
    assert f"link\n{target}\n" in card
    assert "mass\n" in card
    assert page.run("return document.querySelector('#card [data-edit=link]').value") == target
    assert path in text_of(session, cache)
    page.run(
        "const link = document.querySelector('#card [data-edit=link]'); link.value = '';"
        "link.dispatchEvent(new Event('change'));"
    )
    page.element("#card [data-edit=new-link]").clear()
    page.element("#card [data-edit=new-link]").send_keys("post")
    press(page, "assign")
    page.wait("return stepbot.state.selection.connection === 'post_joint'")
    assert f'\n  post: {{parts: ["{path}"]}}\n' in text_of(session, cache)
    assert "\n  post_joint: {type: fixed, parent: rocker, child: post}\n" in text_of(session, cache)
    assert page.element("#card [data-edit=aim]").is_displayed()


def test_line_ends_and_other_editors(page: Page, edited: Callable[[str], Session], robot_library: Path) -> None:
    """Windows line ends stay; what another editor saved meanwhile is kept, and steps before it cannot be undone."""
    good = (robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8")
    session = edited(good.replace("\n", "\r\n"))
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    press(page, "flip")
    page.wait("return stepbot.state.scene.connections.find(one => one.name === 'rocker_swing').axis[2] === 1")
    expected = flipped_text(good).replace("\n", "\r\n").encode()
    assert session.target.read_bytes() == expected
    session.target.write_bytes(expected + b"# a note\r\n")
    page.element("#undo").click()
    page.wait("return document.querySelector('#notice').textContent.includes('changed elsewhere')")
    assert session.target.read_bytes() == expected + b"# a note\r\n"
    press(page, "flip")
    page.wait("return stepbot.state.scene.connections.find(one => one.name === 'rocker_swing').axis[2] === -1")
    assert session.target.read_bytes().endswith(b"# a note\r\n")
