"""Parts without a connection: placeholders, wheels and fingers by name, small parts."""

import pytest
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.draft_robot import infer
from stepbot.draft.inference import infer_mechanism
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import JointKind
from stepbot.step.assembly import BodyKind
from tests.assembled import Node, assembled, group, inferred, joints, links, part
from tests.made.kit import across
from tests.solids import box, cylinder

CHASSIS = box(400, 200, 80)


def test_large_unconnected_part_gets_a_placeholder() -> None:
    """A second body of similar size, far away, is a link with a fixed joint that is to be reviewed."""
    found = inferred(part("one", CHASSIS), part("two", box(300, 200, 80), z=500))
    (arc,) = found.arcs
    assert (arc.evidence.type, arc.evidence.score) == (JointKind.FIXED, 0.0)
    assert arc.evidence.review == "type, axis and parent are unknown"


def test_small_unconnected_part_goes_to_its_neighbour() -> None:
    """A small body goes to the nearest larger one, as a guess."""
    found = inferred(part("one", CHASSIS), part("two", CHASSIS, z=500), part("tiny", box(5, 5, 5), z=450))
    assert {"two", "tiny"} in links(found)
    assert 3 in found.guesses


def test_wheel_by_name_turns_about_its_own_axis() -> None:
    """A single part named a wheel turns, although nothing holds it."""
    found = inferred(part("chassis", CHASSIS), part("wheel", cylinder(50, 30), z=60))
    assert joints(found) == [("revolute", "chassis", "wheel")]
    assert found.arcs[0].evidence.review == "guessed from its name; no contact shows this joint"


def test_two_fingers_by_name_slide_towards_each_other() -> None:
    """Two equal fingers in front of a palm slide; their pads do not."""
    finger = box(20, 15, 60)
    sides = [group(f"finger {x}", part("blade", finger, x=x, z=82)) for x in (-25.0, 25.0)]
    found = inferred(group("palm", part("block", box(100, 100, 100))), *sides)
    assert [kind for kind, *_ in joints(found)] == ["prismatic", "prismatic"]


def test_guessed_parts_are_named() -> None:
    """The draft lists the parts that a link has by a guess, at most three for each reason."""
    tiny = [part(f"tiny {n}", box(5, 5, 5), x=20 * n, z=450) for n in range(5)]
    draft = infer(assembled(part("one", CHASSIS), part("two", CHASSIS, z=500), *tiny), "robot")
    evidence = [fact for link in draft.links for fact in link.confidence.evidence]
    assert evidence == ["not connected: assigned to the nearest part: 'tiny 0', 'tiny 1', 'tiny 2' and 2 more"]


def test_decks_on_standoffs_are_one_body() -> None:
    """Screws and standoffs hold what nothing else does, if there are two; a single one may be anything."""
    deck, standoff = box(120, 80, 4) - cylinder(2, 4).at(-50, 0, -2) - cylinder(2, 4).at(50, 0, -2), cylinder(4, 46)
    pillars = [part("standoff M4", standoff - cylinder(2, 46), x, z=2) for x in (-50, 50)]
    found = inferred(part("lower", deck), part("upper", deck, z=50), *pillars)
    assert len(found.links) == 1
    alone = inferred(part("lower", deck), part("upper", deck, z=50), pillars[0])
    assert len(alone.links) == 2


def test_decks_with_a_joint_each_are_one_body_on_standoffs() -> None:
    """Two decks on standoffs are one body, also where a motor on each turns something."""
    deck, standoff = box(120, 80, 4) - cylinder(2, 4).at(-50, 0, -2) - cylinder(2, 4).at(50, 0, -2), cylinder(4, 46)
    pillars = [part("standoff M4", standoff - cylinder(2, 46), x, z=2) for x in (-50, 50)]
    wheels = [
        node
        for z, way in ((62, 1), (-12, -1))
        for node in (
            group(
                f"servo {z}",
                part("case", box(30, 30, 20), z=z),
                part("horn", cylinder(8, 4), z=z + (10 if way > 0 else -14)),
            ),
            part(f"arm {z}", box(60, 12, 4).at(20, 0, 0), z=z + 16 * way),
        )
    ]
    found = inferred(part("lower", deck), part("upper", deck, z=50), *pillars, *wheels)
    assert len(joints(found)) == 2
    assert any({"lower", "upper"} <= link for link in links(found))


def test_a_block_that_is_screwed_to_two_plates_joins_them() -> None:
    """A spacer with two screw holes towards each of two plates holds both; a round one is a fastener."""
    holes = [cylinder(1.5, 60).at(0, y, -10) for y in (-5, 5)]
    plate, spacer = (
        box(80, 30, 4) - holes[0] - holes[1],
        box(20, 20, 30) - holes[0].at(0, 0, -20) - holes[1].at(0, 0, -20),
    )
    plates = [part("front", plate), part("back", plate, z=34)]
    survey = Survey(
        assembled(*plates, part("femur spacer", spacer, z=17), part("spacer", cylinder(4, 5), x=60)), ALL_SOURCES
    )
    assert [survey.parts[i].path for i in survey.small] == ["spacer"]


@pytest.mark.parametrize(("width", "is_fork"), [(50, True), (54, False)])
def test_both_sides_of_a_fork_are_on_what_they_stand_beside(width: float, *, is_fork: bool) -> None:
    """Two equal cheeks drawn 0.1 mm above a table, with what turns between them, are one; unequal ones are not."""
    cheek, stub = box(50, 6, 90).at(0, 0, 45) - across(5, 20, z=70), across(4.95, 16)
    cradle = box(60, 70, 40).at(0, 0, 70) - across(5, 100, z=70)
    other = cheek if is_fork else box(width, 6, 90).at(0, 0, 45) - across(5, 20, z=70)
    sides = [part("cheek -40", cheek, 0, -40, 0.1), part("cheek 40", other, 0, 40, 0.1)]
    stubs = [part(f"stub {y}", stub, 0, y, 70.1) for y in (-38, 38)]
    found = inferred(part("table", box(160, 160, 20), z=-10), *sides, *stubs, part("cradle", cradle, z=0.1))
    kinds = [kind for kind, *_ in joints(found)]
    assert kinds == ["revolute"] * (1 if is_fork else 2)
    assert any({"cheek -40", "cheek 40"} <= link for link in links(found)) == is_fork


def test_a_mechanism_beside_a_large_body_without_joints_gets_a_placeholder() -> None:
    """What turns stands apart from a chassis that has no joint: one hinge, and a fixed joint between both."""
    hinge = part("bracket", box(40, 40, 10) - cylinder(4, 10).at(0, 0, -5), z=200)
    arm = part("arm", box(80, 20, 6).at(30, 0, 8) + cylinder(3.9, 20).at(0, 0, -10), z=200)
    for beside in ([], [part("slab", box(200, 150, 40), z=150)]):  # which is of the mechanism that it is nearest to
        found = inferred(part("chassis", CHASSIS), hinge, arm, *beside)
        assert sorted(str(arc.evidence.type) for arc in found.arcs) == ["fixed", "revolute"]
        assert {"arm", *(one.name for one in beside)} in links(found)


def pendulum(name: str, x: float, length: float) -> list[Node]:
    """An arm on a pin between two cheeks of a base, all of it around x [mm]."""
    base = box(80, 120, 10).at(0, 0, 5)
    for y in (-20, 20):
        base = base + box(30, 12, 150).at(0, y, 80)
    arm = box(24, 20, length).at(0, 0, 140 - 0.45 * length) - across(4.1, 100, z=140)
    solids = {"stand": base - across(4, 100, z=140), "arm": arm, "pin": across(4, 70, z=140)}
    return [part(f"{name} {what}", solid, x) for what, solid in solids.items()]


@pytest.mark.parametrize("is_grouped", [False, True])
def test_mechanisms_that_stand_apart_are_each_on_the_ground(is_grouped: bool) -> None:
    """Two pendulums of unequal arms, also as a subassembly each: two hinges, and a fixed joint between what stands."""
    sides = [pendulum("A", 0, 110), pendulum("B", 400, 80)]
    nodes = [group(f"machine {n}", *side) for n, side in enumerate(sides)] if is_grouped else [*sides[0], *sides[1]]
    found = infer_mechanism(assembled(*nodes, is_meshed=True))
    assert [(kind, a.split()[-1], b.split()[-1]) for kind, a, b in joints(found)] == [("revolute", "arm", "stand")] * 2
    (fixed,) = (arc for arc in found.arcs if arc.evidence.type == JointKind.FIXED)
    assert fixed.parent == found.root
    assert fixed.evidence.review == "stands beside the root on one ground: it may be a robot of its own"
    stands = [{found.survey.parts[i].path.split()[-1] for i in found.links[n]} for n in (fixed.parent, fixed.child)]
    assert stands == [{"stand", "pin"}] * 2


def test_bodies_without_volume_are_of_the_part_that_they_are_bodies_of() -> None:
    """A dial drawn as surfaces, with a shaft in a plate, is no link that turns there, but one with its case."""
    case = Node("case", box(30, 60, 30).shape, X=Pose.from_xyz_rpy((0.04, 0, 0.015), (0, 0, 0)))
    dial = Node("dial", (cylinder(15, 10) + cylinder(5, 8).at(0, 0, -8)).shape)
    plate = box(120, 60, 8).at(0, 0, -4) - cylinder(5.1, 8).at(0, 0, -8)
    bar = group("arm", part("plate", plate), part("block", box(20, 60, 60).at(-50, 0, 30)))
    drawn = assembled(bar, Node("camera", children=[case, dial], has_bodies=True), part("base", CHASSIS, x=400))
    hollow = next(c.body for c in drawn.components if c.path == "camera/dial")
    bodies = [replace(b, exact=None, kind=BodyKind.SURFACE) if n == hollow else b for n, b in enumerate(drawn.bodies)]
    found = infer_mechanism(replace(drawn, bodies=tuple(bodies)))
    assert any({"camera/case", "camera/dial"} <= link for link in links(found))
