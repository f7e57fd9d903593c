"""Faults in modules are reported once, in their own file, with the module that uses it."""

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.geometry.spatial import Pose
from stepbot.pipeline.composing import compose
from stepbot.pipeline.conversion import Options
from stepbot.pipeline.sidecars import load
from stepbot.robot.kinematics import link_poses
from stepbot.robot.model import Robot

from .described import ARM, composing, link, urdf

Errors = Callable[[Mapping[str, str], Diagnostics], list[str]]
MESH = "<visual><geometry><mesh filename='package://elsewhere/part.obj'/></geometry></visual>"


def test_a_fault_of_a_file_that_is_used_four_times(errors: Errors) -> None:
    """One error, at the line of the module's own sidecar; a note names the first module that uses it."""
    inner = composing("arm: {file: arm.urdf}", more="frames: {x: {link: arm/bse, origin: {relative_to: arm/base}}}\n")
    first, *others = (f"m{i}: {{file: inner.robot.yaml{', at: m0/x' if i else ''}}}" for i in range(4))
    found = Diagnostics()
    files = {"r.robot.yaml": composing(first, *others), "inner.robot.yaml": inner, "arm.urdf": ARM}
    (line,) = errors(files, found)
    assert line.startswith("SB152 6:20 frame 'x': link: no frame or link 'bse' in module 'arm'")
    (error,) = [one for one in found if one.severity == "error"]
    assert error.span.file.endswith("inner.robot.yaml")
    assert [note.split(" of ")[0] for note in error.notes] == ["module 'm0'"]


def test_meshes_of_a_package(tmp_path: Path, write: Callable[[Mapping[str, str]], None], errors: Errors) -> None:
    """A URDF whose package is not found is an error with the module; with the package path it is composed."""
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf}"), "arm.urdf": urdf("arm", link("base", 1.0, MESH))}
    found = Diagnostics()
    (line,) = errors(files, found)
    assert line.startswith("SB861")
    assert any("module 'arm' of" in note for one in found for note in one.notes)
    package = tmp_path / "packages" / "elsewhere"
    package.mkdir(parents=True)
    (package / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    options = Options(tmp_path / "out", package_path=(tmp_path / "packages",))
    robot: Robot = compose(load(tmp_path / "r.robot.yaml", options, found := Diagnostics()), options, found).robot
    assert [asset.name for asset in robot.meshes] == ["part"]


def test_an_sdformat_with_an_include(errors: Errors) -> None:
    """It is as unsupported as alone, and the note names the module."""
    include = '<sdf version="1.9"><model name="m"><include><uri>other</uri></include></model></sdf>'
    found = Diagnostics()
    lines = errors({"r.robot.yaml": composing("arm: {file: m.sdf}"), "m.sdf": include}, found)
    assert lines == ["SB823 0:0 <include> is not supported"]
    assert "module 'arm'" in str(next(one.notes for one in found if one.code == "SB823"))


def test_a_gap_between_the_ends_of_a_closure(errors: Errors) -> None:
    """A closure between modules whose ports are 2 mm apart states the distance, at its own line."""
    more = "closures:\n  ring: {type: revolute, link_a: a/tip, link_b: b/tip}\n"
    modules = ("a: {file: arm.urdf}", "b: {file: arm.urdf, at: a/base, offset: {xyz: [0, 0, 2 mm]}}")
    files = {"r.robot.yaml": composing(*modules, more=more), "arm.urdf": ARM}
    (line,) = errors(files, Diagnostics())
    assert line.startswith("SB411 8:3 closure 'ring': open by 0.002 m")


def test_a_prefix_with_a_slash(errors: Errors) -> None:
    """A slash leads into modules, and cannot be in a name."""
    files = {"r.robot.yaml": composing("arm: {file: arm.urdf, prefix: 'a/'}"), "arm.urdf": ARM}
    assert errors(files, Diagnostics())[0].startswith("SB126 5:33 modules.arm.prefix: 'a/' contains '/'")


@pytest.mark.parametrize("count", [256, 257])
def test_the_number_of_modules_is_limited(count: int, composed: Callable[..., Robot]) -> None:
    """256 instances of one file are composed; one more is an error at that module."""
    modules = ("m0: {file: arm.urdf}", *(f"m{i}: {{file: arm.urdf, at: m0/tip}}" for i in range(1, count)))
    files, found = {"r.robot.yaml": composing(*modules), "arm.urdf": ARM}, Diagnostics()
    if count <= 256:
        assert len(composed(files, found).links) == 2 * count
        return
    with pytest.raises(StepbotError, match=r"SB150.*'m256': more than 256 modules"):
        composed(files, found)


def test_each_configuration_is_computed_once(composed: Callable[..., Robot], monkeypatch: pytest.MonkeyPatch) -> None:
    """However many instances of a file there are, poses of the whole and of the file are computed equally often."""
    calls: list[str] = []

    def counted(robot: Robot, q: Mapping[str, float]) -> dict[str, Pose]:
        calls.append(robot.name)
        return link_poses(robot, q)

    monkeypatch.setattr("stepbot.verification.modules.link_poses", counted)
    counts = []
    for count in (4, 32):
        calls.clear()
        lines = ("m0: {file: arm.urdf}", *(f"m{i}: {{file: arm.urdf, at: m0/tip}}" for i in range(1, count)))
        composed({"r.robot.yaml": composing(*lines), "arm.urdf": ARM}, Diagnostics())
        counts.append(len(calls))
    assert counts[0] == counts[1] > 0


def test_a_bare_step_needs_a_density(composed: Callable[..., Robot]) -> None:
    """The warning is at the module, since there is no other file to write a density into; `set` gives it."""
    text = "fixture: {file: LIBRARY/robotiq_2f85/2f85.step%s}"
    found = Diagnostics()
    composed({"r.robot.yaml": composing(text % "")}, found)
    (placeholder,) = [one for one in found if one.code == "SB522"]
    assert placeholder.span.file.endswith("r.robot.yaml")
    assert placeholder.help == ("write the density of its material: `set: {defaults: {density: 2700 kg/m^3}}`",)
    found = Diagnostics()
    composed({"r.robot.yaml": composing(text % ", set: {defaults: {density: 2700}}")}, found)
    assert "SB522" not in {one.code for one in found}
