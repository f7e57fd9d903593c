"""The written files of library robots as sources: what is read back is the robot of the STEP file."""

import json
from math import isfinite
from pathlib import Path

import numpy as np
import pytest

from stepbot.described.robot import robot_of_description
from stepbot.engines.describe import describe
from stepbot.report.robot import robot_of_report
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import JointKind, Robot

from .conftest import Converted, every_converted_robot

SUFFIXES = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}
PLAIN = {JointKind.FIXED, JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC}


def read_back(path: Path, written_in: str) -> Robot:
    """The robot of a written file; nothing of it is unsupported."""
    described = robot_of_description(describe(str(path), written_in), path.stem, path.name)
    assert not [one for one in described.findings if one.code in ("SB861", "SB866")], described.findings
    return described.robot


@every_converted_robot
@pytest.mark.parametrize("format_", SUFFIXES)
def test_written_file_reads_back_as_the_robot(robot: str, format_: str, converted: Converted) -> None:
    """Masses, inertias, limits and, for trees of simple joints, the poses of all links in a random configuration."""
    conversion = converted(robot)
    text = (conversion.folder / "report.json").read_text(encoding="utf-8")
    model = robot_of_report(json.loads(text))
    read = read_back(conversion.file(SUFFIXES[format_]), format_)
    for link in model.links:
        ours, theirs = link.mass_properties, read.link_by_name[link.name].mass_properties
        assert theirs.mass == pytest.approx(ours.mass, rel=1e-9)
        assert theirs.com == pytest.approx(ours.com, abs=1e-9)
        scale = float(np.abs(ours.inertia).max())
        assert np.array(theirs.inertia) == pytest.approx(np.array(ours.inertia), abs=1e-9 * scale)
    if any(joint.kind not in PLAIN for joint in model.joints) or model.closures:
        return
    for joint in model.joints:
        if joint.kind is not JointKind.FIXED:
            bounds = joint.limit.lower, joint.limit.upper
            found = read.joint_by_name[joint.name].limit
            assert (found.lower, found.upper) == pytest.approx(bounds, abs=1e-9) or not all(map(isfinite, bounds))
    random = np.random.Generator(np.random.PCG64(1))
    q = {joint.name: random.uniform(-0.5, 0.5) for joint in model.joints if joint.kind is not JointKind.FIXED}
    q = {name: value for name, value in q.items() if model.joint_by_name[name].mimic is None}
    expected, found_poses = link_poses(model, q), link_poses(read, q)
    for name, X in expected.items():
        assert max(X.distance_to(found_poses[name])) < 1e-9
