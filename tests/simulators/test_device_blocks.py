"""Blocks for actuators and sensors, which no engine reads: stepbot's parser detects each removal."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation import EngineRefused
from stepbot.formats.rendering import render
from tests.devices import equipped
from tests.simulators.conftest import Folder, failures, look, write

BLOCKS = {
    "urdf": ("extensions", ("gazebo", "transmission", "ros2_control")),
    "sdf": ("reader", ("link/sensor", "joint/sensor", "plugin")),
}

DEFAULTS = {"min_angle": ("0",), "max_angle": ("0",)}
"""Values that equal the specification's defaults, so that their removal has no effect."""
NAMES_OF_IMAGES = {"topic", "gz_frame_id"}
"""Where Gazebo publishes, which the unit tests of optical frames and of the bridge compare."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    """The equipped robot on disk."""
    return write(equipped(), tmp_path_factory.mktemp("equipped"))


def _without_one_thing(file: Path, blocks: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """The file without one element or attribute of its blocks, and the removed part."""
    count = len(list(_things(etree.parse(str(file)).getroot(), blocks)))
    for index in range(count):
        top = etree.parse(str(file)).getroot()
        element, attribute = list(_things(top, blocks))[index]
        name = f"<{element.tag}{''.join(f' {key}={value!r}' for key, value in element.attrib.items())}>"
        if attribute:
            del element.attrib[attribute]
        else:
            element.getparent().remove(element)
        yield f"{attribute or 'all'} of {name}", top


def _things(top: Any, blocks: tuple[str, ...]) -> Iterator[tuple[Any, str]]:
    model = top.find("model") if top.tag == "sdf" else top
    for block in (found for path in blocks for found in model.findall(path)):
        for element in block.iter():
            if element.get("name") == "initial_value":  # a start, which no engine has: test_ros2.py reads it back
                continue
            if element.tag not in NAMES_OF_IMAGES and element.text not in DEFAULTS.get(element.tag, ()):
                yield element, ""
            yield from ((element, attribute) for attribute in element.attrib)


@pytest.mark.slow
@pytest.mark.parametrize("written_in", BLOCKS)
def test_nothing_of_a_block_is_missing_unnoticed(written_in: str, folder: Folder, tmp_path: Path) -> None:
    """The removal of each element and each attribute is detected."""
    engine, blocks = BLOCKS[written_in]
    file = folder.written[written_in].path
    request = replace(folder.request(written_in), simulate=0.0, configurations=())
    expected = replace(folder.expected(written_in), poses=(), dynamics=())
    damaged = tmp_path / file.name
    survivors, count = [], 0
    for what, top in _without_one_thing(file, blocks):
        count += 1
        damaged.write_bytes(etree.tostring(top))
        try:
            seen = look(engine, replace(request, file=str(damaged)))
        except EngineRefused:
            continue
        if not failures(expected, seen):
            survivors.append(what)
    assert count > 90
    assert not survivors, "\n".join(survivors)


def test_blocks_of_others_are_read_too(tmp_path: Path) -> None:
    """Foreign blocks are read: ros2_control without transmissions, ROS 1 transmissions, an unknown sensor type."""
    file = tmp_path / "other.urdf"
    file.write_text(
        """<robot name="other"><link name="a"/><link name="b"/>
        <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
        <gazebo reference="b"><sensor name="sonar" type="sonar"/></gazebo>
        <transmission name="t"><type>transmission_interface/SimpleTransmission</type>
        <joint name="j"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
        <actuator name="t"><mechanicalReduction>7</mechanicalReduction></actuator></transmission>
        <ros2_control name="x" type="system"><hardware><plugin>a/B</plugin></hardware><joint name="j">
        <command_interface name="velocity"><param name="max">2</param></command_interface>
        <state_interface name="position"/><state_interface name="velocity"/><state_interface name="effort"/>
        </joint></ros2_control></robot>""",
        encoding="utf-8",
    )
    from stepbot.engines.observation import Request

    seen = look("extensions", Request(str(file), "urdf"))
    assert seen.actuators is not None
    assert [(a.name, a.joint, a.kind, a.gear) for a in seen.actuators] == [
        ("t", "j", "motor", 7.0),
        ("", "j", "velocity", 1.0),
    ]
    assert seen.sensors is not None
    assert [(s.name, s.kind, s.link) for s in seen.sensors] == [("sonar", "sonar", "b")]
    assert seen.warnings == ()


def test_robots_without_devices_have_no_blocks() -> None:
    """Robots without actuators and sensors have no blocks."""
    bare = replace(equipped(), actuators=(), sensors=(), frames=())
    bare = replace(bare, joints=tuple(replace(joint, dynamics=type(joint.dynamics)()) for joint in bare.joints))
    for name, words in (("urdf", ("gazebo", "transmission", "ros2_control")), ("sdf", ("sensor", "plugin"))):
        text = next(iter(render(bare, name, Diagnostics()).values())).decode()
        assert not [word for word in words if f"<{word}" in text]
