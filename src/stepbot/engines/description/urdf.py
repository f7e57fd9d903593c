"""URDF: links and joints as yourdfpy reads them, shapes and the poses of the joints from the XML.

Springs, actuators and sensors are those of the blocks for Gazebo and ros2_control.
"""

from collections.abc import Iterable, Iterator, Mapping
from math import inf, nan
from pathlib import Path

from msgspec.structs import replace

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.primitives import Primitive, primitive
from stepbot.geometry.spatial import ZERO3, Pose
from stepbot.robot.model import Limit, Rgba
from stepbot.robot.surfaces import PLAIN, Surface

from .. import engine_of
from ..observation import EngineRefused, Observation, Request
from ..urdf_extensions.observer import initial_positions
from ..urdf_versions import EXTRA_LIMITS, extra_limits, newer_than_stated, with_rpy
from ..xml import Element, xml_root
from .description import DescribedShape, Description, MeshFiles
from .urdf_structure import SHAPES, check_structure, open_limits
from .urdf_vocabulary import BULLET, URDF


def describe_urdf(file: str, packages: Iterable[Path] = ()) -> Description:
    """Read a URDF; its meshes are searched for in ``packages``, too.

    Raises:
        EngineRefused: It contradicts its format.
    """
    top = xml_root(Path(file))
    check_structure(top)
    newer, lost = tuple(newer_than_stated(top)), URDF.unread(top)
    extra = {_name(joint): extra_limits(joint) for joint in top.findall("joint")}
    with_rpy(top)
    request = Request(file, "urdf", simulate=0.0)
    seen: Observation = engine_of("yourdfpy").observer.observe(request)
    observation = _with_extensions(seen, engine_of("extensions").observer.observe(request), extra)
    files = MeshFiles(Path(file), packages)
    X_PC = {_name(joint.find("child"), "link"): _origin(joint) for joint in top.findall("joint")}
    stated = (*top.findall("material"), *top.findall("link/visual/material"))  # of the whole file, wherever
    materials = {_name(one): one for one in reversed(stated) if one.find("color") is not None}
    shapes = tuple(shape for link in top.findall("link") for shape in _shapes(link, files, materials))
    return Description(
        replace(observation, initial=initial_positions(top)),
        X_PC,
        shapes,
        files.unread,
        lost,
        files.files,
        plain_meshes=files.plain,
        assumed=tuple(_name(link) for link in top.findall("link") if _is_unweighed(link)),
        open_limits=tuple(open_limits(top)),
        newer=newer,
        without_inertia=tuple(_name(link) for link in top.findall("link") if _lacks_inertia(link)),
    )


def _with_extensions(observation: Observation, blocks: Observation, extra: Mapping[str, Limit]) -> Observation:
    """The robot with limits of URDF 1.2, and springs, actuators, sensors and links without gravity of the blocks."""
    springs = {joint.name: joint.dynamics for joint in blocks.joints}
    weightless = {link.name: link.gravity_compensation for link in blocks.links}
    joints = []
    for joint in observation.joints:
        spring = springs.get(joint.name)
        if joint.dynamics is not None and spring is not None:
            dynamics = replace(joint.dynamics, stiffness=spring.stiffness, spring_reference=spring.spring_reference)
            fields = (*joint.dynamics_fields, "stiffness", "spring_reference")
            joint = replace(joint, dynamics=dynamics, dynamics_fields=fields)
        if joint.limit is not None and joint.name in extra:
            more = extra[joint.name]
            limit = replace(joint.limit, **{name: getattr(more, name) for name in EXTRA_LIMITS})
            joint = replace(joint, limit=limit)
        joints.append(joint)
    return replace(
        observation,
        joints=tuple(joints),
        links=tuple(replace(link, gravity_compensation=weightless.get(link.name)) for link in observation.links),
        actuators=blocks.actuators,
        sensors=blocks.sensors,
    )


def _lacks_inertia(link: Element) -> bool:
    """Whether a link has a mass and no inertia."""
    mass = link.find("inertial/mass")
    return mass is not None and float(mass.get("value", 0.0)) != 0.0 and link.find("inertial/inertia") is None


def _is_unweighed(link: Element) -> bool:
    """Whether a link with geometry does not state a mass."""
    is_frame = link.find("visual") is None and link.find("collision") is None
    return not is_frame and link.find("inertial/mass") is None


def _name(element: Element | None, key: str = "name") -> str:
    return "" if element is None else element.get(key, "")


def _shapes(link: Element, files: MeshFiles, materials: Mapping[str, Element]) -> Iterator[DescribedShape]:
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            geometry = shape.find("geometry")
            mesh = None if geometry is None else geometry.find("mesh")
            uri, collides = _name(mesh, "filename"), kind == "collision"
            name = shape.get("name", "") or Path(uri).stem
            rgba = _color(shape.find("material"), materials)
            parts: tuple[tuple[TriMesh | Primitive, Rgba | None], ...]
            if mesh is None:
                primitive = _primitive(geometry)
                parts = () if primitive is None else ((primitive, rgba),)
            else:
                parts = files.parts(uri, _numbers(mesh.get("scale"), (1.0, 1.0, 1.0)), rgba, whole=collides)
            for piece, (solid, color) in enumerate(parts):
                surface = _surface(link) if collides else PLAIN
                yield DescribedShape(
                    _name(link), name, solid, _origin(shape), color, collides, surface, uri, piece=piece
                )


def _surface(link: Element) -> Surface:
    """PyBullet's contact properties of a link, and Gazebo's friction where these lack it.

    Raises:
        EngineRefused: One is not a number of at least 0.
    """
    values: dict[str, float] = {}
    top = link.getparent()
    for block in () if top is None else top.findall("gazebo"):
        for one in block.findall("mu1") if block.get("reference") == link.get("name") else ():
            values["friction"] = _not_negative("mu1", one.get("value") or one.text)
    for tag, name in BULLET.items():
        first = link.find(f"contact[1]/{tag}")  # of several, PyBullet reads no other
        if first is not None:
            values[name] = _not_negative(tag, first.get("value"))
    return Surface(**values)


def _not_negative(tag: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = nan
    if not 0.0 <= value < inf:
        raise EngineRefused(f"<{tag}>: '{text or ''}' is not a number of at least 0")
    return value


def _color(material: Element | None, materials: Mapping[str, Element]) -> Rgba | None:
    """Colour of a material, its own or that of the first material of the same name in the file."""
    for one in (material, materials.get(_name(material))):
        color = None if one is None else one.find("color")
        if color is not None:
            r, g, b, a = _numbers(color.get("rgba"), (0.8, 0.8, 0.8, 1.0))
            return (r, g, b, a)
    return None


def _primitive(geometry: Element | None) -> Primitive | None:
    for shape in () if geometry is None else geometry.iterchildren(*SHAPES):
        own = {key: shape.get(key) for key in SHAPES[shape.tag]}
        x, y, z = _numbers(own.get("size"), ZERO3)
        (radius,), (length,) = _numbers(own.get("radius"), (0.0,)), _numbers(own.get("length"), (0.0,))
        if made := primitive(shape.tag, size=(x, y, z), radius=radius, length=length):
            return made
    return None


def _origin(element: Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return Pose()
    return Pose.from_xyz_rpy(_numbers(origin.get("xyz"), ZERO3), _numbers(origin.get("rpy"), ZERO3))


def _numbers(text: str | None, default: Iterable[float]) -> tuple[float, ...]:
    """The numbers in an attribute, which :func:`.urdf_structure.check_structure` has counted."""
    return tuple(default if text is None else map(float, text.split()))
