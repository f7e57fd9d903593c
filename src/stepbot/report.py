"""What was proven, and what not: one row for each format and engine, and everything as ``report.json``.

The report is deterministic: no times, no folders of this machine, infinite limits as null. Its schema is
``schemas/report-1.schema.json``.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite
from pathlib import PurePath
from typing import Any

import stepbot

from .diagnostics import Diagnostic, Diagnostics
from .joint_table import JointRow
from .kinematics import initial_configuration, link_poses
from .model import Actuator, Joint, JointKind, Limit, Link, LoopClosure, MassProperties, Robot, combined
from .pybullet_loops import LoopConstraint, loop_constraints
from .sensors import SEEING, Sensor
from .spatial import Pose

VERSION = 1
"""Version of the schema."""

Json = dict[str, Any]


OWN_PARSERS = ("reader", "extensions")
"""What reads files back for stepbot itself: it confirms the text, and no engine."""


class Status(StrEnum):
    """The outcome of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_RUN = "not run"


@dataclass(frozen=True)
class Check:
    """One quantity, compared in one file as one engine sees it."""

    file: str
    """File name; empty for what belongs to the robot and not to a file."""
    format: str
    engine: str
    quantity: str
    status: Status
    deviation: float | None = None
    """The worst one; None where the quantity has no number or nothing was compared."""
    tolerance: float | None = None
    """What was allowed there."""
    unit: str = ""
    where: str = ""
    """Link, joint, configuration of the worst deviation."""
    why: str = ""
    """Why it failed, did not run, or covers less than its name says."""
    against: str = "model"
    """What the file was compared with: the model, or another file and engine."""

    @property
    def ratio(self) -> float:
        """Deviation as a multiple of the tolerance; negative where there is no number."""
        if self.deviation is None or not self.tolerance:
            return -1.0
        return self.deviation / self.tolerance


@dataclass(frozen=True)
class Row:
    """All checks of one file and engine, for one line of a table."""

    file: str
    format: str
    engine: str
    status: Status
    """Failed if one check failed, passed if at least one passed and none failed, else not run."""
    compared: tuple[str, ...]
    """Quantities that were compared, in the order of the report."""
    worst: Check | None
    """The check that came nearest to its tolerance, or went farthest beyond it."""
    why: str
    """What failed, or what did not run and why."""
    against: str


@dataclass(frozen=True)
class MeasuredBody:
    """One definition of the assembly, measured twice, at a density of 1 kg/m^3."""

    name: str
    occurrences: int
    mesh: MassProperties | None
    """By trimesh, on the written mesh."""
    exact: MassProperties | None
    """By integration over the exact solid."""
    deviation: float | None
    """The largest relative difference between the two, of volume, centre and inertia."""
    error: float | None
    """Estimated relative error of ``exact``; None where there is no exact solid, or no estimate."""
    written: str
    """Which of the two the files carry, and why."""


@dataclass(frozen=True)
class Report:
    """The proof."""

    checks: tuple[Check, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    """Engines that ran, and their versions."""
    robot: Robot | None = None
    degrees_of_freedom: int | None = None
    """Loops closed and mimics obeyed, in the drawn pose."""
    driven: tuple[str, ...] = ()
    """Joints that the others follow from, where there are loops."""
    collisions: tuple[tuple[str, str, float | None], ...] = ()
    """Pairs of links that overlap in the drawn pose, and how deep [m]; None between two surfaces."""
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """What was changed or added so that an engine could check at all, by file and engine."""
    names: Mapping[str, str] = field(default_factory=dict)
    """Names in the files, and the names in the STEP that they stand for."""
    bodies: tuple[MeasuredBody, ...] = ()
    joint_table: tuple[JointRow, ...] = ()
    """Where each joint is, for a person to check; of files that were compared, as the first one says."""

    @property
    def failed(self) -> bool:
        """Whether any check failed."""
        return any(check.status is Status.FAILED for check in self.checks)

    @property
    def read_back(self) -> tuple[Check, ...]:
        """The checks that passed because stepbot's own parsers say so, and no engine."""
        return tuple(check for check in self.checks if check.status is Status.PASSED and check.engine in OWN_PARSERS)

    def rows(self) -> tuple[Row, ...]:
        """One row for each file and engine, in the order of the checks."""
        keys = dict.fromkeys((check.file, check.engine, check.against) for check in self.checks)
        return tuple(
            _row([check for check in self.checks if (check.file, check.engine, check.against) == key]) for key in keys
        )


def _row(checks: list[Check]) -> Row:
    by_status = {status: [check for check in checks if check.status is status] for status in Status}
    failed, passed, not_run = by_status[Status.FAILED], by_status[Status.PASSED], by_status[Status.NOT_RUN]
    status = Status.FAILED if failed else Status.PASSED if passed else Status.NOT_RUN
    first = checks[0]
    measured = [check for check in failed or passed if check.ratio >= 0.0]
    return Row(
        first.file,
        first.format,
        first.engine,
        status,
        tuple(check.quantity for check in checks if check.status is not Status.NOT_RUN),
        max(measured, key=lambda check: check.ratio, default=None),
        "; ".join(f"{check.quantity}: {check.why or check.where}" for check in failed) or _reasons(not_run),
        first.against,
    )


def _reasons(not_run: list[Check]) -> str:
    """Each reason once, with the quantities that it holds for."""
    grouped: dict[str, list[str]] = {}
    for check in not_run:
        grouped.setdefault(check.why, []).append(check.quantity)
    return "; ".join(f"{', '.join(quantities)} not run: {why}" for why, quantities in grouped.items())


def report_bytes(report: Report, diagnostics: Iterable[Diagnostic]) -> bytes:
    """``report.json``: UTF-8, indented, one newline at the end."""
    text = json.dumps(report_document(report, diagnostics), indent=2, ensure_ascii=False, allow_nan=False)
    return (text + "\n").encode("utf-8", "backslashreplace")


def report_document(report: Report, diagnostics: Iterable[Diagnostic]) -> Json:
    """The report as what JSON can hold; of what was ignored it has the counts."""
    ignored = diagnostics.ignored if isinstance(diagnostics, Diagnostics) else ()
    statuses = [check.status for check in report.checks]
    return {
        "version": VERSION,
        "generator": f"stepbot {stepbot.__version__}",
        "robot": None if report.robot is None else _robot(report, report.robot),
        "summary": {
            **{status.name.lower(): statuses.count(status) for status in Status},
            "passed_by_own_parsers": len(report.read_back),
            "ignored": dict(sorted(Counter(one.code for one in ignored).items())),
        },
        "engines": dict(report.versions),
        "checks": [_check(check) for check in report.checks],
        "notes": {key: list(notes) for key, notes in report.notes.items()},
        "names": dict(report.names),
        "bodies": [_body(body) for body in report.bodies],
        "joint_table": joint_table_document(report.joint_table),
        "diagnostics": [_diagnostic(diagnostic) for diagnostic in diagnostics],
    }


def joint_table_document(rows: Iterable[JointRow]) -> list[Json]:
    """The joint table as what JSON can hold."""
    return [_joint_row(row) for row in rows]


def _joint_row(row: JointRow) -> Json:
    found = row.evidence
    return {
        "name": row.name,
        "kind": row.kind,
        "is_closure": row.is_closure,
        "parent": row.parent,
        "child": row.child,
        "origin": None if row.origin is None else list(row.origin),
        "axis": None if row.axis is None else list(row.axis),
        "axis2": None if row.axis2 is None else list(row.axis2),
        "basis": found.basis.value,
        "source": found.text,
        "faces": [{"component": one.component, "radius": one.radius, "bore": one.bore} for one in found.sides],
        "overlap": found.overlap,
        "clearance": found.clearance,
        "selected": found.selected,
        "rivals": [
            {
                "basis": rival.basis.value,
                "point": list(rival.point),
                "direction": list(rival.direction),
                "radii": list(rival.radii),
                "share": rival.share,
            }
            for rival in found.rivals
        ],
        "doubt": found.doubt,
    }


def _check(check: Check) -> Json:
    return {
        "file": check.file,
        "format": check.format,
        "engine": check.engine,
        "against": check.against,
        "quantity": check.quantity,
        "status": check.status.value,
        "deviation": _number(check.deviation),
        "tolerance": _number(check.tolerance),
        "unit": check.unit,
        "where": check.where,
        "why": check.why,
    }


def _number(value: float | None) -> float | None:
    """The number; null where it is none or infinite."""
    return float(value) if value is not None and isfinite(value) else None


def _robot(report: Report, robot: Robot) -> Json:
    poses = link_poses(robot, initial_configuration(robot))
    total = combined(link.mass_properties.moved(poses[link.name]) for link in robot.links)
    return {
        "name": robot.name,
        "source": robot.source,
        "base": robot.base.value,
        "root": robot.root.name,
        **_mass(total),
        "degrees_of_freedom": report.degrees_of_freedom,
        "driven": list(report.driven),
        "links": [_link(link) for link in robot.links],
        "joints": [_joint(joint) for joint in robot.joints],
        "closures": [_closure(closure) for closure in robot.closures],
        "pybullet": [_loop_constraint(constraint) for constraint in loop_constraints(robot)],
        "frames": [
            {"name": frame.name, "link": frame.link, "pose": _pose(frame.X_LF), "source": frame.source}
            for frame in robot.frames
        ],
        "actuators": [_actuator(actuator) for actuator in robot.actuators],
        "sensors": [_sensor(sensor) for sensor in robot.sensors],
        "overlaps": [{"links": [a, b], "depth": depth} for a, b, depth in report.collisions],
    }


def _mass(body: MassProperties) -> Json:
    return {"mass": body.mass, "com": list(body.com), "inertia": [list(row) for row in body.inertia]}


def _pose(X: Pose) -> Json:
    return {"xyz": list(X.position), "rpy": list(X.rpy)}


def _loop_constraint(constraint: LoopConstraint) -> Json:
    frames = {
        name: {"xyz": list(position), "quaternion": list(turn)}
        for name, (position, turn) in (("frame_a", constraint.frame_a), ("frame_b", constraint.frame_b))
    }
    words = {name: getattr(constraint, name) for name in ("closure", "type", "link_a", "link_b")}
    return {**words, **frames, "axis": list(constraint.axis)}


def _link(link: Link) -> Json:
    return {
        "name": link.name,
        **_mass(link.mass_properties),
        "components": list(link.components),
        "sources": [
            {
                "component": source.component,
                "mass": source.mass,
                "density": _number(source.density or None),
                "origin": source.origin,
                "method": source.method,
            }
            for source in link.mass_sources
        ],
    }


def _joint(joint: Joint) -> Json:
    moves = joint.kind is not JointKind.FIXED
    return {
        "name": joint.name,
        "kind": joint.kind.value,
        "parent": joint.parent,
        "child": joint.child,
        "pose": _pose(joint.X_PC),
        "axis": list(joint.axis) if moves else None,
        "axis2": list(joint.axis2) if joint.kind is JointKind.UNIVERSAL else None,
        "pitch": joint.pitch if joint.kind is JointKind.SCREW else None,
        "limits": _limits(joint.limit),
        "dynamics": {
            name: float(getattr(joint.dynamics, name))
            for name in ("damping", "friction", "stiffness", "spring_reference", "armature")
        },
        "mimic": None
        if joint.mimic is None
        else {"joint": joint.mimic.joint, "multiplier": joint.mimic.multiplier, "offset": joint.mimic.offset},
        "drawn_position": joint.drawn_position,
    }


def _limits(limit: Limit) -> Json:
    return {name: _number(getattr(limit, name)) for name in ("lower", "upper", "velocity", "effort")}


def _actuator(actuator: Actuator) -> Json:
    return {
        "name": actuator.name,
        "joint": actuator.joint,
        "kind": actuator.kind.value,
        "kp": actuator.kp,
        "kv": actuator.kv,
        "gear": actuator.gear,
        "limits": _limits(actuator.limit),
    }


def _sensor(sensor: Sensor) -> Json:
    view = sensor.view
    sees = {"fov": view.fov, "columns": view.columns, "rows": view.rows, "nearest": view.nearest}
    return {
        "name": sensor.name,
        "kind": sensor.kind.value,
        "link": sensor.link,
        "joint": sensor.joint or None,
        "pose": _pose(sensor.X_LS),
        "rate": sensor.rate,
        "view": {**sees, "farthest": _number(view.farthest)} if sensor.kind in SEEING else None,
        "source": sensor.source,
    }


def _closure(closure: LoopClosure) -> Json:
    return {
        "name": closure.name,
        "kind": closure.kind.value,
        "link_a": closure.link_a,
        "pose_a": _pose(closure.X_AF),
        "link_b": closure.link_b,
        "pose_b": _pose(closure.X_BF),
        "axis": list(closure.axis),
    }


def _body(body: MeasuredBody) -> Json:
    return {
        "name": body.name,
        "occurrences": body.occurrences,
        "mesh": None if body.mesh is None else _mass(body.mesh),
        "exact": None if body.exact is None else _mass(body.exact),
        "deviation": _number(body.deviation),
        "error": _number(body.error),
        "written": body.written,
    }


def _diagnostic(diagnostic: Diagnostic) -> Json:
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "file": PurePath(diagnostic.span.file).name,
        "line": diagnostic.span.line,
        "column": diagnostic.span.column,
        "help": list(diagnostic.help),
        "notes": list(diagnostic.notes),
    }
