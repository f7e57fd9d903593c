"""Joints, closures and actuators: poses at q = 0 from the drawing, checked by moving the robot."""

from math import cos, inf, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble.bound import bind
from stepbot.assemble.joints import tree_order
from stepbot.geometry.spatial import Pose, rotation_about
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Actuator, ActuatorKind, JointDynamics, JointKind, Limit, Mimic, Robot
from stepbot.robot.validity import check_robot
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, axis, build, built, sidecar

CHAIN = """
    defaults: {density: 1000}
    links: {base: {rest: true}, upper: {parts: [upper]}, lower: {parts: [lower]}}
"""


def _chain() -> Workshop:
    shop = Workshop()
    shop.box("base")
    shop.box("upper", (10, 10, 100), at(0, 0, 50))
    shop.box("lower", (10, 10, 100), at(0, 0, 150))
    return shop


def _drawn(robot: Robot) -> dict[str, float]:
    return {j.name: j.drawn_position for j in robot.joints if j.kind is not JointKind.FIXED}


def _com_in_world(robot: Robot, link: str, q: dict[str, float]) -> np.ndarray:
    return link_poses(robot, q)[link].apply(robot.link_by_name[link].mass_properties.com)


@pytest.mark.parametrize(("zero_a", "zero_b"), [(0.0, 0.0), (30.0, 0.0), (-20.0, 75.0)])
def test_the_drawn_pose_is_q_equal_zero_key(zero_a: float, zero_b: float, tmp_path: Path) -> None:
    """At q = ``zero`` every part has its drawn pose; at q = 0 the chain is moved back by ``zero``."""
    text = (
        CHAIN
        + f"""
    joints:
      a: {{type: continuous, parent: base, child: upper, origin: {{xyz: [0, 0, 0], rpy: [0.2, 0, 0]}},
           axis: y, zero: {zero_a} deg}}
      b: {{type: continuous, parent: upper, child: lower, origin: {{xyz: [0, 0, 0.1]}}, axis: y, zero: {zero_b} deg}}
"""
    )
    robot = built(_chain(), tmp_path, text)
    np.testing.assert_allclose(_com_in_world(robot, "upper", _drawn(robot)), (0, 0, 0.05), atol=1e-12)
    np.testing.assert_allclose(_com_in_world(robot, "lower", _drawn(robot)), (0, 0, 0.15), atol=1e-12)
    # As drawn, the second joint turns about the y axis, the first about the y axis of its own frame, rolled by 0.2.
    R_a = rotation_about((0, cos(0.2), sin(0.2)), -radians(zero_a))
    R_b = rotation_about((0, 1, 0), -radians(zero_b))
    np.testing.assert_allclose(_com_in_world(robot, "upper", {}), R_a @ (0, 0, 0.05), atol=1e-12)
    np.testing.assert_allclose(_com_in_world(robot, "lower", {}), R_a @ ((0, 0, 0.1) + R_b @ (0, 0, 0.05)), atol=1e-12)


def test_the_joint_frame_is_the_origins(tmp_path: Path) -> None:
    """At q = 0 the child's frame is that of the origin for any ``zero``; everything below it is rotated back."""
    text = (
        CHAIN
        + """
    joints:
      a: {type: revolute, parent: base, child: upper, axis: x, zero: ZERO, limits: {lower: -2, upper: 2},
          origin: {xyz: [0, 0, 0], rpy: [0, 0, 1]}}
      b: {type: fixed, parent: upper, child: lower, origin: {xyz: [0.1, 0, 0], rpy: [1, 2, 3], relative_to: upper}}
"""
    )
    robot = built(_chain(), tmp_path, text.replace("ZERO", "0.5"))
    a, b = robot.joints
    np.testing.assert_allclose(a.X_PC.matrix, Pose.from_xyz_rpy(rpy=(0, 0, 1)).matrix, atol=1e-12)
    np.testing.assert_allclose(b.X_PC.matrix, Pose.from_xyz_rpy((0.1, 0, 0), (1, 2, 3)).matrix, atol=1e-12)
    assert a.drawn_position == 0.5
    plain, turned = built(_chain(), tmp_path, text.replace("ZERO", "0")).links[1], robot.links[1]
    back = Pose.of(rotation_about((1, 0, 0), -0.5))
    expected = plain.mass_properties.moved(back)
    np.testing.assert_allclose(turned.mass_properties.com, expected.com, atol=1e-12)
    np.testing.assert_allclose(turned.mass_properties.inertia, expected.inertia, atol=1e-12)
    np.testing.assert_allclose(turned.visuals[0].X_LG.matrix, (back @ plain.visuals[0].X_LG).matrix, atol=1e-11)


def test_slides_are_slid_back(tmp_path: Path) -> None:
    """A prismatic joint drawn 20 mm out is 20 mm further in at q = 0, along its axis."""
    text = (
        CHAIN
        + """
    joints:
      a: {type: fixed, parent: base, child: upper, origin: {xyz: [0, 0, 0]}}
      b: {type: prismatic, parent: upper, child: lower, origin: {xyz: [0, 0, 100 mm]}, axis: [0, 3, 4], zero: 20 mm,
          limits: {lower: 0, upper: 50 mm}}
"""
    )
    robot = built(_chain(), tmp_path, text)
    np.testing.assert_allclose(robot.joints[1].X_PC.p, (0, 0, 0.1), atol=1e-12)
    np.testing.assert_allclose(robot.joints[1].axis, (0, 0.6, 0.8), atol=1e-15)
    np.testing.assert_allclose(_com_in_world(robot, "lower", {}), (0, -0.012, 0.134), atol=1e-12)
    np.testing.assert_allclose(_com_in_world(robot, "lower", {"b": 0.02}), (0, 0, 0.15), atol=1e-12)


def test_limits_dynamics_mimic(tmp_path: Path) -> None:
    """Limits, dynamics and mimics are in SI; missing fields come from the first default pattern that sets them."""
    text = (
        CHAIN
        + """
    joint_defaults:
      "b*": {limits: {effort: 2 N*m}, dynamics: {friction: 0.1}}
      "*": {limits: {effort: 1.5 N*m, velocity: 60 rpm}, dynamics: {damping: 0.5, friction: 9}}
    joints:
      a: {type: continuous, parent: base, child: upper, origin: {xyz: [0, 0, 0]}}
      b: {type: revolute, parent: upper, child: lower, origin: {xyz: [0, 0, 0]}, axis: -x,
          limits: {lower: -90 deg, upper: inf, velocity: 1}, dynamics: {damping: 0.2, armature: 0.01},
          mimic: {joint: a, multiplier: -2, offset: 0}}
    actuators: {m: {joint: a, kind: position, kp: 100, kv: 5, gear: 3}}
"""
    )
    robot = built(_chain(), tmp_path, text)
    a, b = robot.joints
    assert a.limit == Limit(velocity=2 * pi, effort=1.5)
    assert a.dynamics == JointDynamics(damping=0.5, friction=9)
    assert b.limit == Limit(-pi / 2, float("inf"), 1.0, 2.0)
    assert b.dynamics == JointDynamics(damping=0.2, friction=0.1, armature=0.01)
    assert b.axis == (-1.0, 0.0, 0.0)
    assert b.mimic == Mimic("a", -2.0, 0.0)
    assert robot.actuators == (Actuator("m", "a", ActuatorKind.POSITION, 100.0, 5.0, 3.0),)


def test_order_is_root_first_depth_first(tmp_path: Path) -> None:
    """Joints are depth-first from the root, in the sidecar's order; links are in the order of their joints."""
    shop = Workshop()
    for name in "abcde":
        shop.box(name)
    joint = "{{type: fixed, parent: {}, child: {}, origin: {{xyz: [0, 0, 0]}}}}"
    text = "    defaults: {density: 1}\n    links:\n" + "".join(f"      {n}: {{parts: [{n}]}}\n" for n in "abcde")
    text += "    joints:\n" + "".join(
        f"      {p}{c}: {joint.format(p, c)}\n" for p, c in (("d", "e"), ("c", "b"), ("c", "d"), ("b", "a"))
    )
    robot = built(shop, tmp_path, text)
    assert [link.name for link in robot.links] == ["c", "b", "a", "d", "e"]
    assert [j.child for j in robot.joints] == ["b", "a", "d", "e"]
    assert tree_order(sidecar(tmp_path, text).document)[0] == "c"


def _four_bar_shop(zero: float) -> tuple[Workshop, str]:
    """A parallelogram linkage of 100 mm by 200 mm, and its sidecar; the crank is drawn upright."""
    shop = Workshop()
    corners = {"a": (0, 0), "b": (0, 100), "c": (200, 100), "d": (200, 0)}
    for name, ends in (("ground", "ad"), ("crank", "ab"), ("coupler", "bc"), ("rocker", "cd")):
        holes = [axis((*corners[end], 0), radius=4) for end in ends]
        shop.box(name, (5, 5, 5), axes=holes)
    text = f"""
    defaults: {{density: 7850}}
    links:
      ground: {{rest: true}}
      crank: {{parts: [crank]}}
      coupler: {{parts: [coupler]}}
      rocker: {{parts: [rocker]}}
    joints:
      a: {{type: continuous, parent: ground, child: crank, zero: {zero}}}
      b: {{type: continuous, parent: crank, child: coupler, zero: {-zero}}}
      d: {{type: continuous, parent: ground, child: rocker, zero: {zero}}}
    closures:
      c: {{type: revolute, link_a: coupler, link_b: rocker}}
"""
    return shop, text


@pytest.mark.parametrize("zero", [0.0, 0.7])
def test_a_closure_binds_as_drawn(zero: float, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The two frames of a closure coincide in the drawn pose and along the motion of a parallelogram."""
    shop, text = _four_bar_shop(zero)
    robot = built(shop, tmp_path, text)
    (closure,) = robot.closures
    assert (closure.kind, closure.link_a, closure.link_b) == (JointKind.REVOLUTE, "coupler", "rocker")
    # The rods are drawn along x and y; in links with a zero they are rotated back.
    np.testing.assert_allclose(closure.X_AF.p, rotation_about((0, 0, 1), zero) @ (0.2, 0, 0), atol=1e-12)
    np.testing.assert_allclose(closure.X_BF.p, rotation_about((0, 0, 1), -zero) @ (0, 0.1, 0), atol=1e-12)
    for turn in (0.0, 0.5, -1.2):
        q = {"a": zero + turn, "b": -zero - turn, "d": zero + turn}
        poses = link_poses(robot, q)
        a, b = poses["coupler"] @ closure.X_AF, poses["rocker"] @ closure.X_BF
        np.testing.assert_allclose(a.p, b.p, atol=1e-12)
    check_robot(robot, diagnostics)
    assert not list(diagnostics)


def test_places_of_joints_and_closures_are_known_without_a_robot(tmp_path: Path) -> None:
    """Every joint and closure whose mate is found has its point and axis; others are omitted."""
    shop, text = _four_bar_shop(0.7)
    measures = shop.measures
    placed = bind(shop.assembly, sidecar(tmp_path, text), measures).joints
    assert [(one.name, one.parent, one.child) for one in placed] == [
        ("a", "ground", "crank"),
        ("b", "crank", "coupler"),
        ("d", "ground", "rocker"),
        ("c", "coupler", "rocker"),
    ]
    for one, corner in zip(placed, ((0, 0, 0), (0, 0.1, 0), (0.2, 0, 0), (0.2, 0.1, 0)), strict=True):
        np.testing.assert_allclose(one.origin, corner, atol=1e-12)
        np.testing.assert_allclose(np.abs(one.axis), (0, 0, 1), atol=1e-12)
    unbound = text.replace("link_b: rocker", "link_b: rocker, origin: {mate: [coupler, ground]}")
    unbound = unbound.replace("child: crank,", "child: crank, origin: {mate: [ground, coupler]},")
    assert [one.name for one in bind(shop.assembly, sidecar(tmp_path, unbound), measures).joints] == ["b", "d"]


def test_joints_of_every_kind_are_built(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Joints of every kind have their axes, pitch and forces in SI."""
    text = (
        CHAIN
        + """
    joints:
      a:
        type: screw
        parent: base
        child: upper
        origin: {xyz: [0, 0, 0]}
        axis: x
        pitch: 2 mm/rev
        limits: {lower: -2 rev, upper: inf}
      b:
        type: universal
        parent: upper
        child: lower
        origin: {xyz: [0, 0, 0]}
        axis: y
        axis2: -x
        dynamics: {damping: 0.1}
"""
    )
    robot = build(_chain(), tmp_path, text, diagnostics)
    assert robot is not None
    screw, cross = robot.joints
    assert screw.pitch == pytest.approx(0.002 / (2 * pi), rel=1e-15)
    assert screw.limit.lower == pytest.approx(-4 * pi, rel=1e-15)
    assert screw.limit.upper == inf
    assert (cross.axis, cross.axis2) == ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))
    assert cross.dynamics.damping == 0.1
    for kind in ("ball", "planar", "cylindrical", "floating"):
        of_kind = (
            f"{CHAIN}\n    joints:\n      a: {{type: {kind}, parent: base, child: upper, origin: {{xyz: [0, 0, 0]}}}}\n"
        )
        built = build(
            _chain(),
            tmp_path,
            of_kind + "      b: {type: fixed, parent: upper, child: lower, origin: {xyz: [0, 0, 0]}}\n",
            diagnostics,
        )
        assert built is not None
        assert built.joints[0].kind == kind
