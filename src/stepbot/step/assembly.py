"""What a STEP file holds, as plain data in SI: the tree, each body once, the axes that joints can bind to.

Nothing in here knows the geometry kernel. Frames: W is the assembly (the STEP's own frame), C a component, D the
definition that a component is an occurrence of; C and D coincide, so a body's coordinates in D are coordinates in C.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepbot.diagnostics import Diagnostic
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose, Vector3, join_bounds
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import Rgba

from .faces import Face

CERTAIN = 1e-3
"""Relative error of mass properties up to which they are known."""
ROOT_PATH = "."
"""Path of the root of the assembly."""


@dataclass(frozen=True)
class MeshTolerance:
    """How closely a mesh follows its solid."""

    relative: float = 0.002
    """Chordal deviation as a share of the solid's diagonal; used where ``absolute`` is 0."""
    absolute: float = 0.0
    """Chordal deviation [m]."""
    angle: float = 0.2617993877991494
    """Angular deviation [rad] between neighbouring facets; 15 degrees."""


@dataclass(frozen=True)
class ReadOptions:
    """What to compute while a STEP file is read."""

    tolerance: MeshTolerance = MeshTolerance()
    tolerance_of: tuple[tuple[str, MeshTolerance], ...] = ()
    """Component path or glob (see :mod:`.structure.paths`) and its own tolerance; the nearest claim wins."""
    refine_mass_to: float = 0.0
    """Relative deviation from the exact mass properties to refine a measuring mesh to; 0 for no such mesh."""
    encoding: str = ""
    """Code page that names are declared to be in, where they are neither ASCII nor UTF-8; empty for none."""
    geometry: bool = True
    """Whether bodies are meshed and measured; False gives the tree alone."""
    faces: bool = False
    """Whether to keep every face of each body (:attr:`Body.faces`); only inference needs them."""


class BodyKind(StrEnum):
    """What a body is made of."""

    SOLID = "solid"
    SURFACE = "surface"
    """Faces that enclose no volume."""
    TESSELLATED = "tessellated"
    """Triangles without exact geometry; a closed one has a volume."""
    WIRE = "wire"
    """Curves and points only; nothing to see or to weigh."""


@dataclass(frozen=True)
class AxisFace:
    """A cylindrical or conical face: a line that a joint can turn about or slide along."""

    point: Vector3
    """A point of the axis [m], in the frame that the face is given in."""
    direction: Vector3
    """Unit direction; its sign means nothing."""
    radius: float
    """Radius [m]; of a cone, the larger one."""
    low: float
    """Start of the face along ``direction`` from ``point`` [m]."""
    high: float
    """End of the face along ``direction`` from ``point`` [m]."""
    bore: bool
    """Whether material lies outside (a hole) or inside (a shaft)."""
    cone: bool = False

    def moved(self, X_AB: Pose) -> "AxisFace":
        """This face, given in B, expressed in A."""
        x, y, z = X_AB.apply(self.point).tolist()
        u, v, w = X_AB.turn(self.direction).tolist()
        return AxisFace((x, y, z), (u, v, w), self.radius, self.low, self.high, self.bore, self.cone)


@dataclass(frozen=True, eq=False)
class Body:
    """One solid or surface of a definition: meshed once, measured once, however often it occurs."""

    kind: BodyKind
    mesh: TriMesh
    """In the definition's frame; without faces for a wire."""
    face_colors: NDArray[np.int32]
    """Shape (m,): for each face of the mesh an index of ``colors``."""
    colors: tuple[Rgba | None, ...]
    """Colours that the STEP gives; None where the face has no colour of its own and takes the component's."""
    watertight: bool
    """Whether every edge of the mesh joins exactly two faces that agree on the outside."""
    defect: str = ""
    """Why the body is not watertight or has no volume, for people; empty when all is well."""
    exact: VolumeProperties | None = None
    """From the exact B-rep; None where there is no volume."""
    exact_error: float = 0.0
    """Estimated relative error of ``exact``; 0 where there is no estimate, above :data:`CERTAIN` it is unconfirmed."""
    refined: VolumeProperties | None = None
    """By trimesh from the measuring mesh of ``ReadOptions.refine_mass_to``; None when it was not asked for."""
    axis_faces: tuple[AxisFace, ...] = ()
    """In the definition's frame, in file order."""
    area: float = 0.0
    """Exact area [m^2] of all faces, integrated only for files that state areas; 0 elsewhere."""
    faces: tuple[Face, ...] = ()
    """Every face, in file order; only with ``ReadOptions.faces``."""


@dataclass(frozen=True)
class Component:
    """One occurrence in the assembly tree."""

    index: int
    """Place in :attr:`Assembly.components`."""
    parent: int
    """Index of the component above; -1 for the root."""
    segment: str
    """Last segment of the canonical path, escaped, with ``#n`` where siblings share it."""
    path: str
    """Canonical path, unique: what `inspect` and messages print. ``.`` for the root."""
    product: str
    """Name of the product in the STEP; may be empty."""
    occurrence: str
    """Name of the occurrence in the STEP; may be empty or machine-made."""
    ordinal: int
    """n among the siblings that share the product name, from 1 in file order."""
    X_WC: Pose = IDENTITY
    """Pose in the assembly."""
    body: int = -1
    """Index of :attr:`Assembly.bodies`; -1 for a component that only holds others."""
    definition: int = -1
    """Index of the definition; components with the same one have the same shape."""
    color: Rgba | None = None
    """Colour of the occurrence, or of the part where the body's faces have none."""
    material: str = ""
    """Name of the material in the STEP; empty where there is none."""
    density: float = 0.0
    """Density [kg/m^3] in the STEP; 0 where there is none."""
    by_ordinal_only: bool = False
    """Whether only ``#n`` tells it from a sibling: such a path breaks when the CAD inserts a part."""


class Quantity(StrEnum):
    """What a CAD program states about a shape, for readers to check themselves by."""

    VOLUME = "volume"
    AREA = "area"
    CENTROID = "centroid"


@dataclass(frozen=True)
class Validation:
    """A validation property of the file, against what was read."""

    component: int
    """Index of the first component that it is about."""
    quantity: Quantity
    stated: tuple[float, ...]
    """In the file [m^3, m^2 or m]; a centroid in the component's frame, or in that of the component above."""
    read: tuple[float, ...]
    deviation: float
    """Of volumes and areas a share of what is stated, of centroids a share of the radius of gyration."""
    tolerance: float
    """Deviation up to which both count as equal."""

    @property
    def agrees(self) -> bool:
        """Whether what was read is what the file says."""
        return self.deviation <= self.tolerance


@dataclass(frozen=True, eq=False)
class Assembly:
    """A STEP file."""

    source: str
    """File name, without folders."""
    schema: str
    """AP203, AP214, AP242 ..., as the header says."""
    originating_system: str
    """CAD program that wrote it, as the header says; may be empty."""
    unit: str
    """Length unit of the file: ``mm``, ``cm``, ``m``, ``inch``, ``foot`` ..."""
    unit_scale: float
    """Metres per unit."""
    components: tuple[Component, ...]
    """The root first, then the tree in depth-first file order."""
    bodies: tuple[Body, ...]
    definitions: int = 0
    """Number of product definitions."""
    validations: tuple[Validation, ...] = ()
    """Validation properties of the file, in file order."""
    diagnostics: tuple[Diagnostic, ...] = ()
    """What the reader found; errors end the conversion."""
    facts: dict[str, str] = field(default_factory=dict)
    """Further things that `inspect` shows: encoding, time of writing, entity counts."""

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """For each component the indices of those directly below, in file order."""
        below: list[list[int]] = [[] for _ in self.components]
        for component in self.components[1:]:
            below[component.parent].append(component.index)
        return tuple(tuple(indices) for indices in below)

    def subtree(self, index: int) -> tuple[int, ...]:
        """The component and all below it, depth first."""
        found = [index]
        for child in self.children[index]:
            found += self.subtree(child)
        return tuple(found)

    def bounds(self, index: int) -> tuple[Vector3, Vector3] | None:
        """Lowest and highest corner [m] of a component and all below it, along the axes of the assembly."""
        boxes = []
        for i in self.subtree(index):
            component = self.components[i]
            if component.body >= 0 and len(self.bodies[component.body].mesh.vertices):
                boxes.append(self.bodies[component.body].mesh.moved(component.X_WC).bounds)
        return join_bounds(boxes) if boxes else None
