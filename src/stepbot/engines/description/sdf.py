"""SDFormat by stepbot's own reader."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import Primitive
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Rgba

from .. import engine_of
from ..observation import EngineCannotRead, Observation, Quantity, Request
from ..sdformat_reader.frames import Frames, number_at, numbers, read_pose, three_at
from ..sdformat_reader.observer import primitive_of, surface_of
from ..sdformat_reader.tree import read_model, the_model
from ..xml import Element, xml_root
from .description import DescribedShape, Description, MeshFiles, cone_mesh, ellipsoid_mesh
from .sdf_vocabulary import AROUND, MODEL
from .vocabulary import Unread


def describe_sdf(file: str, packages: Iterable[Path] = ()) -> Description:
    """Read an SDFormat file; its meshes are searched for in ``packages``, too.

    Raises:
        EngineRefused: It violates its format.
        EngineCannotRead: It uses unsupported features.
    """
    observation = engine_of("reader").observer.observe(Request(file, "sdf", configurations=({},), simulate=0.0))
    files = MeshFiles(Path(file), packages)
    model = read_model(Path(file))
    for link in model.findall("link"):
        inertial = link.find("inertial")
        if inertial is not None and inertial.get("auto", "") in ("true", "1"):
            what = "mass properties that SDFormat computes from collisions (`auto`) are not supported"
            raise EngineCannotRead(f"link '{link.get('name')}': {what}: state its mass and inertia")
    shapes = tuple(shape for link in model.findall("link") for shape in _shapes(link, files))
    assumed = tuple(link.get("name", "") for link in model.findall("link") if not _is_weighed(link))
    return Description(
        replace(observation, name=model.get("name")),
        _at_zero(observation),
        shapes,
        files.unread,
        _unread(Path(file)),
        files.files,
        plain_meshes=files.plain,
        assumed=assumed,
        X_WR=_root_pose(model, observation),
    )


def _unread(file: Path) -> tuple[Unread, ...]:
    """What is not read of the model, and of the world around it."""
    top = xml_root(file)
    model = the_model(top)
    around = model.getparent()
    own = MODEL.unread(model)
    if around is not None:
        around.remove(model)
    return (*AROUND.unread(top), *own)


def _root_pose(model: Element, observation: Observation) -> Pose:
    """Pose of the root link in the world."""
    children = {joint.child for joint in observation.joints}
    root = next((link.name for link in observation.links if link.name not in children), observation.links[0].name)
    return read_pose(model) @ Frames(model).X_M(root)


def _is_weighed(link: Element) -> bool:
    """Whether a link states its mass and moments of inertia."""
    needed = ("mass", "inertia/ixx", "inertia/iyy", "inertia/izz")
    inertial = link.find("inertial")
    return inertial is not None and all(inertial.find(path) is not None for path in needed)


def _at_zero(observation: Observation) -> dict[str, Pose]:
    """Poses in the parents at q = 0; the reader moves mimicking joints like any other."""
    if not observation.poses:
        raise EngineCannotRead(observation.not_run[Quantity.POSES])
    poses = observation.poses[0]
    return {joint.child: poses[joint.parent].inverse() @ poses[joint.child] for joint in observation.joints}


_AS_MESHES = (("geometry/ellipsoid", "an ellipsoid"), ("geometry/cone", "a cone"))
"""Shapes that a mesh approximates: the model does not have them."""


def _shapes(link: Element, files: MeshFiles) -> Iterator[DescribedShape]:
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            name, X_LG, rgba = shape.get("name", ""), read_pose(shape), _color(shape)
            uri, collides = (shape.findtext("geometry/mesh/uri") or "").strip(), kind == "collision"
            mesh, geometry = shape.find("geometry/mesh"), shape.find("geometry")
            parts: tuple[tuple[TriMesh | Primitive, Rgba | None], ...] = ()
            if mesh is not None:
                parts = files.parts(uri, three_at(mesh, "scale", "1 1 1"), rgba, whole=collides)
            elif geometry is not None and (solid := _geometry(geometry)) is not None:
                parts = ((solid, rgba),)
            surface = surface_of(shape)
            of_mesh = next((a for tag, a in _AS_MESHES if shape.find(tag) is not None), "")
            for piece, (part, color) in enumerate(parts):
                yield DescribedShape(
                    link.get("name", ""), name, part, X_LG, color, collides, surface, uri, of_mesh, piece
                )


def _color(shape: Element) -> Rgba | None:
    """The diffuse colour of a visual."""
    values = numbers(shape.findtext("material/diffuse") or "")
    return (values[0], values[1], values[2], values[3] if len(values) > 3 else 1.0) if len(values) >= 3 else None


def _geometry(geometry: Element) -> TriMesh | Primitive | None:
    round_, cone = geometry.find("ellipsoid"), geometry.find("cone")
    if round_ is not None:
        return ellipsoid_mesh(three_at(round_, "radii", "1 1 1"))
    if cone is not None:
        return cone_mesh(number_at(cone, "radius", 0.5), number_at(cone, "length", 1.0))
    return primitive_of(geometry)
