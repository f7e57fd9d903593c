"""The report as a page: its numbers are those of report.json, its names are text, and it refers to no other file."""

import json
import re
from collections.abc import Mapping
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from lxml import html
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostic, Span
from stepbot.pipeline.conversion import REPORT, REPORT_PAGE, Options
from stepbot.pipeline.scenes import robot_of_assembly
from stepbot.pipeline.stages import inspect, produce
from stepbot.report.robot import Check, Report, Status
from stepbot.report.words import sheet_blocks
from stepbot.robot.datasheet import data_sheet
from stepbot.robot.joint_table import Basis, Evidence, JointRow
from stepbot.robot.model import Robot
from stepbot.viewing.report.page import Entry, index_page, report_page
from tests.robots import ROBOTS

EVIL = '</script><script>alert(1)</script><b onload="x">&\''


class Pages(Struct, frozen=True):
    """What one conversion wrote."""

    text: str
    page: Any
    """The parsed page."""
    report: Mapping[str, Any]
    """``report.json``."""


@pytest.fixture(scope="module")
def arm(robot_library: Path) -> Pages:
    """The arm of the library, verified in MuJoCo."""
    options = Options(Path("out"), formats=("mjcf",), html=True)
    conversion = produce(robot_library / "stepbot_arm2" / "arm2.robot.yaml", options)
    text = conversion.files[REPORT_PAGE].decode()
    return Pages(text, html.fromstring(text), json.loads(conversion.files[REPORT]))


def values(row: Any) -> list[float]:
    """The exact numbers of a row."""
    return [float(value) for value in row.xpath("./td/@data-value")]


@pytest.mark.slow
def test_masses_are_those_of_the_report(arm: Pages) -> None:
    """Of every link, of every component that adds to it, and in total."""
    robot = arm.report["robot"]
    rows = {row.get("data-link"): row for row in arm.page.xpath("//*[@id='mass-table']//tr[@data-link]")}
    assert list(rows) == [link["name"] for link in robot["links"]]
    for link in robot["links"]:
        row = rows[link["name"]]
        assert values(row) == [link["mass"]]
        parts = row.xpath(".//details//tbody/tr")
        assert [part.xpath("string(td[1])") for part in parts] == [one["component"] for one in link["sources"]]
        for part, source in zip(parts, link["sources"], strict=True):
            shown = [float(value) for value in part.xpath("td[2]/@data-value | td[3]/@data-value")]
            assert shown == [value for value in (source["mass"], source["density"]) if value is not None]
            assert part.xpath("string(td[5])") == source["origin"]
    (total,) = arm.page.xpath("//*[@id='mass-table']//tr[@class='total']")
    assert values(total) == [pytest.approx(robot["mass"], rel=1e-12)]


@pytest.mark.slow
def test_data_sheet_is_that_of_the_command(arm: Pages, robot_library: Path) -> None:
    """Each row of `stepbot datasheet` is in the page; the picture of a workspace is as wide as its farthest band."""
    conversion = produce(robot_library / "stepbot_arm2" / "arm2.robot.yaml", Options(Path("out"), verify=False))
    assert conversion.robot is not None
    sheet = data_sheet(conversion.robot)
    (section,) = arm.page.xpath("//*[@id='data-sheet']")
    rows = {tuple(cell.text_content() for cell in row.xpath("./th | ./td")) for row in section.xpath(".//tbody/tr")}
    tables = [block for block in sheet_blocks(sheet) if not isinstance(block, str)]
    assert {row for _, listed in tables for row in listed} == rows
    assert len(section.xpath(".//svg[@class='reach']")) == len(sheet.arms)
    for arm_, picture in zip(sheet.arms, section.xpath(".//svg[@class='reach']"), strict=True):
        bands = [(float(r.get("x")), float(r.get("width"))) for r in picture.xpath("./rect")]
        assert len(bands) == len(arm_.workspace)
        scale = float(picture.get("width")) / max(far for _, _, far in arm_.workspace)
        for (x, width), (_, near, far) in zip(bands, arm_.workspace, strict=True):
            assert (x, width) == pytest.approx((scale * near, scale * (far - near)), rel=0.01, abs=0.2)


@pytest.mark.slow
def test_joints_are_those_of_the_report(arm: Pages) -> None:
    """Names, types, limits, and how each axis was found."""
    joints = {joint["name"]: joint for joint in arm.report["robot"]["joints"]}
    rows = {row.get("data-joint"): row for row in arm.page.xpath("//*[@id='joint-table']//tr[@data-joint]")}
    assert list(rows) == [row["name"] for row in arm.report["joint_table"]]
    for found in arm.report["joint_table"]:
        row, joint = rows[found["name"]], joints[found["name"]]
        assert row.xpath("string(td[1])") == found["kind"]
        assert row.xpath("string(td[2])") == f"{found['parent']} → {found['child']}"
        if joint["mimic"] is None:
            assert values(row) == [joint["limits"]["lower"], joint["limits"]["upper"]]
        for face in found["faces"]:
            assert f"of radius {1e3 * face['radius']:.10g} mm" in row.xpath("string(td[7])")


def test_checks_are_those_of_the_report(arm: Pages) -> None:
    """Every check once, with its deviation and tolerance; the counts; a dot for each number."""
    rows = arm.page.xpath("//*[@id='proof-table']//tbody/tr")
    shown = sorted((row.xpath("string(th)"), row.xpath("string(td[1])"), tuple(values(row))) for row in rows)
    checks = arm.report["checks"]
    assert shown == sorted(
        (
            check["quantity"],
            check["status"],
            tuple(check[name] for name in ("deviation", "tolerance") if check[name] is not None),
        )
        for check in checks
    )
    passed = arm.report["summary"]["passed"]
    assert f"{passed} passed" in arm.page.xpath("string(//*[@id='proof-table']/p)")
    measured = [
        one for one in checks if one["status"] == "passed" and one["deviation"] is not None and one["tolerance"]
    ]
    assert len(arm.page.xpath("//*[@id='proof-table']//*[local-name()='circle']")) == len(measured) > 0


def test_the_page_is_complete_in_one_file(arm: Pages) -> None:
    """It refers to nothing but places in itself, may load nothing, and is far below 3 MB."""
    assert arm.page.xpath("//@src | //link | //iframe | //img | //base") == []
    assert all(target.startswith("#") for target in arm.page.xpath("//@href"))
    for target in arm.page.xpath("//@href"):
        assert arm.page.xpath(f"//*[@id='{target[1:]}']")
    style = arm.page.xpath("string(//style)")
    assert "url(" not in style
    assert "@import" not in style
    assert re.search(r"https?://", arm.text) is None
    (policy,) = arm.page.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
    assert policy.startswith("default-src 'none'")
    assert "connect-src" not in policy
    assert arm.page.xpath("//@style") == []  # the policy forbids them
    assert len(arm.text) < 1_000_000


class Elements(HTMLParser):
    """Tags and texts of a page, as a browser parses it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.texts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Remember the tag; no attribute is a handler."""
        assert not any(name.startswith("on") for name, _ in attrs)
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        """Remember the text."""
        self.texts.append(data)


def evil_report() -> tuple[Robot, Report, tuple[Diagnostic, ...]]:
    """A robot, a report and diagnostics whose every text is markup."""
    robot = ROBOTS["two_link_arm"]()
    links = {link.name: f"{EVIL}{i}" for i, link in enumerate(robot.links)}
    robot = replace(
        robot,
        name=EVIL,
        source=EVIL,
        links=tuple(replace(link, name=links[link.name]) for link in robot.links),
        joints=tuple(
            replace(joint, name=f"{EVIL}{joint.name}", parent=links[joint.parent], child=links[joint.child])
            for joint in robot.joints
        ),
        frames=(),
        actuators=(),
        sensors=(),
    )
    rows = tuple(
        JointRow(joint.name, EVIL, EVIL, EVIL, None, None, evidence=Evidence(Basis.GIVEN, EVIL, doubt=EVIL))
        for joint in robot.joints
    )
    checks = (Check(EVIL, EVIL, EVIL, EVIL, Status.FAILED, 2.0, 1.0, EVIL, EVIL, EVIL, EVIL),)
    report = Report(checks, {EVIL: EVIL}, 2, inputs={EVIL: EVIL}, joint_table=rows, robot=robot)
    found = (Diagnostic("SB301", "error", EVIL, Span(EVIL, 3, 2, 5), help=(EVIL,), notes=(EVIL,)),)
    return robot, report, found


def test_no_name_becomes_markup() -> None:
    """A robot called `<script>` is text in every place of the page."""
    robot, report, found = evil_report()
    text = report_page(robot, report, found, {(EVIL, 3): EVIL}).decode()
    parsed = Elements(text)
    assert parsed.tags.count("script") == 2
    assert "onload" not in re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL).replace("&lt;b onload=", "")
    assert EVIL not in text
    assert sum(EVIL in shown for shown in parsed.texts) > 10


def test_a_diagnostic_has_its_source_line() -> None:
    """With the place marked, and the folder of the file left out."""
    robot = ROBOTS["one_link"]()
    found = (Diagnostic("SB301", "error", "no such part", Span("/robots/arm.robot.yaml", 6, 4, 8)),)
    text = report_page(robot, Report(robot=robot), found, {("/robots/arm.robot.yaml", 6): "ab  part: x"}).decode()
    page = html.fromstring(text)
    (frame,) = page.xpath("//*[@id='finding-list']//pre")
    assert frame.text_content() == "6 │ ab  part: x"
    assert frame.xpath("string(mark)") == " par"
    assert "arm.robot.yaml:6" in page.xpath("string(//*[@id='finding-list'])")
    assert "/robots" not in text


def test_the_same_robot_gives_the_same_bytes() -> None:
    """No time, no set order."""
    robot, report, found = evil_report()
    assert report_page(robot, report, found, {}) == report_page(robot, report, found, {})


@pytest.mark.long
@pytest.mark.parametrize("name", ["low_cost_robot_follower.step", "so101_assembly.step"])
def test_a_real_arm_is_below_three_megabytes(name: str, corpus: Path, tmp_path: Path) -> None:
    """With all of its parts; the page says how far the displayed meshes are from the exact ones."""
    assembly = inspect(corpus / name, Options(tmp_path)).assembly
    assert assembly is not None
    robot = robot_of_assembly(assembly, "arm")
    page = report_page(robot, Report(robot=robot), (), {})
    assert len(page) < 3_000_000
    faces = sum(len(asset.mesh.faces) for asset in robot.meshes)
    assert re.search(rf"The picture has .*\b{faces} triangles", page.decode())


def test_the_index_counts_one_robot() -> None:
    """The page of a batch of one robot has `1 robot` as its heading."""
    assert "<h2>1 robot</h2>" in index_page([Entry("arm", "converted")]).decode()
    assert "<h2>2 robots, 1 failed</h2>" in index_page([Entry("arm", "converted"), Entry("leg", "failed")]).decode()
