"""Assignment of components to links: the nearest claim wins, and every component is in exactly one link."""

from pathlib import Path

from stepbot.diagnostics import Diagnostics
from stepbot.robot.model import Robot
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, build, built

TWO = """
    defaults: {density: 1000}
    joints:
      j: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}
"""


def _motor_shop() -> Workshop:
    """A motor of case, horn and two screws, and a plate."""
    shop = Workshop()
    motor = shop.group("motor")
    shop.box("case", parent=motor)
    shop.box("horn", parent=motor, X_PC=at(0, 0, 20))
    shop.box("screw", parent=motor, X_PC=at(0, 0, 30))
    shop.box("screw", parent=motor, X_PC=at(0, 0, 40))
    shop.box("plate", X_PC=at(20, 0, 0))
    return shop


def _components(robot: Robot) -> dict[str, tuple[str, ...]]:
    return {link.name: link.components for link in robot.links}


def test_nearest_claim_wins(tmp_path: Path) -> None:
    """A link that names a motor gets it, except for its horn, which another link names."""
    robot = built(
        _motor_shop(), tmp_path, TWO + '    links: {base: {parts: ["motor", "plate"]}, arm: {parts: ["horn"]}}\n'
    )
    assert _components(robot) == {
        "base": ("motor/case", "motor/screw#1", "motor/screw#2", "plate"),
        "arm": ("motor/horn",),
    }


def test_claims_may_alternate_on_the_way_down(tmp_path: Path) -> None:
    """A claim below another claim applies to its own subtree, to any depth."""
    shop = Workshop()
    a = shop.group("a")
    b = shop.group("b", a)
    c = shop.group("c", b)
    shop.box("x", parent=c)
    shop.box("y", parent=b)
    shop.box("z", parent=a)
    robot = built(shop, tmp_path, TWO + "    links: {base: {parts: [a, a/b/c]}, arm: {parts: [a/b]}}\n")
    assert _components(robot) == {"base": ("a/b/c/x", "a/z"), "arm": ("a/b/y",)}


def test_rest_takes_what_no_link_claims(tmp_path: Path) -> None:
    """``rest`` takes all unclaimed components; a claim on the root's own path takes everything."""
    robot = built(_motor_shop(), tmp_path, TWO + '    links: {base: {rest: true}, arm: {parts: ["**/screw"]}}\n')
    assert _components(robot)["arm"] == ("motor/screw#1", "motor/screw#2")
    assert _components(robot)["base"] == ("motor/case", "motor/horn", "plate")
    robot = built(_motor_shop(), tmp_path, TWO + '    links: {base: {parts: ["."]}, arm: {parts: [horn]}}\n')
    assert len(_components(robot)["base"]) == 4


def test_ignored_components_are_in_no_link(tmp_path: Path) -> None:
    """``ignore`` excludes components and whole subassemblies; the first rule that sets it applies."""
    text = (
        TWO
        + """
    parts:
      "motor/screw#1": {ignore: false}
      "**/screw": {ignore: true}
    links: {base: {parts: [motor]}, arm: {parts: [plate]}}
"""
    )
    robot = built(_motor_shop(), tmp_path, text)
    assert _components(robot)["base"] == ("motor/case", "motor/horn", "motor/screw#1")
    text = (
        TWO
        + """
    parts: {motor: {ignore: true}}
    links:
      base: {rest: true}
      arm: {inertial: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}}
"""
    )
    assert _components(built(_motor_shop(), tmp_path, text)) == {"base": ("plate",), "arm": ()}


def test_two_links_on_one_component(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A component claimed by a second link is reported at the second claim, with both links."""
    text = (
        TWO
        + """
      k: {type: fixed, parent: arm, child: other, origin: {xyz: [0, 0, 0]}}
    links:
      base: {rest: true}
      arm: {parts: [horn]}
      other: {parts: [plate, motor/horn]}
"""
    )
    assert build(_motor_shop(), tmp_path, text, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB303"
    assert fault.message == "link 'other': \"motor/horn\" is already in link 'arm'"
    lines = (tmp_path / "test.robot.yaml").read_text(encoding="utf-8").splitlines()
    assert lines[fault.span.line - 1][fault.span.column - 1 :].startswith("motor/horn")


def test_components_in_no_link_are_listed(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """One error lists unassigned components, a subassembly as one entry if all of it is unassigned."""
    shop = _motor_shop()
    hand = shop.group("hand")
    shop.box("palm", parent=hand)
    shop.box("thumb", parent=hand)
    build(shop, tmp_path, TWO + "    links: {base: {parts: [plate]}, arm: {parts: [motor/case]}}\n", diagnostics)
    (fault,) = diagnostics
    assert fault.code == "SB304"
    assert fault.message == "robot.step: 5 components are not assigned to any link"
    assert fault.notes == ('"motor/horn"', '"motor/screw#1"', '"motor/screw#2"', '"hand"')


def test_misspelt_part_comes_with_near_matches(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A path without a match is an error with similar names; the error about unassigned components refers to it."""
    build(
        _motor_shop(), tmp_path, TWO + "    links: {base: {parts: [plate, motor]}, arm: {parts: [hron]}}\n", diagnostics
    )
    (fault,) = diagnostics
    assert fault.code == "SB301"
    assert fault.message == "link 'arm': no component 'hron' in robot.step"
    assert fault.help == ("did you mean 'horn'?",)


def test_every_unbound_path_is_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """All unknown and ambiguous paths in links and rules are reported in one run."""
    shop = _motor_shop()
    other = shop.group("other")
    shop.box("horn", parent=other)
    text = (
        TWO
        + """
    parts: {"**/M3*": {ignore: true}}
    links: {base: {parts: [motro], rest: true}, arm: {parts: [horn]}}
"""
    )
    build(shop, tmp_path, text, diagnostics)
    assert diagnostics.codes() == ["SB301", "SB301", "SB302"]
    assert list(diagnostics)[2].notes == ('"motor/horn"', '"other/horn"')


def test_path_that_takes_nothing(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A claim on ignored components, or on ones claimed more closely, is a warning with the reason."""
    shop = Workshop()
    pair = shop.group("pair")
    shop.box("x", parent=pair)
    shop.box("y", X_PC=at(20, 0, 0), parent=pair)
    shop.box("label")
    shop.box("plate")
    text = (
        TWO
        + "    parts: {label: {ignore: true}}\n    links: {base: {parts: [pair, label, plate]}, arm: {parts: [x, y]}}\n"
    )
    assert build(shop, tmp_path, text, diagnostics) is not None
    assert diagnostics.codes() == ["SB306", "SB306"]
    assert [d.message.rsplit(": ", 1)[1] for d in diagnostics] == [
        "more specific claims take all of it",
        "`parts` ignores it",
    ]


def test_binding_by_number_draws_one_warning(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """All paths that depend on ``#n`` alone are collected in one warning."""
    text = TWO + '    links: {base: {rest: true}, arm: {parts: ["motor/screw#1", "motor/screw#2"]}}\n'
    assert build(_motor_shop(), tmp_path, text, diagnostics) is not None
    (fault,) = diagnostics
    assert (fault.code, fault.severity) == ("SB305", "warning")
    assert len(fault.notes) == 2


def test_named_occurrences_draw_none(tmp_path: Path) -> None:
    """``#n`` on siblings with their own names causes no warning."""
    shop = Workshop()
    shop.box("motor", occurrence="left motor")
    shop.box("motor", occurrence="right motor")
    diagnostics = Diagnostics()
    build(shop, tmp_path, TWO + '    links: {base: {parts: ["motor#1"]}, arm: {parts: [right motor]}}\n', diagnostics)
    assert not list(diagnostics)
