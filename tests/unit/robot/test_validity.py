"""Physically impossible properties are reported once, with their code; valid robots pass without diagnostics."""

from math import cos, inf, nan, pi, sin

import numpy as np
import pytest
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.robot.model import (
    Actuator,
    ActuatorKind,
    Base,
    Box,
    Capsule,
    Collision,
    Cylinder,
    Frame,
    Geometry,
    Joint,
    JointKind,
    Limit,
    Link,
    LoopClosure,
    MeshAsset,
    MeshRef,
    Mimic,
    Robot,
    Sphere,
    Visual,
)
from stepbot.robot.validity import check_robot, inertia_fault
from tests.robots import ROBOTS

SOLID = MassProperties.of(1.0, (0, 0, 0), np.diag([1.0, 1.0, 1.0]))


def _codes(robot: Robot) -> list[str]:
    diagnostics = Diagnostics()
    check_robot(robot, diagnostics)
    return [diagnostic.code for diagnostic in diagnostics]


def _pair(joint: Joint | None = None, **changes: object) -> Robot:
    """Two links and the joint between them, with changes of the robot."""
    hinge = joint or Joint("j", JointKind.REVOLUTE, "a", "b", limit=Limit(-1, 1))
    return replace(Robot("pair", (Link("a", SOLID), Link("b", SOLID)), (hinge,)), **changes)  # type: ignore[arg-type]


def _hinge(**changes: object) -> Joint:
    return replace(Joint("j", JointKind.REVOLUTE, "a", "b", limit=Limit(-1, 1)), **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", list(ROBOTS))
def test_sound_robots_pass(name: str) -> None:
    """The robots of other tests are valid."""
    assert _codes(ROBOTS[name]()) == []


def _mesh(size: float) -> MeshAsset:
    return MeshAsset("m", TriMesh.of(size * np.eye(4, 3), [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]))


SEEN = Link("a", SOLID, (Visual("v", MeshRef("m")),))

BROKEN: dict[str, tuple[str, Robot]] = {
    "two links of one name": ("SB135", _pair(links=(Link("a", SOLID), Link("b", SOLID), Link("b", SOLID)))),
    "frame named like a link": ("SB135", _pair(frames=(Frame("b", "a"),))),
    "closure named like a joint": (
        "SB135",
        _pair(closures=(LoopClosure("j", JointKind.REVOLUTE, "a", Pose(), "b", Pose()),)),
    ),
    "two drives of one name": (
        "SB135",
        _pair(actuators=(Actuator("m", "j", ActuatorKind.MOTOR), Actuator("m", "j", ActuatorKind.MOTOR))),
    ),
    "two visuals of one name": ("SB135", _pair(links=(SEEN, replace(SEEN, name="b")), meshes=(_mesh(0.1),))),
    "no such link": ("SB417", _pair(_hinge(child="c"))),
    "no such leader": ("SB417", _pair(_hinge(mimic=Mimic("k")))),
    "no such mesh": ("SB417", _pair(links=(SEEN, Link("b", SOLID)))),
    "no such link of a frame": ("SB417", _pair(frames=(Frame("f", "c"),))),
    "no such link of a closure": (
        "SB417",
        _pair(closures=(LoopClosure("c", JointKind.REVOLUTE, "a", Pose(), "x", Pose()),)),
    ),
    "no such joint of a drive": ("SB417", _pair(actuators=(Actuator("m", "k", ActuatorKind.MOTOR),))),
    "infinite mass": ("SB414", _pair(links=(Link("a", SOLID), Link("b", replace(SOLID, mass=inf))))),
    "pose that is not a number": ("SB414", _pair(_hinge(X_PC=Pose(position=(nan, 0, 0))))),
    "mass that single precision cannot hold": (
        "SB414",
        _pair(links=(Link("a", SOLID), Link("b", replace(SOLID, mass=1e39)))),
    ),
    "centre of mass among the stars": (
        "SB414",
        _pair(links=(Link("a", SOLID), Link("b", replace(SOLID, com=(0.0, 1e12, 0.0))))),
    ),
    "vertex that single precision cannot hold": ("SB414", _pair(links=(SEEN, Link("b", SOLID)), meshes=(_mesh(1e39),))),
    "effort that single precision cannot hold": ("SB414", _pair(_hinge(limit=Limit(-1, 1, 1, 1e100)))),
    "limit that is not a number": ("SB414", _pair(_hinge(limit=Limit(nan, 1)))),
    "axis of length two": ("SB415", _pair(_hinge(axis=(0, 0, 2)))),
    "rotation that stretches": ("SB415", _pair(_hinge(X_PC=Pose(((2, 0, 0), (0, 1, 0), (0, 0, 0.5)))))),
    "rotation that mirrors": ("SB415", _pair(_hinge(X_PC=Pose(((-1, 0, 0), (0, 1, 0), (0, 0, 1)))))),
    "two parents": ("SB450", _pair(joints=(_hinge(), _hinge(name="k")))),
    "link without joint": ("SB450", _pair(joints=())),
    "circle": (
        "SB450",
        Robot(
            "ring",
            (Link("a", SOLID), Link("b", SOLID), Link("c", SOLID)),
            (_hinge(name="k", parent="c", child="b"), _hinge(name="l", parent="b", child="c")),
        ),
    ),
    "root that is moved": ("SB450", _pair(_hinge(parent="b", child="a"))),
    "no links": ("SB450", Robot("nothing", ())),
    "mimic of itself": ("SB458", _pair(_hinge(mimic=Mimic("j")))),
    "swapped limits": ("SB456", _pair(_hinge(limit=Limit(1, -1)))),
    "equal limits": ("SB456", _pair(_hinge(limit=Limit(0, 0)))),
    "negative effort": ("SB456", _pair(_hinge(limit=Limit(-1, 1, effort=-1)))),
    "drawn outside": ("SB457", _pair(_hinge(drawn_position=1.1))),
    "moving link without mass": ("SB508", _pair(links=(Link("a", SOLID), Link("b")))),
    "floating without mass": (
        "SB508",
        _pair(_hinge(kind=JointKind.FIXED), links=(Link("a"), Link("b")), base=Base.FLOATING),
    ),
    "negative inertia": (
        "SB509",
        _pair(links=(Link("a", SOLID), Link("b", MassProperties.of(1, (0, 0, 0), np.diag([1, 1, -1]))))),
    ),
    "no triangle": (
        "SB509",
        _pair(links=(Link("a", SOLID), Link("b", MassProperties.of(1, (0, 0, 0), np.diag([1, 1, 2.1]))))),
    ),
    "mass without inertia": ("SB509", _pair(links=(Link("a", SOLID), Link("b", MassProperties(1.0))))),
    "dust": ("SB510", _pair(links=(Link("a", SOLID.scaled(1e-4)), Link("b", SOLID.scaled(1e-4))))),
    "nothing weighs": ("SB510", Robot("stand", (Link("a"),))),
    "giant": ("SB420", _pair(links=(SEEN, Link("b", SOLID)), meshes=(_mesh(20.1),))),
    "open closure": (
        "SB411",
        _pair(closures=(LoopClosure("c", JointKind.REVOLUTE, "a", Pose(), "b", Pose(position=(2e-6, 0, 0))),)),
    ),
    "slanting closure": (
        "SB411",
        _pair(closures=(LoopClosure("c", JointKind.REVOLUTE, "a", Pose(), "b", Pose.from_xyz_rpy(rpy=(2e-3, 0, 0))),)),
    ),
    "closure closed at zero, not as drawn": (
        "SB411",
        _pair(
            _hinge(X_PC=Pose(position=(1, 0, 0)), drawn_position=0.5),
            closures=(
                LoopClosure("c", JointKind.REVOLUTE, "a", Pose(position=(2, 0, 0)), "b", Pose(position=(1, 0, 0))),
            ),
        ),
    ),
}


@pytest.mark.parametrize("fault", list(BROKEN))
def test_each_fault_has_its_code(fault: str) -> None:
    """One error has its own code, and no other."""
    code, robot = BROKEN[fault]
    assert set(_codes(robot)) == {code}


@pytest.mark.parametrize("fault", [fault for fault, (code, _) in BROKEN.items() if code == "SB414"])
def test_numbers_that_no_engine_takes_have_a_remedy(fault: str) -> None:
    """Numbers of a source, such as a density in a STEP file, are the user's to correct."""
    diagnostics = Diagnostics()
    check_robot(BROKEN[fault][1], diagnostics)
    assert all(one.help for one in diagnostics)


@pytest.mark.parametrize(("fault", "size"), [("dust", "mass of 0.2 g"), ("giant", "size of 20.1 m")])
def test_a_doubtful_unit_is_named(fault: str, size: str) -> None:
    """For a robot that is far too large or too light the warning names the unit of its file."""
    diagnostics = Diagnostics()
    check_robot(replace(BROKEN[fault][1], source="arm.step"), diagnostics, unit="inch")
    (warning,) = diagnostics
    assert warning.severity == "warning"
    assert warning.message.endswith(f"{size}; check the length unit of arm.step (inch)")
    assert warning.help == ("if it was drawn in another unit, export it again with that unit",)


def test_a_giant_in_metres_may_be_drawn_in_millimetres() -> None:
    """The remedy gives the size in millimetres; the place is that of the STEP file's name."""
    diagnostics, place = Diagnostics(), Span("arm.robot.yaml", 3, 7)
    check_robot(BROKEN["giant"][1], diagnostics, unit="m", places=lambda: {"step": place})
    (warning,) = diagnostics
    assert warning.span == place
    assert warning.help == ("if it was drawn in mm, it is 0.0201 m large: export it again with that unit",)


def test_no_mass_is_reported_once() -> None:
    """Where a moving link without mass is an error, that is no further doubt; descriptions may have none."""
    assert set(_codes(_pair(links=(Link("a"), Link("b"))))) == {"SB508"}
    diagnostics = Diagnostics()
    check_robot(Robot("stand", (Link("a"),)), diagnostics, massless_between=True)
    assert not list(diagnostics)


def test_a_size_due_to_collision_shapes_is_no_doubt_of_the_unit() -> None:
    """The links are named whose shapes are large, and the first is the place of the warning."""
    huge = Link("b", SOLID, collisions=(Collision("c", Box((25.0, 1.0, 1.0))),))
    robot = _pair(links=(replace(SEEN, collisions=(Collision("s", Box((0.5, 0.5, 0.5))),)), huge), meshes=(_mesh(0.3),))
    diagnostics, place = Diagnostics(), Span("arm.robot.yaml", 4, 5)
    check_robot(robot, diagnostics, unit="mm", places=lambda: {"link 'b': collision": place})
    (warning,) = diagnostics
    assert (warning.code, warning.span) == ("SB420", place)
    assert warning.message == "robot 'pair': size of 25 m, 0.3 m without the collision shapes of 'b'"


@pytest.mark.parametrize(
    ("geometry", "size"),
    [
        (Sphere(12.0), (24.0, 24.0, 24.0)),
        (Cylinder(1.0, 22.0), (2.0, 2.0, 22.0)),
        (Cylinder(11.0, 2.0), (22.0, 22.0, 2.0)),
        (Capsule(2.0, 19.0), (4.0, 4.0, 23.0)),
        (Box((3.0, 21.0, 4.0)), (3.0, 21.0, 4.0)),
    ],
    ids=lambda one: type(one).__name__,
)
def test_size_of_primitive_shapes(geometry: Geometry, size: tuple[float, float, float]) -> None:
    """A robot of one shape, turned by 30 degrees, is as large as the closed form of its box."""
    turned = Pose.from_xyz_rpy((1.0, 2.0, 3.0), (pi / 6, 0.0, 0.0))
    robot = Robot("one", (Link("a", SOLID, collisions=(Collision("c", geometry, turned),)),))
    diagnostics = Diagnostics()
    check_robot(robot, diagnostics)
    (x, y, z), c, s = size, cos(pi / 6), sin(pi / 6)
    largest = max(x, c * y + s * z, s * y + c * z)
    (warning,) = (one for one in diagnostics if one.code == "SB420")
    assert f"size of {largest:.3g} m" in warning.message


@pytest.mark.parametrize(("size", "mass", "codes"), [(20.0, 1e-3, set()), (20.1, 0.99e-3, {"SB420", "SB510"})])
def test_limits_of_size_and_mass(size: float, mass: float, codes: set[str]) -> None:
    """Robots up to 20 m and from 1 g are no doubt of the unit."""
    link = Link("a", SOLID.scaled(mass), collisions=(Collision("c", Box((size, 1.0, 1.0))),))
    assert set(_codes(Robot("one", (link,)))) & {"SB420", "SB510"} == codes


def test_faults_are_reported_where_their_element_is_described() -> None:
    """An impossible inertia at the `inertial`, limits at the joint, else the source as a whole."""
    diagnostics = Diagnostics()
    robot = _pair(_hinge(limit=Limit(1, -1)), links=(Link("a", SOLID), Link("b", MassProperties(1.0))))
    places = {"link 'b': inertial": Span("arm.robot.yaml", 7, 3), "joint 'j'": Span("arm.robot.yaml", 9, 3)}
    check_robot(robot, diagnostics, Span("arm.robot.yaml"), places=lambda: places)
    assert [(d.code, d.span.line) for d in diagnostics] == [("SB456", 9), ("SB509", 7)]


SOUND: dict[str, Robot] = {
    "plain": _pair(),
    "joint named like its link": _pair(_hinge(name="b")),
    "thin plate": _pair(links=(Link("a", SOLID), Link("b", MassProperties.of(1, (0, 0, 0), np.diag([1, 1, 2]))))),
    "one-sided limits": _pair(_hinge(limit=Limit(-inf, 1))),
    "massless and fixed": _pair(_hinge(kind=JointKind.FIXED), links=(Link("a", SOLID), Link("b"))),
    "massless base that is fixed": _pair(links=(Link("a"), Link("b", SOLID))),
    "massless, moved together with mass": Robot(
        "three", (Link("a", SOLID), Link("b"), Link("c", SOLID)), (_hinge(), Joint("k", JointKind.FIXED, "b", "c"))
    ),
    "twenty metres": _pair(links=(SEEN, Link("b", SOLID)), meshes=(_mesh(19.9),)),
    "closure along the axis": _pair(
        closures=(LoopClosure("c", JointKind.REVOLUTE, "a", Pose(), "b", Pose.from_xyz_rpy(rpy=(0, 0, 1))),)
    ),
}


@pytest.mark.parametrize("case", list(SOUND))
def test_what_is_allowed(case: str) -> None:
    """Values just within the limits are accepted."""
    assert _codes(SOUND[case]) == []


def test_all_faults_at_once() -> None:
    """Independent errors are reported together, at the given place."""
    diagnostics = Diagnostics()
    span = Span("arm.robot.yaml", 3, 1)
    robot = _pair(
        _hinge(limit=Limit(1, -1)), links=(Link("a", SOLID), Link("b", MassProperties(1.0))), base=Base.FLOATING
    )
    check_robot(robot, diagnostics, span)
    assert [d.code for d in diagnostics] == ["SB456", "SB509"]
    assert {d.span for d in diagnostics} == {span}


@pytest.mark.parametrize(
    ("moments", "sound"),
    [((1, 1, 1), True), ((1, 2, 3), True), ((1, 2, 3.1), False), ((0, 1, 1), False), ((-1, 2, 2), False)],
)
def test_triangle_inequality(moments: tuple[float, float, float], sound: bool) -> None:
    """No principal moment of a body exceeds the sum of the others, for any axes of the tensor."""
    R = Pose.from_xyz_rpy(rpy=(0.3, 0.2, 1)).R
    assert (inertia_fault(MassProperties.of(1.0, (0, 0, 0), R @ np.diag(moments) @ R.T)) == "") is sound


@pytest.mark.parametrize("number", [nan, inf, 1.1e30, 1e200, 1e308])
def test_inertias_that_eigenvalues_do_not_exist_of(number: float) -> None:
    """LAPACK ends without a result for some of them."""
    faulty = MassProperties(1.0, (0.0, 0.0, 0.0), ((number, 0.0, 0.0), (0.0, number, 0.0), (0.0, 0.0, 1.0)))
    assert inertia_fault(faulty) == "its inertia is not finite, or larger than 1e+30 kg m^2"
