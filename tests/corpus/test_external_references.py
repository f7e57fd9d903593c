"""A real SolidWorks assembly in thirteen files, against its files read separately and the kernel's reading."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.step.assembly import Assembly, BodyKind, ReadOptions
from stepbot.step.features.ground import standing
from stepbot.step.reader import start_reading
from tests import command_line

FOLDER = "koch_v1_1_external_references"
ROOT = "Follower_Arm.STEP"
SIDECAR = """\
version: 1
robot: whole
step: '{}'
defaults: {{density: 1240 kg/m^3}}
links:
  all: {{rest: true}}
"""


# `make test` reads made assemblies in many files: tests/cli/test_external_files.py.
pytestmark = [pytest.mark.long, pytest.mark.xdist_group("koch")]


@pytest.fixture(scope="module")
def koch(corpus: Path) -> Path:
    """The folder; the test is skipped if it is missing."""
    folder = corpus / FOLDER
    if not (folder / ROOT).exists():
        pytest.skip(f"no {FOLDER} in {corpus}")
    return folder


def read(step: Path) -> Assembly:
    """The assembly of a file without errors."""
    diagnostics = Diagnostics()
    assembly = start_reading(step, ReadOptions()).finish(diagnostics)
    assert [str(d) for d in diagnostics if d.severity == "error"] == []
    assert assembly is not None
    return assembly


def volume(assembly: Assembly, below: int = 0) -> float:
    """Volume [m^3] of all solids of a component and below it."""
    bodies = [
        assembly.bodies[assembly.components[i].body]
        for i in assembly.subtree(below)
        if assembly.components[i].body >= 0
    ]
    return sum(body.exact.volume for body in bodies if body.kind is BodyKind.SOLID and body.exact is not None)


@pytest.fixture(scope="module")
def whole(koch: Path) -> Assembly:
    """The assembly."""
    return read(koch / ROOT)


def test_tree(whole: Assembly) -> None:
    """The tree is that of the index."""
    assert (whole.definitions, len(whole.children[0]), len(whole.external_files)) == (13, 25, 12)


def test_whole_and_parts(koch: Path, whole: Assembly) -> None:
    """Each of the 25 parts has the volume of its own file."""
    assembly = whole
    parts = assembly.children[0]
    alone = {path.stem: volume(read(path)) for path in sorted(koch.glob("*.STEP")) if path.name != ROOT}
    assert len(alone) == 12
    for index in parts:
        assert volume(assembly, index) == pytest.approx(alone[assembly.components[index].product], rel=1e-12)
    products = [assembly.components[index].product for index in parts]
    assert volume(assembly) == pytest.approx(sum(alone[product] for product in products), rel=1e-12)


def test_against_the_kernel(koch: Path, whole: Assembly) -> None:
    """The kernel, which opens the files itself, finds the same 18 solids in the same poses.

    Its integrals are refined until they change by 1e-5.
    """
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    reader = STEPCAFControl_Reader()
    reader.ReadFile(str(koch / ROOT))
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    assert reader.Transfer(document)
    shape = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetOneShape()
    solids = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    theirs = []
    while solids.More():
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solids.Current(), properties, 1e-5, True, False)
        theirs.append((properties.Mass() * 1e-9, np.array(properties.CentreOfMass().Coord()) / 1e3))
        solids.Next()
    ours = [
        (body.exact.volume, c.X_WC.R @ np.array(body.exact.unit_density.com) + c.X_WC.p)
        for c in whole.components
        if c.body >= 0 and (body := whole.bodies[c.body]).exact is not None and body.kind is BodyKind.SOLID
    ]
    assert len(ours) == len(theirs) == 18
    for own, centre in ours:
        other, place = min(theirs, key=lambda solid: float(np.linalg.norm(solid[1] - centre)))
        assert np.linalg.norm(place - centre) < 1e-4
        assert own == pytest.approx(other, rel=1e-4)


def test_the_axis_that_is_up(whole: Assembly) -> None:
    """The arm is drawn with y up: it is on its base, whose motor turns about y."""
    base = [c.index for c in whole.components if c.path.startswith("Follower_Base")]
    found = standing(whole, base, [(0.0, 1.0, 0.0)])
    assert found is not None
    assert found.up == "y"


def test_one_link(koch: Path, tmp_path: Path) -> None:
    """The assembly converts and is verified; without one of its files it is rejected with the name of that file."""
    sidecar = tmp_path / "whole.robot.yaml"
    sidecar.write_text(SIDECAR.format((koch / ROOT).as_posix()), encoding="utf-8")
    run = command_line.stepbot("convert", sidecar, "-o", "whole", cwd=tmp_path)
    assert run.code == 0, run.out + run.err
    partly = tmp_path / "partly"
    shutil.copytree(koch, partly)
    missing = partly / "Follower_Base.STEP"
    missing.chmod(0o644)
    partly.chmod(0o755)
    missing.unlink()
    run = command_line.stepbot("convert", sidecar, "--step", partly / ROOT, cwd=tmp_path)
    assert run.code == 1
    assert run.err.count("error[") == 1
    assert (
        "error[SB203]: the geometry of 'Follower_Base' is in file 'Follower_Base.STEP', which does not exist" in run.err
    )
