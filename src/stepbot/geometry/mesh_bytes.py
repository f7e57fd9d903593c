"""The bytes of STL, glTF and COLLADA files with one triangle mesh, in metres; :mod:`.mesh` has OBJ.

Coordinates are those of the mesh, whatever axis a format calls up: a description places the coordinates of its mesh
files, and Gazebo and RViz take them as they are (glTF's y is up for viewers of glTF alone). STL and glTF store them in
single precision. Nothing depends on the clock or on the version of a library.

Formats: https://www.loc.gov/preservation/digital/formats/fdd/fdd000505.shtml,
https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, https://www.khronos.org/files/collada_spec_1_4.pdf.
"""

import json
from struct import pack

import numpy as np
from numpy.typing import NDArray

from .fixed_point import distinct_rows, fixed_point_lines
from .mesh import GRID_DECIMALS, GRID_PER_METRE, TriMesh, with_four_vertices
from .primitives import Color, linear_from_srgb
from .shading import NORMAL_DECIMALS, shaded, unit_normals

_STL_TITLE = b"stepbot, metres"
"""Must not begin with ``solid``, as text files do."""
_STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])

_GLB_VERSION, _JSON, _BINARY = 2, b"JSON", b"BIN\0"
_VERTICES, _INDICES = 34962, 34963
"""Targets of buffer views."""
_FLOAT, _UNSIGNED = 5126, 5125
"""Types of components."""
_ROUGHNESS = 0.5
_COLOR_DECIMALS = 9

_NO_DATE = "1970-01-01T00:00:00Z"
"""COLLADA requires dates, which would change with every run."""
_COLLADA = """\
<?xml version="1.0" encoding="UTF-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <created>{date}</created>
    <modified>{date}</modified>
    <unit name="meter" meter="1"/>
    <up_axis>Z_UP</up_axis>
  </asset>
  <library_effects>
    <effect id="color-effect">
      <profile_COMMON>
        <technique sid="common">
          <lambert>
            <diffuse><color>{color}</color></diffuse>{transparency}
          </lambert>
        </technique>
      </profile_COMMON>
    </effect>
  </library_effects>
  <library_materials>
    <material id="color" name="color"><instance_effect url="#color-effect"/></material>
  </library_materials>
  <library_geometries>
    <geometry id="mesh" name="{name}">
      <mesh>
{positions}{normals}        <vertices id="vertices"><input semantic="POSITION" source="#positions"/></vertices>
        <triangles material="color" count="{faces}">
          <input semantic="VERTEX" source="#vertices" offset="0"/>
          <input semantic="NORMAL" source="#normals" offset="1"/>
          <p>{corners}</p>
        </triangles>
      </mesh>
    </geometry>
  </library_geometries>
  <library_visual_scenes>
    <visual_scene id="scene">
      <node id="node" name="{name}">
        <instance_geometry url="#mesh">
          <bind_material><technique_common>
            <instance_material symbol="color" target="#color"/>
          </technique_common></bind_material>
        </instance_geometry>
      </node>
    </visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""
_SOURCE = """\
        <source id="{name}">
          <float_array id="{name}-array" count="{numbers}">{values}</float_array>
          <technique_common>
            <accessor source="#{name}-array" count="{rows}" stride="3">
              <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
            </accessor>
          </technique_common>
        </source>
"""
_TRANSPARENCY = """
            <transparent opaque="A_ONE"><color>1 1 1 {opacity}</color></transparent>
            <transparency><float>1</float></transparency>"""


def stl_bytes(mesh: TriMesh) -> bytes:
    """Binary STL, which has no colours, in metres."""
    mesh = with_four_vertices(mesh)
    facets = np.zeros(len(mesh.faces), _STL_FACET)
    facets["normal"] = unit_normals(mesh)
    facets["corners"] = mesh.vertices[mesh.faces]
    return _STL_TITLE.ljust(80) + pack("<I", len(facets)) + facets.tobytes()


def glb_bytes(mesh: TriMesh, name: str, rgba: Color) -> bytes:
    """Binary glTF 2.0 of one material, with a vertex for each normal at a point."""
    normals, which = shaded(mesh)
    corners = np.stack([mesh.faces.ravel(), which.ravel()], axis=1)
    first, indices = distinct_rows(corners)
    points, directions = corners[first].T
    positions = mesh.vertices[points].astype("<f4")
    units = (normals[directions] / 10.0**NORMAL_DECIMALS).astype("<f4")
    binary = [positions.tobytes(), units.tobytes(), indices.astype("<u4").tobytes()]
    starts = [0, len(binary[0]), len(binary[0]) + len(binary[1])]
    red, green, blue, opacity = rgba
    color = [*(round(linear_from_srgb(c), _COLOR_DECIMALS) for c in (red, green, blue)), opacity]
    material = {
        "name": "color",
        "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": color, "metallicFactor": 0, "roughnessFactor": _ROUGHNESS},
        **({"alphaMode": "BLEND"} if opacity < 1.0 else {}),
    }
    low, high = (positions.min(axis=0), positions.max(axis=0)) if len(positions) else (np.zeros(3), np.zeros(3))
    primitive = {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}
    content = {
        "asset": {"version": "2.0", "generator": "stepbot"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": [primitive]}],
        "materials": [material],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": len(positions),
                "type": "VEC3",
                "min": [float(x) for x in low],
                "max": [float(x) for x in high],
            },
            {"bufferView": 1, "componentType": _FLOAT, "count": len(units), "type": "VEC3"},
            {"bufferView": 2, "componentType": _UNSIGNED, "count": len(indices), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(part), "target": target}
            for start, part, target in zip(starts, binary, (_VERTICES, _VERTICES, _INDICES), strict=True)
        ],
        "buffers": [{"byteLength": sum(map(len, binary))}],
    }
    text = json.dumps(content, separators=(",", ":")).encode()
    chunks = _chunk(_JSON, text, b" ") + _chunk(_BINARY, b"".join(binary), b"\0")
    return b"glTF" + pack("<II", _GLB_VERSION, 12 + len(chunks)) + chunks


def dae_bytes(mesh: TriMesh, name: str, rgba: Color) -> bytes:
    """COLLADA 1.4.1 of one material with normals; ``name`` is of letters, digits, ``_`` and ``-``."""
    normals, which = shaded(mesh)
    nanometres = np.rint(mesh.vertices * GRID_PER_METRE).astype(np.int64)
    corners = np.stack([mesh.faces, which], axis=2).reshape(-1, 6)
    red, green, blue, opacity = (f"{round(channel, _COLOR_DECIMALS):.{_COLOR_DECIMALS}g}" for channel in rgba)
    return _COLLADA.format(
        date=_NO_DATE,
        color=f"{red} {green} {blue} 1",
        transparency=_TRANSPARENCY.format(opacity=opacity) if rgba[3] < 1.0 else "",
        name=name,
        positions=_source("positions", nanometres, GRID_DECIMALS),
        normals=_source("normals", normals, NORMAL_DECIMALS),
        faces=len(mesh.faces),
        corners=_words(corners),
    ).encode()


def _chunk(kind: bytes, content: bytes, padding: bytes) -> bytes:
    padded = content + padding * (-len(content) % 4)
    return pack("<I", len(padded)) + kind + padded


def _source(name: str, rows: NDArray[np.int64], decimals: int) -> str:
    """A COLLADA source of vectors (n, 3), in units of the last decimal."""
    return _SOURCE.format(name=name, numbers=rows.size, values=_words(rows, decimals), rows=len(rows))


def _words(rows: NDArray[np.int64], decimals: int = 0) -> str:
    """All numbers, one row per line, from integers (n, k) in units of the last decimal."""
    return fixed_point_lines("", rows, decimals).decode().replace("\n ", "\n").strip()
