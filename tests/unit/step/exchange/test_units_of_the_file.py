"""Lengths and densities in any declared unit, against the definitions of the units."""

import re
from pathlib import Path

import pytest

from stepbot.step.assembly import Assembly
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here, read_quietly

GRAM = "( MASS_UNIT() NAMED_UNIT(*) SI_UNIT($,.GRAM.) )"
CENTIMETRE = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.CENTI.,.METRE.) )"
MILLIMETRE = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"
EXTRA = """\
#9001=DIMENSIONAL_EXPONENTS(0.,1.,0.,0.,0.,0.,0.);
#9002=( MASS_UNIT() NAMED_UNIT(*) SI_UNIT(.KILO.,.GRAM.) );
#9003=MASS_MEASURE_WITH_UNIT(MASS_MEASURE(0.45359237),#9002);
#9004=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#9005=( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) );
#9006=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.0254),#9005);
"""
POUND = "( CONVERSION_BASED_UNIT('POUND',#9003) MASS_UNIT() NAMED_UNIT(#9001) )"
INCH = "( CONVERSION_BASED_UNIT('INCH',#9006) LENGTH_UNIT() NAMED_UNIT(#9004) )"


def rewrite(path: Path, *replacements: tuple[str, str], extra: str = EXTRA) -> Path:
    """Replace texts in a STEP file, each at least once, and add entities."""
    text = re.sub(r"\n\s*", "", path.read_text(encoding="utf-8")).replace(";", ";\n")
    for old, new in replacements:
        assert old in text, f"{old} in\n{text}"
        text = text.replace(old, new)
    before, after = text.rsplit("ENDSEC;", 1)
    path.write_text(f"{before}{extra}ENDSEC;{after}", encoding="utf-8", newline="\n")
    return path


def density_of(assembly: Assembly | None) -> float | None:
    """The density of the only part."""
    assert assembly is not None
    return assembly.components[0].density


@pytest.mark.parametrize(
    ("mass", "length", "density"),
    [
        (GRAM, CENTIMETRE, 1000.0),
        (GRAM.replace("$", ".KILO."), CENTIMETRE.replace(".CENTI.", "$"), 1.0),
        (GRAM.replace("$", ".MEGA."), CENTIMETRE.replace(".CENTI.", ".MILLI."), 1e12),
        (POUND, INCH, 0.45359237 / 0.0254**3),
        (GRAM, INCH, 1e-3 / 0.0254**3),
    ],
    ids=["g/cm^3", "kg/m^3", "t/mm^3", "lb/in^3", "g/in^3"],
)
def test_density(mass: str, length: str, density: float, tmp_path: Path) -> None:
    """A density is in its own unit, SI or not."""
    path = parts.write_box(tmp_path / "box.step", density=7850.0).path
    rewrite(path, (GRAM, mass), (CENTIMETRE, length), ("POSITIVE_RATIO_MEASURE(7.85)", "POSITIVE_RATIO_MEASURE(2.)"))
    assert density_of(read_quietly(path)) == pytest.approx(2 * density, rel=1e-11)


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        (",-3.)", ",2.)", "g cm^2"),
        ("POSITIVE_RATIO_MEASURE(7.85)", "POSITIVE_RATIO_MEASURE(-7.85)", "-7.85"),
        (GRAM, CENTIMETRE, "cm cm^-3"),
        ("DERIVED_UNIT((", "DERIVED_UNIT((#9001,", ""),
    ],
)
def test_a_density_without_its_unit(
    old: str, new: str, word: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """A value without a unit of density is ignored with a diagnostic."""
    path = parts.write_box(tmp_path / "box.step", density=7850.0).path
    assert density_of(read_here(rewrite(path, (old, new)), diagnostics)) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB211"
    assert word in diagnostic.notes[0]


def test_zero_is_no_density(tmp_path: Path) -> None:
    """A density of 0, which some programs write by default, counts as none."""
    path = parts.write_box(tmp_path / "box.step", density=7850.0).path
    assert density_of(read_quietly(rewrite(path, ("MEASURE(7.85)", "MEASURE(0.)")))) is None


def test_densities_that_contradict_each_other(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Two contradictory densities are both ignored with a diagnostic."""
    path = parts.write_box(tmp_path / "box.step", density=7850.0).path
    text = path.read_text(encoding="utf-8").replace("\n", "")
    relation = re.search(r"#(\d+)=PROPERTY_DEFINITION\('material property','density',#(\d+)\)", text)
    measure = re.search(
        r"MEASURE_REPRESENTATION_ITEM\('density measure',\s*POSITIVE_RATIO_MEASURE\(7.85\),(#\d+)\)", text
    )
    context = re.search(r"REPRESENTATION\('density',\(#\d+\),(#\d+)\)", text)
    assert relation
    assert measure
    assert context
    second = f"""\
#9101=MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE(1.2),{measure[1]});
#9102=REPRESENTATION('density',(#9101),{context[1]});
#9103=PROPERTY_DEFINITION('material property','density',#{relation[2]});
#9104=PROPERTY_DEFINITION_REPRESENTATION(#9103,#9102);
"""
    assert density_of(read_here(rewrite(path, extra=second), diagnostics)) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB211"
    assert "7850, 1200" in diagnostic.message


def test_a_part_made_from_a_raw_material(tmp_path: Path) -> None:
    """Its density is the raw material's, and its material the name of that product, as in files of I-DEAS."""
    path = parts.write_box(tmp_path / "box.step", density=7850.0).path
    text = path.read_text(encoding="utf-8").replace("\n", "")
    part = re.search(r"(#\d+)=PRODUCT_DEFINITION\('[^']*','[^']*',#\d+,(#\d+)\)", text)
    product = re.search(r"PRODUCT\('[^']*','[^']*','[^']*',\((#\d+)\)\)", text)
    unit = re.search(r"POSITIVE_RATIO_MEASURE\(7.85\),(#\d+)\)", text)
    assert part
    assert product
    assert unit
    raw = f"""\
#9101=PRODUCT('bar','Bar of bronze','',({product[1]}));
#9102=PRODUCT_DEFINITION_FORMATION('','',#9101);
#9103=PRODUCT_DEFINITION('design','',#9102,{part[2]});
#9104=MEASURE_WITH_UNIT(COUNT_MEASURE(1.),{unit[1]});
#9105=MAKE_FROM_USAGE_OPTION('1','','',{part[1]},#9103,1,'',#9104);
"""
    made = rewrite(path, (f"'density',{part[1]}", "'density',#9103"), ("'stuff of 7850'", "''"), extra=raw)
    component = next(one for one in read_quietly(made).components if one.body >= 0)
    assert (component.material, component.density) == ("Bar of bronze", pytest.approx(7850.0, rel=1e-12))


@pytest.mark.parametrize(
    ("unit", "name", "scale"),
    [
        (INCH, "inch", 0.0254),
        (MILLIMETRE.replace(".MILLI.", ".MICRO."), "um", 1e-6),
        (MILLIMETRE.replace(".MILLI.", ".DECI."), "dm", 0.1),
        (INCH.replace("INCH", "CUBIT"), "cubit", 0.0254),
    ],
)
def test_length_units(unit: str, name: str, scale: float, tmp_path: Path) -> None:
    """A unit has its declared length, even if its name is unknown."""
    assembly = read_quietly(rewrite(parts.write_box(tmp_path / "box.step").path, (MILLIMETRE, unit)))
    assert assembly.unit == name
    assert assembly.unit_scale == pytest.approx(scale, rel=1e-12)
    (body,) = assembly.bodies
    assert body.exact is not None
    assert body.exact.volume == pytest.approx(100 * 60 * 40 * scale**3, rel=1e-9, abs=0)


def test_an_inch_of_another_size(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An inch that is not 25.4 mm has its declared size, with a warning."""
    path = parts.write_box(tmp_path / "box.step").path
    extra = EXTRA.replace("0.0254", "0.025")
    assembly = read_here(rewrite(path, (MILLIMETRE, INCH), extra=extra), diagnostics)
    assert assembly is not None
    assert assembly.unit_scale == pytest.approx(0.025)
    assert diagnostics.codes() == ["SB209"]
