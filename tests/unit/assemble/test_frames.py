"""Every form of ``origin`` gives the documented frame, or an error with a snippet to paste."""

from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import Robot
from stepbot.step.assembly import AxisFace
from tests.conftest import ReadDiagnostics
from tests.unit.assemble.workshop import Workshop, at, axis, build, built, sidecar

HEAD = "    defaults: {density: 1000}\n    links: {base: {rest: true}, arm: {parts: [arm]}}\n"


def _joint(origin: str, kind: str = "continuous", extra: str = "") -> str:
    return HEAD + f"    joints: {{j: {{type: {kind}, parent: base, child: arm, origin: {origin}{extra}}}}}\n"


def _two(base: list[AxisFace], arm: list[AxisFace], X_WA: Pose = at(0, 0, 0)) -> Workshop:  # noqa: B008 - a value
    shop = Workshop()
    shop.box("base", (100, 100, 10), axes=base)
    shop.box("arm", (20, 20, 60), X_WA, axes=arm)
    return shop


def _expect(robot: Robot, position_mm: tuple[float, float, float], R: object = np.eye(3)) -> None:
    X = robot.joints[0].X_PC
    np.testing.assert_allclose(X.p * 1e3, position_mm, atol=1e-9)
    np.testing.assert_allclose(X.R, R, atol=1e-12)


def test_explicit(tmp_path: Path) -> None:
    """A pose in numbers is relative to the assembly; ``offset`` is applied in its frame."""
    shop = _two([], [], at(5, 6, 7, (0, 0, np.pi / 2)))
    turned = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    _expect(built(shop, tmp_path, _joint("{xyz: [1 mm, 2 mm, 3 mm], rpy: [0, 0, 90 deg]}")), (1, 2, 3), turned)
    offset = "offset: {xyz: [10 mm, 0, 0], rpy: [0, 0, -90 deg]}"
    _expect(built(shop, tmp_path, _joint(f"{{xyz: [1 mm, 0, 0], rpy: [0, 0, 90 deg], {offset}}}")), (1, 10, 0))


def test_relative_to_a_component_or_link(tmp_path: Path) -> None:
    """A name denotes a link before a component; the frame of a link is that of the drawn pose."""
    shop = Workshop()
    shop.box("base")
    shop.box("arm", (10, 10, 10), at(5, 6, 7, (0, 0, np.pi / 2)))
    shop.box("tip", (10, 10, 10), at(0, 0, 99))
    text = """
    defaults: {density: 1000}
    links: {base: {rest: true}, upper: {parts: [arm]}, tip: {parts: [tip]}}
    joints:
      a:
        {type: revolute, parent: base, child: upper, zero: 30 deg, limits: {lower: -1, upper: 1},
         origin: {xyz: [1 mm, 0, 0], relative_to: arm}}
      b: {type: fixed, parent: upper, child: tip, origin: {xyz: [0, 0, 2 mm], relative_to: upper}}
"""
    robot = built(shop, tmp_path, text)
    np.testing.assert_allclose(robot.joint_by_name["a"].X_PC.p * 1e3, (5, 7, 7), atol=1e-9)
    np.testing.assert_allclose(robot.joint_by_name["b"].X_PC.p * 1e3, (0, 0, 2), atol=1e-9)
    np.testing.assert_allclose(robot.joint_by_name["b"].X_PC.R, np.eye(3), atol=1e-12)


def test_component_and_center(tmp_path: Path) -> None:
    """``component`` is the component's frame; ``center`` the centre of its bounding box along the assembly's axes."""
    shop = Workshop()
    shop.box("base")
    arm = shop.group("arm", X_PC=at(100, 0, 0, (0, 0, np.pi / 2)))
    shop.box("lower", (10, 20, 30), at(0, 0, 0), arm)
    shop.box("upper", (10, 10, 10), at(0, 0, 40), arm)
    turned = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    _expect(built(shop, tmp_path, _joint("{component: arm}")), (100, 0, 0), turned)
    _expect(built(shop, tmp_path, _joint("{component: upper}")), (100, 0, 40), turned)
    _expect(built(shop, tmp_path, _joint("{center: arm}")), (100, 0, 15))  # from -15 to 45
    _expect(built(shop, tmp_path, _joint("{center: upper, offset: {xyz: [0, 0, 5 mm]}}")), (100, 0, 45))


def test_ignored_components_can_be_named(tmp_path: Path) -> None:
    """An origin may name an ignored component."""
    shop = _two([], [])
    shop.box("marker", (1, 1, 1), at(3, 4, 5))
    text = _joint("{center: marker}") + "    parts: {marker: {ignore: true}}\n"
    _expect(built(shop, tmp_path, text), (3, 4, 5))


def test_axis_of(tmp_path: Path) -> None:
    """``axis_of`` is the line of a component's faces: z along it by the sign rule, origin in their middle."""
    holes = [axis((10, 0, 0), (0, -1, 0), 8, 20), axis((10, 30, 0), (0, 1, 0), 3, 10), axis((40, 0, 0), (0, 1, 0), 3)]
    shop = _two(holes, [])
    along_y = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    # The frame's columns are x, y, z: z along +y, x stays, y is z cross x = -z.
    _expect(built(shop, tmp_path, _joint("{axis_of: base}")), (10, 12.5, 0), along_y)  # from -10 to 35
    _expect(built(shop, tmp_path, _joint("{axis_of: base, radius: 8 mm}")), (10, 0, 0), along_y)
    _expect(built(shop, tmp_path, _joint("{axis_of: base, near: [39 mm, 0, 0]}")), (40, 0, 0), along_y)


def test_axis_of_a_subassembly(tmp_path: Path) -> None:
    """``axis_of`` a subassembly uses the faces of all its components, in any orientation."""
    shop = Workshop()
    shop.box("base")
    arm = shop.group("arm", X_PC=at(0, 0, 50, (np.pi / 2, 0, 0)))
    shop.rod("pin", 4, 30, at(0, 0, 10), arm)
    _expect(built(shop, tmp_path, _joint("{axis_of: arm}")), (0, -10, 50), [[1, 0, 0], [0, 0, 1], [0, -1, 0]])


def test_mate_and_auto(tmp_path: Path) -> None:
    """``auto``, explicit or by default, is the mate between the parts of both links, its origin in their overlap."""
    shop = _two(
        [axis((20, 0, 0), radius=8, length=10), axis((0, 20, 0), radius=2)],
        [axis((0, 0, 0), radius=7.9, length=40, bore=False), axis((-20, 20, 0), radius=2)],
        at(20, 0, 15),
    )
    # Bore from -5 to 5, shaft from -5 to 35: their overlap is the bore.
    for origin in ("auto", "{auto: true}", '{mate: ["base", "arm"]}', '{mate: ["arm", "base"]}'):
        _expect(built(shop, tmp_path, _joint(origin)), (20, 0, 0))
    left_out = HEAD + "    joints: {j: {type: continuous, parent: base, child: arm}}\n"
    _expect(built(shop, tmp_path, left_out), (20, 0, 0))
    # The pins beside it do not overlap: from -5 to 5, and from 10 to 20.
    _expect(built(shop, tmp_path, _joint("{radius: 2 mm}")), (0, 20, 7.5))
    _expect(built(shop, tmp_path, _joint("{near: [0, 20 mm, 0], offset: {xyz: [0, 0, 1 mm]}}")), (0, 20, 8.5))


def test_auto_looks_at_all_parts_of_both_links(tmp_path: Path) -> None:
    """``auto`` uses all parts of both links, such as a horn within the parent's motor, and no ignored ones."""
    shop = Workshop()
    motor = shop.group("motor")
    shop.box("case", parent=motor, axes=[axis((0, 0, 0), radius=6)])
    shop.box("horn", parent=motor, axes=[axis((0, 0, 0), radius=5), axis((9, 0, 0), radius=4)])
    shop.box("screw", (2, 2, 20), at(9, 0, 0), motor, axes=[axis((0, 0, 0), radius=4)])
    shop.box("arm", (10, 10, 50), at(0, 0, 30), axes=[axis((9, 0, 0), radius=4)])
    text = """
    defaults: {density: 1000}
    links: {base: {rest: true}, arm: {parts: [arm, horn]}}
    joints: {j: {type: continuous, parent: base, child: arm}}
"""
    # With the screw, its hole would be a second candidate: 4 mm against 5 mm.
    _expect(built(shop, tmp_path, text + "    parts: {screw: {ignore: true}}\n"), (0, 0, 0))


def test_ambiguous_axes_are_listed_to_paste(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Ambiguous axes are an error at the origin, with a snippet for each."""
    bolts = [axis((10, 0, 0), radius=3), axis((-10, 0, 0), radius=3), axis((0, 10, 0), radius=2)]
    shop = _two(bolts, bolts)
    assert build(shop, tmp_path, _joint("auto"), diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB402"
    assert fault.message == "joint 'j': link 'base' and link 'arm' share 3 axes, none of them twice as wide as the next"
    assert fault.help[0] == "origin: {auto: true, near: [10 mm, 0 mm, 0 mm]}"
    assert fault.help[2] == "origin: {auto: true, radius: 2 mm}"
    for text, x, y in ((fault.help[0], 10, 0), (fault.help[1], -10, 0), (fault.help[2], 0, 10)):
        _expect(built(shop, tmp_path, _joint(text.removeprefix("origin: "))), (x, y, 0))


def test_misspelt_part_is_no_ambiguous_axis(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The link with ``rest`` gets the part that a misspelt path was to match; its axes are not judged."""
    shop = Workshop()
    shop.box("plate", (100, 100, 10), axes=[axis((0, 0, 0), radius=5)])
    shop.box("motor", (20, 20, 10), at(30, 0, 0), axes=[axis((0, 0, 0), radius=5)])
    shop.box("arm", (20, 20, 60), axes=[axis((0, 0, 0), radius=5), axis((30, 0, 0), radius=5)])
    text = """
    defaults: {density: 1000}
    links: {base: {rest: true}, drive: {parts: [MOTOR]}, arm: {parts: [arm]}}
    joints:
      j: {type: continuous, parent: base, child: arm}
      k: {type: fixed, parent: arm, child: drive, origin: {xyz: [0, 0, 0]}}
"""
    _expect(built(shop, tmp_path, text.replace("MOTOR", "motor")), (0, 0, 0))
    assert build(shop, tmp_path, text.replace("MOTOR", "motro"), diagnostics) is None
    assert diagnostics.codes() == ["SB301"]


def test_pasted_axis_snippets_work_on_one_component(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An ambiguous ``axis_of`` lists a snippet for each line."""
    shop = _two([axis((10, 0, 0), radius=3), axis((-10, 0, 0), radius=2.9)], [])
    assert build(shop, tmp_path, _joint("{axis_of: base}"), diagnostics) is None
    (fault,) = diagnostics
    assert fault.help == ('origin: {axis_of: "base", radius: 3 mm}', 'origin: {axis_of: "base", radius: 2.9 mm}')
    _expect(built(shop, tmp_path, _joint(fault.help[1].removeprefix("origin: "))), (-10, 0, 0))


def test_no_axis_reports_near_misses(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """If two links share no line, lines less than 2 mm apart are reported, with snippets."""
    shop = _two([axis((10, 0, 0), radius=5), axis((30, 0, 0), radius=1)], [axis((11.57, 0, 0), radius=4)])
    assert build(shop, tmp_path, _joint("auto"), diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB401"
    assert fault.message == "joint 'j': link 'base' and link 'arm' share no axis"
    assert fault.notes == ('1.57 mm apart: "base" (radius 5 mm) and "arm" (radius 4 mm)',)
    assert fault.help == ('origin: {axis_of: "base"}', 'origin: {axis_of: "arm"}')
    _expect(built(shop, tmp_path, _joint('{axis_of: "arm"}')), (11.57, 0, 0))


def test_a_horn_and_a_bracket_far_apart_are_no_axis(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Faces on one line with a gap of 228 mm are no joint; the error lists the selectors for them."""
    horn = [axis((0, 0, 0), radius=10, length=4, bore=False)]
    bracket = [axis((0, 0, 234), radius=10.2, length=8)]
    shop = _two(horn, bracket)
    for origin in ("auto", '{mate: ["base", "arm"]}'):
        assert build(shop, tmp_path, _joint(origin), diagnostics) is None
    first, second = diagnostics
    assert (first.code, second.code) == ("SB406", "SB406")
    words = "have faces on one line, but no shaft in a bore and no touching faces"
    assert first.message == f"joint 'j': link 'base' and link 'arm' {words}"
    assert first.notes == (
        'shaft of radius 10 mm of "base" and bore of radius 10.2 mm of "arm" are 228 mm apart; '
        "direction [0, 0, 1], at [0 mm, 0 mm, 116 mm]",
    )
    assert first.help == ("origin: {auto: true, radius: 10.2 mm}",)
    assert second.help == ('origin: {mate: ["base", "arm"], radius: 10.2 mm}',)
    for chosen in (first.help[0], second.help[0], "origin: {near: [0, 0, 0]}"):  # a choice in the sidecar is explicit
        _expect(built(shop, tmp_path, _joint(chosen.removeprefix("origin: "))), (0, 0, 116))


@pytest.mark.parametrize("count", [2, 3])
def test_lines_without_a_contact_are_counted(count: int, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Lines on which faces of both sides are far apart are counted and each listed, with what selects it."""
    at = [(30.0 * n, 0, 0) for n in range(count)]
    horn = [axis(point, radius=10 + n, length=4, bore=False) for n, point in enumerate(at)]
    bracket = [axis((x, y, 234), radius=10.2 + n, length=8) for n, (x, y, _) in enumerate(at)]
    assert build(_two(horn, bracket), tmp_path, _joint("auto"), diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB406"
    assert f"faces on {count} lines" in fault.message
    assert (len(fault.notes), len(fault.help)) == (count, count)


def test_a_fit_beats_a_wider_line_without_contact(tmp_path: Path) -> None:
    """A pin in its bore is preferred to a line whose wider faces are apart."""
    base = [axis((0, 0, 0), radius=10, length=4, bore=False), axis((40, 0, 0), radius=2, length=10, bore=False)]
    arm = [axis((0, 0, 234), radius=10.2, length=8), axis((40, 0, 0), radius=2.1, length=10)]
    _expect(built(_two(base, arm), tmp_path, _joint("auto")), (40, 0, 0))


def test_faces_that_touch_but_do_not_fit_are_marked(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A line of faces that touch without fitting is a warning, unless the sidecar selects it."""
    shop = _two(
        [axis((0, 0, 0), radius=5, length=4)], [axis((0, 0, 1), radius=10, length=4, bore=False), axis((20, 0, 0))]
    )
    robot = build(shop, tmp_path, _joint("auto"), diagnostics)
    assert robot is not None
    _expect(robot, (0, 0, 0.5))
    (doubt,) = diagnostics
    assert (doubt.code, doubt.severity) == ("SB407", "warning")
    words = "bore of radius 5 mm and shaft of radius 10 mm overlap by 3 mm, but their radii do not match"
    assert doubt.message == f"joint 'j': weak evidence for its axis: {words}"
    assert doubt.help == ("origin: {auto: true, radius: 10 mm}",)
    _expect(built(shop, tmp_path, _joint(doubt.help[0].removeprefix("origin: "))), (0, 0, 0.5))
    made = build_robot(shop.assembly, sidecar(tmp_path, _joint("auto")), lambda: shop.measures, Diagnostics())
    assert made is not None
    assert made.joint_table[0].evidence.doubt == words


def test_the_centre_of_a_ball_on_a_line_is_doubted(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A line does not state the centre of a ball: a warning, unless the sidecar selects it or gives an offset."""
    shop = _two([axis((0, 0, 0), radius=5, length=4)], [axis((0, 0, 1), radius=5, length=4, bore=False)])
    assert build(shop, tmp_path, _joint("auto", "ball"), diagnostics) is not None
    (doubt,) = diagnostics
    words = "a ball joint turns about the centre of its ball, and this is the middle of the faces on the line"
    assert (doubt.code, doubt.message) == ("SB407", f"joint 'j': weak evidence for its axis: {words}")
    assert doubt.help[0].startswith("give the centre of the ball: `origin: {xyz: [...]}`, as `stepbot init` drafts it")
    for chosen in ("{auto: true, offset: {xyz: [0, 0, 2 mm]}}", "{auto: true, radius: 5 mm}"):
        built(shop, tmp_path, _joint(chosen, "ball"))


@pytest.mark.parametrize(("size", "doubted"), [((20, 20, 60), True), ((20, 20, 20), False), ((20, 12, 20), False)])
def test_the_middle_of_a_stud_is_no_centre_of_a_ball(
    size: tuple[float, float, float], doubted: bool, tmp_path: Path
) -> None:
    """A ball, with flat ends or without, has its centre in the middle of its box; a ball on a stem does not."""
    shop = Workshop()
    shop.box("base", (100, 100, 10))
    shop.box("arm", size)
    made = build_robot(
        shop.assembly, sidecar(tmp_path, _joint("{center: arm}", "ball")), lambda: shop.measures, Diagnostics()
    )
    assert made is not None
    words = "a ball joint turns about the centre of its ball, and this is the middle of a box of 20 x 20 x 60 mm, "
    assert made.joint_table[0].evidence.doubt == (f"{words}which is not that of a ball" if doubted else "")


def test_a_ball_in_a_socket_has_no_line(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The remedy is where to take the centre from; cylinders elsewhere on the two links are no cause."""
    shop = _two([axis((0, 0, 0), radius=5, length=4)], [axis((90, 0, 1), radius=5, length=4, bore=False)])
    assert build(shop, tmp_path, _joint("auto", "ball"), diagnostics) is None
    (error,) = diagnostics
    assert error.code == "SB401"
    (help,) = error.help
    assert help.endswith("or `{center: PATH}` of a whole ball")


def test_a_selector_of_a_draft_is_doubted_until_reviewed(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A radius that a draft wrote counts as a choice once the REVIEW comment is gone; the evidence names its face."""
    base = [axis((0, 0, 0), radius=1.1, length=4), axis((0, 0, 40), radius=8, bore=False), axis((20, 0, 0))]
    shop = _two(base, [axis((0, 0, 10), radius=1.4, length=4), axis((20, 0, 0))])
    joint = "      j: {type: continuous, parent: base, child: arm, origin: {auto: true, radius: 8 mm}}\n"
    score, review = "      # score 0.95: output of the motor 'm'\n", "      # REVIEW: weak\n"
    drafted, confirmed = (f"{HEAD}    joints:\n{score}{comment}{joint}" for comment in (review, ""))
    for text, doubt in ((drafted, "bore of radius 1.1 mm and bore of radius 1.4 mm are 6 mm apart"), (confirmed, "")):
        made = build_robot(shop.assembly, sidecar(tmp_path, text), lambda: shop.measures, diagnostics)
        assert made is not None
        (evidence,) = (row.evidence for row in made.joint_table)
        assert (evidence.selected, evidence.doubt) == (True, doubt)
        assert [(face.component, face.radius) for face in evidence.selected_by] == [("base", 0.008)]
    (warned,) = diagnostics
    assert warned.code == "SB407"
    assert warned.help[0] == "if its origin is right, remove the REVIEW comment of the draft above it"


def test_a_fit_beside_a_wider_line_that_touches_is_marked(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A screw in its hole is preferred to a wide line of touching faces, with a warning."""
    base = [axis((0, 0, 0), radius=20), axis((40, 0, 0), radius=2, bore=False)]
    arm = [axis((0, 0, 0), radius=10, bore=False), axis((40, 0, 0), radius=2.1)]
    robot = build(_two(base, arm), tmp_path, _joint("auto"), diagnostics)
    assert robot is not None
    _expect(robot, (40, 0, 0))
    (doubt,) = diagnostics
    assert doubt.code == "SB407"
    assert doubt.help == ("origin: {auto: true, radius: 2.1 mm}", "origin: {auto: true, radius: 20 mm}")


def test_a_wide_line_that_touches_beats_a_bolt_circle(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Among equal bolt holes on several lines, a line twice as wide is the axis."""
    bolts = [axis((x, y, 0), radius=1.2) for x, y in ((12, 0), (-12, 0), (0, 12), (0, -12))]
    base = [axis((0, 0, 0), radius=5, bore=False), *bolts]
    arm = [axis((0, 0, 0), radius=7), *bolts]
    robot = build(_two(base, arm), tmp_path, _joint("auto"), diagnostics)
    assert robot is not None
    _expect(robot, (0, 0, 0))
    assert diagnostics.codes() == ["SB407"]


def test_a_slide_takes_any_of_parallel_lines(tmp_path: Path) -> None:
    """For a prismatic joint two parallel guides are not ambiguous."""
    guides = [axis((10, 0, 0), radius=3), axis((-10, 0, 0), radius=3)]
    text = _joint("auto", "prismatic", ", limits: {lower: 0, upper: 10 mm}")
    _expect(built(_two(guides, guides), tmp_path, text), (10, 0, 0))


def test_auto_without_parts(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A link without parts shares no line, and the message has the reason; a misspelt path is reported once."""
    shop = _two([axis((0, 0, 0))], [])
    inertial = "{mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}"
    empty = _joint("auto").replace("arm: {parts: [arm]}", f"arm: {{inertial: {inertial}}}")
    assert build(shop, tmp_path, empty, diagnostics) is None
    assert diagnostics.codes() == ["SB405"]
    assert build(shop, tmp_path, _joint("auto").replace("parts: [arm]", "parts: [amr]"), diagnostics) is None
    assert diagnostics.codes() == ["SB405", "SB301"]


def test_paths_in_origins_are_checked(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An unknown component, and one without extent, are errors at their place in the origin."""
    shop = _two([], [])
    shop.group("nothing")
    assert build(shop, tmp_path, _joint("{component: amr}"), diagnostics) is None
    assert build(shop, tmp_path, _joint("{center: nothing}"), diagnostics) is None
    assert build(shop, tmp_path, _joint("{xyz: [0, 0, 0], relative_to: foot}"), diagnostics) is None
    assert build(shop, tmp_path, _joint("{axis_of: arm, radius: 4 mm}"), diagnostics) is None
    assert diagnostics.codes() == ["SB301", "SB404", "SB301", "SB401"]
    first = next(iter(diagnostics))
    assert first.message == "joint 'j': no component 'amr' in robot.step"
    lines = HEAD.splitlines()
    column = _joint("{component: amr}").splitlines()[-1].index("amr") + 1 - 4  # the workshop removes the indent
    assert (first.span.line, first.span.column) == (3 + len(lines) + 1, column)


def test_frames_that_wait_for_each_other(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A joint relative to its own child, and two joints relative to each other's, are one error each."""
    shop = _two([], [])
    shop.box("tip")
    text = """
    defaults: {density: 1000}
    links: {base: {rest: true}, arm: {parts: [arm]}, tip: {parts: [tip]}}
    joints:
      a: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0], relative_to: tip}}
      b: {type: fixed, parent: arm, child: tip, origin: {xyz: [0, 0, 0], relative_to: arm}}
"""
    assert build(shop, tmp_path, text, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB403"
    assert "link 'arm' depends on link 'tip' depends on link 'arm'" in fault.message


def test_root_frame(tmp_path: Path) -> None:
    """The root frame is the assembly's unless ``root`` sets it; all other frames are relative to it."""
    shop = _two([axis((20, 0, 0), radius=8)], [axis((20, 0, 0), radius=8)])
    plain = built(shop, tmp_path, _joint("auto"))
    root = "    root: {link: base, frame: {axis_of: base, offset: {xyz: [0, 0, -40 mm]}}}\n"
    moved = built(shop, tmp_path, _joint("auto") + root)
    np.testing.assert_allclose(plain.root.mass_properties.com, (0, 0, 0), atol=1e-12)
    np.testing.assert_allclose(moved.root.mass_properties.com, (-0.02, 0, 0.04), atol=1e-12)
    np.testing.assert_allclose(moved.joints[0].X_PC.p, (0, 0, 0.04), atol=1e-12)
    np.testing.assert_allclose(moved.root.visuals[0].X_LG.p, (-0.02, 0, 0.04), atol=1e-12)
    assert plain.links[1].mass_properties == moved.links[1].mass_properties


def test_named_frames(tmp_path: Path) -> None:
    """A named frame has the pose of its origin in its link's frame."""
    shop = _two([axis((20, 0, 0), radius=8)], [axis((20, 0, 0), radius=8)], at(0, 0, 0))
    text = _joint("auto") + "    frames: {tool: {link: arm, origin: {xyz: [20 mm, 0, 60 mm], rpy: [0, 90 deg, 0]}}}\n"
    (frame,) = built(shop, tmp_path, text).frames
    assert (frame.name, frame.link) == ("tool", "arm")
    np.testing.assert_allclose(frame.X_LF.p, (0, 0, 0.06), atol=1e-12)
    np.testing.assert_allclose(frame.X_LF.rpy, (0, np.pi / 2, 0), atol=1e-9)


@pytest.mark.parametrize(
    ("origin", "source"),
    [
        (
            "auto",
            "axis that link 'base' and link 'arm' share, of faces of \"base\", \"arm\": "
            "radius 8 mm, direction [0, 0, 1], at [20 mm, 0 mm, 0 mm]",
        ),
        ("{axis_of: arm}", 'axis, of faces of "arm": radius 8 mm, direction [0, 0, 1], at [20 mm, 0 mm, 0 mm]'),
        ("{component: arm}", 'the frame of component "arm"'),
        ("{center: arm, offset: {xyz: [1 mm, 0, 0]}}", 'the centre of the box around "arm"; moved by its offset'),
        ("{xyz: [1 mm, 0, 0]}", 'numbers, relative to "assembly"'),
    ],
)
def test_source_of_an_origin_is_in_the_joint_table(origin: str, source: str, tmp_path: Path) -> None:
    """The joint table has the source of each frame."""
    shop = _two([axis((20, 0, 0), radius=8)], [axis((20, 0, 0), radius=8)], at(0, 0, 0))
    made = build_robot(shop.assembly, sidecar(tmp_path, _joint(origin)), lambda: shop.measures, Diagnostics())
    assert made is not None
    (row,) = made.joint_table
    assert row.evidence.text == source


def test_a_turning_joint_does_not_choose_among_lines(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Of joints that move, only prismatic ones accept any of several parallel lines."""
    guides = [axis((10, 0, 0), radius=3), axis((-10, 0, 0), radius=3)]
    assert (
        build(
            _two(guides, guides), tmp_path, _joint("auto", "revolute", ", limits: {lower: -1, upper: 1}"), diagnostics
        )
        is None
    )
    assert diagnostics.codes() == ["SB402"]


@pytest.mark.parametrize("holes", [[], [(10, 0, 0), (-10, 0, 0)]])
def test_a_fixed_joint_needs_no_axis(holes: list[tuple[float, float, float]], tmp_path: Path) -> None:
    """Two plates that share no line, or a bolt circle, have the parent's frame; the joint table says so."""
    bores = [axis(at, radius=3) for at in holes]
    shop = _two(bores, bores, at(0, 0, 35))
    root = "    root: {frame: {xyz: [0, 0, 7 mm]}}\n"
    diagnostics = Diagnostics()
    made = build_robot(
        shop.assembly, sidecar(tmp_path, root + _joint("auto", "fixed")), lambda: shop.measures, diagnostics
    )
    assert made is not None
    assert not list(diagnostics)
    _expect(made.robot, (0, 0, 0))
    (row,) = made.joint_table
    assert row.origin == pytest.approx((0, 0, 0.007))
    assert row.evidence.text == "the frame of link 'base', since a fixed joint needs no axis"


def test_a_fixed_joint_is_on_the_line_that_its_links_share(tmp_path: Path) -> None:
    """Weak evidence for it is no reason to warn, since nothing turns."""
    base, arm = axis((20, 0, 0), radius=17.5, length=4, bore=False), axis((20, 0, 4), radius=9, length=4, bore=False)
    robot = built(_two([base], [arm]), tmp_path, _joint("auto", "fixed"))
    assert robot.joints[0].X_PC.p[0] == pytest.approx(0.02)


def test_another_parent_is_proposed(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """If a joint's links share no axis, the help names the link that has one with the child."""
    shop = Workshop()
    shop.box("base", (100, 100, 10), axes=[axis((40, 0, 0), radius=8)])
    shop.box("arm", (20, 20, 60), axes=[axis((40, 0, 0), radius=7.9, bore=False), axis((0, 0, 30), radius=5)])
    shop.box("jaw", (10, 10, 60), axes=[axis((0, 0, 30), radius=4.9, bore=False)])
    text = """
    defaults: {density: 1000}
    links: {base: {rest: true}, arm: {parts: [arm]}, jaw: {parts: [jaw]}}
    joints:
      lift: {type: continuous, parent: base, child: arm}
      grip: {type: continuous, parent: PARENT, child: jaw}
"""
    assert build(shop, tmp_path, text.replace("PARENT", "base"), diagnostics) is None
    (fault,) = diagnostics
    assert (fault.code, fault.message) == ("SB401", "joint 'grip': link 'base' and link 'jaw' share no axis")
    assert fault.help[0] == "link 'arm' and link 'jaw' share an axis: `parent: arm`, if it carries it"
    built(shop, tmp_path, text.replace("PARENT", "arm"))


@pytest.mark.parametrize(("xyz", "far"), [("[0, 4, 8]", True), ("[0, 100 mm, 200 mm]", False), ("[0, 0, 9]", False)])
def test_axes_far_from_the_assembly(xyz: str, far: bool, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A line through given coordinates that passes far from everything is a warning; along the line it is free."""
    build(_two([], [], at(0, 0, 35)), tmp_path, _joint(f"{{xyz: {xyz}}}"), diagnostics)
    assert diagnostics.codes() == ["SB423"] * far


def test_two_shafts_of_one_radius_are_named(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Shafts of equal radius that meet end to end are weak evidence because no shaft is in a bore."""
    base, arm = axis((0, 0, 0), radius=17.5, length=4, bore=False), axis((0, 0, 4), radius=17.5, length=4, bore=False)
    build(_two([base], [arm]), tmp_path, _joint("auto"), diagnostics)
    (doubt,) = diagnostics
    words = "two shafts of radius 17.5 mm meet end to end, and no shaft is in a bore"
    assert doubt.message == f"joint 'j': weak evidence for its axis: {words}"
