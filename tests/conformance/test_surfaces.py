"""Contact properties in every format: read back by engines and readers of descriptions, and felt in simulation."""

from pathlib import Path

import mujoco
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of
from stepbot.engines.describe import describe
from stepbot.engines.observation import Quantity, Request
from stepbot.engines.reference import observe_robot
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Base, Box, Collision, Joint, JointKind, Link, Robot, Sphere
from stepbot.robot.surfaces import PLAIN, Surface, damping_ratio, restitution_of
from stepbot.verification.compare import compare

WHOLE = Surface(friction=0.35, torsional=0.002, rolling=1e-4, restitution=0.45, softness=0.007)
SURFACES = (
    PLAIN,
    WHOLE,
    Surface(friction=0.8),
    Surface(rolling=1e-3),
    Surface(restitution=0.6),
    Surface(softness=0.01),
)
BODY = MassProperties(1.0, (0.0, 0.0, 0.0), ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01)))


def chain(surfaces: tuple[Surface, ...] = SURFACES) -> Robot:
    """A chain of spheres with a surface each."""
    links = [
        Link(f"l{i}", BODY, collisions=(Collision(f"c{i}", Sphere(0.1), Pose(), surface),))
        for i, surface in enumerate(surfaces)
    ]
    joints = [
        Joint(f"j{i}", JointKind.CONTINUOUS, f"l{i - 1}", f"l{i}", Pose.of(position=(0.5, 0.0, 0.0)))
        for i in range(1, len(surfaces))
    ]
    return Robot("chain", tuple(links), tuple(joints))


def block(surface: Surface) -> Robot:
    """A free cube of 0.2 m."""
    shape = Collision("cube", Box((0.2, 0.2, 0.2)), surface=surface)
    return Robot("block", (Link("block", BODY, collisions=(shape,)),), base=Base.FLOATING)


def write(robot: Robot, format_: str, folder: Path) -> tuple[Path, Robot]:
    """The file of a format, and the robot in it."""
    lowered = lower(robot, FORMATS[format_], Diagnostics())
    for name, content in render(robot, format_, Diagnostics()).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder / f"{robot.name}{FORMATS[format_].suffix}", lowered


@pytest.mark.parametrize(
    ("format_", "engine", "read"),
    [
        ("mjcf", "mujoco", ("friction", "torsional", "rolling", "restitution", "softness")),
        ("urdf", "pybullet", ("friction", "torsional", "rolling", "restitution")),
        ("sdf", "reader", ("friction", "restitution")),
        ("usd", "usd", ("friction", "restitution")),
    ],
)
def test_engines_read_back_what_is_stated(format_: str, engine: str, read: tuple[str, ...], tmp_path: Path) -> None:
    """Each property that a format has arrives in an engine, and another value is a failure of the comparison."""
    if engine in ("usd", "pybullet"):
        pytest.importorskip({"usd": "pxr"}.get(engine, engine))
    path, lowered = write(chain(), format_, tmp_path)
    request = Request(str(path), format_, simulate=0.0)
    seen = engine_of(engine).observer.observe(request)
    for link, given in zip(seen.links, SURFACES, strict=True):
        assert link.collisions is not None
        (shape,) = link.collisions
        assert shape.surface is not None
        stated = {name for name in read if getattr(given, name) is not None}
        for name in stated:
            assert getattr(shape.surface, name) == pytest.approx(getattr(given, name), rel=1e-6), (link.name, name)
    reference = observe_robot(lowered, request)
    (right,) = (one for one in compare(reference, seen) if one.quantity is Quantity.SHAPES)
    assert right.deviations.failures == []
    for name in read:
        wrong = replace(WHOLE, **{name: 0.5 * getattr(WHOLE, name)})
        other = observe_robot(lower(chain((PLAIN, wrong, *SURFACES[2:])), FORMATS[format_], Diagnostics()), request)
        (compared,) = (one for one in compare(other, seen) if one.quantity is Quantity.SHAPES)
        assert any(failure.where.startswith(name) for failure in compared.deviations.failures), name


@pytest.mark.parametrize("format_", ["mjcf", "urdf", "sdf"])
def test_descriptions_keep_their_surfaces(format_: str, tmp_path: Path) -> None:
    """A description that stepbot wrote gives the same contact properties when it is read again, and loses none."""
    path, lowered = write(chain(), format_, tmp_path)
    described = describe(str(path), format_)
    found = [shape.surface for shape in described.shapes if shape.collides]
    for surface, link in zip(found, lowered.links, strict=True):
        expected = link.collisions[0].surface
        for name in ("friction", "torsional", "rolling", "restitution", "softness"):
            value = getattr(expected, name)
            if value is not None:
                assert getattr(surface, name) == pytest.approx(value), (link.name, name)
    assert described.lost == ()


def test_webots_has_the_properties_in_its_world(tmp_path: Path) -> None:
    """The world has the contact properties of each material that a solid of the PROTO names."""
    path, _ = write(chain(), "webots", tmp_path)
    proto, world = path.read_text(encoding="utf-8"), path.with_suffix(".wbt").read_text(encoding="utf-8")
    assert 'contactMaterial "chain 1"' in proto
    first = world.partition('material1 "chain 1"')[2].partition("}")[0].split("\n")
    assert [line.strip() for line in first if line.strip()] == [
        "coulombFriction [ 0.35 ]",
        "bounce 0.45",
        "rollingFriction 0.0001 0.0001 0.002",
    ]


def test_shapes_of_one_link_with_different_surfaces(tmp_path: Path) -> None:
    """URDF has one surface for a link: that of the shape with most friction, and a warning names the link."""
    robot = chain((PLAIN,))
    shapes = [Collision(f"c{i}", Sphere(0.1), surface=Surface(friction=mu)) for i, mu in enumerate((0.2, 0.9))]
    robot = replace(robot, links=(replace(robot.links[0], collisions=tuple(shapes)),))
    diagnostics = Diagnostics()
    lowered = lower(robot, FORMATS["urdf"], diagnostics)
    assert {shape.surface.friction for shape in lowered.links[0].collisions} == {0.9}
    assert [str(one.message) for one in diagnostics if one.code.startswith("SB761")] == [
        "URDF: a link has the contact properties of its shape with most friction: 'l0'"
    ]


@pytest.mark.parametrize("restitution", [0.2, 0.4, 0.6, 0.8, 0.95])
def test_ratio_of_a_restitution(restitution: float) -> None:
    """The closed form is the inverse of the ratio."""
    assert restitution_of(damping_ratio(restitution)) == pytest.approx(restitution, rel=1e-9)


@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.8])
def test_ball_bounces_in_mujoco(restitution: float, tmp_path: Path) -> None:
    """A ball that falls on a floor leaves it with the share of its speed that its restitution states."""
    robot = block(Surface(restitution=restitution))
    ball = replace(robot.links[0].collisions[0], geometry=Sphere(0.1))
    path, _ = write(replace(robot, links=(replace(robot.links[0], collisions=(ball,)),)), "mjcf", tmp_path)
    model = mujoco.MjModel.from_xml_path(str(path.with_name("block.scene.xml")))
    model.opt.timestep = 5e-4
    data = mujoco.MjData(model)
    data.qpos[2] = data.qpos[2] + 0.3
    down = up = 0.0
    for _ in range(1200):
        mujoco.mj_step(model, data)
        down, up = min(down, data.qvel[2]), max(up, data.qvel[2])
        if up > 0.0 and not data.ncon:
            break
    assert -up / down == pytest.approx(restitution, abs=0.06)


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_block_slides_as_far_as_its_friction_lets_it(friction: float, tmp_path: Path) -> None:
    """A block that slides at 1 m/s stops after v^2 / (2 mu g), in MuJoCo on any floor, in PyBullet on one of 1."""
    expected = 1.0 / (2.0 * friction * 9.81)
    path, _ = write(block(Surface(friction=friction)), "mjcf", tmp_path)
    model = mujoco.MjModel.from_xml_path(str(path.with_name("block.scene.xml")))
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    start = float(data.qpos[0])
    for _ in range(int(1.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert float(data.qpos[0]) - start == pytest.approx(expected, rel=0.05)

    path, _ = write(block(Surface(friction=friction)), "urdf", tmp_path)
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0.0, 0.0, -9.81)
        plane = pybullet.createMultiBody(0.0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
        pybullet.changeDynamics(plane, -1, lateralFriction=1.0)
        body = pybullet.loadURDF(str(path), [0.0, 0.0, 0.1])
        pybullet.changeDynamics(body, -1, linearDamping=0.0, angularDamping=0.0)
        pybullet.resetBaseVelocity(body, [1.0, 0.0, 0.0])
        for _ in range(240):
            pybullet.stepSimulation()
        (x, _, _), _ = pybullet.getBasePositionAndOrientation(body)
    finally:
        pybullet.disconnect(client)
    assert x == pytest.approx(expected, rel=0.05)
