"""``stepbot view --edit``: the card of a joint follows each answer, and keeps what was not sent yet."""

from collections.abc import Callable
from pathlib import Path

import pytest

from robot_library.step_file import Assembly, Occurrence
from stepbot.pipeline.conversion import Options
from stepbot.runtime.cache import Cache
from stepbot.serving.session import Session
from tests import parts, solids

from .page import Page
from .test_edit import press
from .test_edit_joints import CONTROL, PARTS_OF_THE_ROOT, enter

pytestmark = pytest.mark.slow

ENTER, TAB = "\ue007", "\ue004"
"""The keys in WebDriver."""

WITHOUT_LIMITS = PARTS_OF_THE_ROOT.replace("{lower: -91 deg, upper: 89 deg}", "todo")
NAME, LOWER, UPPER = "#card [data-edit=joint-name]", "#card [data-end=lower]", "#card [data-end=upper]"


@pytest.fixture
def session(page: Page, edited: Callable[[str], Session]) -> Session:
    """A joint without limits, selected."""
    session = edited(WITHOUT_LIMITS)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    return session


def settled(page: Page) -> None:
    """Wait until every change is answered."""
    page.wait("return !document.body.classList.contains('checking')")


def value(page: Page, selector: str) -> str:
    """What a field shows."""
    return str(page.element(selector).get_property("value"))


def retype(page: Page, selector: str, text: str) -> None:
    """Type over a field."""
    page.element(selector).send_keys(CONTROL, "a")
    page.element(selector).send_keys(text)


def drag(page: Page, end: str, to: float) -> None:
    """Drag the slider of a limit and release it."""
    page.run(
        "const bar = document.querySelector(`#card [data-limit=${arguments[0]}]`); bar.value = arguments[1];"
        "bar.dispatchEvent(new Event('input')); bar.dispatchEvent(new Event('change'));",
        end,
        to,
    )


def test_answers_keep_what_was_not_sent(page: Page, session: Session) -> None:
    """A limit typed or dragged stays, with the focus, while an earlier change is answered; the facts are new."""
    retype(page, NAME, "first" + ENTER)
    retype(page, LOWER, "-20" + TAB)
    settled(page)
    assert page.text("#card h2") == "first"
    assert value(page, LOWER) == "-20 °"
    assert "Set the other limit, too." in page.text("#card")
    retype(page, NAME, "second" + ENTER)
    drag(page, "lower", -30)
    retype(page, UPPER, "4")
    settled(page)
    assert page.text("#card h2") == "second"
    assert (value(page, LOWER), value(page, UPPER)) == ("-30 °", "4")
    page.element(UPPER).send_keys("5")
    assert page.run("return document.activeElement === document.querySelector(arguments[0])", UPPER)
    page.element(UPPER).send_keys(ENTER)
    settled(page)
    assert "limits: {lower: -30 deg, upper: 45 deg}" in session.target.read_text(encoding="utf-8")
    assert "range\n-30 ° to 45 °" in page.text("#card")


def test_changes_use_the_name_that_a_joint_has(page: Page, session: Session) -> None:
    """A joint is renamed twice, limited and removed without leaving the field, each before the former answer."""
    retype(page, NAME, "first" + ENTER)
    retype(page, NAME, "second" + ENTER)
    settled(page)
    text = session.target.read_text(encoding="utf-8")
    assert "\n  second:" in text
    assert "first" not in text
    assert page.text("#card h2") == "second"
    assert page.text("#notice").startswith("saved")
    page.element("#undo").click()
    settled(page)
    assert (page.text("#card h2"), value(page, NAME)) == ("first", "first")
    retype(page, NAME, "third" + ENTER)
    press(page, "remove")
    settled(page)
    assert "crank" not in session.target.read_text(encoding="utf-8").split("links:")[1]
    assert page.text("#notice").startswith("saved")
    assert not page.element("#card").is_displayed()


def test_the_panel_says_saved_with_the_new_scene(page: Page, session: Session) -> None:
    """When the page says `saved`, title, links and fields are the new ones, while the field has the focus."""
    retype(page, "#card [data-edit=link-name]", "disc" + ENTER)
    page.wait("return document.querySelector('#notice').textContent.startsWith('saved')")
    assert "links\nground → disc" in page.text("#card")
    assert page.run("return document.activeElement.dataset.edit") == "link-name"


def test_refused_values_do_not_stay(page: Page, session: Session) -> None:
    """A refused limit is replaced by the stored one; without one it stays to be corrected, marked as invalid."""
    enter(page, "[data-end=lower]", "-10")
    enter(page, "[data-end=upper]", "-20")
    settled(page)
    assert "must be below" in page.text("#notice")
    assert value(page, UPPER) == "-20 °"
    assert page.element(UPPER).get_attribute("aria-invalid") == "true"
    enter(page, "[data-end=upper]", "78")
    settled(page)
    assert page.element(UPPER).get_attribute("aria-invalid") is None
    enter(page, "[data-end=upper]", "-20")
    settled(page)
    assert value(page, UPPER) == "78 °"
    assert page.run("return Number(document.querySelector('#card [data-limit=upper]').value)") == 78
    assert "limits: {lower: -10 deg, upper: 78 deg}" in session.target.read_text(encoding="utf-8")


def test_every_link_has_a_name_field(page: Page, session: Session) -> None:
    """The panel of the base link renames it, twice without leaving the field, and stays open."""
    page.run("stepbot.state.select({link: 'ground'})")
    for name in ("bench", "base"):
        retype(page, "#card [data-edit=link-name]", name + ENTER)
    settled(page)
    assert page.text("#card h2") == "link base"
    assert page.run("return document.activeElement.dataset.edit") == "link-name"
    text = session.target.read_text(encoding="utf-8")
    assert "\n  base: {rest: true}" in text
    assert "parent: base\n" in text
    retype(page, "#card [data-edit=link-name]", "crank_turn" + ENTER)
    settled(page)
    assert page.text("#notice").startswith("a link and a joint cannot have one name; try 'crank_turn_link'")
    assert value(page, "#card [data-edit=link-name]") == "base"


def test_flip_axis_says_what_happens_to_the_limits(page: Page, session: Session) -> None:
    """With limits they are mirrored; without there is nothing to say about them."""
    press(page, "flip")
    settled(page)
    assert page.text("#notice").startswith("axis flipped\n")
    enter(page, "[data-end=lower]", "-10")
    enter(page, "[data-end=upper]", "78")
    settled(page)
    press(page, "flip")
    settled(page)
    assert page.text("#notice").startswith("axis flipped; limits mirrored, the motion is the same")
    assert (value(page, LOWER), value(page, UPPER)) == ("-78 °", "10 °")


STOPS = """  # stop found by collision at -2.0944 rad: 'base/pad' and 'crank'; a limit may be closer
  # stop found by collision at 0.6981 rad: 'base/pad' and 'crank/pin'; a limit may be closer
"""
WEAK = """version: 1
robot: hinge
step: hinge.step
links:
  plate: {parts: [plate]}
  arm: {parts: [arm]}
joints:
  hinge: {type: revolute, parent: plate, child: arm, limits: {lower: -1, upper: 1}}
"""


def test_stops_of_the_draft_become_limits(page: Page, edited: Callable[[str], Session]) -> None:
    """The panel has the stops with their parts; one press makes limits of them; they follow `flip axis`."""
    session = edited(WITHOUT_LIMITS.replace("  # REVIEW", f"{STOPS}  # REVIEW"))
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    card = page.text("#card")
    assert "-120 °: 'base/pad' and 'crank'\n40 °: 'base/pad' and 'crank/pin'\n" in card
    press(page, "flip")
    settled(page)
    assert "120 °: 'base/pad' and 'crank'\n-40 °: 'base/pad' and 'crank/pin'\n" in page.text("#card")
    press(page, "stops")
    settled(page)
    assert (value(page, LOWER), value(page, UPPER)) == ("-39.998 °", "120 °")
    assert "limits: {lower: -39.998 deg, upper: 120 deg}" in session.target.read_text(encoding="utf-8")


def test_a_drafted_joint_is_confirmed(page: Page, edited: Callable[[str], Session]) -> None:
    """`axis is right` takes the mark from a drafted joint; it is offered for marked ones alone."""
    session = edited(PARTS_OF_THE_ROOT)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    assert page.text("#card [data-edit=confirm]") == "axis is right"
    press(page, "confirm")
    settled(page)
    assert page.run("return stepbot.state.find({connection: 'crank_turn'}).doubt") == ""
    assert not page.element("#card [data-edit=confirm]").is_displayed()
    assert "# REVIEW" not in session.target.read_text(encoding="utf-8")


def test_a_weak_axis_is_confirmed(page: Page, tmp_path: Path, cache: Path) -> None:
    """A pin in a wider bore is a doubted axis (SB407); `axis is right` selects it and takes the mark away."""
    plate = solids.box(80, 80, 10) + solids.cylinder(10, 20).at(0, 0, 5)
    arm = solids.box(40, 120, 10).at(0, 45, 10) - solids.cylinder(10.5, 10).at(0, 0, 5)
    children = [
        Occurrence(parts.drawn("plate", plate, density=7850.0), "plate:1"),
        Occurrence(parts.drawn("arm", arm, density=2700.0), "arm:1"),
    ]
    parts.write_step(tmp_path / "hinge.step", Assembly("hinge", children))
    sidecar = tmp_path / "hinge.robot.yaml"
    sidecar.write_text(WEAK, encoding="utf-8")
    session = Session(sidecar, Options(output=Path(), cache=Cache(cache)), edits=True)
    try:
        session.load()
        session.server.start()
        page.open(session.server.url)
        page.wait("return document.querySelector('#live').textContent === 'live'")
        assert "do not match" in page.run("return stepbot.state.find({connection: 'hinge'}).doubt")
        page.run("stepbot.state.select({connection: 'hinge'})")
        press(page, "confirm")
        settled(page)
        assert page.run("return stepbot.state.find({connection: 'hinge'}).doubt") == ""
    finally:
        session.close()
    assert "origin: {auto: true, radius: 10.5 mm}" in sidecar.read_text(encoding="utf-8")
