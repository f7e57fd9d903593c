"""Links without mass, for formats in which a mass of 0 means that the engine computes one, or is an error."""

from collections.abc import Callable
from dataclasses import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO33
from stepbot.robot.kinematics import rigid_bodies
from stepbot.robot.model import Base, Collision, Link, MeshFormat, MeshRef, Robot, Visual

STAND_IN_MASS, STAND_IN_MOMENT = 1e-6, 1e-9
"""Mass [kg] and principal moments [kg m^2] for a link that has none: a milligram, with a radius of gyration of 3 cm."""

LEAST_MASS, LEAST_MOMENT = 2e-15, 1e-14
"""The same for a moving link without mass: above the least that MuJoCo accepts, and without effect on the motion."""


def massless_links(robot: Robot) -> list[str]:
    """Links without mass, and links without inertia."""
    return [f"'{link.name}'" for link in robot.links if _is_massless(link)]


def with_stand_in_masses(robot: Robot) -> Robot:
    """The robot with a small mass and inertia in place of missing ones."""
    return replace(
        robot,
        links=tuple(
            _with(link, STAND_IN_MASS, STAND_IN_MOMENT) if _is_massless(link) else link for link in robot.links
        ),
    )


def massless_moving_links(robot: Robot) -> list[str]:
    """The topmost link of each moving body without mass."""
    return [f"'{name}'" for name in massless_bodies(robot)]


def with_least_masses(robot: Robot) -> Robot:
    """The robot with a tiny mass and inertia in place of those of moving bodies that have none."""
    bodies = set(massless_bodies(robot))
    return replace(
        robot,
        links=tuple(_with(link, LEAST_MASS, LEAST_MOMENT) if link.name in bodies else link for link in robot.links),
    )


def massless_bodies(robot: Robot) -> list[str]:
    """Names of the topmost link of each moving body without mass."""
    rigid = rigid_bodies(robot.root.name, robot.joints)
    heavy = {rigid[link.name] for link in robot.links if link.mass_properties.mass > 0.0}
    held = {robot.root.name} if robot.base is Base.FIXED else set()
    return [body for body in dict.fromkeys(rigid.values()) if body not in heavy | held]


def _is_massless(link: Link) -> bool:
    return link.mass_properties.mass == 0.0 or link.mass_properties.inertia == ZERO33


def _with(link: Link, mass: float, I: float) -> Link:  # noqa: E741 - the field's letter
    body = link.mass_properties
    inertia = ((I, 0.0, 0.0), (0.0, I, 0.0), (0.0, 0.0, I))
    return replace(link, mass_properties=MassProperties(body.mass or mass, body.com, inertia))


def visuals_as(*formats: MeshFormat) -> Callable[[Robot], list[str]]:
    """The number of visual meshes, if they are in one of the formats."""

    def affected(robot: Robot) -> list[str]:
        return _count("visual", robot.mesh_formats.visual in formats, Visual, robot)

    return affected


def collisions_as(*formats: MeshFormat) -> Callable[[Robot], list[str]]:
    """The number of collision meshes, if they are in one of the formats."""

    def affected(robot: Robot) -> list[str]:
        return _count("collision", robot.mesh_formats.collision in formats, Collision, robot)

    return affected


def with_obj_visuals(robot: Robot) -> Robot:
    """The robot with visual meshes as OBJ."""
    return replace(robot, mesh_formats=replace(robot.mesh_formats, visual=MeshFormat.OBJ))


def with_obj_collisions(robot: Robot) -> Robot:
    """The robot with collision meshes as OBJ."""
    return replace(robot, mesh_formats=replace(robot.mesh_formats, collision=MeshFormat.OBJ))


def _count(word: str, applies: bool, kind: type[Visual | Collision], robot: Robot) -> list[str]:
    geometries = {shape.geometry for shape in robot.distinct_shapes if isinstance(shape, kind)} if applies else set()
    names = [geometry.name for geometry in geometries if isinstance(geometry, MeshRef)]
    if not names:
        return []
    return [f"{len(names)} {word} mesh{'es' if len(names) > 1 else ''}"]
