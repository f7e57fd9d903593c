"""OpenUSD files of library robots in NVIDIA's validators, and beside those of converters that others wrote."""

import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from stepbot.engines import engine_of
from stepbot.engines.observation import Observation, Request
from stepbot_cli import main
from tests.library.conftest import every_robot, name_of, sidecar_of
from tests.processes import call_isolated, python_with

pytestmark = pytest.mark.long

ROBOTS = ("universal_robots_ur5e", "stepbot_delta")
"""A tree, and a mechanism with loops."""
ASSET_VALIDATOR = ("omniverse-asset-validator[usd]>=1.18,<2",)
SIMREADY_VALIDATOR = ("simready-validate>=2026.8", "simready-foundation-tier-core>=2026.8")
CONVERTERS = ("mujoco-usd-converter>=0.8,<0.9", "urdf-usd-converter>=0.3.4,<0.4")
"""They come with a USD library of their own, so that they need an environment of their own."""
NEWTON = ("newton>=1.8,<2", "newton-usd-schemas>=0.6,<1", "usd-core", "mujoco", "mujoco-warp", "scipy")
READ_BY_NEWTON = """
import json
import sys

import newton  # before pxr: it adds schemas
from pxr import Usd

resolvers = {name: getattr(newton.usd, f"SchemaResolver{name}") for name in ("Newton", "Physx", "Mjc")}
found = {}
for variant, resolver in zip(("Newton", "PhysX", "MuJoCo"), resolvers.values()):
    stage = Usd.Stage.Open(sys.argv[1])
    stage.GetDefaultPrim().GetVariantSet(variant).SetVariantSelection("Enabled")
    builder = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    builder.add_usd(stage, schema_resolvers=[resolver()], skip_mesh_approximation=True)
    names = ("armature", "friction", "effort_limit", "velocity_limit", "target_ke", "target_kd", "limit_lower")
    found[variant] = {name: [float(value) for value in getattr(builder, f"joint_{name}")] for name in names}
    found[variant]["mass"] = [float(value) for value in builder.body_mass]
    leaders, ratios = builder.joint_mimic_joint, [list(one) for one in builder.joint_mimic_coeffs]
    followers = {joint: [leader, *ratios[joint]] for joint, leader in enumerate(leaders) if leader >= 0}
    rows = zip(*(getattr(builder, f"constraint_mimic_{one}") for one in ("joint0", "joint1", "coef0", "coef1")))
    found[variant]["mimics"] = sorted([joint, *map(float, one)] for joint, one in followers.items())
    found[variant]["mimics"] += sorted(list(map(float, row)) for row in rows)
print(json.dumps(found))
"""
"""What Newton reads of each variant, by its readers of the three families of schemas."""
PROFILE = "Robot-Body"
PACKAGING = {"FET_000_STANDARD", "FET_000_ISAAC", "FET_100_ISAAC"}
"""Optional features about folders, thumbnails, dates and layers of an asset library."""
OTHER_PROGRAMS = {
    *("FET_000_PHYSX", "FET_000_NEWTON", "FET_000_MUJOCO", "FET_003_MUJOCO", "FET_004_MUJOCO", "FET_004_ROBOT_MUJOCO"),
    *("FET_022_MUJOCO", "FET_025_ROS", "FET_006_MDL", "FET_006_OPENPBR"),
}
"""Optional features that are variants for one runtime each, schemas of MuJoCo, ROS bridges of Isaac Sim, and materials
beside those of USD."""
PASSIVE = {"FET_022_NEWTON"}
"""An optional feature that wants a drive in every joint that moves: the elbows of the delta robot have no motor."""
ISAAC_SCHEMAS = ("IsaacRobotAPI", "IsaacLinkAPI", "IsaacJointAPI", "IsaacSiteAPI")
ROBOT_SCHEMA = """
from enum import Enum
from types import SimpleNamespace

Classes = Enum("Classes", {"ROBOT_API": "IsaacRobotAPI", "LINK_API": "IsaacLinkAPI", "JOINT_API": "IsaacJointAPI"})
Relations = SimpleNamespace(
    ROBOT_LINKS=SimpleNamespace(name="isaac:physics:robotLinks"),
    ROBOT_JOINTS=SimpleNamespace(name="isaac:physics:robotJoints"),
)
"""
"""Names of Isaac Sim's module that SimReady's rules import; without it they end with an error, and count as passed."""


Converted = Callable[[str], Path]


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Converted:
    """Returns the folder of a library robot with its URDF, MJCF and OpenUSD; each is converted on first use."""

    @cache
    def convert(robot: str) -> Path:
        folder = tmp_path_factory.mktemp("converted") / name_of(robot)
        command = ["convert", str(sidecar_of(robot)), "-o", str(folder), "--no-verify", "-f", "urdf,mjcf,usd"]
        command += ["--for", "simready"]
        assert main(command) == 0
        return folder

    return convert


@pytest.fixture(scope="module")
def asset_validator(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter with NVIDIA's Asset Validator."""
    return python_with(ASSET_VALIDATOR, tmp_path_factory.mktemp("asset_validator"))


@pytest.fixture(scope="module")
def simready(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter with SimReady's validator."""
    return python_with(SIMREADY_VALIDATOR, tmp_path_factory.mktemp("simready"))


@pytest.fixture(scope="module")
def converters(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter with the converters."""
    return python_with(CONVERTERS, tmp_path_factory.mktemp("converters"))


def usd_in(folder: Path) -> Path:
    """The OpenUSD file in a folder."""
    (file,) = (file for file in folder.glob("*.usda") if not file.name.endswith(".scene.usda"))
    return file


@every_robot
def test_asset_validator_has_no_remark(robot: str, converted: Converted, asset_validator: Path, tmp_path: Path) -> None:
    """Its command with default settings finds no issue in any file: robot, scene and meshes."""
    usd = tmp_path / "usd"
    shutil.copytree(converted(robot), usd, ignore=lambda _, names: [one for one in names if is_other_file(one)])
    assert len(list(usd.rglob("*.usd*"))) == 3
    code, text = validated(asset_validator, usd)
    assert code == 0, text
    assert [line for line in text.splitlines() if not line.startswith("INFO:omni.asset_validator.")] == []
    assert text.endswith("No issues found.\n")


def test_asset_validator_notices_faults(converted: Converted, asset_validator: Path, tmp_path: Path) -> None:
    """The same command rejects a robot without its meshes, so that it does look."""
    shutil.copy(usd_in(converted("stepbot_delta")), tmp_path)
    code, text = validated(asset_validator, tmp_path)
    assert code == 1
    assert "MissingReferenceChecker" in text


def validated(asset_validator: Path, folder: Path) -> tuple[int, str]:
    """The exit status and all output of the validator's command with default settings."""
    command = [str(asset_validator.with_name("omni_asset_validate")), str(folder)]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=600)
    return run.returncode, run.stdout


def is_other_file(name: str) -> bool:
    """Whether it is a file of another format, or the folder of layers."""
    return name == "simready" or ("." in name and Path(name).suffix not in {".usda", ".usdc"})


@pytest.fixture(scope="module")
def isaac_sim(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, str]:
    """An environment in which USD has the names of Isaac Sim's schemas, for the rules about them."""
    folder = tmp_path_factory.mktemp("isaac_sim")
    package = folder / "usd" / "schema" / "isaac"
    package.mkdir(parents=True)
    (package / "robot_schema.py").write_text(ROBOT_SCHEMA, encoding="utf-8")
    kind = {"bases": ["UsdAPISchemaBase"], "schemaKind": "singleApplyAPI"}
    types = {name: {**kind, "alias": {"UsdSchemaBase": name}, "schemaIdentifier": name} for name in ISAAC_SCHEMAS}
    plugin = {"Name": "isaac", "Type": "resource", "Root": ".", "ResourcePath": ".", "LibraryPath": ""}
    content = {"Plugins": [{**plugin, "Info": {"Types": types}}]}
    (folder / "plugInfo.json").write_text(json.dumps(content), encoding="utf-8")
    classes = "\n".join(f'class "{name}"\n{{\n}}\n' for name in ISAAC_SCHEMAS)
    (folder / "generatedSchema.usda").write_text(f"#usda 1.0\n\n{classes}", encoding="utf-8")
    return {**os.environ, "PYTHONPATH": str(folder), "PXR_PLUGINPATH_NAME": str(folder)}


def simready_says(python: Path, file: Path, env: Mapping[str, str], *options: str) -> tuple[bool, dict[str, str]]:
    """Whether a file passes the profile by SimReady's command, and what is said of each feature that it lacks."""
    command = [str(python.with_name("simready-validate")), "--profile", PROFILE, *options, str(file)]
    run = subprocess.run(command, env=dict(env), capture_output=True, text=True, check=False, timeout=300)
    verdict = re.search(rf"\[(PASSED|FAILED)\] {PROFILE} v", run.stdout)
    assert verdict, run.stdout + run.stderr
    lacking = dict(re.findall(r"^ +(FET_\w+): (.*)$", run.stdout, re.MULTILINE))
    assert (run.returncode == 0) is (verdict[1] == "PASSED")
    return verdict[1] == "PASSED", lacking


@pytest.mark.parametrize("robot", ROBOTS)
def test_simready_robots_of_isaac_sim(
    robot: str, converted: Converted, simready: Path, isaac_sim: Mapping[str, str]
) -> None:
    """The files pass the profile of robots as they are, and have its features of Isaac Sim but for the packaging."""
    passed, lacking = simready_says(simready, usd_in(converted(robot)), isaac_sim, "--version", "2.0.0")
    assert (passed, set(lacking)) == (True, PACKAGING)


@pytest.mark.parametrize("robot", ROBOTS)
def test_simready_assets_in_layers(
    robot: str, converted: Converted, simready: Path, isaac_sim: Mapping[str, str]
) -> None:
    """`--for simready` lacks what a publisher adds, drives of passive joints, and files for other programs."""
    name = name_of(robot)
    main = converted(robot) / "simready" / name / "usd" / f"{name}.usda"
    _, lacking = simready_says(simready, main, isaac_sim)
    rules = {rule for text in lacking.values() for rule in re.findall(r"simready\.([A-Z.]+\d+)", text)}
    assert rules - {"NEWTON.DJ.001", "MUJOCO.DJ.002"} == {
        *("RC.004", "SR.001", "SR.002", "SR.004"),
        *("ROS.001", "VM.MDL.003", "VM.PBR.001"),
    }
    assert {"NEWTON.DJ.001", "MUJOCO.DJ.002"}.isdisjoint(rules) is (robot == "universal_robots_ur5e")


@pytest.mark.parametrize("robot", ["universal_robots_ur5e", "franka_hand"])
def test_newton_reads_one_robot_from_each_variant(
    robot: str, converted: Converted, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Its readers of Newton's, PhysX's and MuJoCo's schemas get the same numbers, in their units."""
    python, name = python_with(NEWTON, tmp_path_factory.getbasetemp() / "newton"), name_of(robot)
    main = converted(robot) / "simready" / name / "usd" / f"{name}.usda"
    command = [str(python), "-c", READ_BY_NEWTON, str(main)]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    assert any(found["Newton"]["armature"]) or found["Newton"]["mimics"]
    assert set(found["MuJoCo"].pop("velocity_limit")) == {1e6}  # MuJoCo has none
    for variant, quantities in found.items():
        for quantity, values in quantities.items():
            assert np.allclose(values, found["Newton"][quantity], rtol=1e-6), (variant, quantity)


@pytest.mark.parametrize("robot", ROBOTS)
def test_simready_robots_that_are_published(
    robot: str, converted: Converted, simready: Path, isaac_sim: Mapping[str, str], tmp_path: Path
) -> None:
    """They pass its newest version with what a publisher adds: a thumbnail, a date, and an entry in Wikidata."""
    folder = tmp_path / name_of(robot)
    shutil.copytree(converted(robot), folder)
    file = usd_in(folder)
    passed, lacking = simready_says(simready, file, isaac_sim)
    assert (passed, {name for name, text in lacking.items() if text.startswith("failing")}) == (
        False,
        {"FET_033_STANDARD"},
    )
    names = ("author", "asset_name", "asset_type", "asset_license", "category", "source_file", "usd_date_generated")
    stated = {**dict.fromkeys(names, "stated"), "qcode": "Q11012", "rigid_body_count": 7, "mass": 1.0}
    file.with_suffix(".json").write_text(json.dumps({**stated, "asset_extents": [1.0, 1.0, 1.0]}), encoding="utf-8")
    thumbnail = folder / ".thumbs" / "256x256" / f"{file.name}.png"
    thumbnail.parent.mkdir(parents=True)
    thumbnail.write_bytes(b"\x89PNG\r\n")
    passed, lacking = simready_says(simready, file, isaac_sim)
    assert passed
    assert set(lacking) - PASSIVE == PACKAGING | OTHER_PROGRAMS
    assert PASSIVE.isdisjoint(lacking) is (robot == "universal_robots_ur5e")


@pytest.mark.parametrize(
    ("old", "new", "feature", "rule"),
    [
        ("IsaacRobotAPI", "OtherAPI", "FET_021_ISAAC", "RC.007"),
        ("IsaacJointAPI", "OtherAPI", "FET_022_ISAAC", "DJ.008"),
        ("IsaacLinkAPI", "OtherAPI", "FET_022_ISAAC", "DJ.009"),
        ("prepend rel isaac:physics", "rel isaac:physics", "FET_022_ISAAC", "DJ.010"),
        ('"Manipulator"', '"Default"', "FET_021_ISAAC", "RC.008"),
        ("/delta/joints/world_joint>, <", "", "FET_021_ISAAC", "RC.009"),
    ],
)
def test_simready_notices_faults(
    old: str, new: str, feature: str, rule: str, converted: Converted, simready: Path, isaac_sim: Mapping[str, str],
    tmp_path: Path,
) -> None:  # fmt: skip
    """The rules about Isaac Sim's schemas reject files without them, so that they do look."""
    folder = tmp_path / "delta"
    shutil.copytree(converted("stepbot_delta"), folder)
    file = usd_in(folder)
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    _, lacking = simready_says(simready, file, isaac_sim, "--version", "2.0.0")
    assert rule in lacking.get(feature, ""), lacking


def look(file: Path) -> Observation:
    """The content of a file, by stepbot's reader."""
    reason = engine_of("usd").available()
    if reason is not None:
        pytest.skip(reason)
    request = Request(str(file), "usd", configurations=({},), simulate=0.0)
    observation: Observation = call_isolated("stepbot.engines.usd.observer:observe", request)
    return observation


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(("converter", "suffix"), [("mujoco_usd_converter", ".xml"), ("urdf_usd_converter", ".urdf")])
def test_other_converters_get_the_same_robot(
    converter: str, suffix: str, robot: str, converted: Converted, converters: Path, tmp_path: Path
) -> None:
    """The OpenUSD that others make of our MJCF and URDF has the same links, joints, limits, masses and inertias."""
    ours = look(usd_in(converted(robot)))
    (source,) = (file for file in converted(robot).glob(f"*{suffix}") if not file.name.endswith(".scene.xml"))
    command = [str(converters.with_name(converter)), str(source), str(tmp_path / "out")]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0, run.stderr
    theirs = look(usd_in(tmp_path / "out"))
    links = {link.name: link for link in theirs.links}
    heavy = [link for link in ours.links if link.mass is not None and link.mass > 1e-5]
    assert len(heavy) >= 7
    for link in heavy:
        other = links[link.name]
        assert other.mass == pytest.approx(link.mass, rel=1e-7)
        if other.com is not None:  # urdf-usd-converter writes none at the origin
            assert other.com == pytest.approx(link.com, abs=1e-8)
        np.testing.assert_allclose(other.inertia, link.inertia, rtol=0, atol=1e-6 * np.max(link.inertia))
    joints = {joint.child: joint for joint in theirs.joints}
    for joint in (joint for joint in ours.joints if joint.kind in ("revolute", "prismatic")):
        other = joints[joint.child]
        assert (other.name, other.kind, other.parent) == (joint.name, joint.kind, joint.parent)
        assert joint.limit is not None
        assert other.limit is not None
        assert (other.limit.lower, other.limit.upper) == pytest.approx((joint.limit.lower, joint.limit.upper), rel=1e-6)
        np.testing.assert_allclose(other.axis, joint.axis, atol=1e-6)
