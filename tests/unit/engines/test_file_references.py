"""Files with references that engines must not follow are rejected before any engine reads them."""

import os
from pathlib import Path

import pytest

from stepbot.engines.description.statements import mesh_hash
from stepbot.engines.file_references import refusals
from stepbot.engines.observation import EngineCannotRead
from stepbot.engines.sdformat_reader.tree import read_model
from stepbot.engines.xml import xml_root

pipes = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")


def codes(path: Path, text: str, written_in: str) -> list[str]:
    """The codes of a file with this text."""
    path.write_text(text, encoding="utf-8")
    return [one.code for one in refusals(str(path), written_in)]


def test_entities_are_refused_before_they_are_expanded(tmp_path: Path) -> None:
    """An entity bomb of a gigabyte is rejected by its declaration; a DOCTYPE without entities is accepted."""
    entities = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    bomb = f'<!DOCTYPE robot [<!ENTITY e0 "x">{entities}]><robot name="r"><link name="&e9;"/></robot>'
    assert codes(tmp_path / "bomb.urdf", bomb, "urdf") == ["SB820"]
    assert codes(tmp_path / "plain.urdf", '<!DOCTYPE robot><robot name="r"/>', "urdf") == []


def test_includes_stay_in_the_folder(tmp_path: Path) -> None:
    """Includes in the folder and below are read, also nested ones; those outside are rejected."""
    inside = tmp_path / "scene"
    (inside / "parts").mkdir(parents=True)
    (tmp_path / "outside.xml").write_text("<mujoco/>", encoding="utf-8")
    (inside / "near.xml").write_text("<mujoco/>", encoding="utf-8")
    (inside / "parts" / "far.xml").write_text('<mujoco><include file="../outside.xml"/></mujoco>', encoding="utf-8")
    (inside / "circle.xml").write_text('<mujoco><include file="circle.xml"/></mujoco>', encoding="utf-8")

    def including(name: str) -> list[str]:
        return codes(inside / "scene.xml", f'<mujoco><worldbody><include file="{name}"/></worldbody></mujoco>', "mjcf")

    assert including("near.xml") == []
    assert including("circle.xml") == []
    assert including("missing.xml") == []
    assert including("../outside.xml") == ["SB820"]
    assert including(str(tmp_path / "outside.xml")) == ["SB820"]
    assert refusals(str(inside / "scene.xml"), "mjcf", [tmp_path]) == ()  # the user names the folder
    assert including("parts/far.xml") == ["SB820"]


def test_attached_models_are_read_as_includes_are(tmp_path: Path) -> None:
    """A model that is attached stays in the folder, and so does what it includes, from its own folder."""
    inside = tmp_path / "scene"
    (inside / "arm").mkdir(parents=True)
    (tmp_path / "outside.xml").write_text("<mujoco/>", encoding="utf-8")
    (inside / "arm" / "near.xml").write_text("<mujoco/>", encoding="utf-8")
    (inside / "arm" / "arm.xml").write_text('<mujoco><include file="near.xml"/></mujoco>', encoding="utf-8")
    (inside / "arm" / "far.xml").write_text('<mujoco><include file="../../outside.xml"/></mujoco>', encoding="utf-8")
    (inside / "arm" / "self.xml").write_text(
        '<mujoco><asset><model name="m" file="self.xml"/></asset></mujoco>', encoding="utf-8"
    )

    def attaching(name: str) -> list[str]:
        text = f'<mujoco><asset><model name="m" file="{name}"/></asset></mujoco>'
        return codes(inside / "scene.xml", text, "mjcf")

    assert attaching("arm/arm.xml") == []
    assert attaching("arm/self.xml") == ["SB820"]
    assert attaching("scene.xml") == ["SB820"]
    assert attaching("../outside.xml") == ["SB820"]
    assert attaching("arm/far.xml") == ["SB820"]


OUTSIDE = b'<include file="../outside.xml"/>'


@pytest.mark.parametrize(
    "text",
    [
        b"<mujoco><!-- \xff -->" + OUTSIDE + b"</mujoco>",
        b"<mujoco>" + OUTSIDE + b"</mujoco><more/>",
        b"<mujoco a='1' a='2'>" + OUTSIDE + b"</mujoco>",
        b"<?xml version='1.0' encoding='iso-2022-jp'?><mujoco><!-- \x1b$B-->" + OUTSIDE + b"<!--\x1b(B --></mujoco>",
    ],
    ids=["bytes that are not UTF-8", "two roots", "an attribute twice", "tags that are Japanese"],
)
def test_file_that_our_parser_reads_otherwise_reaches_no_engine(text: bytes, tmp_path: Path) -> None:
    """MuJoCo and PyBullet read what is not XML, or declares another encoding, and would open the includes in it."""
    (tmp_path / "in").mkdir()
    (tmp_path / "outside.xml").write_text("<mujocoinclude/>", encoding="utf-8")
    main, part = tmp_path / "in" / "main.xml", tmp_path / "in" / "part.xml"
    main.write_bytes(text)
    assert {one.code for one in refusals(str(main), "mjcf")} == {"SB814"}
    part.write_bytes(text)
    assert codes(main, '<mujoco><include file="part.xml"/></mujoco>', "mjcf") == ["SB814"]


def test_latin_1_and_deep_trees_are_read(tmp_path: Path) -> None:
    """Encodings of which ASCII is a part, trees deeper than lxml's limit, and prefixes without a namespace are read."""
    path = tmp_path / "latin.xml"
    path.write_bytes("<?xml version='1.0' encoding='ISO-8859-1'?><mujoco model='Fuß'/>".encode("latin-1"))
    assert refusals(str(path), "mjcf") == ()
    assert codes(tmp_path / "deep.xml", "<mujoco>" + 1000 * "<body>" + 1000 * "</body>" + "</mujoco>", "mjcf") == []
    assert codes(tmp_path / "drake.urdf", '<robot name="r"><link name="a"/><drake:joint/></robot>', "urdf") == []
    assert xml_root(tmp_path / "drake.urdf")[1].tag == "drake:joint"
    assert codes(tmp_path / "open.urdf", '<robot name="r"><link name="a"/><drake:joint></robot>', "urdf") == ["SB814"]


def test_link_out_of_the_folder_is_no_way_around(tmp_path: Path) -> None:
    """The target of a symbolic link counts."""
    (tmp_path / "outside.xml").write_text("<mujoco/>", encoding="utf-8")
    (tmp_path / "scene").mkdir()
    try:
        (tmp_path / "scene" / "near.xml").symlink_to(tmp_path / "outside.xml")
    except OSError:
        pytest.skip("no symbolic links here")
    text = '<mujoco><include file="near.xml"/></mujoco>'
    assert codes(tmp_path / "scene" / "scene.xml", text, "mjcf") == ["SB820"]


@pipes
def test_pipes_are_refused_wherever_they_are_named(tmp_path: Path) -> None:
    """A pipe is rejected as a mesh, a texture, an include, by a mesh folder, a relative path or a package path."""
    os.mkfifo(tmp_path / "pipe.obj")
    mesh = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
    for name in ("pipe.obj", f"file://{tmp_path}/pipe.obj", "package://arm/pipe.obj"):
        assert codes(tmp_path / "robot.urdf", mesh.format(name), "urdf") == ["SB820"], name
    asset = f'<mujoco><compiler meshdir="{tmp_path}"/><asset><mesh file="pipe.obj"/></asset></mujoco>'
    (tmp_path / "other").mkdir()
    assert codes(tmp_path / "other" / "robot.xml", asset, "mjcf") == ["SB820"]
    assert codes(tmp_path / "robot.xml", '<mujoco><asset><texture fileup="pipe.obj"/></asset></mujoco>', "mjcf") == [
        "SB820"
    ]
    assert codes(tmp_path / "robot.xml", '<mujoco><include file="pipe.obj"/></mujoco>', "mjcf") == ["SB820"]
    uri = '<sdf version="1.9"><model name="m"><link name="a"><uri>pipe.obj</uri></link></model></sdf>'
    assert codes(tmp_path / "robot.sdf", uri, "sdf") == ["SB820"]


def test_ordinary_files_are_admitted(tmp_path: Path) -> None:
    """Existing, missing and external meshes are left to the engines."""
    (tmp_path / "a.obj").write_text("v 0 0 0\n", encoding="utf-8")
    (tmp_path / "in").mkdir()
    mesh = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
    for name in ("../a.obj", str(tmp_path / "a.obj"), "missing.obj", "a\N{NULL}b".replace("\0", "&#10;"), ""):
        assert codes(tmp_path / "in" / "robot.urdf", mesh.format(name), "urdf") == [], name


@pytest.mark.parametrize("text", ["<include/>", '<world name="w"><include/></world>'])
def test_include_beside_the_model_is_not_left_out_in_silence(tmp_path: Path, text: str) -> None:
    """A world that includes another model is rejected instead of read without it."""
    path = tmp_path / "world.sdf"
    path.write_text(f'<sdf version="1.9"><model name="m"/>{text}</sdf>', encoding="utf-8")
    with pytest.raises(EngineCannotRead, match="include"):
        read_model(path)


@pipes
def test_linked_description_is_looked_at_where_engines_read_it(tmp_path: Path) -> None:
    """References are relative to the file itself, not to a link to it."""
    (tmp_path / "there").mkdir()
    (tmp_path / "here").mkdir()
    os.mkfifo(tmp_path / "there" / "pipe.obj")
    robot = tmp_path / "there" / "robot.urdf"
    robot.write_text('<robot name="r"><mesh filename="pipe.obj"/></robot>', encoding="utf-8")
    given = tmp_path / "here" / "robot.urdf"
    given.symlink_to(robot)
    (refused,) = refusals(str(given), "urdf")
    assert (refused.code, refused.file) == ("SB820", str(given))


@pipes
def test_link_to_a_pipe_is_a_pipe(tmp_path: Path) -> None:
    """Links to pipes and devices are rejected like them, also for height fields and skins."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "a.obj").symlink_to(tmp_path / "pipe")
    (tmp_path / "b.obj").symlink_to("/dev/zero")
    for name in ("a.obj", "b.obj", "/dev/zero", "file:///dev/zero"):
        text = f'<robot name="r"><mesh filename="{name}"/></robot>'
        assert codes(tmp_path / "robot.urdf", text, "urdf") == ["SB820"], name
        for element in ("hfield", "skin", "mesh", "texture"):
            text = f'<mujoco><asset><{element} file="{name}"/></asset></mujoco>'
            if "://" not in name:
                assert codes(tmp_path / "robot.xml", text, "mjcf") == ["SB820"], (element, name)


@pipes
def test_settings_of_included_files_hold_in_all(tmp_path: Path) -> None:
    """Settings of an included file apply to all: a mesh folder, and `strippath`."""
    (tmp_path / "other").mkdir()
    (tmp_path / "scene").mkdir()
    os.mkfifo(tmp_path / "other" / "pipe.obj")
    compiler = f'<mujoco><compiler meshdir="{tmp_path}/other" strippath="true"/></mujoco>'
    (tmp_path / "scene" / "settings.xml").write_text(compiler, encoding="utf-8")
    for name in ("pipe.obj", "any/pipe.obj"):
        text = f'<mujoco><include file="settings.xml"/><asset><mesh file="{name}"/></asset></mujoco>'
        assert codes(tmp_path / "scene" / "scene.xml", text, "mjcf") == ["SB820"]


def test_layers_stay_in_the_folder(tmp_path: Path) -> None:
    """Sublayers, references and payloads of a stage are in its folder, also those of other layers."""
    pytest.importorskip("pxr", reason="usd-core is not installed")
    inside = tmp_path / "robot"
    (inside / "parts").mkdir(parents=True)
    (tmp_path / "outside.usda").write_text("#usda 1.0\n", encoding="utf-8")
    (inside / "near.usda").write_text("#usda 1.0\n", encoding="utf-8")
    far = '#usda 1.0\ndef "a" (payload = @../../outside.usda@</a>)\n{\n}\n'
    (inside / "parts" / "far.usda").write_text(far, encoding="utf-8")

    def referring(name: str) -> list[str]:
        text = f'#usda 1.0\ndef "robot" (references = @{name}@</a>)\n{{\n}}\n'
        return codes(inside / f"robot_{len(list(inside.iterdir()))}.usda", text, "usd")

    assert referring("./near.usda") == []
    assert referring("./missing.usda") == []
    assert codes(inside / "own.usda", '#usda 1.0\ndef "a"\n{\n}\n\ndef "b" (references = </a>)\n{\n}\n', "usd") == []
    assert referring("../outside.usda") == ["SB820"]
    assert referring(str(tmp_path / "outside.usda")) == ["SB820"]
    assert referring("./parts/far.usda") == ["SB820"]
    assert codes(inside / "sub.usda", "#usda 1.0\n(\n    subLayers = [@../outside.usda@]\n)\n", "usd") == ["SB820"]
    assert codes(inside / "broken.usda", "#usda 1.0\ndef", "usd") == []


@pipes
def test_pipes_are_no_layers(tmp_path: Path) -> None:
    """A pipe as a layer would block the engine."""
    pytest.importorskip("pxr", reason="usd-core is not installed")
    os.mkfifo(tmp_path / "pipe.usda")
    assert codes(tmp_path / "robot.usda", '#usda 1.0\ndef "a" (references = @./pipe.usda@)\n{\n}\n', "usd") == ["SB820"]


SIZES = {
    '<asset><hfield name="h" nrow="30000" ncol="30000" size="1 1 1 1"/></asset>': True,
    '<asset><hfield name="h" nrow="300" ncol="300" size="1 1 1 1"/></asset>': False,
    '<asset><texture name="t" type="2d" builtin="flat" width="90000" height="90000"/></asset>': True,
    '<asset><texture name="t" type="2d" builtin="flat" width="512" height="512"/></asset>': False,
    '<size nuser_body="1000000000"/>': True,
    '<size nuser_geom="1e12"/>': True,
    '<size nuser_body="8" memory="64M" njmax="500"/>': False,
    '<size memory="900G"/>': True,
    '<size nkey="1000000000"/>': True,
    '<worldbody><replicate count="1000000"><geom size="1"/></replicate></worldbody>': True,
}


@pytest.mark.parametrize("text", SIZES)
def test_sizes_in_a_few_digits(tmp_path: Path, text: str) -> None:
    """A short MJCF that asks for gigabytes is rejected at its line before MuJoCo reserves them; usual ones are not."""
    path = tmp_path / "robot.xml"
    path.write_text(f"<mujoco>\n{text}</mujoco>", encoding="utf-8")
    found = refusals(str(path), "mjcf")
    assert [(one.code, one.line) for one in found] == [("SB823", 2)] * SIZES[text]


def test_the_hash_of_meshes_tells_whether_their_surfaces_may_differ(tmp_path: Path) -> None:
    """Equal bytes of files of one format have equal surfaces, whatever their names."""

    def meshes(folder: str, file: str, content: bytes) -> str:
        place = tmp_path / folder
        place.mkdir()
        (place / file).write_bytes(content)
        link = f'<link name="a"><visual><geometry><mesh filename="{file}"/></geometry></visual></link>'
        (place / "a.urdf").write_text(f'<robot name="a">{link}</robot>')
        return mesh_hash(place / "a.urdf", ())

    triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    known = meshes("one", "a.obj", triangle)
    assert meshes("copy", "a.obj", triangle) == meshes("renamed", "b.obj", triangle) == known
    assert meshes("other", "a.obj", triangle.replace(b"1 0 0", b"2 0 0")) != known
    assert meshes("in_another_format", "a.stl", triangle) != known
    assert meshes("gltf", "a.gltf", b"{}") != meshes("gltf_elsewhere", "a.gltf", b"{}"), "its triangles are elsewhere"
