"""Materials by name: the density comes from the sidecar's table, and the report has the source of each mass."""

import json
from pathlib import Path

import pytest

from robot_library.moments import pose
from robot_library.step_file import Assembly, Occurrence
from tests import parts, solids
from tests.step_editor import StepEditor

from .conftest import Stepbot

SIDECAR = """\
version: 1
robot: cart
step: cart.step
{materials}
parts:
  "wheel": {{mass: 20 g}}
links:
  cart: {{rest: true}}
"""
TABLE = 'materials: {"Aluminium 6061": {density: 2.7 g/cm^3}, ABS: {density: 1040 kg/m^3}}\ndefaults: {material: ABS}'


@pytest.fixture
def cart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a STEP that names materials without densities, as many CAD programs write it."""
    products = [parts.drawn(name, solids.box(100, 20, 30)) for name in ("frame", "axle", "cover", "wheel")]
    children = [Occurrence(p, f"{p.name}:1", pose((0, 50 * i, 0))) for i, p in enumerate(products)]
    parts.draw(tmp_path / "cart.step", Assembly("root", children))
    file = StepEditor(tmp_path / "cart.step")
    name_material(file, "frame", "DESCRIPTIVE_REPRESENTATION_ITEM('Aluminium 6061','wrought')")
    name_material(file, "axle", "DESCRIPTIVE_REPRESENTATION_ITEM('material name','Unobtainium')")
    file.write()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def name_material(file: StepEditor, product: str, item: str) -> None:
    """Set the material of a product."""
    subject = file.definition(product)
    meaning = file.add(f"PROPERTY_DEFINITION('material property','material name',#{subject})")
    context = file.context(file.representation(subject))
    representation = file.add(f"REPRESENTATION('material name',(#{file.add(item)}),#{context})")
    file.add(f"PROPERTY_DEFINITION_REPRESENTATION(#{meaning},#{representation})")


def test_each_mass_has_its_source(cart: Path, stepbot: Stepbot) -> None:
    """The density comes from the material table, else from the default; a measured mass takes precedence."""
    (cart / "cart.robot.yaml").write_text(SIDECAR.format(materials=TABLE), encoding="utf-8")
    run = stepbot("convert", "cart.robot.yaml", "--no-verify", "-o", "out", "--json")
    document = json.loads(run.out)
    assert run.code == 0, document
    (link,) = document["report"]["robot"]["links"]
    sources = {source["component"]: source for source in link["sources"]}
    assert {path: source["origin"] for path, source in sources.items()} == {
        "frame": "material 'Aluminium 6061' in the STEP",
        "axle": "defaults",
        "cover": "defaults",
        "wheel": "parts rule 'wheel'",
    }
    volume = 0.1 * 0.02 * 0.03
    masses = {"frame": 2700 * volume, "axle": 1040 * volume, "cover": 1040 * volume, "wheel": 0.020}
    assert {path: source["mass"] for path, source in sources.items()} == pytest.approx(masses, rel=1e-9)
    assert link["mass"] == pytest.approx(sum(masses.values()), rel=1e-9)
    (note,) = [d for d in document["diagnostics"] if d["code"] == "SB515"]
    assert note["notes"] == ["'Unobtainium': \"axle\""]


def test_a_material_that_nothing_gives_a_density(cart: Path, stepbot: Stepbot) -> None:
    """Materials without a density are an error that names parts and materials, with the line to add."""
    (cart / "cart.robot.yaml").write_text(SIDECAR.format(materials=""), encoding="utf-8")
    run = stepbot("convert", "cart.robot.yaml", "--no-verify", "-o", "out")
    assert run.code == 1
    assert "Aluminium 6061" in run.err
    assert 'materials: {"' in run.err


def test_inspect_lists_materials(cart: Path, stepbot: Stepbot) -> None:
    """The header counts solids by material."""
    run = stepbot("inspect", "cart.step")
    assert "materials: 'Aluminium 6061' without density (1), 'Unobtainium' without density (1), none (2)" in run.out
