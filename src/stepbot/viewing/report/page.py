"""The report of one robot: the page that moves it, and below it everything that a reviewer asks for."""

from collections.abc import Mapping, Sequence
from pathlib import PurePath

from stepbot.diagnostics import Diagnostic
from stepbot.geometry.sums import exact_sum
from stepbot.report.robot import Report, Status
from stepbot.robot.model import Robot
from stepbot.version import __version__

from ..connections import evidence_of_rows
from ..page import page_html
from ..scene import scene_document
from .markup import Markup, element, joined, mass_text
from .reduction import Reduced, reduced
from .result_tables import Places, findings_section, inputs_section, proof_section
from .robot_tables import bodies_section, collisions_section, joints_section, masses_section, motors_section

STYLES = ("style.css", "report.css")
_GENERATOR = f"Written by stepbot {__version__}."
_WAYS = (
    ("joint-table", "Joints"),
    ("mass-table", "Masses"),
    ("proof-table", "Verification"),
    ("finding-list", "Findings"),
    ("body-table", "Bodies"),
)


def report_page(robot: Robot, report: Report, found: Sequence[Diagnostic], lines: Places) -> bytes:
    """The report as one HTML file without references to others.

    Args:
        robot: The robot.
        report: Results of verification, bodies, joint table.
        found: Diagnostics.
        lines: Source lines of diagnostics.
    """
    shown = reduced(robot)
    scene = scene_document(shown.robot, evidence=evidence_of_rows(report.joint_table), report=report, found=found)
    names: Mapping[str, str] = {one.span.file: PurePath(one.span.file).name for one in found}
    sections = element(
        "div",
        _summary(robot, report, found),
        joints_section(robot, report.joint_table),
        masses_section(robot),
        motors_section(robot),
        proof_section(report),
        findings_section(found, lines, names),
        collisions_section(report.collision_shapes),
        bodies_section(report.bodies),
        inputs_section(report),
        element(
            "footer", element("p.quiet", _mesh_words(shown)), element("p.quiet", f"Written by stepbot {__version__}.")
        ),
        id="report",
    )
    html = page_html(f"{robot.name} – stepbot report", scene, styles=STYLES, after=sections)
    return html.encode("utf-8", "backslashreplace")


def _summary(robot: Robot, report: Report, found: Sequence[Diagnostic]) -> Markup:
    """The numbers that a reviewer wants first."""
    statuses = [check.status for check in report.checks]
    failed, passed = statuses.count(Status.FAILED), statuses.count(Status.PASSED)
    warnings = sum(one.severity == "warning" for one in found)
    weak = sum(bool(row.evidence.doubt) for row in report.joint_table)
    verdict = ("failed", "bad") if failed else ("passed", "good") if passed else ("not verified", "warn")
    checks = f"{failed} of {len(statuses)} checks" if failed else f"{passed} checks" if passed else ""
    freedom = report.degrees_of_freedom
    tiles = (
        (verdict[0], checks or "verification", verdict[1]),
        (mass_text(exact_sum(link.mass_properties.mass for link in robot.links)), "mass", ""),
        (str(len(robot.links)), "links", ""),
        (str(len(robot.joints)), "joints", ""),
        (str(len(robot.closures)), "closed loops", "") if robot.closures else None,
        (str(freedom), "degrees of freedom", "") if freedom is not None else None,
        (str(weak), "joints on weak evidence", "warn") if weak else None,
        (str(warnings), "warnings", "warn") if warnings else None,
    )
    cells = (
        element("div.tile", element(f"b.{tone}" if tone else "b", value), element("span", name))
        for value, name, tone in filter(None, tiles)
    )
    links = (
        ("#joint-table", "Joints"),
        ("#mass-table", "Masses"),
        ("#proof-table", "Verification"),
        ("#finding-list", "Findings"),
    )
    ways = joined(element("a", text, href=target) for target, text in links)
    return element("section", element("div.tiles", cells), element("nav.ways", ways), id="summary")


def _mesh_words(shown: Reduced) -> str:
    """How the displayed meshes differ from those in the files."""
    bound = f"{1e3 * shown.deviation:.2g} mm"
    if shown.displayed == shown.faces:
        return f"The picture has the meshes of the files, {shown.faces} triangles, with coordinates rounded to {bound}."
    return (
        f"The picture has {shown.displayed} of the {shown.faces} triangles in the files; no point of the exact meshes "
        f"is farther than {bound} from a displayed one. Tables and checks are about the exact meshes."
    )
