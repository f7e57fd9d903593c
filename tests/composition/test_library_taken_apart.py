"""Robots of the library, taken apart into modules, compose back to themselves; mirrored limbs are the drawn ones."""

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

from stepbot.compose.mirroring import NORMALS, mirrored
from stepbot.diagnostics import Diagnostics
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.stages import produce
from stepbot.robot.kinematics import initial_configuration, link_poses
from stepbot.robot.model import MeshRef, Robot
from stepbot.runtime.cache import Cache

Compose = Callable[[Mapping[str, str], Diagnostics], Robot]

LEG = """
    version: 1
    robot: leg
    step: LIBRARY/stepbot_quadruped/quadruped.step
    root: {link: bracket, frame: {component: front_left_bracket}}
    parts:
      trunk: {ignore: true}
      "front_right_*": {ignore: true}
      "rear_*": {ignore: true}
      "**/foot": {collision: sphere}
    links:
      bracket: {parts: [front_left_bracket]}
      thigh: {parts: [front_left_thigh]}
      shank: {parts: [front_left_shank]}
    joint_defaults:
      hip:
        limits: {lower: -80 deg, upper: 160 deg, effort: 24 N*m, velocity: 30 rad/s}
        dynamics: {damping: 0.05, friction: 0.1, armature: 0.01}
      knee:
        limits: {lower: -158 deg, upper: -20 deg, effort: 36 N*m, velocity: 20 rad/s}
        dynamics: {damping: 0.05, friction: 0.1, armature: 0.02}
    joints:
      hip:
        {type: revolute, parent: bracket, child: thigh, axis: y, zero: 26 deg,
         origin: {component: front_left_thigh, offset: {rpy: [0, -26 deg, 0]}}}
      knee:
        {type: revolute, parent: thigh, child: shank, axis: y, zero: -80 deg,
         origin: {component: front_left_shank, offset: {rpy: [0, 80 deg, 0]}}}
    """

DOG = """
    version: 1
    robot: dog
    base: floating
    step: LIBRARY/stepbot_quadruped/quadruped.step
    parts: {"front_*": {ignore: true}, "rear_*": {ignore: true}}
    root: {link: trunk, frame: {component: trunk}}
    links: {trunk: {parts: [trunk]}}
    frames:
      front_hip: {link: trunk, origin: {component: front_left_bracket}}
    modules:
      front_left: {file: leg.robot.yaml}
      front_right: {mirror_of: front_left, flip: ["*_roll"], home: {hip: 54 deg}}
    joint_defaults:
      "*_roll":
        limits: {lower: -45 deg, upper: 45 deg, effort: 24 N*m, velocity: 30 rad/s}
        dynamics: {damping: 0.05, friction: 0.1, armature: 0.01}
    joints:
      front_left_roll: {type: revolute, parent: front_hip, child: front_left, axis: x}
    """


def library_robot(name: str, cache: Cache, library: Path, scratch: Path) -> Robot:
    """A robot of the library as it is converted, without verification."""
    sidecar = next((library / name).glob("*.robot.yaml"))
    robot = produce(sidecar, Options(scratch, verify=False, cache=cache)).robot
    assert robot is not None
    return robot


def same_robot(composed: Robot, drawn: Robot, *, com: float, inertia: float) -> None:
    """Every link and joint of the composed robot is that of the drawn one: place, mass properties, axis, limits."""
    poses = link_poses(composed, initial_configuration(composed)), link_poses(drawn, initial_configuration(drawn))
    for link in composed.links:
        theirs = drawn.link_by_name[link.name].mass_properties
        distance, angle = poses[0][link.name].distance_to(poses[1][link.name])
        assert distance < 1e-11, link.name
        assert angle < 1e-11, link.name
        assert link.mass_properties.mass == pytest.approx(theirs.mass, rel=1e-7), link.name
        assert np.allclose(link.mass_properties.com, theirs.com, rtol=0.0, atol=com), link.name
        assert np.allclose(link.mass_properties.inertia, theirs.inertia, rtol=0.0, atol=inertia), link.name
    for joint in composed.joints:
        there = drawn.joint_by_name[joint.name]
        assert (joint.kind, joint.parent, joint.child) == (there.kind, there.parent, there.child)
        assert joint.axis == pytest.approx(there.axis, abs=1e-12), joint.name
        assert (joint.limit.lower, joint.limit.upper) == pytest.approx((there.limit.lower, there.limit.upper)), (
            joint.name
        )
        assert (joint.limit.effort, joint.limit.velocity) == (there.limit.effort, there.limit.velocity)
        assert joint.dynamics == there.dynamics
        assert joint.drawn_position == pytest.approx(there.drawn_position, abs=1e-12), joint.name
        assert joint.mimic == there.mimic


def test_front_legs_of_one_leg_are_the_drawn_ones(
    composed: Compose, robot_library: Path, cache: Cache, tmp_path: Path, found: Diagnostics
) -> None:
    """A leg and its mirror image, which hang on joints of the composing file, against both legs as drawn."""
    dog = composed({"dog.robot.yaml": DOG, "leg.robot.yaml": LEG}, found)
    assert {one.code for one in found} == {"SB169", "SB505"}
    same_robot(dog, library_robot("stepbot_quadruped", cache, robot_library, tmp_path), com=1e-7, inertia=1e-8)
    assert [(one.name, one.mirror, one.at) for one in dog.modules] == [
        ("front_left", "", "trunk"),
        ("front_right", "y", "trunk"),
    ]


def test_meshes_of_a_mirrored_leg(composed: Compose, found: Diagnostics) -> None:
    """Symmetric parts share their meshes; the others have new ones that enclose their volume from outside."""
    dog = composed({"dog.robot.yaml": DOG, "leg.robot.yaml": LEG}, found)
    left, right = (
        {
            one.geometry.name
            for link in dog.links
            if link.name.startswith(leg)
            for one in link.visuals
            if isinstance(one.geometry, MeshRef)
        }
        for leg in ("front_left", "front_right")
    )
    assert {"knee_pin", "cap", "lid", "knee_drive"} <= left & right
    images = [asset for asset in dog.meshes if asset.name in right - left]
    assert {asset.name for asset in images} == {f"{name}_mirrored" for name in left - right}
    for asset in images:
        a, b, c = asset.mesh.vertices[asset.mesh.faces].transpose(1, 0, 2)
        assert np.einsum("ni,ni->", a, np.cross(b, c)) > 0.0, asset.name
    [note] = [one for one in found if one.code == "SB169"]
    assert "thigh shell" in note.message


def _upper_body(library: Path) -> dict[str, str]:
    """The upper body as torso, one arm, and its mirror image."""
    source = YAML(typ="safe").load(library / "stepbot_upper_body" / "upper_body.robot.yaml")
    step = (library / "stepbot_upper_body" / "upper_body.step").as_posix()

    def arm(element: Any) -> Any:
        """The element with the names of the arm's own file."""
        return json.loads(json.dumps(element).replace('"left_', '"').replace('["', '["left_'))

    mine = {name: rule for name, rule in source["joint_defaults"].items() if name.startswith("*_")}
    of_arm = {name: joint for name, joint in source["joints"].items() if name.startswith("left_")}
    of_torso = {name: joint for name, joint in source["joints"].items() if not name.startswith(("left_", "right_"))}
    shoulder = of_arm.pop("left_shoulder_pitch")
    joints = {}
    for name, joint in of_arm.items():
        origin = joint["origin"]
        joints[name.removeprefix("left_")] = {**arm({**joint, "origin": {}}), "origin": origin}
    others = {name: {"ignore": True} for name in ("base", "torso", "neck", "head", "right_*")}
    links = {name: link for name, link in source["links"].items() if name.startswith("left_")}
    module = {
        "version": 1,
        "robot": "arm",
        "step": step,
        "root": {"link": "shoulder", "frame": {"component": "left_shoulder"}},  # as drawn
        "parts": others,
        "links": {name.removeprefix("left_"): link for name, link in links.items()},
        "joint_defaults": {
            name[2:]: rule for name, rule in mine.items() if name != "*_shoulder_pitch" and name != "*_grip"
        }
        | {"grip": source["joint_defaults"]["*_grip"]},
        "joints": joints,
    }
    zeros = {
        name.removeprefix("right_"): joint.get("zero", 0)
        for name, joint in source["joints"].items()
        if name.startswith("right_")
    }
    followers = ("thumb_grip", "shoulder_pitch")
    whole = {
        "version": 1,
        "robot": "upper_body",
        "step": step,
        "parts": {"left_*": {"ignore": True}, "right_*": {"ignore": True}},
        "links": {name: link for name, link in source["links"].items() if not name.startswith(("left_", "right_"))},
        "frames": {"left_mount": {"link": "torso", "origin": {**shoulder["origin"], "component": "left_shoulder"}}},
        "modules": {
            "left": {"file": "arm.robot.yaml"},
            "right": {
                "mirror_of": "left",
                "flip": ["*_roll", "*_yaw"],
                "home": {name: zero for name, zero in zeros.items() if name not in followers},
            },
        },
        "joint_defaults": {name: rule for name, rule in source["joint_defaults"].items() if not name.startswith("*_")}
        | {"*_shoulder_pitch": source["joint_defaults"]["*_shoulder_pitch"]},
        "joints": of_torso
        | {"left_shoulder_pitch": {**shoulder, "parent": "left_mount", "child": "left", "origin": "auto"}},
    }
    return {"upper_body.robot.yaml": json.dumps(whole), "arm.robot.yaml": json.dumps(module)}


def test_mirrored_arm_is_the_drawn_one(
    composed: Compose, robot_library: Path, cache: Cache, tmp_path: Path, found: Diagnostics
) -> None:
    """An arm of nine joints with a mimic and one-sided limits, its image against the right arm drawn in the CAD."""
    body = composed(_upper_body(robot_library), found)
    assert not [one for one in found if one.severity == "error"]
    drawn = library_robot("stepbot_upper_body", cache, robot_library, tmp_path)
    same_robot(_at_zero(body), _at_zero(drawn), com=3e-9, inertia=1e-7)


def _at_zero(robot: Robot) -> Robot:
    return replace(robot, joints=tuple(replace(joint, drawn_position=0.0) for joint in robot.joints))


@pytest.mark.parametrize("normal", NORMALS)
def test_mirrored_twice_is_the_robot(normal: str, robot_library: Path, cache: Cache, tmp_path: Path) -> None:
    """Links and joints bit for bit; places of shared meshes within rounding."""
    robot = library_robot("stepbot_quadruped", cache, robot_library, tmp_path)
    twice = mirrored(mirrored(robot, normal), normal)
    assert twice.joints == robot.joints
    assert twice.frames == robot.frames
    assert [asset.name for asset in twice.meshes] == [asset.name for asset in robot.meshes]
    for ours, theirs in zip(twice.meshes, robot.meshes, strict=True):
        assert np.array_equal(ours.mesh.vertices, theirs.mesh.vertices)
        assert np.array_equal(ours.mesh.faces, theirs.mesh.faces)
    for link, former in zip(twice.links, robot.links, strict=True):
        assert link.mass_properties == former.mass_properties
        for shape, before in zip(link.shapes, former.shapes, strict=True):
            assert shape.geometry == before.geometry
            assert np.allclose(shape.X_LG.matrix, before.X_LG.matrix, rtol=0.0, atol=1e-12)
