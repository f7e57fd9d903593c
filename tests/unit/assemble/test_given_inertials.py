"""The `inertial` of a link is compared with its geometry, and with that of links fixed to it."""

from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, build

POSSIBLE = "{mass: 2, com: [0, 0, 0], inertia: {ixx: 1.2e-3, iyy: 1.2e-3, izz: 1.2e-3}}"


def _reported(tmp_path: Path, inertial: str, diagnostics: Diagnostics) -> list[tuple[str, str]]:
    """Codes and messages for a box of 100 x 60 x 40 mm with an ``inertial``."""
    shop = Workshop()
    shop.box("a", size=(100, 60, 40))
    build(shop, tmp_path, f"    links: {{base: {{rest: true, inertial: {inertial}}}}}\n", diagnostics)
    return [(one.code, one.message) for one in diagnostics]


@pytest.mark.parametrize(
    "inertial",
    [
        POSSIBLE,
        "{mass: 2}",  # scales what the shape has
        "{mass: 2, com: [5 mm, 3 mm, 2 mm]}",
        # The corners of the box, exactly: 2 kg at (+-50, +-30, +-20) mm.
        "{mass: 2, com: [0, 0, 0], inertia: {ixx: 2.6e-3, iyy: 5.8e-3, izz: 6.8e-3}}",
    ],
)
def test_possible_values_are_accepted(tmp_path: Path, inertial: str) -> None:
    """Values that a mass within the box can have, up to the bound, are not reported."""
    assert _reported(tmp_path, inertial, Diagnostics()) == []


def test_moment_above_its_bound(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A moment that would need mass outside the box is reported with the bound, at the link's `inertial`."""
    inertial = "{mass: 2, com: [0, 0, 0], inertia: {ixx: 0.02, iyy: 0.02, izz: 0.02}}"
    ((code, message),) = _reported(tmp_path, inertial, diagnostics)
    assert code == "SB518:large-inertia"
    assert message == (
        "link 'base': ixx = 0.02 kg m^2, but 2 kg with this com have at most 0.0026 within the geometry, "
        "x -50 to 50, y -30 to 30, z -20 to 20 mm"
    )


def test_moments_within_bounds_with_a_spread_above(tmp_path: Path) -> None:
    """If no moment exceeds its bound, the direction is named along which the mass would lie outside."""
    inertial = "{mass: 2, com: [0, 0, 0], inertia: {ixx: 2.5e-3, iyy: 2.5e-3, izz: 1e-3}}"
    ((code, message),) = _reported(tmp_path, inertial, Diagnostics())
    assert code == "SB518:large-inertia"
    assert "spreads the mass by 31.6 mm (root mean square) along (0.00, 0.00, 1.00)" in message
    assert message.endswith("by at most 20.0 mm")


def test_com_outside_the_geometry(tmp_path: Path) -> None:
    """A centre of mass outside the box is reported with its distance."""
    inertial = "{mass: 2, com: [0, 0, 50 mm], inertia: {ixx: 1e-3, iyy: 1e-3, izz: 1e-3}}"
    ((code, message),) = _reported(tmp_path, inertial, Diagnostics())
    assert code == "SB518:com"
    assert "com (0.0, 0.0, 50.0) mm is 30.0 mm outside its geometry" in message


def test_inertia_in_another_unit(tmp_path: Path) -> None:
    """An inertia a thousand times too small is reported."""
    inertial = "{mass: 2, com: [0, 0, 0], inertia: {ixx: 2e-6, iyy: 2e-6, izz: 2e-6}}"
    ((code, _),) = _reported(tmp_path, inertial, Diagnostics())
    assert code == "SB518:small-inertia"


@pytest.mark.parametrize(("kind", "codes"), [("fixed", []), ("continuous", ["SB521", "SB518:large-inertia"])])
def test_geometry_of_links_fixed_to_it_counts(tmp_path: Path, kind: str, codes: list[str]) -> None:
    """What is drawn on a link fixed to it counts as its geometry; what is beyond a moving joint does not."""
    shop = Workshop()
    shop.box("a", size=(20, 20, 20))
    shop.box("b", size=(400, 20, 20), X_PC=at(0, 0, 30))
    joint = f"{{type: {kind}, parent: base, child: b, origin: {{xyz: [0, 0, 30 mm]}}}}"
    inertial = "{mass: 2, com: [0, 0, 10 mm], inertia: {ixx: 1e-3, iyy: 0.02, izz: 0.02}}"
    text = f"""
    defaults: {{density: 1000}}
    links: {{base: {{rest: true, inertial: {inertial}}}, b: {{parts: [b]}}}}
    joints: {{j: {joint}}}
"""
    diagnostics = Diagnostics()
    build(shop, tmp_path, text, diagnostics)
    assert [one.code for one in diagnostics] == codes


def test_mass_too_large_for_the_volume(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Grams without a unit: 55 kg in a box of 24 cm^3; the remedy has the unit."""
    shop = Workshop()
    shop.box("a", size=(20, 30, 40))
    assert build(shop, tmp_path, "    links: {base: {rest: true, inertial: {mass: 55}}}\n", diagnostics) is not None
    (doubt,) = diagnostics
    words = "55 kg in 24 cm^3 is 2.29e+06 kg/m^3, more than any material has"
    assert (doubt.code, doubt.message) == ("SB521", f"link 'base': {words}")
    assert doubt.help[0] == "if the unit is g, write `55 g`; numbers without a unit are kilograms"
    build(shop, tmp_path, "    links: {base: {rest: true, inertial: {mass: 800 g}}}\n", diagnostics)
    assert "if the unit is g" not in "".join([*diagnostics][-1].help), "the unit is written"


def test_a_link_without_geometry_is_not_checked(tmp_path: Path) -> None:
    """There is no bound on the inertia of a link without geometry."""
    shop = Workshop()
    shop.box("a")
    inertial = "{mass: 2, com: [0, 0, 1], inertia: {ixx: 1, iyy: 1, izz: 1}}"
    text = f"""
    defaults: {{density: 1000}}
    links: {{base: {{rest: true}}, b: {{parts: [], inertial: {inertial}}}}}
    joints: {{j: {{type: continuous, parent: base, child: b, origin: {{xyz: [0, 0, 0]}}}}}}
"""
    diagnostics = Diagnostics()
    build(shop, tmp_path, text, diagnostics)
    assert [one.code for one in diagnostics] == []
