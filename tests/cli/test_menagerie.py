"""``stepbot convert --for menagerie``: the folder of a robot in MuJoCo Menagerie."""

import re
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics
from stepbot.formats.mjcf.menagerie import menagerie_files, report_missing_license
from stepbot.formats.rendering import render
from stepbot.robot.metadata import Metadata
from tests.command_line import convert_once
from tests.robots import two_link_arm

from .conftest import Stepbot

pytest.importorskip("embreex")
pytest.importorskip("PIL")


def converted(temporary: pytest.TempPathFactory, sidecar: Path) -> Path:
    """The folder of a robot in Menagerie."""
    options = ("--no-verify", "-f", "mjcf", "--for", "menagerie")
    output = convert_once(temporary, f"{sidecar.stem} for Menagerie", sidecar, *options).folder
    (folder,) = (output / "menagerie").iterdir()
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, robot_library: Path) -> Path:
    """That of the arm with a gripper."""
    return converted(tmp_path_factory, robot_library / "stepbot_arm2" / "arm2.robot.yaml")


def run_with_noise(scene: Path) -> list[int]:
    """Counts of MuJoCo's warnings in a second of random inputs over the whole ranges, as in Menagerie's own check."""
    model = mujoco.MjModel.from_xml_path(str(scene))
    data, random = mujoco.MjData(model), np.random.default_rng(0)
    lower, upper = model.actuator_ctrlrange.T
    limited = model.actuator_ctrllimited.astype(bool)
    while data.time < 1.0:
        data.ctrl = random.uniform(np.where(limited, lower, -1.0), np.where(limited, upper, 1.0))
        mujoco.mj_step(model, data)
    return [int(count) for count in data.warning.number]


@pytest.mark.slow
def test_folder_has_what_the_checks_ask_for(folder: Path) -> None:
    """A README, a licence, a changelog, a scene and a picture, and all meshes in `assets`."""
    names = {"LICENSE", "README.md", "CHANGELOG.md", "arm2.xml", "scene.xml", "arm2.png", "assets"}
    assert {path.name for path in folder.iterdir()} == names
    assert "Apache License" in (folder / "LICENSE").read_text(encoding="utf-8")
    assert {path.suffix for path in (folder / "assets").iterdir()} == {".obj"}
    for path in folder.glob("*.*"):
        if path.suffix != ".png":
            text = path.read_text(encoding="utf-8")
            assert text.endswith("\n"), path
            assert not text.endswith("\n\n"), path
            assert not [line for line in text.split("\n") if line != line.rstrip()], path


@pytest.mark.slow
def test_xml_has_the_form_that_is_asked_for(folder: Path) -> None:
    """No declaration, 120 columns, and as many attributes in a line as fit; the elements are those of the MJCF."""
    for name, original in (("arm2.xml", "arm2.xml"), ("scene.xml", "arm2.scene.xml")):
        text = (folder / name).read_text(encoding="utf-8")
        assert text.startswith("<mujoco model=")
        lines = text.split("\n")
        for line, following in pairwise(lines):
            assert len(line) <= 120 or line.count('="') == 1, line
            if not line.endswith(">"):
                first = following.strip().split('" ')[0]  # without its last quote, where another attribute follows
                assert len(f'{line} {first}"') > 120, line
        styled = [(one.tag, one.attrib) for one in ET.fromstring(text).iter()]
        plain = [(one.tag, dict(one.attrib)) for one in ET.parse(folder.parents[1] / original).iter()]
        for tag, attributes in plain:
            if tag == "compiler":
                attributes["meshdir"] = "assets"
            elif tag == "mesh":
                attributes["file"] = attributes["file"].removeprefix("meshes/")
        assert styled == plain


@pytest.mark.slow
def test_model_is_that_of_the_output_folder(folder: Path) -> None:
    """MuJoCo compiles both files to the same numbers."""
    here = mujoco.MjModel.from_xml_path(str(folder / "arm2.xml"))
    there = mujoco.MjModel.from_xml_path(str(folder.parents[1] / "arm2.xml"))
    for name in ("body_mass", "body_inertia", "body_ipos", "geom_pos", "mesh_vert", "jnt_range", "key_qpos"):
        assert np.array_equal(getattr(here, name), getattr(there, name)), name
    assert not any(run_with_noise(folder / "scene.xml"))


@pytest.mark.long
@pytest.mark.parametrize("robot", ["four_bar", "diff_drive", "quadruped", "stewart", "desk_arm"])
def test_random_inputs_cause_no_warnings(
    robot: str, tmp_path_factory: pytest.TempPathFactory, robot_library: Path
) -> None:
    """Robots with loops, wheels, legs and slides."""
    folder = converted(tmp_path_factory, robot_library / f"stepbot_{robot}" / f"{robot}.robot.yaml")
    assert not any(run_with_noise(folder / "scene.xml"))


@pytest.mark.slow
def test_readme_states_where_numbers_are_from(folder: Path) -> None:
    """Densities with their rules, faces of axes, the hash of the STEP, and how gains were computed."""
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert readme.startswith("# arm2 Description (MJCF)\n")
    assert "| right_finger | 29 g | 1040 kg/m³ (parts rule '**/finger'), mesh volume |" in readme
    assert "| shoulder | revolute | shaft of radius 10 mm in bore of radius 10.05 mm, 18 mm engaged |" in readme
    assert "SHA-256 `" in readme
    assert re.search(r"\| gripper_drive \| kp \d+, kv \d+ \| computed: 25 Hz with 0\.058 kg at the joint \|", readme)
    assert "limits, from the sidecar |" in readme


@pytest.mark.parametrize(
    ("license", "phrase"),
    [
        ("Apache-2.0", "Version 2.0, January 2004"),
        ("BSD-2-Clause", "Copyright (c) Ada Lovelace"),
        ("BSD-3-Clause", "Neither the name of the copyright holder"),
        ("MIT", "Permission is hereby granted, free of charge"),
    ],
)
def test_licence_has_its_text(license: str, phrase: str) -> None:
    """With the maintainer as its holder; a licence that names its holder is not written without one."""
    for holder in ("Ada Lovelace", ""):
        robot, diagnostics = replace(two_link_arm(), metadata=Metadata(holder, "", license)), Diagnostics()
        files = menagerie_files(robot, render(robot, "mjcf", diagnostics))
        report_missing_license(robot, diagnostics)
        written = holder or license == "Apache-2.0"
        assert ("LICENSE" in files) == bool(written)
        assert ("SB643" in [one.code for one in diagnostics]) == (not written)
        if written:
            assert phrase in files["LICENSE"].decode()
            assert "<copyright" not in files["LICENSE"].decode()


def test_uptodate_takes_any_picture(folder: Path, robot_library: Path, stepbot: Stepbot) -> None:
    """Pixels depend on the processor; all other files are compared, and named with the option if it is not given."""
    sidecar = robot_library / "stepbot_arm2" / "arm2.robot.yaml"
    asked = ("uptodate", str(sidecar), "-o", str(folder.parents[1]), "-f", "mjcf")
    picture = folder / "arm2.png"
    content = picture.read_bytes()
    try:
        picture.write_bytes(content + b"other")
        assert stepbot(*asked, "--for", "menagerie").code == 0
    finally:
        picture.write_bytes(content)
    assert "add menagerie to `--for` of `uptodate`" in stepbot(*asked, "-v").out
