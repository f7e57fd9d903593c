"""Mesh files in formats that the readers of a description do not read: OBJ in their place."""

from collections.abc import Callable
from dataclasses import replace

from stepbot.robot.model import Collision, MeshFormat, MeshRef, Robot, Visual


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
