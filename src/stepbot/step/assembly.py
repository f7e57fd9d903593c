"""The content of a STEP file as plain data in SI: the tree, each body once, the axes that joints can bind to.

Independent of the geometry kernel. Frames: W is the assembly (the STEP's own frame), C a component, D the definition
that a component is an occurrence of; C and D coincide, so a body's coordinates in D are coordinates in C.
"""

from enum import StrEnum
from functools import cached_property

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray

from stepbot.diagnostics import Diagnostic
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Array, Matrix3, Pose, Vector3, join_bounds, vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import Rgba

from .faces import Face

CERTAIN = 1e-3
"""Relative error of mass properties up to which they are reliable."""
USABLE = 0.1
"""The same up to which a robot is built with them, with a warning: densities are seldom known better."""
SMALL = 0.01
"""Size [m] of an assembly below which distances that decide shrink with it: fits of watches, grippers of endoscopes."""
_FINEST = 0.05
"""Least factor: below half a millimetre, selectors to the micrometre would no longer find what they select."""
ROOT_PATH = "."
"""Path of the root of the assembly."""


class MeshTolerance(Struct, frozen=True):
    """Tolerance of a mesh."""

    relative: float = 0.002
    """Chordal deviation as a share of the solid's diagonal; used if ``absolute`` is 0."""
    absolute: float = 0.0
    """Chordal deviation [m]."""
    angle: float = 0.2617993877991494
    """Angular deviation [rad] between adjacent facets; 15 degrees."""


class ReadOptions(Struct, frozen=True):
    """What to compute while a STEP file is read."""

    tolerance: MeshTolerance = MeshTolerance()
    tolerance_of: tuple[tuple[str, MeshTolerance], ...] = ()
    """Component path or glob (see :mod:`.structure.paths`) and its own tolerance; the nearest match wins."""
    refine_mass_to: float = 0.0
    """Relative deviation from the exact mass properties to refine a measuring mesh to; 0 for no such mesh."""
    encoding: str = ""
    """Declared code page of names, if they are neither ASCII nor UTF-8; empty for none."""
    geometry: bool = True
    """Whether bodies are meshed and measured; False reads only the tree."""
    faces: bool = False
    """Whether to keep every face of each body (:attr:`Body.faces`), which only inference needs."""


class BodyKind(StrEnum):
    """The type of geometry of a body."""

    SOLID = "solid"
    SURFACE = "surface"
    """Faces that enclose no volume."""
    TESSELLATED = "tessellated"
    """Triangles without exact geometry; a closed one has a volume."""
    WIRE = "wire"
    """Curves and points only, without surface or volume."""


class AxisFace(Struct, frozen=True):
    """A cylindrical or conical face: a line that a joint can turn about or slide along."""

    point: Vector3
    """A point of the axis [m], in the frame of the face."""
    direction: Vector3
    """Unit direction; its sign has no meaning."""
    radius: float
    """Radius [m]; of a cone, the larger one."""
    low: float
    """Start of the face along ``direction`` from ``point`` [m]."""
    high: float
    """End of the face along ``direction`` from ``point`` [m]."""
    bore: bool
    """Whether material is outside (a hole) or inside (a shaft)."""
    cone: bool = False

    def moved(self, X_AB: Pose) -> "AxisFace":
        """This face, given in B, expressed in A."""
        x, y, z = X_AB.apply(self.point).tolist()
        u, v, w = X_AB.turn(self.direction).tolist()
        return AxisFace((x, y, z), (u, v, w), self.radius, self.low, self.high, self.bore, self.cone)


class Body(Struct, frozen=True, eq=False):
    """One solid or surface of a definition: meshed and measured once for all its occurrences."""

    kind: BodyKind
    mesh: TriMesh
    """In the definition's frame; without faces for a wire."""
    face_colors: NDArray[np.int32]
    """Shape (m,): for each face of the mesh an index into ``colors``."""
    colors: tuple[Rgba | None, ...]
    """Colours in the STEP; None for faces without own colour, which take the component's."""
    watertight: bool
    """Whether every edge of the mesh joins exactly two consistently oriented faces."""
    defect: str = ""
    """Why the body is not watertight or has no volume, for messages; empty otherwise."""
    exact: VolumeProperties | None = None
    """From the exact B-rep; None without a volume."""
    exact_error: float = 0.0
    """Estimated relative error of ``exact``; 0 without an estimate, unconfirmed above :data:`CERTAIN`."""
    refined: VolumeProperties | None = None
    """By trimesh from the measuring mesh of ``ReadOptions.refine_mass_to``; None if not requested."""
    axis_faces: tuple[AxisFace, ...] = ()
    """In the definition's frame, in file order."""
    area: float = 0.0
    """Exact area [m^2] of all faces, integrated only for files that state areas; otherwise 0."""
    faces: tuple[Face, ...] = ()
    """Every face, in file order; only with ``ReadOptions.faces``."""
    face_counts: tuple[tuple[str, int], ...] = ()
    """How many faces lie on each kind of surface, by the name of the kind; none for a body of triangles or curves."""

    @property
    def has_volume(self) -> bool:
        """Whether it encloses a volume: a solid, or a closed mesh."""
        return self.kind is BodyKind.SOLID or (self.kind is BodyKind.TESSELLATED and self.watertight)


class Component(Struct, frozen=True):
    """One occurrence in the assembly tree."""

    index: int
    """Index in :attr:`Assembly.components`."""
    parent: int
    """Index of the component above; -1 for the root."""
    segment: str
    """Last segment of the canonical path, escaped, with ``#n`` for siblings that share it."""
    path: str
    """Canonical path, unique; used by `inspect` and messages. ``.`` for the root."""
    product: str
    """Name of the product in the STEP; may be empty."""
    occurrence: str
    """Name of the occurrence in the STEP; may be empty or generated."""
    ordinal: int
    """n among the siblings that share the product name, from 1 in file order."""
    X_WC: Pose = IDENTITY
    """Pose in the assembly."""
    body: int = -1
    """Index in :attr:`Assembly.bodies`; -1 for a component without own body."""
    definition: int = -1
    """Index of the definition; components of one definition have the same shape."""
    color: Rgba | None = None
    """Colour of the occurrence, or of the part for faces without own colour."""
    material: str = ""
    """Name of the material in the STEP; may be empty."""
    density: float | None = None
    """Density [kg/m^3] in the STEP; None if it has none."""
    by_ordinal_only: bool = False
    """Whether only ``#n`` distinguishes it from a sibling: such a path breaks when the CAD inserts a part."""
    missing: str = ""
    """Name of the file with its shape, if that could not be read: an error, and the assembly is incomplete."""


class Quantity(StrEnum):
    """The quantity of a validation property, stated by the CAD program for readers to compare."""

    VOLUME = "volume"
    AREA = "area"
    CENTROID = "centroid"


class Validation(Struct, frozen=True):
    """A validation property of the file, compared with the geometry that was read."""

    component: int
    """Index of the first component that it refers to."""
    quantity: Quantity
    stated: tuple[float, ...]
    """In the file [m^3, m^2 or m]; a centroid in the component's frame, or in its parent's."""
    read: tuple[float, ...]
    deviation: float
    """Volumes and areas relative to the stated value, centroids relative to the radius of gyration."""
    tolerance: float
    """Deviation up to which both count as equal."""

    @property
    def agrees(self) -> bool:
        """Whether the geometry that was read matches the file's value."""
        return self.deviation <= self.tolerance


class Assembly(Struct, frozen=True, eq=False, dict=True):
    """A STEP file."""

    source: str
    """File name, without folders."""
    schema: str
    """AP203, AP214, AP242 ..., from the header."""
    originating_system: str
    """CAD program that wrote it, from the header; may be empty."""
    unit: str
    """Length unit of the file: ``mm``, ``cm``, ``m``, ``inch``, ``foot`` ..."""
    unit_scale: float
    """Metres per unit."""
    components: tuple[Component, ...]
    """The root first, then the tree in depth-first file order."""
    bodies: tuple[Body, ...]
    definitions: int = 0
    """Number of product definitions."""
    external_files: tuple[str, ...] = ()
    """Further files that hold shapes of parts, relative to the folder of this one, with slashes."""
    validations: tuple[Validation, ...] = ()
    """Validation properties of the file, in file order."""
    diagnostics: tuple[Diagnostic, ...] = ()
    """Diagnostics of the reader; errors end the conversion."""
    facts: dict[str, str] = field(default_factory=dict)
    """Further facts for `inspect`: encoding, time of writing, entity counts."""

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """For each component, the indices of its children, in file order."""
        below: list[list[int]] = [[] for _ in self.components]
        for component in self.components[1:]:
            below[component.parent].append(component.index)
        return tuple(tuple(indices) for indices in below)

    @cached_property
    def index_of(self) -> dict[str, int]:
        """The index of the component at each path."""
        return {component.path: component.index for component in reversed(self.components)}

    @cached_property
    def first_of_body(self) -> dict[int, int]:
        """For each body the index of its first component."""
        return {body: indices[0] for body, indices in self.occurrences.items()}

    @cached_property
    def occurrences(self) -> dict[int, tuple[int, ...]]:
        """For each body the indices of its components, in file order."""
        instances: dict[int, list[int]] = {}
        for component in self.components:
            if component.body >= 0:
                instances.setdefault(component.body, []).append(component.index)
        return {body: tuple(indices) for body, indices in instances.items()}

    def subtree(self, index: int) -> tuple[int, ...]:
        """The component and everything below it, depth first."""
        members = [index]
        for child in self.children[index]:
            members += self.subtree(child)
        return tuple(members)

    @cached_property
    def fineness(self) -> float:
        """Factor of the distances that decide about fits and gaps: 1 unless the assembly is smaller than 10 mm."""
        if any(len(body.mesh.vertices) and _longest(body.mesh.bounds) >= SMALL for body in self.bodies):
            return 1.0
        box = self.bounds(0)
        return 1.0 if box is None else round(min(max(_longest(box) / SMALL, _FINEST), 1.0), 3)

    def bounds(self, index: int) -> tuple[Vector3, Vector3] | None:
        """Lowest and highest corner [m] of a component and everything below it, along the axes of the assembly."""
        boxes = []
        turned: dict[tuple[int, Matrix3], Array] = {}  # one box for all bodies that are turned alike
        for i in self.subtree(index):
            body, X_WC = self.components[i].body, self.components[i].X_WC
            if body >= 0 and len(self.bodies[body].mesh.vertices):
                key = body, X_WC.rotation
                if key not in turned:
                    turned[key] = np.array(self.bodies[body].mesh.moved(Pose(X_WC.rotation)).bounds)
                low, high = (turned[key] + X_WC.p).tolist()
                boxes.append((vector3(low), vector3(high)))
        return join_bounds(boxes) if boxes else None


def _longest(box: tuple[Vector3, Vector3]) -> float:
    return max(high - low for low, high in zip(*box, strict=True))
