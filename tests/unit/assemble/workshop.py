"""Assemblies in memory, of boxes and cylinders whose volume, com and inertia are closed forms, and sidecars for them.

Arguments are in millimetres, as in CAD; results are in SI.
"""

import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from stepbot.assemble import BuiltRobot, build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Array, Pose, Vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import Rgba, Robot
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly, AxisFace, Body, BodyKind, Component
from stepbot.step.structure.naming import NamedComponent, assign_paths

MM = 1e-3
CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
BOX_FACES = np.array([face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


def at(x: float, y: float, z: float, rpy: Vector3 = (0.0, 0.0, 0.0)) -> Pose:
    """A pose with its position in mm."""
    return Pose.from_xyz_rpy((x * MM, y * MM, z * MM), rpy)


def box_inertia(size: Vector3) -> Array:
    """Inertia of a box of density 1 about its centre, from its edges [m]."""
    x, y, z = size
    return x * y * z / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])


def cylinder_inertia(radius: float, length: float) -> Array:
    """Inertia of a cylinder along z of density 1 about its centre [m]."""
    volume = np.pi * radius**2 * length
    across = volume * (3 * radius**2 + length**2) / 12
    return np.diag([across, across, 0.5 * volume * radius**2])


def axis(
    point: Vector3, direction: Vector3 = (0, 0, 1), radius: float = 4.0, length: float = 10.0, *, bore: bool = True
) -> AxisFace:
    """A cylindrical face around a point [mm]."""
    x, y, z = (MM * c for c in point)
    return AxisFace((x, y, z), direction, radius * MM, -0.5 * length * MM, 0.5 * length * MM, bore=bore)


def rod_mesh(radius: float, length: float, sides: int) -> TriMesh:
    """A prism along z inscribed in a cylinder [m]; its first corner is on the x axis."""
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    bottom, top = (np.column_stack([ring, np.full(sides, z)]) for z in (-0.5 * length, 0.5 * length))
    vertices = np.vstack([bottom, top, [[0, 0, -0.5 * length], [0, 0, 0.5 * length]]])
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        faces += [
            (i, j, sides + j),
            (i, sides + j, sides + i),
            (2 * sides, j, i),
            (2 * sides + 1, sides + i, sides + j),
        ]
    return TriMesh.of(vertices, faces)


class Workshop:
    """Collects components below a root, which has index 0."""

    def __init__(self, product: str = "robot") -> None:
        self.components: list[Component] = [Component(0, -1, "", ".", product, product, 1)]
        self.bodies: list[Body] = []
        self.measures: list[VolumeProperties | None] = []

    def group(self, name: str, parent: int = 0, X_PC: Pose = IDENTITY, occurrence: str = "") -> int:
        """A component without a body that contains others."""
        return self._add(name, parent, X_PC, occurrence)

    def box(
        self,
        name: str,
        size: Vector3 = (10, 10, 10),
        X_PC: Pose = IDENTITY,
        parent: int = 0,
        axes: Sequence[AxisFace] = (),
        density: float | None = None,
        color: Rgba | None = None,
        face_colors: Sequence[Rgba | None] = (None,),
        occurrence: str = "",
        kind: BodyKind = BodyKind.SOLID,
    ) -> int:
        """A box around its frame's origin; ``face_colors`` are assigned to its twelve triangles in turn."""
        x, y, z = (MM * c for c in size)
        properties = None
        if kind is BodyKind.SOLID:
            properties = VolumeProperties.of(x * y * z, np.zeros(3), box_inertia((x, y, z)))
        body = Body(
            kind,
            TriMesh.of(CORNERS * (x, y, z), BOX_FACES),
            np.arange(12, dtype=np.int32) % len(face_colors),
            tuple(face_colors),
            watertight=kind is BodyKind.SOLID,
            exact=properties,
            axis_faces=tuple(axes),
        )
        return self._add_body(name, parent, X_PC, occurrence, body, properties, density, color)

    def rod(
        self,
        name: str,
        radius: float = 4.0,
        length: float = 20.0,
        X_PC: Pose = IDENTITY,
        parent: int = 0,
        sides: int = 256,
        density: float | None = None,
        occurrence: str = "",
    ) -> int:
        """A cylinder along z; its mesh is an inscribed prism whose volume and inertia are those of the prism."""
        r, h = radius * MM, length * MM
        exact = VolumeProperties.of(np.pi * r * r * h, np.zeros(3), cylinder_inertia(r, h))
        # Of a regular n-gon of circumradius r, t = 2 pi / n: area n/2 r^2 sin t, polar moment area r^2 (2 + cos t) / 6.
        t = 2 * np.pi / sides
        area = 0.5 * sides * r * r * np.sin(t)
        polar = area * r * r * (2 + np.cos(t)) / 6
        across = h * 0.5 * polar + area * h * h * h / 12
        prism = VolumeProperties.of(area * h, np.zeros(3), np.diag([across, across, h * polar]))
        mesh = rod_mesh(r, h, sides)
        body = Body(
            BodyKind.SOLID,
            mesh,
            np.zeros(len(mesh.faces), dtype=np.int32),
            (None,),
            watertight=True,
            exact=exact,
            axis_faces=(axis((0, 0, 0), radius=radius, length=length, bore=False),),
        )
        return self._add_body(name, parent, X_PC, occurrence, body, prism, density, None)

    def made_of(self, index: int, material: str) -> None:
        """Set the material name of a component, as the STEP does."""
        self.components[index] = replace(self.components[index], material=material)

    def again(self, index: int, X_PC: Pose, parent: int = 0, occurrence: str = "", color: Rgba | None = None) -> int:
        """Another occurrence of a component with a body."""
        first = self.components[index]
        new = self._add(first.product, parent, X_PC, occurrence)
        self.components[new] = replace(
            self.components[new], body=first.body, definition=first.definition, density=first.density, color=color
        )
        return new

    @property
    def assembly(self) -> Assembly:
        """The assembly of the collected components, with canonical paths."""
        names = assign_paths([NamedComponent(c.parent, c.product, c.occurrence) for c in self.components])
        named = [
            replace(c, segment=n.segment, path=n.path, ordinal=n.ordinal, by_ordinal_only=n.by_ordinal_only)
            for c, n in zip(self.components, names, strict=True)
        ]
        return Assembly("robot.step", "AP214", "", "mm", MM, tuple(named), tuple(self.bodies))

    def _add(self, name: str, parent: int, X_PC: Pose, occurrence: str) -> int:
        last = self.components[-1].index
        while last != parent:
            assert last > 0, "components are added depth first"
            last = self.components[last].parent
        X_WC = self.components[parent].X_WC @ X_PC
        self.components.append(Component(len(self.components), parent, "", "", name, occurrence, 1, X_WC=X_WC))
        return len(self.components) - 1

    def _add_body(
        self,
        name: str,
        parent: int,
        X_PC: Pose,
        occurrence: str,
        body: Body,
        measure: VolumeProperties | None,
        density: float | None,
        color: Rgba | None,
    ) -> int:
        index = self._add(name, parent, X_PC, occurrence)
        number = len(self.bodies)
        self.bodies.append(body)
        self.measures.append(measure)
        self.components[index] = replace(
            self.components[index], body=number, definition=number, density=density, color=color
        )
        return index


HEAD = "version: 1\nrobot: test\nstep: robot.step\n"


def sidecar(folder: Path, text: str) -> Sidecar:
    """A valid sidecar: version, robot and step, followed by the given text."""
    path = folder / "test.robot.yaml"
    path.write_text(HEAD + textwrap.dedent(text), encoding="utf-8")
    diagnostics = Diagnostics()
    loaded = load_sidecar(path, diagnostics)
    assert loaded is not None, "\n".join(map(str, diagnostics))
    check_sidecar(loaded, diagnostics)
    assert not diagnostics.has_errors, "\n".join(map(str, diagnostics))
    return loaded


def build(shop: Workshop, folder: Path, text: str, diagnostics: Diagnostics) -> Robot | None:
    """The robot of a sidecar and the workshop's assembly."""
    return robot_of(build_robot(shop.assembly, sidecar(folder, text), lambda: shop.measures, diagnostics))


def robot_of(built: BuiltRobot | None) -> Robot | None:
    """The robot, after all diagnostics."""
    if built is None:
        return None
    built.double_counting.report()
    return built.robot


def built(shop: Workshop, folder: Path, text: str) -> Robot:
    """The robot of a sidecar without errors."""
    diagnostics = Diagnostics()
    robot = build(shop, folder, text, diagnostics)
    assert robot is not None, "\n".join(map(str, diagnostics))
    assert not diagnostics.has_errors
    return robot
