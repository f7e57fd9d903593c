"""Whatever fails beside the geometry costs itself alone: a failure injected into each step, one by one."""

import os
from pathlib import Path
from typing import Any

import OCP.Standard as Standard
import pytest
from msgspec.structs import replace

from robot_library.step_file import Part, write_step
from stepbot.step import worker
from stepbot.step.assembly import Assembly, BodyKind, ReadOptions
from stepbot.step.shapes import bodies
from stepbot.step.shapes.healing import healed
from tests import solids
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here
from tests.unit.step.shapes.test_bodies import as_nurbs

STEPS = [
    ("shapes.bodies.axis_faces", "finding axes"),
    ("features.axis_faces._axis_face", "finding axes failed on"),
    ("shapes.bodies.read_faces", "reading faces"),
    ("features.face_reading._read_face", "reading faces failed on"),
    ("shapes.bodies.face_counts", "counting its faces"),
    ("shapes.bodies.integrate", "integrating its volume"),
    ("shapes.bodies.estimated", "estimating the error"),
    ("shapes.bodies.share_within", "checking for self-intersection"),
    ("shapes.bodies.surface_area", "integrating its area"),
    ("shapes.bodies.refine", "refining its measuring mesh"),
    ("one_file.Materials", "reading materials"),
    ("one_file.Materials.of", "reading materials"),
    ("one_file.mechanism_count", "reading mechanisms"),
    ("content._stated", "reading validation properties"),
    ("worker.compare", "reading validation properties"),
    ("structure.definitions.Colors._of_label", "colors"),
    ("structure.definitions.Colors._of_parts", "colors"),
]
"""Functions that a file can be read without, and what the message says."""


def failing(error: type[Exception]) -> Any:
    """A function that fails."""

    def fail(*_: Any, **__: Any) -> Any:
        raise error("on purpose")

    return fail


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A shaft of free-form surfaces, and a block with a colour."""
    path = tmp_path / "pair.step"
    write_step(
        path,
        Part("shaft", as_nurbs(solids.cylinder(5, 40).shape)),
        Part("block", solids.box(30, 20, 10).shape, color="#3366cc"),
    )
    return path


def triangles(assembly: Assembly | None) -> list[int]:
    """Number of triangles of each body."""
    assert assembly is not None
    return [len(body.mesh.faces) for body in assembly.bodies]


@pytest.mark.parametrize(("step", "says"), STEPS)
def test_a_step_that_fails_costs_itself(
    step: str, says: str, path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is read, each body has its mesh, and a warning names what is missing."""
    error = (Standard.Standard_NullObject, ValueError)[STEPS.index((step, says)) % 2]
    options = ReadOptions(faces=True, refine_mass_to=0.1 if says.startswith("refining") else 0.0)
    request = worker.BodyRequest
    monkeypatch.setattr(worker, "BodyRequest", lambda *given: replace(request(*given), area=True))
    monkeypatch.setattr(f"stepbot.step.{step}", failing(error))
    assembly = read_here(path, diagnostics, options)
    assert [count > 10 for count in triangles(assembly)] == [True, True]
    assert set(diagnostics.codes()) <= {"SB233", "SB605"}
    assert any(says in diagnostic.message and error.__name__ in diagnostic.message for diagnostic in diagnostics)


@pytest.mark.parametrize("test", ["IsPlane", "IsCylinder", "IsCone", "IsSphere"])
def test_a_form_that_is_not_recognized_is_free(
    test: str, path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the kernel fails to recognize one form, others are still tried, and the face stays a face."""
    from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition

    from stepbot.step.features import axis_faces as recognition

    class Failing:
        def __init__(self, face: Any) -> None:
            self._recognition = ShapeAnalysis_CanonicalRecognition(face)

        def __getattr__(self, name: str) -> Any:
            return failing(Standard.Standard_NullObject) if name == test else getattr(self._recognition, name)

    monkeypatch.setattr(recognition, "ShapeAnalysis_CanonicalRecognition", Failing)
    assembly = read_here(path, diagnostics, ReadOptions(faces=True))
    assert assembly is not None
    assert not diagnostics.codes()
    assert [len(body.faces) for body in assembly.bodies] == [3, 6]
    assert bool(assembly.bodies[0].axis_faces) is (test != "IsCylinder")


@pytest.mark.parametrize("error", [Standard.Standard_NullObject, ValueError])
def test_a_body_without_a_mesh_costs_this_body(
    error: type[Exception], path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body that cannot be healed has no mesh, and counts as a solid whose mass is missing."""

    def failing_on_many(shape: Any, *arguments: Any) -> Any:
        if len(solids.faces(shape)) == 6:
            raise error("on purpose")
        return healed(shape, *arguments)

    monkeypatch.setattr(bodies, "healed", failing_on_many)
    assembly = read_here(path, diagnostics)
    assert assembly is not None
    assert diagnostics.codes() == ["SB213"]
    assert "block" in next(iter(diagnostics)).message
    assert [len(body.mesh.faces) > 0 for body in assembly.bodies] == [True, False]
    assert assembly.bodies[1].kind is BodyKind.SOLID
    assert assembly.bodies[1].defect


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="without fork, a crash ends the test")
@pytest.mark.parametrize("step", ["estimated", "axis_faces", "share_within", "integrate"])
def test_a_step_that_crashes_costs_the_measures_of_its_body(
    step: str, path: Path, diagnostics: ReadDiagnostics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The body is made again with a mesh alone; its mass is unknown, not wrong."""
    monkeypatch.setattr(worker, "thread_count", lambda: 1)  # as in the kernel's process
    monkeypatch.setattr(bodies, step, lambda *_, **__: os._exit(7))
    assembly = read_here(path, diagnostics)
    assert assembly is not None
    assert set(diagnostics.codes()) == {"SB233"}
    assert "exit code 7" in next(iter(diagnostics)).message
    assert all(len(body.mesh.faces) and body.exact is None and not body.watertight for body in assembly.bodies)
