"""Names that a format cannot represent unchanged."""

from collections.abc import Callable, Mapping

from msgspec.structs import replace

from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Joint, Robot


def reserved(robot: Robot, reserves: Callable[[str], bool]) -> list[str]:
    """Names of links, joints, closures and frames that the format reserves."""
    names = [*(link.name for link in robot.links), *(joint.name for joint in robot.joints)]
    names += [*(closure.name for closure in robot.closures), *(frame.name for frame in robot.frames)]
    return [f"'{name}'" for name in dict.fromkeys(names) if reserves(name)]


def renamed_joints(robot: Robot) -> list[str]:
    """Joints and closures whose names conflict with links or each other."""
    joints, closures = _joint_names(robot)
    return _changes(joints) + _changes(closures)


def rename_joints(robot: Robot) -> Robot:
    """The robot with a unique name for every link, joint and closure; links keep theirs."""
    joints, closures = _joint_names(robot)

    def renamed(joint: Joint) -> Joint:
        mimic = replace(joint.mimic, joint=joints[joint.mimic.joint]) if joint.mimic else None
        return replace(joint, name=joints[joint.name], mimic=mimic)

    return replace(
        robot,
        joints=tuple(renamed(joint) for joint in robot.joints),
        closures=tuple(replace(closure, name=closures[closure.name]) for closure in robot.closures),
        actuators=tuple(replace(actuator, joint=joints[actuator.joint]) for actuator in robot.actuators),
        sensors=tuple(replace(s, joint=joints[s.joint]) if s.joint else s for s in robot.sensors),
    )


def renamed_frames(robot: Robot) -> list[str]:
    """Frames whose names conflict with links, joints or closures."""
    return _changes(_frame_names(robot))


def rename_frames(robot: Robot) -> Robot:
    """The robot with a unique name for every frame."""
    names = _frame_names(robot)
    return replace(robot, frames=tuple(replace(frame, name=names[frame.name]) for frame in robot.frames))


def _joint_names(robot: Robot) -> tuple[dict[str, str], dict[str, str]]:
    taken = {link.name for link in robot.links}
    joints = {joint.name: free_name(joint.name, "_joint", taken) for joint in robot.joints}
    closures = {closure.name: free_name(closure.name, "_closure", taken) for closure in robot.closures}
    return joints, closures


def _frame_names(robot: Robot) -> dict[str, str]:
    taken = {link.name for link in robot.links} | {joint.name for joint in robot.joints}
    taken |= {closure.name for closure in robot.closures}
    return {frame.name: free_name(frame.name, "_frame", taken) for frame in robot.frames}


def _changes(names: Mapping[str, str]) -> list[str]:
    return [f"'{old}' is now '{new}'" for old, new in names.items() if old != new]
