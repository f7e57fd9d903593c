"""The arm with closed forms: engines report them for its files, and the unit of its STEP changes nothing."""

import json
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from robot_library.moments import Array
from robot_library.step_file import LengthUnit, write_document
from tests.command_line import Conversion, convert, snapshot
from tests.library.conftest import LIBRARY, Converted, sidecar_of
from tests.processes import call_isolated
from tests.rigid import deviations, numbers, sdf_pose, urdf_links

FOLDER = "stepbot_arm2"
POSES = ("links_at_zero", "links_as_drawn")
LINKS = {"base", "upper_arm", "forearm", "left_finger", "right_finger"}


@cache
def expected() -> dict[str, Any]:
    """Closed forms, without CAD."""
    content: dict[str, Any] = json.loads((LIBRARY / FOLDER / "expected.json").read_text(encoding="utf-8"))
    return content


@pytest.fixture
def arm(converted: Converted) -> Conversion:
    """The arm in all formats."""
    return converted(FOLDER)


def _configurations() -> list[dict[str, float]]:
    drawn: dict[str, float] = expected()["drawn"]
    return [dict.fromkeys(drawn, 0.0), drawn]


def _assert_closed_forms(found: Mapping[str, Any], pose: str) -> None:
    for name, link in expected()[pose].items():
        assert max(deviations(found[name], link)) < 1e-3, (pose, name)


# Engines against closed forms


@pytest.mark.mujoco
@pytest.mark.parametrize("suffix", [".xml", ".urdf"])
def test_mujoco_sees_the_closed_forms(arm: Conversion, suffix: str) -> None:
    """MuJoCo reports mass, com and inertia of every link, in the world, at q = 0 and as drawn, to 1e-3."""
    seen = call_isolated("tests.engines:mujoco_bodies", str(arm.file(suffix)), _configurations())
    for pose, bodies in zip(POSES, seen, strict=True):
        assert set(bodies) - {"tool0"} == LINKS
        _assert_closed_forms(bodies, pose)


@pytest.mark.pybullet
def test_pybullet_sees_the_closed_forms(arm: Conversion) -> None:
    """PyBullet reports the same from the URDF, including the base, without complaints."""
    pytest.importorskip("pybullet")
    seen = call_isolated("tests.conformance.pybullet_numbers:read", str(arm.file(".urdf")), _configurations())
    assert seen["complaints"] == []
    for pose, X_BL in zip(POSES, seen["poses"], strict=True):
        bodies = {name: _in_world(numbers, np.array(X_BL[name])) for name, numbers in seen["links"].items()}
        _assert_closed_forms(bodies, pose)


def _in_world(body_L: tuple[float, list[float], list[list[float]]], X_WL: Array) -> tuple[float, Array, Array]:
    """A body given in its link's frame, in the world."""
    mass, com, inertia = body_L
    R = X_WL[:3, :3]
    return mass, R @ com + X_WL[:3, 3], R @ np.array(inertia) @ R.T


def test_the_text_of_the_sdformat_has_the_closed_forms(arm: Conversion) -> None:
    """The SDFormat text, from which PyBullet reads no inertia, has the closed forms at q = 0."""
    model = etree.parse(arm.file(".sdf")).getroot().find("model")
    bodies = {}
    for link in model.iter("link"):
        inertial = link.find("inertial")
        X_LI = sdf_pose(inertial)
        np.testing.assert_array_equal(X_LI[:3, :3], np.eye(3))
        inertia = _symmetric({entry.tag: float(entry.text) for entry in inertial.find("inertia")})
        body = (float(inertial.findtext("mass")), X_LI[:3, 3].tolist(), inertia.tolist())
        bodies[link.get("name")] = _in_world(body, sdf_pose(link))
    assert set(bodies) == LINKS
    _assert_closed_forms(bodies, "links_at_zero")


def _symmetric(entries: Mapping[str, float]) -> Array:
    names = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
    return np.array([[entries.get(name, 0.0) for name in row] for row in names])


def test_joint_frames_are_the_closed_forms(arm: Conversion) -> None:
    """Positions of shoulder and elbow to 1e-9 m, all axes to 1e-9, the sidecar's limits, and the tool frame."""
    root = etree.parse(arm.file(".urdf")).getroot()
    top, X_BL = urdf_links(root)
    assert top == "base"
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    for name, joint in expected()["joints"].items():
        X = X_BL[joints[name].find("child").get("link")]
        axis = X[:3, :3] @ numbers(joints[name].find("axis").get("xyz"))
        np.testing.assert_allclose(axis, joint["axis"], atol=1e-9, err_msg=name)
        if "frame" in joint:
            np.testing.assert_allclose(X[:3, 3], joint["frame"]["position"], atol=1e-9, err_msg=name)
            np.testing.assert_allclose(X[:3, :3], joint["frame"]["rotation"], atol=1e-9, err_msg=name)
    tool = expected()["frames"]["tool0"]
    np.testing.assert_allclose(X_BL["tool0"][:3, 3], tool["position"], atol=1e-9)
    np.testing.assert_allclose(X_BL["tool0"][:3, :3], tool["rotation"], atol=1e-9)
    limits = {
        name: tuple(float(joint.find("limit").get(word)) for word in ("lower", "upper", "effort", "velocity"))
        for name, joint in joints.items()
        if joint.get("type") != "fixed"
    }
    degree = np.pi / 180
    assert limits["shoulder"] == pytest.approx((-170 * degree, 170 * degree, 6, 90 * degree), rel=1e-12)
    assert limits["elbow"] == pytest.approx((-25 * degree, 115 * degree, 4, 120 * degree), rel=1e-12)
    assert limits["finger"] == limits["finger_mirror"] == pytest.approx((0, 0.02, 20, 0.1), rel=1e-12)
    mimic = joints["finger_mirror"].find("mimic")
    assert (mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))) == ("finger", 1, 0)


# Engines against the model


@pytest.mark.mujoco
@pytest.mark.parametrize("suffix", [".xml", ".urdf"])
def test_the_models_numbers_come_back_from_mujoco(arm: Conversion, suffix: str) -> None:
    """MuJoCo reports mass, com and inertia of every link as in report.json, to 1e-9."""
    seen = call_isolated("tests.engines:mujoco_links", str(arm.file(suffix)))
    for link in arm.report["robot"]["links"]:
        assert max(deviations(seen[link["name"]], link)) < 1e-9, link["name"]


@pytest.mark.pybullet
def test_the_models_numbers_come_back_from_pybullet(arm: Conversion) -> None:
    """From URDF PyBullet reports mass and com to 1e-9 and inertia to 1e-6; from SDFormat mass and com only."""
    pytest.importorskip("pybullet")
    for function, suffix in (("read", ".urdf"), ("read_tree", ".sdf")):
        seen = call_isolated(f"tests.conformance.pybullet_numbers:{function}", str(arm.file(suffix)), [{}])
        assert seen["complaints"] == []
        for link in arm.report["robot"]["links"]:
            mass, com, inertia, moments = deviations(seen["links"][link["name"]], link)
            assert max(mass, com) < 1e-9, (suffix, link["name"])
            if suffix == ".urdf":
                assert max(inertia, moments) < 1e-6, link["name"]


# One arm, in three units


@pytest.fixture(scope="session")
def document() -> Any:
    """The kernel's document of the arm: products, names, colours and densities of its STEP."""
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application

    storage = TCollection_ExtendedString("BinXCAF")
    document = TDocStd_Document(storage)
    XCAFApp_Application.GetApplication_s().NewDocument(storage, document)
    reader = STEPCAFControl_Reader()
    for switch in (reader.SetNameMode, reader.SetColorMode, reader.SetMatMode):
        switch(True)
    reader.ReadFile(str(LIBRARY / FOLDER / "arm2.step"))
    assert reader.Transfer(document)
    return document


@pytest.mark.slow
@pytest.mark.parametrize(
    ("unit", "declared"), [("m", "LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.)"), ("inch", "'INCH'")]
)
def test_the_same_step_in_another_unit_is_the_same_robot(
    arm: Conversion, document: Any, unit: LengthUnit, declared: str, tmp_path: Path
) -> None:
    """STEP files in metres and inches convert to the files of millimetres: equal text, numbers within 1e-9."""
    step = tmp_path / "arm2.step"
    write_document(step, document, unit=unit)
    assert declared in step.read_text(encoding="utf-8")
    assert declared not in (LIBRARY / FOLDER / "arm2.step").read_text(encoding="utf-8")
    other = convert(sidecar_of(FOLDER), tmp_path / "out", "--step", step, "--no-verify")
    assert set(snapshot(other.folder)) == set(snapshot(arm.folder))
    for suffix in (".urdf", ".sdf", ".xml"):
        _assert_same_text(other.file(suffix), arm.file(suffix))
    for mesh in sorted(arm.folder.glob("meshes/*.obj")):
        _assert_same_shape(other.folder / "meshes" / mesh.name, mesh)
    for part in ("mass", "com", "inertia", "links", "joints", "frames", "actuators"):
        numbers_of = [_flat(conversion.report["robot"][part]) for conversion in (other, arm)]
        assert numbers_of[0], part
        np.testing.assert_allclose(*numbers_of, atol=1e-12, rtol=1e-9, err_msg=part)


_NO_PRODUCT = re.compile(r"\n *<(ixy|ixz|iyz)>-?[\d.]+e-[12]\d</\1>")
"""Products of inertia that are not 0 only because of rounding."""
_NUMBER = re.compile(r"(?<![\w.#])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def _assert_same_text(one: Path, other: Path) -> None:
    """Assert that two files differ only in the last digits of numbers."""
    texts = [_NO_PRODUCT.sub("", path.read_text(encoding="utf-8")) for path in (one, other)]
    assert _NUMBER.sub("0", texts[0]) == _NUMBER.sub("0", texts[1]), one.name
    values = [np.array(_NUMBER.findall(text), dtype=np.float64) for text in texts]
    assert len(values[0]) > 100
    np.testing.assert_allclose(*values, atol=1e-12, rtol=1e-9, err_msg=one.name)


def _assert_same_shape(one: Path, other: Path) -> None:
    """Two meshes have the same vertices [m] to 1e-9 and the same number of faces; diagonals may differ."""
    from scipy.spatial import KDTree

    lines = [[line.split() for line in path.read_text(encoding="utf-8").splitlines()] for path in (one, other)]
    a, b = (np.array([line[1:] for line in mesh if line[:1] == ["v"]], dtype=np.float64) for mesh in lines)
    faces = [sum(line[:1] == ["f"] for line in mesh) for mesh in lines]
    assert a.shape == b.shape
    assert faces[0] == faces[1] > 0
    for these, those in ((a, b), (b, a)):
        assert float(np.max(KDTree(these).query(those)[0])) < 1e-9, one.name


def _flat(value: Any) -> list[float]:
    """All numbers in a part of a report, in order."""
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in _flat(value[key])]
    if isinstance(value, list):
        return [number for inner in value for number in _flat(inner)]
    return [float(value)] if isinstance(value, int | float) else []
