"""Isaac Sim's robot schema: https://docs.isaacsim.omniverse.nvidia.com/latest/omniverse_usd/robot_schema.html.

Its tools list the robots, links, joints and sites of a stage by these schemas. Other programs ignore them.
"""

from collections.abc import Sequence

from stepbot.robot.model import Base, Robot

from .usda import Prim, quoted

_ROBOT, _LINK, _JOINT, _SITE = "IsaacRobotAPI", "IsaacLinkAPI", "IsaacJointAPI", "IsaacSiteAPI"
_PINNED = "Manipulator"
"""The type of robots whose base is fixed. The types of others name what they are for, which the model does not have."""


def mark_robot(prim: Prim, robot: Robot, links: Sequence[str], joints: Sequence[str]) -> None:
    """Apply the schema of robots.

    Args:
        prim: The robot's prim.
        links: Paths of its links, the base first.
        joints: Paths of its joints, the one to the world first; without closures, which the articulation excludes.
    """
    prim.schemas.append(_ROBOT)
    stated = {
        "string isaac:description": robot.metadata.description,
        "token isaac:license": robot.metadata.license,
        "token isaac:robotType": _PINNED if robot.base is Base.FIXED else "",
        "string isaac:source": robot.source,
        "string isaac:version": robot.metadata.version,
    }
    for declaration, value in stated.items():
        if value:
            prim.set(declaration, quoted(value))
    for name, paths in (("robotJoints", joints), ("robotLinks", links)):
        if paths:  # prepended, so that a scene can add a tool's
            prim.set(f"prepend rel isaac:physics:{name}", f"[{', '.join(f'<{path}>' for path in paths)}]")


def mark_link(prim: Prim, name: str) -> None:
    """Apply the schema of links, with the name where the prim has another one."""
    prim.schemas.append(_LINK)
    if prim.name != name:
        prim.set("string isaac:nameOverride", quoted(name))


def mark_joint(prim: Prim, name: str) -> None:
    """Apply the schema of joints in the articulation, with the name where the prim has another one."""
    prim.schemas.append(_JOINT)
    if prim.name != name:
        prim.set("string isaac:NameOverride", quoted(name))


def mark_site(prim: Prim) -> None:
    """Apply the schema of frames: places of tools and sensors."""
    prim.schemas.append(_SITE)


def marked_joints(scope: Prim) -> list[str]:
    """Names of the prims of joints with the schema, the one to the world first."""
    marked = [prim for prim in scope.children if _JOINT in prim.schemas]
    rooted = sorted(marked, key=lambda prim: any(one.startswith("rel physics:body0") for one in prim.properties))
    return [prim.name for prim in rooted]
