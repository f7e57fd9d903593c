"""Reach and symmetry of a robot, against closed forms."""

from math import cos, pi, radians, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Box, Frame, Joint, JointKind, Limit, Link, Mimic, Robot, Visual
from stepbot.robot.reach import reach
from stepbot.robot.symmetry import mirrored, whole

lengths = st.floats(0.05, 2.0)


def planar(a: float, b: float, limit: Limit, kind: JointKind = JointKind.REVOLUTE) -> Robot:
    """Two bars on parallel axes; the second one ends at the frame ``tip``."""
    joints = (
        Joint("shoulder", JointKind.CONTINUOUS, "base", "upper"),
        Joint("elbow", kind, "upper", "fore", Pose.of(position=(a, 0.0, 0.0)), limit=limit),
    )
    links = tuple(Link(name) for name in ("base", "upper", "fore"))
    return Robot("arm", links, joints, frames=(Frame("tip", "fore", Pose.of(position=(b, 0.0, 0.0))),))


@pytest.mark.slow
@given(a=lengths, b=lengths, low=st.floats(-pi, pi), wide=st.floats(0.01, pi))
def test_reach_of_a_planar_arm(a: float, b: float, low: float, wide: float) -> None:
    """The law of cosines at the straightest elbow that the limits allow."""
    high = low + wide
    turns = [k * 2 * pi for k in (-1, 0, 1)]
    straightest = 1.0 if any(low <= turn <= high for turn in turns) else max(cos(low), cos(high))
    expected = sqrt(a * a + b * b + 2 * a * b * straightest)
    assert reach(planar(a, b, Limit(low, high)), "tip", "base") == pytest.approx(expected, rel=1e-7)


@pytest.mark.slow
def test_reach_of_a_slide_and_of_a_follower() -> None:
    """A slide reaches to its end; a follower goes where its leader can take it."""
    slide = replace(planar(0.5, 0.1, Limit(-0.1, 0.3), JointKind.PRISMATIC))
    joints = (slide.joints[0], replace(slide.joints[1], axis=(1.0, 0.0, 0.0)))
    assert reach(replace(slide, joints=joints), "tip", "base") == pytest.approx(0.9)
    arm = planar(0.4, 0.4, Limit(radians(30), radians(120)))
    led = replace(arm.joints[1], mimic=Mimic("shoulder", 0.5, 0.0), limit=Limit(-4.0, 4.0))
    turned = replace(arm, joints=(replace(arm.joints[0], kind=JointKind.REVOLUTE, limit=Limit(1.0, 2.0)), led))
    assert reach(turned, "tip", "base") == pytest.approx(0.8 * cos(0.25), rel=1e-4)


def body(name: str, y: float, mass: float, size: float = 0.1) -> Link:
    """A cube beside the plane y = 0."""
    X = Pose.of(position=(0.2, y, 0.0))
    inertia = mass * size * size / 6 * np.eye(3)
    shape = Visual(f"{name}_visual", Box((size, size, size)), X)
    return Link(name, MassProperties.of(mass, X.p, inertia), (shape,))


def walker(*bodies: Link) -> Robot:
    """Bodies that are fixed to a base across the plane."""
    links = (body("base", 0.0, 2.0, 0.4), *bodies)
    joints = tuple(Joint(f"{one.name}_joint", JointKind.FIXED, "base", one.name) for one in bodies)
    return Robot("walker", links, joints)


def test_twins_are_found_and_compared() -> None:
    """Cubes at mirrored places are twins, whatever they are called; their masses differ by a share of the larger."""
    robot = walker(body("left", 0.3, 1.0), body("a", -0.3, 0.75), body("top", 0.0, 0.5))
    found = mirrored(robot, "y")
    assert [(one.a.name, one.b.name) for one in found.twins] == [("a", "left")]
    assert found.twins[0].difference == pytest.approx(0.25)
    assert not found.alone
    assert found.offset == pytest.approx((0.3 * 1.0 - 0.3 * 0.75) / 4.25)


def test_what_has_no_twin_is_listed_by_what_it_moves() -> None:
    """Displaced, larger and single parts are alone; the first is that with the largest mass times distance."""
    robot = walker(
        body("left", 0.3, 1.0), body("right", -0.35, 1.0), body("far", 0.9, 0.5), body("big", -0.3, 0.1, 0.2)
    )
    found = mirrored(robot, "y")
    assert not found.twins
    assert [one.name for one in found.alone] == ["far", "right", "left", "big"]


def test_whole_is_the_sum_in_the_drawn_pose() -> None:
    """Mass and centre of mass with a joint that is drawn away from zero."""
    arm = planar(0.5, 0.1, Limit())
    heavy = MassProperties.of(2.0, (0.1, 0.0, 0.0), 0.01 * np.eye(3))
    links = (arm.links[0], *(replace(one, mass_properties=heavy) for one in arm.links[1:]))
    joints = (replace(arm.joints[0], drawn_position=pi / 2), arm.joints[1])
    mass, com = whole(replace(arm, links=links, joints=joints))
    assert mass == 4.0
    np.testing.assert_allclose(com, (0.0, 0.35, 0.0), atol=1e-12)
