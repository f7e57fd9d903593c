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


def each_link(rewrite: Callable[[Link], Link]) -> Callable[[Robot], Robot]:
    """The robot with every link rewritten."""
    return lambda robot: replace(robot, links=tuple(map(rewrite, robot.links)))


def has_capsule(link: Link) -> bool:
    """Whether a shape of a link is a capsule."""
    return any(isinstance(shape.geometry, Capsule) for shape in link.shapes)


def split_capsules(link: Link) -> Link:
    """The link with a cylinder and two spheres for every capsule, which fill the same space."""
    visuals = tuple(part for shape in link.visuals for part in _split(shape))
    return replace(link, visuals=visuals, collisions=tuple(part for shape in link.collisions for part in _split(shape)))


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

    return each_link(without)(robot)


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
    search = robot.self_collision
    pairs = search.pairs if search is not None else ()
    searched = [(pair.link_a, pair.link_b) for pair in pairs if search and pair.kind in search.exclude]
    return [f"'{a}' and '{b}'" for a, b in dict.fromkeys((*robot.excluded_contacts, *searched))]


def with_surfaces(link: Link, change: Callable[[Surface], Surface]) -> Link:
    """The link with other contact properties of its shapes."""
    return replace(
        link, collisions=tuple(replace(collision, surface=change(collision.surface)) for collision in link.collisions)
    )


def has_dead_bounce(link: Link) -> bool:
    """Whether a shape of a link has a restitution below that of a critically damped contact."""
    return any(_is_dead(shape.surface) for shape in link.collisions)


def without_dead_bounce(link: Link) -> Link:
    """The link without such restitutions."""
    return with_surfaces(link, lambda one: replace(one, restitution=None) if _is_dead(one) else one)


def _is_dead(surface: Surface) -> bool:
    return surface.restitution is not None and surface.restitution <= DEAD


def is_mixed(link: Link) -> bool:
    """Whether the shapes of a link have different contact properties."""
    return len({shape.surface for shape in link.collisions}) > 1


def with_one_surface(link: Link) -> Link:
    """The link with the contact properties of the shape with most friction on all of its shapes."""
    stated = [shape.surface for shape in link.collisions if shape.surface.is_stated]
    most = max(stated, key=lambda one: -1.0 if one.friction is None else one.friction)
    return with_surfaces(link, lambda _: most)
