"""Commercial robots against their makers' data: joints, limits, masses, and poses of links."""

import json
import os
from collections.abc import Mapping
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

from robot_library.description import DescribedJoint, Description, load_description
from robot_library.moments import inverse
from tests.conftest import CORPUS
from tests.library.conftest import LIBRARY, ROBOTS, SHORT, Converted, sidecar_of
from tests.processes import call_isolated

REFERENCE = Path(os.environ.get("STEPBOT_REFERENCE", CORPUS.parent / "reference"))
WORLD = "world"
"""A massless root of this name, fixed at the origin, represents the world."""
CONFIGURATIONS, SEED = 100, 20
CLOSE = 1e-6
"""[m], [rad], and the limits' own units."""
WEIGHTLESS = 1e-7
"""Mass [kg] below which a maker's link is only a named frame: none of them has a physical inertia."""


def _expected(robot: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((LIBRARY / robot / "expected.json").read_text(encoding="utf-8"))
    return content


DESCRIBED = tuple(robot for robot in ROBOTS if "source" in _expected(robot))
every_described_robot = pytest.mark.parametrize("robot", DESCRIBED)
every_converted_described_robot = pytest.mark.parametrize(
    "robot", [pytest.param(robot, marks=() if robot in SHORT else pytest.mark.long) for robot in DESCRIBED]
)


def _description(robot: str) -> Description:
    return load_description(LIBRARY / robot / "expected.json")


@every_described_robot
def test_the_drawn_positions_are_the_sidecars_zeros(robot: str) -> None:
    """The drawn joint positions are the sidecar's `zero`."""
    content = YAML(typ="safe", pure=True).load(sidecar_of(robot).read_text(encoding="utf-8"))
    zeros = {name: _plain(joint["zero"]) for name, joint in content["joints"].items() if "zero" in joint}
    drawn = {name: value for name, value in _description(robot).drawn.items() if value}
    assert zeros == pytest.approx(drawn, abs=1e-12)


def _close(number: float) -> Any:
    return pytest.approx(number, abs=CLOSE)


def _plain(value: Any) -> float:
    """A number, with degrees and millimetres converted to SI."""
    if isinstance(value, int | float):
        return float(value)
    number, unit = value.split()
    return float(number) * {"deg": np.pi / 180, "mm": 1e-3, "rad": 1.0, "m": 1.0}[unit]


@pytest.mark.slow
@every_converted_described_robot
def test_joints_and_limits_are_the_makers(robot: str, converted: Converted) -> None:
    """Kind, links, axis, limits, velocity, effort and mimic of every URDF joint, read by yourdfpy, are the maker's."""
    seen = call_isolated("tests.library.test_reference:joints_in_yourdfpy", str(converted(robot).file(".urdf")))
    expected = _description(robot).joints
    moving = {name: joint for name, joint in expected.items() if joint.kind != "fixed"}
    added = set(_expected(robot).get("added_joints", ()))
    assert set(moving) | added == {name for name, joint in seen.items() if joint["kind"] != "fixed"}
    for name, joint in moving.items():
        found = seen[name]
        assert (found["kind"], found["parent"], found["child"]) == (joint.kind, joint.parent, joint.child), name
        assert found["axis"] == pytest.approx(joint.axis, abs=CLOSE), name
        for bound in ("lower", "upper", "velocity", "effort"):
            wanted = getattr(joint, bound)
            if np.isfinite(wanted):
                assert found[bound] == pytest.approx(wanted, abs=CLOSE), (name, bound)
        # Joints of a loop that follow its driver along a line are written as the mimics that the maker has.
        mimic = joint.mimic and (joint.mimic.joint, *map(_close, (joint.mimic.multiplier, joint.mimic.offset)))
        assert found["mimic"] == mimic, name


@every_converted_described_robot
def test_masses_are_the_makers(robot: str, converted: Converted) -> None:
    """Links have the maker's mass, centre of mass and inertia; massless ones may be frames."""
    content = converted(robot).report["robot"]
    found = {link["name"]: link for link in content["links"]}
    frames = {frame["name"] for frame in content["frames"]}
    for name, link in _expected(robot)["links"].items():
        if name in frames:
            assert link.get("mass", 0.0) < WEIGHTLESS, name
        elif link and "mass" in link:
            i = link["inertia"]
            rows = [[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]]
            assert found[name]["mass"] == pytest.approx(link["mass"], rel=1e-9), name
            np.testing.assert_allclose(found[name]["com"], link["com"], atol=1e-9, err_msg=name)
            np.testing.assert_allclose(found[name]["inertia"], rows, atol=1e-9 * np.max(rows), err_msg=name)


@every_converted_described_robot
def test_closed_loops_hold_what_the_maker_lets_mimic(robot: str, converted: Converted) -> None:
    """Where loops replace the maker's mimics, the loops are closed at all positions that the mimics give."""
    description = _description(robot)
    closures = converted(robot).report["robot"]["closures"]
    assert bool(closures) == ("by_loop" in _expected(robot))
    for q in description.random_positions(CONFIGURATIONS, SEED):
        poses = description.poses(q)
        for closure in closures:
            a, b = (poses[closure[f"link_{side}"]] @ _given(closure[f"pose_{side}"]) for side in "ab")
            np.testing.assert_allclose(a[:3, 3], b[:3, 3], atol=CLOSE, err_msg=f"{closure['name']} at {q}")


def _given(stated: Mapping[str, Any]) -> Any:
    return DescribedJoint("", "fixed", "", "", tuple(stated["xyz"]), tuple(stated["rpy"])).X_PC


@pytest.mark.slow
@every_converted_described_robot
@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
def test_every_link_is_where_the_maker_has_it(robot: str, suffix: str, converted: Converted) -> None:
    """Every link and frame has the maker's pose at q = 0 and 100 random positions, to 1e-6 m and rad."""
    description = _description(robot)
    positions = [description.positions({}), *description.random_positions(CONFIGURATIONS, SEED)]
    engine = {".urdf": "poses_in_yourdfpy", ".xml": "poses_in_mujoco"}[suffix]
    seen = call_isolated(f"tests.library.test_reference:{engine}", str(converted(robot).file(suffix)), positions)
    links = [link for link in description.poses({}) if link != WORLD]
    root = links[0]
    for q, poses in zip(positions, seen, strict=True):
        expected = description.poses(q)
        for link in links:
            X = inverse(expected[root]) @ expected[link]
            found = inverse(np.array(poses[root])) @ np.array(poses[link])
            np.testing.assert_allclose(found[:3, 3], X[:3, 3], atol=CLOSE, err_msg=f"{link} at {q}")
            np.testing.assert_allclose(found[:3, :3], X[:3, :3], atol=CLOSE, err_msg=f"{link} at {q}")


def joints_in_yourdfpy(file: str) -> dict[str, dict[str, Any]]:
    """Joints of a URDF by name."""
    import yourdfpy

    robot = yourdfpy.URDF.load(file, build_scene_graph=False, load_meshes=False)
    found = {}
    for name, joint in robot.joint_map.items():
        limit, mimic = joint.limit, joint.mimic
        found[name] = {
            "kind": joint.type,
            "parent": joint.parent,
            "child": joint.child,
            "axis": [0.0, 0.0, 0.0] if joint.axis is None else [float(value) for value in joint.axis],
            "mimic": None if mimic is None else (mimic.joint, mimic.multiplier or 0.0, mimic.offset or 0.0),
            "lower": -inf if limit is None or limit.lower is None else float(limit.lower),
            "upper": inf if limit is None or limit.upper is None else float(limit.upper),
            "velocity": inf if limit is None or limit.velocity is None else float(limit.velocity),
            "effort": inf if limit is None or limit.effort is None else float(limit.effort),
        }
    return found


def poses_in_yourdfpy(file: str, positions: list[dict[str, float]]) -> list[dict[str, Any]]:
    """X_WL of every link of a URDF, shape (4, 4), at each of the positions; yourdfpy computes mimics."""
    import yourdfpy

    robot = yourdfpy.URDF.load(file, load_meshes=False)
    found = []
    for q in positions:
        robot.update_cfg({name: q.get(name, 0.0) for name in robot.actuated_joint_names})
        found.append({link: robot.get_transform(link, robot.base_link).tolist() for link in robot.link_map})
    return found


def poses_in_mujoco(file: str, positions: list[dict[str, float]]) -> list[dict[str, Any]]:
    """X_WB of every body and site of an MJCF file, shape (4, 4), at each of the positions."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    found = []
    for q in positions:
        for name, value in q.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        poses = {}
        for i in range(1, model.nbody):
            poses[model.body(i).name] = _pose(data.xpos[i], data.xmat[i])
        for i in range(model.nsite):
            poses[model.site(i).name] = _pose(data.site_xpos[i], data.site_xmat[i])
        found.append(poses)
    return found


def _pose(position: Any, rotation: Any) -> list[list[float]]:
    return [[*row, float(p)] for row, p in zip(rotation.reshape(3, 3).tolist(), position, strict=True)] + [[0, 0, 0, 1]]


# The makers' descriptions, where they are available


def _described_in(source: Mapping[str, str]) -> Mapping[str, Any]:
    """The description that an expected.json was taken from; the test is skipped if it is missing."""
    if not REFERENCE.is_dir():
        pytest.skip("the makers' descriptions are absent (set STEPBOT_REFERENCE)")
    for file in sorted(REFERENCE.glob("*.yaml")):
        for part in YAML(typ="safe", pure=True).load(file.read_text(encoding="utf-8")).values():
            if isinstance(part, dict) and "fk" in part and part["source"].get("path") == source["path"]:
                stated: Mapping[str, Any] = part
                return stated
    raise AssertionError(f"no description from {source['repo']}, {source['path']}")


@pytest.mark.slow
@every_described_robot
def test_expected_json_is_the_makers_description(robot: str) -> None:
    """expected.json has the joints and poses of the maker's description."""
    content, description = _expected(robot), _description(robot)
    stated = _described_in(content["source"])
    assert stated["source"]["commit"] == content["source"]["commit"]
    assert {joint["name"] for joint in stated["joints"]} == set(description.joints)
    for joint in stated["joints"]:
        ours = description.joints[joint["name"]]
        assert (ours.kind, ours.parent, ours.child) == (joint["type"], joint["parent"], joint["child"])
        if ours.kind != "fixed":
            assert ours.axis == pytest.approx(joint["axis"], abs=1e-12)
        for bound in ("velocity", "effort") if ours.kind in ("continuous", "fixed") else LIMITS:
            if joint.get(bound) is not None:
                published = content["joints"][ours.name].get("published", {}).get(bound, getattr(ours, bound))
                assert published == pytest.approx(joint[bound], abs=1e-12), (ours.name, bound)
    for link in stated["links"]:
        ours_of_link = content["links"][link["name"]]
        mass = {**ours_of_link, **ours_of_link.get("published", {})}.get("mass")
        assert mass == (None if link.get("mass") is None else pytest.approx(link["mass"], rel=1e-12))
        inertia = content["links"][link["name"]]
        inertia = {**inertia, **inertia.get("published", {})}.get("inertia")
        if link.get("mass") is not None and not any(link.get("com_rpy") or ()):
            assert inertia == pytest.approx({key: float(value) for key, value in link["inertia"].items()}, abs=1e-12)
    for case in ("zero", "test"):
        poses = description.poses(stated["fk"][case]["q"])
        for link, pose in stated["fk"][case]["poses"].items():
            np.testing.assert_allclose(poses[link][:3, 3], pose["xyz"], atol=2e-9, err_msg=link)
            np.testing.assert_allclose(poses[link][:3, :3], _rotation(pose["quat_wxyz"]), atol=1e-8, err_msg=link)


LIMITS = ("lower", "upper", "velocity", "effort")


def _rotation(quaternion: list[float]) -> Any:
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )
