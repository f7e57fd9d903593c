"""The joint table as JSON data."""

from collections.abc import Iterable
from typing import Any

from stepbot.robot.joint_table import JointRow

Json = dict[str, Any]


def joint_table_document(rows: Iterable[JointRow]) -> list[Json]:
    """The joint table as JSON data."""
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
