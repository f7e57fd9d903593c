"""`zero` of every kind of joint, against products of exponentials and MuJoCo."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import JointKind, MeshRef, Robot
from stepbot.runtime.output import write_atomically
from stepbot.sidecar.check import check_sidecar
from stepbot.sidecar.load import load_sidecar
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import HEAD, Workshop, at, built

PITCH = 0.003
"""[m/rad]."""
ZEROS = {"revolute": 0.7, "continuous": -1.1, "prismatic": 0.02, "screw": 2.3}
"""[rad] or [m]."""
LINKS = ("base", "one", "two", "three", "four", "five")
ORIGINS = tuple(
    Pose.from_xyz_rpy((0.03 * i - 0.05, 0.02 * i * i, 0.1 * i), (0.4 * i, -0.3 - 0.2 * i, 0.9 * i)) for i in range(5)
)
"""Slanted frames of the five joints in the assembly, as drawn."""
AXIS = np.array((1.0, 2.0, 2.0)) / 3.0
"""Axis of every joint, in its own frame."""


def _shop() -> Workshop:
    shop = Workshop()
    for i, name in enumerate(LINKS):
        shop.box(name, (10, 20, 30), at(20 * i, -15 * i, 100 * i, (0.3 * i, 0.2, -0.1 * i)))
    return shop


def _settings(kind: str) -> str:
    limits = ", limits: {lower: -9, upper: 9}" if kind in ("revolute", "prismatic") else ""
    return f"zero: {ZEROS[kind]}{limits}" + (f", pitch: {PITCH}" if kind == "screw" else "")


def _text(kinds: tuple[str, ...]) -> str:
    lines = ["defaults: {density: 1000}", "links:", "  base: {rest: true}"]
    lines += [f"  {name}: {{parts: [{name}]}}" for name in LINKS[1:]]
    lines.append("joints:")
    for i, (kind, (parent, child)) in enumerate(zip(kinds, pairwise(LINKS), strict=True)):
        origin = f"{{xyz: {list(ORIGINS[i].position)}, rpy: {list(ORIGINS[i].rpy)}}}"
        lines.append(f"  j{i}:")
        lines.append(f"    {{type: {kind}, parent: {parent}, child: {child}, origin: {origin}, axis: [1, 2, 2],")
        lines.append(f"     {_settings(kind)}}}")
    return "\n".join(lines) + "\n"


def _exponential(kind: str, X_WJ: Pose, moved: float) -> Array:
    """Motion (4, 4), in the world, of a joint by ``moved`` from its drawn position."""
    a = X_WJ.R @ AXIS
    turn, slide = {"prismatic": (0.0, 1.0), "screw": (1.0, PITCH)}.get(kind, (1.0, 0.0))
    twist = np.zeros((4, 4))
    twist[:3, :3] = turn * np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    twist[:3, 3] = -twist[:3, :3] @ X_WJ.p + slide * a
    return np.asarray(expm(twist * moved))


def _corners(shop: Workshop, index: int) -> Array:
    component = shop.components[index]
    return component.X_WC.apply(shop.bodies[component.body].mesh.vertices)


def _expected(shop: Workshop, kinds: tuple[str, ...], q: dict[str, float]) -> list[Array]:
    """Corners of every link's box in the world, from the drawing and the sidecar's numbers only."""
    X, found = np.eye(4), [_corners(shop, 1)]
    for i, kind in enumerate(kinds):
        X = X @ _exponential(kind, ORIGINS[i], q[f"j{i}"] - ZEROS[kind])
        found.append(_corners(shop, i + 2) @ X[:3, :3].T + X[:3, 3])
    return found


def _built_corners(robot: Robot, q: dict[str, float]) -> list[Array]:
    poses = link_poses(robot, q)
    found = []
    for link in robot.links:
        (visual,) = link.visuals
        assert isinstance(visual.geometry, MeshRef)
        mesh = robot.mesh_by_name[visual.geometry.name].mesh
        found.append((poses[link.name] @ visual.X_LG).apply(mesh.vertices))
    return found


def _same(a: list[Array], b: list[Array]) -> None:
    """Assert that two sets of corners are equal, in any order."""
    for x, y in zip(a, b, strict=True):
        distances = np.linalg.norm(x[:, None, :] - y[None, :, :], axis=2)
        assert distances.min(axis=0).max() < 5e-9  # vertices are on a grid of a nanometre
        assert distances.min(axis=1).max() < 5e-9


CHAINS = [
    ("screw",) * 5,
    ("screw", "revolute", "screw", "prismatic", "continuous"),
    ("prismatic", "screw", "continuous", "revolute", "screw"),
    ("revolute", "continuous", "prismatic", "revolute", "prismatic"),
]


@pytest.mark.parametrize("kinds", CHAINS)
def test_zero_of_every_kind(kinds: tuple[str, ...], tmp_path: Path) -> None:
    """Links several joints deep are at the expected poses, as drawn, at 0, and at random positions."""
    shop = _shop()
    robot = built(shop, tmp_path, _text(kinds))
    drawn = {f"j{i}": ZEROS[kind] for i, kind in enumerate(kinds)}
    assert {joint.name: joint.drawn_position for joint in robot.joints} == drawn
    random = np.random.default_rng(5)
    anywhere = {name: float(random.uniform(-1, 1)) for name in drawn}
    for q in (drawn, dict.fromkeys(drawn, 0.0), anywhere):
        _same(_built_corners(robot, q), _expected(shop, kinds, q))


@pytest.mark.parametrize("kinds", CHAINS)
def test_zero_in_an_engine(kinds: tuple[str, ...], tmp_path: Path) -> None:
    """MuJoCo has the links of the written file at the same poses; the slide of a screw follows its angle."""
    mujoco = pytest.importorskip("mujoco")
    shop = _shop()
    robot = built(shop, tmp_path, _text(kinds))
    write_atomically(render(robot, "mjcf", Diagnostics()), tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / f"{robot.name}.xml"))
    data = mujoco.MjData(model)
    random = np.random.default_rng(7)
    q = {f"j{i}": float(random.uniform(-1, 1)) for i in range(len(kinds))}
    for i, kind in enumerate(kinds):
        body = model.body(LINKS[i + 1])
        assert int(body.jntnum[0]) == (2 if kind == "screw" else 1)
        for joint in range(int(body.jntadr[0]), int(body.jntadr[0] + body.jntnum[0])):
            slides_along = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE and kind == "screw"
            data.qpos[model.jnt_qposadr[joint]] = q[f"j{i}"] * (PITCH if slides_along else 1.0)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    expected = _expected(shop, kinds, q)
    for i, name in enumerate(LINKS[1:], start=1):
        np.testing.assert_allclose(data.body(name).xipos, expected[i].mean(axis=0), atol=1e-8)


@pytest.mark.parametrize("kind", [kind for kind in JointKind if kind.value not in ZEROS])
def test_other_kinds_refuse_zero(kind: JointKind, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """`zero` of a joint without a single position is an error at its place."""
    extra = ", axis2: x" if kind is JointKind.UNIVERSAL else ""
    text = HEAD + (
        "links: {base: {rest: true}, arm: {parts: [arm]}}\n"
        f"joints: {{j: {{type: {kind}, parent: base, child: arm, zero: 0.1{extra}}}}}\n"
    )
    path = tmp_path / "a.robot.yaml"
    path.write_text(text, encoding="utf-8")
    loaded = load_sidecar(path, diagnostics)
    assert loaded is not None
    check_sidecar(loaded, diagnostics)
    (fault,) = diagnostics
    assert fault.code == "SB137"
    assert fault.message == f"joint 'j': 'zero' is not valid for type {kind}"
