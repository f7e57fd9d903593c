"""The layers of `convert --for simready`, composed by USD's library as any program would."""

from collections.abc import Iterator
from functools import cache
from math import degrees, isfinite, radians
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation import Request
from stepbot.engines.reference import observe_robot
from stepbot.formats import FORMATS
from stepbot.formats.learning import simready_folder
from stepbot.formats.lowering import lower
from stepbot.robot.kinematics import configurations, initial_configuration, rates
from stepbot.robot.model import ActuatorKind, Joint, JointKind, Robot
from tests.robots import ROBOTS, every_robot
from tests.simulators.conftest import failures, look

pxr = pytest.importorskip("pxr", reason="usd-core is not installed")

from pxr import Sdf, Usd  # noqa: E402

ENGINES = {"Newton": ("Newton", "newton:"), "PhysX": ("Physx", "physx"), "MuJoCo": ("Mjc", "mjc:")}
"""How the schemas and properties of each engine begin."""
NEUTRAL = ("Physics", "physics:")
_FOLDERS: list[TemporaryDirectory[str]] = []
"""Folders of open stages, which map binary layers into memory."""


@cache
def lowered(name: str) -> Robot:
    """A robot as OpenUSD expresses it."""
    return lower(ROBOTS[name](), FORMATS["usd"], Diagnostics())


def written(robot: Robot, engine: str = "") -> Path:
    """The main file of a robot's asset in a folder of its own, with the variant of an engine selected."""
    _FOLDERS.append(TemporaryDirectory())
    folder = Path(_FOLDERS[-1].name)
    for path, content in simready_folder(robot).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)
    main = folder / "simready" / robot.name / "usd" / f"{robot.name}.usda"
    if engine:
        text = main.read_text(encoding="utf-8")
        assert f'string {engine} = "Disabled"' in text
        main.write_text(text.replace(f'string {engine} = "Disabled"', f'string {engine} = "Enabled"'), encoding="utf-8")
    return main


def stated(prim: Any) -> Iterator[str]:
    """Names of the schemas and properties that layers state of a composed prim."""
    yield from prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    yield from prim.GetAuthoredPropertyNames()


def stated_at(layer: Any, at: Any) -> list[str]:
    """Names of the schemas that one layer applies to a prim, or of its attribute."""
    spec = layer.GetObjectAtPath(at)
    if isinstance(spec, Sdf.PrimSpec):
        return list(spec.GetInfo("apiSchemas").GetAppliedItems())
    return [spec.name] if isinstance(spec, Sdf.AttributeSpec) else []


@every_robot
def test_newtons_variant_is_the_robot(name: str) -> None:
    """What the layers compose to is what the single file has, by stepbot's reader and the model itself."""
    robot = lowered(name)
    drawn = initial_configuration(robot)
    request = Request(
        str(written(robot, "Newton")),
        "usd",
        configurations(robot, 3),
        drawn,
        simulate=0.0,
        closures=robot.closures,
        rates=rates(robot, 3),
    )
    assert failures(observe_robot(robot, request), look("usd", request)) == set()


@every_robot
@pytest.mark.parametrize("engine", ["", *ENGINES])
def test_variants_compose_what_is_theirs(name: str, engine: str) -> None:
    """Without errors, and with no schema or property of another engine."""
    stage = Usd.Stage.Open(str(written(lowered(name), engine)))
    assert stage.GetCompositionErrors() == []
    names = {one for prim in stage.TraverseAll() for one in stated(prim)}
    for other, begins in ENGINES.items():
        found = {one for one in names if one.startswith(begins)}
        if other == engine:
            assert found or not lowered(name).joints
        else:
            assert not found, (other, found)


@every_robot
def test_each_layer_has_one_concern(name: str) -> None:
    """UsdPhysics is stated in its layer alone, so that it can be left out or replaced."""
    main = written(lowered(name))
    for path in main.parent.rglob("*.usda"):
        layer, names = Sdf.Layer.FindOrOpen(str(path)), set[str]()
        layer.Traverse(Sdf.Path.absoluteRootPath, lambda at, of=layer, into=names: into.update(stated_at(of, at)))
        physical = {one for one in names if one.startswith(NEUTRAL)}
        allowed = {"physics:approximation"} if path.stem == "mujoco" else set()  # it takes convex hulls of all meshes
        assert bool(physical) is (path.stem == "physics") or physical == allowed, path


def in_degrees(joint: Joint, value: float) -> float:
    """A position or speed in the unit of UsdPhysics."""
    return value if joint.kind is JointKind.PRISMATIC else degrees(value)


@every_robot
def test_numbers_of_physx_and_mujoco(name: str) -> None:
    """Armature, passive forces, velocity limits, mimics and drives are the model's, in the units of each engine."""
    robot = lowered(name)
    physx, mujoco = (Usd.Stage.Open(str(written(robot, engine))) for engine in ("PhysX", "MuJoCo"))
    (scope,) = (one for one in physx.GetDefaultPrim().GetChildren() if one.GetName() == "joints")
    paths = {joint.name: child.GetPath() for joint, child in zip(robot.joints, scope.GetChildren(), strict=False)}
    for joint in robot.joints:
        if not joint.kind.is_pair:
            continue
        axis = "linear" if joint.kind is JointKind.PRISMATIC else "angular"
        at, mjc = physx.GetPrimAtPath(paths[joint.name]), mujoco.GetPrimAtPath(paths[joint.name])
        expected = {
            "armature": joint.dynamics.armature,
            "staticFrictionEffort": joint.dynamics.friction,
            "maxJointVelocity": in_degrees(joint, joint.limit.velocity) if isfinite(joint.limit.velocity) else 0.0,
        }
        damping = joint.dynamics.damping
        expected["viscousFrictionCoefficient"] = damping if joint.kind is JointKind.PRISMATIC else radians(damping)
        for quantity, value in expected.items():
            assert (at.GetAttribute(f"physxJointAxis:{axis}:{quantity}").Get() or 0.0) == pytest.approx(value, 1e-6)
        for quantity, value in (("armature", joint.dynamics.armature), ("damping", joint.dynamics.damping)):
            assert (mjc.GetAttribute(f"mjc:{quantity}").Get() or 0.0) == value
        if joint.mimic is not None:
            gearing, offset = (at.GetAttribute(f"physxMimicJoint:rotX:{one}").Get() for one in ("gearing", "offset"))
            leader, theta = robot.joint_by_name[joint.mimic.joint], 0.3
            follower = joint.mimic.multiplier * theta + joint.mimic.offset
            # PhysX holds follower + gearing leader + offset at 0
            assert in_degrees(joint, follower) + gearing * in_degrees(leader, theta) + offset == pytest.approx(
                0, abs=1e-4
            )
            assert mjc.GetAttribute("mjc:coef0").Get() == joint.mimic.offset
            assert mjc.GetAttribute("mjc:coef1").Get() == joint.mimic.multiplier
            assert mjc.GetRelationship("mjc:target").GetTargets() == [paths[leader.name]]
    actuators = [prim for prim in mujoco.Traverse() if prim.GetTypeName() == "MjcActuator"]
    assert len(actuators) == len(robot.actuators)
    for actuator, prim in zip(robot.actuators, actuators, strict=True):
        assert prim.GetRelationship("mjc:target").GetTargets() == [paths[actuator.joint]]
        kp, kv = actuator.kp, actuator.kv
        kinds = {ActuatorKind.POSITION: ([kp], [0.0, -kp, -kv]), ActuatorKind.VELOCITY: ([kv], [0.0, 0.0, -kv])}
        if actuator.kind in kinds:
            found = [list(prim.GetAttribute(f"mjc:{one}").Get()) for one in ("gainPrm", "biasPrm")]
            assert found == [one + [0.0] * (10 - len(one)) for one in kinds[actuator.kind]]
        else:
            assert not prim.GetAttribute("mjc:gainPrm").HasAuthoredValue()


def test_a_link_may_have_the_name_of_the_scope_of_actuators() -> None:
    """Both are there, under two names."""
    robot = lowered("two_link_arm")
    old = robot.links[-1].name
    named = replace(
        robot,
        links=tuple(replace(link, name="actuators") if link.name == old else link for link in robot.links),
        joints=tuple(replace(one, child="actuators") if one.child == old else one for one in robot.joints),
        frames=(),
        sensors=(),
        excluded_contacts=(),
    )
    stage = Usd.Stage.Open(str(written(named, "MuJoCo")))
    (link,) = (prim for prim in stage.Traverse() if prim.GetName() == "actuators")
    assert link.HasAPI("PhysicsRigidBodyAPI")
    motors = [prim for prim in stage.Traverse() if prim.GetTypeName() == "MjcActuator"]
    assert len(motors) == len(robot.actuators) > 0
    assert not any(prim.GetPath().HasPrefix(link.GetPath()) for prim in motors)


def test_same_bytes() -> None:
    """Twice, and without files that nothing refers to."""
    robot = lowered("primitives")
    assert simready_folder(robot) == simready_folder(replace(robot))
    bare = replace(robot, links=tuple(replace(link, visuals=(), collisions=()) for link in robot.links))
    assert {Path(path).stem for path in simready_folder(robot)} - {
        Path(path).stem for path in simready_folder(bare)
    } == {"geometries", "instances", "materials"}
