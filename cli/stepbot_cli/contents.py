"""Totals of each component of an assembly, including its subtree; and all that `inspect` reports as JSON, in SI."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.poses import Poses, bounds_at
from stepbot.geometry.spatial import ZERO3, Array, Pose, Vector3, vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.pipeline.stages import Inspection
from stepbot.report.plain import picked
from stepbot.step.assembly import Assembly, Body, BodyKind, Component, MeshTolerance, Validation
from stepbot.step.features.axes import AxisLine

from .inspection_rows import SharedAxes, component_axes

Box = tuple[Vector3, Vector3]

_IN_PLANE = 2e-9
"""Distance [m] from a plane up to which a vertex lies in it: vertices are on a grid of a nanometre."""


class Contents(Struct):
    """Totals of a component and its subtree."""

    solids: int = 0
    surfaces: int = 0
    """Number of bodies with a surface that encloses no volume."""
    volume: float = 0.0
    """[m^3]."""
    box: Box | None = None
    """Lowest and highest corner [m] of the meshes, along the axes of the assembly; None without geometry."""
    slack: Box = (ZERO3, ZERO3)
    """How far [m] the exact shape may extend beyond each coordinate of the box: 0 where a flat face lies there."""

    @property
    def center(self) -> Vector3 | None:
        """Centre of the bounding box [m], as in an origin ``{center: PATH}``."""
        if self.box is None:
            return None
        (a, b, c), (x, y, z) = self.box
        return ((a + x) / 2, (b + y) / 2, (c + z) / 2)

    @property
    def size(self) -> Vector3 | None:
        """Extent of the bounding box [m] along the axes of the assembly."""
        if self.box is None:
            return None
        (a, b, c), (x, y, z) = self.box
        return (x - a, y - b, z - c)

    @property
    def size_slack(self) -> Vector3:
        """How much [m] larger each extent may be than that of the meshes."""
        (a, b, c), (x, y, z) = self.slack
        return (a + x, b + y, c + z)

    def add(self, other: "Contents") -> None:
        """Add the totals of a child."""
        self.solids += other.solids
        self.surfaces += other.surfaces
        self.volume += other.volume
        if self.box and other.box:
            self.slack = _joined_slack(self, other.box, other.slack)
            self.box = _joined(self.box, other.box)
        elif other.box:
            self.box, self.slack = other.box, other.slack


def contents(
    assembly: Assembly, measures: tuple[VolumeProperties | None, ...], tolerance: MeshTolerance
) -> list[Contents]:
    """Totals of each component; ``measures`` are the mass properties of the mesh of each body."""
    rows = [Contents() for _ in assembly.components]
    for number, indices in assembly.occurrences.items():
        body = assembly.bodies[number]
        own = volume(body, measures[number])
        is_solid = body.kind is BodyKind.SOLID or (body.kind is BodyKind.TESSELLATED and own > 0.0)
        is_surface = not is_solid and body.kind is not BodyKind.WIRE
        boxes: list[Box | None] = [None] * len(indices)
        if len(body.mesh.vertices):
            corners = bounds_at(body.mesh.vertices, Poses.of(assembly.components[index].X_WC for index in indices))
            boxes = list(zip(*(_vectors(corner) for corner in corners), strict=True))
        slacks = _slacks(body, [assembly.components[index].X_WC for index in indices], tolerance)
        for index, box, slack in zip(indices, boxes, slacks, strict=True):
            rows[index] = Contents(int(is_solid), int(is_surface), own, box, slack)
    for component in reversed(assembly.components[1:]):
        rows[component.parent].add(rows[component.index])
    return rows


def _slacks(body: Body, poses: Sequence[Pose], tolerance: MeshTolerance) -> Iterator[Box]:
    """For each pose of a body, how far its exact shape may extend beyond the box of its mesh."""
    if body.kind is BodyKind.TESSELLATED or not len(body.mesh.faces):
        yield from [(ZERO3, ZERO3)] * len(poses)
        return
    deviation = tolerance.absolute or tolerance.relative * body.mesh.diagonal
    known: dict[object, Box] = {}
    for pose in poses:
        if pose.rotation not in known:
            flat = _flat_ends(body.mesh, pose)
            low, high = (vector3(np.where(ends, 0.0, deviation)) for ends in flat)
            known[pose.rotation] = low, high
        yield known[pose.rotation]


def _flat_ends(mesh: TriMesh, X: Pose) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """For each axis (3,), whether a triangle of the moved mesh lies in the lowest and in the highest plane of its box.

    A flat face does; of a curved face, only edges or corners do, between which the exact face may extend farther.
    """
    corners = X.turn(mesh.vertices)[mesh.faces]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    return ((corners.max(axis=1) <= low + _IN_PLANE).any(axis=0), (corners.min(axis=1) >= high - _IN_PLANE).any(axis=0))


def _joined_slack(one: Contents, box: Box, slack: Box) -> Box:
    """For each coordinate of the box around two, the slack of the one that it is of."""
    assert one.box is not None
    low = [s if a <= b else t for a, b, s, t in zip(one.box[0], box[0], one.slack[0], slack[0], strict=True)]
    high = [s if a >= b else t for a, b, s, t in zip(one.box[1], box[1], one.slack[1], slack[1], strict=True)]
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _vectors(rows: Array) -> list[Vector3]:
    """The rows of an array (n, 3)."""
    return [(x, y, z) for x, y, z in rows.tolist()]


def _joined(a: Box, b: Box) -> Box:
    """The box around two boxes, without arrays: there may be 10,000 components."""
    x, y, z = map(min, a[0], b[0])
    u, v, w = map(max, a[1], b[1])
    return (x, y, z), (u, v, w)


def volume(body: Body, measured: VolumeProperties | None) -> float:
    """Volume [m^3] of a body: the exact one, else that of a closed mesh, else 0."""
    if body.exact is not None:
        return body.exact.volume
    return measured.volume if measured is not None else 0.0


def inspection_document(inspection: Inspection, *, features: bool) -> dict[str, Any]:
    """The file, its components, and its bodies, to which components refer by index; ``features`` are axis lines."""
    assembly = inspection.assembly
    if assembly is None:
        return {}
    sums = contents(assembly, inspection.measures, inspection.tolerance)
    components = [_component(component, sums[component.index]) for component in assembly.components]
    if features:
        for component, document in zip(assembly.components, components, strict=True):
            axes = component_axes(assembly, component)
            document["axes"] = [{**_line(line), "origin": origin} for line, origin in axes]
    return {
        **picked(assembly, "file=source schema originating_system unit unit_scale facts definitions"),
        **picked(sums[0], "solids surfaces volume"),
        "validations": [_validation(assembly, validation) for validation in assembly.validations],
        "components": components,
        "bodies": [_body(body, measured) for body, measured in zip(assembly.bodies, inspection.measures, strict=True)],
    }


def shared_axes_document(shared: SharedAxes) -> dict[str, Any]:
    """The axes that two components or links share, or nearly share."""
    return {
        "lines": [
            {**_line(line), "weight": line.weight, "chosen": line is shared.chosen, "origin": snippet}
            for line, snippet in zip(shared.lines, shared.snippets, strict=True)
        ],
        "near_misses": [
            {"distance": miss.distance, "angle": miss.angle, "components": list(places)}
            for miss, places in zip(shared.misses, shared.miss_places, strict=True)
        ],
    }


def _component(component: Component, inside: Contents) -> dict[str, Any]:
    keys = "path parent product occurrence by_ordinal_only missing definition body"
    return {
        **picked(component, keys, missing=component.missing or None),
        "pose": picked(component.X_WC, "rotation position"),
        **picked(inside, "solids surfaces volume bounds=box size center"),
        **picked(component, "material density color", density=component.density or 0.0),
    }


def _body(body: Body, measured: VolumeProperties | None) -> dict[str, Any]:
    return {
        **picked(body, "kind watertight defect"),
        "vertices": len(body.mesh.vertices),
        "faces": len(body.mesh.faces),
        "colors": body.colors,
        "area": body.area or None,
        "exact": _volume(body.exact),
        "mesh": _volume(measured),
        "axis_faces": [picked(face, "point direction radius low high bore cone") for face in body.axis_faces],
    }


def _validation(assembly: Assembly, validation: Validation) -> dict[str, Any]:
    """A validation property of the file, in SI."""
    path = assembly.components[validation.component].path
    return picked(validation, "component quantity stated read deviation tolerance agrees", component=path)


def _line(line: AxisLine) -> dict[str, Any]:
    return picked(line, "point direction low high radii")


def _volume(properties: VolumeProperties | None) -> dict[str, Any] | None:
    """Volume [m^3], com [m], and inertia [kg m^2] about the com at 1 kg/m^3, in the definition's frame."""
    if properties is None:
        return None
    unit = properties.unit_density
    return {"volume": properties.volume, "com": unit.com, "inertia_at_unit_density": unit.inertia}
