"""stepbot's reader of OpenUSD: files with changed values, and conventions of other programs."""

import re
from collections.abc import Callable, Mapping
from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Observation, Quantity, Request
from stepbot.engines.reference import observe_robot
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import Pose
from stepbot.robot.kinematics import configurations, initial_configuration, rates
from stepbot.robot.model import Robot
from tests.mechanisms import gear
from tests.robots import four_bar, primitives, tree, two_link_arm
from tests.simulators.conftest import failures, look

pytest.importorskip("pxr", reason="usd-core is not installed")


@cache
def original(build: Callable[[], Robot]) -> tuple[dict[str, bytes], Observation, Request]:
    """A robot's files, the expected observation, and the request, which is for a few configurations."""
    robot = lower(build(), FORMATS["usd"], Diagnostics())
    request = Request(
        "",
        "usd",
        configurations(robot, 3),
        initial_configuration(robot),
        simulate=0.0,
        closures=robot.closures,
        rates=rates(robot, 3),
    )
    return render(build(), "usd", Diagnostics()), observe_robot(robot, request), request


def written(files: Mapping[str, bytes], folder: Path) -> Path:
    """The main one of the files, after they were written to a folder."""
    for path, content in files.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content)
    return folder / next(iter(files))


def changed(build: Callable[[], Robot], folder: Path, pattern: str, new: str) -> set[Quantity]:
    """The quantities that differ after the first match of a pattern in a robot's file is replaced."""
    files, expected, request = original(build)
    file = written(files, folder)
    edited, count = re.subn(pattern, new, file.read_text(encoding="utf-8"), count=1, flags=re.DOTALL)
    assert count == 1, pattern
    file.write_text(edited, encoding="utf-8")
    return failures(expected, look("usd", replace(request, file=str(file))))


@pytest.mark.parametrize("build", [two_link_arm, four_bar, gear, tree, primitives])
def test_unchanged_files_have_no_difference(build: Callable[[], Robot], tmp_path: Path) -> None:
    """The files that the other tests change are right."""
    assert changed(build, tmp_path, "^", "") == set()


NUMBER = r"-?[\d.]+"
DYNAMICS = {Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS}


@pytest.mark.parametrize(
    ("pattern", "new", "expected"),
    [
        (r"physics:mass = 0.972", "physics:mass = 0.9721", {Quantity.MASS, *DYNAMICS}),
        (r"physics:centerOfMass = \(0.15,", "physics:centerOfMass = (0.1501,", {Quantity.COM, *DYNAMICS}),
        (r"physics:diagonalInertia = \(0.0002025", "physics:diagonalInertia = (0.0002026", {Quantity.INERTIA}),
        (r"physics:lowerLimit = -60", "physics:lowerLimit = -60.001", {Quantity.LIMITS, Quantity.ACTUATORS}),
        (r"newton:velocityLimit = 180", "newton:velocityLimit = 180.01", {Quantity.LIMITS}),
        (r"newton:armature = 0.003", "newton:armature = 0.0031", {Quantity.DYNAMICS}),
        (r"physics:maxForce = 12.5", "physics:maxForce = 12.6", {Quantity.ACTUATORS}),
        (r"physics:stiffness = 1.745", "physics:stiffness = 1.746", {Quantity.ACTUATORS}),
        (r'actuator = "shoulder_motor"', 'actuator = "other_motor"', {Quantity.ACTUATORS}),
        (r"(def Xform \"tool0\".*?translate = \()0.25", r"\g<1>0.2501", {Quantity.FRAMES}),
        (r"color3f inputs:diffuseColor = \(0.", "color3f inputs:diffuseColor = (0.1", {Quantity.SHAPES}),
        (r"rel physics:body1 = </two_link_arm/base>", "rel physics:body1 = </two_link_arm/forearm>", None),
    ],
)
def test_a_changed_value_is_noticed(pattern: str, new: str, expected: set[Quantity] | None, tmp_path: Path) -> None:
    """Each value that is written is read, and a change of it is a difference of its quantity."""
    found = changed(two_link_arm, tmp_path, pattern, new)
    assert found if expected is None else found == expected


@pytest.mark.parametrize(
    ("build", "pattern", "new", "expected"),
    [
        (four_bar, "uniform bool physics:excludeFromArticulation = true", "", set()),  # it closes a loop all the same
        (four_bar, r"(Joint \"rocker_pin\".*?localPos0 = \()" + NUMBER, r"\g<1>0.5", {Quantity.CLOSURES}),
        (gear, r"mimicCoef1 = (-?)", r"mimicCoef1 = \g<1>1", {Quantity.MIMIC}),
        (tree, r"rel physics:filteredPairs = \[[^\]]*\]", "", {Quantity.CONTACTS}),
        (primitives, r"double radius = ", "double radius = 1", {Quantity.MESHES}),
    ],
)  # fmt: skip
def test_a_changed_structure_is_noticed(
    build: Callable[[], Robot], pattern: str, new: str, expected: set[Quantity], tmp_path: Path
) -> None:
    """Closures, mimics, filtered contacts and shapes are read."""
    found = changed(build, tmp_path, pattern, new)
    assert found == expected


@pytest.mark.parametrize("axis", [(0.0, 0.0, -1.0), (0.0, 0.6, 0.8), (1.0, 0.0, 0.0)])
def test_closures_about_any_axis(axis: tuple[float, float, float], tmp_path: Path) -> None:
    """UsdPhysics has axes X, Y and Z: the frames of other axes are turned, and read back."""
    robot = four_bar()
    R = Pose.from_xyz_rpy((0, 0, 0), (0.4, -0.2, 0.3))
    (pin,) = robot.closures
    turned = replace(pin, X_AF=pin.X_AF @ R, X_BF=pin.X_BF @ R, axis=axis)
    file = written(render(replace(robot, closures=(turned,)), "usd", Diagnostics()), tmp_path)
    seen = look("usd", Request(str(file), "usd", closures=(turned,), simulate=0.0))
    (closure,) = seen.closures or ()
    assert closure.axis == pytest.approx(axis, abs=1e-6)
    for found, expected in ((closure.X_AF, turned.X_AF), (closure.X_BF, turned.X_BF)):
        assert found is not None
        assert found.distance_to(expected) == pytest.approx((0.0, 0.0), abs=1e-6)


ELSEWHERE = """#usda 1.0
(
    defaultPrim = "door"
    metersPerUnit = 0.01
    kilogramsPerUnit = 0.001
    upAxis = "Y"
)

def Xform "door" (
    prepend apiSchemas = ["PhysicsArticulationRootAPI"]
)
{
    def Xform "frame" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {
        float physics:mass = 5000

        def Xform "leaf" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {
            float physics:mass = 2000
            point3f physics:centerOfMass = (40, 0, 0)
            float3 physics:diagonalInertia = (1000, 2000, 3000)
            double3 xformOp:translate = (10, 0, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]

            def Cube "panel" (
                prepend apiSchemas = ["PhysicsCollisionAPI"]
            )
            {
                double size = 2
                double3 xformOp:translate = (40, 0, 0)
                double3 xformOp:scale = (40, 100, 2)
                uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
            }

            def Xform "hinge_place"
            {
                double3 xformOp:translate = (-5, 0, 0)
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }
        }
    }

    def PhysicsRevoluteJoint "hinge"
    {
        uniform token physics:axis = "Y"
        rel physics:body0 = </door/frame/leaf/hinge_place>
        rel physics:body1 = </door/frame>
        point3f physics:localPos1 = (5, 0, 0)
        float physics:lowerLimit = -90
        float physics:upperLimit = 10
    }

    def PhysicsFixedJoint "wall"
    {
        rel physics:body0 = </door/frame>
    }
}
"""


def read(tmp_path: Path, text: str, **request: object) -> Observation:
    """The observation of a stage."""
    file = tmp_path / "stage.usda"
    file.write_text(text, encoding="utf-8")
    return look("usd", Request(str(file), "usd", simulate=0.0, **request))  # type: ignore[arg-type]


def test_conventions_of_other_programs(tmp_path: Path) -> None:
    """Centimetres, grams, y up, nested bodies, a joint from child to parent at a prim below the body."""
    seen = read(tmp_path, ELSEWHERE, configurations=({"hinge": pi / 6},))
    assert seen.base == "fixed"
    (joint,) = seen.joints
    assert (joint.parent, joint.child, joint.kind) == ("frame", "leaf", "revolute")
    # Its first body is the child: a positive angle turns the parent, so that the leaf turns the other way.
    assert joint.axis == pytest.approx((0.0, -1.0, 0.0))
    assert joint.limit is not None
    assert (joint.limit.lower, joint.limit.upper) == pytest.approx((-pi / 18, pi / 2))
    frame, leaf = seen.links
    assert (frame.mass, leaf.mass) == pytest.approx((5.0, 2.0))
    assert leaf.com == pytest.approx((0.4, 0.0, 0.0))
    np.testing.assert_allclose(leaf.inertia, 1e-7 * np.diag([1000, 2000, 3000]), rtol=1e-6)
    np.testing.assert_allclose(leaf.collision_bounds, [(0.0, -1.0, -0.02), (0.8, 1.0, 0.02)], atol=1e-9)
    assert frame.inertia is None  # a simulator would compute it
    (poses,) = seen.poses
    half = Pose.from_xyz_rpy((0.05, 0, 0), (0, -pi / 6, 0)) @ Pose.of(position=(0.05, 0, 0))
    assert poses["leaf"].distance_to(half) == pytest.approx((0.0, 0.0), abs=1e-7)


def test_passive_forces_of_a_slide_in_other_units(tmp_path: Path) -> None:
    """Damping in g/s, friction in g cm/s^2 and armature in g of a prismatic joint become SI."""
    given = "float newton:damping = 3\n        float newton:friction = 4\n        float newton:armature = 5\n"
    slide = ELSEWHERE.replace("PhysicsRevoluteJoint", "PhysicsPrismaticJoint")
    seen = read(tmp_path, slide.replace("float physics:lowerLimit", f"{given}        float physics:lowerLimit"))
    dynamics = seen.joints[0].dynamics
    assert dynamics is not None
    assert (dynamics.damping, dynamics.friction, dynamics.armature) == pytest.approx((3e-3, 4e-5, 5e-3))


KNOB = """    def Xform "knob" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {
        float physics:mass = 10
    }

    def PhysicsRevoluteJoint "turn" (
        prepend apiSchemas = ["NewtonMimicAPI"]
    )
    {
        uniform token physics:axis = "Y"
        rel physics:body0 = <BODY0>
        rel physics:body1 = <BODY1>
        float newton:mimicCoef0 = 90
        float newton:mimicCoef1 = 0.5
        rel newton:mimicJoint = </door/hinge>
    }

    def PhysicsFixedJoint "wall\""""


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_mimics_of_reversed_joints(sign: float, tmp_path: Path) -> None:
    """A joint whose first body is the child has the opposite sign, as leader and as follower."""
    ends = ("/door/frame/leaf", "/door/knob")[:: int(sign)]
    knob = KNOB.replace("BODY0", ends[0]).replace("BODY1", ends[1])
    seen = read(tmp_path, ELSEWHERE.replace('    def PhysicsFixedJoint "wall"', knob))
    (mimic,) = (joint.mimic for joint in seen.joints if joint.name == "turn")
    assert mimic is not None  # turn = 90 deg + 0.5 hinge in the file, where the hinge is reversed
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("hinge", -0.5 * sign, pytest.approx(sign * pi / 2))


def test_a_scene_refers_to_a_file_with_an_at_sign(tmp_path: Path) -> None:
    """The scene of a robot with `@` in its name, which delimits paths in USD, has the robot and its meshes."""
    from pxr import Usd

    written(render(replace(two_link_arm(), name="arm@2"), "usd", Diagnostics()), tmp_path)
    stage = Usd.Stage.Open(str(tmp_path / "arm@2.scene.usda"))
    assert stage.GetPrimAtPath("/World/arm_2/forearm")
    assert stage.GetPrimAtPath("/World/arm_2/forearm/collisions/forearm_collision_1").GetAttribute("points").Get()


@pytest.mark.parametrize(
    ("old", "new", "error", "message"),
    [
        ("#usda 1.0", "#usda 9.9", EngineRefused, "9.9"),
        ('def PhysicsRevoluteJoint "hinge"', 'def Scope "hinge"', EngineCannotRead, "not connected to 'frame': leaf"),
        ("PhysicsFixedJoint", "PhysicsPrismaticJoint", EngineCannotRead, "joints to the world that move"),
        ("</door/frame/leaf/hinge_place>", "</door/nothing>", EngineRefused, "'hinge': no prim /door/nothing"),
        ("</door/frame/leaf/hinge_place>", "</door/frame>", EngineRefused, "does not connect two bodies"),
        ('physics:axis = "Y"', 'physics:axis = "Q"', EngineRefused, "joint 'hinge': axis 'Q' is not X, Y or Z"),
        ("float physics:lowerLimit = -90", 'string physics:lowerLimit = "low"', EngineRefused, "is not a number"),
        ("point3f physics:localPos1", "quatf physics:localRot0 = (0, 0, 0, 0)\n        point3f physics:localPos1",
         EngineRefused, "joint 'hinge': a quaternion of length 0"),
        ('"PhysicsRigidBodyAPI", ', "", EngineCannotRead, "no rigid bodies"),
    ],
)  # fmt: skip
def test_what_is_no_robot_is_rejected(old: str, new: str, error: type[Exception], message: str, tmp_path: Path) -> None:
    """Files of another version, loose bodies, moving joints to the world, missing prims."""
    assert old in ELSEWHERE
    with pytest.raises(error, match=re.escape(message)):
        read(tmp_path, ELSEWHERE.replace(old, new))
