"""Shapes that a format or its engine does not support."""

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from msgspec.structs import replace

from stepbot.geometry.predicates import is_convex, is_flat
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Capsule, Collision, Cylinder, Link, MeshFormat, MeshRef, Robot, Sphere, Visual
from stepbot.robot.surfaces import DEAD, Surface

DENT = 1e-4
"""Ratio of depth to extent below which a dent is ignored: hulls of tiny parts have some, from the vertex grid."""

_Shape = TypeVar("_Shape", Visual, Collision)


def upright(shape: Visual | Collision) -> Pose:
    """Pose of a shape in its link; for a sphere without rotation."""
    return Pose.of(position=shape.X_LG.p) if isinstance(shape.geometry, Sphere) else shape.X_LG


def look(shape: Visual | Collision) -> tuple[Hashable, ...]:
    """Equal for shapes of one kind that differ in name and position alone, or are both at the origin."""
    finish = shape.rgba if isinstance(shape, Visual) else shape.surface
    return finish, shape.geometry, shape.X_LG.rotation, any(shape.X_LG.position)


def links_with_capsules(robot: Robot) -> list[str]:
    """Links with a capsule."""
    return [f"'{link.name}'" for link in robot.links if any(isinstance(one.geometry, Capsule) for one in link.shapes)]


def split_capsules(robot: Robot) -> Robot:
    """The robot with a cylinder and two spheres for every capsule, which fill the same space."""

    def split(shapes: tuple[_Shape, ...]) -> tuple[_Shape, ...]:
        return tuple(part for shape in shapes for part in _split(shape))

    links = (replace(link, visuals=split(link.visuals), collisions=split(link.collisions)) for link in robot.links)
    return replace(robot, links=tuple(links))


def meshes_as(kind: type[Visual | Collision], *formats: MeshFormat) -> Callable[[Robot], list[str]]:
    """The number of meshes of visuals or collisions, if they are in one of the formats."""
    role = kind.__name__.lower()

    def affected(robot: Robot) -> list[str]:
        if getattr(robot.mesh_formats, role) not in formats:
            return []
        meshes = {shape.geometry for shape in robot.distinct_shapes if isinstance(shape, kind)}
        count = len([geometry for geometry in meshes if isinstance(geometry, MeshRef)])
        return [f"{count} {role} mesh{'es' if count > 1 else ''}"] if count else []

    return affected


def as_obj(kind: type[Visual | Collision]) -> Callable[[Robot], Robot]:
    """The robot with meshes of visuals or collisions as OBJ."""
    obj: dict[str, Any] = {kind.__name__.lower(): MeshFormat.OBJ}
    return lambda robot: replace(robot, mesh_formats=replace(robot.mesh_formats, **obj))


def flat_collisions(robot: Robot) -> list[str]:
    """Collision meshes that are planar."""
    return [f"'{name}'" for name in sorted(_flat_meshes(robot))]


def drop_flat_collisions(robot: Robot) -> Robot:
    """The robot without planar collision meshes."""
    flat = _flat_meshes(robot)

    def without(link: Link) -> Link:
        kept = (c for c in link.collisions if not (isinstance(c.geometry, MeshRef) and c.geometry.name in flat))
        return replace(link, collisions=tuple(kept))

    return replace(robot, links=tuple(without(link) for link in robot.links))


def concave_collisions(robot: Robot) -> list[str]:
    """Collision meshes that are not convex, or not closed."""
    return [f"'{name}'" for name in sorted(concave_meshes(robot))]


def concave_meshes(robot: Robot) -> set[str]:
    """Names of the meshes of collisions that are not convex, or not closed."""
    meshes = {name: robot.mesh_by_name[name].mesh for name in _touched(robot)}
    return {name for name, mesh in meshes.items() if not is_convex(mesh, DENT * mesh.diagonal)}


def _split(shape: _Shape) -> tuple[_Shape, ...]:
    capsule = shape.geometry
    if not isinstance(capsule, Capsule):
        return (shape,)
    middle = Cylinder(capsule.radius, capsule.length)
    end = Pose.of(position=(0.0, 0.0, capsule.length / 2))
    names = capsule_parts(shape.name)
    return (
        replace(shape, name=names[0], geometry=middle),
        replace(shape, name=names[1], geometry=Sphere(capsule.radius), X_LG=shape.X_LG @ end),
        replace(shape, name=names[2], geometry=Sphere(capsule.radius), X_LG=shape.X_LG @ end.inverse()),
    )


def capsule_parts(name: str) -> tuple[str, str, str]:
    """Names of the cylinder and the two spheres that formats without capsules have for a capsule."""
    return f"{name}_middle", f"{name}_top", f"{name}_bottom"


def _flat_meshes(robot: Robot) -> set[str]:
    return {name for name in _touched(robot) if is_flat(robot.mesh_by_name[name].mesh)}


def _touched(robot: Robot) -> set[str]:
    touching = (shape.geometry for shape in robot.distinct_shapes if isinstance(shape, Collision))
    return {geometry.name for geometry in touching if isinstance(geometry, MeshRef)}


def excluded_pairs(robot: Robot) -> list[str]:
    """Pairs of links that are not adjacent whose contacts are excluded."""
    found = robot.self_collision
    pairs = found.pairs if found is not None else ()
    searched = [(pair.link_a, pair.link_b) for pair in pairs if found and pair.kind in found.exclude]
    return [f"'{a}' and '{b}'" for a, b in dict.fromkeys((*robot.excluded_contacts, *searched))]


def surfaces_where(stated: Callable[[Surface], bool]) -> Callable[[Robot], list[str]]:
    """Links with a collision whose contact properties meet a condition."""
    return lambda robot: [
        f"'{link.name}'" for link in robot.links if any(stated(shape.surface) for shape in link.collisions)
    ]


def without_surface(*names: str) -> Callable[[Robot], Robot]:
    """The robot without some of the contact properties of its shapes."""
    return lambda robot: _with_surfaces(robot, lambda _link, one: replace(one, **dict.fromkeys(names)))


def without_dead_bounce(robot: Robot) -> Robot:
    """The robot without restitutions below that of a critically damped contact."""
    return _with_surfaces(robot, lambda _, one: replace(one, restitution=None) if is_dead(one) else one)


def is_dead(surface: Surface) -> bool:
    """Whether a restitution is given that is below that of a critically damped contact."""
    return surface.restitution is not None and surface.restitution <= DEAD


def mixed_surfaces(robot: Robot) -> list[str]:
    """Links whose shapes have different contact properties."""
    return [f"'{link.name}'" for link in robot.links if len({shape.surface for shape in link.collisions}) > 1]


def one_surface(robot: Robot) -> Robot:
    """The robot with the contact properties of the shape with most friction on all shapes of its link."""

    def most(link: Link) -> Surface:
        stated = [shape.surface for shape in link.collisions if shape.surface.is_stated]
        return max(stated, key=lambda one: -1.0 if one.friction is None else one.friction)

    mixed = {link.name: most(link) for link in robot.links if len({one.surface for one in link.collisions}) > 1}
    return _with_surfaces(robot, lambda link, one: mixed.get(link.name, one))


def _with_surfaces(robot: Robot, change: Callable[[Link, Surface], Surface]) -> Robot:
    def of(link: Link) -> Link:
        shapes = tuple(replace(shape, surface=change(link, shape.surface)) for shape in link.collisions)
        return link if shapes == link.collisions else replace(link, collisions=shapes)

    return replace(robot, links=tuple(of(link) for link in robot.links))
