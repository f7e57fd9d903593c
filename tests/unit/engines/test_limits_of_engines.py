"""What engines cannot hold is no fault of a file, and ends no comparison."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engine_of
from stepbot.engines.description.statements import statements
from stepbot.engines.observation import EngineCannotRead, EngineRefused, Request
from stepbot.geometry.spatial import IDENTITY
from stepbot.report.robot import Status
from stepbot.robot.model import JointKind, LoopClosure
from stepbot.verification.files import verify_files

_BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


@pytest.mark.parametrize("file", ["r.sdf", "r.urdf", "r.xml"])
def test_statements_of_deeply_nested_elements(file: str, tmp_path: Path) -> None:
    """They are listed in the order of the file, however deep they are."""
    path = tmp_path / file
    path.write_text("<sdf>" + "<x a='1'>" * 2000 + "</x>" * 2000 + "<y a='2'/></sdf>", encoding="utf-8")
    found = statements(path, {"sdf": "sdf", "urdf": "urdf", "xml": "mjcf"}[path.suffix[1:]])
    assert [one.value for one in found] == ["1"] * 2000 + ["2"]


@pytest.mark.pybullet
@pytest.mark.parametrize("count", [127, 128])
def test_joints_that_pybullet_can_have(count: int, tmp_path: Path) -> None:
    """It reports the state of 127: a robot with more is not read, with the reason, and not refused."""
    links = [f'<link name="l{n}">{_BODY}</link>\n' for n in range(count + 1)]
    joints = (
        f'<joint name="j{n}" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/></joint>\n' for n in range(count)
    )
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r">{"".join(links)}{"".join(joints)}</robot>', encoding="utf-8")
    request = Request(str(path), "urdf", configurations=({},), simulate=0.0)
    if count == 127:
        assert len(engine_of("pybullet").observer.observe(request).links) == count + 1
        return
    with pytest.raises(EngineCannotRead, match="at most 127 joints, the file has 128"):
        engine_of("pybullet").observer.observe(request)


@pytest.mark.pybullet
def test_depth_that_pybullet_can_read(tmp_path: Path) -> None:
    """Its parser for MJCF gives up on deep bodies, which MuJoCo reads."""
    path = tmp_path / "r.xml"
    path.write_text(f"<mujoco><worldbody>{'<body>' * 600}{'</body>' * 600}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(EngineCannotRead, match="nested so deeply"):
        engine_of("pybullet").observer.observe(Request(str(path), "mjcf"))


def test_links_that_mujoco_cannot_have(tmp_path: Path) -> None:
    """An MJCF is rejected, with the bound and what helps; a URDF, which other engines read, is not read by MuJoCo."""
    path, body = tmp_path / "r.xml", '<inertial pos="0 0 0" mass="1e-9" fullinertia="1e-15 1e-15 1e-15 0 0 0"/>'
    path.write_text(f"<mujoco><worldbody><body>{body}<joint/></body></worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(EngineRefused, match=r"1e-14 kg m\^2\nhelp: check the length unit .* leave out MJCF"):
        engine_of("mujoco").observer.observe(Request(str(path), "mjcf"))
    verify_files([path], diagnostics := Diagnostics())
    assert "check the length unit" in [one.help[0][:21] for one in diagnostics if one.code == "SB801"]

    small = _BODY.replace('"1"', '"1e-15"').replace('mass value="1e-15"', 'mass value="1e-9"')
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
    links = f'<link name="a">{small}</link><link name="b">{small}</link>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{joint}</robot>', encoding="utf-8")
    with pytest.raises(EngineCannotRead, match="below 1e-15 kg or 1e-14 kg m"):
        engine_of("mujoco").observer.observe(Request(str(tmp_path / "r.urdf"), "urdf"))


def test_light_links_in_a_gimbal(tmp_path: Path) -> None:
    """Near its lock, MuJoCo cannot invert the mass matrix of a fly's leg: a note for a URDF, which has no armature."""
    small = _BODY.replace('"1"', '"2e-14"').replace('mass value="2e-14"', 'mass value="1e-9"')
    links = f'<link name="l0">{_BODY}</link>' + "".join(
        f'<link name="l{n}">{small * (n == 3)}</link>' for n in (1, 2, 3)
    )
    joints = "".join(
        f'<joint name="j{n}" type="continuous"><parent link="l{n - 1}"/><child link="l{n}"/>'
        f'<axis xyz="{axis}"/></joint>'
        for n, axis in enumerate(("0 0 1", "0 1 0", "1 0 0"), 1)
    )
    (path := tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    request = Request(str(path), "urdf", configurations=({"j1": 0.0, "j2": 1.5707, "j3": 0.0},), simulate=0.0)
    seen = engine_of("mujoco").observer.observe(request)
    assert seen.warnings == ()
    assert any("armature" in note for note in seen.notes)


def test_closure_between_links_that_do_not_move(tmp_path: Path) -> None:
    """There is nothing to solve for, and the gap is measured."""
    path = tmp_path / "r.xml"
    bodies = "".join(f'<body name="{name}"><geom size="0.1"/></body>' for name in "ab")
    bodies += '<body><geom size="0.1"/><joint name="driven"/></body>'
    weld = '<equality><connect name="c" body1="a" body2="b" anchor="0 0 0"/></equality>'
    path.write_text(f"<mujoco><worldbody>{bodies}</worldbody>{weld}</mujoco>", encoding="utf-8")
    wanted = LoopClosure("c", JointKind.BALL, "a", IDENTITY, "b", IDENTITY)
    request = Request(str(path), "mjcf", closures=(wanted,), ways=(({},),), driven=("driven",), simulate=0.0)
    (closure,) = engine_of("mujoco").observer.observe(request).closures
    assert closure.residual == pytest.approx(0.0, abs=1e-12)
    assert closure.angle_error == 0.0


_ARM = f"""<robot name="r"><link name="base">{_BODY}</link><link name="arm">{_BODY}</link>
<link name="pad"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link><link name="tool"/>
<joint name="slide" type="prismatic"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit {{bounds}} effort="5" velocity="2"/></joint>
<joint name="weld" type="fixed"><parent link="arm"/><child link="pad"/><origin xyz="0 0 0.1"/></joint>
<joint name="tcp" type="fixed"><parent link="pad"/><child link="tool"/></joint></robot>"""
_BOUNDS = {
    "lower only": ('lower="-0.2"', (-0.2, 0.0)),
    "upper only": ('upper="0.2"', (0.0, 0.2)),
    "equal": ('lower="0.1" upper="0.1"', (0.1, 0.1)),
    "both 0": ('lower="0" upper="0"', (0.0, 0.0)),
}


@pytest.mark.slow
@pytest.mark.pybullet
@pytest.mark.mujoco
@pytest.mark.parametrize("kind", ["prismatic", "revolute"])
@pytest.mark.parametrize("case", _BOUNDS)
def test_what_urdf_defines_is_the_same_in_every_engine(case: str, kind: str, tmp_path: Path) -> None:
    """A bound that is missing beside another is 0, equal bounds are bounds, and a link without inertial has no mass."""
    text, expected = _BOUNDS[case]
    path = tmp_path / "r.urdf"
    path.write_text(_ARM.format(bounds=text).replace("prismatic", kind), encoding="utf-8")
    diagnostics = Diagnostics()
    report = verify_files([path], diagnostics)
    reported = {name for name in ("mujoco", "pybullet", "yourdfpy") if engine_of(name).available() is None}
    assert not [str(one) for one in diagnostics if one.severity == "error"]
    assert reported <= {check.engine for check in report.checks if check.status is Status.PASSED}
    seen = {name: engine_of(name).observer.observe(Request(str(path), "urdf", simulate=0.0)) for name in reported}
    slides = {name: joint for name, one in seen.items() for joint in one.joints if joint.name == "slide"}
    limits = {name: joint.limit for name, joint in slides.items() if joint.limit and "lower" in joint.limit_fields}
    assert {(limit.lower, limit.upper) for limit in limits.values()} == {expected}
    assert limits.keys() == reported - ({"mujoco"} if expected[0] == expected[1] else set())
    if "pybullet" in reported:
        warned = [str(one) for one in diagnostics if "PyBullet takes 1 kg" in str(one)]
        assert len(warned) == 1
        assert "compared with 0: pad, tool" in warned[0]
        assert {link.name: link.mass for link in seen["pybullet"].links} == {"base": 1, "arm": 1, "pad": 0, "tool": 0}


@pytest.mark.mujoco
def test_equal_bounds_of_a_joint_that_has_none(tmp_path: Path) -> None:
    """The exporter of SolidWorks writes bounds of 0 for a continuous joint, too, which remains one."""
    path = tmp_path / "r.urdf"
    path.write_text(_ARM.format(bounds='lower="0" upper="0"').replace("prismatic", "continuous"), encoding="utf-8")
    seen = engine_of("mujoco").observer.observe(Request(str(path), "urdf", simulate=0.0))
    assert next(joint.kind for joint in seen.joints if joint.name == "slide") == "continuous"


@pytest.mark.parametrize("rgba", ["1.2 0.4 0.6 1", "255 128 0 1", "0.5 0.5 0.5 1"])
def test_colours_that_yourdfpy_cannot_have(rgba: str, tmp_path: Path) -> None:
    """It converts them to bytes: other engines read such a file, and are compared."""
    material = f'<material name="m"><color rgba="{rgba}"/></material>'
    visual = f'<visual><geometry><sphere radius="1"/></geometry>{material}</visual>'
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r"><link name="base">{visual}</link></robot>', encoding="utf-8")
    request = Request(str(path), "urdf", configurations=({},), simulate=0.0)
    if rgba.startswith("0"):
        assert engine_of("yourdfpy").observer.observe(request).links[0].visuals[0].rgba == (0.5, 0.5, 0.5, 1.0)
        return
    with pytest.raises(EngineCannotRead, match="no colours outside of 0 to 1"):
        engine_of("yourdfpy").observer.observe(request)


@pytest.mark.pybullet
def test_colours_of_materials_without_a_name(tmp_path: Path) -> None:
    """As SolidWorks exports them: each visual has its own colour, and none that of another one."""
    colours = ("0.79 0.82 0.93 1", "1 0 0 1", "0 0.5 0 1")
    visual = (
        '<visual><geometry><sphere radius="1"/></geometry><material name=""><color rgba="{1}"/></material></visual>'
    )
    link = f'<link name="l{{0}}">{_BODY}{visual}</link>'
    joint = '<joint name="j{0}" type="continuous"><parent link="l0"/><child link="l{0}"/></joint>'
    text = "".join(link.format(number, rgba) for number, rgba in enumerate(colours))
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r">{text}{joint.format(1)}{joint.format(2)}</robot>', encoding="utf-8")
    request = Request(str(path), "urdf", configurations=({},), simulate=0.0)
    expected = {f"l{number}": tuple(map(float, rgba.split())) for number, rgba in enumerate(colours)}
    for name in ("pybullet", "yourdfpy"):  # MuJoCo's observer reports none for URDF
        if engine_of(name).available() is None:
            seen = {link.name: link.visuals[0].rgba for link in engine_of(name).observer.observe(request).links}
            assert {key: pytest.approx(rgba, abs=1e-6) for key, rgba in expected.items()} == seen, name


def test_meshes_in_ascii_that_mujoco_does_not_read(tmp_path: Path) -> None:
    """It reads STL in binary alone: a URDF with another is compiled from a copy, as one with Collada is."""
    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    facets = [[corners[n] for n in face] for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    lines = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*one) for one in facet)
        + "endloop\nendfacet\n"
        for facet in facets
    )
    (tmp_path / "m.stl").write_text(f"solid m\n{lines}endsolid m\n", encoding="ascii")
    shape = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>'
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r"><link name="base">{_BODY}{shape}</link></robot>', encoding="utf-8")
    seen = engine_of("mujoco").observer.observe(Request(str(path), "urdf", configurations=({},), simulate=0.0))
    bounds = seen.links[0].collision_bounds
    assert bounds is not None
    assert [*bounds[0], *bounds[1]] == pytest.approx([0, 0, 0, 1, 1, 1], abs=1e-6)
    assert any(".stl" in note for note in seen.notes)
