"""Densities, measured masses and inertias: the source of each mass, against closed forms."""

from math import fsum
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import force_setattr

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import rotation_from_rpy
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.model import ComponentMass, Link, Robot
from stepbot.step.assembly import BodyKind
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, box_inertia, build, built, cylinder_inertia

ONE = "    links: {base: {rest: true}}\n"
TWO = """
    links: {base: {rest: true}, arm: {parts: [arm]}}
    joints: {j: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}}
"""
CUBE = 1e-6
"""Volume [m^3] of the cube of 10 mm."""


def _sources(robot: Robot) -> dict[str, ComponentMass]:
    return {source.component: source for link in robot.links for source in link.masses}


def _masses(robot: Robot) -> dict[str, float]:
    return {name: source.mass for name, source in _sources(robot).items()}


def _mass(link: Link) -> MassProperties:
    return link.mass_properties


def test_each_field_comes_from_the_first_rule_that_sets_it(tmp_path: Path) -> None:
    """The density is that of a rule, a rule's material, the STEP or the defaults, in this order, with its source."""
    shop = Workshop()
    shop.box("a", density=7850)
    shop.box("b", density=7850)
    shop.box("c", density=7850)
    shop.box("d")
    text = """
    materials: {pla: {density: 1240 kg/m^3}, paint: {color: "#ff0000"}}
    defaults: {density: 500}
    parts:
      a: {color: "#000000"}
      b: {material: pla}
      c: {material: paint}
      "*": {density: 2000}
      d: {density: 9999}
"""
    sources = _sources(built(shop, tmp_path, text + ONE))
    assert {k: v.density for k, v in sources.items()} == {"a": 2000, "b": 1240, "c": 2000, "d": 2000}
    assert [v.origin for v in sources.values()] == [
        "parts rule '*'",
        "parts rule 'b'",
        "parts rule '*'",
        "parts rule '*'",
    ]
    assert sum(v.mass for v in sources.values()) == pytest.approx(7240 * CUBE)


def _of_code(code: str, diagnostics: Diagnostics) -> list[tuple[str, tuple[str, ...]]]:
    return [(one.message, one.help) for one in diagnostics if one.code == code]


def test_rules_below_a_general_glob_are_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Each names the fields without effect and the rule that has set them; a rule with some effect is not shadowed."""
    shop = Workshop()
    for name in ("a", "b", "c"):
        shop.box(name)
    text = """
    parts:
      c: {mass: 5 g}
      "*": {density: 2000, visual: true}
      a: {density: 500, color: "#ff0000"}
      b: {density: 2000, visual: true}
      c#1: {mass: 7 g}
"""
    build(shop, tmp_path, text + ONE, diagnostics)
    (density, mass) = _of_code("SB306", diagnostics)
    assert density[0] == "parts rule 'a': 'density' without effect: set by '*' above"
    assert density[1] == ("of several rules the first holds: move this rule above '*', or remove it",)
    assert mass[0] == "parts rule 'c#1': 'mass' without effect: set by 'c' above"


def test_specific_rules_above_a_glob_are_no_fault(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The glob holds for the rest; if there is none, it changes nothing unless it says otherwise."""
    shop = Workshop()
    shop.box("a")
    shop.box("b")
    build(shop, tmp_path, "    parts: {a: {density: 500}, '*': {density: 2000}}\n" + ONE, diagnostics)
    assert _of_code("SB306", diagnostics) == []
    build(shop, tmp_path, "    parts: {a: {density: 5}, b: {density: 5}, '*': {density: 5}}\n" + ONE, diagnostics)
    assert _of_code("SB306", diagnostics) == []


def test_a_density_to_do_is_a_warning_until_it_is_given(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Components with a density of their own, and links with an inertial, do not need it."""
    shop = Workshop()
    shop.box("a")
    shop.box("arm", density=7850)
    robot = built(shop, tmp_path, "    defaults: {density: todo}\n" + TWO)
    assert {k: (v.density, v.origin) for k, v in _sources(robot).items()} == {
        "a": (1000.0, "defaults: todo"),
        "arm": (7850.0, "STEP"),
    }
    build(shop, tmp_path, "    defaults: {density: todo}\n" + TWO, diagnostics)
    ((message, help),) = _of_code("SB522", diagnostics)
    assert (
        message
        == 'defaults.density: component "a" has the placeholder `todo` as density: 1000 kg/m^3, 0.001 kg in total'
    )
    assert help
    for given in ("{a: {density: 500}}", "{a: {mass: 5 g}}"):
        known = Diagnostics()
        build(shop, tmp_path, f"    defaults: {{density: todo}}\n    parts: {given}\n" + TWO, known)
        assert _of_code("SB522", known) == []


def test_own_density_beats_the_material_of_the_same_rule(tmp_path: Path) -> None:
    """In one rule, a density takes precedence over a material."""
    shop = Workshop()
    shop.box("a")
    text = "    materials: {pla: {density: 1240}}\n    parts: {a: {material: pla, density: 300}}\n" + ONE
    assert _sources(built(shop, tmp_path, text))["a"].density == 300


def test_step_density_and_defaults(tmp_path: Path) -> None:
    """The density of the STEP takes precedence over the defaults unless it is ignored."""
    shop = Workshop()
    shop.box("a", density=7850)
    shop.box("b")
    text = "    materials: {pla: {density: 1240}}\n    defaults: {material: pla}\n" + ONE
    assert [(s.density, s.origin) for s in _sources(built(shop, tmp_path, text)).values()] == [
        (7850, "STEP"),
        (1240, "defaults"),
    ]
    robot = built(shop, tmp_path, "    step_density: ignore\n" + text)
    assert [s.origin for s in _sources(robot).values()] == ["defaults", "defaults"]
    robot = built(shop, tmp_path, text.replace("{material: pla}", "{material: pla, density: 1000}"))
    assert _sources(robot)["b"].density == 1000


def test_materials_that_the_step_names(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A material named in the STEP is looked up in ``materials``, after rules and the STEP's density."""
    shop = Workshop()
    parts = {"ruled": None, "dense": 2700.0, "named": None, "colored": None, "unlisted": None, "unnamed": None}
    for i, (name, density) in enumerate(parts.items()):
        shop.box(name, X_PC=at(20 * i, 0, 0), density=density)
    for i, material in enumerate(("ABS / PC", "ABS / PC", " ABS / PC ", "paint", "Steel"), start=1):
        shop.made_of(i, material)
    text = """
    materials: {"ABS / PC": {density: 1150}, paint: {color: "#ff0000"}}
    defaults: {density: 500}
    parts: {ruled: {density: 3}}
"""
    robot = build(shop, tmp_path, text + ONE, diagnostics)
    assert robot is not None
    assert [(s.density, s.origin) for s in _sources(robot).values()] == [
        (3, "parts rule 'ruled'"),
        (2700, "STEP"),
        (1150, "material 'ABS / PC' in the STEP"),
        (500, "defaults"),
        (500, "defaults"),
        (500, "defaults"),
    ]
    (note,) = diagnostics
    assert (note.code, note.severity, note.span.line) == ("SB515", "note", 5)
    assert note.notes == ("'paint': \"colored\"", "'Steel': \"unlisted\"")
    assert note.help == ('define it: `materials: {"paint": {density: ...}}`',)

    again = Diagnostics()
    robot = build(shop, tmp_path, "    step_density: ignore\n" + text + ONE, again)
    assert robot is not None
    assert _sources(robot)["dense"].origin == "material 'ABS / PC' in the STEP"
    assert not list(again)


def test_a_missing_density_names_the_material(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """If the STEP names the material of a part without density, the remedy is a line in ``materials``, which works."""
    shop = Workshop()
    shop.made_of(shop.box("a"), "PLA")
    assert build(shop, tmp_path, ONE, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB501"
    assert '`materials: {"PLA": {density: 1240 kg/m^3}}`' in fault.help[-1]
    assert _masses(built(shop, tmp_path, '    materials: {"PLA": {density: 1240 kg/m^3}}\n' + ONE)) == {
        "a": pytest.approx(1240 * CUBE)
    }


def test_rules_reach_down(tmp_path: Path) -> None:
    """A rule on a subassembly applies to everything below it."""
    shop = Workshop()
    motor = shop.group("motor")
    shop.box("case", parent=motor)
    shop.box("horn", parent=motor)
    robot = built(shop, tmp_path, "    parts: {horn: {density: 1}, motor: {density: 2}}\n" + ONE)
    assert {k: v.density for k, v in _sources(robot).items()} == {"motor/case": 2, "motor/horn": 1}


def test_missing_density_is_an_error(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """All components without a density are in one error with the remedy."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", density=7850)
    shop.box("c")
    assert build(shop, tmp_path, ONE, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB501"
    assert fault.notes == ('"a"', '"c"')
    assert any("defaults: {density:" in text for text in fault.help)


def test_one_density_for_everything_is_suspicious(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Equal STEP densities of all definitions are a warning, unless they are ignored or overridden."""
    shop = Workshop()
    shop.box("a", density=7850)
    shop.box("b", X_PC=at(20, 0, 0), density=7850)
    assert build(shop, tmp_path, ONE, diagnostics) is not None
    (fault,) = diagnostics
    assert (fault.code, fault.severity) == ("SB502", "warning")
    assert "7850 kg/m^3" in fault.message
    built_quietly = [
        "    step_density: ignore\n    defaults: {density: 1}\n" + ONE,
        '    parts: {"**": {density: 1}}\n' + ONE,
    ]
    for text in built_quietly:
        build(shop, tmp_path, text, diagnostics)
    shop.box("c", X_PC=at(40, 0, 0), density=1000)
    build(shop, tmp_path, ONE, diagnostics)
    single = Workshop()
    first = single.box("a", density=7850)
    single.again(first, at(50, 0, 0))
    build(single, tmp_path, ONE, diagnostics)
    assert len(diagnostics) == 1


def test_link_mass_is_the_sum_of_its_parts(tmp_path: Path) -> None:
    """Mass, com and inertia of a link of moved solids equal the closed forms, in the link's frame."""
    shop = Workshop()
    shop.box("plate", (100, 40, 6), at(10, 20, 30, (0.3, -0.2, 0.9)))
    shop.rod("rod", 5, 80, at(-40, 5, 12, (1.1, 0.4, -0.3)))
    text = """
    mass: exact
    parts: {plate: {density: 2700}, rod: {density: 7850}}
    root: {link: base, frame: {xyz: [0.1, 0, 0], rpy: [0, 0, 90 deg]}}
"""
    properties = _mass(built(shop, tmp_path, text + ONE).root)

    R_RW = rotation_from_rpy((0, 0, np.pi / 2)).T
    bodies = []
    for pose, density, volume, inertia in (
        (at(10, 20, 30, (0.3, -0.2, 0.9)), 2700, 0.1 * 0.04 * 0.006, box_inertia((0.1, 0.04, 0.006))),
        (at(-40, 5, 12, (1.1, 0.4, -0.3)), 7850, np.pi * 0.005**2 * 0.08, cylinder_inertia(0.005, 0.08)),
    ):
        R = R_RW @ pose.R
        bodies.append((density * volume, R_RW @ (pose.p - [0.1, 0, 0]), density * R @ inertia @ R.T))
    mass = sum(m for m, _, _ in bodies)
    com = sum(m * p for m, p, _ in bodies) / mass
    inertia = sum(own + m * ((p - com) @ (p - com) * np.eye(3) - np.outer(p - com, p - com)) for m, p, own in bodies)
    assert properties.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(properties.com, com, atol=1e-12)
    np.testing.assert_allclose(properties.inertia, inertia, rtol=1e-9, atol=1e-15)


def test_mass_on_a_component_scales_its_inertia(tmp_path: Path) -> None:
    """A measured mass keeps the com and scales the inertia, with or without a density."""
    shop = Workshop()
    shop.box("a", (10, 20, 30), at(5, 0, 0))
    robot = built(shop, tmp_path, "    parts: {a: {mass: 60 g}}\n" + ONE)
    properties = _mass(robot.root)
    assert properties.mass == pytest.approx(0.06)
    np.testing.assert_allclose(properties.com, (0.005, 0, 0), atol=1e-15)
    np.testing.assert_allclose(properties.inertia, box_inertia((0.01, 0.02, 0.03)) * 1e4, rtol=1e-12)
    volume = pytest.approx(6e-6, rel=1e-12)
    assert _sources(robot)["a"] == ComponentMass("a", pytest.approx(0.06), None, volume, "parts rule 'a'", "mesh")


def test_mass_that_no_material_has(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Grams without a unit are kilograms: one warning for the rule, with the value in grams."""
    shop = Workshop()
    servo = shop.box("servo", (45, 25, 32), occurrence="servo:1")
    shop.again(servo, at(100, 0, 0))
    text = "    parts: {'servo*': {mass: MASS}}\n" + ONE
    build(shop, tmp_path, text.replace("MASS", "55"), diagnostics)
    (doubt,) = diagnostics
    words = "55 kg in 36 cm^3 is 1.53e+06 kg/m^3, more than any material has"
    assert (doubt.code, doubt.message) == ("SB521", f"parts rule 'servo*': {words}")
    assert doubt.help[0] == "if the unit is g, write `55 g`; numbers without a unit are kilograms"
    assert _mass(built(shop, tmp_path, text.replace("MASS", "55 g")).root).mass == pytest.approx(0.11)


def test_mass_of_a_subassembly_is_shared_by_computed_mass_across_links(tmp_path: Path) -> None:
    """The mass of a subassembly is shared among its parts by density times volume, whichever link they are in."""
    shop = Workshop()
    for i in range(2):
        motor = shop.group("motor", X_PC=at(100 * i, 0, 0), occurrence=f"motor:{i + 1}")
        if i == 0:
            case = shop.box("case", (10, 10, 30), parent=motor)
            horn = shop.box("horn", (10, 10, 10), parent=motor)
        else:
            shop.again(case, at(0, 0, 0), motor)
            shop.again(horn, at(0, 0, 0), motor)
    text = """
    defaults: {density: 1000}
    parts: {"**/horn": {density: 3000}, "motor": {mass: 60 g}}
    links: {base: {rest: true}, arm: {parts: ["**/horn"]}}
    joints: {j: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}}
"""
    masses = _masses(built(shop, tmp_path, text))
    assert len(masses) == 4
    assert list(masses.values()) == pytest.approx([0.03] * 4)


def test_mass_of_a_subassembly_is_shared_by_volume_if_a_density_is_missing(tmp_path: Path) -> None:
    """If a density is missing, the mass of a subassembly is shared by volume."""
    shop = Workshop()
    motor = shop.group("motor")
    shop.box("case", (10, 10, 30), parent=motor, density=9000)
    shop.box("horn", (10, 10, 10), parent=motor)
    masses = _masses(built(shop, tmp_path, "    parts: {motor: {mass: 40 g}}\n" + ONE))
    assert masses == pytest.approx({"motor/case": 0.03, "motor/horn": 0.01})


def test_ignored_parts_get_no_share(tmp_path: Path) -> None:
    """Ignored parts get no share; the others have the whole mass."""
    shop = Workshop()
    motor = shop.group("motor")
    shop.box("case", parent=motor)
    shop.box("screw", parent=motor)
    text = "    parts: {screw: {ignore: true}, motor: {mass: 40 g}}\n" + ONE
    assert _masses(built(shop, tmp_path, text)) == pytest.approx({"motor/case": 0.04})


def _nested_shop() -> Workshop:
    shop = Workshop()
    arm = shop.group("arm")
    motor = shop.group("motor", arm)
    shop.box("case", (10, 10, 10), parent=motor)
    shop.box("horn", (10, 10, 30), parent=motor)
    shop.box("tube", (10, 10, 20), parent=arm)
    shop.box("cap", (10, 10, 60), parent=arm)
    return shop


def test_of_nested_masses_the_outer_is_the_total(tmp_path: Path) -> None:
    """Of nested masses the inner ones are kept, and the rest of the outer one is shared among the other parts."""
    text = "    defaults: {density: 1000}\n    parts: {motor: {mass: 40 g}, arm: {mass: 200 g}}\n" + ONE
    masses = _masses(built(_nested_shop(), tmp_path, text))
    assert masses == pytest.approx({"arm/motor/case": 0.01, "arm/motor/horn": 0.03, "arm/tube": 0.04, "arm/cap": 0.12})


def test_a_glob_that_matches_a_part_of_its_match_weighs_once(tmp_path: Path) -> None:
    """A rule that matches a subassembly and a part of it gives the mass of the subassembly."""
    shop = Workshop()
    motor = shop.group("XL-430")
    shop.box("XL-430 case", (10, 10, 10), parent=motor)
    shop.box("horn", (10, 10, 30), parent=motor)
    text = '    defaults: {density: 1000}\n    parts: {"**/XL*": {mass: 40 g}}\n' + ONE
    assert _masses(built(shop, tmp_path, text)) == pytest.approx({"XL-430/XL-430 case": 0.01, "XL-430/horn": 0.03})


@pytest.mark.parametrize("outer", ["30 g", "40 g"])
def test_nested_masses_that_contradict(outer: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Inner masses that leave nothing for the rest are replaced by shares of the outer mass, with a warning."""
    text = f"    defaults: {{density: 1000}}\n    parts: {{motor: {{mass: 40 g}}, arm: {{mass: {outer}}}}}\n" + ONE
    robot = build(_nested_shop(), tmp_path, text, diagnostics)
    assert robot is not None
    total = float(outer.removesuffix(" g")) * 1e-3
    assert _mass(robot.root).mass == pytest.approx(total)
    assert _masses(robot)["arm/cap"] == pytest.approx(total / 2)
    (fault,) = diagnostics
    assert fault.code == "SB504"


def test_nested_masses_that_do_not_add_up(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """If every part has a mass and the sum differs from the outer mass, the outer one is used."""
    text = "    parts: {motor: {mass: 40 g}, tube: {mass: 10 g}, cap: {mass: 50 g}, arm: {mass: 100 g}}\n" + ONE
    assert _masses(built(_nested_shop(), tmp_path, text))["arm/cap"] == pytest.approx(0.05)
    robot = build(_nested_shop(), tmp_path, text.replace("100 g", "90 g"), diagnostics)
    assert robot is not None
    assert _mass(robot.root).mass == pytest.approx(0.09)
    assert diagnostics.codes() == ["SB504"]


@pytest.mark.parametrize("masses", [(0.011, 0.011, 0.013), (0.013, 0.011, 0.011)])
def test_decimal_masses_that_add_up(masses: tuple[float, ...], tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Masses whose decimals add up to the outer one do not contradict it, although their doubles do not add up."""
    motor, tube, cap = masses
    assert fsum(masses) != 0.035
    inner = f"motor: {{mass: {motor}}}, tube: {{mass: {tube}}}, cap: {{mass: {cap}}}"
    robot = build(_nested_shop(), tmp_path, f"    parts: {{{inner}, arm: {{mass: 0.035}}}}\n" + ONE, diagnostics)
    assert robot is not None
    assert _masses(robot)["arm/cap"] == pytest.approx(cap)
    assert "SB504" not in diagnostics.codes()


def test_mass_on_a_surface_is_an_error(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A mass on a surface body is an error."""
    shop = Workshop()
    shop.box("sheet", kind=BodyKind.SURFACE)
    shop.box("plate", density=1000)
    assert build(shop, tmp_path, "    parts: {sheet: {mass: 5 g}}\n" + ONE, diagnostics) is None
    assert diagnostics.codes() == ["SB503", "SB506"]


def test_surfaces_weigh_nothing_and_are_drawn(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A surface body adds no mass, keeps its visual, and is reported in a note."""
    shop = Workshop()
    shop.box("sheet", kind=BodyKind.SURFACE)
    shop.box("plate", density=1000)
    robot = build(shop, tmp_path, ONE, diagnostics)
    assert robot is not None
    assert _mass(robot.root).mass == pytest.approx(1000 * CUBE)
    assert len(robot.root.visuals) == 2
    (note,) = diagnostics
    assert (note.code, note.severity) == ("SB506", "note")


def test_a_solid_without_volume_is_an_error(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A solid without measurable volume is an error, unless its link needs no mass."""
    shop = Workshop()
    shop.box("broken", kind=BodyKind.SURFACE)
    force_setattr(shop.bodies[0], "kind", BodyKind.SOLID)
    assert build(shop, tmp_path, "    defaults: {density: 1}\n" + ONE, diagnostics) is None
    assert diagnostics.codes() == ["SB507"]
    inertial = "{mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}"
    text = f"    links: {{base: {{rest: true, inertial: {inertial}}}}}\n"
    assert _mass(built(shop, tmp_path, text).root).mass == 1.0


def test_inertial_overrules(tmp_path: Path) -> None:
    """``inertial`` is com in the link's frame and inertia about it along the link's axes; products as in URDF."""
    shop = Workshop()
    shop.box("a")
    text = """
    links:
      base:
        rest: true
        inertial: {mass: 0.11 kg, com: [0, 0, 20 mm], inertia: {ixx: 1e-5, iyy: 1e-5, izz: 1.5e-5, ixy: 1e-6}}
"""
    robot = built(shop, tmp_path, text)
    assert _mass(robot.root) == MassProperties(
        0.11, (0.0, 0.0, 0.02), ((1e-5, 1e-6, 0.0), (1e-6, 1e-5, 0.0), (0.0, 0.0, 1.5e-5))
    )
    assert robot.root.masses == (ComponentMass("", 0.11, None, None, "inertial of link 'base'", "given"),)


def test_inertial_mass_alone_scales(tmp_path: Path) -> None:
    """``inertial`` with a mass alone keeps the com and scales the inertia; parts without density share by volume."""
    shop = Workshop()
    shop.box("a", (10, 10, 30), at(0, 0, 0), density=5000)
    shop.box("b", (10, 10, 10), at(0, 0, 20))
    robot = built(shop, tmp_path, "    links: {base: {rest: true, inertial: {mass: 80 g}}}\n")
    assert _mass(robot.root).mass == pytest.approx(0.08)
    np.testing.assert_allclose(_mass(robot.root).com, (0, 0, 0.005), atol=1e-15)
    np.testing.assert_allclose(_mass(robot.root).inertia, box_inertia((0.01, 0.01, 0.04)) * 2e4, rtol=1e-12)
    assert _masses(robot) == pytest.approx({"a": 0.06, "b": 0.02})


def test_inertial_mass_on_nothing(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """``inertial`` with a mass alone on a link without volumes is an error."""
    shop = Workshop()
    shop.box("a", density=1)
    text = TWO.replace("arm: {parts: [arm]}", "arm: {inertial: {mass: 1}}")
    assert build(shop, tmp_path, text, diagnostics) is None
    assert diagnostics.codes() == ["SB503"]


def test_mesh_where_it_agrees_else_exact(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """``mass: auto`` uses the mesh within 1e-3 of the exact solid, else the exact solid, and reports which."""
    shop = Workshop()
    shop.rod("fine", sides=256)
    shop.rod("coarse", X_PC=at(20, 0, 0), sides=24)
    robot = build(shop, tmp_path, "    defaults: {density: 1000}\n" + ONE, diagnostics)
    assert robot is not None
    sources = _sources(robot)
    assert sources["fine"].method == "mesh"
    prism = 0.5 * 256 * 0.004**2 * np.sin(2 * np.pi / 256) * 0.02
    assert sources["fine"].mass == pytest.approx(1000 * prism, rel=1e-12)
    assert sources["coarse"].method.startswith("exact: mesh differs by ")
    assert sources["coarse"].mass == pytest.approx(1000 * np.pi * 0.004**2 * 0.02, rel=1e-12)
    (note,) = diagnostics
    assert (note.code, note.severity) == ("SB505", "note")
    # The polar moment of an inscribed n-gon is (2 + cos t) sin t / 3 t of the circle's, t = 2 pi / n.
    t = 2 * np.pi / 24
    off = 1 - (2 + np.cos(t)) * np.sin(t) / (3 * t)
    assert note.notes == (f"coarse: exact: mesh differs by {off:.1e} in inertia",)


def test_com_and_inertia_count_too(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The exact solid is used if com or inertia of the mesh deviate, even if its volume does not."""
    for fault in ("com", "inertia"):
        shop = Workshop()
        shop.box("a", density=1000)
        com = np.array([2e-5 if fault == "com" else 0.0, 0, 0])
        inertia = box_inertia((0.01, 0.01, 0.01)) * (1.002 if fault == "inertia" else 1.0)
        shop.measures[0] = VolumeProperties.of(CUBE, com, inertia)
        robot = build(shop, tmp_path, ONE, diagnostics)
        assert robot is not None
        assert _sources(robot)["a"].method.endswith(f" in {fault}")
    assert len(diagnostics) == 2


def test_exact_and_mesh_on_request(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """``mass: exact`` uses the solid; ``mass: mesh`` the finest mesh, with a warning if it deviates."""
    shop = Workshop()
    shop.rod("a", sides=24, density=1000)
    exact = 1000 * np.pi * 0.004**2 * 0.02
    assert _masses(built(shop, tmp_path, "    mass: exact\n" + ONE))["a"] == pytest.approx(exact, rel=1e-12)
    robot = build(shop, tmp_path, "    mass: mesh\n" + ONE, diagnostics)
    assert robot is not None
    assert _masses(robot)["a"] == pytest.approx(1000 * shop.measures[0].volume, rel=1e-12)  # type: ignore[union-attr]
    (fault,) = diagnostics
    assert (fault.code, fault.severity) == ("SB511", "warning")
    fine = Workshop()
    fine.rod("a", sides=512)
    force_setattr(shop.bodies[0], "refined", fine.measures[0])
    assert _masses(built(shop, tmp_path, "    mass: mesh\n" + ONE))["a"] == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("mode", ["auto", "mesh", "exact"])
def test_mass_properties_that_nothing_confirms_are_an_error(
    mode: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """Uncertain mass properties are an error in every mode, unless the link has an ``inertial``."""
    shop = Workshop()
    shop.box("a", density=1000)
    force_setattr(shop.bodies[0], "exact_error", 0.4)
    force_setattr(shop.bodies[0], "defect", "its mass properties do not converge")
    build(shop, tmp_path, f"    mass: {mode}\n" + ONE, diagnostics)
    faults = [fault for fault in diagnostics if fault.code == "SB516"]
    assert [fault.severity for fault in faults] == ["error"]
    assert faults[0].notes == ("a: its mass properties do not converge",)
    given = "    links: {base: {rest: true, inertial: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}}}\n"
    robot = built(shop, tmp_path, f"    mass: {mode}\n" + given)
    assert _mass(robot.root).mass == 1.0


def test_roughly_known_mass_properties_are_used_and_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Methods that agree to a few percent give a robot with the exact solid's, and the report says how well known."""
    shop = Workshop()
    shop.box("a", density=1000)
    force_setattr(shop.bodies[0], "exact_error", 0.05)
    exact = shop.bodies[0].exact
    robot = build(shop, tmp_path, ONE, diagnostics)
    assert robot is not None
    assert exact is not None
    assert _mass(robot.root).mass == pytest.approx(1000 * exact.volume)
    (note,) = (fault for fault in diagnostics if fault.code == "SB505")
    assert note.notes == ("a: exact: accurate to 5.0% only",)


def test_an_open_mesh_gives_way(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """With an open mesh the exact solid is used, with the reason; a closed tessellation is sufficient."""
    shop = Workshop()
    shop.box("a", density=1000)
    shop.box("b", X_PC=at(20, 0, 0), density=2000)
    shop.measures[0] = None
    force_setattr(shop.bodies[0], "defect", "face 3 has no triangles")
    force_setattr(shop.bodies[1], "exact", None)
    force_setattr(shop.bodies[1], "kind", BodyKind.TESSELLATED)
    robot = build(shop, tmp_path, ONE, diagnostics)
    assert robot is not None
    assert _sources(robot)["a"].method == "exact: face 3 has no triangles"
    assert _sources(robot)["b"].method == "mesh"
    assert diagnostics.codes() == ["SB505"]


def test_total_does_not_depend_on_the_links(tmp_path: Path) -> None:
    """Mass and com of the whole robot do not depend on the assignment of components to links."""
    shop = Workshop()
    shop.box("arm", (30, 20, 10), at(3, 4, 5, (0.1, 0.2, 0.3)))
    shop.rod("post", 6, 50, at(-9, 0, 7))
    head = "    defaults: {density: 1000}\n"
    one = built(shop, tmp_path, head + ONE).root
    two = built(shop, tmp_path, head + TWO.replace("xyz: [0, 0, 0]", "xyz: [0.2, 0.1, 0], rpy: [1, 2, 3]"))
    total = sum(_mass(link).mass for link in two.links)
    assert total == pytest.approx(_mass(one).mass, rel=1e-12)
    X_WA = two.joints[0].X_PC
    com = sum(
        _mass(link).mass * X.apply(_mass(link).com) for link, X in zip(two.links, (at(0, 0, 0), X_WA), strict=True)
    )
    np.testing.assert_allclose(com / total, _mass(one).com, atol=1e-12)
