"""``stepbot diff`` and ``stepbot verify`` of robots: numbers that no engine reports, other names, files refused."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from stepbot.engines import engine_of
from stepbot.verification.text import OF_MESHES
from tests.simulators.conftest import skip_without

from .conftest import Stepbot

ARM = """<robot name="arm">
 <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
 <link name="{base}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="0.1 0.2 0.3"/></geometry><material name="grey"/></visual></link>
 <link name="{arm}"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
   <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin rpy="0.3 0 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
 <link name="{tool}"><inertial><mass value="0.5"/>
   <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <joint name="{elbow}" type="revolute"><parent link="{base}"/><child link="{arm}"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="5" velocity="2"/><dynamics damping="0.1" friction="0.2"/>
  <calibration rising="0.3"/><safety_controller k_velocity="10" soft_lower_limit="-0.9"/></joint>
 <joint name="{wrist}" type="continuous"><parent link="{arm}"/><child link="{tool}"/><origin xyz="0.3 0 0"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="3" velocity="4"/></joint>
</robot>
"""
NAMES = {"base": "base", "arm": "arm", "tool": "tool", "elbow": "elbow", "wrist": "wrist"}
OTHERS = {"base": "base_link", "arm": "panda_arm", "tool": "panda_tool", "elbow": "panda_elbow", "wrist": "panda_wrist"}


def _arm(path: Path, *changes: tuple[str, str], **names: str) -> str:
    text = ARM.format(**{**NAMES, **names})
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return str(path)


def _diff(stepbot: Stepbot, old: str, new: str) -> tuple[int, list[dict[str, object]]]:
    run = stepbot("diff", "--json", old, new)
    return run.code, json.loads(run.out)["differences"]


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('rpy="0.3 0 0"', 'rpy="-0.3 0 0"', "oblique box of collision"),
        ('rising="0.3"', 'rising="0.31"', "calibration@rising"),
        ('soft_lower_limit="-0.9"', 'soft_lower_limit="-0.8"', "safety_controller@soft_lower_limit"),
        ('lower="-2" upper="2"', 'lower="-3" upper="2"', "limit@lower"),
        ('rgba="0.5 0.5 0.5 1"', 'rgba="0.5 0.6 0.5 1"', "colour of visual"),
    ],
    ids=["turned", "calibration", "soft_limit", "limit_without_meaning", "colour_without_name"],
)
def test_diff_names_the_number(old: str, new: str, place: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """Also a number that no engine reports, and a turn within one bounding box."""
    skip_without("mujoco")
    files = _arm(tmp_path / "a.urdf"), _arm(tmp_path / "b.urdf", (old, new))
    code, rows = _diff(stepbot, *files)
    assert code == 1
    assert len(rows) == 1
    assert place in str(rows[0]["name"])


@pytest.mark.slow
@pytest.mark.mujoco
def test_the_same_file_is_equal(tmp_path: Path, stepbot: Stepbot) -> None:
    """A copy, and the file itself, have no differences."""
    skip_without("mujoco")
    first, copy = _arm(tmp_path / "a.urdf"), _arm(tmp_path / "b.urdf")
    assert _diff(stepbot, first, copy) == (0, [])
    assert _diff(stepbot, first, first) == (0, [])


@pytest.mark.slow
@pytest.mark.mujoco
def test_other_names_are_paired_by_structure(tmp_path: Path, stepbot: Stepbot) -> None:
    """Numbers are compared under other names of links and joints, and each pair is listed."""
    skip_without("mujoco")
    files = _arm(tmp_path / "a.urdf"), _arm(tmp_path / "b.urdf", ('value="2"', 'value="7"'), **OTHERS)
    code, rows = _diff(stepbot, *files)
    assert code == 1
    renamed = {str(row["name"]): row["new_name"] for row in rows if row["kind"] == "renamed"}
    assert renamed == {NAMES[key]: OTHERS[key] for key in NAMES}
    masses = [row for row in rows if row["kind"] == "mass"]
    assert [(row["name"], row["old"], row["new"]) for row in masses] == [("mass of link 'arm'", 2.0, 7.0)]
    run = stepbot("verify", *files)
    assert run.code == 1
    assert "link 'base' is named 'base_link', paired by structure" in run.err + run.out
    assert "mass of link 'arm'" in run.err + run.out


MESH = """<mujoco><asset><mesh name="m" file="{mesh}"/></asset><worldbody><body name="b">
<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/><joint name="j" axis="{axis}"/><geom type="mesh" mesh="m"/>
</body></worldbody></mujoco>"""


@pytest.mark.slow
@pytest.mark.mujoco
def test_a_refused_file_is_not_equal(tmp_path: Path, stepbot: Stepbot) -> None:
    """A file that an engine refuses, and what was not compared, end in code 2 with the reason."""
    skip_without("mujoco")
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    old, new = tmp_path / "a.xml", tmp_path / "b.xml"
    old.write_text(MESH.format(mesh="m.obj", mass=1, axis="0 0 1"))
    new.write_text(MESH.format(mesh="gone.obj", mass=7, axis="0 1 0"))
    for first, second in ((old, new), (new, old), (new, new)):
        run = stepbot("diff", str(first), str(second))
        assert run.code == 2
        assert "gone.obj" in run.err
        assert f"no differences between {first}" not in run.out


def test_a_file_that_no_engine_reads_is_named(tmp_path: Path, stepbot: Stepbot) -> None:
    """A model with two roots and relative poses is read by no engine of the core install, and refused by Drake."""
    links = "<link name='a'/><link name='b'><pose relative_to='a'>1 0 0 0 0 0</pose></link>"
    path = tmp_path / "two.sdf"
    path.write_text(f"<sdf version='1.9'><model name='m'>{links}</model></sdf>")
    run = stepbot("diff", str(path), str(path))
    assert run.code == 2
    assert ("SB815" if importlib.util.find_spec("pydrake") is None else "SB801") in run.err
    assert "2 root links" in run.err or "only validates files" in run.err  # libsdformat's command, if installed


@pytest.mark.slow
@pytest.mark.parametrize("old", ['<child link="{tool}"/>', '<parent link="{arm}"/>'])
def test_a_joint_to_a_link_that_is_missing(old: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """Engines that read such a file are no reason for an internal error, whichever of two files it is."""
    paths = [
        _arm(tmp_path / "sound.urdf"),
        _arm(tmp_path / "main.urdf", (old.format(**NAMES), old.format(arm="x", tool="x"))),
    ]
    for pair in (paths, paths[::-1]):
        run = stepbot("diff", *pair)
        assert run.code in (1, 2)
        assert "SB901" not in run.err


@pytest.mark.slow
@pytest.mark.mujoco
def test_diff_quotes_texts_with_commas(tmp_path: Path, stepbot: Stepbot) -> None:
    """Where the old text ends is not guessed from what it has in it."""
    skip_without("mujoco")
    old = _arm(tmp_path / "old.urdf", ("k_velocity", 'note="a, b expected" k_velocity'))
    new = _arm(tmp_path / "new.urdf", ("k_velocity", 'note="c, d" k_velocity'))
    code, rows = _diff(stepbot, old, new)
    assert code == 1
    assert [row["name"] for row in rows] == [
        "robot/joint 'elbow'/safety_controller@note: 'c, d', formerly 'a, b expected'"
    ]


@pytest.mark.slow
@pytest.mark.mujoco
def test_robots_without_masses_are_compared(tmp_path: Path, stepbot: Stepbot) -> None:
    """A robot of frames alone has no centre of mass to compare."""
    skip_without("mujoco")
    frames = """<robot name="frames"><link name="a"/><link name="b"/>
      <joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="5" velocity="2"/></joint></robot>"""
    for name in ("old.urdf", "new.urdf"):
        (tmp_path / name).write_text(frames)
    assert _diff(stepbot, str(tmp_path / "old.urdf"), str(tmp_path / "new.urdf")) == (0, [])


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize("command", ["diff", "verify"])
def test_words_that_no_engine_reports_are_compared(command: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """Two files of one robot that are simulated by other integrators."""
    skip_without("mujoco")
    text = """<mujoco model="arm"><option{}/><worldbody><body name="a"><inertial pos="0 0 0" mass="1"
      diaginertia="1 1 1"/><joint name="j" axis="0 0 1"/></body></worldbody></mujoco>"""
    paths = [tmp_path / f"{number}.xml" for number in range(3)]
    for path, integrator in zip(paths, ("", ' integrator="Euler"', ' integrator="RK4"'), strict=True):
        path.write_text(text.format(integrator))
    same, other = (stepbot(command, str(paths[0]), str(path)) for path in paths[1:])
    assert same.code == 0
    assert other.code == 1
    assert "option@integrator" in other.out + other.err


_SDF = """<sdf version="1.9"><model name="m"><link name="a"><inertial><mass>1</mass><inertia><ixx>1</ixx>
<iyy>1</iyy><izz>1</izz></inertia></inertial></link>{}</model></sdf>"""
_FRAME = '<frame name="{}" attached_to="a"><pose>0 0 {} 0 0 0</pose></frame>'


def test_a_shape_without_size_is_a_difference(
    tmp_path: Path, stepbot: Stepbot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where engines that reject such a file are not there, the reader reports that there is a shape, and no size."""
    monkeypatch.setattr("stepbot.engines.workers.engines_for", lambda _: (engine_of("reader"),))
    paths = [tmp_path / name for name in ("old.sdf", "new.sdf")]
    for path, box in zip(paths, ("<box><size>1 2 3</size></box>", ""), strict=True):
        visual = f'<visual name="v"><geometry>{box}</geometry></visual></link>'
        path.write_text(_SDF.format("").replace("</link>", visual), encoding="utf-8")
    code, rows = _diff(stepbot, *map(str, paths))
    assert code == 1
    assert [row["name"] for row in rows] == ["size of the visual of link 'a' is missing"]


@pytest.mark.parametrize("other", ["", _FRAME.format("wrist", 1), _FRAME.format("tool", 1) + _FRAME.format("wrist", 1)])
def test_a_frame_of_one_file_is_a_difference(other: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """One that is missing, renamed, or new: programs look for frames by their names."""
    paths = [tmp_path / name for name in ("old.sdf", "new.sdf")]
    for path, frames in zip(paths, (_FRAME.format("tool", 1), other), strict=True):
        path.write_text(_SDF.format(frames), encoding="utf-8")
    code, rows = _diff(stepbot, *map(str, paths))
    assert code == 1
    names = {"tool", "wrist"} if "wrist" in other else {"tool"}
    assert {str(row["name"]).split("'")[1] for row in rows} == names - ({"tool"} if "tool" in other else set())
    assert {row["kind"] for row in rows} == {"frames"}


_PLAIN = """<mujoco model="r"><compiler{0}/><option{1}/><visual><map{2}/></visual><worldbody>
  <body name="base"{3}><geom name="g" size="0.1"{4}/><body name="b" pos="0 0 0.3">
  <joint name="j" axis="0 0 1" range="-85 60"{5}/><geom name="h" size="0.04"/></body></body></worldbody>
  <actuator><motor name="m" joint="j" ctrlrange="-1 1"{6}/></actuator></mujoco>"""
_STATED = (
    ' autolimits="true"',
    ' cone="pyramidal" gravity="0 0 -9.81"',
    ' znear="0.01"',
    ' gravcomp="0" mocap="false" quat="-1 0 0 0"',
    ' solmix="1" gap="0"',
    ' solreflimit="0.02 1"',
    ' group="0"',
)
"""What MuJoCo takes where nothing is stated."""
_GIVEN = (
    "",
    ' cone="elliptic"',
    ' znear="0.02"',
    ' gravcomp="0.5"',
    ' gap="0.001"',
    ' solreflimit="0.03 1"',
    ' group="1"',
)
"""The same attributes with other values, of those that change what MuJoCo does or shows."""


@pytest.mark.slow
@pytest.mark.mujoco
def test_a_stated_default_of_mjcf_is_no_difference(tmp_path: Path, stepbot: Stepbot) -> None:
    """MuJoCo compiles both files: what it cannot tell apart is the same, and each other value alone is a difference."""
    skip_without("mujoco")
    bare = tmp_path / "bare.xml"
    bare.write_text(_PLAIN.format(*[""] * len(_STATED)), encoding="utf-8")
    for number, given in enumerate(_GIVEN):
        stated = tmp_path / f"{number}.xml"
        stated.write_text(_PLAIN.format(*_STATED[:number], given, *_STATED[number + 1 :]), encoding="utf-8")
        code, rows = _diff(stepbot, str(bare), str(stated))
        attribute = given.partition("=")[0].strip()
        assert code == (1 if given else 0), given
        texts = [str(row["name"]) for row in rows if row["kind"] == "text"]
        assert [attribute in text for text in texts] == [True] * bool(given), rows


@pytest.mark.slow
def test_a_stated_default_of_sdformat_is_no_difference(tmp_path: Path, stepbot: Stepbot) -> None:
    """Elements that stepbot does not read, with what SDFormat takes where they are missing, and with another value."""
    skip_without("pybullet")
    text = """<sdf version="1.9"><model name="r">{0}<link name="base">{1}<inertial><mass>1</mass>
      <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
      <visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry>{2}</visual></link></model></sdf>"""
    stated = ("<self_collide>false</self_collide>", "<kinematic>0</kinematic>", "<cast_shadows>true</cast_shadows>")
    given = ("<self_collide>true</self_collide>", "<kinematic>1</kinematic>", "<cast_shadows>0</cast_shadows>")
    bare, other = tmp_path / "bare.sdf", tmp_path / "other.sdf"
    bare.write_text(text.format("", "", ""), encoding="utf-8")
    for number in range(-1, len(given)):
        words = stated if number < 0 else [one if n == number else "" for n, one in enumerate(given)]
        other.write_text(text.format(*words), encoding="utf-8")
        code, _ = _diff(stepbot, str(bare), str(other))
        assert code == (0 if words == stated else 1), words


@pytest.mark.slow
@pytest.mark.mujoco
def test_an_effort_that_means_unlimited_is_none(tmp_path: Path, stepbot: Stepbot) -> None:
    """As stepbot states it where a file has none; another number of that size is another text."""
    skip_without("mujoco")
    none = _arm(tmp_path / "a.urdf", (' effort="3"', ""))
    stated = _arm(tmp_path / "b.urdf", ('effort="3"', 'effort="1e9"'))
    larger = _arm(tmp_path / "c.urdf", ('effort="3"', 'effort="2e9"'))
    assert [_diff(stepbot, none, other)[0] for other in (stated, larger)] == [0, 0]
    assert _diff(stepbot, stated, larger)[0] == 1


@pytest.mark.slow
@pytest.mark.mujoco
def test_a_warning_hides_no_difference(tmp_path: Path, stepbot: Stepbot) -> None:
    """MuJoCo warns of both files that an attribute is deprecated; what no engine reports is compared all the same."""
    skip_without("mujoco")
    text = _PLAIN.format(' settotalmass="14"', ' timestep="{0}"', "", "", "", "", "")
    old, new = tmp_path / "old.xml", tmp_path / "new.xml"
    old.write_text(text.format("0.01"), encoding="utf-8")
    new.write_text(text.format("0.0101"), encoding="utf-8")
    assert [_diff(stepbot, str(old), str(other))[0] for other in (old, new)] == [0, 1]


@pytest.mark.slow
@pytest.mark.mujoco
def test_what_an_mjcf_includes_is_compared(tmp_path: Path, stepbot: Stepbot) -> None:
    """As what it states itself: a number that no engine reports, the surface of a mesh. Includes are no difference."""
    skip_without("mujoco")
    part = """<mujoco><visual><headlight diffuse=".8 .8 {0}"/></visual>
      <asset><mesh name="ball" file="{1}.obj"/></asset></mujoco>"""
    arm = """<mujoco>{0}<worldbody><body><joint name="turn"/><geom size=".1"/>
      <geom type="mesh" mesh="ball" mass="0" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.export(tmp_path / "ball.obj")
    ball.vertices[np.argsort(np.abs(ball.vertices).max(axis=1))[:40]] *= 0.97  # within the same box
    ball.export(tmp_path / "dent.obj")
    for name, numbers in {"old": (".8", "ball"), "light": (".9", "ball"), "dent": (".8", "dent")}.items():
        (tmp_path / f"part_{name}.xml").write_text(part.format(*numbers), encoding="utf-8")
        (tmp_path / f"{name}.xml").write_text(arm.format(f'<include file="part_{name}.xml"/>'), encoding="utf-8")
    whole = part.format(".8", "ball").replace("<mujoco>", "").replace("</mujoco>", "")
    (tmp_path / "whole.xml").write_text(arm.format(whole), encoding="utf-8")
    found = {
        name: _diff(stepbot, str(tmp_path / "old.xml"), str(tmp_path / f"{name}.xml"))[0]
        for name in ("old", "whole", "light", "dent")
    }
    assert found == {"old": 0, "whole": 0, "light": 1, "dent": 1}


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize("command", ["diff", "verify"])
def test_surroundings_are_no_robot(command: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """An MJCF without bodies is rejected."""
    skip_without("mujoco")
    for name in ("a.xml", "b.xml"):
        (tmp_path / name).write_text(
            "<mujoco><worldbody><geom type='plane' size='1 1 1'/></worldbody></mujoco>", "utf-8"
        )
    run = stepbot(command, str(tmp_path / "a.xml"), str(tmp_path / "b.xml"))
    assert run.code in (1, 2)
    assert "the file has no bodies" in run.err
    assert "SB901" not in run.err


@pytest.mark.slow
@pytest.mark.mujoco
def test_an_engine_that_crashes_ends_no_comparison(tmp_path: Path, stepbot: Stepbot) -> None:
    """PyBullet ends in an abort over a joint limited by its defaults and without range; MuJoCo reports all of both."""
    skip_without("mujoco")
    skip_without("pybullet")
    text = """<mujoco><default><joint limited="true" range="-9 9"/></default><worldbody><body name="a">
      <geom size="0.1"/><body name="b"><joint name="j"/><geom size="0.1" mass="{}"/></body></body></worldbody>
      </mujoco>"""
    old, new = tmp_path / "old.xml", tmp_path / "new.xml"
    for path, mass in ((old, 1), (new, 2)):
        path.write_text(text.format(mass), encoding="utf-8")
    for other, code in ((old, 0), (new, 1)):
        run = stepbot("diff", str(old), str(other))
        assert run.code == code
        assert "SB815" in run.err
        assert "not compared in pybullet, only in mujoco" in run.err
        assert ("mass of link 'b'" in run.out) == (other is new)


DENTED = """v 0 0 0
v 0.1 0 0
v 0.1 0.1 0
v 0 0.1 0
v 0 0 0.1
v 0.1 0 0.1
v 0.1 0.1 0.1
v 0 0.1 0.1
v 0.05 0.05 {depth}
f 1 4 3 2
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
f 5 6 9
f 6 7 9
f 7 8 9
f 8 5 9
"""
"""A cube of 0.1 m with a dent in its upper face, which no box around it shows."""
MESHED = {
    "urdf": """<robot name="dented"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual name="seen"><geometry><mesh filename="dented.obj"/></geometry></visual></link></robot>""",
    "sdf": """<sdf version="1.9"><model name="dented"><link name="base"><inertial><mass>1</mass>
<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
<visual name="seen"><geometry><mesh><uri>dented.obj</uri></mesh></geometry></visual></link></model></sdf>""",
    "xml": """<mujoco model="dented"><compiler meshdir="."/><asset><mesh name="dented" file="dented.obj"/></asset>
<worldbody><body name="base"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<geom name="seen" type="mesh" mesh="dented" contype="0" conaffinity="0" group="2"/></body></worldbody></mujoco>""",
}


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize("suffix", MESHED)
def test_a_mesh_within_the_same_box_is_a_difference(suffix: str, tmp_path: Path, stepbot: Stepbot) -> None:
    """A vertex that moves by a tenth of a millimetre is named; one that is rounded to single precision is not."""
    for name, depth in (("old", "0.06"), ("rounded", "0.0600000002"), ("new", "0.0601")):
        (tmp_path / name).mkdir()
        (tmp_path / name / f"dented.{suffix}").write_text(MESHED[suffix], encoding="utf-8")
        (tmp_path / name / "dented.obj").write_text(DENTED.format(depth=depth), encoding="utf-8")
    old, rounded, new = (str(tmp_path / name / f"dented.{suffix}") for name in ("old", "rounded", "new"))
    assert _diff(stepbot, old, rounded) == (0, [])
    code, found = _diff(stepbot, old, new)
    assert code == 1
    assert {str(one["name"]).partition(",")[0].rpartition("@")[2] for one in found} == {*OF_MESHES}
    assert stepbot("verify", old, new).code == 1


_ON_WORLD = """<link name="world"/>
 <joint name="mount" type="{}"><parent link="world"/><child link="base"/>{}</joint></robot>"""


@pytest.mark.slow
@pytest.mark.mujoco
@pytest.mark.parametrize(
    ("kind", "origin", "place"),
    [
        ("fixed", '<origin xyz="0 0 0"/>', ""),
        ("fixed", '<origin xyz="0 0 0.1"/>', "robot/joint 'mount'/origin@xyz, number 3"),
        ("fixed", '<origin rpy="0 0.2 0"/>', "robot/joint 'mount'/origin@rpy, number 2"),
        ("floating", "", "robot/joint 'mount'@type: 'floating'"),
    ],
)
def test_the_joint_on_the_world_is_compared(
    kind: str, origin: str, place: str, tmp_path: Path, stepbot: Stepbot
) -> None:
    """A base stands elsewhere, or moves freely: engines report neither of a URDF; all see one robot in each file."""
    skip_without("mujoco")
    old = _arm(tmp_path / "a.urdf", ("</robot>", _ON_WORLD.format("fixed", "")))
    new = _arm(tmp_path / "b.urdf", ("</robot>", _ON_WORLD.format(kind, origin)))
    assert stepbot("verify", new).code == 0
    code, rows = _diff(stepbot, old, new)
    assert code == bool(place)
    assert any(place in str(row["name"]) for row in rows) == bool(place)
