"""The root link."""

from math import pi
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import Sources
from stepbot.draft.inference import infer_mechanism
from stepbot.draft.mechanism import unconnected
from stepbot.draft.parts.names import Role, roles
from stepbot.geometry.inertia import DIRECTIONS, Direction, rotation_of
from stepbot.geometry.spatial import Pose
from stepbot.step.assembly import Assembly, ReadOptions
from tests.assembled import BARE, Node, group, inferred, joints, links, part, turned
from tests.solids import Solid, box, cylinder
from tests.unit.step.in_process import read_quietly

BORED = box(120, 40, 20).at(40, 0, 15) - cylinder(10.02, 20).at(0, 0, 5)
"""5 mm above z = 0."""


def hinge(lower: str, upper: str, *, heavy_above: bool = False) -> set[str]:
    """The root of two subassemblies that turn on each other, one above the other."""
    block = box(80, 80, 20).at(0, 0, -10) + cylinder(10, 25)
    arm = BORED + (box(200, 200, 100).at(120, 0, 75) if heavy_above else box(20, 20, 10).at(90, 0, 30))
    nodes = [Node(lower, children=[part("block", block)]), Node(upper, children=[part("arm", arm)])]
    found = inferred(*nodes)
    return links(found)[found.root]


def test_named_base_is_the_root() -> None:
    """A link with a part named a base is the root, even if it is lighter and above."""
    assert hinge("a", "base") == {"base/arm"}
    assert hinge("base", "b", heavy_above=True) == {"base/block"}


def test_larger_and_lower_link_is_the_root() -> None:
    """Without names the larger one, if it is not far above, is the root."""
    assert hinge("a", "b") == {"a/block"}


def test_heavy_trunk_is_the_root_before_a_hub_with_more_joints() -> None:
    """A plate of three joints is the root, not the hub below it, which has six and half of its volume."""
    bore = cylinder(5.05, 10).at(0, 0, -5)
    lever = box(40, 15, 10).at(15, 0, 0) - bore
    at_plate, at_hub = (
        [(-120.0, 0.0), (120.0, 0.0)],
        [(-50.0, y) for y in (-40.0, 40.0)] + [(50.0, y) for y in (-40.0, 0.0, 40.0)],
    )
    plate, hub = box(300, 200, 20).at(0, 0, 10), box(150, 110, 40) - cylinder(5.05, 40).at(0, 0, -20)
    for x, y in [*at_plate, (0.0, 0.0)]:
        plate += cylinder(5, 13).at(x, y, -13)
    for x, y in at_hub:
        hub += cylinder(5, 13).at(x, y, -33)
    levers = [part(f"lever {x} {y}", lever, x=x, y=y, z=z) for z, at in ((-7, at_plate), (-49, at_hub)) for x, y in at]
    found = inferred(part("plate", plate), part("hub", hub, z=-22), *levers, sources=BARE)
    assert len(links(found)) == 9
    assert links(found)[found.root] == {"plate"}


def linkage(base: Solid, *, plate: str = "plate") -> str:
    """The root of a base with one joint, to a hub with four; names are read, subassemblies are not needed."""
    bore = cylinder(5.05, 10).at(0, 0, -5)
    lever = box(40, 15, 10).at(15, 0, 0) - bore
    body = box(100, 60, 10) - bore
    at = [(-40.0, -20.0), (-40.0, 20.0), (40.0, 0.0)]
    for x, y in at:
        body += cylinder(5, 11).at(x, y, 5)
    levers = [part(f"lever {n}", lever, x=x, y=y, z=10.5) for n, (x, y) in enumerate(at)]
    found = inferred(part(plate, base), part("hub", body), *levers)
    (name,) = links(found)[found.root]
    return name


@pytest.fixture(scope="module")
def upper_body(robot_library: Path) -> Assembly:
    """A torso with two arms and a head on a stand, which has one joint and a third of the torso's volume."""
    return read_quietly(robot_library / "stepbot_upper_body" / "upper_body.step", ReadOptions(faces=True))


@pytest.mark.slow
@pytest.mark.parametrize("up", DIRECTIONS)
def test_what_stands_on_the_ground_is_the_root_before_a_trunk(up: Direction, upper_body: Assembly) -> None:
    """Without names, a stand is the root and not the torso on it with four joints, whichever way is up."""
    X = Pose.of(rotation_of(up, "y" if up.endswith("x") else "x"))
    turned = tuple(replace(one, X_WC=X @ one.X_WC) for one in upper_body.components)
    found = infer_mechanism(replace(upper_body, components=turned), Sources(names=False))
    assert "base/stand" in links(found)[found.root]


def test_named_base_is_the_root_before_a_hub_with_more_joints() -> None:
    """A short post below the hub is the root if it is named a base, in any language; else the hub is."""
    post = cylinder(12, 20).at(0, 0, -26) + cylinder(5, 12).at(0, 0, -6.5)
    assert linkage(post, plate="part 1") == "hub"
    for name in ("Base", "Sockel", "ground", "底座", "основание"):
        assert linkage(post, plate=name) == name


@pytest.mark.parametrize("name", ["Gripper base", "Greifer Grundplatte", "tool frame", "夹爪底座"])
def test_base_of_what_is_carried_is_no_base(name: str) -> None:
    """The base of a gripper or a tool is not that of the robot."""
    assert Role.BASE not in roles(name)
    assert hinge("a", name) == {"a/block"}


def test_base_of_a_wheel_is_no_base() -> None:
    """A part named a base in a subassembly named a wheel is not that of the robot."""
    nodes = [Node("a", children=[part("block", box(80, 80, 20).at(0, 0, -10) + cylinder(10, 25))])]
    nodes += [Node("omni wheel", children=[part("base", BORED)])]
    found = inferred(*nodes)
    assert links(found)[found.root] == {"a/block"}


def test_base_drawn_in_pieces_is_one_link() -> None:
    """A second part named a base that touches nothing is part of the root, and its link is a guess."""
    block = box(80, 80, 20).at(0, 0, -10) + cylinder(10, 25)
    pieces = (part("ground", block), part("far ground", box(60, 60, 20), x=400.0))
    found = inferred(*pieces, part("arm", BORED))
    assert links(found)[found.root] == {"ground", "far ground"}
    assert "named a base, as the root is" in found.guesses.values()


@pytest.mark.parametrize("names", [("a", "b", "c"), ("1", "2", "3")])
def test_one_of_two_equal_limbs_is_no_root(names: tuple[str, str, str]) -> None:
    """What two equal levers turn on is the root, though each of them is larger."""
    middle = box(300, 40, 20).at(0, 0, 10) - cylinder(10, 20).at(-120, 0, 0) - cylinder(10, 20).at(120, 0, 0)
    lever = box(60, 300, 60).at(0, 80, 30) + cylinder(9.95, 20).at(0, 0, -20)
    nodes = [part(names[0], lever, -120, 0, 20.2), part(names[1], middle), part(names[2], lever, 120, 0, 20.2)]
    found = inferred(*nodes)
    assert len(found.links) == 3
    assert links(found)[found.root] == {names[1]}


def test_a_foot_that_touches_nothing_counts_for_what_is_next_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plate 1 mm below the smaller block is what the two stand on."""
    monkeypatch.setattr(unconnected, "grounds", lambda _: {"z": {3: 0.4}})
    block, foot = box(60, 60, 20).at(0, 0, -10) + cylinder(10, 25), box(90, 90, 4).at(0, 0, -23)
    arm = BORED + box(150, 100, 60).at(120, 0, 50)
    found = inferred(part("block", block), part("arm", arm), part("foot", foot), sources=BARE)
    assert links(found)[found.root] == {"block", "foot"}


@pytest.mark.parametrize(("up", "root"), [("z", "tip"), ("y", "tip"), ("-z", "arm"), ("x", "arm")])
def test_a_chain_stands_on_its_largest_link_towards_unusual_sides(
    up: Direction, root: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A small link with the only flat side is the root if that is below, and not if it is above or beside."""
    monkeypatch.setattr(unconnected, "grounds", lambda _: {up: {1: 0.4}})
    tip, arm = box(60, 60, 20).at(0, 0, -10) + cylinder(10, 25), BORED + cylinder(30, 60).at(80, 0, 24)
    found = inferred(part("tip", tip), part("arm", arm), sources=BARE)
    assert links(found)[found.root] == {root}


def test_the_root_is_on_the_branch_that_outweighs_a_hand() -> None:
    """A hub with four joints is no trunk if one of them is to what is heavier than the hub."""
    pin = cylinder(5, 12).at(0, 0, -6.5)
    assert linkage(box(60, 60, 12).at(0, 0, -12) + pin, plate="part 1") == "hub"
    assert linkage(box(100, 100, 20).at(0, 0, -16) + pin, plate="part 1") == "part 1"


@pytest.mark.parametrize("length", [20.0, 400.0])
def test_a_housing_that_turns_a_stub_and_a_table_is_the_root(length: float) -> None:
    """A motor's shaft is no end of a chain; what it turns, if it is as large as a link, is one."""
    housing = box(160, 140, 40).at(0, 0, -20) - cylinder(10.02, 20).at(0, 0, -20)
    motor = part("NEMA17", box(42, 42, 40).at(0, -91, -20) - cylinder(2.5, 20).at(0, -91, -20))
    shaft = part("NEMA17 shaft", cylinder(2.5, 40).at(0, -91, -20))
    load = part("coupling", cylinder(9, length).at(0, -91, 5) - cylinder(2.5, 15).at(0, -91, 5))
    table = part("table", cylinder(85, 30) + cylinder(10, 19).at(0, 0, -19))
    found = inferred(part("housing", housing), motor, shaft, load, table)
    assert "housing" in links(found)[found.root]


@pytest.mark.parametrize(("width", "roll"), [(160, 0.0), (120, pi), (160, pi)])
def test_what_a_motor_is_in_is_the_root_before_what_it_drives(width: float, roll: float) -> None:
    """A plate with a servo is the root, though the one on its horn is larger, and lower if the servo hangs."""
    servo = group("SG90 servo", part("block", box(40, 20, 30), z=-15), part("disc", cylinder(8, 3), x=10))
    plates = part("one", box(120, 80, 10), z=-35), part("two", box(120, width, 10), 40, 0, 8)
    found = inferred(replace(group("all", servo, *plates), X=Pose.from_xyz_rpy((0, 0, 0), (roll, 0, 0))))
    assert joints(found) == [("revolute", "all/one", "all/two")]
    assert "all/one" in links(found)[found.root]


def test_a_roller_on_a_flat_axis_is_no_root() -> None:
    """A heavy roller in bearings between the sides of a light frame turns in it, and not the frame about the roller."""
    side = box(300, 6, 60) - turned(cylinder(11, 6), 0, 3, 0, (pi / 2, 0, 0))
    ring = cylinder(11, 6) - cylinder(4, 6)
    sides = [part(f"side {y}", side, y=y) for y in (-60, 60)]
    seats = [part(f"608 {y}", turned(ring, 0, y + 3, 0, (pi / 2, 0, 0))) for y in (-60, 60)]
    roller = turned(cylinder(40, 100).at(0, 0, -50) + cylinder(4, 140).at(0, 0, -70), rpy=(pi / 2, 0, 0))
    cross = [part(f"cross {x}", box(10, 114, 10), x=x) for x in (-140, 140)]
    found = inferred(*sides, *seats, *cross, part("roller", roller))
    assert "side -60" in links(found)[found.root]
