"""More known traps of docs/verification.md: each is shown in the engine, and that stepbot avoids it."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

import stepbot
from stepbot.diagnostics import Diagnostics
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Quantity, Request
from stepbot.formats.rendering import render
from stepbot.report.results import Status
from stepbot.robot.dynamics import equations_of_motion
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.model import JointDynamics
from stepbot.robot.surfaces import Surface
from stepbot.runtime.worker import RemoteError, WorkerDied
from tests.processes import call_isolated
from tests.robots import ROBOTS
from tests.simulators.conftest import Folder, failures, look, skip_without, write

_FRICTION = "<surface><friction><ode><mu>0.4</mu>{}</ode></friction></surface>"


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    """The two-link arm on disk."""
    return write(ROBOTS["two_link_arm"](), tmp_path_factory.mktemp("arm"))


def _changed(folder: Folder, written_in: str, name: str, pattern: str, new: str) -> Path:
    """A copy of a file in its folder, with some text replaced."""
    right = folder.written[written_in].path
    text, count = re.subn(pattern, new, right.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert count
    path = right.with_name(name)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.pybullet
def test_pybullet_is_kept_from_joints_of_one_name(arm: Folder) -> None:
    """Duplicate joint names in a URDF end PyBullet's process or its loading; both are reported, and nothing passes."""
    skip_without("pybullet")
    path = _changed(arm, "urdf", "twice.urdf", 'joint name="elbow"', 'joint name="shoulder"')
    with pytest.raises((WorkerDied, RemoteError)) as caught:
        call_isolated(
            "stepbot.engines.pybullet.observer:observe", replace(arm.request("urdf"), file=str(path)), timeout=60.0
        )
    assert isinstance(caught.value, WorkerDied) or caught.value.kind == "EngineRefused"


@pytest.mark.pybullet
def test_pybullet_reads_inertia_only_with_its_flag(arm: Folder) -> None:
    """By default PyBullet computes inertia from collision shapes; stepbot sets the flag that reads the file's."""
    skip_without("pybullet")
    file = str(arm.written["urdf"].path)
    plain, reported = call_isolated("tests.simulators.raw_engines:principal_moments", file, timeout=60.0)
    right = np.linalg.eigvalsh(np.array(arm.robot.link_by_name["forearm"].mass_properties.inertia))
    np.testing.assert_allclose(sorted(reported), right, rtol=1e-4)
    assert not np.allclose(sorted(plain), right, rtol=1e-2)


@pytest.mark.pybullet
def test_pybullet_gives_axes_in_the_inertial_frame(arm: Folder) -> None:
    """PyBullet rotates its joint axis by the principal axes; stepbot rotates it back before comparing."""
    skip_without("pybullet")
    raw = call_isolated("tests.simulators.raw_engines:axis", str(arm.written["urdf"].path), "elbow", timeout=60.0)
    right = arm.robot.joint_by_name["elbow"].axis
    seen = next(joint for joint in look("pybullet", arm.request("urdf")).joints if joint.name == "elbow")
    assert np.linalg.norm(np.subtract(raw, right)) > 1e-3
    np.testing.assert_allclose(seen.axis, right, atol=1e-12)


@pytest.mark.pybullet
def test_pybullet_follows_a_mimic_by_a_gear_alone(tmp_path: Path) -> None:
    """A follower does not move until a JOINT_GEAR with the ratio -1/multiplier drives it."""
    skip_without("pybullet")
    robot = ROBOTS["gripper_with_mimic"]()
    file = str(write(robot, tmp_path).written["urdf"].path)
    mimic = robot.joint_by_name["finger_mirrored"].mimic
    free, geared = call_isolated(
        "tests.simulators.raw_engines:geared", file, mimic.joint, "finger_mirrored", mimic.multiplier, timeout=60.0
    )
    assert abs(free[0]) > 0.003
    assert abs(free[1]) < 1e-6
    assert geared[1] == pytest.approx(mimic.multiplier * geared[0], rel=0.05)


@pytest.mark.pybullet
@pytest.mark.parametrize(("share", "grows"), [(0.9, False), (1.1, True)])
def test_pybullet_shakes_where_damping_is_too_much(share: float, grows: bool, tmp_path: Path) -> None:
    """PyBullet integrates damping explicitly: above 2 x inertia / step, each step overshoots."""
    skip_without("pybullet")
    robot = ROBOTS["two_link_arm"]()
    names = [joint.name for joint in moving_joints(robot)]
    M = equations_of_motion(robot, {"elbow": 0.5}).mass_matrix
    mobility = np.linalg.inv(M)[names.index("elbow"), names.index("elbow")]
    damping = share * 2 / (1e-3 * mobility)
    joints = tuple(
        replace(joint, dynamics=JointDynamics(damping=damping if joint.name == "elbow" else 0.0))
        for joint in robot.joints
    )
    file = write(replace(robot, joints=joints), tmp_path).written["urdf"].path
    speeds = call_isolated("tests.simulators.raw_engines:pushed", str(file), "elbow", timeout=60.0)
    assert (speeds[-1] > 10 * speeds[0]) == grows
    assert (speeds[-1] < 0.1 * speeds[0]) != grows


@pytest.mark.pybullet
def test_pybullet_is_asked_of_mjcf_whether_it_loads_and_no_more(arm: Folder) -> None:
    """PyBullet computes wrong poses for MJCF, so everything except loading is not run, with a reason."""
    seen = look("pybullet", arm.request("mjcf"))
    assert set(Quantity) - set(seen.not_run) == {Quantity.LOAD}
    assert {"computes wrong poses" in reason for reason in seen.not_run.values()} == {True}


@pytest.mark.mujoco
def test_mujoco_collides_a_fixed_base_with_the_first_link(arm: Folder) -> None:
    """MuJoCo filters contacts with a parent, except with one fixed to the world; there stepbot writes an exclude."""
    path = _changed(arm, "mjcf", "touching.xml", "<contact>.*?</contact>", "")
    seen = look("mujoco", replace(arm.request("mjcf"), file=str(path), simulate=0.0))
    assert Quantity.CONTACTS in failures(arm.expected("mjcf"), seen)


@pytest.mark.mujoco
def test_mujoco_equal_limits_are_noticed(arm: Folder) -> None:
    """MuJoCo interprets equal limits as unlimited, or rejects them; both are reported."""
    path = _changed(arm, "urdf", "equal.urdf", 'lower="-2" upper="2.25"', 'lower="0" upper="0"')
    seen = look("mujoco", replace(arm.request("urdf"), file=str(path), simulate=0.0))
    elbow = next(joint for joint in seen.joints if joint.name == "elbow")
    assert not {"lower", "upper"} & set(elbow.limit_fields)
    assert failures(arm.expected("urdf"), seen) == {Quantity.WARNINGS}


@pytest.mark.mujoco
def test_mujoco_reads_one_object_per_mesh_and_no_packages(arm: Folder) -> None:
    """Each mesh is an OBJ of one object at a plain path; in foreign files ``package://`` is resolved first."""
    meshes = sorted(file for file in (arm.path / "meshes").iterdir() if file.suffix != ".usdc")
    assert {mesh.suffix for mesh in meshes} == {".obj"}
    for mesh in meshes:
        assert sum(line.startswith("o ") for line in mesh.read_text(encoding="utf-8").splitlines()) <= 1
    for one in arm.written.values():
        assert "package://" not in one.path.read_text(encoding="utf-8")
    path = _changed(arm, "urdf", "package.urdf", 'filename="meshes/', f'filename="package://{arm.path.name}/meshes/')
    request = replace(arm.request("urdf"), file=str(path), simulate=0.0)
    assert Quantity.MESHES not in failures(arm.expected("urdf"), look("mujoco", request))


def test_mujoco_gets_an_inertial_for_every_body() -> None:
    """Every body has an inertial; otherwise MuJoCo would compute masses from meshes."""
    for name in ("two_link_arm", "tree", "primitives", "floating_biped"):
        main, *_ = render(ROBOTS[name](), "mjcf", Diagnostics()).values()
        bodies = list(etree.fromstring(main).iter("body"))
        assert bodies
        assert all(len(body.findall("inertial")) == 1 for body in bodies)


@pytest.mark.mujoco
def test_mujoco_would_write_six_digits(arm: Folder) -> None:
    """MuJoCo's own writer rounds to six digits; stepbot's file has all digits."""
    skip_without("mujoco")
    import mujoco

    mass = repr(arm.robot.root.mass_properties.mass)
    assert len(mass) > 12
    spec = mujoco.MjSpec.from_file(str(arm.written["mjcf"].path))
    spec.compile()
    assert mass not in spec.to_xml()
    assert mass in arm.written["mjcf"].path.read_text(encoding="utf-8")


def test_drake_needs_a_scene_to_miss_a_mesh(tmp_path: Path) -> None:
    """A plant without a scene loads a file whose mesh is missing; stepbot adds a scene, and Drake rejects the file."""
    skip_without("drake")
    from stepbot.engines.drake.plant import build

    folder = write(ROBOTS["two_link_arm"](), tmp_path)
    request = replace(folder.request("sdf"), simulate=0.0)
    (tmp_path / "meshes" / "upper_arm_1.obj").unlink()
    assert build(request, bare=True).bodies
    with pytest.raises((WorkerDied, RemoteError), match="upper_arm_1"):
        call_isolated("stepbot.engines.drake.observer:observe", request, timeout=120.0)


def test_drake_rejects_the_frames_of_sensors_in_gazebo(tmp_path: Path) -> None:
    """Drake rejects `<gz_frame_id>`; it is verified with a copy without, and a note says so."""
    skip_without("drake")
    from stepbot.engines.drake.plant import build

    request = replace(write(ROBOTS["equipped"](), tmp_path).request("sdf"), simulate=0.0)
    assert "<gz_frame_id>" in Path(request.file).read_text(encoding="utf-8")
    with pytest.raises(EngineRefused, match="gz_frame_id"):
        build(request)
    seen = call_isolated("stepbot.engines.drake.observer:observe", request, timeout=120.0)
    assert any("gz_frame_id" in note for note in seen.notes)


@pytest.mark.parametrize("second", ["", "<mu2>0.3</mu2>", "<mu2>0.5</mu2>"])
def test_drake_takes_the_second_friction_for_that_of_sliding(second: str, tmp_path: Path) -> None:
    """It rejects more than the first, and 1 is its default; it is verified with the friction of the first direction."""
    skip_without("drake")
    shape = f"<geometry><sphere><radius>0.1</radius></sphere></geometry>{_FRICTION.format(second)}"
    link = f'<link name="a"><inertial><mass>1</mass></inertial><collision name="c">{shape}</collision></link>'
    (tmp_path / "r.sdf").write_text(f'<sdf version="1.9"><model name="r">{link}</model></sdf>', encoding="utf-8")
    request = Request(str(tmp_path / "r.sdf"), "sdf", configurations=({},), simulate=0.0)
    seen = call_isolated("stepbot.engines.drake.observer:observe", request, timeout=120.0)
    assert [one.surface for one in seen.links[0].collisions] == [Surface(0.4)]
    assert any("<mu2>" in note for note in seen.notes)


@pytest.mark.parametrize("name", ["robot.urdf.xml", "robot.world", "robot.mjcf"])
def test_drake_takes_the_format_from_the_name_of_the_file(name: str, tmp_path: Path) -> None:
    """A file with another suffix is left to other engines; Drake would reject it."""
    skip_without("drake")
    written_in = {".xml": "urdf", ".world": "sdf", ".mjcf": "mjcf"}[Path(name).suffix]
    request = write(ROBOTS["floating_biped"](), tmp_path).request(written_in)
    path = Path(request.file).rename(tmp_path / name)
    with pytest.raises(RemoteError, match="Drake takes the format of a file from its name") as caught:
        call_isolated("stepbot.engines.drake.observer:observe", replace(request, file=str(path)), timeout=120.0)
    assert caught.value.kind == "EngineCannotRead"


def test_drake_does_not_read_mimics_of_sdformat(tmp_path: Path) -> None:
    """Drake ignores mimics of SDFormat; the comparison is not run, and not passed."""
    folder = write(ROBOTS["gripper_with_mimic"](), tmp_path)
    seen = look("drake", replace(folder.request("sdf"), simulate=0.0))
    assert all(joint.mimic is None for joint in seen.joints)
    assert Quantity.MIMIC in seen.not_run


def test_drake_takes_no_joint_that_closes_a_loop(tmp_path: Path) -> None:
    """Drake does not read the SDFormat of a four-bar; the file for Drake is verified instead."""
    skip_without("drake")
    folder = write(ROBOTS["four_bar"](), tmp_path)
    with pytest.raises(RemoteError, match="closes a loop") as caught:
        call_isolated("stepbot.engines.drake.observer:observe", folder.request("sdf"), timeout=120.0)
    assert caught.value.kind == "EngineCannotRead"
    assert look("drake", replace(folder.request("drake.sdf"), simulate=0.0)).closures


def test_drake_ends_over_swapped_limits(arm: Folder) -> None:
    """Swapped limits end Drake's process, which is separate: it is reported and the other engines continue."""
    skip_without("drake")
    path = _changed(arm, "urdf", "swapped_limits.urdf", 'lower="-2" upper="2.25"', 'lower="2.25" upper="-2"')
    request = replace(arm.request("urdf"), file=str(path), simulate=0.0)
    with pytest.raises((WorkerDied, RemoteError)):
        call_isolated("stepbot.engines.drake.observer:observe", request, timeout=120.0)


@pytest.mark.parametrize("late", ['<compiler angle="radian"/>', '<default><joint axis="1 0 0"/></default>'])
def test_pinocchio_reads_no_defaults_behind_bodies(late: str, tmp_path: Path) -> None:
    """Such a file is left to other engines: Pinocchio would turn bodies by other angles, and about other axes."""
    skip_without("pinocchio")
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    bodies = f'<body name="a">{inertial}<body name="b" euler="1 0 0">{inertial}<joint name="j"/></body></body>'
    file = tmp_path / "r.xml"
    request = Request(str(file), "mjcf", configurations=({},), simulate=0.0)
    file.write_text(f"<mujoco>{late}<worldbody>{bodies}</worldbody></mujoco>", encoding="utf-8")
    assert look("pinocchio", request).poses
    file.write_text(f"<mujoco><worldbody>{bodies}</worldbody>{late}</mujoco>", encoding="utf-8")
    with pytest.raises(EngineCannotRead, match="only in front of the bodies"):
        look("pinocchio", request)


def test_pinocchio_has_two_coordinates_for_a_joint_without_limits(tmp_path: Path) -> None:
    """Pinocchio has cosine and sine as coordinates; stepbot converts from and to one angle."""
    skip_without("pinocchio")
    import pinocchio

    folder = write(ROBOTS["pendulum"](), tmp_path)
    model = pinocchio.buildModelFromUrdf(str(folder.written["urdf"].path))
    assert (model.nq, model.nv) == (2, 1)
    seen = look("pinocchio", folder.request("urdf"))
    assert len(seen.coordinates) == 1
    assert failures(folder.expected("urdf"), seen) == set()


def test_libsdformat_calls_later_versions_valid(arm: Folder) -> None:
    """libsdformat accepts a later version with exit code 0 and a warning; such a file is not run."""
    skip_without("libsdformat")
    from stepbot.engines.libsdformat import observer as libsdformat

    path = _changed(arm, "sdf", "later.sdf", 'sdf version="1.9"', 'sdf version="9.9"')
    command = libsdformat._command()
    assert command is not None
    run = subprocess.run([command[0], "sdf", "--check", str(path)], capture_output=True, text=True, check=False)
    assert run.returncode == 0
    assert "Valid." in run.stdout
    with pytest.raises(RemoteError, match=r"version 9\.9") as caught:
        call_isolated("stepbot.engines.libsdformat.observer:observe", replace(arm.request("sdf"), file=str(path)))
    assert caught.value.kind == "EngineCannotRead"


@pytest.mark.parametrize("engine", ["drake", "pinocchio"])
def test_a_body_that_is_hinged_to_the_world_is_left_to_other_engines(engine: str, tmp_path: Path) -> None:
    """Neither reports the world: Drake lacks the joint, and the search for the link above it did not end."""
    skip_without(engine)
    file = tmp_path / "cart.xml"
    file.write_text(
        """<mujoco model="cart"><worldbody><body name="a"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<joint name="j" axis="0 0 1"/></body></worldbody></mujoco>""",
        encoding="utf-8",
    )
    verified = stepbot.verify(file)
    assert not [str(one) for one in verified.diagnostics if one.severity == "error"]
    own = [check for check in verified.report.checks if check.engine == engine]
    (reason,) = {check.why for check in own}
    assert {check.status for check in own} == {Status.NOT_RUN}
    assert "world" in reason
