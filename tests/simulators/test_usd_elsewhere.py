"""OpenUSD files of library robots in NVIDIA's validators, and beside those of converters that others wrote."""

import json
import shutil
import subprocess
import venv
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepbot.engines import engine_of
from stepbot.engines.observation import Observation, Request
from stepbot.runtime.worker import call_isolated
from stepbot_cli import main
from tests.library.conftest import every_robot, name_of, sidecar_of

pytestmark = pytest.mark.long

ROBOTS = ("universal_robots_ur5e", "stepbot_delta")
"""A tree, and a mechanism with loops."""
ASSET_VALIDATOR = ("omniverse-asset-validator[usd]>=1.18,<2",)
SIMREADY_VALIDATOR = ("simready-validate>=2026.8", "simready-foundation-tier-core>=2026.8")
CONVERTERS = ("mujoco-usd-converter>=0.8,<0.9", "urdf-usd-converter>=0.3.4,<0.4")
"""They come with a USD library of their own, so that they need an environment of their own."""
PROFILE = ("Robot-Body", "2.1.0")

SIMREADY = """
import json, sys
import simready.validate as validate
validate.initialize(rules_and_requirements_paths=[], features_paths=[], profiles_paths=[])
asked = validate.AssetValidationConfig(asset_path=sys.argv[1], profile_id=sys.argv[2], profile_version=sys.argv[3])
result = validate.validate_asset(asked)
print(json.dumps({name: one["passed"] for name, one in result.features_summary.items()}))
"""
PHYSICAL = {
    "FET_001_STANDARD", "FET_003_STANDARD", "FET_003_PHYSX", "FET_003_NEWTON", "FET_004_STANDARD", "FET_004_PHYSX",
    "FET_004_NEWTON", "FET_004_ROBOT_NEWTON", "FET_022_STANDARD", "FET_022_PHYSX", "FET_022_ISAAC", "FET_023_ISAAC",
    "FET_024_STANDARD", "FET_024_PHYSX", "FET_024_NEWTON",
}  # fmt: skip
"""Features of the profile about the scene, rigid bodies, colliders, driven joints and the articulation. The others are
about folders, thumbnails, metadata and layers of an asset library, variants for each runtime, and MuJoCo's schemas."""


Converted = Callable[[str], Path]


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> Converted:
    """Returns the folder of a library robot with its URDF, MJCF and OpenUSD; each is converted on first use."""

    @cache
    def convert(robot: str) -> Path:
        folder = tmp_path_factory.mktemp("converted") / name_of(robot)
        command = ["convert", str(sidecar_of(robot)), "-o", str(folder), "--no-verify", "-f", "urdf,mjcf,usd"]
        assert main(command) == 0
        return folder

    return convert


def python_with(packages: Sequence[str], folder: Path) -> Path:
    """The interpreter of a new environment with some packages; the test is skipped if they cannot be installed."""
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    if run.returncode:
        pytest.skip(f"cannot be installed here: {', '.join(packages)}: {run.stderr.strip().splitlines()[-1:]}")
    return python


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


def said(python: Path, program: str, *arguments: str) -> Any:
    """What a program prints last, as JSON."""
    command = [str(python), "-c", program, *arguments]
    run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    return json.loads(run.stdout.splitlines()[-1])


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
    """Whether it is a file of another format."""
    return "." in name and Path(name).suffix not in {".usda", ".usdc"}


@pytest.mark.parametrize("robot", ROBOTS)
def test_physics_of_simready_robots(robot: str, converted: Converted, simready: Path) -> None:
    """Every physical feature of SimReady's profile of robots passes; Newton's wants a drive in passive joints, too."""
    passed = said(simready, SIMREADY, str(usd_in(converted(robot))), *PROFILE)
    assert set(passed) >= PHYSICAL
    assert [name for name in sorted(PHYSICAL) if not passed[name]] == []
    assert passed["FET_022_NEWTON"] is (robot == "universal_robots_ur5e")  # the elbows of the delta robot are passive


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
