"""The page beside its panels: nothing covers the robot, everything has a key and a name."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from stepbot.serving.session import Session

from .page import Page
from .test_settings import UNDECIDED

pytestmark = pytest.mark.slow

NAMED = ("button", "textbox", "searchbox", "combobox", "slider", "tab", "checkbox", "spinbutton", "splitter", "link")
"""Roles of Chromium's accessibility tree that a person operates."""
ARROW_LEFT, ARROW_RIGHT, END, ESCAPE = "\ue012", "\ue014", "\ue010", "\ue00c"


@pytest.fixture
def opened(edited: Callable[[str], Session], robot_library: Path, page: Page) -> Session:
    """The four-bar linkage, open for editing, with a joint selected."""
    session = edited((robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8"))
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    return session


def boxes(page: Page) -> dict[str, Any]:
    """Places of the robot, the panels and the selection in the window [px]."""
    script = "return document.getElementById(arguments[0]).getBoundingClientRect().toJSON()"
    return {name: page.run(script, name) for name in ("stage", "panels", "card", "canvas")}


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1000, 700), (768, 1024)])
def test_the_panels_cover_nothing_of_the_robot(page: Page, opened: Session, width: int, height: int) -> None:
    """On a small screen and a tablet the robot has over a third, the selection is in the panels, in the window."""
    page.resize(width, height)
    found = boxes(page)
    stage, panels, card = found["stage"], found["panels"], found["card"]
    beside = stage["x"] + stage["width"] <= panels["x"] + 1
    below = stage["y"] + stage["height"] <= panels["y"] + 1
    assert beside or below
    assert panels["y"] <= card["y"]
    assert card["y"] + card["height"] <= panels["y"] + panels["height"] + 1 <= height + 1.001
    assert panels["x"] + panels["width"] <= width
    assert stage["width"] * stage["height"] > width * height / 3
    assert page.run("return document.documentElement.scrollWidth <= innerWidth")
    ends = "return [...document.querySelectorAll('#toolbar .chip')].map(one => one.getBoundingClientRect().right)"
    assert max(page.run(ends)) <= width


def test_a_turned_tablet_gets_its_panels_beside_the_robot(page: Page, edited: Callable[[str], Session]) -> None:
    """Panels that were as wide as an upright screen are not so on a wide one."""
    page.resize(820, 1180)
    edited(UNDECIDED)
    page.resize(1180, 820)
    found = boxes(page)
    assert found["stage"]["width"] > found["panels"]["width"]
    page.wait(
        "return document.getElementById('grip').getAttribute('aria-valuenow') === String(arguments[0])",
        found["panels"]["width"],
    )


def test_the_panels_are_resized_and_hidden_by_keys(page: Page, opened: Session) -> None:
    """Arrow keys on the edge widen the panels, `p` hides them, and the robot's view has the rest."""
    before = boxes(page)
    page.element("#grip").send_keys(ARROW_LEFT * 3)
    wide = boxes(page)
    assert wide["panels"]["width"] == before["panels"]["width"] + 96
    assert wide["canvas"]["width"] == before["canvas"]["width"] - 96
    assert page.element("#grip").get_attribute("aria-valuenow") == str(wide["panels"]["width"])
    page.element("#canvas").send_keys("p")
    assert not page.element("#panels").is_displayed()
    assert boxes(page)["canvas"]["width"] == page.run("return innerWidth")
    page.element("#dock").click()
    assert boxes(page)["panels"] == wide["panels"]


def test_keys(page: Page, opened: Session) -> None:
    """Arrow keys go through the tabs and turn the robot; `j` and `k` go through the joints; `?` lists all keys."""
    page.element("#tab-joints").send_keys(ARROW_RIGHT)
    assert page.run("return document.activeElement.id") == "tab-parts"
    assert page.element("#parts").is_displayed()
    page.element("#tab-parts").send_keys(END)
    assert page.element("#findings").is_displayed()
    canvas = page.element("#canvas")
    turned = "return stepbot.view.camera.azimuth"
    before = page.run(turned)
    canvas.send_keys(ARROW_LEFT)
    assert page.run(turned) != before
    names = page.run("return stepbot.state.scene.connections.map(({name}) => name)")
    selected = "return stepbot.state.selection?.connection ?? null"
    canvas.send_keys(ESCAPE)
    assert page.run(selected) is None
    canvas.send_keys("j")
    assert page.run(selected) == names[0]
    canvas.send_keys("k")
    assert page.run(selected) == names[-1]
    canvas.send_keys("?")
    assert page.element("#help").is_displayed()
    listed = page.text("#help")
    assert all(words in listed for words in ("fit the robot", "next joint", "undo"))
    page.element("#help").send_keys(ESCAPE)
    assert not page.element("#help").is_displayed()
    assert page.run(selected) == names[-1]
    field = page.element("#card [data-edit=joint-name]")
    field.send_keys("j")
    assert page.run(selected) == names[-1]


def test_everything_to_operate_has_a_name(page: Page, opened: Session) -> None:
    """Chromium's accessibility tree has a name for every button, field, slider and tab, in every panel."""
    if not page.is_chromium:
        pytest.skip("the accessibility tree is read by a protocol of Chromium")
    page.driver.execute_cdp_cmd("Accessibility.enable", {})
    for tab in page.run(
        "return [...document.querySelectorAll('[role=tab]')].map(tab => tab.getAttribute('aria-controls'))"
    ):
        page.tab(tab)
        nodes = page.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        operated = [node for node in nodes if not node["ignored"] and node["role"]["value"] in NAMED]
        assert len(operated) > 15
        assert [node for node in operated if not node.get("name", {}).get("value", "").strip()] == []
