"""An assembly as fingerprints, independent of names, order and entity numbers.

Numbers are rounded to a nanometre, a nanoradian or nine digits: well below every tolerance of a comparison, well above
differences between machines.
"""

from collections.abc import Iterable, Sequence
from functools import cached_property
from math import floor, log10

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble.bound import Bound, PlacedJoint
from stepbot.geometry.mesh import TriMesh, surface_moments
from stepbot.geometry.spatial import IDENTITY3, ZERO3, Array, Matrix3, Pose, Vector3, matrix3, vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.component_paths import component_paths
from stepbot.sidecar.document import Document
from stepbot.step.assembly import CERTAIN, Assembly, Body, BodyKind, Component
from stepbot.step.structure.paths import ComponentPaths

EXACT, MESH, AREA, NOTHING = "exact", "mesh", "area", "none"
"""Domain of the integrals of a shape: the exact solid, its mesh, the triangles of a surface, or none."""
FREE_FORM = "other"
"""The surface type of splines in :attr:`Shape.faces`."""
_DECIMALS = 9
_DIGITS = 9
_AREA_ERROR = 1e-2
"""Relative error of integrals over the triangles of a surface, which depend on the mesh."""
_LEAST_ERROR = 1e-9
Six = tuple[float, float, float, float, float, float]


class Shape(Struct, frozen=True, dict=True):
    """The fingerprint of a body, independent of names and of the order of faces."""

    kind: str
    """A :class:`.BodyKind` value."""
    faces: tuple[tuple[str, int], ...]
    """Number of faces of each surface type."""
    basis: str
    """Domain of the integrals."""
    measure: float = 0.0
    """Volume [m^3], or area [m^2] of a surface."""
    com: Vector3 = ZERO3
    """Centroid [m] in the frame of the definition."""
    inertia: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Second moments at density 1 about the centroid, xx, yy, zz, xy, xz, yz [m^5, of a surface m^4]."""
    error: float = 0.0
    """Estimated relative error of the integrals."""

    @cached_property
    def tensor(self) -> Array:
        """:attr:`inertia` as a matrix (3, 3)."""
        xx, yy, zz, xy, xz, yz = self.inertia
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class Part(Struct, frozen=True, dict=True):
    """A component with a body."""

    path: str
    """Canonical path."""
    shape: int
    """Index of :attr:`Snapshot.shapes`."""
    position: Vector3 = ZERO3
    """p_WC [m]."""
    rotation: Matrix3 = IDENTITY3
    """R_WC."""
    box: tuple[Vector3, Vector3] = (ZERO3, ZERO3)
    """Lowest and highest corner [m] in the assembly's frame."""
    density: float = 0.0
    """[kg/m^3] in the STEP; 0 for none."""
    material: str = ""
    """Name of the material in the STEP; empty for none."""
    by_ordinal: bool = False
    """Whether a segment of the path depends on ``#n``."""
    link: str = ""
    """Its link; empty for none."""
    mass: float | None = None
    """[kg] in the robot; None if unknown."""

    @cached_property
    def X_WC(self) -> Pose:
        """Pose in the assembly."""
        return Pose(self.rotation, self.position)

    @cached_property
    def diagonal(self) -> float:
        """Of :attr:`box` [m]."""
        return float(np.linalg.norm(np.subtract(*self.box)))


class Reference(Struct, frozen=True):
    """A component path of the sidecar, and its matches."""

    path: str
    components: tuple[str, ...]
    """Canonical paths; of nested components the topmost."""


class Snapshot(Struct, frozen=True, dict=True):
    """An assembly, and its bindings by a sidecar; without a sidecar, only the parts."""

    source: str
    """File name of the STEP."""
    digest: str
    """Hash of its bytes."""
    shapes: tuple[Shape, ...]
    parts: tuple[Part, ...]
    robot: str = ""
    joints: tuple[PlacedJoint, ...] = ()
    references: tuple[Reference, ...] = ()

    def shape_of(self, part: int) -> Shape:
        """The shape of a part."""
        return self.shapes[self.parts[part].shape]

    @cached_property
    def index_of(self) -> dict[str, int]:
        """Index of each part by its path."""
        return {part.path: index for index, part in enumerate(self.parts)}


def snapshot(assembly: Assembly, digest: str, measures: Sequence[VolumeProperties | None]) -> Snapshot:
    """The fingerprints of an assembly.

    Args:
        digest: Hash of the bytes of the file.
        measures: trimesh's mass properties of each of ``assembly.bodies``.
    """
    shown = part_components(assembly)
    bodies = sorted({component.body for component in shown})
    number = {body: position for position, body in enumerate(bodies)}
    by_ordinal = _by_ordinal(assembly.components)
    return Snapshot(
        assembly.source,
        digest,
        tuple(_shape(assembly.bodies[body], measures[body]) for body in bodies),
        tuple(_part(assembly, component, number[component.body], by_ordinal[component.index]) for component in shown),
    )


def with_sidecar(taken: Snapshot, assembly: Assembly, document: Document, bound: Bound) -> Snapshot:
    """A snapshot with the sidecar's bindings: links, masses, joints and paths."""
    parts = []
    for part, component in zip(taken.parts, part_components(assembly), strict=True):
        weighed = bound.masses.get(component.index)
        mass = None if weighed is None or weighed.mass is None else _significant(weighed.mass)
        parts.append(replace(part, link=bound.claims.link_of[component.index], mass=mass))
    joints = tuple(
        replace(joint, origin=_rounded(joint.origin), axis=None if joint.axis is None else _rounded(joint.axis))
        for joint in bound.joints
    )
    return replace(
        taken, parts=tuple(parts), robot=document.robot, joints=joints, references=_references(assembly, document)
    )


def part_components(assembly: Assembly) -> list[Component]:
    """The components with a visible body, in file order: one for each part of a snapshot."""
    return [c for c in assembly.components if c.body >= 0 and assembly.bodies[c.body].kind is not BodyKind.WIRE]


def _references(assembly: Assembly, document: Document) -> tuple[Reference, ...]:
    paths = ComponentPaths(assembly.components)
    named = dict.fromkeys(place.pattern for place in component_paths(document))
    references = {pattern: paths.find(pattern) for pattern in sorted(named)}
    return tuple(
        Reference(pattern, tuple(assembly.components[index].path for index in binding.topmost))
        for pattern, binding in references.items()
        if not binding.problem
    )


def _by_ordinal(components: Iterable[Component]) -> list[bool]:
    held: list[bool] = []
    for component in components:
        held.append(component.by_ordinal_only or (component.parent >= 0 and held[component.parent]))
    return held


def _part(assembly: Assembly, component: Component, shape: int, by_ordinal: bool) -> Part:
    mesh = assembly.bodies[component.body].mesh
    box = mesh.moved(component.X_WC).bounds if len(mesh.vertices) else (ZERO3, ZERO3)
    R = component.X_WC.R
    return Part(
        component.path,
        shape,
        _rounded(component.X_WC.position),
        matrix3(np.round(R, _DECIMALS) + 0.0),
        (_rounded(box[0]), _rounded(box[1])),
        _significant(component.density or 0.0),
        component.material.strip(),
        by_ordinal,
    )


def _shape(body: Body, measured: VolumeProperties | None) -> Shape:
    kind, faces = body.kind.value, body.face_counts
    if body.exact is not None and body.exact_error <= CERTAIN:
        return _of_volume(kind, faces, EXACT, body.exact, max(body.exact_error, _LEAST_ERROR))
    if measured is not None:
        error = _LEAST_ERROR if body.kind is BodyKind.TESSELLATED else CERTAIN
        return _of_volume(kind, faces, MESH, measured, error)
    return _of_surface(kind, faces, body.mesh)


def _of_volume(
    kind: str, faces: tuple[tuple[str, int], ...], basis: str, properties: VolumeProperties, error: float
) -> Shape:
    inertia = np.array(properties.unit_density.inertia)
    com = _rounded(properties.unit_density.com)
    return Shape(kind, faces, basis, _significant(properties.volume), com, _six(inertia), _significant(error, 2))


def _of_surface(kind: str, faces: tuple[tuple[str, int], ...], mesh: TriMesh) -> Shape:
    """Area, centroid and second moments of the triangles of a mesh."""
    area, com, second = surface_moments(mesh.vertices, mesh.faces)
    if not area:
        return Shape(kind, faces, NOTHING)
    inertia = np.trace(second) * np.eye(3) - second
    return Shape(kind, faces, AREA, _significant(area), _rounded(com), _six(inertia), _AREA_ERROR)


def _six(tensor: Array) -> Six:
    """The six numbers of a symmetric matrix, to nine digits of the largest."""
    largest = float(np.abs(tensor).max())
    decimals = _DIGITS - 1 - floor(log10(largest)) if largest else 0
    (xx, xy, xz), (_, yy, yz), (*_, zz) = (np.round(tensor, decimals) + 0.0).tolist()
    return xx, yy, zz, xy, xz, yz


def _significant(value: float, digits: int = _DIGITS) -> float:
    return float(f"{value:.{digits - 1}e}") if value else 0.0


def _rounded(values: Iterable[float]) -> Vector3:
    return vector3(np.round(np.asarray(tuple(values)), _DECIMALS) + 0.0)
