"""What a picture of a robot or of an assembly shows."""

from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.geometry.spatial import IDENTITY
from stepbot.pictures.camera import VIEWS, camera_of
from stepbot.pictures.picture import Sheet, distinct_color, draw
from stepbot.pictures.scene import robot_subject, scene_of
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.picturing import Label, assembly_subject, part_labels
from stepbot.pipeline.stages import inspect
from stepbot.robot.model import Joint, JointKind, Robot
from stepbot.robot.posing import posed
from stepbot.step.assembly import Assembly
from tests import parts
from tests.robots import ROBOTS
from tests.workshop import Workshop, at

TOP = Sheet(400, 300, samples=1, view=VIEWS["top"])


def turning(kind: JointKind) -> Robot:
    """A plate, and another one 0.4 m from it, which turns about z or slides along y."""
    shop = Workshop()
    base = shop.link("base", [((0.1, 0.1, 0.002), IDENTITY)])
    arm = shop.link("arm", [((0.1, 0.1, 0.002), at(x=0.4))])
    axis = (0.0, 0.0, 1.0) if kind is JointKind.CONTINUOUS else (0.0, 1.0, 0.0)
    return Robot("turning", (base, arm), (Joint("joint", kind, "base", "arm", axis=axis),), meshes=shop.sorted_meshes())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "q", "middle"),
    [
        (JointKind.CONTINUOUS, 0.0, (0.4, 0.0)),
        (JointKind.CONTINUOUS, pi / 2, (0.0, 0.4)),
        (JointKind.CONTINUOUS, -2.0, (0.4 * cos(2.0), -0.4 * sin(2.0))),
        (JointKind.PRISMATIC, 0.25, (0.4, 0.25)),
    ],
)
def test_a_joint_moves_the_pixels_of_its_link(kind: JointKind, q: float, middle: tuple[float, float]) -> None:
    """From the top, the middle of the visible pixels of the link is where kinematics puts the plate."""
    robot = turning(kind)
    subject = robot_subject(robot, posed(robot, {"joint": q}))
    scene = scene_of(subject, TOP.view)
    assert scene is not None
    camera = camera_of(scene.vertices, TOP.view, TOP.width, TOP.height)
    ((x, y),) = camera.project((*middle, 0.001))
    assert draw(subject, TOP).places["arm"] == pytest.approx((x, y), abs=1.5)


def test_axes_go_through_their_joints() -> None:
    """Axes of joints and closures in the world, by independent kinematics of the planar linkage."""
    robot = ROBOTS["four_bar"]()
    axes = {axis.name: axis for axis in robot_subject(robot, posed(robot, {})).axes}
    assert set(axes) == {"crank_pin", "coupler_pin", "ground_pin", "rocker_pin"}
    for axis in axes.values():
        assert axis.direction == pytest.approx((0.0, 0.0, 1.0))
        assert (axis.turns, axis.slides) == (True, False)
    assert axes["coupler_pin"].point[:2] == pytest.approx((0.1 * cos(pi / 3), 0.1 * sin(pi / 3)))


def test_an_axis_of_a_universal_joint_stays_in_the_parent() -> None:
    """The first axis does not move with the second one."""
    robot = ROBOTS["universal"]()
    first, second = (name for name in posed(robot, {}) if name.endswith(("_1", "_2")))
    still = robot_subject(robot, posed(robot, {})).axes[0]
    moved = robot_subject(robot, posed(robot, {first: 0.3, second: 0.5})).axes[0]
    assert moved.direction == pytest.approx(still.direction)


def assembly_of(path: Path) -> Assembly:
    """The assembly of a STEP file."""
    inspection = inspect(path, Options(path.parent))
    assert inspection.assembly is not None
    return inspection.assembly


def test_equal_parts_share_a_label(tmp_path: Path) -> None:
    """A name with the number of occurrences; one label each if they are not folded."""
    parts.write_many(tmp_path / "many.step", count=3)
    assembly = assembly_of(tmp_path / "many.step")
    every = range(len(assembly.components))
    folded = part_labels(assembly, every, folded=True)
    assert [len(label.components) for label in folded] == [3]
    assert folded[0].text.endswith(" x3")
    assert [len(label.components) for label in part_labels(assembly, every, folded=False)] == [1, 1, 1]


def test_an_assembly_of_one_color_gets_one_for_each_label(tmp_path: Path) -> None:
    """Colours of the file are kept if there are several."""
    parts.write_hinge(tmp_path / "hinge.step")
    assembly = assembly_of(tmp_path / "hinge.step")
    labels = part_labels(assembly, assembly.children[0], folded=True)
    assert found_colors(assembly, labels) == {(0.439216,) * 3, (0.815686, 0.501961, 0.0)}
    bodies = tuple(replace(body, colors=(None,), face_colors=0 * body.face_colors) for body in assembly.bodies)
    plain = replace(assembly, bodies=bodies, components=tuple(replace(c, color=None) for c in assembly.components))
    assert found_colors(plain, labels) == {tuple(distinct_color(i).tolist()) for i in range(len(labels))}


def found_colors(assembly: Assembly, labels: list[Label]) -> set[tuple[float, ...]]:
    """The colours of the first faces of all bodies."""
    return {tuple(np.atleast_2d(shape.colors)[0].tolist()) for shape in assembly_subject(assembly, labels).shapes}


def test_parts_are_drawn_where_they_are_or_apart(tmp_path: Path) -> None:
    """Without a distance every body is at its place; with one, the two leaves move in opposite directions."""
    parts.write_hinge(tmp_path / "hinge.step")
    assembly = assembly_of(tmp_path / "hinge.step")
    labels = part_labels(assembly, assembly.children[0], folded=True)
    components = [c for c in assembly.components if c.body >= 0]
    together = assembly_subject(assembly, labels).shapes
    assert [shape.X_WG for shape in together] == [component.X_WC for component in components]
    moves = [s.X_WG.p - t.X_WG.p for s, t in zip(assembly_subject(assembly, labels, 1.0).shapes, together, strict=True)]
    assert max(np.linalg.norm(move) for move in moves) > 1e-3
