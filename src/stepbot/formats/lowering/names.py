"""Names that a format cannot represent unchanged."""

from collections.abc import Callable, Mapping

from stepbot.robot.mesh_names import free_name
from stepbot.robot.model import Robot
from stepbot.robot.renaming import NewNames, names_of, renamed


def reserved(robot: Robot, reserves: Callable[[str], bool]) -> list[str]:
    """Names of links, joints, closures and frames that the format reserves."""
    names = dict.fromkeys(names_of(robot, "links", "joints", "closures", "frames"))
    return [f"'{name}'" for name in names if reserves(name)]


def renamed_joints(robot: Robot) -> list[str]:
    """Joints and closures whose names conflict with links or each other."""
    joints, closures = _joint_names(robot)
    return _changes(joints) + _changes(closures)


def rename_joints(robot: Robot) -> Robot:
    """The robot with a unique name for every link, joint and closure; links keep theirs."""
    joints, closures = _joint_names(robot)
    return renamed(robot, joint=NewNames(joints=joints).joint, closure=closures.__getitem__)


def renamed_frames(robot: Robot) -> list[str]:
    """Frames whose names conflict with links, joints or closures."""
    return _changes(_frame_names(robot))


def rename_frames(robot: Robot) -> Robot:
    """The robot with a unique name for every frame."""
    return renamed(robot, frame=_frame_names(robot).__getitem__)


def _joint_names(robot: Robot) -> tuple[dict[str, str], dict[str, str]]:
    taken = set(names_of(robot, "links"))
    joints = {joint.name: free_name(joint.name, "_joint", taken) for joint in robot.joints}
    closures = {closure.name: free_name(closure.name, "_closure", taken) for closure in robot.closures}
    return joints, closures


def _frame_names(robot: Robot) -> dict[str, str]:
    taken = set(names_of(robot, "links", "joints", "closures"))
    return {frame.name: free_name(frame.name, "_frame", taken) for frame in robot.frames}


def _changes(names: Mapping[str, str]) -> list[str]:
    return [f"'{old}' is now '{new}'" for old, new in names.items() if old != new]
