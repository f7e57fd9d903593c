"""`up` and `forward`: a robot drawn in any orientation equals the robot drawn upright."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.inertia import DIRECTIONS, vector
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import Robot
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import parse_sidecar
from tests.unit.assemble.workshop import Workshop, at, built

PAIRS = [(up, forward) for up, forward in product(DIRECTIONS, DIRECTIONS) if up[-1] != forward[-1]]
TEXT = """
    defaults: {{density: 1000}}
    root: {root}
    links: {{base: {{parts: [foot]}}, arm: {{parts: [arm]}}}}
    joints:
      j: {{type: revolute, parent: base, child: arm, limits: {{lower: -1, upper: 1}},
           origin: {{component: arm, offset: {{xyz: [1 mm, 2 mm, 3 mm]}}}}, axis: [0.6, 0, 0.8], zero: 20 deg}}
    frames: {{tip: {{link: arm, origin: {{component: arm, offset: {{xyz: [0, 0, 40 mm]}}}}}}}}
"""


def drawn(turned: Array, root: str, folder: Path) -> Robot:
    """A foot and an arm, the whole assembly rotated by R (3, 3)."""
    X = Pose.of(turned)
    shop = Workshop()
    shop.box("foot", (100, 60, 10), X @ at(5, 0, 5))
    shop.box("arm", (20, 30, 70), X @ at(10, 20, 45, (0.1, -0.2, 0.3)))
    return built(shop, folder, TEXT.format(root=root))


def assert_same(one: Robot, other: Robot) -> None:
    """Assert that two robots have equal masses, positions and motions."""
    for link, expected in zip(one.links, other.links, strict=True):
        assert link.name == expected.name
        np.testing.assert_allclose(link.mass_properties.mass, expected.mass_properties.mass, rtol=1e-12)
        np.testing.assert_allclose(link.mass_properties.com, expected.mass_properties.com, atol=1e-12)
        np.testing.assert_allclose(link.mass_properties.inertia, expected.mass_properties.inertia, atol=1e-15)
        for visual, same in zip(link.visuals, expected.visuals, strict=True):
            np.testing.assert_allclose(visual.X_LG.matrix, same.X_LG.matrix, atol=1e-12)
    for joint, same_joint in zip(one.joints, other.joints, strict=True):
        np.testing.assert_allclose(joint.X_PC.matrix, same_joint.X_PC.matrix, atol=1e-12)
        np.testing.assert_allclose(joint.axis, same_joint.axis, atol=1e-12)
    for frame, same_frame in zip(one.frames, other.frames, strict=True):
        np.testing.assert_allclose(frame.X_LF.matrix, same_frame.X_LF.matrix, atol=1e-12)


@pytest.mark.parametrize(("up", "forward"), PAIRS, ids=[f"{up},{forward}" for up, forward in PAIRS])
def test_against_the_assembly_turned_upright(up: str, forward: str, tmp_path: Path) -> None:
    """Each of the 24 orientations gives the robot of the upright drawing."""
    z, x = vector(up), vector(forward)  # type: ignore[arg-type]
    turned = np.column_stack([x, np.cross(z, x), z])  # rotates an upright drawing to this one
    assert np.linalg.det(turned) == pytest.approx(1.0)
    upright = drawn(np.eye(3), "{link: base}", tmp_path)
    assert_same(drawn(turned, f"{{up: {up}, forward: {forward}}}", tmp_path), upright)


@pytest.mark.parametrize(
    ("root", "forward"),
    [
        ("{up: z}", "x"),
        ("{up: y}", "x"),
        ("{up: -z}", "x"),
        ("{up: x}", "y"),
        ("{up: -x}", "y"),
        ("{forward: -y}", "-y"),
    ],
)
def test_defaults(root: str, forward: str, tmp_path: Path) -> None:
    """`forward` defaults to x unless that is up or down; `up` defaults to z."""
    up = root.partition("up: ")[2].strip("{}") or "z"
    expected = drawn(np.eye(3), f"{{up: {up}, forward: {forward}}}", tmp_path)
    assert_same(drawn(np.eye(3), root, tmp_path), expected)


def test_y_is_up(tmp_path: Path) -> None:
    """With `up: y` a point above the foot along y is above the base; the CAD's x stays, its z is to the right."""
    robot = drawn(np.eye(3), "{up: y}", tmp_path)
    X_CW = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    foot = robot.links[0].mass_properties
    np.testing.assert_allclose(foot.com, X_CW @ [0.005, 0, 0.005], atol=1e-12)


def test_with_a_frame(tmp_path: Path) -> None:
    """`frame` gives the position, the directions give the axes."""
    robot = drawn(np.eye(3), "{up: y, frame: {component: arm}}", tmp_path)
    foot = robot.links[0].mass_properties
    X_CW = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    np.testing.assert_allclose(foot.com, X_CW @ [-0.005, -0.02, -0.04], atol=1e-12)


@pytest.mark.parametrize("root", ["{up: y, forward: -y}", "{up: x, forward: x}", "{forward: z}"])
def test_forward_along_up(root: str) -> None:
    """`forward` along `up` is an error that lists the remaining directions."""
    text = f"version: 1\nrobot: r\nstep: r.step\nroot: {root}\nlinks: {{base: {{rest: true}}}}\n"
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(text, Path("r.robot.yaml"), diagnostics)
    assert sidecar is not None
    check_sidecar(sidecar, diagnostics)
    (fault,) = diagnostics
    assert (fault.code, fault.span.line) == ("SB128", 4)
    assert fault.help


@pytest.mark.parametrize("value", ["up", "Y", "[0, 1, 0]", "+y", "true"])
def test_other_words(value: str) -> None:
    """Only the six directions are accepted."""
    text = f"version: 1\nrobot: r\nstep: r.step\nroot: {{up: {value}}}\nlinks: {{base: {{rest: true}}}}\n"
    diagnostics = Diagnostics()
    assert parse_sidecar(text, Path("r.robot.yaml"), diagnostics) is None or diagnostics.has_errors
    assert diagnostics.has_errors
