"""Drafts from the STEP alone, of robots whose joints are known."""

from collections.abc import Callable
from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.scoring import score
from benchmarks.truth import read_truth
from robot_library.moments import pose
from stepbot.diagnostics import Diagnostics
from stepbot.draft.contacts.survey import Sources
from stepbot.draft.draft import Draft, OriginForm
from stepbot.draft.draft_robot import infer
from stepbot.draft.inference import infer_mechanism
from stepbot.robot.model import Base, JointKind
from stepbot.step.assembly import Assembly, BodyKind, MeshTolerance, ReadOptions
from stepbot.step.reader import read_assembly
from tests.assembled import BARE, Node, assembled, group, inferred, joints, part, turned
from tests.solids import box, cylinder, joined

LIBRARY = Path(__file__).parents[3] / "robot_library"


@cache
def assembly(folder: str) -> Assembly:
    """A robot of the library with its faces."""
    (step,) = (LIBRARY / folder).glob("*.step")
    diagnostics = Diagnostics()
    options = ReadOptions(faces=True, tolerance=MeshTolerance(relative=0.05, angle=0.8))
    read = read_assembly(step, options, diagnostics)
    assert read is not None, list(diagnostics)
    return read


@pytest.fixture(scope="session")
def drafted() -> Callable[[str], Draft]:
    """Drafts a robot of the library."""
    return cache(lambda folder: infer(assembly(folder), folder))


def test_four_bar_is_a_loop_of_four_hinges(drafted: Callable[[str], Draft]) -> None:
    """Three hinges make the tree and one closes the loop; all four axes are parallel."""
    draft = drafted("stepbot_four_bar")
    kinds = [j.type for j in (*draft.joints, *draft.closures)]
    assert (len(draft.links), len(draft.joints), len(draft.closures)) == (4, 3, 1)
    assert set(kinds) == {JointKind.REVOLUTE}
    directions = np.array([j.direction for j in (*draft.joints, *draft.closures)])
    assert np.linalg.norm(np.cross(directions, directions[0]), axis=1).max() < 1e-9


@pytest.mark.slow
def test_a_link_without_volume_is_fixed_and_may_move() -> None:
    """Engines have no moving link without mass: the motion of a link of surfaces is a line to uncomment."""
    drawn = assembly("stepbot_scara")
    moving = infer(drawn, "scara")
    (tip,) = (j for j in moving.joints if j.child not in {other.parent for other in moving.joints})
    (hollow,) = (link for link in moving.links if link.name == tip.child)
    surfaces = {drawn.components[i].body for i in hollow.components}
    bodies = tuple(replace(b, kind=BodyKind.SURFACE) if n in surfaces else b for n, b in enumerate(drawn.bodies))
    (joint,) = (j for j in infer(replace(drawn, bodies=bodies), "scara").joints if j.child == tip.child)
    assert (joint.type, joint.alternatives[0].type) == (JointKind.FIXED, tip.type)
    assert "encloses a volume" in joint.review


@pytest.mark.slow
def test_slider_crank_has_one_slide(drafted: Callable[[str], Draft]) -> None:
    """The loop leaves the piston a slide and no rotation."""
    draft = drafted("stepbot_slider_crank")
    assert sorted(j.type for j in (*draft.joints, *draft.closures)) == ["prismatic", "revolute", "revolute", "revolute"]


@pytest.mark.slow
def test_every_part_is_claimed_by_one_link(drafted: Callable[[str], Draft]) -> None:
    """All components with a body are in exactly one link, and one link takes the rest."""
    for folder in ("stepbot_four_bar", "stepbot_quadruped"):
        draft = drafted(folder)
        bodies = [c.index for c in assembly(folder).components if c.body >= 0]
        assert sorted(i for link in draft.links for i in link.components) == bodies
        assert [link.name for link in draft.links if link.rest] == [draft.root]


def test_joints_are_mates_where_the_drawing_has_them(drafted: Callable[[str], Draft]) -> None:
    """A pin in its bore is drafted as the mate of both parts, with the axis of the frame."""
    for joint in drafted("stepbot_four_bar").joints:
        assert joint.origin.form == OriginForm.MATE
        assert joint.axis == "z"


@pytest.mark.slow
def test_evidence_stands_with_every_joint(drafted: Callable[[str], Draft]) -> None:
    """Each joint has evidence, and each uncertain one a mark."""
    for joint in drafted("stepbot_quadruped").joints:
        assert joint.confidence.evidence
        assert joint.is_reviewed or joint.confidence.score >= 0.8


@pytest.mark.slow
@pytest.mark.parametrize("sources", [Sources(), Sources(names=False), Sources(names=False, tree=False)])
def test_same_assembly_same_draft(sources: Sources) -> None:
    """Two drafts of an assembly agree in every number and text."""
    folder = "stepbot_slider_crank"
    assert infer(assembly(folder), "robot", sources) == infer(assembly(folder), "robot", sources)


@pytest.mark.slow
def test_rods_between_balls_do_not_spin() -> None:
    """Each rod of a delta robot has a universal joint at the arm and a ball at the platform, in either order."""
    draft = infer(assembly("stepbot_delta"), "delta")
    kinds = [j.type for j in (*draft.joints, *draft.closures)]
    counts = {kind: kinds.count(kind) for kind in set(kinds)}
    assert counts == {JointKind.REVOLUTE: 3, JointKind.UNIVERSAL: 6, JointKind.BALL: 6}
    assert all(j.is_reviewed for j in (*draft.joints, *draft.closures) if j.type == JointKind.UNIVERSAL)


@pytest.mark.slow
def test_struts_slide_without_names() -> None:
    """The six legs of a Stewart platform are slides: a shaft in a bore between two swivels."""
    draft = infer(assembly("stepbot_stewart"), "stewart", Sources(names=False))
    kinds = [j.type for j in (*draft.joints, *draft.closures)]
    assert kinds.count(JointKind.PRISMATIC) == 6


@pytest.mark.slow
def test_motors_by_their_use() -> None:
    """Without names and tree, equal motors mounted off their axes give all 18 joints."""
    draft = infer(assembly("stepbot_hexapod"), "hexapod", Sources(names=False, tree=False))
    assert [j.type for j in draft.joints] == [JointKind.REVOLUTE] * 18
    assert all(j.is_reviewed for j in draft.joints)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("folder", "found", "volume"),
    [
        ("stepbot_scara", 2, 0.98),
        pytest.param("universal_robots_ur5e", 5, 0.97, marks=pytest.mark.long),
        pytest.param("stepbot_upper_body", 19, 0.97, marks=pytest.mark.long),
        pytest.param("robotiq_2f85", 6, 0.94, marks=pytest.mark.long),
    ],
)
def test_stands_and_linkages_without_names_and_tree(folder: str, found: int, volume: float) -> None:
    """Joints with the reference's axes, types and sides, and the share of the volume in the right links."""
    (sidecar,) = (LIBRARY / folder).glob("*.robot.yaml")
    drawn = assembly(folder)
    result = score(infer_mechanism(drawn, Sources(names=False, tree=False)), read_truth(sidecar, drawn))
    assert result.found >= found
    assert result.volume > volume
    assert result.unmarked == 0


@pytest.mark.slow
def test_fingers_slide_towards_each_other() -> None:
    """Two equal fingers of each hand slide in opposite directions, by their names and marked for review."""
    draft = infer(assembly("abb_yumi"), "yumi")
    slides = [j for j in draft.joints if j.type == JointKind.PRISMATIC]
    assert len(slides) == 4
    assert all(j.is_reviewed for j in slides)
    for parent in {j.parent for j in slides}:
        one, two = (np.array(j.direction) for j in slides if j.parent == parent)
        assert one @ two == pytest.approx(-1.0, abs=1e-6)


def test_two_wheels_make_a_floating_base() -> None:
    """Wheels, by name or since all stands on them, turn without limits, and their base floats; other links do not."""
    tyre = cylinder(30, 12) - cylinder(4.05, 12)
    rolls, stays = (JointKind.CONTINUOUS, Base.FLOATING), (JointKind.REVOLUTE, Base.FIXED)
    for name, width, (kind, base) in (("wheel", 80, rolls), ("disc", 50, rolls), ("disc", 80, stays)):
        hub = box(width, width, 10) + cylinder(4, 120).at(0, 0, -60)
        nodes = [group("chassis", part("plate", hub)), group("a", part(f"{name} left", tyre, z=45))]
        draft = infer(assembled(*nodes, group("b", part(f"{name} right", tyre, z=-57))), "cart")
        assert [joint.type for joint in draft.joints] == [kind, kind]
        assert draft.base is base


@pytest.mark.parametrize(("is_on_a_foot", "base"), [(False, Base.FLOATING), (True, Base.FIXED)])
def test_wheels_in_steered_forks_make_a_floating_base(is_on_a_foot: bool, base: Base) -> None:
    """What stands on wheels rolls, though they turn in forks that turn on the chassis; on a foot it stands still."""
    turned = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]  # z to -y
    chassis = box(200, 80, 10) + cylinder(20, 90).at(0, 0, -90) if is_on_a_foot else box(200, 80, 10)
    for x in (80, -80):
        chassis -= cylinder(6.02, 10).at(x, 0, -5)
    fork = box(24, 30, 6) + cylinder(6, 13).at(0, 0, 0) + box(24, 4, 60).at(0, 13, -30) + box(24, 4, 60).at(0, -13, -30)
    fork += cylinder(4, 30).moved(pose((0, 15, -50), turned))
    tyre = (cylinder(30, 12) - cylinder(4.02, 12)).moved(pose((0, 6, -50), turned))
    nodes = [group("chassis", part("plate", chassis, z=8))]
    for n, x in enumerate((80, -80)):
        nodes.append(group(f"fork {n}", part(f"holder {n}", fork.at(x, 0, 0))))
        nodes.append(group(f"disc {n}", part(f"disc {n}", tyre.at(x, 0, 0))))
    draft = infer(assembled(*nodes), "cart")
    assert len(draft.joints) == 4
    assert draft.base is base


@pytest.mark.parametrize(("thickness", "moving"), [(6.0, 2), (6.04, 2), (6.09, 1), (7.0, 1)])
def test_equal_small_bodies_on_one_axle_turn_alone(thickness: float, moving: int) -> None:
    """Discs whose volumes differ by less than a hundredth are two; others are a horn and the idler behind it."""
    plate = box(200, 200, 4) + cylinder(4, 40).at(0, 0, -20)
    left, right = (cylinder(10, height) - cylinder(4.05, height) for height in (6.0, thickness))
    nodes = [group("a", part("disc left", left, z=3)), group("b", part("disc right", right, z=-3 - thickness))]
    draft = infer(assembled(group("base", part("plate", plate)), *nodes), "cart")
    assert len(draft.joints) == moving


def test_a_draft_without_joints_says_why() -> None:
    """A single block has no axis that two parts share."""
    draft = infer(assembled(part("block", box(10, 10, 10)), part("lid", box(10, 10, 2), z=6)), "still")
    assert not draft.joints
    assert draft.notes[0].startswith("no moving parts found: ")


def test_wheels_that_all_stands_on_turn_at_the_ends_of_round_bosses() -> None:
    """Two equal wheels end 2 mm beside bosses, without shafts: they are links, since their rims are on the ground."""
    chassis, wheels = box(100, 600, 60), list[Node]()
    for n, side in enumerate((1, -1)):
        rpy = (0, side * pi / 2, 0)
        chassis = joined(chassis, turned(cylinder(15, 15), side * 45, -60, 0, rpy))
        wheels.append(part(f"w{n}", turned(cylinder(40, 15), side * 62, -60, 0, rpy)))
    found = inferred(
        part("a", chassis),
        part("b", box(30, 30, 60), 0, 90),
        part("c", box(10, 30, 8), 0, 90, 34),
        *wheels,
        sources=BARE,
    )
    assert [pair[1:] for pair in joints(found)] == [("a", "w0"), ("a", "w1")]
