"""STL, glTF and COLLADA files, read back by trimesh, by pycollada, and by the layouts of the specifications."""

import json
import struct
from io import BytesIO
from xml.etree import ElementTree as ET

import collada
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_bytes import dae_bytes, glb_bytes, stl_bytes
from stepbot.geometry.shading import corner_normals, unit_normals
from tests.meshes import dented_box

ORANGE = (0.8, 0.4, 0.1, 1.0)
GLASS = (0.1, 0.5, 0.9, 0.25)

meshes = st.lists(st.tuples(*[st.floats(-100, 100)] * 3), min_size=4, max_size=12).map(
    lambda points: TriMesh.of(points, [(0, 1, 2), (3, 2, 1), *((i, i - 1, 0) for i in range(4, len(points)))])
)


def glb_chunks(content: bytes) -> tuple[dict, bytes]:  # type: ignore[type-arg]
    """JSON and binary data of a glTF file, by the layout in its specification."""
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert (kind, size % 4) == (b"JSON", 0)
    rest = 20 + size
    data, binary = struct.unpack_from("<I4s", content, rest)
    assert (binary, data % 4, rest + 8 + data) == (b"BIN\0", 0, len(content))
    return json.loads(content[20:rest]), content[rest + 8 :]


@settings(max_examples=25)
@given(meshes)
def test_stl_has_the_triangles_in_single_precision(mesh: TriMesh) -> None:
    """trimesh reads every triangle in its place, in metres, and the normals are those of the triangles."""
    read = trimesh.load_mesh(BytesIO(stl_bytes(mesh)), file_type="stl", process=False)
    np.testing.assert_array_equal(read.triangles, mesh.vertices[mesh.faces].astype(np.float32))


@settings(max_examples=25)
@given(meshes)
def test_glb_has_triangles_and_normals_in_single_precision(mesh: TriMesh) -> None:
    """trimesh reads every triangle, and the normals of its corners, at the root of the scene."""
    scene = trimesh.load_scene(BytesIO(glb_bytes(mesh, "part", ORANGE)), file_type="glb", process=False)
    (node,) = scene.graph.nodes_geometry
    transform, name = scene.graph[node]
    np.testing.assert_array_equal(transform, np.eye(4))
    read = scene.geometry[name]
    np.testing.assert_array_equal(read.triangles, mesh.vertices[mesh.faces].astype(np.float32))
    normals = corner_normals(mesh.vertices, mesh.faces)
    np.testing.assert_allclose(read.vertex_normals[read.faces], normals, atol=6e-7)


@pytest.mark.parametrize("rgba", [ORANGE, GLASS])
def test_glb_is_laid_out_as_specified(rgba: tuple[float, float, float, float]) -> None:
    """Accessors lie in their buffer and state the extent; colours are linear, glass is blended."""
    mesh = dented_box(0.2)
    content, binary = glb_chunks(glb_bytes(mesh, "part", rgba))
    positions, _, indices = content["accessors"]
    views = content["bufferViews"]
    assert sum(view["byteLength"] for view in views) == content["buffers"][0]["byteLength"] <= len(binary)
    start = np.frombuffer(binary, "<f4", positions["count"] * 3, views[0]["byteOffset"]).reshape(-1, 3)
    assert (positions["min"], positions["max"]) == (start.min(axis=0).tolist(), start.max(axis=0).tolist())
    numbers = np.frombuffer(binary, "<u4", indices["count"], views[2]["byteOffset"]).reshape(-1, 3)
    np.testing.assert_array_equal(start[numbers], mesh.vertices[mesh.faces].astype(np.float32))
    (material,) = content["materials"]
    srgb = np.array(rgba[:3])
    expected = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(material["pbrMetallicRoughness"]["baseColorFactor"], [*expected, rgba[3]], atol=1e-9)
    assert material.get("alphaMode") == ("BLEND" if rgba[3] < 1.0 else None)
    assert "rotation" not in content["nodes"][0]
    assert "matrix" not in content["nodes"][0]


@settings(max_examples=25)
@given(meshes)
def test_dae_has_every_coordinate_to_the_nanometre(mesh: TriMesh) -> None:
    """Pycollada reads equal vertices and faces, in metres with z up."""
    content = dae_bytes(mesh, "part", ORANGE)
    read = collada.Collada(BytesIO(content))
    assert (read.assetInfo.unitmeter, read.assetInfo.upaxis) == (1.0, "Z_UP")
    (geometry,) = read.geometries
    (triangles,) = geometry.primitives
    np.testing.assert_array_equal(triangles.vertex, mesh.vertices.astype(np.float32))  # pycollada's precision
    text = ET.fromstring(content).findtext(".//{*}float_array[@id='positions-array']") or ""
    np.testing.assert_array_equal(np.array(text.split(), float).reshape(-1, 3), mesh.vertices)
    np.testing.assert_array_equal(triangles.vertex_index, mesh.faces)
    normals = corner_normals(mesh.vertices, mesh.faces)
    np.testing.assert_allclose(triangles.normal[triangles.normal_index], normals, atol=6e-7)


@pytest.mark.parametrize("rgba", [ORANGE, GLASS])
def test_dae_has_the_colour(rgba: tuple[float, float, float, float]) -> None:
    """Pycollada reads the colour and the opacity."""
    read = collada.Collada(BytesIO(dae_bytes(dented_box(0.2), "part", rgba)))
    (effect,) = read.effects
    assert effect.diffuse[:3] == pytest.approx(rgba[:3], abs=1e-9)
    opacity = 1.0 if effect.transparent is None else effect.transparent[3] * effect.transparency
    assert opacity == pytest.approx(rgba[3], abs=1e-9)


def test_normals_point_outwards() -> None:
    """Normals of STL are those that trimesh computes from the corners; a face without area has z."""
    mesh = dented_box(0.2)
    facets = np.frombuffer(stl_bytes(mesh)[84:], np.dtype([("normal", "<f4", 3), ("rest", "V38")]))
    np.testing.assert_allclose(facets["normal"], trimesh.Trimesh(mesh.vertices, mesh.faces).face_normals, atol=1e-7)
    flat = TriMesh.of([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 1, 3)])
    np.testing.assert_array_equal(unit_normals(flat), [(0, 0, 1), (0, 0, 1)])


def test_small_meshes_have_four_vertices_in_stl() -> None:
    """MuJoCo requires four: a triangle is split around its centre."""
    triangle = TriMesh.of([(0, 0, 0), (3, 0, 0), (0, 3, 0)], [(0, 1, 2)])
    read = trimesh.load_mesh(BytesIO(stl_bytes(triangle)), file_type="stl")
    assert (len(read.vertices), len(read.faces), read.area) == (4, 3, pytest.approx(4.5))
