"""Mesh files in every format, in every description: what is written, and what engines and readers make of it."""

from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.geometry.mesh_files import read_content
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Collision, Link, MeshFormat, MeshFormats, MeshRef, Robot, Visual
from tests.robots import ROBOTS, one_link

with_meshes = pytest.mark.parametrize("format_", [one.name for one in FORMATS.values() if one.root])
READ = {
    "urdf": {"visual": ("obj", "stl", "dae"), "collision": ("obj", "stl")},
    "sdf": {"visual": ("obj", "stl", "dae", "glb"), "collision": ("obj", "stl")},
    "mjcf": {"visual": ("obj", "stl"), "collision": ("obj", "stl")},
}
"""What the readers of each description read: RViz and PyBullet; Gazebo; MuJoCo."""

REWRITTEN = ("SB763:dae-visual", "SB763:glb-visual", "SB763:other-collision")
"""Codes of meshes in another format than asked for."""


def as_format(robot: Robot, visual: MeshFormat, collision: MeshFormat = MeshFormat.OBJ) -> Robot:
    """The robot with meshes in these formats."""
    return replace(robot, mesh_formats=MeshFormats(visual, collision))


@pytest.mark.parametrize("wanted", MeshFormat)
@with_meshes
def test_every_mesh_is_written_as_its_readers_read_it(format_: str, wanted: MeshFormat) -> None:
    """Each reference is to a written file and each file is referred to; other formats become OBJ, with a note."""
    diagnostics = Diagnostics()
    files = render(as_format(ROBOTS["tree"](), wanted, wanted), format_, diagnostics)
    top = etree.fromstring(next(iter(files.values())))
    meshes = {path for path in files if path.startswith("meshes/")}
    attributes = {element.get(key) for element in top.iter("mesh") for key in ("filename", "file")}
    assert (attributes | {element.text for element in top.iter("uri")}) - {None} == meshes
    kinds = {wanted.value if wanted.value in READ[format_][side] else "obj" for side in ("visual", "collision")}
    assert {path.rpartition(".")[2] for path in meshes} == kinds
    noted = [one.message for one in diagnostics if one.code in REWRITTEN]
    assert len(noted) == sum(wanted.value not in kinds_read for kinds_read in READ[format_].values())


@pytest.mark.parametrize("wanted", [MeshFormat.DAE, MeshFormat.GLB])
def test_files_have_the_colour_of_their_visual(wanted: MeshFormat, tmp_path: Path) -> None:
    """A mesh that is shown in two colours has two files; each visual refers to the one in its colour."""
    link = one_link().root
    (first, *_) = (visual for visual in link.visuals if isinstance(visual.geometry, MeshRef))
    colors = {"a": (1.0, 0.5, 0.0, 1.0), "b": (0.0, 0.25, 1.0, 0.5), "c": (1.0, 0.5, 0.0, 1.0)}
    shown = [replace(first, name=name, rgba=rgba) for name, rgba in colors.items()]
    touched = Collision("t", first.geometry)
    link = Link("base", link.mass_properties, tuple(shown), (touched,))
    robot = as_format(replace(one_link(), links=(link,)), wanted)
    files = MeshFiles(robot)
    assert files.of(shown[0]) == files.of(shown[2]) != files.of(shown[1])
    assert files.of(touched).path == f"meshes/{first.geometry.name}.obj"  # type: ignore[union-attr]
    assert len(files.all) == len({file.path for file in files.all}) == 3
    for visual in shown:
        path = tmp_path / Path(files.of(visual).path).name
        path.write_bytes(files.of(visual).content())
        content = read_content(path)
        assert content is not None
        ((mesh, rgba),) = content.parts
        np.testing.assert_allclose(rgba, visual.rgba, atol=0.6 / 255)  # trimesh has 8 bits per channel
        assert len(mesh.faces) == len(files.of(visual).asset.mesh.faces)


def test_one_mesh_in_two_formats_has_two_names_in_mjcf() -> None:
    """A visual as STL and a collision as OBJ of the same mesh are two assets."""
    import mujoco

    robot = one_link()
    ref = robot.root.visuals[0].geometry
    link = replace(robot.root, visuals=(Visual("v", ref),), collisions=(Collision("c", ref),))
    files = render(as_format(replace(robot, links=(link,)), MeshFormat.STL), "mjcf", Diagnostics())
    model = mujoco.MjModel.from_xml_string(files["one_link.xml"].decode(), files)
    visual, collision = (
        model.mesh_vert[start : start + count]
        for start, count in zip(model.mesh_vertadr, model.mesh_vertnum, strict=True)
    )
    np.testing.assert_array_equal(np.unique(visual, axis=0), np.unique(collision, axis=0))


@pytest.mark.pybullet
@pytest.mark.parametrize("wanted", ["stl", "dae"])
def test_pybullet_draws_the_same_picture(wanted: str, tmp_path: Path) -> None:
    """Its renderer sees each link in the same pixels and colours as with OBJ: place, scale and axes are right."""
    pictures = [_picture(tmp_path / kind, MeshFormat(kind)) for kind in ("obj", wanted)]
    np.testing.assert_array_equal(pictures[0][1], pictures[1][1])
    assert len(np.unique(pictures[0][1])) > 2  # several links are visible
    np.testing.assert_allclose(pictures[0][0], pictures[1][0], atol=12)


def _picture(folder: Path, visual: MeshFormat) -> tuple[np.ndarray, np.ndarray]:
    """Colours and links of the pixels of a picture of the tree, from a corner."""
    import pybullet

    for path, content in render(as_format(ROBOTS["tree"](), visual), "urdf", Diagnostics()).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.loadURDF(str(folder / "tree.urdf"), useFixedBase=True)
        view = pybullet.computeViewMatrix((0.9, 0.7, 0.6), (0, 0, 0.15), (0, 0, 1))
        lens = pybullet.computeProjectionMatrixFOV(45, 1, 0.1, 10)
        flags = pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX
        picture = pybullet.getCameraImage(96, 96, view, lens, shadow=0, flags=flags, renderer=pybullet.ER_TINY_RENDERER)
    finally:
        pybullet.disconnect(client)
    return np.array(picture[2]).reshape(96, 96, 4).astype(int), np.array(picture[4]).reshape(96, 96)
