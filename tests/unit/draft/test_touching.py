"""Drafts propose what touches the ground and the objects: wheels, casters, feet and fingers, each with its reason."""

from math import pi
from pathlib import Path

import pytest
from msgspec.structs import replace

from stepbot.draft.draft import Confidence, Draft, DraftClosure, DraftJoint, DraftLink, OriginForm, OriginSnippet
from stepbot.draft.text.sidecar_text import sidecar_text
from stepbot.draft.touching import contacts_of
from stepbot.geometry.spatial import Vector3
from stepbot.robot.model import JointKind, Sphere
from stepbot.robot.surfaces import Surface
from stepbot.sidecar.contact import ContactMaterial
from tests.unit.assemble.workshop import MM, Workshop, at
from tests.unit.draft.test_sidecar_text import built

LEVEL = (pi / 2, 0.0, 0.0)
"""A cylinder along y."""
ORIGIN = OriginSnippet(OriginForm.XYZ)
RUBBER, SILICONE, SLIDING = (
    ContactMaterial.RUBBER_ON_FLOOR,
    ContactMaterial.SILICONE_ON_OILED_STEEL,
    ContactMaterial.PTFE_ON_STEEL,
)


def link(name: str, *indices: int, parts: tuple[str, ...] = (), rest: bool = False) -> DraftLink:
    """A link of some components."""
    return DraftLink(name, parts or ((name,) if not rest else ()), Confidence(1.0), rest=rest, components=indices)


def joint(parent: str, child: str, kind: JointKind, point: Vector3, direction: Vector3 = (0.0, 1.0, 0.0)) -> DraftJoint:
    """A sure joint at a point [mm]."""
    x, y, z = point
    place = (x * MM, y * MM, z * MM)
    return DraftJoint(
        *(f"{child}_joint", kind, replace(ORIGIN, xyz=place), direction, place, direction),
        *(Confidence(0.9), (parent, child)),
        parent=parent,
        child=child,
    )


def rover(lift: float = 0.0) -> tuple[Draft, Workshop]:
    """A chassis on two wheels of r 40 mm and a skid below it; the wheels are lifted by some millimetres."""
    made = Workshop()
    chassis = made.box("chassis", (200, 100, 20), at(0, 0, 60))
    skid = made.box("skid", (10, 10, 50), at(80, 0, 25))
    sides = {"left": 70, "right": -70}
    wheels = [made.rod(side, 40, 20, at(-60, y, 40 + lift, LEVEL)) for side, y in sides.items()]
    links = (link("chassis", chassis, skid, rest=True), link("left", wheels[0]), link("right", wheels[1]))
    axles = [joint("chassis", side, JointKind.CONTINUOUS, (-60, y, 40 + lift)) for side, y in sides.items()]
    return Draft("rover", "chassis", links, tuple(axles), without_density=("",)), made


def walker(reach: float = 100.0) -> tuple[Draft, Workshop]:
    """A trunk at a height of 100 mm with two legs of two joints, whose shins end ``reach`` below it."""
    made = Workshop()
    links, joints = [link("trunk", made.box("trunk", (100, 100, 20), at(0, 0, 110)), rest=True)], []
    for side, y in (("left", 60), ("right", -60)):
        thigh = made.box(f"{side} thigh", (10, 10, 50), at(0, y, 75))
        shin = made.box(f"{side} shin", (10, 10, reach - 50), at(0, y, 50 - (reach - 50) / 2))
        links += [link(f"{side} thigh", thigh), link(f"{side} shin", shin)]
        joints.append(joint("trunk", f"{side} thigh", JointKind.REVOLUTE, (0, y, 100)))
        joints.append(joint(f"{side} thigh", f"{side} shin", JointKind.REVOLUTE, (0, y, 50)))
    return Draft("walker", "trunk", tuple(links), tuple(joints)), made


def proposed(draft: Draft, made: Workshop) -> list[tuple[str, str, ContactMaterial]]:
    """Link, part and material of each proposal."""
    return [(one.link, one.part, one.material) for one in contacts_of(draft, made.assembly)]


def test_a_base_on_wheels_in_one_line_slides_on_its_lowest_part() -> None:
    """A skid that ends 8 mm above the ground, farther than what counts as on it: the base leans on it all the same."""
    found = [("chassis", "skid", SLIDING), ("left", "", RUBBER), ("right", "", RUBBER)]
    assert proposed(*rover(lift=-8.0)) == found


def test_wheels_are_rubber_and_what_slides_beside_them_has_little_friction() -> None:
    """Both wheels of a rover, and the one part of its chassis that is on the ground."""
    found = [("chassis", "skid", SLIDING), ("left", "", RUBBER), ("right", "", RUBBER)]
    assert proposed(*rover()) == found


def test_rollers_of_a_wheel_touch_the_ground_in_its_place() -> None:
    """A link that turns and carries three turning ones is a hub; a chassis with three wheels is none."""
    draft, made = rover()
    rims = [made.rod(f"roller {n}", 40, 5, at(-60, 70 + n, 40, LEVEL)) for n in range(3)]
    links = (*draft.links, *(link(f"roller {n}", i) for n, i in enumerate(rims)))
    axles = tuple(joint("left", f"roller {n}", JointKind.CONTINUOUS, (-60, 70, 40)) for n in range(3))
    found = proposed(replace(draft, links=links, joints=(*draft.joints, *axles)), made)
    assert found == [
        ("chassis", "skid", SLIDING),
        ("right", "", RUBBER),
        *((f"roller {n}", "", RUBBER) for n in range(3)),
    ]


def test_round_links_above_the_ground_are_no_wheels() -> None:
    """Propellers and pulleys turn about level axes, too; a robot on a skid has no casters."""
    assert proposed(*rover(lift=10.0)) == []


@pytest.mark.parametrize("kind", [JointKind.PRISMATIC, JointKind.FIXED])
def test_wheels_turn(kind: JointKind) -> None:
    """A round link that slides, or that nothing moves, is none."""
    draft, made = rover()
    assert proposed(replace(draft, joints=tuple(replace(one, type=kind) for one in draft.joints)), made) == []


def test_ends_of_limbs_on_the_ground_are_feet() -> None:
    """The shins of a walker, if its trunk is above the ground."""
    assert proposed(*walker()) == [("left shin", "", RUBBER), ("right shin", "", RUBBER)]


def test_one_limb_and_limbs_in_loops_have_no_feet() -> None:
    """The arms of a delta robot that hangs end on a platform; one arm that reaches the ground is no leg."""
    draft, made = walker()
    loop = DraftClosure(
        "loop", JointKind.BALL, ORIGIN, "z", (0, 0, 0), None, Confidence(0.9), ("a", "b"),
        link_a="left shin", link_b="right shin",
    )  # fmt: skip
    assert proposed(replace(draft, closures=(loop,)), made) == []
    assert proposed(replace(draft, links=draft.links[:3], joints=draft.joints[:2]), made) == []


def test_only_fingers_at_the_end_of_the_tree_grip() -> None:
    """By the name of the link, or of one of its parts."""
    draft, made = walker(reach=90.0)
    made.box("stand", (50, 50, 10), at(0, 0, 5))
    base = replace(draft.links[0], components=(*draft.links[0].components, len(made.components) - 1))
    links = (base, *(replace(one, name=one.name.replace("shin", "finger")) for one in draft.links[1:]))
    joints = tuple(replace(one, child=one.child.replace("shin", "finger")) for one in draft.joints)
    found = [("left finger", "", SILICONE), ("right finger", "", SILICONE)]
    assert proposed(replace(draft, links=links, joints=joints), made) == found


def test_proposals_are_written_with_their_reasons_and_reach_the_robot(tmp_path: Path) -> None:
    """Marked REVIEW beside the first of each reason; the shapes of the robot have the friction."""
    draft, made = rover()
    draft = replace(draft, contacts=contacts_of(draft, made.assembly))
    text = sidecar_text(draft, "robot.step")
    assert "    contact: rubber-on-floor  # REVIEW: a tyre on the ground, of one of 2 wheels; friction 0.7\n" in text
    assert "    contact: rubber-on-floor  # as above\n" in text
    assert '\nparts:\n  "skid": {contact: ptfe-on-steel}  # REVIEW: on the ground beside wheels, and no ' in text
    assert text.count("    collision: {merge: wheel}\n") == 2
    robot, _ = built(draft, tmp_path, made)
    (shape,) = next(one for one in robot.links if one.name == "left").collisions
    assert isinstance(shape.geometry, Sphere)
    assert shape.geometry.radius == pytest.approx(0.04, rel=1e-6)
    surfaces = {one.name: {shape.surface for shape in one.collisions} for one in robot.links}
    assert surfaces["left"] == surfaces["right"] == {Surface(0.7)}
    assert surfaces["chassis"] == {Surface(), Surface(0.04)}
