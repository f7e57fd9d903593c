"""Assemblies in memory for inference: shapes of the kernel [mm] in a tree, without a STEP file in between.

``cylinder``, ``box`` and the like of :mod:`tests.solids` make the shapes; volumes and inertias are the kernel's here,
since only their ratios count.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct, field

from robot_library.step_file import moved
from stepbot.draft.contacts.survey import ALL_SOURCES, Sources
from stepbot.draft.inference import InferredMechanism, infer_mechanism
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly, Body, BodyKind, Component, MeshTolerance

from .solids import Solid, faces

BARE = Sources(names=False, tree=False)
"""Neither names nor subassemblies are used."""
_COARSE = MeshTolerance(relative=0.05, angle=0.8)
"""As drafting reads files."""
_NOWHERE = np.eye(4)
_NO_MESH = TriMesh.of(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))


class Node(Struct, frozen=True, eq=False):
    """A part, or a subassembly of others, at its place in what is above."""

    name: str
    shape: Any = None
    children: Sequence["Node"] = ()
    X: Pose = field(default_factory=Pose)
    has_bodies: bool = False
    """Whether its children are bodies of one part."""


def part(name: str, solid: Solid | Any, x: float = 0.0, y: float = 0.0, z: float = 0.0, rpy: Any = (0, 0, 0)) -> Node:
    """A part: ``solid`` moved to (x, y, z) [mm], turned by roll, pitch and yaw [rad]; one solid is one definition."""
    shape = solid.shape if isinstance(solid, Solid) else solid
    return Node(name, shape, X=Pose.from_xyz_rpy((x * 1e-3, y * 1e-3, z * 1e-3), rpy))


def group(name: str, *children: Node) -> Node:
    """A subassembly."""
    return Node(name, children=children)


def assembled(*nodes: Node, is_meshed: bool = False) -> Assembly:
    """The assembly of some nodes, as the reader returns it with ``ReadOptions.faces``; with meshes if they count."""
    components, shapes = [Component(0, -1, ".", ".", "", "", 1)], [None]
    for node in nodes:
        _add(node, 0, Pose(), components, shapes)
    bodies = tuple(_body(shape, _mesh(shape) if is_meshed else _NO_MESH) for shape in shapes[1:])
    return Assembly("made.step", "AP242", "", "mm", 1e-3, tuple(components), bodies)


def _add(
    node: Node, parent: int, X_WP: Pose, components: list[Component], shapes: list[Any], *, is_body: bool = False
) -> None:
    """Add a node and everything below it; the first shape is that of subassemblies, which have none."""
    number = next((n for n, shape in enumerate(shapes) if shape is node.shape), len(shapes))
    if number == len(shapes):
        shapes.append(node.shape)
    index, X_WC = len(components), X_WP @ node.X
    path = f"{components[parent].path}/{node.name}" if parent else node.name
    definition = number or 1000 + index
    product = "" if is_body else node.name
    components.append(Component(index, parent, node.name, path, product, "", 1, X_WC, number - 1, definition))
    for child in node.children:
        _add(child, index, X_WC, components, shapes, is_body=node.has_bodies)


def reexported(*nodes: Node, to: Any = _NOWHERE) -> list[Node]:
    """Nodes as exports have them that make each occurrence a product of its own, drawn where it is in the assembly.

    ``to`` (4, 4) is what is done to all of them [mm], a reflection for one.
    """
    found = []
    for node in nodes:
        X = node.X.matrix
        X[:3, 3] *= 1e3
        X = to @ X
        shape = None if node.shape is None else moved(node.shape, X)
        found.append(Node(node.name, shape, reexported(*node.children, to=X), has_bodies=node.has_bodies))
    return found


def inferred(*nodes: Node, sources: Sources = ALL_SOURCES) -> InferredMechanism:
    """The mechanism inferred from some nodes; scores are from 0 to 1, as drafts say of them."""
    found = infer_mechanism(assembled(*nodes), sources)
    assert all(0.0 <= one.score <= 1.0 for one in (*found.welds, *found.offered, *(arc.evidence for arc in found.arcs)))
    return found


def links(inferred: InferredMechanism) -> list[set[str]]:
    """The paths of the parts of each link."""
    return [{inferred.survey.parts[i].path for i in members} for members in inferred.links]


def joints(inferred: InferredMechanism) -> list[tuple[str, str, str]]:
    """Type and the larger parts' paths of both sides of each joint, sorted; without placeholders."""
    rows = []
    for arc in inferred.arcs:
        if arc.evidence.type != JointKind.FIXED:
            ends = sorted(_largest(inferred, n) for n in (arc.parent, arc.child))
            rows.append((str(arc.evidence.type), ends[0], ends[1]))
    return sorted(rows)


def _largest(inferred: InferredMechanism, link: int) -> str:
    parts = [inferred.survey.parts[i] for i in inferred.links[link]]
    return max(parts, key=lambda p: (p.volume, p.path)).path


def _mesh(shape: Any) -> TriMesh:
    from stepbot.step.shapes.tessellation import diagonal, fineness, tessellated_once

    mesh = tessellated_once(shape, fineness((_COARSE,), diagonal(shape))).mesh
    return TriMesh.of(mesh.vertices * 1e-3, mesh.faces)


def _body(shape: Any, mesh: TriMesh) -> Body:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopoDS import TopoDS

    from stepbot.step.features.face_reading import read_faces

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found)
    com, matrix = found.CentreOfMass(), found.MatrixOfInertia()
    inertia = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    exact = VolumeProperties.of(found.Mass() * 1e-9, np.array([com.X(), com.Y(), com.Z()]) * 1e-3, inertia * 1e-15)
    errors: list[str] = []
    colors, read = (
        np.zeros(len(mesh.faces), dtype=np.int32),
        read_faces([TopoDS.Face(face) for face in faces(shape)], errors),
    )
    assert not errors
    colors = np.zeros(len(mesh.faces), dtype=np.int32)
    return Body(BodyKind.SOLID, mesh, colors, (None,), True, exact=exact, faces=read)


def turned(solid: Solid, x: float = 0.0, y: float = 0.0, z: float = 0.0, rpy: Any = (0, 0, 0)) -> Solid:
    """A solid turned by roll, pitch and yaw [rad], then moved to (x, y, z) [mm]."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = Pose.from_xyz_rpy((0, 0, 0), rpy).R, (x, y, z)
    return Solid(moved(solid.shape, X), solid.moments.moved(X))


def cut(solid: Solid, *tools: Solid) -> Solid:
    """What is left of a solid; unlike ``-``, the tools need not be inside. Its moments are not those of the result."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    shape = solid.shape
    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool.shape).Shape()
    return Solid(shape, solid.moments)
