"""Bodies without volume have visuals, and mass only from the sidecar."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mass_properties import measured
from stepbot.robot.model import Robot
from stepbot.robot.validity import check_robot
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.parts import Drawing
from tests.unit.assemble.workshop import robot_of, sidecar
from tests.unit.step.in_process import read_here

ONE = "    links: {base: {rest: true}}\n"
WATER = "    defaults: {density: 1000}\n"
TWO = """
    links: {base: {rest: true}, arm: {parts: [sheet]%s}}
    joints: {j: {type: continuous, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}}
"""
GIVEN = "inertial: {mass: 5 g, com: [20 mm, 0, 0], inertia: {ixx: 3e-7, iyy: 1e-7, izz: 2e-7}}"


def _convert(drawing: Drawing | Path, folder: Path, text: str, diagnostics: Diagnostics) -> Robot | None:
    """The checked robot, as `convert` builds it; the reader's diagnostics are ignored here."""
    path = drawing if isinstance(drawing, Path) else drawing.path
    assembly = read_here(path, Diagnostics())
    assert assembly is not None
    loaded = sidecar(folder, text)
    robot = robot_of(
        build_robot(assembly, loaded, lambda: [measured(body.mesh) for body in assembly.bodies], diagnostics)
    )
    if robot is not None:
        check_robot(robot, diagnostics, loaded.span(), assembly.unit)
    return robot


def test_a_surface_is_drawn_and_weighs_nothing(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A sheet beside a block: both are visible, the link has the block's mass, and a note names the sheet."""
    drawing = parts.write_surface_body(tmp_path / "robot.step")
    robot = _convert(drawing, tmp_path, WATER + ONE, diagnostics)
    assert robot is not None
    assert len(robot.root.visuals) == 2
    assert robot.root.mass_properties.mass == pytest.approx(1000 * drawing.body.mass, rel=1e-9)
    np.testing.assert_allclose(robot.root.mass_properties.com, drawing.body.com, atol=1e-12)
    note = next(d for d in diagnostics if d.code == "SB506")
    assert (note.severity, note.notes) == ("note", ("sheet: encloses no volume: surface without a solid",))
    assert "`inertial`" in note.help[0]


def test_a_link_of_surfaces_needs_an_inertial(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A moving link of a sheet alone is an error that names it; with an ``inertial`` it is valid."""
    drawing = parts.write_surface_body(tmp_path / "robot.step")
    _convert(drawing, tmp_path, WATER + TWO % "", diagnostics)
    fault = next(d for d in diagnostics if d.severity == "error")
    assert fault.code == "SB508"
    assert "link 'arm'" in fault.message
    assert "'sheet'" in fault.message
    assert fault.help == ("give it an `inertial` with mass, com and inertia",)

    again = Diagnostics()
    robot = _convert(drawing, tmp_path, WATER + TWO % f", {GIVEN}, collision: none", again)
    assert robot is not None
    arm = robot.link_by_name["arm"]
    assert (arm.mass_properties.mass, arm.mass_properties.com) == (0.005, (0.02, 0.0, 0.0))
    assert len(arm.visuals) == 1
    assert not list(again)


@pytest.mark.parametrize("link", ["", ", inertial: {mass: 5 g}"], ids=["by a rule", "by its link"])
def test_mass_alone_on_a_surface_is_an_error(link: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A mass without a com on a surface is one error at the mass, with the remedy."""
    rule = "" if link else "    parts: {sheet: {mass: 5 g}}\n"
    drawing = parts.write_surface_body(tmp_path / "robot.step")
    assert _convert(drawing, tmp_path, WATER + rule + TWO % link, diagnostics) is None
    (fault,) = [d for d in diagnostics if d.severity == "error"]
    assert fault.code == "SB503"
    assert "inertia" in fault.help[0]


def test_a_solid_that_does_not_close(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A box without a lid is not a surface: its mass is an error unless the link has an ``inertial``."""
    drawing = parts.write_open_solid(tmp_path / "robot.step")
    assert _convert(drawing, tmp_path, WATER + ONE, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB507"
    assert "edges belong to one face only" in fault.notes[0]
    again = Diagnostics()
    robot = _convert(drawing, tmp_path, f"    links: {{base: {{rest: true, {GIVEN}}}}}\n", again)
    assert robot is not None
    assert robot.root.mass_properties.mass == 0.005
    assert len(robot.root.visuals) == 1
    assert not list(again)


def test_closed_triangles_have_a_volume(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A tessellated box has the mass of its mesh, which is reported if the exact solid was requested."""
    drawing = parts.write_tessellated(tmp_path / "robot.step")
    robot = _convert(drawing, tmp_path, WATER + ONE, diagnostics)
    assert robot is not None
    properties = robot.root.mass_properties
    assert properties.mass == pytest.approx(1000 * drawing.body.mass, rel=1e-9)
    np.testing.assert_allclose(properties.inertia, 1000 * drawing.body.inertia, rtol=1e-8, atol=1e-15)
    assert [source.method for source in robot.root.masses] == ["mesh"]
    assert not list(diagnostics)
    assert _convert(drawing, tmp_path, WATER + "    mass: exact\n" + ONE, diagnostics) is not None
    (note,) = diagnostics
    assert (note.code, note.notes) == ("SB505", (".: mesh: there is no exact solid",))


def test_open_triangles_have_none(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A tessellated box with a hole has no mass: a note names it, a warning the robot; a mass for it is one error."""
    drawing = parts.write_tessellated(tmp_path / "robot.step", closed=False)
    robot = _convert(drawing, tmp_path, WATER + ONE, diagnostics)
    assert robot is not None
    assert len(robot.root.visuals) == 1
    assert robot.root.mass_properties.mass == 0.0
    note, massless = diagnostics
    assert (note.code, note.severity) == ("SB506", "note")
    assert (massless.code, massless.severity) == ("SB510", "warning")
    assert "its triangles are not closed" in note.notes[0]
    again = Diagnostics()
    assert _convert(drawing, tmp_path, '    parts: {"**": {mass: 5 g}}\n' + ONE, again) is None
    assert [d.code for d in again if d.severity == "error"] == ["SB503"]


def test_real_triangles_that_do_not_close(corpus: Path, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Open triangles of an AP242 file have a visual and a note; a rule with a mass for all of it is one error."""
    step = corpus / "tessellated_only_ap242.step"
    robot = _convert(step, tmp_path, WATER + ONE, diagnostics)
    assert robot is not None
    assert len(robot.root.visuals) == 1
    note = next(d for d in diagnostics if d.code == "SB506")
    assert "SplitEdges.stl/GeoContainer" in note.notes[0]
    again = Diagnostics()
    assert _convert(step, tmp_path, '    parts: {"**": {mass: 5 g}}\n' + ONE, again) is None
    assert [d.code for d in again if d.severity == "error"] == ["SB503"]
    floating = Diagnostics()
    _convert(step, tmp_path, WATER + "    base: floating\n" + ONE, floating)
    assert [d.code for d in floating if d.severity == "error"] == ["SB508"]
