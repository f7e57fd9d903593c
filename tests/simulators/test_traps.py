"""Known deviations of engines; each test fails if the engine's behaviour changes."""

import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.engines import engine_of
from stepbot.engines.observation import EngineCannotRead, Observation, Quantity, Request
from stepbot.engines.workers import Engines, Fate
from stepbot.robot.model import Collision, Sphere
from stepbot.runtime.worker import RemoteError, WorkerDied
from tests.processes import call_isolated
from tests.robots import ROBOTS
from tests.simulators.conftest import Folder, failures, look, skip_without, write


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    """The two-link arm on disk."""
    return write(ROBOTS["two_link_arm"](), tmp_path_factory.mktemp("arm"))


def _link(observation: Observation, name: str) -> object:
    return next(link for link in observation.links if link.name == name)


@pytest.mark.pybullet
def test_pybullet_reports_no_mass_of_a_fixed_base(arm: Folder) -> None:
    """PyBullet reports 0 kg for a fixed base: the mass is read from a second, floating body."""
    base = arm.robot.root
    seen = next(link for link in look("pybullet", arm.request("urdf")).links if link.name == base.name)
    assert seen.mass == pytest.approx(base.mass_properties.mass, rel=1e-12)
    np.testing.assert_allclose(seen.inertia, base.mass_properties.inertia, rtol=1e-6, atol=1e-12)


@pytest.mark.pybullet
def test_pybullet_poses_are_doubles(arm: Folder) -> None:
    """PyBullet returns link frames as floats, 1e-8 off; inertial frames are doubles."""
    request = replace(arm.request("urdf"), simulate=0.0)
    seen, expected = look("pybullet", request), arm.expected("urdf")
    for ours, theirs in zip(expected.poses, seen.poses, strict=True):
        for link in ours:
            assert max(ours[link].distance_to(theirs[link])) < 1e-12


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.parametrize("robot", ["two_link_arm", "four_bar", "floating_biped"])
@pytest.mark.parametrize(("engine", "written_in"), [("mujoco", "mjcf"), ("mujoco", "urdf"), ("pybullet", "urdf")])
def test_what_was_observed_first_makes_no_difference(
    engine: str, written_in: str, robot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One state, or one server, is allocated for a request; what it did last is not in what it reports next."""
    module, allocates = import_module(engine), {"mujoco": "MjData", "pybullet": "connect"}[engine]
    allocate, allocated = getattr(module, allocates), []

    def counted(*given: Any) -> Any:
        allocated.append(given)
        return allocate(*given)

    monkeypatch.setattr(module, allocates, counted)
    folder = write(ROBOTS[robot](), tmp_path)
    asked = folder.request(written_in)
    count = len(asked.configurations)
    backwards = replace(asked, configurations=asked.configurations[::-1], rates=asked.rates[::-1])
    seen, other = look(engine, asked), look(engine, backwards)
    assert len(allocated) == 2
    assert failures(folder.expected(written_in), seen) == set()
    assert seen.dynamics is not None
    assert other.dynamics is not None
    for poses, again in zip(seen.poses[:count], other.poses[count - 1 :: -1], strict=True):
        assert all(poses[link].matrix.tolist() == again[link].matrix.tolist() for link in poses)
    for one, again in zip(seen.dynamics[:count], other.dynamics[count - 1 :: -1], strict=True):
        np.testing.assert_array_equal(one.mass_matrix, again.mass_matrix)
        np.testing.assert_array_equal(one.gravity, again.gravity)
        np.testing.assert_array_equal(one.inverse, again.inverse)


@pytest.mark.pybullet
def test_pybullet_prints_a_question_mark_for_a_ball_beside_a_mesh(tmp_path: Path) -> None:
    """PyBullet prints a line for each shape without vertices, which is not a warning about the file."""
    robot = ROBOTS["two_link_arm"]()
    link = robot.links[-1]
    shapes = (Collision("hull", link.visuals[0].geometry), Collision("ball", Sphere(0.01)))
    mixed = replace(robot, links=(*robot.links[:-1], replace(link, collisions=shapes)))
    folder = write(mixed, tmp_path)
    seen = look("pybullet", replace(folder.request("urdf"), simulate=0.0))
    assert seen.warnings == ()
    assert next(one for one in seen.links if one.name == link.name).collision_bounds is not None


@pytest.mark.pybullet
def test_pybullet_takes_a_link_without_inertial_for_a_kilogram(arm: Folder) -> None:
    """PyBullet uses 1 kg for a link without inertial: it gets a copy with an all-zero one, and a check fails."""
    engine = pytest.importorskip("pybullet")
    path = arm.path / "no_inertial.urdf"
    text = arm.written["urdf"].path.read_text(encoding="utf-8")
    path.write_text(re.sub(r'(<link name="tool0">)\s*<inertial>.*?</inertial>', r"\1", text, flags=re.DOTALL))
    client = engine.connect(engine.DIRECT)
    body = engine.loadURDF(str(path), useFixedBase=True, physicsClientId=client)
    indices = range(engine.getNumJoints(body, physicsClientId=client))
    names = {engine.getJointInfo(body, index, physicsClientId=client)[12]: index for index in indices}
    assert engine.getDynamicsInfo(body, names[b"tool0"], physicsClientId=client)[0] == 1.0
    engine.disconnect(client)
    seen = look("pybullet", replace(arm.request("urdf"), file=str(path), simulate=0.0))
    assert next(link.mass for link in seen.links if link.name == "tool0") == 0.0
    assert any("1 kg for a link without <inertial>" in warning for warning in seen.warnings)
    assert failures(arm.expected("urdf"), seen) == {Quantity.WARNINGS}


@pytest.mark.pybullet
@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_pybullet_crashes_on_two_roots_in_a_process_of_its_own(arm: Folder) -> None:
    """Two roots crash PyBullet; its last output is kept, and the other engines report."""
    skip_without("pybullet")
    path = arm.path / "two_roots.urdf"
    text = arm.written["urdf"].path.read_text(encoding="utf-8")
    path.write_text(text.replace('<link name="base">', '<link name="other"/><link name="base">'), encoding="utf-8")
    with Engines({"file": "urdf"}) as engines:
        engines.submit({"file": replace(arm.request("urdf"), file=str(path))})
        outcomes = {outcome.engine: outcome for outcome in engines.results(120.0)}
    assert outcomes["pybullet"].fate is Fate.DIED
    assert "SIGSEGV" in outcomes["pybullet"].reason
    assert any("multiple root links" in line for line in outcomes["pybullet"].last_lines)
    assert outcomes["yourdfpy"].fate is Fate.REFUSED
    assert outcomes["mujoco"].fate is not Fate.DIED


@pytest.mark.pybullet
def test_pybullet_reads_sdformat_from_a_copy_without_world_and_loops(tmp_path: Path) -> None:
    """PyBullet rejects a joint to the world and crashes on a loop; it gets a copy without, and both are named."""
    folder = write(ROBOTS["four_bar"](), tmp_path)
    request = folder.request("sdf")
    seen = look("pybullet", request)
    assert seen.notes == (
        "read from a copy without joint 'world_to_ground' to the world",
        "read from a copy without closing joint 'rocker_pin'",
    )
    with pytest.raises(RemoteError, match="Cannot load SDF file"):
        call_isolated("tests.simulators.raw_engines:load_sdf", request.file, timeout=60.0)
    loop = tmp_path / "loop.sdf"
    text = Path(request.file).read_text(encoding="utf-8")
    loop.write_text(re.sub(r'<joint name="world_to_ground".*?</joint>', "", text, flags=re.DOTALL), encoding="utf-8")
    with pytest.raises(WorkerDied, match="SIGSEGV"):
        call_isolated("tests.simulators.raw_engines:load_sdf", str(loop), timeout=60.0)


@pytest.mark.pybullet
def test_pybullet_ignores_inertia_in_sdformat(arm: Folder) -> None:
    """PyBullet ignores inertia in SDFormat: inertia and mass matrix are not run; gravity forces use masses only."""
    seen = look("pybullet", arm.request("sdf"))
    assert all(link.inertia is None for link in seen.links)
    assert all(one.mass_matrix is None and one.inverse is None for one in seen.dynamics)
    assert {Quantity.INERTIA, Quantity.MASS_MATRIX, Quantity.INVERSE_DYNAMICS} <= set(seen.not_run)


HINGE = """<sdf version="1.9"><model name="door">
  <link name="frame"><inertial><mass>5</mass>INERTIA</inertial></link>
  <link name="leaf"><pose PLACE</pose><inertial><mass>2</mass>INERTIA</inertial></link>
  <joint name="hinge" type="KIND"><pose>JOINT</pose><parent>frame</parent><child>leaf</child>
    <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
</model></sdf>""".replace("INERTIA", "<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>")


@pytest.mark.pybullet
@pytest.mark.parametrize(
    ("place", "kind", "joint", "reason"),
    [
        (">0.3 0.1 0 0 0 0", "revolute", "0.01 0.02 0 0 0 0", "poses of joints"),
        (">0.3 0.1 0 0 0 0", "prismatic", "0 0 0 0.3 0 0", "poses of joints"),
        (' degrees="true">0.3 0.1 0 10 20 30', "revolute", "0 0 0 0 0 0", "degrees"),
        (' rotation_format="quat_xyzw">0.3 0.1 0 0 0 0.1 0.995', "revolute", "0 0 0 0 0 0", "rotation_format"),
        (' relative_to="frame">0.3 0.1 0 0 0 0', "revolute", "0 0 0 0 0 0", "relative_to"),
        (">0.3 0.1 0 0.1 0 0", "revolute", "0 0 0 0 0 0", ""),
        (">0.3 0.1 0 0.1 0 0", "prismatic", "0.01 0.02 0 0 0 0", ""),  # a slide is the same anywhere
    ],
)
def test_pybullet_is_kept_from_poses_that_it_ignores(
    place: str, kind: str, joint: str, reason: str, tmp_path: Path
) -> None:
    """PyBullet would turn a leaf about its origin, not about its hinge; other files it reads as the reader does."""
    file = tmp_path / "door.sdf"
    file.write_text(HINGE.replace(" PLACE", place).replace("KIND", kind).replace("JOINT", joint), encoding="utf-8")
    request = Request(str(file), "sdf", ({"hinge": 0.4},), simulate=0.0)
    if reason:
        with pytest.raises(EngineCannotRead, match=f"PyBullet ignores {reason}"):
            look("pybullet", request)
        return
    ours, theirs = (look(engine, request).poses[0]["leaf"] for engine in ("reader", "pybullet"))
    assert theirs.distance_to(ours) == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.pybullet
def test_pybullet_refuses_what_is_not_there(tmp_path: Path) -> None:
    """PyBullet rejects a missing file with a message instead of a crash."""
    skip_without("pybullet")
    with pytest.raises(RemoteError, match="Cannot load URDF file") as caught:
        call_isolated("stepbot.engines.pybullet.observer:observe", Request(str(tmp_path / "no.urdf"), "urdf"))
    assert caught.value.kind == "EngineRefused"
    assert str(tmp_path) not in caught.value.text


@pytest.mark.pybullet
def test_pybullet_names_the_missing_mesh(tmp_path: Path) -> None:
    """A missing mesh rejects the whole file; the message has the given names and no local folder."""
    skip_without("pybullet")
    folder = write(ROBOTS["two_link_arm"](), tmp_path)
    (tmp_path / "meshes" / "upper_arm_1.obj").unlink()
    with pytest.raises(RemoteError, match=r"cannot find 'meshes/upper_arm_1\.obj'") as caught:
        call_isolated("stepbot.engines.pybullet.observer:observe", folder.request("urdf"))
    assert caught.value.kind == "EngineRefused"
    assert str(tmp_path) not in caught.value.text


@pytest.mark.slow
@pytest.mark.pybullet
def test_pybullet_does_not_remember_a_former_file(arm: Folder, tmp_path: Path) -> None:
    """Two meshes of one name in two folders stay distinct in one process."""
    skip_without("pybullet")
    other = write(ROBOTS["two_link_arm"](), tmp_path)
    swapped = tmp_path / "meshes" / "upper_arm_1.obj"
    swapped.write_bytes((tmp_path / "meshes" / "base_1.obj").read_bytes())
    seen = call_isolated(
        "tests.simulators.raw_engines:observe_both",
        "stepbot.engines.pybullet.observer",
        replace(arm.request("urdf"), simulate=0.0),
        replace(other.request("urdf"), simulate=0.0),
    )
    assert Quantity.MESHES not in failures(arm.expected("urdf"), seen[0])
    assert Quantity.MESHES in failures(arm.expected("urdf"), seen[1])


@pytest.mark.mujoco
def test_mujoco_keeps_base_visuals_and_folders_of_a_urdf(arm: Folder) -> None:
    """Without stepbot's compiler options MuJoCo merges the base into the world and strips folders from mesh names."""
    seen = look("mujoco", arm.request("urdf"))
    assert seen.links[0].name == "base"
    assert seen.links[0].mass == pytest.approx(arm.robot.root.mass_properties.mass, rel=1e-12)
    assert all(link.has_visuals for link in seen.links[:3])
    assert failures(arm.expected("urdf"), seen) == set()


@pytest.mark.mujoco
def test_mujoco_lets_the_base_of_a_urdf_collide_with_what_moves_on_it(tmp_path: Path) -> None:
    """MuJoCo excludes contacts of adjacent links, but not with a parent fixed to the world; stepbot does."""
    mujoco = pytest.importorskip("mujoco")
    from stepbot.engines.mujoco.observer import _compile

    link = (
        '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        "</inertial>"
        '<collision><origin xyz="0 0 {}"/><geometry><sphere radius="0.2"/></geometry></collision></link>'
    )
    joint = '<joint name="{1}" type="{2}"><parent link="{0}"/><child link="{1}"/><axis xyz="1 0 0"/></joint>'
    top = "".join([link.format(name, z) for name, z in (("base", 0), ("stand", 0.1), ("arm", 0.2), ("tool", 0.15))])
    top += joint.format("base", "stand", "fixed") + joint.format("stand", "arm", "continuous")
    path = tmp_path / "two.urdf"
    path.write_text(f'<robot name="two">{top}{joint.format("arm", "tool", "fixed")}</robot>', encoding="utf-8")

    def contacts(model: Any) -> int:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return int(data.ncon)

    assert contacts(mujoco.MjModel.from_xml_path(str(path))) > 0
    assert contacts(_compile(mujoco, Request(str(path), "urdf"))[0]) == 0


@pytest.mark.mujoco
def test_mujoco_mass_matrix_is_compared_without_armature(arm: Folder) -> None:
    """MuJoCo's mass matrix includes armature; stepbot compares without it, and armature separately."""
    seen, expected = look("mujoco", arm.request("mjcf")), arm.expected("mjcf")
    assert arm.robot.joint_by_name["shoulder"].dynamics.armature > 0.0
    for ours, theirs in zip(expected.dynamics, seen.dynamics, strict=True):
        np.testing.assert_allclose(theirs.mass_matrix, ours.mass_matrix, rtol=1e-12)


@pytest.mark.mujoco
def test_mujoco_swapped_limits_are_noticed(arm: Folder) -> None:
    """Swapped limits are unlimited in MuJoCo; other engines reject them or crash, which is reported."""
    path = arm.path / "swapped.urdf"
    text = arm.written["urdf"].path.read_text(encoding="utf-8")
    path.write_text(re.sub(r'lower="-2" upper="2.25"', 'lower="2.25" upper="-2"', text), encoding="utf-8")
    with Engines({"file": "urdf"}) as engines:
        engines.submit({"file": replace(arm.request("urdf"), file=str(path), simulate=0.0)})
        for outcome in engines.results(120.0):
            if outcome.fate is Fate.ABSENT or outcome.engine == "extensions":  # which reads no joint limits
                continue
            if outcome.fate is Fate.DIED:
                assert outcome.engine == "drake"
                assert any("pos_lower_limits" in line for line in outcome.last_lines)
                continue
            assert outcome.fate in (Fate.OBSERVED, Fate.REFUSED)
            if outcome.observation is not None:
                assert Quantity.LIMITS in failures(arm.expected("urdf"), outcome.observation)


@pytest.mark.mujoco
def test_mujoco_rejections_have_its_own_message(arm: Folder) -> None:
    """Reasons of a rejection are MuJoCo's message, without local folders."""
    skip_without("mujoco")
    path = arm.path / "broken.xml"
    text = arm.written["mjcf"].path.read_text(encoding="utf-8")
    path.write_text(text.replace("upper_arm_1.obj", "no.obj"), encoding="utf-8")
    with pytest.raises(RemoteError, match="upper_arm_1") as caught:
        call_isolated("stepbot.engines.mujoco.observer:observe", replace(arm.request("mjcf"), file=str(path)))
    assert caught.value.kind == "EngineRefused"
    assert str(arm.path) not in caught.value.text


@pytest.mark.mujoco
def test_mujoco_simulation_that_diverges_is_noticed(
    arm: Folder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A step of 0.1 s on a spring that pushes diverges: not finite, whatever MuJoCo warns of; no log file is left."""
    monkeypatch.chdir(tmp_path)
    path = arm.path / "stiff.xml"
    text = arm.written["mjcf"].path.read_text(encoding="utf-8")
    text = text.replace("<default>", '<option timestep="0.1" integrator="RK4"/><default>', 1)
    path.write_text(text.replace('damping="0.02"', 'stiffness="-1e9"'), encoding="utf-8")
    seen = look("mujoco", replace(arm.request("mjcf"), file=str(path)))
    assert seen.simulation_finite is False
    assert any("Nan, Inf or huge value" in note for note in seen.notes), "with the coordinate"
    assert Quantity.SIMULATION in failures(arm.expected("mjcf"), seen)
    assert list(tmp_path.iterdir()) == []


def test_yourdfpy_does_not_follow_a_chain_of_mimics(tmp_path: Path) -> None:
    """yourdfpy puts a mimic of a mimic at its offset: poses are not run, and the reason names the joint."""
    path = tmp_path / "chain.urdf"
    joints = "".join(
        f'<joint name="{name}" type="prismatic"><parent link="base"/><child link="{name}_link"/>{mimic}'
        '<limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
        for name, mimic in (("a", ""), ("b", '<mimic joint="a"/>'), ("c", '<mimic joint="b" offset="0.5"/>'))
    )
    links = "".join(f'<link name="{name}"/>' for name in ("base", "a_link", "b_link", "c_link"))
    path.write_text(f'<robot name="chain">{links}{joints}</robot>', encoding="utf-8")
    seen = look("yourdfpy", Request(str(path), "urdf", configurations=({"a": 0.1, "b": 0.1, "c": 0.6},)))
    assert seen.poses == ()
    assert seen.not_run[Quantity.POSES] == "yourdfpy does not follow a mimic of a mimic: c"
    assert seen.warnings == ()


def test_an_engine_that_is_not_there_is_absent(arm: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that is not installed is not run, with the reason; no process is started."""
    monkeypatch.setattr(engine_of("yourdfpy"), "available", lambda: "yourdfpy is not installed")
    with Engines({"file": "urdf"}) as engines:
        engines.submit({"file": replace(arm.request("urdf"), simulate=0.0)})
        outcomes = {outcome.engine: outcome for outcome in engines.results(120.0)}
    assert outcomes["yourdfpy"].fate is Fate.ABSENT
    assert outcomes["yourdfpy"].reason == "yourdfpy is not installed"


_TRAPPED = """<mujoco><worldbody><body name="box"><geom type="box" size="1 1 0.1" pos="0 0 0.12"/>
  <body name="ball" pos="{x} 0 0"><joint type="slide" axis="0 0 1"{more}/><geom size="0.1" solref="-1e15 -1"/>
</body></body></worldbody><option><flag filterparent="disable"/></option></mujoco>"""


@pytest.mark.mujoco
def test_links_that_are_pushed_apart_are_named(tmp_path: Path) -> None:
    """A stiff contact that begins deep makes the simulation diverge, which excluding it would mend."""
    path = tmp_path / "trapped.xml"
    request = Request(str(path), "mjcf", configurations=({},), simulate=0.1)
    path.write_text(_TRAPPED.format(x=0.0, more=""), encoding="utf-8")
    seen = look("mujoco", request)
    assert (seen.simulation_finite, seen.initial_penetrations, seen.warnings) == (False, (("ball", "box"),), ())
    path.write_text(_TRAPPED.format(x=3.0, more=""), encoding="utf-8")
    assert look("mujoco", request).simulation_finite
    path.write_text(_TRAPPED.format(x=3.0, more=' stiffness="-1e15" ref="1" springref="0"'), encoding="utf-8")
    assert look("mujoco", request).initial_penetrations == ()
