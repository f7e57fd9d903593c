"""MJCF compiled by MuJoCo, against the written robot."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose, rotation_from_rpy
from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.kinematics import configurations, initial_configuration, link_poses
from stepbot.robot.model import Base, Collision, JointKind, Link, LoopClosure, MeshAsset, MeshRef, Robot, Sphere, Visual
from tests.conformance.conftest import Write
from tests.devices import equipped
from tests.robots import SINGLE_FREEDOMS, four_bar, one_link, pendulum

pytestmark = pytest.mark.mujoco
every_robot = pytest.mark.parametrize("name", SINGLE_FREEDOMS)


def compiled(file: Path) -> Any:
    """The compiled model; each compiler warning is an error."""
    import mujoco

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return mujoco.MjModel.from_xml_path(str(file))


def compiled_from_memory(robot: Robot) -> Any:
    """The model of a robot compiled from memory."""
    import mujoco

    files = render(robot, "mjcf", Diagnostics())
    main, *_ = files
    return mujoco.MjModel.from_xml_string(files[main].decode(), {p: c for p, c in files.items() if p != main})


def data_at(model: Any, q: dict[str, float]) -> Any:
    """Forward kinematics at a configuration."""
    import mujoco

    data = mujoco.MjData(model)
    for name, value in q.items():
        data.qpos[model.joint(name).qposadr[0]] = value
    mujoco.mj_forward(model, data)
    return data


@every_robot
def test_bodies_have_the_links_mass_com_and_inertia(name: str, write: Write) -> None:
    """Mass, centre of mass and inertia tensor of every body are the link's."""
    import mujoco

    robot, file = write(name, "mjcf")
    model = compiled(file)
    assert {model.body(i).name for i in range(1, model.nbody)} == set(robot.link_by_name)
    for link in robot.links:
        body = model.body(link.name)
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, body.iquat)
        R = R.reshape(3, 3)
        mass = link.mass_properties
        np.testing.assert_allclose(body.mass[0], mass.mass, rtol=1e-12)
        np.testing.assert_allclose(body.ipos, mass.com, atol=1e-12)
        scale = np.abs(mass.inertia).max() or 1.0
        np.testing.assert_allclose(R @ np.diag(body.inertia) @ R.T, mass.inertia, atol=1e-9 * scale)


@every_robot
def test_links_are_where_the_robot_has_them(name: str, write: Write) -> None:
    """Poses of all links agree at random configurations and at q = 0; a floating base is where it stands."""
    robot, file = write(name, "mjcf")
    model = compiled(file)
    standing = np.array([0.0, 0.0, standing_height(robot, {})])
    zero = dict.fromkeys(initial_configuration(robot), 0.0)
    for q in configurations(robot, 8):
        data = data_at(model, {**zero, **q})
        for link, X_WL in link_poses(robot, q).items():
            np.testing.assert_allclose(data.body(link).xpos, X_WL.p + standing, atol=1e-9)
            np.testing.assert_allclose(data.body(link).xmat.reshape(3, 3), X_WL.R, atol=1e-9)


@every_robot
def test_joints_have_their_limits_and_dynamics(name: str, write: Write) -> None:
    """Kind, axis, limits, passive forces and velocity limits of the compiled joints are the robot's."""
    import mujoco

    robot, file = write(name, "mjcf")
    model = compiled(file)
    moving = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED]
    assert model.njnt == len(moving) + (robot.base is Base.FLOATING)
    for joint in moving:
        read, limit = model.joint(joint.name), joint.limit
        slides = read.type[0] == mujoco.mjtJoint.mjJNT_SLIDE
        assert slides == (joint.kind is JointKind.PRISMATIC)
        np.testing.assert_allclose(read.axis, joint.axis, atol=1e-15)
        bounds = tuple(read.range) if read.limited[0] else (-np.inf, np.inf)
        assert bounds == (limit.lower, limit.upper)
        address = read.dofadr[0]
        assert model.dof_damping[address] == joint.dynamics.damping
        assert model.dof_frictionloss[address] == joint.dynamics.friction
        assert model.dof_armature[address] == joint.dynamics.armature
        assert read.stiffness[0] == joint.dynamics.stiffness
        assert model.qpos_spring[read.qposadr[0]] == joint.dynamics.spring_reference
        force = model.jnt_actfrcrange[read.id][1] if model.jnt_actfrclimited[read.id] else np.inf
        assert force == limit.effort
        if np.isfinite(limit.velocity):
            assert model.numeric(f"{joint.name}::velocity").data[0] == limit.velocity


@every_robot
def test_geometry_is_where_the_link_has_it(name: str, write: Write) -> None:
    """Vertices of every mesh geom, without MuJoCo's centring, are the asset's in the link's frame."""
    robot, file = write(name, "mjcf")
    model = compiled(file)
    data = data_at(model, {})
    for link in robot.links:
        body = data.body(link.name)
        X_WL = Pose.of(body.xmat.reshape(3, 3), body.xpos)
        for shape in (*link.visuals, *link.collisions):
            geom = model.geom(shape.name)
            X_WG = Pose.of(data.geom(shape.name).xmat.reshape(3, 3), data.geom(shape.name).xpos)
            if isinstance(shape.geometry, MeshRef):
                mesh = model.mesh(int(geom.dataid[0]))
                start, count = int(mesh.vertadr[0]), int(mesh.vertnum[0])
                read = (X_WL.inverse() @ X_WG).apply(model.mesh_vert[start : start + count])
                vertices = shape.X_LG.apply(robot.mesh_by_name[shape.geometry.name].mesh.vertices)
                np.testing.assert_allclose(read.min(axis=0), vertices.min(axis=0), atol=1e-7)
                np.testing.assert_allclose(read.max(axis=0), vertices.max(axis=0), atol=1e-7)
            else:
                X = X_WL.inverse() @ X_WG
                rows = 3 if isinstance(shape.geometry, Sphere) else 0  # a sphere has no orientation
                np.testing.assert_allclose(X.p, shape.X_LG.p, atol=1e-12)
                np.testing.assert_allclose(X.R[rows:], shape.X_LG.R[rows:], atol=1e-12)


@every_robot
def test_what_is_seen_touches_nothing(name: str, write: Write) -> None:
    """Visuals have their colour and no contacts; collisions have contacts."""
    robot, file = write(name, "mjcf")
    model = compiled(file)
    for link in robot.links:
        for visual in link.visuals:
            geom = model.geom(visual.name)
            assert (geom.contype[0], geom.conaffinity[0], geom.group[0]) == (0, 0, 2)
            np.testing.assert_allclose(geom.rgba, visual.rgba, rtol=1e-6)
        for collision in link.collisions:
            geom = model.geom(collision.name)
            assert (geom.contype[0], geom.conaffinity[0], geom.group[0]) == (1, 1, 3)


@every_robot
def test_second_of_simulation_is_finite_and_without_contact(name: str, write: Write) -> None:
    """From the drawn pose the robot runs for a second without a warning or a contact between neighbours."""
    import mujoco

    _, file = write(name, "mjcf")
    model = compiled(file)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    while data.time < 1.0:
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert [int(warning.number) for warning in data.warning] == [0] * len(data.warning)


@pytest.mark.parametrize("name", ["four_bar", "four_bar_with_zeros"])
def test_loop_closes_at_home_and_has_one_freedom(name: str, write: Write) -> None:
    """At the drawn pose the sites of the closure coincide; the equality rows leave one of three degrees of freedom."""
    import mujoco

    robot, file = write(name, "mjcf")
    model = compiled(file)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert rows.sum() == 6
    np.testing.assert_allclose(data.efc_pos[rows], 0.0, atol=1e-12)
    jacobian = data.efc_J.reshape(-1, model.nv)[rows]
    assert np.linalg.matrix_rank(jacobian, tol=1e-9) == 2
    for side, link, X_LF in (
        ("a", robot.closures[0].link_a, robot.closures[0].X_AF),
        ("b", robot.closures[0].link_b, robot.closures[0].X_BF),
    ):
        site = model.site(f"rocker_pin::{side}")
        assert model.body(int(site.bodyid[0])).name == link
        np.testing.assert_allclose(site.pos, X_LF.p, atol=1e-15)


def spatial_loop(kind: JointKind) -> Robot:
    """Two pendulums about skew axes, connected at their ends."""
    left, right = pendulum(), pendulum()
    base, bob = left.links
    other = replace(
        right.links[1],
        name="other",
        visuals=tuple(replace(v, name=f"other {v.name}") for v in bob.visuals),
        collisions=tuple(replace(c, name=f"other {c.name}") for c in bob.collisions),
    )
    swing = replace(left.joints[0], dynamics=left.joints[0].dynamics)
    second = replace(swing, name="second", child="other", X_PC=Pose.from_xyz_rpy((0, 0.5, 0), (0.4, 0.2, 0.1)))
    X_WA, X_WB = swing.X_PC, second.X_PC
    X_WF = Pose.from_xyz_rpy((0.3, 0.2, 0.1), (0.5, 0.6, 0.7))
    closure = LoopClosure("pin", kind, "bob", X_WA.inverse() @ X_WF, "other", X_WB.inverse() @ X_WF, (0.0, 0.6, 0.8))
    return replace(left, links=(base, bob, other), joints=(swing, second), closures=(closure,))


@pytest.mark.parametrize(("kind", "lost"), [(JointKind.REVOLUTE, 5), (JointKind.BALL, 3), (JointKind.FIXED, 6)])
def test_closure_takes_as_many_freedoms_as_its_kind(kind: JointKind, lost: int) -> None:
    """Between two floating bodies the equality rows have the rank of the joint that they represent."""
    import mujoco

    robot = spatial_loop(kind)
    files = render(robot, "mjcf", Diagnostics())
    main, *_ = files
    top = etree.fromstring(files[main])
    for hinge in top.findall(".//body/joint"):
        for axis in ("1 0 0", "0 1 0", "0 0 1"):
            hinge.addnext(etree.Element("joint", type="slide", axis=axis))
        hinge.addnext(etree.Element("joint", type="ball"))
        hinge.getparent().remove(hinge)
    meshes = {path: content for path, content in files.items() if path != main}
    model = mujoco.MjModel.from_xml_string(etree.tostring(top).decode(), meshes)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    np.testing.assert_allclose(data.efc_pos[rows], 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(data.efc_J.reshape(-1, model.nv)[rows], tol=1e-9) == lost


def test_mimic_is_an_equality_of_joints(write: Write) -> None:
    """The equality constrains q = multiplier * leader + offset."""
    robot, file = write("gripper_with_mimic", "mjcf")
    model = compiled(file)
    read = {
        model.joint(int(model.eq_obj1id[i])).name: (model.joint(int(model.eq_obj2id[i])).name, *model.eq_data[i][:5])
        for i in range(model.neq)
    }
    expected = {j.name: (j.mimic.joint, j.mimic.offset, j.mimic.multiplier, 0, 0, 0) for j in robot.joints if j.mimic}
    assert read == expected


def test_actuators_drive_their_joints_within_limits(write: Write) -> None:
    """Gains, gear, control and force ranges of the compiled actuators are the robot's."""
    _, file = write("two_link_arm", "mjcf")
    model = compiled(file)
    shoulder, elbow = model.actuator("shoulder_motor"), model.actuator("elbow_motor")
    assert model.joint(int(shoulder.trnid[0])).name == "shoulder"
    assert (shoulder.gainprm[0], shoulder.biasprm[1]) == (100.0, -100.0)
    # kv, of which the slope from effort to velocity limit is damping that the force range does not cut off.
    beside = float(model.actuator_damping[shoulder.id])
    assert beside - shoulder.biasprm[2] == pytest.approx(5.0)
    velocity = float(model.numeric("shoulder::velocity").data[0])
    assert beside + float(model.joint("shoulder").damping[0]) == pytest.approx(12.5 / velocity)
    np.testing.assert_allclose(shoulder.ctrlrange, (-np.pi / 3, 2 * np.pi / 3), rtol=1e-15)
    np.testing.assert_allclose(shoulder.forcerange, (-12.5, 12.5))
    assert elbow.gear[0] == 20.0
    np.testing.assert_allclose(elbow.ctrlrange, (-0.4, 0.4))


def test_neighbours_are_excluded_across_fixed_joints(write: Write) -> None:
    """Contacts are excluded between links connected by a joint, a chain of fixed joints or a closure, and no others."""
    touching = {}
    for name in ("tree", "four_bar"):
        _, file = write(name, "mjcf")
        model = compiled(file)
        model.geom_margin[:] = model.body_margin[:] = 10.0
        data = data_at(model, {})
        bodies = [[int(model.geom_bodyid[g]) for g in geoms] for geoms in data.contact.geom]
        touching[name] = {frozenset((model.body(a).name, model.body(b).name)) for a, b in bodies}
    assert not touching["tree"] & {
        frozenset(pair) for pair in (("base", "left_arm"), ("post", "left_arm"), ("left_arm", "tip"))
    }
    assert frozenset(("left_arm", "right_arm")) in touching["tree"]
    assert frozenset(("coupler", "rocker")) not in touching["four_bar"]
    assert frozenset(("crank", "rocker")) in touching["four_bar"]


@pytest.mark.parametrize("seed", range(40))
def test_flat_and_round_inertias_compile(seed: int) -> None:
    """Bodies whose principal moments satisfy A + B = C, or are equal, compile in any orientation."""
    rng = np.random.default_rng(seed)
    a, b = 10.0 ** rng.uniform(-8, 0, 2)
    moments = ((a, b, a + b), (a, a, 2 * a), (a, a, a))[seed % 3]
    R = rotation_from_rpy(rng.uniform(-3, 3, 3))
    mass = MassProperties.of(1.0, (0.1, 0.2, 0.3), R @ np.diag(moments) @ R.T)
    robot = pendulum()
    robot = replace(robot, links=(robot.root, replace(robot.links[1], mass_properties=mass)))
    body = compiled_from_memory(robot).body("bob")
    np.testing.assert_allclose(np.sort(body.inertia), np.sort(moments), rtol=1e-9, atol=1e-11 * max(moments))


def test_flat_collision_is_left_out_and_flat_visual_stays(diagnostics: Diagnostics) -> None:
    """A flat collision sheet is omitted with a diagnostic; its visual remains."""
    sheet = MeshAsset("sheet", TriMesh.of([(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)]))
    base = one_link().root
    link = Link(
        "base", base.mass_properties, (Visual("seen", MeshRef("sheet")),), (Collision("touched", MeshRef("sheet")),)
    )
    robot = Robot("sheet", (link,), meshes=(sheet,))
    files = render(robot, "mjcf", diagnostics)
    assert [d.code for d in diagnostics] == ["SB760:flat-collision"]
    assert b'name="touched"' not in files["sheet.xml"]
    model = compiled_from_memory(robot)
    assert model.ngeom == 1


def test_visual_and_collision_of_one_name_both_live() -> None:
    """A visual and a collision of one name get distinct geoms."""
    robot = four_bar()
    link = robot.root
    robot = replace(
        robot,
        links=(replace(link, collisions=(replace(link.collisions[0], name=link.visuals[0].name),)), *robot.links[1:]),
    )
    model = compiled_from_memory(robot)
    assert model.geom(f"{link.visuals[0].name}_geom").group[0] == 3


@pytest.mark.parametrize("robot", [equipped(), four_bar()], ids=["equipped", "four_bar"])
def test_dm_control_reads_the_file(robot: Robot, tmp_path: Path) -> None:
    """It rejects a slash in a name, and elements that it does not know; where it is missing, the first is tested."""
    files = render(robot, "mjcf", Diagnostics())
    main = next(iter(files))
    elements = list(etree.fromstring(files[main]).iter("*"))
    assert [one.get("name") for one in elements if "/" in (one.get("name") or "")] == []
    assert {one.tag for one in elements} & {"replicate", "frame", "attach", "model"} == set()
    mjcf = pytest.importorskip("dm_control.mjcf")
    for path, content in files.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_bytes(content)
    assert mjcf.from_path(str(tmp_path / main)).model == robot.name
