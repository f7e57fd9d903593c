"""The report: rows for the terminal, JSON that conforms to its schema, deterministic bytes."""

import json
from math import inf, pi
from pathlib import Path

import jsonschema
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.inertia import MassProperties
from stepbot.report.document import report_bytes, report_document
from stepbot.report.robot import Check, MeasuredBody, Report, Status
from stepbot.robot.joint_table import Basis, Evidence, JointRow, Rival, Side
from stepbot.robot.model import ComponentMass, Limit
from tests.conftest import ReadDiagnostics
from tests.robots import ROBOTS, four_bar, two_link_arm

SCHEMA = Path(__file__).parents[3] / "schemas" / "report-1.schema.json"
PASSED = Check("a.urdf", "urdf", "mujoco", "mass", Status.PASSED, 2e-16, 1e-9, "kg", "mass of link 'arm'")
NEARER = Check("a.urdf", "urdf", "mujoco", "meshes", Status.PASSED, 2e-8, 1e-6, "m", "visual box of link 'arm'")
NAMES = Check("a.urdf", "urdf", "mujoco", "links", Status.PASSED)
NOT_RUN = Check("a.urdf", "urdf", "mujoco", "mimic", Status.NOT_RUN, why="mujoco does not tell")
FAILED = Check("a.sdf", "sdf", "reader", "mass", Status.FAILED, 0.5, 1e-9, "kg", "mass of link 'arm'", why="too heavy")
ABSENT = Check("a.xml", "mjcf", "mujoco", "load", Status.NOT_RUN, why="mujoco is not installed")


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    """A validator for the schema, which is valid itself."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def faults(validator: jsonschema.Draft202012Validator, document: object) -> list[str]:
    """Errors of a report by the schema, with their places."""
    return [f"{fault.json_path}: {fault.message}" for fault in validator.iter_errors(document)]


def test_one_row_per_file_and_engine() -> None:
    """Rows are in the order of the checks; failed takes precedence over passed, passed over not run."""
    rows = Report((NAMES, PASSED, NEARER, NOT_RUN, FAILED, ABSENT)).rows()
    assert [(row.file, row.engine, row.status) for row in rows] == [
        ("a.urdf", "mujoco", Status.PASSED),
        ("a.sdf", "reader", Status.FAILED),
        ("a.xml", "mujoco", Status.NOT_RUN),
    ]
    assert rows[0].compared == ("links", "mass", "meshes")
    assert rows[0].why == "mimic not run: mujoco does not tell"
    assert rows[1].why == "mass: too heavy"
    assert rows[2].compared == ()
    assert rows[2].why == "load not run: mujoco is not installed"


def test_the_worst_is_the_nearest_to_its_tolerance() -> None:
    """The worst check is the nearest to its tolerance; of a failed row, the worst failed one."""
    rows = Report((PASSED, NEARER, replace(FAILED, file="a.urdf", engine="mujoco"))).rows()
    assert rows[0].worst is not None
    assert rows[0].worst.quantity == "mass"
    assert Report((PASSED, NEARER)).rows()[0].worst == NEARER
    assert Report((NAMES,)).rows()[0].worst is None


def test_equal_reasons_are_merged() -> None:
    """Equal reasons are merged, with all their quantities."""
    row = Report((NOT_RUN, replace(NOT_RUN, quantity="limits"))).rows()[0]
    assert row.why == "mimic, limits not run: mujoco does not tell"


def test_files_compared_with_several_others_have_several_rows() -> None:
    """Checks against several references have several rows."""
    assert len(Report((PASSED, replace(PASSED, against="b.urdf (mujoco)"))).rows()) == 2


def test_failed_means_a_failed_check() -> None:
    """A report fails by a failed check, not by one that was not run."""
    assert Report((FAILED, PASSED)).failed
    assert not Report((PASSED, NOT_RUN)).failed


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_keeps_the_schema(name: str, validator: jsonschema.Draft202012Validator) -> None:
    """Reports of all robots conform to the schema: loops, mimics, frames, infinite limits."""
    robot = ROBOTS[name]()
    report = Report((PASSED, NOT_RUN, FAILED), {"mujoco": "4.0"}, 1, ("one",), (("a", "b", None),), robot=robot)
    assert faults(validator, json.loads(report_bytes(report, Diagnostics()))) == []


def test_a_full_report_keeps_the_schema(
    validator: jsonschema.Draft202012Validator, diagnostics: ReadDiagnostics
) -> None:
    """A report with mass sources, measured bodies, names, notes and diagnostics conforms to the schema."""
    diagnostics.add("SB810", "links overlap", Span("arm.step", 3, 4), help=["move them"], notes=["by 1 mm"])
    source = ComponentMass("arm/upper", 0.9, 2700.0, 0.9 / 2700.0, "parts rule '**'", "mesh")
    given = ComponentMass("arm/motor", 0.1, None, 5e-5, "parts rule 'motor'", "given")
    robot = two_link_arm()
    links = (replace(robot.links[0], masses=(source, given), components=("arm/upper",)), *robot.links[1:])
    measured = MassProperties.of(1e-4, (0, 0, 0), [[0] * 3] * 3)
    body = MeasuredBody("upper", 2, measured, None, None, None, measured, "mesh")
    report = Report(
        (PASSED,),
        robot=replace(robot, links=links),
        notes={"a.sdf in pybullet": ("a copy",)},
        names={"a": "b"},
        bodies=(body,),
    )
    document = report_document(report, diagnostics)
    assert faults(validator, document) == []
    assert document["diagnostics"][0]["line"] == 3
    assert [one["density"] for one in document["robot"]["links"][0]["sources"]] == [2700.0, None]


def test_joint_table_keeps_the_schema(validator: jsonschema.Draft202012Validator) -> None:
    """Rows of the joint table conform to the schema, with all optional values and with none."""
    sides = (Side("a/pin", 0.004, bore=False), Side("b/hub", 0.0041, bore=True))
    rival = Rival(Basis.TOUCH, (0.0, 0.0, 0.1), (0.0, 0.0, 1.0), (0.002,), 0.5)
    fit = Evidence(Basis.FIT, "axis", sides, 0.01, rivals=(rival,), doubt="a wider axis")
    full = JointRow("j", "universal", "a", "b", (0.0, 0.0, 0.1), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), evidence=fit)
    document = report_document(Report(joint_table=(full, JointRow("k", "fixed", "a", "b", None, None))), Diagnostics())
    assert faults(validator, document) == []
    assert document["joint_table"][0]["clearance"] == pytest.approx(1e-4)
    assert [row["basis"] for row in document["joint_table"]] == ["fit", "file"]


def test_files_without_a_robot_keep_the_schema(validator: jsonschema.Draft202012Validator) -> None:
    """The report of a comparison of files, which has no robot, conforms to the schema."""
    document = report_document(Report((PASSED, FAILED, ABSENT)), Diagnostics())
    assert faults(validator, document) == []
    assert document["robot"] is None
    assert document["summary"] == {"passed": 1, "failed": 1, "not_run": 1, "passed_by_own_parsers": 0, "ignored": {}}


def test_checks_by_own_parsers_only_are_counted_separately() -> None:
    """Checks passed in stepbot's own parsers only are counted as passed, and separately."""
    read_back = replace(PASSED, file="a.sdf", format="sdf", engine="reader")
    report = Report(
        (PASSED, read_back, replace(read_back, file="a.urdf", engine="extensions"), FAILED),
        own_parsers=("reader", "extensions"),
    )
    assert report_document(report, Diagnostics())["summary"] == {
        "passed": 3,
        "failed": 1,
        "not_run": 0,
        "passed_by_own_parsers": 2,
        "ignored": {},
    }


def test_the_schema_describes_everything(validator: jsonschema.Draft202012Validator) -> None:
    """The schema allows no further key and requires all."""
    document = report_document(Report((PASSED,), robot=four_bar()), Diagnostics())
    for change in (lambda d: d.pop("checks"), lambda d: d["robot"]["links"][0].update(weight=1)):
        broken = json.loads(json.dumps(document))
        change(broken)
        assert faults(validator, broken) != []


def test_what_is_infinite_is_null() -> None:
    """Infinity is null in JSON."""
    robot = two_link_arm()
    joint = replace(robot.joints[0], limit=Limit(-inf, 1.0))
    document = report_document(Report(robot=replace(robot, joints=(joint, robot.joints[1]))), Diagnostics())
    limits = document["robot"]["joints"][0]["limits"]
    assert limits == {"lower": None, "upper": 1.0, "velocity": None, "effort": None}
    infinite = report_document(Report((replace(FAILED, deviation=inf),)), Diagnostics())
    assert infinite["checks"][0]["deviation"] is None


def test_the_whole_is_the_sum_of_the_links_as_drawn() -> None:
    """Mass, centre and inertia of the whole robot are those of the drawn pose, which is not q = 0."""
    robot = two_link_arm()
    document = report_document(Report(robot=robot), Diagnostics())["robot"]
    assert document["mass"] == pytest.approx(sum(link.mass_properties.mass for link in robot.links), rel=1e-15)
    straight = replace(robot, joints=tuple(replace(joint, drawn_position=0.0) for joint in robot.joints))
    assert document["com"] != report_document(Report(robot=straight), Diagnostics())["robot"]["com"]
    assert document["joints"][1]["drawn_position"] == pi / 6


def test_the_same_report_has_the_same_bytes() -> None:
    """The report is deterministic UTF-8 with one newline at the end and unescaped names."""
    report = Report((replace(PASSED, where="mass of link 'Grundplatte groß'"),), robot=four_bar())
    first = report_bytes(report, Diagnostics())
    assert first == report_bytes(replace(report, robot=four_bar()), Diagnostics())
    assert "groß".encode() in first
    assert first.endswith(b"}\n")
    assert b"\r" not in first
