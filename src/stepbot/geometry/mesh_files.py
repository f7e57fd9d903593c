"""Triangles and colours of mesh files, read by trimesh, which opens no file that they name.

A glTF file keeps its triangles in buffers of other files: those in its folder are read.
"""

import json
from base64 import b64encode
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from msgspec import Struct

from stepbot.runtime.file import is_file, read_regular, resolved

from .mesh import TriMesh, joined, merged
from .primitives import Color, srgb_from_linear

KINDS = (".stl", ".obj", ".ply", ".dae", ".glb", ".gltf")
"""Suffixes of the files that are read."""
_COLLADA = ".dae"
_USE_OF_MATERIAL = "{http://www.collada.org/2005/11/COLLADASchema}instance_material"
_STL = ".stl"
_GLTF = ".gltf"
_LINEAR = (".glb", _GLTF)
"""Suffixes of files whose colours are linear, not sRGB."""


class MeshContent(Struct, frozen=True, eq=False):
    """The content of a mesh file, in its coordinates [m]."""

    mesh: TriMesh
    """All triangles."""
    parts: tuple[tuple[TriMesh, Color], ...] = ()
    """The triangles by colour; empty if the file gives none."""
    has_other_looks: bool = False
    """Whether it has textures, colours of vertices, or materials in another file, none of which are read."""
    buffers: tuple[Path, ...] = ()
    """The other files that its triangles were read from."""


def read_mesh(path: Path) -> TriMesh | None:
    """All triangles of a mesh file, in its coordinates [m]; None where it cannot be read."""
    content = read_content(path)
    return None if content is None else content.mesh


def read_content(path: Path) -> MeshContent | None:
    """Triangles and colours of a mesh file; None where it cannot be read.

    A Collada file states its unit, and its lengths become metres. Its ``up_axis`` is ignored, as in RViz: the
    description places the coordinates of the file.
    """
    import trimesh

    kind = path.suffix.lower()
    try:
        # From bytes: what else the file names is not opened.
        content, buffers = read_regular(path), tuple[Path, ...]()
        if kind == _GLTF:
            content, buffers = _with_buffers(content, path.parent)
        loaded, is_broken = _loaded(content, kind[1:])
        read = [mesh for mesh in _placed(loaded) if isinstance(mesh, trimesh.Trimesh)]
        unit = trimesh.units.unit_conversion(loaded.units, "meters") if kind == _COLLADA else 1.0
        meshes = [TriMesh.of(mesh.vertices * unit, mesh.faces) for mesh in read]
        if kind == _STL:
            meshes = [merged(mesh) for mesh in meshes]
        joined_mesh = joined(meshes) if meshes else None
        colors = [_color(mesh.visual, linear=kind in _LINEAR) for mesh in read] if kind in (_COLLADA, *_LINEAR) else []
        other = b"usemtl" in content if kind == ".obj" else any(_has_other_looks(mesh.visual) for mesh in read)
        other |= is_broken
    except Exception:  # noqa: BLE001 - whatever a loader raises over foreign bytes, there are no triangles
        return None
    if joined_mesh is None or not len(joined_mesh.vertices) or not bool(np.isfinite(joined_mesh.vertices).all()):
        return None
    return MeshContent(joined_mesh, _by_color(meshes, colors), other, buffers)


def _with_buffers(content: bytes, folder: Path) -> tuple[bytes, tuple[Path, ...]]:
    """A glTF file with the content of its buffers in it, and the files that they were in.

    Raises:
        ValueError: A buffer is not a regular file in the folder of the glTF file or below.
    """
    tree, files = json.loads(content), []
    for buffer in tree.get("buffers", []):
        uri = buffer["uri"]
        if uri.startswith("data:"):
            continue
        file = resolved(folder / unquote(uri))
        if not (file.is_relative_to(resolved(folder)) and is_file(file)):
            raise ValueError(f"'{uri}' is not a file in the folder of the mesh")
        buffer["uri"] = f"data:application/octet-stream;base64,{b64encode(read_regular(file)).decode('ascii')}"
        files.append(file)
    return json.dumps(tree).encode(), tuple(files)


def _loaded(content: bytes, kind: str) -> tuple[Any, bool]:
    """The scene of a file, and whether materials are left out that refer to what the file lacks.

    With these, trimesh would leave out the shapes that have them.
    """
    import trimesh

    if kind != _COLLADA[1:]:
        return trimesh.load_scene(BytesIO(content), file_type=kind, process=False), False
    import collada

    try:
        return trimesh.load_scene(BytesIO(content), file_type=kind, process=False, ignore_broken=False), False
    except collada.common.DaeError:
        broken = collada.Collada(BytesIO(content), ignore=[collada.common.DaeError])
    known = {f"#{material.id}" for material in broken.materials}
    wrong = [
        (parent, one)
        for parent in broken.xmlnode.getroot().iter()
        for one in parent
        if one.tag == _USE_OF_MATERIAL and one.get("target") not in known
    ]
    for parent, one in wrong:
        parent.remove(one)
    mended = BytesIO()
    broken.xmlnode.write(mended)
    mended.seek(0)
    return trimesh.load_scene(mended, file_type=kind, process=False), bool(wrong)


def _placed(scene: Any) -> list[Any]:
    """The geometries of a scene at their places, in the order of the file, which the nodes of the scene do not keep."""
    order = {name: index for index, name in enumerate(scene.geometry)}
    placed = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        placed.append((order[name], str(node), scene.geometry[name].copy().apply_transform(transform)))
    return [mesh for _, _, mesh in sorted(placed, key=lambda one: one[:2])]


def _color(visual: Any, *, linear: bool) -> Color | None:
    """The colour of a material; None if it gives none."""
    material: Any = getattr(visual, "material", None)
    given = getattr(material, "baseColorFactor", None) if hasattr(material, "baseColorFactor") else material
    if given is None:
        return None
    r, g, b, a = (float(channel) / 255.0 for channel in material.main_color)
    if linear:
        r, g, b = map(srgb_from_linear, (r, g, b))
    red, green, blue, opacity = (round(channel, 4) for channel in (r, g, b, a))
    return red, green, blue, opacity


def _has_other_looks(visual: Any) -> bool:
    material = getattr(visual, "material", None)
    images = (getattr(material, name, None) for name in ("image", "baseColorTexture"))
    return any(image is not None for image in images) or visual.kind in ("vertex", "face")


def _by_color(meshes: Sequence[TriMesh], colors: Sequence[Color | None]) -> tuple[tuple[TriMesh, Color], ...]:
    """The meshes joined by colour, in the order of the file; none unless every mesh has a colour."""
    groups: dict[Color, list[TriMesh]] = {}
    for mesh, color in zip(meshes, colors, strict=False):
        if color is None:
            return ()
        groups.setdefault(color, []).append(mesh)
    return tuple((joined(of_color), color) for color, of_color in groups.items())
