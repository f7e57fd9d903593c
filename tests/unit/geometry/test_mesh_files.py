"""Mesh files against the coordinates that their formats define."""

import base64
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from stepbot.geometry.mesh import TriMesh
from stepbot.runtime.worker import Worker

_CORNERS = np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0], [0.0, 0.0, 20.0]])
"""Corners of a tetrahedron, in the file's unit."""
_FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
_OFFSET = np.array([5.0, 6.0, 7.0])
"""Translation of its node."""

_COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>{unit}<up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="12">{points}</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>5 6 7</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def _collada(folder: Path, unit: str, up: str = "Z_UP") -> Path:
    path = folder / "part.dae"
    points, faces = (" ".join(map(str, values.ravel().tolist())) for values in (_CORNERS, _FACES))
    path.write_text(_COLLADA.format(unit=unit, up=up, points=points, faces=faces))
    return path


def _gltf() -> tuple[dict[str, object], bytes]:
    """The tetrahedron as glTF 2.0: its JSON without the buffer's place, and the buffer."""
    points, faces = _CORNERS.astype("<f4").tobytes(), _FACES.astype("<u2").tobytes()
    content: dict[str, object] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": _OFFSET.tolist()}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": _CORNERS.min(axis=0).tolist(),
                "max": _CORNERS.max(axis=0).tolist(),
            },
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(faces)},
        ],
    }
    return content, points + faces


def _read(path: Path) -> TriMesh | None:
    """The mesh of a file, read as for a robot description, in a process of its own."""
    with Worker("stepbot.geometry.mesh_files:read_mesh") as worker:
        mesh: TriMesh | None = worker.submit(path).result(60)
    return mesh


def _corners(path: Path) -> set[tuple[float, ...]]:
    mesh = _read(path)
    assert mesh is not None
    assert len(mesh.faces) == len(_FACES)
    return {tuple(point) for point in np.round(mesh.vertices, 9).tolist()}


def _expected(unit: float) -> set[tuple[float, ...]]:
    return {tuple(point) for point in np.round((_CORNERS + _OFFSET) * unit, 9).tolist()}


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("", 1.0), ('<unit name="mm" meter="0.001"/>', 1e-3), ('<unit name="inch" meter="0.0254"/>', 0.0254)],
)
def test_collada_is_read_in_metres(tmp_path: Path, unit: str, metres: float) -> None:
    """Lengths of a Collada file are multiplied by the unit that it states, and its nodes place the geometry."""
    assert _corners(_collada(tmp_path, unit)) == _expected(metres)


def test_up_axis_of_collada_is_ignored(tmp_path: Path) -> None:
    """The description places the coordinates of the file, whatever its up axis, as in RViz."""
    assert _corners(_collada(tmp_path, "", up="Y_UP")) == _expected(1.0)


def test_collada_without_its_materials(tmp_path: Path) -> None:
    """A shape whose material the file lacks is read, and its colour is known to be missing."""
    from stepbot.geometry.mesh_files import read_content

    path, node = _collada(tmp_path, ""), '<instance_geometry url="#g"'
    use = "<technique_common><instance_material symbol='m' target='#m'/></technique_common>"
    path.write_text(
        path.read_text().replace(f"{node}/>", f"{node}><bind_material>{use}</bind_material></instance_geometry>")
    )
    content = read_content(path)
    assert content is not None
    assert content.has_other_looks
    assert _corners(path) == _expected(1.0)


def test_gltf_with_its_data_inside(tmp_path: Path) -> None:
    """Binary glTF, and glTF with an embedded buffer, have the points of the specification."""
    content, buffer = _gltf()
    embedded = tmp_path / "part.gltf"
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    embedded.write_text(json.dumps({**content, "buffers": [{"byteLength": len(buffer), "uri": uri}]}))
    text = json.dumps({**content, "buffers": [{"byteLength": len(buffer)}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(buffer), 0x004E4942) + buffer
    binary = tmp_path / "part.glb"
    binary.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    assert _corners(embedded) == _corners(binary) == _expected(1.0)


def test_a_gltf_reads_buffers_of_its_own_folder_alone(tmp_path: Path) -> None:
    """A buffer beside the file or below is read; one elsewhere is not opened, and the mesh counts as unreadable."""
    content, buffer = _gltf()
    folder = tmp_path / "meshes"
    folder.mkdir()
    (folder / "part.bin").write_bytes(buffer)
    (tmp_path / "outside.bin").write_bytes(buffer)
    (folder / "link.bin").symlink_to(tmp_path / "outside.bin")
    path = folder / "part.gltf"
    for uri, is_read in (("part.bin", True), ("../outside.bin", False), ("link.bin", False)):
        path.write_text(json.dumps({**content, "buffers": [{"byteLength": len(buffer), "uri": uri}]}))
        assert (_read(path) is not None) == is_read, uri


def test_colors_of_materials_split_a_mesh(tmp_path: Path) -> None:
    """A glTF of two materials has two parts in their colours, converted from linear to sRGB."""
    import trimesh

    from stepbot.geometry.mesh_files import read_content

    scene = trimesh.Scene()
    for x, color in ((0.0, [255, 0, 0, 255]), (1.0, [0, 55, 0, 255])):
        mesh = trimesh.creation.box(bounds=[[x, 0, 0], [x + 0.5, 1, 1]])
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=color)
        mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=material)
        scene.add_geometry(mesh)
    path = tmp_path / "two.glb"
    path.write_bytes(scene.export(file_type="glb"))
    content = read_content(path)
    assert content is not None
    assert not content.has_other_looks
    assert [color for _, color in content.parts] == [
        (1.0, 0.0, 0.0, 1.0),
        (0.0, pytest.approx(1.055 * (55 / 255) ** (1 / 2.4) - 0.055, abs=1e-4), 0.0, 1.0),
    ]
    assert [len(mesh.faces) for mesh, _ in content.parts] == [12, 12]
