"""A robot without some of its links, joints and devices."""

from collections.abc import Collection, Mapping, Sequence

from msgspec.structs import replace

from stepbot.robot.model import Actuator, Frame, Joint, Link, LoopClosure, MeshRef, Robot
from stepbot.robot.sensors import Sensor

Element = Link | Joint | LoopClosure | Frame | Actuator | Sensor


class StillFollowed(ValueError):
    """A joint that would stay mimics one that would not.

    Attributes:
        joint: The joint that stays.
        leader: The joint that it mimics.
    """

    def __init__(self, joint: str, leader: str) -> None:
        self.joint, self.leader = joint, leader
        super().__init__(f"joint '{joint}' mimics '{leader}'")


def elements(robot: Robot) -> Mapping[str, Sequence[Element]]:
    """The elements with names, by the key of a sidecar that lists them."""
    return {
        "links": robot.links,
        "joints": robot.joints,
        "closures": robot.closures,
        "frames": robot.frames,
        "actuators": robot.actuators,
        "sensors": robot.sensors,
    }


def without(robot: Robot, names: Collection[str]) -> Robot:
    """The robot without the named elements; of a link or joint of the tree, without everything below it.

    Closures, frames, actuators and sensors of what is left out go, too, and meshes that nothing uses any more.

    Raises:
        StillFollowed: A joint that stays mimics one that goes.
    """
    gone_links = {link.name for link in robot.links[1:] if link.name in names}
    for joint in robot.joints:  # parents first
        if joint.name in names or joint.parent in gone_links or joint.child in gone_links:
            gone_links.add(joint.child)
    joints = tuple(joint for joint in robot.joints if joint.child not in gone_links)
    left = {joint.name for joint in joints}
    for joint in joints:
        if joint.mimic is not None and joint.mimic.joint not in left:
            raise StillFollowed(joint.name, joint.mimic.joint)

    def stays(name: str, *links: str) -> bool:
        return name not in names and not any(link in gone_links for link in links)

    links = tuple(link for link in robot.links if link.name not in gone_links)
    pruned = replace(
        robot,
        links=links,
        joints=joints,
        closures=tuple(closure for closure in robot.closures if stays(closure.name, closure.link_a, closure.link_b)),
        frames=tuple(frame for frame in robot.frames if stays(frame.name, frame.link)),
        actuators=tuple(
            actuator for actuator in robot.actuators if actuator.name not in names and actuator.joint in left
        ),
        sensors=tuple(sensor for sensor in robot.sensors if stays(sensor.name, sensor.link)),
        excluded_contacts=tuple(pair for pair in robot.excluded_contacts if not gone_links.intersection(pair)),
        self_collision=None,
        modules=tuple(
            replace(module, links=tuple(link for link in module.links if link not in gone_links))
            for module in robot.modules
            if module.links[0] not in gone_links
        ),
    )
    used = {shape.geometry for link in links for shape in link.shapes}
    return replace(pruned, meshes=tuple(asset for asset in robot.meshes if MeshRef(asset.name) in used))
