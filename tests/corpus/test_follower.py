"""A real arm of five axes and a gripper, from its published STEP, against independent measurements."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from tests.command_line import Conversion, convert, convert_once
from tests.processes import call_isolated
from tests.rigid import deviations, numbers, urdf_links

HERE = Path(__file__).parent
SIDECAR = HERE / "low_cost_robot_follower.robot.yaml"
PLA = 1240.0
"""[kg/m^3]."""
ROOT = 'root: {link: base, frame: {axis_of: "XL-430_new:1/DC11_A01_IDLER_CAP_DUMMY", offset: {xyz: [0, 0, -2.6 mm]}}}'
AGAINST_THE_LINE = {"shoulder_lift", "elbow_flex", "wrist_flex"}
"""Joints that the sidecar reverses with `axis: -z`."""
LIMITS = {
    "shoulder_pan": (-150, 150, 1.5, 61),
    "shoulder_lift": (-60, 100, 1.5, 61),
    "elbow_flex": (-90, 60, 0.52, 103),
    "wrist_flex": (-95, 95, 0.52, 103),
    "wrist_roll": (-150, 150, 0.52, 103),
    "gripper_jaw": (-3, 100, 0.52, 103),
}
"""Lower and upper [deg], effort [N m], velocity [rpm]."""

# `make test` converts the arm in test_first_hour.py.
pytestmark = pytest.mark.long


@cache
def expected() -> dict[str, Any]:
    """Values by the kernel's own reader and integrals."""
    path = HERE / "low_cost_robot_follower.expected.json"
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


@pytest.fixture(scope="module")
def step(corpus: Path) -> Path:
    """The arm's STEP file."""
    return corpus / "low_cost_robot_follower.step"


@pytest.fixture(scope="module")
def follower(step: Path, tmp_path_factory: pytest.TempPathFactory) -> Conversion:
    """The arm in all formats, verified."""
    return convert_once(tmp_path_factory, "follower", SIDECAR, "--step", step)


def _as_drawn(path: Path, *changes: tuple[str, str]) -> Path:
    """The sidecar with the base frame of the assembly, and other changes."""
    text = SIDECAR.read_text(encoding="utf-8")
    for old, new in ((ROOT, "root: {link: base}"), *changes):
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8", newline="\n")
    return path


@pytest.fixture(scope="module")
def exact(step: Path, tmp_path_factory: pytest.TempPathFactory) -> Conversion:
    """The arm with the kernel's exact integrals throughout."""
    path = tmp_path_factory.mktemp("exact") / "exact.robot.yaml"
    sidecar = _as_drawn(path, ("base: fixed\n", "base: fixed\nmass: exact\n"))
    return convert_once(tmp_path_factory, "follower_exact", sidecar, "--step", step, "--no-verify")


def test_total_mass_is_volumes_times_densities(follower: Conversion) -> None:
    """The mass is the exact volume of printed parts times PLA's density, plus six weighed motors, to 1e-3."""
    printed = expected()["volume_mm3"]["printed"] * 1e-9 * PLA
    assert expected()["mass"] == pytest.approx(printed + 2 * 0.0572 + 4 * 0.018, rel=1e-9)
    root = etree.parse(follower.file(".urdf")).getroot()
    masses = [float(mass.get("value")) for mass in root.iter("mass")]
    assert sum(masses) == pytest.approx(expected()["mass"], rel=1e-3)
    assert follower.report["robot"]["mass"] == pytest.approx(sum(masses), rel=1e-12)


def test_total_mass_by_density_alone(step: Path, tmp_path: Path) -> None:
    """Without weighed parts the mass is the exact volume of all solids times one density, to 1e-3."""
    motors = '  "**/XL-430*": {mass: 57.2 g}         # Dynamixel XL430-W250\n'
    others = '  "**/XL,XC-330*": {mass: 18 g}        # Dynamixel XL330-M288\n'
    sidecar = _as_drawn(tmp_path / "plain.robot.yaml", (f"parts:\n{motors}{others}", ""))
    plain = convert(sidecar, tmp_path / "out", "--step", step, "--no-verify")
    volumes = [entry["occurrences"] * entry["volume_mm3"] for entry in expected()["definitions"].values()]
    assert sum(volumes) == pytest.approx(286113.895654, rel=1e-9)
    assert plain.report["robot"]["mass"] == pytest.approx(sum(volumes) * 1e-9 * PLA, rel=1e-3)


def test_exact_mass_is_exact(exact: Conversion) -> None:
    """With `mass: exact`, mass, com and inertia of every link are those of the kernel's Gauss-Kronrod rule to 1e-6."""
    assert exact.report["robot"]["mass"] == pytest.approx(expected()["mass"], rel=1e-7)
    links = {link["name"]: link for link in exact.report["robot"]["links"]}
    assert set(links) == set(expected()["links"])
    for name, body in _in_assembly(exact).items():
        assert max(deviations(body, expected()["links"][name])) < 1e-6, name


def test_links_weigh_what_their_parts_weigh(follower: Conversion) -> None:
    """Mass and principal moments of every link agree to 1e-3 in any frame; com within 1e-3 of its size."""
    for link in follower.report["robot"]["links"]:
        true = expected()["links"][link["name"]]
        assert link["mass"] == pytest.approx(true["mass"], rel=1e-3)
        moments, true_moments = (np.linalg.eigvalsh(body["inertia"]) for body in (link, true))
        np.testing.assert_allclose(moments, true_moments, rtol=1e-3, err_msg=link["name"])


def _in_assembly(conversion: Conversion) -> dict[str, tuple[float, np.ndarray, np.ndarray]]:
    """Mass, com and inertia of every link of a URDF in the frame of its base at q = 0."""
    root = etree.parse(conversion.file(".urdf")).getroot()
    _, X_BL = urdf_links(root)
    bodies = {}
    for link in conversion.report["robot"]["links"]:
        X = X_BL[link["name"]]
        R = X[:3, :3]
        inertia = R @ np.array(link["inertia"]) @ R.T
        bodies[link["name"]] = (link["mass"], R @ link["com"] + X[:3, 3], inertia)
    return bodies


def test_axes_are_those_of_the_horns(exact: Conversion) -> None:
    """Each joint turns about the widest cylinder of its motor's horn or idler, to 1e-6 m and 1e-6 rad."""
    seen = call_isolated("tests.engines:mujoco_axes", str(exact.file(".xml")))
    assert set(seen) == set(expected()["axes"])
    for name, axis in expected()["axes"].items():
        point, direction = (np.array(value) for value in seen[name])
        z = np.array(axis["direction"]) * (-1 if name in AGAINST_THE_LINE else 1)
        assert float(np.linalg.norm(np.cross(direction, z))) < 1e-6, name
        assert direction @ z > 0, name
        beside = point - np.array(axis["point_mm"]) / 1000
        assert float(np.linalg.norm(beside - (beside @ z) * z)) < 1e-6, name


def test_root_frame_moves_the_arm_and_nothing_in_it(follower: Conversion, exact: Conversion) -> None:
    """With the sidecar's root frame the pan axis is the base's z, and the relative poses of links are unchanged."""
    poses = []
    for conversion in (follower, exact):
        root = etree.parse(conversion.file(".urdf")).getroot()
        top, X_BL = urdf_links(root)
        assert top == "base"
        poses.append(X_BL)
    pan = poses[0]["shoulder"]
    np.testing.assert_allclose(pan[:2, 3], 0, atol=1e-9)
    np.testing.assert_allclose(pan[:3, 2], (0, 0, 1), atol=1e-9)
    for name in set(poses[0]) - {"base"}:
        beside = [np.linalg.inv(X_BL["shoulder"]) @ X_BL[name] for X_BL in poses]
        np.testing.assert_allclose(*beside, atol=1e-9, err_msg=name)


def test_limits_are_those_of_the_sidecar(follower: Conversion) -> None:
    """Degrees and revolutions per minute are converted to SI; defaults reach the joints that they match."""
    root = etree.parse(follower.file(".urdf")).getroot()
    joints = {joint.get("name"): joint for joint in root.findall("joint") if joint.get("type") == "revolute"}
    assert set(joints) == set(LIMITS)
    for name, (lower, upper, effort, speed) in LIMITS.items():
        limit = joints[name].find("limit")
        found = [float(limit.get(word)) for word in ("lower", "upper", "effort", "velocity")]
        true = (np.radians(lower), np.radians(upper), effort, speed * 2 * np.pi / 60)
        assert found == pytest.approx(true, rel=1e-12), name
        assert numbers(joints[name].find("axis").get("xyz")) == [0, 0, -1 if name in AGAINST_THE_LINE else 1]


@pytest.mark.mujoco
def test_mujoco_loads_it_and_holds_it(follower: Conversion) -> None:
    """MuJoCo reads the report's mass from URDF and MJCF; with the motors on, the arm stays in place for a second."""
    true = {link["name"]: link["mass"] for link in follower.report["robot"]["links"]}
    for suffix in (".urdf", ".xml"):
        seen = call_isolated("tests.engines:mujoco_links", str(follower.file(suffix)))
        masses = {name: body[0] for name, body in seen.items() if body[0]}
        assert masses == pytest.approx(true, rel=1e-9)
    held = call_isolated("tests.engines:run_in_mujoco", str(follower.file(".xml")), 1.0, False)
    assert not any(held["warnings"])
    assert held["finite"]
    assert 1e-3 < held["speed"] < 1.0


@pytest.mark.pybullet
def test_pybullet_loads_it(follower: Conversion) -> None:
    """PyBullet reads the report's mass from the URDF and the tree of the SDFormat, without a complaint."""
    pytest.importorskip("pybullet")
    true = {link["name"]: link["mass"] for link in follower.report["robot"]["links"]}
    for function, suffix in (("read", ".urdf"), ("read_tree", ".sdf")):
        seen = call_isolated(f"tests.conformance.pybullet_numbers:{function}", str(follower.file(suffix)), [{}])
        assert seen["complaints"] == []
        masses = {name: body[0] for name, body in seen["links"].items() if body[0]}
        assert masses == pytest.approx(true, rel=1e-9)


def test_every_check_that_an_engine_can_make_has_passed(follower: Conversion) -> None:
    """Every file loads in every engine that reads it, and no check fails."""
    report = follower.report
    assert report["summary"]["failed"] == 0
    loaded = {
        (c["format"], c["engine"]) for c in report["checks"] if (c["quantity"], c["status"]) == ("load", "passed")
    }
    wanted = {("urdf", "mujoco"), ("urdf", "yourdfpy"), ("sdf", "reader"), ("mjcf", "mujoco")}
    if "pybullet" in report["engines"]:
        wanted |= {("urdf", "pybullet"), ("sdf", "pybullet"), ("mjcf", "pybullet")}
    assert loaded >= wanted
    assert {engine for _, engine in loaded} == set(report["engines"]) | {"reader"}


def test_nothing_of_the_step_is_lost(follower: Conversion) -> None:
    """All 161 parts are in some link: 117 solids have mass, 46 surface bodies are reported as massless."""
    assert expected()["counts"] == {"parts": 161, "solids": 117}
    (surfaces,) = (entry for entry in follower.report["diagnostics"] if entry["code"] == "SB506")
    assert "46 surface bodies" in surfaces["message"]
    sources = [source for link in follower.report["robot"]["links"] for source in link["sources"]]
    assert len([source for source in sources if source["mass"] > 0]) == 117
    components = [path for link in follower.report["robot"]["links"] for path in link["components"]]
    assert len(components) == len(set(components))
