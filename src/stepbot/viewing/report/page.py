"""The report of one robot: the page that moves it, and below it everything that a reviewer asks for."""

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from urllib.parse import quote

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostic, counted
from stepbot.geometry.fixed_point import distinct_rows, exact_sum
from stepbot.geometry.mesh import TriMesh, triangle_areas
from stepbot.geometry.spatial import Array
from stepbot.report.robot import Report, Status
from stepbot.robot.model import Robot
from stepbot.version import __version__

from ..connections import evidence_of_rows
from ..page import page_html, plain_page
from ..scene import STEPS, scene_document
from .result_tables import Places, findings_section, inputs_section, proof_section
from .robot_tables import (
    Markup,
    bodies_section,
    collisions_section,
    datasheet_section,
    element,
    joined,
    joints_section,
    mass_text,
    masses_section,
    modules_section,
    motors_section,
    table,
    table_row,
)


class Entry(Struct, frozen=True):
    """One robot."""

    name: str
    status: str
    """``converted``, ``unchanged`` or ``failed``."""
    page: str = ""
    """Path of its report, relative to the index, with slashes; empty without one."""
    passed: int = 0
    failed: int = 0
    not_run: int = 0
    links: int | None = None
    joints: int | None = None
    mass: float | None = None
    """[kg]."""
    errors: tuple[str, ...] = ()
    """Messages."""
    warnings: int = 0


def index_page(entries: Sequence[Entry]) -> bytes:
    """The page."""
    failed = sum(entry.status == "failed" for entry in entries)
    words = f"{counted(len(entries), 'robot')}{f', {failed} failed' if failed else ''}"
    headings = ("robot", "result", "checks", "mass", "links", "joints", "warnings", "errors")
    body = element("div", element("section", element("h2", words), table(headings, map(_row, entries))), id="report")
    return plain_page("Robots – stepbot report", body).encode("utf-8", "backslashreplace")


def _row(entry: Entry) -> Markup:
    name = element("a", entry.name, href=quote(entry.page)) if entry.page else entry.name
    failed = element("b.bad", f", {entry.failed} failed") if entry.failed else None
    checks = (f"{entry.passed} passed", failed) if entry.passed or entry.failed else "–"
    return table_row(
        name,
        element("td.bad" if entry.status == "failed" else "td.good", entry.status),
        checks,
        element("td.number", "–" if entry.mass is None else mass_text(entry.mass)),
        element("td.number", "–" if entry.links is None else entry.links),
        element("td.number", "–" if entry.joints is None else entry.joints),
        element("td.number", entry.warnings),
        (element("div", message) for message in entry.errors),
        data_robot=entry.name,
    )


BUDGET = 2_100_000
"""Size [bytes] of all meshes in a page."""
_PER_VERTEX = _PER_FACE = 8
"""Six bytes each as base64."""
_FINEST = 2**-13
"""Smallest cell, relative to the largest mesh."""


class ReducedRobot(Struct, frozen=True, eq=False):
    """A robot to display."""

    robot: Robot
    deviation: float
    """Upper bound [m] of the distance of every point of the robot's meshes from the displayed ones."""
    faces: int
    """Number of triangles of the robot's meshes."""
    displayed: int


def reduced(robot: Robot, budget: int = BUDGET) -> ReducedRobot:
    """The robot with meshes that fit a page; unchanged ones if they do."""
    meshes = [asset.mesh for asset in robot.meshes]
    faces = sum(len(mesh.faces) for mesh in meshes)
    largest = max((mesh.diagonal for mesh in meshes), default=0.0)
    cell, deviation, displayed = 0.0, 0.0, meshes
    while _size(displayed) > budget and cell < largest:
        cell = cell * 2**0.5 or largest * _FINEST
        pairs = [clustered(mesh, cell) for mesh in meshes]
        displayed, deviation = [mesh for mesh, _ in pairs], max(moved for _, moved in pairs)
    rounding = max((0.5 * mesh.diagonal / STEPS for mesh in displayed), default=0.0)
    assets = tuple(replace(asset, mesh=mesh) for asset, mesh in zip(robot.meshes, displayed, strict=True))
    shown = sum(len(mesh.faces) for mesh in displayed)
    return ReducedRobot(replace(robot, meshes=assets), deviation + rounding, faces, shown)


def clustered(mesh: TriMesh, cell: float) -> tuple[TriMesh, float]:
    """The mesh with one vertex per cell [m] of a grid, and the largest motion [m] of a vertex."""
    if not len(mesh.faces):
        return mesh, 0.0
    keys = np.floor(mesh.vertices / cell).astype(np.int64)
    first, cluster = distinct_rows(keys)
    counts = np.bincount(cluster)
    means: Array = np.stack([np.bincount(cluster, mesh.vertices[:, i]) / counts for i in range(3)], axis=1)
    # A vertex that is alone in its cell stays where it is, to the last bit.
    vertices = np.where(counts[:, None] == 1, mesh.vertices[first], means)
    faces = cluster[mesh.faces]
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    moved = float(np.linalg.norm(vertices[cluster] - mesh.vertices, axis=1).max())
    if not kept.any():  # smaller than a cell: a triangle remains, so that the part does not disappear
        kept = np.zeros(len(faces), dtype=bool)
        kept[int(triangle_areas(mesh.vertices[mesh.faces]).argmax())] = True
        return mesh.subset(kept), mesh.diagonal
    used, renumbered = np.unique(faces[kept], return_inverse=True)
    triangles = renumbered.reshape(-1, 3)
    unique, _ = distinct_rows(np.sort(triangles, axis=1))
    return TriMesh.of(vertices[used], triangles[np.sort(unique)]), moved


def _size(meshes: list[TriMesh]) -> int:
    vertices = sum(len(mesh.vertices) for mesh in meshes)
    faces = sum(len(mesh.faces) for mesh in meshes)
    return _PER_VERTEX * vertices + _PER_FACE * faces


STYLES = ("style.css", "report.css")


def report_page(robot: Robot, report: Report, diagnostics: Sequence[Diagnostic], lines: Places) -> bytes:
    """The report as one HTML file without references to others."""
    shown = reduced(robot)
    scene = scene_document(
        shown.robot, evidence=evidence_of_rows(report.joint_table), report=report, diagnostics=diagnostics
    )
    names: Mapping[str, str] = {diagnostic.span.file: PurePath(diagnostic.span.file).name for diagnostic in diagnostics}
    sections = element(
        "div",
        _summary(robot, report, diagnostics),
        modules_section(robot, report),
        joints_section(robot, report.joint_table),
        masses_section(robot),
        motors_section(robot),
        datasheet_section(robot),
        proof_section(report),
        findings_section(diagnostics, lines, names),
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


def _summary(robot: Robot, report: Report, diagnostics: Sequence[Diagnostic]) -> Markup:
    """The numbers that a reviewer wants first."""
    statuses = [check.status for check in report.checks]
    failed, passed = statuses.count(Status.FAILED), statuses.count(Status.PASSED)
    warnings = sum(diagnostic.severity == "warning" for diagnostic in diagnostics)
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
        ("#data-sheet", "Data sheet"),
        ("#proof-table", "Verification"),
        ("#finding-list", "Findings"),
    )
    ways = joined(element("a", text, href=target) for target, text in links)
    return element("section", element("div.tiles", cells), element("nav.ways", ways), id="summary")


def _mesh_words(shown: ReducedRobot) -> str:
    """How the displayed meshes differ from those in the files."""
    bound = f"{1e3 * shown.deviation:.2g} mm"
    if shown.displayed == shown.faces:
        return f"The picture has the meshes of the files, {shown.faces} triangles, with coordinates rounded to {bound}."
    return (
        f"The picture has {shown.displayed} of the {shown.faces} triangles in the files; no point of the exact meshes "
        f"is farther than {bound} from a displayed one. Tables and checks are about the exact meshes."
    )
