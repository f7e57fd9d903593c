"""``stepbot view --edit``: what is dragged and clicked on the robot itself."""

from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import pytest

from robot_library.stepbot_four_bar.dimensions import BASE, BASE_CENTRE, BOLT_INSET
from stepbot.serving.session import Session

from .page import Page
from .test_edit import BARE, component, press, text_of
from .test_edit_joints import PARTS_OF_THE_ROOT
from .test_edit_panel import retype, settled

pytestmark = pytest.mark.slow

LOOSE = PARTS_OF_THE_ROOT + (
    """  rocker_swing:
    type: continuous
    parent: ground
    child: rocker
    origin: {mate: ["frame/ground bar", rocker]}
    axis: -z
"""
)
LOOSE = LOOSE.replace("  crank: {parts: [crank]}\n", "  crank: {parts: [crank]}\n  rocker: {parts: [rocker]}\n")
"""Two joints on the ground."""
PILLARS = ["frame/pillar:1", "frame/pillar:2"]

Place = tuple[float, float]


def frame_of(page: Page, paths: list[str]) -> tuple[Place, Place]:
    """Opposite corners, in the window, of a frame that is 3 pixels larger than some parts."""
    script = """const {view, state} = stepbot; const {left, top, width, height} = view.canvas.getBoundingClientRect();
      const X = view.items.filter(one => arguments[0].includes(one.component)).flatMap(item => {
        const {vertices} = item.geometry; const pose = state.pose(item.link); const L = item.X_LG; const found = [];
        const move = (T, p) => [0, 1, 2].map(i => T[3*i]*p[0] + T[3*i+1]*p[1] + T[3*i+2]*p[2] + T[9+i]);
        for (let i = 0; i < vertices.length; i += 3) {
          found.push(view.camera.project(move(pose, move(L, [...vertices.subarray(i, i + 3)]))));
        } return found.map(({x, y}) => [left + x * width, top + y * height]); });
      const ends = [0, 1].map(i => [Math.min(...X.map(p => p[i])), Math.max(...X.map(p => p[i]))]);
      return [[ends[0][0] - 3, ends[1][0] - 3], [ends[0][1] + 3, ends[1][1] + 3]];"""
    a, b = page.run(script, paths)
    return (a[0], a[1]), (b[0], b[1])


def picked(page: Page) -> list[str]:
    """Paths of the parts that are selected together."""
    return sorted(page.run("return stepbot.state.selection?.picked ?? []"))


def grip(page: Page, text: str) -> Place:
    """The middle of a handle on the robot, by the start of its text."""
    page.run("stepbot.view.draw()")
    script = """const grips = [...document.querySelectorAll('.grip')];
      const one = grips.find(one => one.textContent.startsWith(arguments[0]));
      const box = one.getBoundingClientRect(); return [box.left + box.width / 2, box.top + box.height / 2];"""
    x, y = page.run(script, text)
    return x, y


def rounded(page: Page, joint: str, end: str) -> float:
    """A limit of a joint [deg] in the scene."""
    value = page.run("return stepbot.state.find({connection: arguments[0]}).limits[arguments[1]]", joint, end)
    return float(value) / radians(1.0)


def viewpoint(page: Page) -> list[float]:
    """Where the camera is and looks; unlike its matrix independent of the size of the canvas."""
    return page.run("const c = stepbot.view.camera; return [c.azimuth, c.elevation, c.distance, ...c.target]")


@pytest.mark.parametrize("with_control", [True, False], ids=["Ctrl-drag", "after its button"])
def test_a_box_selects_the_parts_inside(
    page: Page, edited: Callable[[str], Session], cache: Path, with_control: bool
) -> None:
    """Parts that are wholly inside, hidden ones too, are selected and moved together; the view does not turn."""
    session = edited(LOOSE)
    before = viewpoint(page)
    if not with_control:
        page.element("#box").click()
    corner, other = frame_of(page, ["crank", "rocker", "coupler", "frame/ground bar"])
    page.drag(corner, other, with_control=with_control)
    assert picked(page) == ["coupler", "crank", "frame/ground bar", "rocker"]
    page.drag(*frame_of(page, ["frame/pillar:2"]), with_control=True)
    assert picked(page) == ["coupler", "crank", "frame/ground bar", "frame/pillar:2", "rocker"]
    assert viewpoint(page) == before
    assert not page.element("#rubber").is_displayed()
    for path in ("crank", "frame/ground bar", "frame/pillar:2"):  # a second click takes one away
        page.run(
            "stepbot.state.select({link: stepbot.state.linkOf(arguments[0]), component: arguments[0], add: true})", path
        )
    assert picked(page) == ["coupler", "rocker"]
    page.element("#card [data-edit=link]").send_keys("rocker")
    press(page, "assign")
    settled(page)
    assert "  rocker: {parts: [rocker, coupler]}\n" in text_of(session, cache)
    page.drag((20.0, 700.0), (60.0, 740.0), with_control=True)
    assert page.text("#notice").startswith("No part is wholly inside the box.")
    page.drag((400.0, 700.0), (460.0, 700.0))
    assert viewpoint(page) != before


def test_equal_parts_get_one_rule(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """All parts of a product are selected from one of them; a rule of several parts names the product where it can."""
    session = edited(BARE)
    page.run("stepbot.state.select({link: 'ground', component: arguments[0]})", component(page, "pillar:2"))
    assert page.text("#card [data-alike='of pillar']") == "select all 2 of pillar"
    page.element("#card [data-alike='of pillar']").click()
    assert picked(page) == PILLARS
    page.run("stepbot.state.select({link: 'ground', component: 'rocker', add: true})")
    retype(page, "#card [data-set='parts..mass']", "0.25 kg")
    press(page, "rules")
    settled(page)
    page.wait("return stepbot.state.scene.links[0].sources.filter(({mass}) => mass === 0.25).length === 3")
    text = text_of(session, cache)
    assert [line for line in BARE.split("\n") if line not in text.split("\n")] == []
    assert "\n\nparts:\n" in text
    assert text.count("0.25 kg") == 2
    assert '"**/pillar"' in text
    page.element("#undo").click()
    page.until(lambda: session.target.read_text(encoding="utf-8") == BARE, "one step")


def test_a_joint_follows_a_clicked_one(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """Two clicks and a ratio of teeth: the joint moves with the other one; Esc ends the question."""
    session = edited(LOOSE)
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    press(page, "follow")
    page.run("dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}))")
    page.click(page.pixel_of("crank"))
    assert page.run("return stepbot.state.selection.component") == "crank"
    page.run("stepbot.state.select({connection: 'rocker_swing'})")
    press(page, "follow")
    page.click(page.pixel_of("crank"))
    assert page.text("#card h2") == "rocker_swing"
    assert "of crank_turn, rocker_swing moves" in page.text("#card")
    retype(page, "#card [data-edit=ratio]", "-20/60")
    press(page, "follow-set")
    page.wait("return stepbot.state.find({connection: 'rocker_swing'}).mimic")
    assert "    mimic: {joint: crank_turn, multiplier: -0.333333333}\n" in text_of(session, cache)
    page.tab("joints")
    page.slide("crank_turn", 60.0)
    assert page.positions()["rocker_swing"] == pytest.approx(radians(-20.0), abs=1e-8)
    settled(page)
    press(page, "unfollow")
    page.until(lambda: session.target.read_text(encoding="utf-8") == LOOSE, "as before")


def test_limits_are_dragged_on_the_robot(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A handle of the arc sets its limit on release, in whole degrees; another one moves the joint."""
    session = edited(PARTS_OF_THE_ROOT)
    page.run("stepbot.view.camera.look(-Math.PI / 2, 0); stepbot.view.fit()")  # along the axis
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    seen = """const {state, view} = stepbot; const [angle] = arguments;
      const {left, top} = view.canvas.getBoundingClientRect();
      const joint = state.tree.joints[state.tree.column.get('crank_turn')];
      const {x, y} = view.grips.seen({joint}, angle); return [left + x, top + y];"""

    def at(degrees: float) -> Place:
        x, y = page.run(seen, radians(degrees))
        return x, y

    page.drag(grip(page, "lower"), at(-40.0))
    page.wait("return document.querySelector('#notice').textContent.startsWith('saved')")
    settled(page)
    assert rounded(page, "crank_turn", "lower") == pytest.approx(-40.0, abs=1.0)
    text = text_of(session, cache)
    assert "deg, upper: 89 deg}" in text
    lower = text.split("lower: ")[1].split(" deg")[0]
    assert float(lower) == round(float(lower))
    page.drag(grip(page, "0°"), at(50.0))
    assert page.positions()["crank_turn"] == pytest.approx(radians(50.0), abs=radians(1.0))
    assert session.target.read_text(encoding="utf-8") == text
    press(page, "upper-here")
    page.until(lambda: "upper: 89" not in session.target.read_text(encoding="utf-8"), "written")
    settled(page)
    assert rounded(page, "crank_turn", "upper") == pytest.approx(50.0, abs=1.0)


def edge_pixel(page: Page, path: str, wanted: str) -> Place:
    """A place of the window on an edge of a part for which ``wanted``, a function of its hit in JavaScript, is true."""
    script = f"""const {{view}} = stepbot; const box = view.canvas.getBoundingClientRect(); const wanted = {wanted};
      for (let y = 70; y < box.height; y += 2) for (let x = 4; x < box.width; x += 2) {{
        const at = [box.left + x, box.top + y];
        if (document.elementFromPoint(...at) !== view.canvas) continue;
        const hit = view.hit(...at);
        if (hit && hit.component === arguments[0] && hit.edge && wanted(hit)) return at;
      }} return null;"""
    found = page.run(script, path)
    assert found is not None
    return found[0], found[1]


IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]
"""The pose of the root."""
TOP = "hit.triangle.every(corner => Math.abs(corner[2] - hit.triangle[0][2]) < 1e-6)"
"""Of a hit on a face that is level in the frame of its part."""


def test_the_rim_of_a_hole_is_its_axis(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A click on the flat face beside a bolt hole, on the hole's edge, gives the hole's axis; a sensor goes there."""
    session = edited(BARE)
    page.run("stepbot.view.camera.look(-0.9, 1.2); stepbot.view.fit()")
    page.click(edge_pixel(page, "frame/base", f"hit => hit.edge.isCurved && {TOP}"))
    page.wait("return document.querySelector('#origin')")
    origin = page.text("#origin")
    assert origin.startswith("origin: {axis_of: ")
    near = page.run("return stepbot.state.selection.face.line.point")
    half = [BASE[0] / 2 - BOLT_INSET, BASE[1] / 2 - BOLT_INSET]
    centre = [abs(1e3 * near[i] - offset) for i, offset in enumerate(placed_centre(page))]
    assert centre == pytest.approx(half, abs=1e-3)
    assert page.run("return document.querySelector(\"#card [data-set='frames..origin']\").value") in origin
    page.run(
        "document.querySelector(\"#card [data-set='sensors..type']\").value = 'imu';"
        "document.querySelector('#card [data-group=\"new sensors\"]').open = true;"
        "document.querySelector('#card [data-add=sensors]').click()"
    )
    page.wait("return stepbot.state.scene.sensors.length === 1")
    place = origin.replace('"', "")
    assert f"\nsensors:\n  sensor: {{type: imu, link: ground, {place}}}\n" in text_of(session, cache)
    assert page.run("return document.querySelector('#card [data-new=sensors]').value") == "sensor_2"


def test_a_camera_looks_away_from_a_flat_face(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """On a flat face a frame has z along the normal, and a sensor x, with z as far up as the face allows."""
    session = edited(BARE)
    page.run("stepbot.view.camera.look(-Math.PI / 4, 0.3); stepbot.view.fit()")
    front = """const {view} = stepbot; const box = view.canvas.getBoundingClientRect();
      for (let y = 70; y < box.height; y += 3) for (let x = 4; x < box.width; x += 3) {
        const at = [box.left + x, box.top + y];
        if (document.elementFromPoint(...at) !== view.canvas) continue;
        const hit = view.hit(...at);
        const [a, b, c] = hit?.component === 'frame/base' && !hit.edge ? hit.triangle : [[0], [1], [2]];
        if (Math.abs(a[0] - b[0]) < 1e-9 && Math.abs(a[0] - c[0]) < 1e-9) return at;
      } return null;"""
    place = page.run(front)
    assert place is not None
    page.click(tuple(place))
    page.wait("return stepbot.state.selection?.face?.why")
    point = page.run("return stepbot.state.selection.point")
    outwards = 1.0 if 1e3 * point[0] > BASE_CENTRE[0] else -1.0
    for section, kind in (("frames", ""), ("sensors", "camera")):
        page.run(
            f"const type = document.querySelector(\"#card [data-set='{section}..type']\");"
            f"if (type) type.value = '{kind}';"
            f"document.querySelector('#card [data-group=\"new {section}\"]').open = true;"
            f"document.querySelector('#card [data-add={section}]').click()"
        )
        page.wait(f"return stepbot.state.scene.{section}.length === 1")
        settled(page)
    text_of(session, cache)
    poses = page.run(
        "const {state} = stepbot; const pose = ([one]) => [state.pose(one.link), one.X];"
        "return [state.scene.frames, state.scene.sensors].map(pose)"
    )
    for (X_WL, X_LF), column in zip(poses, (2, 0), strict=True):
        assert X_WL == IDENTITY
        assert X_LF[column:9:3] == pytest.approx([outwards, 0.0, 0.0], abs=1e-6)
        assert X_LF[9:] == pytest.approx(point, abs=1e-6)
    assert poses[1][1][8] == pytest.approx(1.0)


def placed_centre(page: Page) -> list[float]:
    """The middle of the base [mm] in the frame of the part."""
    box: Any = page.run("return stepbot.view.items.find(one => one.component === 'frame/base').geometry")
    return [500.0 * (box["low"][i] + box["high"][i]) for i in range(2)]


def test_a_straight_edge_is_an_axis(page: Page, edited: Callable[[str], Session], cache: Path) -> None:
    """A hinge along an edge of the base: the joint's axis goes through the edge that the drawing has there."""
    session = edited(PARTS_OF_THE_ROOT)
    page.run("stepbot.state.select({connection: 'crank_turn'})")
    press(page, "aim")
    page.run("stepbot.view.camera.look(-0.9, 1.2); stepbot.view.fit()")
    along_x = "Math.abs(hit.edge.ends[0][0] - hit.edge.ends[1][0]) > 0.1"
    page.click(edge_pixel(page, "frame/base", f"hit => !hit.edge.isCurved && {along_x} && {TOP}"))
    page.wait("return stepbot.state.find({connection: 'crank_turn'}).along.endsWith('x')")
    settled(page)
    text = text_of(session, cache)
    assert 'relative_to: "frame/base"' in text or "relative_to: frame/base" in text
    at = page.run("return stepbot.state.find({connection: 'crank_turn'}).at")
    _, y, z = (float(value) for value in at.strip("[] m").split(","))
    edges = (BASE_CENTRE[1] - BASE[1] / 2, BASE_CENTRE[1] + BASE[1] / 2)
    assert min(abs(y - edge) for edge in edges) < 0.01
    assert z == pytest.approx(BASE[2], abs=0.01)
    assert page.text("#card h2") == "crank_turn"
