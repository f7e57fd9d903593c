"""Robots of the corpus, made from their STEP files in the page: by clicks and typed values, without touching YAML."""

import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.drafting import draft_step, write_draft
from stepbot.pipeline.scenes import show
from stepbot.runtime.cache import Cache
from stepbot.serving.session import Session

from .page import Page
from .test_edit_panel import ENTER, TAB, settled

pytestmark = [
    pytest.mark.long,
    pytest.mark.parametrize("driver", ["chromium", "firefox"], indirect=True, scope="session"),
]

COUNTS = {"pimouse": (14, 6), "so101": (16, 18), "follower": (39, 33)}
"""For each robot the presses of the mouse, and the lines of its sidecar, without comments, that are not those of the
draft; as in docs/view.md."""
RIM, TYRE = "Whreel5_ネジ穴位置改良", "タイヤφ44用7.5mm幅_RT-T75-44-R"
FOLLOWER = Path(__file__).parents[1] / "corpus" / "low_cost_robot_follower.robot.yaml"
TURNED = ("XL430_to_XL330_new_connector_joint", "XL330_to_XL330_straight_joint", "servo_connector_angle_joint")
"""Joints of the follower that its truth turns the other way."""

COUNTING = """
const { dataset } = document.body;
dataset.clicks = 0;
addEventListener("pointerdown", (event) => { dataset.clicks = Number(dataset.clicks) + event.isTrusted; }, true);
"""
"""In the document: what a script leaves in its globals is gone in Firefox."""
FRICTION = "#todo [data-kind=review]:not(:has(~ [data-kind=review])) [data-decide=right]"
"""The answer to the last mark, which is that of friction."""
LISTED = "return stepbot.state.writtenOf === stepbot.state.scene"
"""The list of decisions is that of the robot that is shown."""


class Drafting(Struct, frozen=True):
    """A robot that is drafted and then made in the page."""

    page: Page
    session: Session
    options: Options
    sidecar: Path
    before: list[str]

    def click(self, selector: str) -> None:
        """Click what is there once the page lists what is in the file."""
        settled(self.page)
        self.page.wait(LISTED)
        self.page.wait("return document.querySelector(arguments[0])", selector)
        self.page.element(selector).click()

    def type_in(self, selector: str, text: str) -> None:
        """Click a field and type."""
        self.click(selector)
        self.page.element(selector).send_keys(text)

    def select(self, kind: str, name: str) -> None:
        """Click a joint or part in its list."""
        self.click(f'#joints [data-joint="{name}"] button' if kind == "joints" else f'#parts [data-component="{name}"]')

    def keep_draft(self) -> None:
        """The questions of the draft are answered as drafted."""
        self.click("#todo [data-kind=question] [data-decide=keep]")

    def ignore_findings(self) -> None:
        """Ignore what is left."""
        settled(self.page)
        self.page.wait(LISTED)
        while self.page.driver.find_elements("css selector", "#todo [data-decide=ignore]"):
            before = self.sidecar.read_bytes()
            self.click("#todo [data-decide=ignore]")
            settled(self.page)
            self.page.wait(LISTED)
            assert self.sidecar.read_bytes() != before
        assert "Nothing is left to decide." in self.page.text("#todo")

    def convert(self) -> None:
        """Convert, and wait for the proof."""
        self.page.tab("proof")
        self.click("#convert")
        self.page.wait("return document.querySelector('#converted').textContent.includes('the files are in')")

    def finish(self, name: str, truth: str) -> str:
        """Compare the robot with that of another sidecar, and what it took with what the documentation says."""
        assert (self.options.output / f"{name}.urdf").is_file()
        text = self.sidecar.read_text(encoding="utf-8")
        assert "REVIEW" not in text.split("version: 1")[1]
        assert "todo" not in text.split("version: 1")[1]
        other = self.sidecar.with_name("truth.robot.yaml")
        other.write_text(truth, encoding="utf-8")
        assert_same(facts(self.sidecar, self.options), facts(other, self.options))
        before = {bare(line) for line in self.before}
        changed = [line for line in map(bare, text.split("\n")) if line and line not in before]
        assert (self.page.run("return Number(document.body.dataset.clicks)"), len(changed)) == COUNTS[name], "\n".join(
            changed
        )
        return text


@pytest.fixture
def drafting(page: Page, tmp_path: Path) -> Iterator[Callable[[Path, str], Drafting]]:
    """Draft a STEP file under a name, and open it in the page."""

    @contextmanager
    def opened(source: Path, name: str) -> Iterator[Drafting]:
        step, sidecar = tmp_path / f"{name}.step", tmp_path / f"{name}.robot.yaml"
        shutil.copy(source, step)
        options = Options(output=tmp_path / name, cache=Cache(tmp_path / "cache"))
        draft = draft_step(step, options).draft
        assert draft is not None
        write_draft(draft, sidecar, step, "", diagnostics := Diagnostics())
        assert not diagnostics.has_errors
        session = Session(sidecar, options, edits=True)
        try:
            session.load()
            session.server.start()
            page.open(session.server.url)
            page.wait("return document.querySelectorAll('#todo .decision').length > 2")
            page.run(COUNTING)
            yield Drafting(page, session, options, sidecar, sidecar.read_text(encoding="utf-8").split("\n"))
            page.driver.get("about:blank")  # a comparison of links under way would be refused by an ended server
        finally:
            session.close()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tests.browser.page.PATIENCE", 120.0)  # drafts of arms with many faces, converted and proven
        with ExitStack() as running:
            yield lambda source, name: running.enter_context(opened(source, name))


def bare(line: str) -> str:
    """A line without its comment."""
    return re.sub(r"(^|\s+)#( .*)?$", "", line).rstrip()


Facts = dict[frozenset[str], dict[str, Any]]


def facts(sidecar: Path, options: Options) -> Facts:
    """For the parts of each link its mass [kg], and how it moves against which other parts."""
    scene = show(sidecar, options).scene
    assert scene is not None
    parts = {link["name"]: frozenset(link["components"]) for link in scene["links"]}
    found: Facts = {parts[link["name"]]: {"mass": link["mass"]["mass"]} for link in scene["links"]}
    for one in scene["connections"]:
        numbers = [float(x) for x in re.findall(r"-?[\d.]+(?:e-?\d+)?", one["at"])]
        found[parts[one["child"]]] |= {
            "parent": parts[one["parent"]],
            "kind": one["kind"],
            "at": numbers,
            "along": _direction(one["along"]),
            "limits": [one["limits"][end] for end in ("lower", "upper")] if one["limits"] else None,
        }
    return found


def _direction(text: str) -> list[float]:
    if text[1:] in ("x", "y", "z"):
        return [float(f"{text[0]}1") if text[1] == letter else 0.0 for letter in "xyz"]
    return [float(x) for x in re.findall(r"-?[\d.]+(?:e-?\d+)?", text)]


def assert_same(made: Facts, true: Facts) -> None:
    """The same links, masses, axes as lines with a direction, and limits."""
    assert {min(parts): parts for parts in made} == {min(parts): parts for parts in true}
    for parts, expected in true.items():
        one = made[parts]
        assert one["mass"] == pytest.approx(expected["mass"], rel=1e-6)
        if "kind" not in expected:
            assert "kind" not in one
            continue
        assert (one["parent"], one["kind"]) == (expected["parent"], expected["kind"])
        assert one["along"] == pytest.approx(expected["along"], abs=1e-4)
        apart = [a - b for a, b in zip(one["at"], expected["at"], strict=True)]
        along = sum(a * b for a, b in zip(apart, expected["along"], strict=True))
        assert [a - along * b for a, b in zip(apart, expected["along"], strict=True)] == pytest.approx(
            [0, 0, 0], abs=2e-3
        )
        assert one["limits"] == pytest.approx(expected["limits"], abs=1e-4)


def test_pimouse(drafting: Callable[[Path, str], Drafting], corpus: Path) -> None:
    """Rims join their tyres, the wheels are confirmed, the plastic gets its density, and the robot is proven."""
    one = drafting(corpus / "assemblies" / "pimouse.step", "pimouse")
    page = one.page
    one.keep_draft()
    page.tab("parts")
    page.element("#search").send_keys("Whreel5")
    for place, link in (("1", "wheel"), ("2", "wheel_2")):
        one.select("parts", f"{RIM}:{place}")
        page.element("#card [data-edit=link]").send_keys(link)
        one.click("#card [data-edit=assign]")
        page.wait("return stepbot.state.selection.link === arguments[0]", link)
    page.tab("todo")
    one.click("#todo [data-kind=axis] [data-decide=right]")
    for _ in range(3):  # the density until then, and frictions
        one.click("#todo [data-kind=review] [data-decide=right]")
    page.wait("return document.querySelector(\"#todo [data-set='defaults.density']\")")
    page.element("#todo [data-set='defaults.density']").send_keys("1040 kg/m^3" + ENTER)
    one.ignore_findings()
    one.convert()
    wheels = "".join(f'  {name}: {{parts: ["{RIM}:{at}", "{TYRE}:{at}"]}}\n' for name, at in (("r", 1), ("l", 2)))
    pose = "origin: {xyz: [0, 0, 24 mm]}, axis: y"
    joints = "".join(f"  w{name}: {{type: continuous, parent: base, child: {name}, {pose}}}\n" for name in "rl")
    head = "version: 1\nrobot: pimouse\nbase: floating\nstep: pimouse.step\ndefaults: {density: 1040}\n"
    truth = f"{head}links:\n  base: {{rest: true}}\n{wheels}joints:\n{joints}"
    text = one.finish("pimouse", truth)
    for link, place in (("wheel", "1"), ("wheel_2", "2")):
        parts = re.search(rf"\n  {link}:\n    parts: (.*)", text)
        assert parts is not None
        assert parts[1] == f'["{TYRE}:{place}", "{RIM}:{place}"]'


def test_so101(drafting: Callable[[Path, str], Drafting], corpus: Path) -> None:
    """Its draft has all links; limits, motors and a density are typed, and three joints turned."""
    one = drafting(corpus / "so101_assembly.step", "so101")
    one.click(FRICTION)
    names = one.page.run("return stepbot.state.scene.connections.map(one => one.name)")
    one.type_in(f"#todo [data-limits='{names[0]} lower']", TAB.join(["-3 rad", "3 rad"] * len(names)) + TAB)
    one.page.tab("joints")
    for name in (names[0], *names[-2:]):
        one.select("joints", name)
        one.click("#card [data-edit=flip]")
    one.page.tab("todo")
    one.type_in("#todo [data-decide=model]", "STS3215-7.4V")
    one.click("#todo [data-decide=drive]")
    one.type_in("#todo [data-set='defaults.density']", "1000 kg/m^3" + ENTER)
    one.ignore_findings()
    one.convert()
    truth = (corpus / "joints" / "so101.robot.yaml").read_text(encoding="utf-8")
    text = one.finish("so101", truth.replace("../so101_assembly.step", "so101.step"))
    assert (
        "\n\nactuators:\n  Rotation_Pitch_SO101_motor: {joint: Rotation_Pitch_SO101_joint, motor: STS3215-7.4V" in text
    )


def test_follower(drafting: Callable[[Path, str], Drafting], corpus: Path) -> None:
    """Five parts move to their links, three axes turn, motors get their mass, and the rest is of plastic."""
    one = drafting(corpus / "low_cost_robot_follower.step", "follower")
    page = one.page
    one.click(FRICTION)
    for _ in range(2):
        one.click("#todo [data-kind=axis] [data-decide=right]")
    limits = {"rotation_connector_joint": (-150, 150), "XL430_to_XL330_new_connector_joint": (-60, 100)}
    limits |= {"XL330_to_XL330_straight_joint": (-90, 60), "servo_connector_angle_joint": (-95, 95)}
    limits |= {"static_side_joint": (-150, 150), "moving_side_joint": (-3, 100)}
    page.tab("joints")
    for name in TURNED:
        one.select("joints", name)
        one.click("#card [data-edit=flip]")
    page.tab("todo")
    typed = [str(end) for ends in limits.values() for end in ends]
    one.type_in(f"#todo [data-limits='{next(iter(limits))} lower']", TAB.join(typed) + TAB)
    one.type_in("#todo [data-kind=motor] [data-decide=model]", "XL330-M288")
    for _ in range(2):
        one.click("#todo [data-decide=drive]")
    one.type_in("#todo [data-set='defaults.density']", "1240 kg/m^3" + ENTER)
    one.type_in("#todo [data-set='step_density']", "ignore")
    page.tab("parts")
    for sought, mass in (("XL-430_new:1/", "57.2 g"), ("XL,XC-330:6/", "18 g")):
        page.element("#search").clear()
        page.element("#search").send_keys(sought)
        one.click(f"#parts [data-component^='{sought}']")
        one.click(f"#card [data-above='{sought[:-1]}']")
        one.type_in("#card [data-sheet^='parts.'] [data-set$='.mass']", mass + ENTER)
    moved = {
        "XL-430_new:2/DC11_A01_IDLER_SCREW/": "XL430_to_XL330_new_connector",
        "XL,XC-330:8/BTS2_M2_6X8:1/": "servo_connector_angle",
        "XL,XC-330:8/DC15_A01_HORN_DUMMY": "servo_connector_angle",
    }
    for sought, link in moved.items():
        page.element("#search").clear()
        page.element("#search").send_keys(sought)
        one.click(f"#parts [data-component^='{sought}']")
        if sought.endswith("/"):
            one.click(f"#card [data-above='{sought[:-1]}']")
        page.element("#card [data-edit=link]").send_keys(link)
        one.click("#card [data-edit=assign]")
        settled(page)
    page.tab("todo")
    one.ignore_findings()
    one.convert()
    one.finish(
        "follower", FOLLOWER.read_text(encoding="utf-8").replace("low_cost_robot_follower.step", "follower.step")
    )
