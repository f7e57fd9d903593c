"""Drawn mechanisms are drafted from descriptions of them: parts in their links, joints on their lines and as drawn."""

from collections.abc import Mapping, Sequence
from random import Random

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.draft.draft import Draft, DraftJoint
from stepbot.draft.from_description.drafted import draft_of_description
from stepbot.draft.from_description.lines import Lines
from stepbot.draft.parts.axis import Axis
from stepbot.engines.description import DescribedShape, Description
from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import JointKind, Limit
from stepbot.step.assembly import Assembly
from stepbot.step.features.axis_faces import axis_faces
from stepbot.step.kernel import faces_of
from tests.assembled import assembled, part, turned
from tests.made.described import description_of
from tests.made.kit import SCREWS
from tests.made.scored import drawn
from tests.solids import box, cylinder

FOUND = (
    ("pan_tilt", 1),
    ("quadruped", 0),
    ("telescope", 1),
    ("cheek_quadruped", 1),
    ("side_by_side", 1),
    ("excavator", 1),
    ("knee_brace", 0),
    ("dovetail_stage", 1),
)
"""Kinds and seeds whose links all have a shape that is no other's."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), FOUND)
def test_a_description_is_found_in_its_assembly(kind: str, seed: int) -> None:
    """Frames are turned at random and joints are drawn off their zeros; limits are those of the description."""
    kit = drawn(kind, seed)
    assembly, link_of = kit.assembly(is_meshed=True)
    description, positions = description_of(kit, assembly, link_of, Random(f"{kind}{seed}"))
    draft = draft_of_description(description, assembly, kind, "drawn.urdf")
    assert draft is not None
    found = {assembly.components[i].path: link.name for link in draft.links for i in link.components}
    assert {path: found[path] for path, link in link_of.items() if link != SCREWS} == {
        path: link for path, link in link_of.items() if link != SCREWS
    }
    assert len(draft.joints) == len(positions)
    assert len(draft.joints) + len(draft.closures) == len(kit.joints)
    for joint in (*draft.joints, *draft.closures):
        ends = {joint.parent, joint.child} if isinstance(joint, DraftJoint) else {joint.link_a, joint.link_b}
        true = next(one for one in kit.joints if {one.a, one.b} == ends)
        assert joint.type == true.kind
        assert joint.direction is not None
        assert abs(np.dot(joint.direction, true.direction)) == pytest.approx(1.0, abs=1e-9)
        if joint.type is not JointKind.PRISMATIC:
            assert np.linalg.norm(np.cross(np.array(joint.point) - true.point, true.direction)) < 1e-7
    for joint in draft.joints:
        assert joint.zero == pytest.approx(positions[joint.child], abs=1e-5)
        assert joint.limits is not None
        assert (joint.limits.lower, joint.limits.upper) == pytest.approx((joint.zero - 0.5, joint.zero + 0.5), abs=1e-5)


def draft_of_parts(assembly: Assembly, places: Mapping[str, Array], joints: Sequence[ObservedJoint]) -> Draft:
    """The draft by a description with frames at places [m]; parts named like links are theirs.

    A link without a part has no mass.
    """
    bodies = {one.path.rpartition("/")[2]: one for one in assembly.components if one.body >= 0}
    mass = {"mass": 1.0, "com": (0.0, 0.0, 0.0), "inertia": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))}
    links = tuple(ObservedLink(name, **(mass if name in bodies else {})) for name in places)
    frames = {one.child: Pose.of(position=places[one.child] - places[one.parent]) for one in joints}
    shapes = []
    for name in places.keys() & bodies.keys():
        mesh = assembly.bodies[bodies[name].body].mesh
        placed = TriMesh.of(bodies[name].X_WC.apply(mesh.vertices), mesh.faces)
        shapes.append(DescribedShape(name, name, placed, Pose.of(position=places[name]).inverse()))
    seen = Observation("test", "1", "urdf", links=links, joints=tuple(joints))
    draft = draft_of_description(Description(seen, frames, tuple(shapes)), assembly, "drawn", "drawn.urdf")
    assert draft is not None
    return draft


def link_of_parts(assembly: Assembly, places: Mapping[str, Array], joints: Sequence[ObservedJoint]) -> dict[str, str]:
    """The link of each part in that draft."""
    draft = draft_of_parts(assembly, places, joints)
    return {assembly.components[i].path.rpartition("/")[2]: link.name for link in draft.links for i in link.components}


@pytest.mark.parametrize(("kind", "is_limited"), [("revolute", True), ("continuous", False), ("fixed", False)])
def test_limits_are_those_of_the_description(kind: str, is_limited: bool) -> None:
    """A joint that turns endlessly has none, nor has one that does not turn, whatever is written there."""
    nodes = part("base", box(40, 40, 10)), part("arm", box(60, 12, 5), z=8)
    limit = Limit() if kind == "continuous" else Limit(-0.5, 0.25, 2.0, 3.0)
    joint = ObservedJoint("j", kind, "base", "arm", axis=(0.0, 0.0, 1.0), limit=limit)
    draft = draft_of_parts(assembled(*nodes, is_meshed=True), dict.fromkeys(("base", "arm"), np.zeros(3)), [joint])
    assert [one.limits for one in draft.joints] == [limit if is_limited else None]


def test_every_line_of_faces_is_known() -> None:
    """Each of four bores of a plate, one across it, is a line, however many are parallel; between them is none."""
    plate, at = box(80, 60, 10), [(-25.0, -15.0), (-25.0, 15.0), (25.0, 15.0)]
    for x, y in at:
        plate -= cylinder(3, 10).at(x, y, -5)
    plate -= turned(cylinder(2, 80), -40, 0, 0, (0, np.pi / 2, 0))
    drawn = assembled(part("plate", plate, 100))
    (body,) = drawn.bodies
    lines = Lines(replace(drawn, bodies=(replace(body, axis_faces=axis_faces(faces_of(plate.shape), [])),)))
    upright = [np.array([0.1 + 1e-3 * x, 1e-3 * y, 1.0]) for x, y in [*at, (25.0, -15.0)]]
    assert [lines.has(Axis(point, np.array([0.0, 0.0, 1.0]))) for point in upright] == [True, True, True, False]
    assert lines.has(Axis(np.zeros(3), np.array([-1.0, 0.0, 0.0])))


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "ball"])
@pytest.mark.parametrize("beside", [0.0, 0.002])
def test_faces_about_the_axis_of_a_joint_are_evidence_of_it(kind: str, beside: float) -> None:
    """Of a hinge or slide on the line of a pin in a bore, not 2 mm beside it; a ball has no line."""
    base, arm = box(40, 40, 10) - cylinder(4, 10).at(0, 0, -5), cylinder(3.9, 30).at(0, 0, -5) + box(60, 12, 5)
    drawn = assembled(part("base", base), part("arm", arm, z=8), is_meshed=True)
    faces = axis_faces(faces_of(base.shape), []), axis_faces(faces_of(arm.shape), [])
    bodies = tuple(replace(body, axis_faces=of_body) for body, of_body in zip(drawn.bodies, faces, strict=True))
    assembly = replace(drawn, bodies=bodies)
    limit = {} if kind == "ball" else {"axis": (0.0, 0.0, 1.0), "limit": Limit(-0.5, 0.5)}
    at = np.array([beside, 0.0, 0.008])
    draft = draft_of_parts(assembly, {"base": at, "arm": at}, [ObservedJoint("j", kind, "base", "arm", **limit)])
    (joint,) = draft.joints
    of_faces = [fact for fact in joint.confidence.evidence if "faces" in fact]
    assert of_faces == (["its axis is that of faces of 'base', 'arm'"] if kind != "ball" and not beside else [])


def test_a_part_of_no_link_goes_to_the_nearest_of_links_that_are_fixed() -> None:
    """Of links on fixed joints, to the one whose centre of mass is nearest; one without mass has none."""
    post, clip = box(20, 20, 30), box(10, 10, 4)
    nodes = [part("slab", box(300, 40, 10)), part("left", post, x=-100, z=20), part("right", post, x=100, z=20)]
    assembly = assembled(*nodes, part("clip", clip, x=60, z=7), is_meshed=True)
    points = {"slab": (-0.15, 0, 0), "left": (-0.1, 0, 0.02), "bare": (0.06, 0, 0), "right": (0.1, 0, 0.02)}
    parents = {"left": "slab", "bare": "slab", "right": "bare"}  # a link without mass that carries another is a link
    joints = [ObservedJoint(f"to_{name}", "fixed", above, name) for name, above in parents.items()]
    found = link_of_parts(assembly, {name: np.array(point) for name, point in points.items()}, joints)
    assert found == {"slab": "slab", "left": "left", "right": "right", "clip": "right"}


@pytest.mark.parametrize("larger", ["front", "back"])
def test_a_part_of_no_link_moves_with_most_of_what_it_is_fastened_to(larger: str) -> None:
    """Where contacts join parts of two links, the one with more volume takes the others."""
    front, back = (60, 20) if larger == "front" else (20, 60)
    nodes = [
        part("front", box(front, 30, 20), x=-front / 2),
        part("back", box(back, 24, 14) - cylinder(3, 14).at(0, 0, -7), x=back / 2, z=3),
        part("clip", box(10, 10, 4), z=12),
    ]
    joint = ObservedJoint("turn", "revolute", "front", "back", axis=(0.0, 1.0, 0.0), limit=Limit(-1.0, 1.0))
    places = {name: np.array([0.0, 0.0, 0.01]) for name in ("front", "back")}
    found = link_of_parts(assembled(*nodes, is_meshed=True), places, [joint])
    assert found == {"front": "front", "back": "back", "clip": larger}
