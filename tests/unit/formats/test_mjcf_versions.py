"""The MJCF of a robot for the oldest MuJoCo that must read it."""

from xml.etree import ElementTree as ET

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import files_of
from stepbot.robot.model import FormatVersions, Robot
from tests.robots import ROBOTS

MJCF = format_named("mjcf")
NEW = {"damping", "interval", "nsample"}
"""Attributes of actuators and sensors that MuJoCo 3.3 rejects."""


def written(robot: Robot, version: float) -> tuple[ET.Element, Diagnostics]:
    """The MJCF, and what was reported."""
    diagnostics = Diagnostics()
    lowered = lower(replace(robot, versions=FormatVersions(mjcf=version)), MJCF, diagnostics)
    files = files_of(lowered, MJCF)
    return ET.fromstring(next(iter(files.values()))), diagnostics


def devices(tree: ET.Element) -> list[ET.Element]:
    """All actuators and sensors."""
    return [one for part in ("actuator", "sensor") for section in tree.findall(part) for one in section]


@pytest.mark.slow
def test_version_3_3_has_no_attribute_that_mujoco_3_3_rejects() -> None:
    """What newer versions have is there in 3.7, and absent, or reported, in 3.3; the gains are the same in sum."""
    seen = set[str]()
    for make in ROBOTS.values():
        robot = make()
        (new, _), (old, found) = written(robot, 3.7), written(robot, 3.3)
        assert not old.findall("sensor/contact")
        has_rays = old.find("sensor/rangefinder") is not None
        assert len(old.findall("asset/material")) == has_rays  # without materials, the rays of MJX fail
        readings = [one for one in devices(new) if one.tag != "contact"]
        for one, other in zip(readings, devices(old), strict=True):
            seen |= NEW & set(one.keys())
            assert not NEW & set(other.keys())
            total = float(one.get("kv", 0)) + float(one.get("damping", 0))
            assert abs(total - float(other.get("kv", 0))) <= 1e-12 * total
        reported = {one.code for one in found}
        assert ("SB760:contact" in reported) == bool(new.findall("sensor/contact"))
        if any(one.get("interval") for one in readings):
            assert reported & {"SB760:sensor-rate", "SB760:encoder-rate"}
    assert seen == NEW
