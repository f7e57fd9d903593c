"""A robot as one JSON document: everything that the page draws and lists.

Lengths in metres, angles in radians, masses in kilograms; a pose is twelve numbers, the rotation by rows and then the
position; shapes, frames and inertia are in the frame of their link. Numbers that do not exist are null.
"""

import json
from base64 import b64encode
from collections.abc import Iterable, Mapping
from pathlib import PurePath

import numpy as np

from stepbot.diagnostics import Diagnostic
from stepbot.geometry.inertia import MassProperties, combined
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import corners
from stepbot.report.plain import Json, picked, plain
from stepbot.report.results import Results
from stepbot.report.robot import MASS
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import Geometry, JointKind, Link, MeshRef, Robot
from stepbot.robot.sensors import PLACED, Sensor
from stepbot.step.assembly import Assembly

from .connections import component_documents, connection_documents, motion_document, pose_numbers


def proof_document(report: Results) -> Json:
    """The verification table: one row per file and engine; pairs of links that overlap as drawn."""
    return {
        "rows": [
            {
                **picked(
                    row, "file engine version against status compared", version=report.versions.get(row.engine, "")
                ),
                "worst": None if row.worst is None else picked(row.worst, "quantity deviation tolerance unit where"),
                "why": row.why,
            }
            for row in report.rows()
        ],
        "overlaps": [{"links": [a, b], "depth": depth} for a, b, depth in report.collisions],
        "own_parsers": list(report.own_parsers),
    }


def diagnostic_documents(
    diagnostics: Iterable[Diagnostic], lines: Mapping[tuple[str, int], str] | None = None
) -> list[Json]:
    """Diagnostics with places relative to the folders of their files, and their source lines as far as given."""
    return [
        picked(
            diagnostic,
            "code severity message file line help=remedies notes",
            file=PurePath(diagnostic.span.file).name,
            line=diagnostic.span.line,
            source=(lines or {}).get((diagnostic.span.file, diagnostic.span.line), ""),
        )
        for diagnostic in diagnostics
    ]


STEPS = 65535
_FEW = 65536
"""Number of vertices up to which an index fits in two bytes."""


def packed(mesh: TriMesh) -> Json:
    """A mesh as JSON data: ``low`` and ``size`` [m] of its box, vertices and indices as little-endian base64."""
    vertices = mesh.vertices if len(mesh.vertices) else np.zeros((1, 3))
    low, high = corners(vertices)
    size = high - low
    steps = np.rint((vertices - low) / np.where(size > 0.0, size, 1.0) * STEPS).astype("<u2")
    # Formats such as STL repeat each vertex in every triangle; one of each makes edges known.
    keys = steps.astype(np.uint64) @ np.array([1 << 32, 1 << 16, 1], dtype=np.uint64)
    _, kept, renumbered = np.unique(keys, return_index=True, return_inverse=True)
    steps, faces = steps[kept], renumbered[mesh.faces] if len(mesh.faces) else mesh.faces
    wide = len(steps) > _FEW
    return {
        "low": low.tolist(),
        "size": size.tolist(),
        "vertices": b64encode(steps.tobytes()).decode(),
        "faces": b64encode(faces.astype("<u4" if wide else "<u2").tobytes()).decode(),
        "wide": wide,
    }


VERSION = 1
"""Version of the document; page and document come from one stepbot, so it only guards against a mix-up."""


def scene_document(
    robot: Robot,
    *,
    evidence: Mapping[str, Json] | None = None,
    assembly: Assembly | None = None,
    report: Results | None = None,
    diagnostics: Iterable[Diagnostic] = (),
) -> Json:
    """The scene of a robot.

    Args:
        robot: The robot; its visuals are drawn.
        evidence: For each joint and closure, how it was found (:func:`.connections.evidence_of_rows`).
        assembly: The STEP file that it was built from, for the tree of components.
    """
    poses = link_poses(robot, initial_configuration(robot))
    index = {asset.name: number for number, asset in enumerate(robot.meshes)}
    total = combined(link.mass_properties.moved(poses[link.name]) for link in robot.links)
    return {
        "version": VERSION,
        "name": robot.name,
        "source": robot.source,
        "base": robot.base.value,
        "total": _mass(total),
        "meshes": [packed(asset.mesh) for asset in robot.meshes],
        "links": [_link(link, index) for link in robot.links],
        "modules": [picked(module, "name file links") for module in robot.modules],
        "connections": connection_documents(robot, evidence or {}),
        "motion": motion_document(robot),
        "joint_types": {
            kind.value: {"hinge": kind.is_hinge, "needs": kind.needs, "bounded": kind.bounded, "closes": kind.closes}
            for kind in JointKind
        },
        "frames": [
            {"name": frame.name, "link": frame.link, "X": pose_numbers(frame.X_LF), "source": frame.source}
            for frame in robot.frames
        ],
        "sensors": [_sensor(sensor) for sensor in robot.sensors],
        "actuators": [picked(actuator, "name joint kind kp kv") for actuator in robot.actuators],
        "components": [] if assembly is None else component_documents(assembly, robot),
        "proof": None if report is None else proof_document(report),
        "diagnostics": diagnostic_documents(diagnostics),
    }


def scene_text(scene: Json) -> str:
    """The scene as JSON, without spaces; not yet safe within HTML."""
    return json.dumps(scene, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _link(link: Link, index: dict[str, int]) -> Json:
    return {
        "name": link.name,
        "components": list(link.components),
        "mass": _mass(link.mass_properties),
        "visuals": [
            {
                **_geometry(visual.geometry, index),
                "X": pose_numbers(visual.X_LG),
                "color": list(visual.rgba),
                "component": visual.component,
            }
            for visual in link.visuals
        ],
        "collisions": [
            {**_geometry(collision.geometry, index), "X": pose_numbers(collision.X_LG)} for collision in link.collisions
        ],
        "sources": [picked(one, "component mass density origin") for one in link.masses],
    }


def _geometry(geometry: Geometry, index: dict[str, int]) -> Json:
    if isinstance(geometry, MeshRef):
        return {"shape": "mesh", "mesh": index[geometry.name]}
    return {"shape": type(geometry).__name__.lower(), **plain(geometry)}


def _mass(body: MassProperties) -> Json:
    """Mass, centre of mass, inertia, and the solid ellipsoid of the same mass and inertia; null where there is none."""
    return {**picked(body, MASS), "ellipsoid": _ellipsoid(body)}


def _ellipsoid(body: MassProperties) -> Json | None:
    """Rotation by rows, its columns the principal axes, and semi-axes [m]: I_x = m (b^2 + c^2) / 5."""
    if body.mass <= 0.0:
        return None
    moments, axes = np.linalg.eigh(np.array(body.inertia))
    squares = 2.5 / body.mass * (moments.sum() - 2.0 * moments)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return {"R": axes.ravel().tolist(), "radii": np.sqrt(np.maximum(squares, 0.0)).tolist()}


def _sensor(sensor: Sensor) -> Json:
    X, placed = pose_numbers(sensor.X_LS), sensor.kind in PLACED
    return picked(sensor, "name kind link joint placed X fov rate", placed=placed, X=X, fov=sensor.view.fov)
