"""``stepbot view --edit``: the list of what is left to decide, and a field for every key of the sidecar."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.serving.session import Session

from .page import Page
from .test_edit import press, text_of
from .test_edit_joints import PARTS_OF_THE_ROOT
from .test_edit_panel import TAB, settled

pytestmark = pytest.mark.slow

UNDECIDED = PARTS_OF_THE_ROOT.replace("{density: 2700 kg/m^3}", "{density: todo}  # REVIEW: weigh one")


def typed(page: Page, place: str, text: str, keys: str) -> None:
    """Type a value into the field of its keys, in a part of the page."""
    page.wait("return document.querySelector(`${arguments[0]} [data-set='${arguments[1]}']`)", place, keys)
    page.run(
        "let at = document.querySelector(`${arguments[0]} [data-set='${arguments[1]}']`);"
        "for (; at; at = at.parentElement) if (at.tagName === 'DETAILS') at.open = true;",
        place,
        keys,
    )
    page.element(f"{place} [data-set='{keys}']").send_keys(text + TAB)  # Enter would add an unfinished element
    settled(page)


def test_what_is_left_to_decide(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """The list leads to each place; answers take it off the list, and the sidecar has no mark left."""
    session = edited(UNDECIDED)
    page.wait("return document.querySelectorAll('#todo .decision').length === 2")
    assert page.text("#todo .progress") == "0 of 2 decided"
    page.element("#todo [data-kind=axis] .place").click()
    assert page.text("#card h2") == "crank_turn"
    page.element("#todo [data-kind=axis] [data-decide=other]").click()
    assert page.run("return document.activeElement === document.querySelector('#card [data-edit=type]')")
    page.element("#todo [data-kind=axis] [data-decide=right]").click()
    page.wait("return document.querySelectorAll('#todo .decision').length === 1")
    assert page.text("#todo .progress") == "1 of 2 decided"
    offered = page.run(
        "return [...document.querySelector('#todo [data-kind=review] datalist').options].map(o => o.label)"
    )
    assert "steel" in offered
    typed(page, "#todo", "7850 kg/m^3", "defaults.density")
    page.wait("return document.querySelector('#todo .progress').textContent.includes('Nothing is left')")
    assert "defaults: {density: 7850 kg/m^3}\n" in text_of(session, cache)
    assert "REVIEW" not in session.target.read_text(encoding="utf-8")


def test_every_key_has_a_field(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A joint, its actuator and the robot have fields made from the schema, with the lines of the file."""
    session = edited(UNDECIDED)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    typed(page, "#card", "3 N*m", "joints.crank_turn.limits.effort")
    assert "limits: {lower: -91 deg, upper: 89 deg, effort: 3 N*m}" in text_of(session, cache)
    page.wait("return document.querySelector('#card .yaml').textContent.includes('effort: 3 N*m')")
    typed(page, "#card", "auto", "actuators..gains")
    page.run(
        "document.querySelector(\"#card [data-set='actuators..kind']\").value = 'position';"
        "document.querySelector('#card [data-add=actuators]').click()"
    )
    settled(page)
    assert page.text("#notice").startswith("saved")
    page.wait("return document.querySelector('#card [data-sheet=\"actuators.crank_turn\"]')")
    assert "\nactuators:\n  crank_turn: {joint: crank_turn, kind: position, gains: auto}\n" in text_of(session, cache)
    before = session.target.read_text(encoding="utf-8")
    typed(page, "#card", "-3 N", "joints.crank_turn.limits.velocity")
    page.wait("return document.querySelector('#notice').className === 'bad'")
    assert "velocity" in page.text("#notice")
    assert session.target.read_text(encoding="utf-8") == before
    page.tab("robot")
    page.run(
        "const base = document.querySelector(\"#robot [data-set='base']\"); base.value = 'floating';"
        "base.dispatchEvent(new Event('input')); base.dispatchEvent(new Event('change'));"
    )
    page.until(lambda: "\nbase: floating\n" in session.target.read_text(encoding="utf-8"), "the base floats")
    settled(page)
    page.element("#undo").click()
    page.until(lambda: session.target.read_text(encoding="utf-8") == before, "undone")


def test_a_joint_that_does_not_move(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A link is merged into its parent, and its joint is gone, with what the draft wrote about both."""
    session = edited(UNDECIDED)
    page.run("stepbot.state.select({link: 'crank'})")
    press(page, "merge")
    page.wait("return stepbot.state.scene.links.length === 1")
    assert "crank" not in text_of(session, cache)


def test_convert(page: Page, edited: Callable[[str], Session], robot_library: Path) -> None:
    """Convert writes and proves the files, links them, and says how each is loaded; findings lead to their element."""
    session = edited((robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8"))
    folder = session.target.parent / "four_bar"
    session._options = session._options._replace(output=folder)
    page.tab("proof")
    page.element("#convert").click()
    page.wait("return document.querySelector('#converted').textContent.includes('Converted and proven')")
    assert (folder / "four_bar.urdf").is_file()
    assert f'mujoco.viewer --mjcf="{folder.as_posix()}/four_bar.scene.xml"' in page.text("#converted")
    assert page.text("#converted").count("gz sim ") == page.text("#converted").count('four_bar.world.sdf"') == 1
    assert (folder / "report.html").is_file()
    assert page.element("#converted a[target=_blank]").text == "report.html"
    link = page.element("#converted a[download='four_bar.urdf']").get_attribute("href")
    loaded = page.driver.execute_async_script(
        "fetch(arguments[0]).then(answer => answer.text()).then(arguments[1])", link
    )
    assert loaded.encode() == (folder / "four_bar.urdf").read_bytes()
    page.expected_errors.append("404 (Not Found)")
    status = page.run("return fetch('files/..%2Ffour_bar.robot.yaml').then(answer => answer.status)")
    assert status == 404
    statuses = page.run("return [...document.querySelectorAll('#proof tr')].map(row => row.dataset.status)")
    assert statuses == sorted(statuses, key=["failed", "passed", "not run"].index)
    page.run(
        "stepbot.state.scene.diagnostics = [{code: 'SB407', severity: 'warning', file: 'x', line: 1, help: [],"
        "message: \"joint 'rocker_swing': weak\"}]; stepbot.state.tell('proof')"
    )
    page.tab("findings")
    page.element("#findings .about").click()
    assert page.text("#card h2") == "rocker_swing"


def test_all_parts_of_a_name_are_moved_together(page: Page, edited: Callable[[str], Session]) -> None:
    """The search has a button that selects what it finds; a link takes all of it in one step."""
    session = edited(UNDECIDED)
    page.tab("parts")
    paths = page.run("return stepbot.state.scene.links.flatMap(({components}) => components)")
    found = [path for path in paths if "r" in path.lower()]
    assert len(found) > 1
    page.element("#search").send_keys("r")
    page.wait("return document.querySelector('#select-all')")
    assert page.text("#select-all") == f"select all {len(found)}"
    page.element("#select-all").click()
    assert sorted(page.run("return stepbot.state.selection.picked")) == sorted(found)
    assert page.text("#card h2") == f"{len(found)} parts"
    assert page.element("#card [data-edit=assign]").is_displayed()
    assert session.target.read_text(encoding="utf-8") == UNDECIDED
