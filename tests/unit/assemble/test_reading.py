"""Mesh tolerances of links apply to the bodies of their parts."""

from pathlib import Path

import pytest

from stepbot.assemble import link_components
from stepbot.assemble.masses import read_options
from stepbot.diagnostics import Diagnostics
from stepbot.step.structure.repetition import definition_tolerances

from .workshop import Workshop, sidecar

JOINTS = """\
joints:
  a: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}
  b: {type: fixed, parent: arm, child: motor, origin: {xyz: [0, 0, 0]}}
"""
OWN = {"base": 0.1e-3, "arm": 0.2e-3, "motor": 0.3e-3}
"""Tolerance [m] of links that set one."""
ROBOT = 1e-3


def _shop() -> Workshop:
    """``arm`` with a tube and a ``motor`` of two parts; a plate beside it."""
    shop = Workshop()
    shop.box("plate", (10, 10, 10))
    arm = shop.group("arm")
    shop.box("tube", (10, 10, 10), parent=arm)
    motor = shop.group("motor", arm)
    for name in ("case", "horn"):
        shop.box(name, (10, 10, 10), parent=motor)
    return shop


@pytest.mark.parametrize("fine", [(), ("arm",), ("base",), ("motor",), ("base", "arm"), ("base", "arm", "motor")])
@pytest.mark.parametrize(
    "parts",
    [{"arm": "arm", "motor": "motor"}, {"arm": "arm/tube", "motor": "arm"}, {"arm": "**/tube", "motor": "**/motor"}],
)
def test_each_body_has_the_tolerance_of_its_link(tmp_path: Path, fine: tuple[str, ...], parts: dict[str, str]) -> None:
    """A part assigned separately has the tolerance of its own link; a link with `rest` has tolerances, too."""
    claims = {"base": "rest: true", **{link: f"parts: ['{path}']" for link, path in parts.items()}}
    links = "".join(
        f"  {link}: {{{claim}{f', mesh: {{tolerance: {OWN[link]} m}}' if link in fine else ''}}}\n"
        for link, claim in claims.items()
    )
    shop, diagnostics = _shop(), Diagnostics()
    loaded = sidecar(tmp_path, f"mesh: {{tolerance: {ROBOT} m}}\nlinks:\n{links}{JOINTS}")
    components = shop.assembly.components
    tolerances = definition_tolerances(components, range(len(shop.assembly.bodies)), read_options(loaded.document))
    for link, indices in link_components(shop.assembly, loaded, diagnostics).items():
        assert indices
        for index in indices:
            expected = OWN[link] if link in fine else ROBOT
            assert [one.absolute for one in tolerances[components[index].body]] == [expected], components[index].path
    assert not diagnostics.has_errors


def test_without_tolerances_of_links_the_geometry_depends_on_no_link(tmp_path: Path) -> None:
    """Without tolerances of links, a change of their parts does not read the STEP again."""
    loaded = sidecar(
        tmp_path, f"links: {{base: {{rest: true}}, arm: {{parts: [arm]}}, motor: {{parts: [motor]}}}}\n{JOINTS}"
    )
    assert read_options(loaded.document).tolerance_of == ()
