"""Values that no engine of the core install reads: tags of Gazebo, drives of OpenUSD, positions of Webots."""

import re
from math import degrees
from xml.etree import ElementTree as ET

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.robot.model import Actuator, ActuatorKind, Collision, Limit, Robot, Sphere
from stepbot.robot.surfaces import Surface
from tests.robots import two_link_arm

DRAWN = 0.3


def _arm() -> Robot:
    """An arm whose first joint is drawn turned and held there, and whose last link is of rubber."""
    arm = two_link_arm()
    first, second = arm.joints
    second = replace(second, drawn_position=0.0)
    first = replace(first, drawn_position=DRAWN, limit=Limit(-1.0, 1.0, effort=5.0, velocity=2.0))
    *links, last = arm.links
    last = replace(last, collisions=(Collision("tip", Sphere(0.01), surface=Surface(friction=0.85)),))
    held = Actuator("held", first.name, ActuatorKind.POSITION, kp=40.0, kv=2.0)
    return replace(arm, joints=(first, second), links=(*links, last), actuators=(held,))


def _text(format_: str, suffix: str) -> str:
    files = render(_arm(), format_, Diagnostics())
    return files[f"{_arm().name}{suffix}"].decode()


def test_gazebo_has_the_friction_in_both_directions() -> None:
    """Gazebo Classic reads `mu1` along, and `mu2` across the first direction of friction."""
    robot, arm = ET.fromstring(_text("urdf", ".urdf")), _arm()
    block = robot.find(f"gazebo[@reference='{arm.links[-1].name}']")
    assert block is not None
    assert [block.findtext(name) for name in ("mu1", "mu2")] == ["0.85", "0.85"]


def test_a_drive_of_openusd_holds_the_drawn_position() -> None:
    """Without a target a position drive pulls the joint to 0 at the first step."""
    target = re.search(r"drive:angular:physics:targetPosition = (\S+)", _text("usd", ".usda"))
    assert target is not None
    assert float(target[1]) == pytest.approx(degrees(DRAWN), rel=1e-6)


def test_webots_starts_in_the_drawn_position() -> None:
    """A joint of Webots is at 0 unless its `position` is stated; the other joint is at 0."""
    assert re.findall(r"\bposition (\S+)", _text("webots", ".proto")) == [str(DRAWN)]
