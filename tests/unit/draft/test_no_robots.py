"""Assemblies that do not move: no joint is drafted, with names and without, and the draft says why."""

from collections.abc import Callable, Sequence
from math import pi
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Sources, Survey
from stepbot.draft.draft_robot import infer
from stepbot.draft.evidence.wheels import rolling
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly
from tests.assembled import BARE, Node, assembled, group, inferred, joints, part
from tests.parts import write_tessellated
from tests.solids import Solid, box, cylinder
from tests.unit.step.in_process import read_quietly

SOURCES = pytest.mark.parametrize("sources", [ALL_SOURCES, BARE], ids=["as it is", "bare"])


def _bolt(length: float, radius: float) -> Solid:
    """A bolt whose shank points up from its head's lower side, z = 0."""
    return cylinder(radius, length) + cylinder(2.0 * radius, radius).at(0, 0, -radius)


def _frame() -> Assembly:
    """Two rails on two cross members, each corner with a plate that two bolts hold."""
    places = [(x, y) for x in (0.0, 200.0) for y in (0.0, 120.0)]
    holes = [(x + dx, y) for x, y in places for dx in (-8.0, 8.0)]
    nodes: list[Node] = []
    for n, y in enumerate((0.0, 120.0)):
        rail = box(260, 20, 20).at(100, 0, 0)
        for x, at in holes:
            rail = rail - cylinder(2.5, 20).at(x, 0, 0) if at == y else rail
        nodes.append(part(f"rail {n}", rail, y=y, z=-10))
    for n, x in enumerate((0.0, 200.0)):
        nodes.append(part(f"cross member {n}", box(20, 100, 20), x=x, y=60, z=-10))
    plate = box(40, 30, 4)
    for dx in (-8.0, 8.0):
        plate = plate - cylinder(2.6, 4).at(dx, 0, -2)
    for n, (x, y) in enumerate(places):
        nodes.append(part(f"plate {n}", plate, x=x, y=y, z=2))
    bolt = _bolt(20, 2.5)
    nodes += [part("M5x20", bolt, x=x, y=y, z=4, rpy=(pi, 0, 0)) for x, y in holes]
    return assembled(*nodes)


def _board() -> Assembly:
    """A circuit board with a header, four round capacitors on one leg each side, and spacers in its corners."""
    board = box(100, 80, 1.6).at(0, 0, -0.8)
    pins = [(-20 + 2.54 * n, 30) for n in range(10)]
    cans = [(-30 + 20 * n, -10) for n in range(4)]
    corners = [(x, y) for x in (-46, 46) for y in (-36, 36)]
    holes = [(x, y, 0.5) for x, y in pins] + [(x + dx, y, 0.4) for x, y in cans for dx in (-1.25, 1.25)]
    for x, y, radius in [*holes, *((x, y, 1.6) for x, y in corners)]:
        board = board - cylinder(radius, 2).at(x, y, -1.8)
    header = box(26, 2.5, 8.5).at(-20 + 11.43, 30, 4.25)
    for x, y in pins:
        header = header + cylinder(0.4, 3).at(x, y, -3)
    can = cylinder(4, 11)
    for dx in (-1.25, 1.25):
        can = can + cylinder(0.35, 3).at(dx, 0, -3)
    spacer = cylinder(3, 10) - cylinder(1.6, 10)
    chips = [part(f"U{n}", box(10, 8, 1.5), x=25 * n - 25, y=10, z=0.75) for n in range(3)]
    return assembled(
        group("PCB", part("board", board), part("header", header), *chips),
        *(part(f"C{n}", can, x=x, y=y) for n, (x, y) in enumerate(cans)),
        *(part("spacer", spacer, x=x, y=y, z=-11.6) for x, y in corners),
    )


def _rotor() -> Assembly:
    """Magnets in slots of a rotor, as long as it is; each could slide out along it."""
    rotor, places = cylinder(18, 10), [(13.0, 0.0), (0.0, 13.0), (-13.0, 0.0), (0.0, -13.0)]
    nodes = []
    for n, (x, y) in enumerate(places):
        magnet = box(4, 10, 10) if x else box(10, 4, 10)
        rotor = rotor - magnet.at(x, y, 5)
        nodes.append(part(f"a{n}", magnet, x=x, y=y, z=5))
    return assembled(part("b", rotor), *nodes)


@SOURCES
@pytest.mark.parametrize("draw", [_frame, _board, _rotor])
def test_what_is_screwed_or_soldered_does_not_move(draw: Callable[[], Assembly], sources: Sources) -> None:
    """Bolts, spacers, pins and round parts that stand on legs are no mechanism."""
    draft = infer(draw(), "still", sources)
    joints = [joint for joint in (*draft.joints, *draft.closures) if joint.confidence.is_chosen]
    assert not [joint.confidence.evidence for joint in joints]
    assert any(note.startswith("no moving parts found: ") for note in draft.notes)


def test_triangles_have_no_axes(tmp_path: Path) -> None:
    """Nothing was found in a scan, or in one body, whatever moves in it: the draft states why."""
    scan = read_quietly(write_tessellated(tmp_path / "scan.step").path)
    (why,) = infer(scan, "scan").notes
    assert why == "no moving parts found: the file has one body, and a link consists of whole ones"
    body = next(one for one in scan.components if one.body >= 0)
    twice = replace(scan, components=(*scan.components, replace(body, index=len(scan.components), path="other")))
    assert infer(twice, "scan").notes[0] == "no moving parts found: 2 of 2 bodies are triangles, which have no axes"


def test_equal_feet_turn_on_nothing() -> None:
    """Four feet with studs in the legs of a table spin only: not the last of them is a link, either."""
    foot = cylinder(12, 10).at(0, 0, -10) + cylinder(2, 12)
    corners = [(x, y) for x in (-140, 140) for y in (-140, 140)]
    table = box(320, 320, 10).at(0, 0, 305)
    for x, y in corners:
        table += box(20, 20, 300).at(x, y, 150) - cylinder(2.1, 200).at(x, y, 0)
    assert joints(inferred(part("table", table), *(part("foot", foot, x, y) for x, y in corners))) == []


@SOURCES
def test_feet_in_the_ends_of_equal_bars_are_no_outputs(sources: Sources) -> None:
    """Bars with a bore along them, screwed to a plate beside their ends and with a foot in each, are no motors."""
    bar = box(20, 20, 200).at(0, 0, 100) - cylinder(2.1, 200)
    foot = cylinder(8, 10).at(0, 0, -10) + cylinder(2.1, 14)
    corners = [(x, y) for x in (-100, 100) for y in (-100, 100)]
    bars = [part("bar", bar, x, y) for x, y in corners]
    feet = [part("foot", foot, x, y) for x, y in corners]
    rails = [part("rail", box(180, 20, 20), 0, y, 190) for y in (-100, 100)]
    found = inferred(*bars, *feet, *rails, part("top", box(240, 240, 10), z=205), sources=sources)
    assert [h.why for h in (arc.evidence for arc in found.arcs) if h.type != JointKind.FIXED] == []


@SOURCES
def test_feet_on_one_ground_do_not_turn(sources: Sources) -> None:
    """Four feet with smooth stems in the uprights of a frame, of exactly their width, stand and turn about none."""
    foot = cylinder(15, 10) + cylinder(8, 10).at(0, 0, 10) + cylinder(2.1, 30).at(0, 0, 10)
    places = [(x, y) for x in (-150, 150) for y in (-150, 150)]
    upright = box(20, 20, 600).at(0, 0, 320) - cylinder(2.1, 600).at(0, 0, 20)
    shelf = part("shelf", box(280, 280, 6), z=400)
    frame = [part(f"upright {n}", upright, x, y) for n, (x, y) in enumerate(places)]
    bars = [part(f"bar {x}", box(20, 280, 20), x, z=387) for x in (-150, 150)]
    feet = [part(f"foot {n}", foot, x, y) for n, (x, y) in enumerate(places)]
    assert joints(inferred(group("frame", *frame, *bars, shelf), group("feet", *feet), sources=sources)) == []


@pytest.mark.parametrize("is_posed", [False, True])
def test_feet_stand_however_the_assembly_is_posed(is_posed: bool) -> None:
    """Feet of several bodies with nuts on their studs are on one ground, along no axis of the file either."""
    places = [(x, y) for x in (-150, 150) for y in (-90, 90)]
    table, rubber, stud = box(360, 240, 10).at(0, 0, 5), cylinder(15, 20).at(0, 0, -24), cylinder(15, 4).at(0, 0, -4)
    for x, y in places:
        table -= cylinder(4, 10).at(x, y, 0)
    nut = cylinder(8, 6) - cylinder(4, 6)
    foot = [part("rubber", rubber), part("stud", stud + cylinder(4, 20))]
    nodes = [part("table", table), part("frame", box(300, 20, 40), z=30)]
    for n, (x, y) in enumerate(places):
        feet = [replace(node, X=Pose.from_xyz_rpy((x * 1e-3, y * 1e-3, 0.0), (0, 0, 0))) for node in foot]
        nodes += [group(f"foot {n}", *feet), part("M8 nut", nut, x, y, 10)]
    whole = replace(
        group("all", *nodes), X=Pose.from_xyz_rpy((0.1, 0.0, 0.2), (0.3, 0.4, 0.5) if is_posed else (0, 0, 0))
    )
    assert joints(inferred(whole)) == []


def _on_a_box(*more: Node, holes: Sequence[Solid], screws: int = 6) -> list[Node]:
    """A cover that screws hold on a box with some holes, and more."""
    places = [(-60.0 + 24.0 * n, 30.0) for n in range(6)]
    base, cover = box(160, 100, 60).at(0, 0, -30), box(150, 20, 6).at(0, 30, 3)
    for x, y in places:
        base, cover = base - cylinder(2, 20).at(x, y, -20), cover - cylinder(2.2, 6).at(x, y, 0)
    for hole in holes:
        base -= hole
    bolts = [part("M4x20", _bolt(24, 2), x, y, 6, (pi, 0, 0)) for x, y in places[:screws]]
    return [part("base", base), part("cover", cover), *bolts, *more]


@pytest.mark.parametrize(("screws", "has_clip", "count"), [(6, False, 0), (6, True, 1), (2, False, 1)])
def test_what_nothing_keeps_in_is_screwed_in(screws: int, has_clip: bool, count: int) -> None:
    """A gauge on its stem is a link only if a clip keeps it in, or if no screws are drawn: then nothing tells."""
    hole, stem = cylinder(6, 60).at(0, -20, -60), cylinder(6, 66).at(0, 0, -66)
    gauge = stem + cylinder(10, 10) + box(50, 14, 50).at(10, 0, 35)
    clip = [part("circlip", cylinder(9, 1) - cylinder(6, 1), 0, -20, -62)] if has_clip else []
    nodes = _on_a_box(part("gauge", gauge, 0, -20), *clip, holes=[hole], screws=screws)
    assert len(joints(inferred(*nodes))) == count


@pytest.mark.parametrize(("rod", "count"), [(0.0, 0), (90.0, 1)])
def test_a_plug_in_a_tube_is_no_piston(rod: float, count: int) -> None:
    """A round insert that ends in its bore, or hardly out of it, does not slide; with a rod out of it, it does."""
    tube = box(60, 60, 120).at(0, 0, 60) - cylinder(20, 110).at(0, 0, 10)
    core = cylinder(19.9, 14).at(0, 0, 70)
    core = core + cylinder(6, rod).at(0, 0, 84) if rod else core
    found = inferred(part("tube", tube), part("core", core), part("foot", box(200, 200, 10), z=-5))
    assert [kind for kind, *_ in joints(found)] == ["prismatic"] * count


def test_coils_of_valves_turn_on_nothing() -> None:
    """Equal bodies on one line each, with a nut, are clamped if nothing else moves in the assembly."""
    places = [(-60.0, -20.0), (0.0, -20.0), (60.0, -20.0)]
    holes = [cylinder(10, 30).at(x, y, -30) for x, y in places]
    valve = cylinder(9.95, 30).at(0, 0, -30) + cylinder(14, 8) + cylinder(8, 50).at(0, 0, 8)
    coil = box(30, 44, 40).at(0, -4, 28) - cylinder(8.05, 40).at(0, 0, 8)
    nut = cylinder(12, 8) - cylinder(8, 8)
    nodes = _on_a_box(holes=holes)
    for n, (x, y) in enumerate(places):
        nodes.append(
            group(f"station {n}", part("valve", valve, x, y), part("coil", coil, x, y), part("coil nut", nut, x, y, 48))
        )
    assert joints(inferred(*nodes)) == []


def test_four_feet_are_no_wheels() -> None:
    """Turned on its side, an assembly would stand on the rims of two feet: but all four end on one plane."""
    plate, leg, foot = box(200, 130, 10).at(0, 0, 105), cylinder(10, 92).at(0, 0, 8), cylinder(12, 8)
    places = [(x, y) for x in (-95, 95) for y in (-60, 60)]
    nodes = [part("plate", plate), *(part(*one, x, y) for x, y in places for one in (("foot", foot), ("leg", leg)))]
    assert not dict(rolling(Survey(assembled(*nodes), ALL_SOURCES)))
