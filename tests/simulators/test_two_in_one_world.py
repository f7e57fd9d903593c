"""Two robots in one world have distinct names, by the means of each format."""

from pathlib import Path

import pytest
from lxml import etree
from msgspec.structs import replace

from stepbot.robot.model import Base, Robot
from tests.devices import equipped
from tests.processes import call_isolated
from tests.robots import ROBOTS
from tests.simulators.conftest import skip_without, write

SIDES = ("left", "right")
SCENE = """<mujoco model="scene">
  <asset><model name="one" file="{one}"/><model name="two" file="{two}"/></asset>
  <worldbody>
    <attach model="one" prefix="left_"/>
    <frame pos="0 3 0"><attach model="two" prefix="right_"/></frame>
  </worldbody>
</mujoco>
"""


def _files(robots: tuple[Robot, Robot], written_in: str, path: Path) -> list[Path]:
    """The files of two robots, each in its own folder."""
    folders = [write(robot, path / side) for side, robot in zip(SIDES, robots, strict=True)]
    return [folder.written[written_in].path for folder in folders]


def _other(name: str) -> Robot:
    return equipped() if name == "the same" else ROBOTS[name]()


@pytest.mark.parametrize("name", ["the same", "four_bar_with_zeros", "floating"])
@pytest.mark.mujoco
def test_mjcf_is_attached_under_a_prefix(name: str, tmp_path: Path) -> None:
    """Attached under a prefix, bodies, actuators, sensors, equalities and keyframes of both files are distinct."""
    skip_without("mujoco")
    import mujoco

    first, second = equipped(), _other(name)
    files = _files((first, second), "mjcf", tmp_path)
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE.format(one=files[0].as_posix(), two=files[1].as_posix()), encoding="utf-8")
    alone = [mujoco.MjModel.from_xml_path(str(file)) for file in files]
    both = mujoco.MjModel.from_xml_path(str(scene))
    for count in ("njnt", "nu", "nsensor", "nsite", "ncam", "neq", "nkey", "nexclude", "nnumeric"):
        assert getattr(both, count) == sum(getattr(one, count) for one in alone), count
    assert both.nbody == sum(one.nbody for one in alone) - 1
    assert both.body_mass.sum() == pytest.approx(sum(one.body_mass.sum() for one in alone), rel=1e-12)
    names = [f"{side}_{link.name}" for side, robot in (("left", first), ("right", second)) for link in robot.links]
    assert {both.body(i).name for i in range(1, both.nbody)} >= set(names)
    drives = [f"{side}_{drive.name}" for side, one in (("left", first), ("right", second)) for drive in one.actuators]
    assert [both.actuator(i).name for i in range(both.nu)] == drives


def _world(files: list[Path], path: Path) -> Path:
    """A world that includes the model of each file under its own name."""
    top = etree.Element("sdf", version="1.9")
    world = etree.SubElement(top, "world", name="world_of_two")
    for side, file in zip(SIDES, files, strict=True):
        model = etree.parse(str(file)).getroot().find("model")
        assert model is not None
        model.set("name", side)
        etree.strip_elements(model, "gz_frame_id")  # Drake rejects it, as docs/use-it-in.md states
        for uri in model.iter("uri"):
            uri.text = (file.parent / (uri.text or "")).resolve().as_posix()
        world.append(model)
    scene = path / "world.sdf"
    scene.write_bytes(etree.tostring(top))
    return scene


SHARING = {"drake": "tests.worlds:drake_models", "pybullet": "tests.worlds:pybullet_models"}
"""For each engine that reads worlds, the function that lists the links of each model."""


@pytest.mark.parametrize("engine", SHARING)
@pytest.mark.parametrize("name", ["the same", "two_link_arm"])
def test_sdformat_models_are_scopes(engine: str, name: str, tmp_path: Path) -> None:
    """Both models of an SDFormat world have all links, under their own names."""
    skip_without(engine)
    # PyBullet rejects joints to the world.
    first, second = (replace(robot, base=Base.FLOATING) for robot in (equipped(), _other(name)))
    scene = _world(_files((first, second), "sdf", tmp_path), tmp_path)
    seen = call_isolated(SHARING[engine], str(scene))
    assert seen == [sorted(link.name for link in robot.links) for robot in (first, second)]
