"""A URDF as the source of a conversion."""

import importlib.util
import json
from pathlib import Path
from time import process_time
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.described.finding import Finding
from stepbot.described.tree import tree_of
from stepbot.engines.description.urdf import describe_urdf
from stepbot.jobs.incremental import check, convert
from stepbot.pipeline import writing
from stepbot.pipeline.conversion import Conversion, Options
from stepbot.robot.model import Robot
from tests.conftest import ReadDiagnostics

from .arm import ARM, write_arm

pytestmark = pytest.mark.xdist_group("arm of others")


def options_of(folder: Path, *formats: str, verify: bool = True) -> Options:
    """Options of a conversion into a folder, with the package of the arm."""
    return Options(folder / "out", formats=formats, verify=verify, package_path=(folder / "packages",))


@pytest.fixture(scope="module")
def converted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Conversion]:
    """The arm in MJCF and SDFormat, proven."""
    folder = tmp_path_factory.mktemp("arm")
    return folder, convert(write_arm(folder), options_of(folder, "mjcf", "sdf"))


@pytest.mark.slow
def test_conversion_is_proven_against_model_and_source(converted: tuple[Path, Conversion]) -> None:
    """Engines compare the written files with the model, and with what they read of the source."""
    folder, conversion = converted
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    report = json.loads((folder / "out" / "report.json").read_text(encoding="utf-8"))
    assert report["summary"]["failed"] == 0
    for file in ("arm.xml", "arm.sdf"):
        of_source = {
            one["quantity"]
            for one in report["checks"]
            if one["file"] == file and one["against"].startswith("arm.urdf (") and one["status"] == "passed"
        }
        assert {"links", "joints", "axes", "limits", "mass", "com", "inertia", "poses", "mass matrix"} <= of_source
    assert set(report["inputs"]) == {"arm.urdf", "upper.stl"}


@pytest.mark.slow
def test_mujoco_sees_what_the_source_states(converted: tuple[Path, Conversion]) -> None:
    """Mass, centre of mass, inertia, limits and the scaled mesh are those of the URDF's text."""
    folder, _ = converted
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "arm.xml"))
    upper = model.body("upper")
    assert upper.mass == pytest.approx(2.0)
    assert upper.ipos == pytest.approx([0.01, 0.02, 0.15])
    stated = ET.fromstring(ARM).find(".//link[@name='upper']/inertial/inertia")
    assert stated is not None
    i = {name: float(value) for name, value in stated.attrib.items()}
    tensor = np.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]])
    assert sorted(upper.inertia) == pytest.approx(np.linalg.eigvalsh(tensor))
    assert model.joint("shoulder").range == pytest.approx([-1.5, 2.0])
    assert model.joint("shoulder").axis == pytest.approx([0.0, 0.5**0.5, 0.5**0.5])
    lines = (folder / "out" / "meshes" / "upper.obj").read_text(encoding="ascii").splitlines()
    vertices = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    assert len(vertices) == 4  # STL repeats them in each of four faces
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.11, 0.3])  # millimetres, scaled
    assert model.actuator("shoulder_motor").gear[0] == pytest.approx(50.0)
    assert model.neq == 1


def test_losses_are_declared(converted: tuple[Path, Conversion]) -> None:
    """What the model cannot hold is reported at its line, and nothing else."""
    _, conversion = converted
    lost = [(one.message, one.span.line) for one in conversion.diagnostics if one.code == "SB860"]
    line = next(i for i, text in enumerate(ARM.splitlines(), start=1) if "safety_controller" in text)
    assert lost == [("<safety_controller> in <joint>: not converted", line)]
    assert not [one for one in conversion.diagnostics if one.code in ("SB861", "SB863", "SB874:base")]


def test_same_source_gives_same_bytes(converted: tuple[Path, Conversion], tmp_path: Path) -> None:
    """A second conversion writes the same bytes, from another folder."""
    _, conversion = converted
    again = convert(write_arm(tmp_path), options_of(tmp_path, "mjcf", "sdf", verify=False))
    files = {name: content for name, content in conversion.files.items() if name != "report.json"}
    assert {name: content for name, content in again.files.items() if name != "report.json"} == files


@pytest.mark.slow
def test_misreading_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Were a mass misread, the files would be equal to the model, but not to the source."""
    described = writing.rendered

    def misread(robot: Robot, *rest: object) -> writing.Rendered:
        upper = robot.link_by_name["upper"]
        heavier = replace(upper, mass_properties=replace(upper.mass_properties, mass=2.1))
        links = tuple(heavier if link is upper else link for link in robot.links)
        return described(replace(robot, links=links), *rest)  # type: ignore[arg-type]

    monkeypatch.setattr("stepbot.pipeline.translating.rendered", misread)
    conversion = convert(write_arm(tmp_path), options_of(tmp_path, "mjcf"))
    wrong = [one for one in conversion.diagnostics if one.severity == "error"]
    assert {one.code for one in wrong} >= {"SB803"}
    assert all("against arm.urdf" in one.message for one in wrong)


@pytest.mark.slow
def test_check_reads_the_source(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """`check` reports the losses of a conversion, and the missing package as an error."""
    path = write_arm(tmp_path)
    checked = check(path, options_of(tmp_path), diagnostics)
    assert (checked.links, checked.joints) == (4, 3)
    assert [row.name for row in checked.joint_table] == ["shoulder", "slide", "follower"]
    assert checked.joint_table[0].origin == (0.0, 0.0, 0.05)
    assert diagnostics.codes() == ["SB860"]
    lost = ReadDiagnostics()
    check(path, Options(tmp_path / "out"), lost)
    assert "SB861" in lost.codes()


def test_nothing_is_written_over_the_source(tmp_path: Path) -> None:
    """A conversion into the folder of its source is refused where a file would be replaced."""
    path = write_arm(tmp_path)
    conversion = convert(path, options_of(tmp_path, "urdf", verify=False)._replace(output=path.parent))
    assert [one.code for one in conversion.diagnostics if one.severity == "error"] == ["SB012"]
    assert path.read_text(encoding="utf-8") == ARM


BARE = """<link name="{0}"><inertial>
  <mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
</inertial></link>"""


def test_base_of_a_urdf_is_a_stated_guess(tmp_path: Path) -> None:
    """A URDF without a world link is converted as fixed with a warning, or as the option says without one."""
    path = tmp_path / "cart.urdf"
    path.write_text(f'<robot name="cart">{BARE.format("chassis")}</robot>', encoding="utf-8")
    bare = Options(tmp_path / "out", formats=("mjcf",), verify=False)
    guessed = convert(path, bare)
    assert [one.code for one in guessed.diagnostics] == ["SB874:base"]
    assert b"freejoint" not in guessed.files["cart.xml"]
    stated = convert(path, bare._replace(base="floating"))
    assert not list(stated.diagnostics)
    assert b"freejoint" in stated.files["cart.xml"]


def test_a_second_root_is_a_stated_guess(tmp_path: Path) -> None:
    """A link that no joint connects to the root is held in its place, with a warning: the file does not say so."""
    path = tmp_path / "carts.urdf"
    path.write_text(f'<robot name="carts">{BARE.format("one")}{BARE.format("two")}</robot>', encoding="utf-8")
    guessed = convert(path, Options(tmp_path / "out", formats=("mjcf",), verify=False, base="fixed"))
    (one,) = (one for one in guessed.diagnostics if one.severity == "warning")
    assert one.code == "SB874:base"
    assert one.message.startswith("link 'two' is not connected to 'one'")


@pytest.mark.slow
def test_thousands_of_loose_links_are_fixed_in_seconds(tmp_path: Path) -> None:
    """And those of cycles, which a joint of each is left out of."""
    path = tmp_path / "heap.urdf"
    joint = '<joint name="j{0}{1}" type="fixed"><parent link="{0}"/><child link="{1}"/></joint>'
    links = "".join(f'<link name="{name}"/>' for name in ("a", "b", "c", *range(2000)))
    cycle = joint.format("b", "c") + joint.format("c", "b")
    path.write_text(f'<robot name="heap">{links}{cycle}</robot>', encoding="utf-8")
    description, findings = describe_urdf(str(path)), list[Finding]()
    began = process_time()
    joints, _ = tree_of(description, findings)
    assert process_time() - began < 2.0
    assert [one.child for one in joints] == [*map(str, range(2000)), "b", "c"]
    assert len(findings) == 2001


@pytest.mark.slow
def test_missing_limits_are_reported_and_proven(tmp_path: Path) -> None:
    """A joint without bounds is unlimited; one missing bound is 0, also to engines that ignore the other one."""
    moving = """<joint name="{0}" type="{1}">
  <parent link="{2}"/><child link="{3}"/><axis xyz="0 0 1"/>{4}</joint>"""
    text = [BARE.format(link) for link in ("post", "wing", "bolt", "key")]
    text.append(moving.format("hinge", "revolute", "post", "wing", ""))
    text.append(moving.format("slide", "prismatic", "wing", "bolt", '<limit upper="0.2" effort="9" velocity="1"/>'))
    text.append(moving.format("turn", "revolute", "wing", "key", '<limit lower="-1" effort="9" velocity="1"/>'))
    path = tmp_path / "gate.urdf"
    path.write_text("<robot name='gate'>" + "\n".join(text) + "</robot>", encoding="utf-8")
    done = convert(path, Options(tmp_path / "out", formats=("mjcf",), base="fixed"))
    assert done.diagnostics.exit_code == 0, list(map(str, done.diagnostics))
    missing = [one for one in done.diagnostics if one.code == "SB874:limit"]
    lines = [number for number, line in enumerate(path.read_text().splitlines(), start=1) if "<joint" in line]
    assert [one.span.line for one in missing] == lines
    assert [one.message.rpartition(": ")[2] for one in missing] == ["read as unlimited", "0 taken", "0 taken"]
    assert [one.notes for one in missing] == [("ROS (urdfdom) rejects the file",), (), ()]
    written = mujoco.MjModel.from_xml_string(done.files["gate.xml"].decode())
    assert written.jnt_limited.tolist() == [0, 1, 1]
    assert written.joint("slide").range.tolist() == [0.0, 0.2]
    assert written.joint("turn").range.tolist() == [-1.0, 0.0]
    against = [one for one in done.report.checks if one.against.startswith("gate.urdf") and one.quantity == "limits"]
    assert [one.status for one in against] == ["passed"]


def test_a_limit_without_bounds_is_reported(tmp_path: Path) -> None:
    """PyBullet and MuJoCo turn such a joint, which does not move in ROS."""
    joint = '<joint name="hinge" type="revolute"><parent link="a"/><child link="b"/><limit effort="1" velocity="1"/>'
    text = f"<robot name='gate'>{BARE.format('a')}{BARE.format('b')}{joint}</joint></robot>"
    (tmp_path / "gate.urdf").write_text(text, encoding="utf-8")
    done = convert(tmp_path / "gate.urdf", Options(tmp_path / "out", verify=False, base="fixed"))
    (one,) = (one for one in done.diagnostics if one.code == "SB874:limit")
    assert one.message == "joint 'hinge': no 'lower' and 'upper' in <limit>: read as unlimited"
    assert one.notes == ("ROS (urdfdom) takes 0 for both: the joint cannot move",)


@pytest.mark.slow
def test_a_mesh_with_a_texture_is_read(tmp_path: Path) -> None:
    """The process that reads it has Pillow, which trimesh needs for coordinates of textures."""
    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    faces = [f"f {a}/1 {b}/1 {c}/1" for a, b, c in ((1, 3, 2), (1, 2, 4), (2, 3, 4), (3, 1, 4))]
    text = "\n".join(["mtllib looks.mtl", *lines, "vt 0.5 0.5", "usemtl skin", *faces, ""])
    (tmp_path / "part.obj").write_text(text, encoding="utf-8")
    shape = '<visual><geometry><mesh filename="part.obj"/></geometry></visual>'
    link = BARE.format("part").replace("</link>", f"{shape}</link>")
    (tmp_path / "part.urdf").write_text(f'<robot name="part">{link}</robot>', encoding="utf-8")
    done = convert(tmp_path / "part.urdf", Options(tmp_path / "out", formats=("mjcf",), verify=False, base="fixed"))
    assert done.diagnostics.exit_code == 0, list(map(str, done.diagnostics))
    assert [content.count(b"\nf ") for name, content in done.files.items() if name.endswith(".obj")] == [4]


@pytest.mark.long
@pytest.mark.pybullet
@pytest.mark.parametrize(
    ("name", "links"),
    [
        ("r2d2.urdf", 16),
        ("kuka_iiwa/model.urdf", 8),
        ("racecar/racecar.urdf", 13),
        ("franka_panda/panda.urdf", 13),
        ("a1/a1.urdf", 22),
    ],
)
def test_urdfs_of_others_convert_with_proof(name: str, links: int, tmp_path: Path) -> None:
    """Robots of pybullet_data convert to MJCF, SDFormat, OpenUSD, and engines find no difference from their URDFs."""
    data = pytest.importorskip("pybullet_data")
    conversion = convert(Path(data.getDataPath(), name), Options(tmp_path / "out", formats=("mjcf", "sdf", "usd")))
    assert conversion.diagnostics.exit_code == 0, list(map(str, conversion.diagnostics))
    assert conversion.report is not None
    assert len(conversion.robot.links if conversion.robot else ()) == links
    against = {check.file for check in conversion.report.checks if check.against.startswith(f"{Path(name).name} (")}
    assert len(against) == (3 if importlib.util.find_spec("pxr") else 2)  # usd-core reads OpenUSD
    assert not conversion.report.failed


def test_a_material_of_one_visual_is_one_of_the_file(tmp_path: Path) -> None:
    """Other links name it alone; a material that is never defined gives no colour."""
    shape = '<visual><geometry><box size="1 1 1"/></geometry><material name="{}">{}</material></visual>'
    red, named, odd = shape.format("red", '<color rgba="1 0 0 1"/>'), shape.format("red", ""), shape.format("odd", "")
    links = [f'<link name="{name}">{of}</link>' for name, of in (("a", red), ("b", named), ("c", odd))]
    joints = [f'<joint name="{x}" type="fixed"><parent link="a"/><child link="{x}"/></joint>' for x in "bc"]
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{"".join(links + joints)}</robot>', encoding="utf-8")
    shapes = describe_urdf(str(tmp_path / "r.urdf")).shapes
    assert [one.rgba for one in shapes] == [(1.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0), None]
