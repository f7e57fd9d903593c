"""OpenUSD files, read by USD's library as any program would."""

from collections.abc import Callable
from math import pi, radians
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of
from stepbot.engines.observation import Request
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.formats.usd.usda import quoted, single
from stepbot.robot.metadata import Metadata
from stepbot.robot.model import Base, Limit, Robot
from tests.robots import (
    ROBOTS,
    every_robot,
    four_bar,
    gripper_with_mimic,
    odd_names,
    one_link,
    primitives,
    two_link_arm,
)

pxr = pytest.importorskip("pxr", reason="usd-core is not installed")

from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdUtils, UsdValidation  # noqa: E402

_FOLDERS: list[TemporaryDirectory[str]] = []
"""Folders of open stages, which map binary layers into memory."""


def stage_of(robot: Robot) -> Any:
    """The stage of a robot's file."""
    _FOLDERS.append(TemporaryDirectory())
    return Usd.Stage.Open(str(written(robot, Path(_FOLDERS[-1].name))))


def written(robot: Robot, folder: Path) -> Path:
    """A robot's main file, after its files were written to a folder."""
    files = render(robot, "usd", Diagnostics())
    for path, content in files.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content)
    return folder / next(iter(files))


@every_robot
def test_usds_validators_find_nothing(name: str, tmp_path: Path) -> None:
    """All validators that come with USD, those of UsdPhysics among them, have nothing to report on any file."""
    written(ROBOTS[name](), tmp_path)
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    for file in tmp_path.rglob("*.usd*"):
        errors = context.Validate(Usd.Stage.Open(str(file)))
        assert [f"{error.GetName()}: {error.GetMessage()}" for error in errors] == []


def test_usds_compliance_checker_finds_nothing(tmp_path: Path) -> None:
    """What `usdchecker` ran before UsdValidation has no error, no warning and no check that fails in any file."""
    if not hasattr(UsdUtils, "ComplianceChecker"):
        pytest.skip("usd-core 26.11 has UsdValidation in place of ComplianceChecker")
    for build in ROBOTS.values():
        written(build(), tmp_path)
    files = [str(file) for file in tmp_path.rglob("*.usd*")]
    assert len(files) > 2 * len(ROBOTS)
    for file in files:
        checker = UsdUtils.ComplianceChecker()
        checker.CheckCompliance(file)
        assert [*checker.GetErrors(), *checker.GetFailedChecks(), *checker.GetWarnings()] == []


@every_robot
def test_text_has_no_long_arrays(name: str) -> None:
    """Validators want arrays of more than 64 values in binary layers."""
    stage = stage_of(ROBOTS[name]())
    arrays = [
        spec
        for prim in stage.Traverse()
        for attribute in prim.GetAttributes()
        for spec in attribute.GetPropertyStack(Usd.TimeCode.Default())
        if spec.typeName.isArray and spec.layer.GetFileFormat().formatId == "usda"
    ]
    assert [spec.path for spec in arrays if len(spec.default or ()) > 64] == []


def test_units_and_axis_are_declared() -> None:
    """Metres, kilograms, z up, and one root prim, which is the default one."""
    stage = stage_of(two_link_arm())
    assert UsdGeom.GetStageMetersPerUnit(stage) == UsdPhysics.GetStageKilogramsPerUnit(stage) == 1.0
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert stage.GetPseudoRoot().GetChildren() == [stage.GetDefaultPrim()]
    assert stage.GetDefaultPrim().HasAPI(UsdPhysics.ArticulationRootAPI)


def test_angles_are_in_degrees() -> None:
    """Limits, gains and targets of joints that turn are in degrees, and per degree."""
    stage = stage_of(two_link_arm())
    joint = stage.GetPrimAtPath("/two_link_arm/joints/shoulder")
    limits = UsdPhysics.RevoluteJoint(joint)
    assert limits.GetLowerLimitAttr().Get() == pytest.approx(-60.0, rel=1e-7)
    drive = UsdPhysics.DriveAPI(joint, "angular")
    assert drive.GetTypeAttr().Get() == "force"  # the gains are of forces, not of accelerations
    assert drive.GetStiffnessAttr().Get() == pytest.approx(radians(100.0), rel=1e-7)
    assert drive.GetMaxForceAttr().Get() == 12.5
    assert joint.GetAttribute("newton:velocityLimit").Get() == pytest.approx(180.0, rel=1e-7)
    assert joint.GetAttribute("newton:damping").Get() == pytest.approx(0.05 * pi / 180.0, rel=1e-7)
    assert joint.GetAttribute("newton:armature").Get() == pytest.approx(0.003, rel=1e-7)


def test_closures_are_excluded_from_the_articulation() -> None:
    """The joint that closes a loop is a constraint beside the tree; the others are in the tree."""
    stage = stage_of(four_bar())
    joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    excluded = [one.GetPrim().GetName() for one in joints if one.GetExcludeFromArticulationAttr().Get()]
    assert excluded == [closure.name for closure in four_bar().closures]


def test_a_mesh_is_in_the_file_once() -> None:
    """Two visuals and a collision with one mesh share it: visuals are instances of one prototype."""
    robot = one_link()
    (visual, *_), (collision, *_) = robot.root.visuals, robot.root.collisions
    link = replace(robot.root, visuals=(visual, replace(visual, name="again")), collisions=(collision,))
    stage = stage_of(replace(robot, links=(link,)))
    (layer,) = (layer for layer in stage.GetUsedLayers() if layer.realPath.endswith(".usdc"))
    assert layer.ExportToString().count("point3f[] points") == 1
    assert len(stage.GetPrototypes()) == 1
    meshes = [prim for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Mesh)]
    assert len(meshes) == 3
    assert len({len(UsdGeom.Mesh(prim).GetPointsAttr().Get()) for prim in meshes}) == 1


def test_native_shapes_are_native() -> None:
    """Boxes, cylinders, spheres and capsules are gprims; meshes have an approximation, others none."""
    stage = stage_of(primitives())
    colliders = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.CollisionAPI)]
    assert {prim.GetTypeName() for prim in colliders} >= {"Cube", "Cylinder", "Sphere", "Capsule"}
    for prim in colliders:
        assert prim.HasAPI(UsdPhysics.MeshCollisionAPI) == prim.IsA(UsdGeom.Mesh)
        assert UsdGeom.Imageable(prim).ComputePurpose() == "guide"


def test_colours_are_linear_materials() -> None:
    """A material for each colour; USD's colours are linear, those of CAD programs are sRGB."""
    stage = stage_of(two_link_arm())
    surfaces = [UsdShade.Shader(prim) for prim in stage.Traverse() if prim.IsA(UsdShade.Shader)]
    rgba = {visual.rgba for link in two_link_arm().links for visual in link.visuals}
    assert len(surfaces) == len(rgba)
    orange = next(one for one in rgba if one[0] > one[2])
    (seen,) = [one.GetInput("diffuseColor").Get() for one in surfaces if one.GetInput("diffuseColor").Get()[2] < 0.3]
    for channel, linear in zip(orange, seen, strict=False):
        assert linear == pytest.approx(((channel + 0.055) / 1.055) ** 2.4 if channel > 0.04045 else channel / 12.92)


@pytest.mark.parametrize("opacity", [1.0, 0.25])
def test_visuals_have_the_colour_of_their_material(opacity: float) -> None:
    """Viewers without materials, such as Newton's, draw the display colour."""
    robot = two_link_arm()
    links = [
        replace(link, visuals=tuple(replace(one, rgba=(*one.rgba[:3], opacity)) for one in link.visuals))
        for link in robot.links
    ]
    stage = stage_of(replace(robot, links=tuple(links)))
    meshes = [prim for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Gprim)]
    drawn = [prim for prim in meshes if UsdGeom.Imageable(prim).ComputePurpose() == "default"]
    assert len(drawn) == sum(len(link.visuals) for link in links)
    for prim in drawn:
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        shader = material.ComputeSurfaceSource()[0]
        (color,) = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor").Get()
        assert color == shader.GetInput("diffuseColor").Get()
        transparent = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayOpacity")
        assert list(transparent.Get() or [1.0]) == [opacity] == [shader.GetInput("opacity").Get()]


def targets(prim: Any, name: str) -> list[Any]:
    """The prims of a relationship of Isaac Sim's robot schema, which must be prepended."""
    relationship = prim.GetRelationship(f"isaac:physics:{name}")
    assert not any(spec.targetPathList.isExplicit for spec in relationship.GetPropertyStack())
    return [prim.GetStage().GetPrimAtPath(path) for path in relationship.GetTargets()]


@every_robot
def test_isaac_sims_schema_lists_links_and_joints(name: str) -> None:
    """All links, the base first, and the joints of the articulation, the one to the world first, have its schemas."""
    robot = lower(ROBOTS[name](), FORMATS["usd"], Diagnostics())
    stage = stage_of(ROBOTS[name]())
    top = stage.GetDefaultPrim()
    assert "IsaacRobotAPI" in top.GetPrimTypeInfo().GetAppliedAPISchemas()
    links = targets(top, "robotLinks")
    assert [prim.GetDisplayName() or prim.GetName() for prim in links] == [link.name for link in robot.links]
    assert {prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)} == set(links)
    assert {prim for prim in stage.Traverse() if applies(prim, "IsaacLinkAPI")} == set(links)
    joints = targets(top, "robotJoints")
    fixed = robot.base is Base.FIXED
    assert [not UsdPhysics.Joint(prim).GetBody0Rel().GetTargets() for prim in joints[:1]] == [fixed] * bool(joints)
    named = [prim.GetDisplayName() or prim.GetName() for prim in joints[int(fixed) :]]
    assert named == [joint.name for joint in robot.joints]
    assert {prim for prim in stage.Traverse() if applies(prim, "IsaacJointAPI")} == set(joints)
    assert not any(UsdPhysics.Joint(prim).GetExcludeFromArticulationAttr().Get() for prim in joints)
    assert top.GetAttribute("isaac:robotType").Get() == ("Manipulator" if fixed else None)
    sites = [prim for prim in stage.Traverse() if applies(prim, "IsaacSiteAPI")]
    assert len(sites) == len(robot.frames)


def applies(prim: Any, schema: str) -> bool:
    """Whether a prim has a schema that USD itself does not know."""
    return schema in prim.GetPrimTypeInfo().GetAppliedAPISchemas()


def test_isaac_sims_schema_has_the_names_and_the_metadata() -> None:
    """Names that are no identifiers, and who made the robot."""
    stated = Metadata("Ada", "ada@example.com", "Apache-2.0", "1.2.3", 'An "odd" one')
    robot = replace(odd_names(), metadata=stated, source="odd.step")
    stage = stage_of(robot)
    top = stage.GetDefaultPrim()
    values = {name: top.GetAttribute(f"isaac:{name}").Get() for name in ("license", "version", "description", "source")}
    assert list(values.values()) == ["Apache-2.0", "1.2.3", 'An "odd" one', "odd.step"]
    for relation, attribute, named in (
        ("robotLinks", "isaac:nameOverride", robot.links),
        ("robotJoints", "isaac:NameOverride", robot.joints),
    ):
        seen = [prim.GetAttribute(attribute).Get() or prim.GetName() for prim in targets(top, relation)]
        assert [name for name in seen if name != "world_joint"] == [one.name for one in named]
    plain = stage_of(two_link_arm())
    assert not plain.GetDefaultPrim().HasAttribute("isaac:license")


def test_names_are_identifiers_that_keep_the_name() -> None:
    """A prim of another name than its link has that as display name; no two prims have one path."""
    robot = odd_names()
    stage = stage_of(robot)
    bodies = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert [prim.GetDisplayName() or prim.GetName() for prim in bodies] == [link.name for link in robot.links]
    assert len({prim.GetPath() for prim in bodies}) == len(robot.links)
    assert stage.GetDefaultPrim().GetDisplayName() == robot.name


def test_names_that_become_the_same_are_numbered() -> None:
    """`a b`, `a-b` and the scopes of the robot are different prims."""
    robot = gripper_with_mimic()
    new = dict(zip((link.name for link in robot.links), ("a b", "a-b", "joints", "1", "m"), strict=False))
    joints = [replace(one, parent=new[one.parent], child=new[one.child]) for one in robot.joints]
    links = [replace(link, name=new[link.name]) for link in robot.links]
    frames = [replace(frame, link=new[frame.link]) for frame in robot.frames]
    stage = stage_of(replace(robot, links=tuple(links), joints=tuple(joints), frames=tuple(frames)))
    bodies = [prim.GetName() for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert bodies[:3] == ["a_b", "a_b_", "joints_"]


def test_a_floating_robot_has_no_joint_to_the_world() -> None:
    """It stands on z = 0 in the drawn pose."""
    robot = replace(two_link_arm(), base=Base.FLOATING)
    stage = stage_of(robot)
    assert not stage.GetPrimAtPath("/two_link_arm/joints/world_joint")
    box = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "guide"]).ComputeWorldBound(stage.GetDefaultPrim())
    assert box.ComputeAlignedBox().GetMin()[2] == pytest.approx(0.0, abs=1e-6)
    assert stage_of(two_link_arm()).GetPrimAtPath("/two_link_arm/joints/world_joint")


def test_the_files_are_complete(tmp_path: Path) -> None:
    """The robot refers to its meshes, the scene to the robot, and none to anything else."""
    written(two_link_arm(), tmp_path)
    for file, layers in (("meshes/two_link_arm.usdc", 1), ("two_link_arm.usda", 2), ("two_link_arm.scene.usda", 3)):
        found, assets, unresolved = UsdUtils.ComputeAllDependencies(str(tmp_path / file))
        assert (len(found), assets, unresolved) == (layers, [], [])


@pytest.mark.parametrize("build", [two_link_arm, odd_names])
def test_the_scene_has_the_robot_gravity_and_a_floor(build: Callable[[], Robot], tmp_path: Path) -> None:
    """The robot of the scene is that of its file, for validators, for the reader, and for UsdPhysics."""
    file = str(written(build(), tmp_path).with_name(f"{build().name}.scene.usda"))
    stage = Usd.Stage.Open(file)
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(stage)] == []
    request = Request(file, "usd", configurations=({},), simulate=0.0)
    seen = engine_of("usd").observer.observe(request)
    alone = engine_of("usd").observer.observe(replace(request, file=file.replace(".scene.", ".")))
    assert seen.gravity == pytest.approx((0.0, 0.0, -9.81))
    assert alone.gravity == ()
    assert (seen.joints, seen.base) == (alone.joints, alone.base)
    assert [link.mass for link in seen.links] == [link.mass for link in alone.links]
    assert [len(link.visuals) for link in seen.links] == [len(link.visuals) for link in alone.links]
    assert stage.GetPrimAtPath("/World/floor").HasAPI(UsdPhysics.CollisionAPI)
    models = [prim.GetPath().pathString for prim in stage.Traverse(Usd.PrimIsModel)]
    assert models[0] == "/World"
    assert len(models) == 2  # the world and the robot, a component in it


def test_singles_read_back_as_singles() -> None:
    """The shortest text of a single, whole numbers without a point, and no minus zero."""
    assert [single(value) for value in (0.1, 1.0, -0.0, 1 / 3, 1e-9, 16777217.0)] == [
        "0.1", "1", "0", "0.33333334", "0.000000001", "16777216",
    ]  # fmt: skip
    with pytest.raises(ValueError, match="NaN"):
        single(float("nan"))


def test_strings_are_escaped() -> None:
    """Any name is a string of the text format."""
    for text in ('a "b"', "back\\slash", "new\nline", "Röhre", "tab\t\x7f"):
        layer = Sdf.Layer.CreateAnonymous(".usda")
        assert layer.ImportFromString(f"#usda 1.0\n(\n    doc = {quoted(text)}\n)\n")
        assert layer.documentation == text


def test_a_joint_drawn_beyond_half_a_turn_is_read_back(tmp_path: Path) -> None:
    """Poses do not tell full turns apart: the reader reports the turn that is expected, or else the nearest to 0."""
    robot = two_link_arm()
    elbow = replace(robot.joints[1], limit=Limit(-4.0, 4.0), drawn_position=3.5)
    file = written(replace(robot, joints=(robot.joints[0], elbow)), tmp_path)
    request = Request(str(file), "usd", simulate=0.0)
    observe = engine_of("usd").observer.observe
    assert observe(request).initial == pytest.approx({"shoulder": 0.0, "elbow": 3.5 - 2.0 * pi}, abs=1e-6)
    expected = observe(replace(request, initial={"elbow": 3.5})).initial
    assert expected == pytest.approx({"shoulder": 0.0, "elbow": 3.5}, abs=1e-6)
