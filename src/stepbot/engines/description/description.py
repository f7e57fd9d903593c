"""The content of a description."""

from collections.abc import Iterable, Mapping, Sequence
from math import pi
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot.diagnostics import Span
from stepbot.engines.resources import resolve
from stepbot.geometry.mesh import TriMesh, revolved
from stepbot.geometry.mesh_files import KINDS, MeshContent, read_content
from stepbot.geometry.primitives import Primitive, half_size
from stepbot.geometry.spatial import IDENTITY, Array, Pose, box_corners
from stepbot.robot.model import Rgba
from stepbot.robot.surfaces import PLAIN, Surface
from stepbot.robot.tuning import DEFAULTS, Simulation
from stepbot.runtime.file import resolved

from ..observation import Observation
from ..urdf_versions import Newer
from .vocabulary import Unread


class MeshFiles:
    """Reads each mesh file of a description once."""

    def __init__(self, description: Path, packages: Iterable[Path] = ()) -> None:
        self._description, self._packages = description, tuple(packages)
        self._contents: dict[str, MeshContent | None] = {}
        self._files: list[Path] = []

    def mesh(self, uri: str, scale: tuple[float, ...] = (1.0, 1.0, 1.0)) -> TriMesh | None:
        """Triangles in the file, scaled; None if it is missing or unreadable."""
        content = self._content(uri)
        return None if content is None else _scaled(content.mesh, scale)

    def parts(
        self, uri: str, scale: tuple[float, ...], rgba: Rgba | None, *, whole: bool
    ) -> tuple[tuple[TriMesh, Rgba | None], ...]:
        """Triangles in the file, scaled, with the colour of each part; none if it is unreadable.

        Args:
            rgba: The colour that the description gives; None for those of the file.
            whole: Whether the file is one part, whatever its colours.
        """
        content = self._content(uri)
        if content is None:
            return ()
        one_part = ((content.mesh, rgba),)
        parts = one_part if whole or rgba is not None else content.parts or one_part
        return tuple((_scaled(mesh, scale), color) for mesh, color in parts)

    def _content(self, uri: str) -> MeshContent | None:
        if uri not in self._contents:
            self._contents[uri] = self._read(uri)
        return self._contents[uri]

    @property
    def unread(self) -> tuple[str, ...]:
        """The unreadable files, as named in the description, sorted."""
        return tuple(sorted(uri for uri, content in self._contents.items() if content is None))

    @property
    def plain(self) -> tuple[str, ...]:
        """The files whose textures or further colours are not read, as named in the description, sorted."""
        return tuple(sorted(uri for uri, content in self._contents.items() if content and content.has_other_looks))

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that were read, in the order of the description."""
        return tuple(dict.fromkeys(self._files))

    def _read(self, uri: str) -> MeshContent | None:
        path = resolve(uri, self._description, self._packages)
        if path is None or path.suffix.lower() not in KINDS:
            return None
        content = read_content(path)
        self._files += [resolved(path), *(content.buffers if content else ())]
        return content


def _scaled(mesh: TriMesh, scale: tuple[float, ...]) -> TriMesh:
    if scale == (1.0, 1.0, 1.0):
        return mesh
    faces = mesh.faces if scale[0] * scale[1] * scale[2] > 0.0 else mesh.faces[:, ::-1]  # mirrored
    return TriMesh.of(mesh.vertices * scale, faces)


_AROUND = 24
"""Number of vertices around the axis of a shape that a mesh approximates."""


def ellipsoid_mesh(radii: Sequence[float]) -> TriMesh:
    """An ellipsoid around the origin, by its half axes [m]."""
    angles = np.linspace(-pi / 2, pi / 2, _AROUND // 2 + 1)
    ball = revolved(np.stack((np.cos(angles), np.sin(angles)), axis=1), _AROUND)
    return TriMesh.of(ball.vertices * radii, ball.faces)


def cone_mesh(radius: float, length: float) -> TriMesh:
    """A cone along z around the origin [m], with its tip upwards."""
    return revolved(np.array([(0.0, -0.5), (radius, -0.5), (0.0, 0.5)]) * (1.0, length), _AROUND)


class DescribedShape(Struct, frozen=True, eq=False):
    """A visual or a collision of a link."""

    link: str
    name: str
    """Name of the shape, else of its mesh file; may be empty."""
    geometry: TriMesh | Primitive
    X_LG: Pose
    rgba: Rgba | None = None
    """Colour; None if the file gives none."""
    collides: bool = False
    """Whether it is a collision; otherwise a visual."""
    surface: Surface = PLAIN
    """Contact properties of a collision."""
    mesh: str = ""
    """Its mesh, as named in the description; empty for a primitive."""
    approximated: str = ""
    """The shape that a mesh approximates, with its article; empty for none."""
    piece: int = 0
    """Number of its colour among those of its mesh, each of which is a shape."""

    @property
    def points(self) -> Array:
        """Vertices (n, 3) [m] in the frame of the link; for a primitive the corners of its bounding box."""
        if isinstance(self.geometry, TriMesh):
            return self.X_LG.apply(self.geometry.vertices)
        x, y, z = half_size(self.geometry)
        return self.X_LG.apply(box_corners((-x, -y, -z), (x, y, z)))


class OpenLimit(Struct, frozen=True):
    """A joint whose file lacks a position limit."""

    joint: str
    line: int
    missing: tuple[str, ...]
    """``lower``, ``upper``, or both."""
    has_element: bool


class Description(Struct, frozen=True, eq=False):
    """A description, independent of the engine that read it."""

    observation: Observation
    X_PC: Mapping[str, Pose]
    """For each child link its pose in its parent with all joints at 0."""
    shapes: tuple[DescribedShape, ...]
    """Visuals and collisions, in the order of the file."""
    unread: tuple[str, ...] = ()
    """Mesh files that are missing or of an unsupported type, as named in the description."""
    lost: tuple[Unread, ...] = ()
    """Elements and attributes of the file that are not read."""
    files: tuple[Path, ...] = ()
    """The other files that were read: included files, meshes."""
    X_WR: Pose = IDENTITY
    """Pose of the root link in the world of the file."""
    free_roots: tuple[str, ...] = ()
    """Links that nothing holds in the world."""
    plain_meshes: tuple[str, ...] = ()
    """Mesh files whose textures or further colours are not read, as named in the description."""
    unsupported: tuple[str, ...] = ()
    """Constraints that are neither closures nor mimics, in words."""
    simulation: Simulation = DEFAULTS
    """Settings that the file states."""
    assumed: tuple[str, ...] = ()
    """Links whose mass properties the file does not give: the format defines them otherwise."""
    without_inertia: tuple[str, ...] = ()
    """Links with a mass and no inertia: ROS, MuJoCo and PyBullet reject a URDF with one."""
    open_limits: tuple[OpenLimit, ...] = ()
    """Position limits that are missing, although the format requires them."""
    expanded: bytes = b""
    """The URDF that the macros of the file expand to; empty for a file without macros."""
    places: tuple[Span, ...] = ()
    """For each line of the expanded URDF, where it is stated."""
    newer: tuple[Newer, ...] = ()
    """What readers of the version that the file states ignore."""

    def place(self, file: str, line: int) -> Span:
        """The place of what the description states in a line of ``file``, or in the URDF that it expands to."""
        return self.places[line] if 0 < line < len(self.places) else Span(file, line)

    @property
    def seen(self) -> tuple[DescribedShape, ...]:
        """The visuals of each link, or its collisions if it has none."""
        with_visuals = {shape.link for shape in self.shapes if not shape.collides}
        return tuple(shape for shape in self.shapes if not shape.collides or shape.link not in with_visuals)
