"""``stepbot view`` as a person uses it: look, click, copy, move; tabs, reloads, a server that ends."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import Pose
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Cylinder, Joint, JointKind, Limit, Link, Module, Robot, Sphere, Visual
from stepbot.serving.session import Session
from stepbot.viewing.scene import scene_document
from tests.robots import ROBOTS

from .page import Page

Serve = Callable[[Path], Session]
EVIL = "<img src=x onerror=\"document.title='owned'\"></script><script>document.title='owned'</script>"

FACE_KNOWN = "return Object.keys(stepbot.state.selection?.face ?? {}).length > 0"
"""The server has answered about the clicked face."""


@pytest.fixture
def four_bar(session: Serve, robot_library: Path) -> Session:
    """The four-bar linkage of the library, served."""
    return session(robot_library / "stepbot_four_bar" / "four_bar.robot.yaml")


@pytest.mark.slow
def test_click_a_part_and_copy_its_path(page: Page, four_bar: Session) -> None:
    """A click on a part shows its path as a sidecar writes it, its mass and its link."""
    page.open(four_bar.server.url)
    component = next(one for one in page.run("return stepbot.state.link.get('crank').components"))
    page.click(page.pixel_of("crank", component))
    page.wait(FACE_KNOWN)
    assert page.text("#path") == f'"{component}"'
    assert "crank" in page.text("#card")
    page.run(
        "navigator.clipboard.writeText = text => { document.body.dataset.copied = text; return Promise.resolve(); }"
    )
    page.element("#card .copy button").click()
    assert page.run("return document.body.dataset.copied") == f'"{component}"'
    page.element("#card .close").click()
    assert not page.element("#card").is_displayed()


@pytest.mark.slow
def test_click_a_bore_to_get_its_origin(page: Page, four_bar: Session) -> None:
    """A click on a cylinder shows the `origin` of its axis, and on a flat face that it has none."""
    shown = four_bar.load()  # before: a scene that arrives later would end the selection
    page.open(four_bar.server.url)
    assert shown.assembly is not None
    # A triangle of a cylinder of the crank, and one of its flat sides, wherever they are on the screen.
    crank = next(one for one in shown.assembly.components if "crank" in one.path and one.body >= 0)
    body = shown.assembly.bodies[crank.body]
    corners = body.mesh.vertices[body.mesh.faces]
    origins = {}
    for triangle in corners[:: max(1, len(corners) // 12)].tolist():
        page.run(
            "stepbot.state.select({link: 'crank', component: arguments[0], triangle: arguments[1]})",
            crank.path,
            triangle,
        )
        page.wait("return Boolean(stepbot.state.selection.face && Object.keys(stepbot.state.selection.face).length)")
        face = page.run("return stepbot.state.selection.face")
        origins[face.get("origin")] = page.text("#card")
    assert "This face has no axis." in origins.pop(None)
    assert origins
    for origin, card in origins.items():
        assert f"origin: {origin}" in card
        assert origin.startswith(f'{{axis_of: "{crank.path}"')


@pytest.mark.slow
def test_joints_of_the_sidecar_are_listed_with_their_evidence(page: Page, four_bar: Session) -> None:
    """The evidence for an axis is on the card of its joint; the loop shows its gap."""
    page.open(four_bar.server.url)
    page.element("[data-joint=crank_turn] .head button").click()
    card = page.text("#card")
    assert "ground → crank" in card
    assert "shaft of radius" in card
    page.element("[data-joint=rocker_pin] .head button").click()
    assert "closure" in page.text("#card")
    assert "gap" in page.text("#card")


@pytest.mark.slow
def test_links_can_be_hidden(page: Page, four_bar: Session) -> None:
    """A hidden link cannot be clicked; chips show collision shapes."""
    page.open(four_bar.server.url)
    at = page.pixel_of("coupler")
    page.tab("parts")
    page.run("document.querySelector('[data-link=coupler]').parentElement.querySelector('.eye').click()")
    hit = page.run("return stepbot.view.hit(...arguments)", *at)
    assert hit is None or hit["link"] != "coupler"
    page.element("[data-show=collisions]").click()
    assert page.run("return stepbot.view.visible().some(item => item.kind === 'collision')")


@pytest.mark.slow
def test_verification_appears(page: Page, four_bar: Session) -> None:
    """The table is beside the robot as soon as engines have read the files."""
    page.open(four_bar.server.url)
    assert four_bar.prove() is not None
    page.tab("proof")
    page.wait("return document.querySelectorAll('#proof tr[data-status=passed]').length > 2")
    assert "four_bar.xml mujoco" in page.text("#proof")
    assert not page.driver.find_elements("css selector", "#proof tr[data-status=failed]")


@pytest.mark.slow
def test_second_tab_and_reload(page: Page, four_bar: Session) -> None:
    """Two tabs show the same robot and move independently; a reload starts as drawn."""
    page.open(four_bar.server.url)
    first = page.driver.current_window_handle
    page.slide("crank_turn", 30.0)
    moved = page.positions()
    page.driver.switch_to.new_window("tab")
    page.open(four_bar.server.url)
    assert page.positions() != moved
    page.driver.close()
    page.driver.switch_to.window(first)
    assert page.positions() == moved
    page.driver.refresh()
    page.wait("return globalThis.stepbot?.state.scene != null")
    assert page.positions()["crank_turn"] == 0.0
    assert page.text("#live") == "live"


@pytest.mark.slow
def test_page_outlives_its_server(page: Page, four_bar: Session) -> None:
    """When the server ends the page says so, and its joints still move."""
    page.expected_errors = ["ERR_CONNECTION_REFUSED", "ERR_INCOMPLETE_CHUNKED_ENCODING", "ERR_EMPTY_RESPONSE"]
    page.open(four_bar.server.url)
    four_bar.server.close()
    page.wait("return document.querySelector('#live').textContent === 'the server has ended'")
    page.slide("crank_turn", 20.0)
    assert page.positions()["crank_turn"] == pytest.approx(0.349, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("format_", ["urdf", *(pytest.param(name, marks=pytest.mark.long) for name in ("sdf", "mjcf"))])
def test_robot_files_move(page: Page, session: Serve, tmp_path: Path, format_: str) -> None:
    """A URDF, an SDFormat and an MJCF file: every link is where the robot that was written has it, drawn and moved."""
    robot = ROBOTS["two_link_arm"]()
    for path, content in render(robot, format_, Diagnostics()).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_bytes(content)
    page.open(session(tmp_path / f"{robot.name}{FORMATS[format_].suffix}").server.url)
    names = [one["name"] for one in page.run("return stepbot.state.scene.motion.driven")]
    assert names
    for degrees in (0.0, 25.0):
        for name in names:
            page.slide(name, degrees)
        expected = link_poses(robot, page.positions())
        for link in robot.links:
            assert page.poses()[link.name][9:] == pytest.approx(expected[link.name].position, abs=1e-6)
    assert page.pixel_of(robot.links[-1].name)


@pytest.mark.slow
def test_names_cannot_become_markup(page: Page, tmp_path: Path) -> None:
    """Names of links, joints, parts and files that hold HTML are shown as they are, in every panel."""
    text = json.dumps(scene_document(ROBOTS["equipped"]()))
    names = {one["name"] for part in ("links", "connections", "frames", "sensors") for one in json.loads(text)[part]}
    for name in names:
        text = text.replace(json.dumps(name), json.dumps(name + EVIL))
    scene = json.loads(text)
    scene.update(name=EVIL, source=EVIL)
    scene["diagnostics"] = [
        {"code": "SB301", "severity": "error", "message": EVIL, "file": EVIL, "line": 1, "help": [EVIL], "notes": []}
    ]
    scene["proof"] = {
        "rows": [
            {"file": EVIL, "engine": EVIL, "version": EVIL, "against": "model", "status": "failed", "compared": [EVIL]}
            | {"worst": None, "why": EVIL}
        ],
        "overlaps": [{"links": [scene["links"][0]["name"]] * 2, "depth": 0.1}],
        "own_parsers": [],
    }
    page.open_file(tmp_path, scene)
    page.run("stepbot.state.set('names', true); stepbot.state.set('frames', true)")
    for connection in scene["connections"]:
        page.run("stepbot.state.select({connection: arguments[0]})", connection["name"])
    page.run("stepbot.state.select({link: arguments[0], component: arguments[1]})", scene["links"][0]["name"], EVIL)
    for panel in ("parts", "proof", "findings", "joints"):
        page.tab(panel)
    assert page.run("return document.querySelectorAll('img, script').length") == 2
    assert page.driver.title == EVIL
    assert EVIL in page.text("#name")


@pytest.mark.slow
def test_overlapping_links_are_red(page: Page, tmp_path: Path) -> None:
    """A click on a pair of links that overlap selects both and shows their collision shapes in red."""
    scene = scene_document(ROBOTS["four_bar"]())
    first, second = (link["name"] for link in scene["links"][1:3])
    scene["proof"] = {"rows": [], "overlaps": [{"links": [first, second], "depth": 0.0012}], "own_parsers": []}
    page.open_file(tmp_path, scene)
    page.tab("proof")
    assert "1.2 mm deep" in page.text("#proof")
    page.element("#proof button").click()
    assert page.run("return [stepbot.state.selection.overlapped, stepbot.state.selection.link]") == [first, second]
    shapes = "stepbot.view.items.filter((item) => item.kind === 'collision')"
    red = set(page.run(f"return {shapes}.filter((item) => stepbot.view.color(item)[1] < 0.2).map((item) => item.link)"))
    assert red == {first, second}
    assert red < set(page.run(f"return {shapes}.map((item) => item.link)"))
    glowing = page.run("return stepbot.view.items.filter((item) => stepbot.view.glow(item)).map((item) => item.link)")
    assert set(glowing) == red


@pytest.mark.slow
def test_nothing_is_loaded_from_elsewhere(page: Page, four_bar: Session) -> None:
    """Every request of the page goes to its own server, below its token."""
    page.open(four_bar.server.url)
    page.wait("return document.querySelector('#live').textContent === 'live'")
    loaded = page.run("return performance.getEntriesByType('resource').map(entry => entry.name)")
    assert loaded
    assert all(name.startswith(four_bar.server.url) for name in loaded)


@pytest.mark.slow
def test_command(page: Page, robot_library: Path, tmp_path: Path) -> None:
    """The command prints the address, serves until Ctrl-C, ends with exit code 0, and writes nothing."""
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    command = [sys.executable, "-m", "stepbot", "view", str(sidecar), "--no-open", "--no-verify", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=tmp_path) as running:
        assert running.stdout is not None
        lines = []
        while not lines or lines[-1] != "}\n":
            lines.append(running.stdout.readline())
        document: dict[str, Any] = json.loads("".join(lines))
        page.expected_errors = ["ERR_"]
        page.open(document["url"])
        assert page.text("#name") == "arm2"
        running.send_signal(signal.SIGINT)
        try:
            assert running.wait(timeout=30) == 0
        finally:
            running.kill()
    page.wait("return document.querySelector('#live').textContent === 'the server has ended'")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("size", [(1280, 800), (400, 800)])
def test_layout_fits_the_window(page: Page, tmp_path: Path, size: tuple[int, int]) -> None:
    """Nothing is wider than the window, and the robot keeps a good part of it."""
    page.resize(*size)
    page.open_file(tmp_path, scene_document(ROBOTS["equipped"]()))
    assert page.run("return document.documentElement.scrollWidth") <= size[0]
    box = page.run("const {width, height} = stepbot.view.canvas.getBoundingClientRect(); return [width, height]")
    assert box[0] >= min(size[0], 700)
    assert box[1] >= 260
    for panel in ("joints", "parts", "proof", "findings"):
        page.tab(panel)
        wide = "return [...document.querySelectorAll('#sections *')].filter(e => e.scrollWidth > innerWidth).length"
        assert page.run(wide) == 0


SLIDE = """<robot name="slide">
  <link name="floor"><collision><geometry><box size="1 1 0.2"/></geometry></collision></link>
  <link name="post"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="ball"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="along" type="prismatic"><parent link="floor"/><child link="post"/><axis xyz="1 0 0"/>
    <limit lower="-0.3" upper="0.3" effort="1" velocity="1"/></joint>
  <joint name="down" type="prismatic"><parent link="post"/><child link="ball"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
</robot>"""


@pytest.mark.long
def test_links_are_compared_while_they_move(page: Page, session: Serve, tmp_path: Path) -> None:
    """A ball that a slider lowers into the floor: depth and place are those of geometry, red, and gone further up."""
    urdf = tmp_path / "slide.urdf"
    urdf.write_text(SLIDE)
    page.open(session(urdf).server.url)
    page.wait("return stepbot.state.contacts && stepbot.state.contacts.length === 0")
    page.slide("along", 200.0)
    page.slide("down", 320.0)
    page.wait("return stepbot.state.contacts.length === 1")
    page.wait("return Math.abs(stepbot.state.contacts[0].depth - 0.02) < 1e-6")
    (one,) = page.run("return stepbot.state.contacts")
    assert one["links"] == ["floor", "ball"]
    x, y, z = one["point"]
    assert (x, y) == pytest.approx((0.2, 0.0), abs=1e-6)
    assert 0.08 - 1e-6 <= z <= 0.1 + 1e-6
    assert page.run("return stepbot.state.overlaps('ball') && !stepbot.state.overlaps('post')")
    page.run("stepbot.state.set('collisions', true)")
    assert page.run("return stepbot.view.contactPoints(0.01).length") > 3
    page.tab("proof")
    assert "Links that overlap in this pose" in page.text("#proof")
    assert "20 mm deep" in page.text("#proof")
    page.slide("down", 290.0)
    page.wait("return stepbot.state.contacts.length === 0")
    assert "overlap" not in page.text("#proof")


@pytest.mark.slow
def test_only_what_can_be_seen_is_drawn(page: Page, tmp_path: Path) -> None:
    """Equal parts are drawn at once, small ones have no edges, tiny ones are boxes, hidden ones are skipped."""
    row = range(30)
    spacing, disc = 0.1, Cylinder(0.03, 0.06)
    parts = [
        Visual(f"part_{i}_{j}", disc, Pose.of(position=(spacing * i, spacing * j, 0.0)), component=f"part:{i}_{j}")
        for i in row
        for j in row
    ]
    link = Link("base", visuals=tuple(parts), components=tuple(one.component for one in parts))
    page.open_file(tmp_path, scene_document(Robot("field", (link,))))
    page.run("stepbot.view.camera.look(-Math.PI / 2, 1.5533); stepbot.view.fit()")
    counted = """const {view} = stepbot; const {gl} = view.renderer; const calls = [];
      gl.drawArraysInstanced = (mode, first, corners, copies) => {
        if (mode !== gl.TRIANGLE_STRIP) calls.push([mode === gl.LINES ? "edges" : "faces", corners, copies]);
      };
      view.draw(); delete gl.drawArraysInstanced; return calls;"""
    page.run("stepbot.view.camera.zoom(4)")  # each part is a few pixels large
    ((kind, of_disc, copies),) = page.run(counted)
    assert (kind, copies) == ("faces", 900)
    page.run("stepbot.view.camera.zoom(4)")
    assert page.run(counted) == [["faces", 36, 900]]
    page.run("stepbot.view.camera.zoom(1 / 4)")
    page.run("stepbot.view.camera.zoom(0.03)")
    (kind, corners, near), (other, _, with_edges) = page.run(counted)
    assert (kind, other, corners) == ("faces", "edges", of_disc)
    assert 4 <= near == with_edges < 300
    seen = """const {view} = stepbot; const {left, top, width, height} = view.canvas.getBoundingClientRect();
      const {x, y} = view.camera.project(arguments[0]);
      return view.hit(left + x * width, top + y * height)?.component;"""
    page.run("stepbot.view.fit()")
    for i, j in ((0, 0), (13, 7), (29, 29)):
        assert page.run(seen, [spacing * i, spacing * j, 0.03]) == f"part:{i}_{j}"
    assert page.run(seen, [spacing * 3.5, spacing * 3.5, 0.03]) is None


@pytest.mark.slow
def test_links_and_joints_are_listed_by_module(page: Page, tmp_path: Path) -> None:
    """Under a heading for each module, the innermost; those of the composing file are above all headings."""
    box = (Visual("v", Cylinder(0.1, 0.2)),)
    names = ("base", "arm_upper", "arm_hand_palm", "arm_hand_finger")
    joints = tuple(
        Joint(
            f"{child}_joint", JointKind.REVOLUTE, parent, child, Pose.from_xyz_rpy((0.0, 0.0, 0.3)), limit=Limit(-1, 1)
        )
        for parent, child in pairwise(names)
    )
    modules = (Module("arm", "arm.urdf", "arm_", names[1:]), Module("arm/hand", "hand.urdf", "arm_hand_", names[2:]))
    robot = Robot("r", tuple(Link(name, visuals=box) for name in names), joints, modules=modules)
    page.open_file(tmp_path, scene_document(robot))
    rows = "return [...document.querySelectorAll(`#${arguments[0]} :is(h4.module, [data-${arguments[1]}])`)]"
    texts = f"{rows}.map(one => one.dataset[arguments[1]] ?? one.textContent)"
    page.tab("parts")
    expected = ["base", "arm", "arm_upper", "arm/hand", "arm_hand_palm", "arm_hand_finger"]
    assert page.run(texts, "parts", "link") == expected
    page.tab("joints")
    listed = page.run(texts, "joints", "slider")
    assert [name for name in listed if name in ("arm", "arm/hand") or name.endswith("_joint")] == [
        "arm",
        "arm_upper_joint",
        "arm/hand",
        "arm_hand_palm_joint",
        "arm_hand_finger_joint",
    ]


@pytest.mark.slow
def test_many_parts_of_modest_size_have_fewer_triangles(page: Page, tmp_path: Path) -> None:
    """A field of 900 balls is drawn with a third of their triangles, and looks like it has all; near ones have them."""
    row = range(30)
    parts = [
        Visual(f"ball_{i}_{j}", Sphere(0.045), Pose.of(position=(0.1 * i, 0.1 * j, 0.0)), component=f"ball:{i}_{j}")
        for i in row
        for j in row
    ]
    link = Link("base", visuals=tuple(parts), components=tuple(one.component for one in parts))
    page.open_file(tmp_path, scene_document(Robot("field", (link,))))
    page.run("stepbot.view.camera.look(-Math.PI / 2, 1.2); stepbot.view.fit(); stepbot.view.camera.zoom(2)")
    compared = """const {view} = stepbot; const {gl} = view.renderer; const [all, fewer] = [[], []];
      const drawn = (counts) => {
        gl.drawArraysInstanced = function (mode, first, corners, copies) {
          if (mode === gl.TRIANGLES) counts.push(corners / 3 * copies);
          return WebGL2RenderingContext.prototype.drawArraysInstanced.call(gl, mode, first, corners, copies);
        };
        view.draw();
        delete gl.drawArraysInstanced;
        const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
        gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels;
      };
      const near = drawn(fewer); view.coarse = ({mesh}) => mesh; const exact = drawn(all); delete view.coarse;
      let [covered, other] = [0, 0];
      for (let i = 3; i < exact.length; i += 4) {
        const [a, b] = [near, exact].map((one) => one[i] > 128);
        covered += b; other += a !== b;
      }
      return [all, fewer].map((counts) => counts.reduce((a, b) => a + b, 0)).concat(covered, other);"""
    exact, fewer, covered, other = page.run(compared)
    assert exact > 500_000
    assert fewer < exact / 3
    assert covered > 5_000
    assert other < 0.05 * covered
    page.run("stepbot.view.camera.zoom(0.05)")
    exact, fewer, *_ = page.run(compared)
    assert fewer == exact > 0
