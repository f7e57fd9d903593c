"""``stepbot view --edit``: joints on parts of the root, and changes of a joint that exists."""

from collections.abc import Callable
from math import pi
from pathlib import Path

import pytest

from stepbot.serving.session import Session

from .page import CONTROL, Page
from .test_edit import BARE, component, press, text_of

pytestmark = pytest.mark.slow

PARTS_OF_THE_ROOT = (
    BARE
    + """  crank: {parts: [crank]}
joints:
  # score 0.95: output of the motor 'm'
  # REVIEW: could also be prismatic
  crank_turn:
    type: revolute
    parent: ground
    child: crank
    origin: {mate: ["frame/ground bar", crank]}
    axis: -z
    limits: {lower: -91 deg, upper: 89 deg}
"""
)


@pytest.fixture
def good(robot_library: Path) -> str:
    """The sidecar of the four-bar linkage."""
    return (robot_library / "stepbot_four_bar" / "four_bar.robot.yaml").read_text(encoding="utf-8")


def pick(page: Page, *names: str) -> None:
    """Select one part after the other, as with Ctrl."""
    for index, name in enumerate(names):
        path = component(page, name)
        page.run(
            "const [component, add] = arguments; const {state} = stepbot;"
            "state.select({link: state.linkOf(component), component, add});",
            path,
            index > 0,
        )


def enter(page: Page, field: str, value: str) -> None:
    """Enter a value into a field of the card."""
    page.run(
        "const box = document.querySelector(`#card ${arguments[0]}`); box.value = arguments[1];"
        "box.dispatchEvent(new Event('input', {bubbles: true})); box.dispatchEvent(new Event('change'));"
        "box.dispatchEvent(new Event('focusout', {bubbles: true}));",
        field,
        value,
    )


def lines(page: Page, form: str = "#card") -> list[str]:
    """The axes offered."""
    script = (
        "const options = document.querySelectorAll(`${arguments[0]} select[data-edit=origin] option`);"
        "return [...options].map(one => one.textContent);"
    )

    def offered() -> list[str]:
        texts = [str(one) for one in page.run(script, form)]
        return [] if not texts or "looking" in texts[0] else texts

    return list(page.until(offered, "axes are offered"))


def test_a_part_of_the_root_becomes_a_link(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A second part that the root has as `rest` gets a link of its own, whose name can be typed; a loop is a choice."""
    session = edited(PARTS_OF_THE_ROOT)
    pick(page, "crank", "coupler")
    assert "shaft in bore, radius" in lines(page, "#joint-form")[0]
    assert page.run("return document.querySelector('#joint-form [data-edit=target]').value") == ""
    assert page.element("#joint-form [data-edit=child]").is_enabled()
    assert page.run("return document.querySelector('#joint-form [data-edit=child]').value") == "coupler"
    options = "return [...document.querySelectorAll('#joint-form [data-edit=target] option')].map(o => o.textContent)"
    assert page.run(options) == ["a new link", "ground, closing a loop"]
    enter(page, "#joint-form [data-edit=lower]", "abc")
    press(page, "add")
    page.wait("return document.querySelector('#notice').textContent.includes(\"'abc' is not an angle\")")
    assert page.element("#joint-form [data-edit=lower]").get_attribute("aria-invalid") == "true"
    enter(page, "#joint-form [data-edit=lower]", "-1 rad")
    press(page, "add")
    page.wait("return stepbot.state.selection?.connection === 'coupler_joint'")
    text = text_of(session, cache)
    assert "  coupler: {parts: [coupler]}\n" in text
    assert "lower: -57.296 deg, upper: 90 deg" in text
    assert page.text("#notice").startswith("saved")


def test_name_type_and_range_of_a_joint(page: Page, edited: Callable[[str], Session], cache: Path, good: str) -> None:
    """Names are changed with all references, the type with the limits, limits by typing; each is undone."""
    session = edited(good)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    enter(page, "[data-edit=joint-name]", "drive")
    page.wait("return stepbot.state.selection?.connection === 'drive'")
    renamed = good.replace("crank_turn", "drive")
    assert text_of(session, cache) == renamed
    enter(page, "[data-edit=link-name]", "disc")
    page.wait("return stepbot.state.find({connection: 'drive'}).child === 'disc'")
    assert "  disc: {parts: [crank]}" in text_of(session, cache)
    enter(page, "[data-edit=joint-name]", "rocker_swing")
    page.wait("return document.querySelector('#notice').textContent.includes('already')")
    assert page.run("return document.querySelector('[data-edit=joint-name]').value") == "drive"
    page.element("#undo").click()
    page.until(lambda: session.target.read_text(encoding="utf-8") == renamed, "undone")
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    assert page.text("#card h2") == "rocker_swing"
    assert "axis\n-y\n" in page.text("#card")
    enter(page, "[data-end=upper]", "abc")
    assert "'abc' is not an angle" in page.text("#notice")
    assert page.run("return document.querySelector('#card [data-end=upper]').value") == "70 °"
    enter(page, "[data-end=upper]", "1 rad")
    page.until(lambda: "upper: 57.296 deg" in session.target.read_text(encoding="utf-8"), "written")
    page.wait("return !document.body.classList.contains('checking')")
    enter(page, "[data-edit=type]", "continuous")
    page.wait("return stepbot.state.find({connection: 'rocker_swing'}).kind === 'continuous'")
    assert "rocker_swing: {type: continuous, parent: ground, child: rocker, axis: -z}" in text_of(session, cache)


def test_a_screw_and_a_universal_joint(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A type that needs a value has a field for it, of a joint that exists and of a new one; nothing else has."""
    session = edited(PARTS_OF_THE_ROOT)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    assert not page.element("#card [data-edit=needed]").is_displayed()
    enter(page, "[data-edit=type]", "screw")
    assert page.element("#card [data-edit=needed]").is_displayed()
    enter(page, "[data-edit=needed]", "soon")
    page.wait("return document.querySelector('#notice').textContent.includes('soon')")
    assert session.target.read_text(encoding="utf-8") == PARTS_OF_THE_ROOT
    enter(page, "[data-edit=type]", "screw")
    enter(page, "[data-edit=needed]", "2 mm/rev")
    page.wait("return stepbot.state.find({connection: 'crank_turn'}).kind === 'screw'")
    assert "    axis: -z\n    pitch: 2 mm/rev\n" in text_of(session, cache)
    assert not page.element("#card [data-edit=needed]").is_displayed()
    pick(page, "crank", "coupler")
    lines(page, "#joint-form")
    enter(page, "#joint-form [data-edit=kind]", "universal")
    enter(page, "#joint-form [data-edit=needed]", "x")
    press(page, "add")
    page.wait("return stepbot.state.find({connection: 'coupler_joint'})?.kind === 'universal'")
    assert "axis2: x" in text_of(session, cache).split("coupler_joint:")[1]


FUSED = PARTS_OF_THE_ROOT.replace(
    "joints:\n",
    """  # Fused parts that look movable. To free one, uncomment it and its joint, and take it off its link.
  # coupler: {parts: [coupler]}
joints:
""",
) + (
    "  # fused: 'coupler' and 'crank' are one link: round face on a face\n"
    "  # coupler_joint: {type: continuous, parent: crank, child: coupler, origin: auto}  # score 0.40: round face\n"
)


def test_a_fused_part_is_freed(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A part that `init` drafted as fixed is a question: its place selects it, and `it moves` gives it its joint."""
    session = edited(FUSED)
    page.tab("todo")
    page.wait("return document.querySelector('[data-kind=fused]')")
    assert "Does it move? coupler" in page.text("[data-kind=fused]")
    page.element("[data-kind=fused] .place").click()
    assert str(page.run("return stepbot.state.selection.component")).endswith("coupler")
    page.element("[data-kind=fused] [data-decide=free]").click()
    page.wait("return stepbot.state.find({connection: 'coupler_joint'})?.kind === 'continuous'")
    text = text_of(session, cache)
    assert "  coupler: {parts: [coupler]}\n" in text
    assert "fused" not in text.lower()
    page.wait("return !document.querySelector('[data-kind=fused]')")


def test_review_marks_are_those_of_the_sidecar(page: Page, edited: Callable[[str], Session]) -> None:
    """A drafted joint has a question mark while its REVIEW comment is there; its axis is given in the STEP's frame."""
    session = edited(PARTS_OF_THE_ROOT)
    mark = "return stepbot.state.find({connection: 'crank_turn'}).doubt"
    assert page.run(mark) == "could also be prismatic"
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    assert "axis\n-y\n" in page.text("#card")
    press(page, "flip")
    page.wait("return stepbot.state.find({connection: 'crank_turn'}).along === '+y'")
    assert "axis\n+y\n" in page.text("#card")
    page.wait("return !document.body.classList.contains('checking')")
    assert "limits: {lower: -89 deg, upper: 91 deg}" in session.target.read_text(encoding="utf-8")
    text = session.target.read_text(encoding="utf-8")
    session.target.write_text(text.replace("  # REVIEW: could also be prismatic\n", ""), encoding="utf-8")
    session.load()
    page.wait("return stepbot.state.find({connection: 'crank_turn'}).doubt === ''")


def test_typed_positions(page: Page, edited: Callable[[str], Session]) -> None:
    """A position has a unit; what is no position, or beyond a limit, is said, and the box shows where the robot is."""
    edited(PARTS_OF_THE_ROOT)
    page.tab("joints")
    box = page.element("[data-value=crank_turn]")

    def typed(text: str) -> tuple[float, str, str]:
        box.send_keys(CONTROL, "a")
        box.send_keys(text + "\ue007")
        page.wait("return document.querySelector('[data-value=crank_turn]').value.endsWith('°')")
        why = page.run("return document.querySelector('[data-joint=crank_turn] .why').textContent")
        return page.positions()["crank_turn"], str(box.get_property("value")), str(why)

    assert typed("0.5 rad") == (pytest.approx(0.5), "28.648 °", "")
    assert typed("-30") == (pytest.approx(-pi / 6), "-30 °", "")
    assert typed("30 deg")[0] == pytest.approx(pi / 6)
    position, shown, why = typed("abc")
    assert (position, shown) == (pytest.approx(pi / 6), "30 °")
    assert "'abc' is not an angle" in why
    assert "'5 mm' is not an angle" in typed("5 mm")[2]
    position, shown, why = typed("-120")
    assert (position, shown) == (pytest.approx(-91 * pi / 180), "-91 °")
    assert why.startswith("-120 is beyond the limit -91 °")


def test_as_drawn_moves_the_slider_back(page: Page, edited: Callable[[str], Session]) -> None:
    """The thumb that was dragged last follows `as drawn`."""
    edited(PARTS_OF_THE_ROOT)
    page.tab("joints")
    page.slide("crank_turn", 40.0)
    page.element("#reset").click()
    assert page.positions()["crank_turn"] == 0.0
    assert float(page.run("return document.querySelector('[data-slider=crank_turn]').value")) == 0.0


def test_a_gap_of_rounding_errors_is_zero(page: Page, edited: Callable[[str], Session], good: str) -> None:
    """A closed loop has a gap of 0 mm."""
    edited(good)
    page.run("stepbot.state.select({connection: 'rocker_pin'})")
    assert "gap\n0 mm" in page.text("#card")
