"""The comparison: what it detects, what it tolerates, and that missing values never count as agreement."""

import math
from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.engine import Tolerance
from stepbot.engines.observation import Dynamics, Observation, ObservedJoint, Quantity, Request
from stepbot.engines.reference import observe_robot
from stepbot.engines.workers import Fate, Outcome
from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO33, Pose, rotation_about, vector3
from stepbot.report.robot import Status
from stepbot.robot.closures import loop_ways
from stepbot.robot.kinematics import configurations, initial_configuration
from stepbot.robot.model import ActuatorKind, Base, Joint, JointDynamics, JointKind, Limit, Link, Mimic, Robot
from stepbot.verification.compare import compare
from stepbot.verification.deviation import TOLERANCES, Deviations, tolerance
from stepbot.verification.judging import Subject, check_of, checks_without_observation, report_failure
from stepbot.verification.merged_observation import gather
from stepbot.verification.normalized import normalized
from tests.conftest import ReadDiagnostics
from tests.recorded.verdicts import changed
from tests.robots import ROBOTS, four_bar, gripper_with_mimic, primitives, two_link_arm

Change = Callable[[Observation], Observation]


def seen(robot: Robot, engine: str = "engine") -> Observation:
    """The expected observation, as if reported by an engine."""
    request = Request(
        "file", "mjcf", configurations(robot, n=3), initial_configuration(robot), ways=loop_ways(robot, n=4)
    )
    return replace(observe_robot(robot, request), engine=engine, simulation_finite=True)


def statuses(reference: Observation, observed: Observation) -> dict[Quantity, Status]:
    """The status of every quantity."""
    subject = Subject("file", "mjcf", observed.engine)
    return {one.quantity: check_of(subject, one).status for one in compare(reference, observed)}


def failed(reference: Observation, observed: Observation) -> set[Quantity]:
    """The quantities that fail."""
    return {quantity for quantity, status in statuses(reference, observed).items() if status is Status.FAILED}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_is_itself(name: str) -> None:
    """A robot compared with itself passes in all its quantities, with deviation 0."""
    observation = seen(ROBOTS[name]())
    assert set(statuses(observation, observation).values()) == {Status.PASSED}
    assert all(one.deviations.worst.ratio == 0.0 for one in compare(observation, observation) if one.deviations.worst)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["equipped", "gripper_with_mimic", "screw", "slider_crank", "universal"])
def test_what_one_side_does_not_report_is_no_difference(name: str) -> None:
    """Each value that may be missing, on either side; but no mimic, loop's axes or gain makes another robot."""
    whole = seen(ROBOTS[name]())
    for at, less in changed(whole):
        if at.endswith(" gone"):
            allowed = {_MISSING[word] for word in _MISSING if f".{word} gone" in at}
            assert failed(whole, less) | failed(less, whole) <= allowed, at


_MISSING = {"mimic": Quantity.MIMIC, "axes": Quantity.CLOSURES, "kp": Quantity.ACTUATORS, "kv": Quantity.ACTUATORS}
"""What counts as absent from the robot where it is missing, and by which quantity."""


def test_a_stand_in_for_a_missing_inertia_is_no_other_mass_matrix() -> None:
    """MJCF gives moving links without mass 1e-14 kg m^2, which is more than the tolerance of a very light robot."""
    arm = two_link_arm()
    body = arm.links[-1].mass_properties
    tiny = replace(arm, links=tuple(replace(link, mass_properties=body.scaled(1e-9)) for link in arm.links))
    ours = seen(tiny)
    massless = replace(ours, links=(*ours.links[:-1], replace(ours.links[-1], mass=0.0)))

    def off(amount: float) -> tuple[Dynamics, ...]:
        return tuple(replace(one, mass_matrix=np.array(one.mass_matrix) + amount) for one in ours.dynamics)

    assert statuses(massless, replace(massless, dynamics=off(1e-14)))[Quantity.MASS_MATRIX] is Status.PASSED
    assert statuses(massless, replace(massless, dynamics=off(1.5e-14)))[Quantity.MASS_MATRIX] is Status.FAILED
    assert statuses(ours, replace(ours, dynamics=off(1e-14)))[Quantity.MASS_MATRIX] is Status.FAILED


@pytest.mark.parametrize("side", ["X_AF", "X_BF"])
def test_a_turned_frame_of_a_closure_is_another_one(side: str) -> None:
    """Its place alone is not enough: the axis of the pin is in the frame."""
    ours = seen(four_bar())
    (closure,) = ours.closures or ()
    X = getattr(closure, side)
    turned = replace(closure, **{side: X @ Pose.of(rotation_about((1.0, 0.0, 0.0), 2e-9), (0.0, 0.0, 0.0))})
    assert failed(ours, replace(ours, closures=(turned,))) == {Quantity.CLOSURES}


def on_link(name: str, **changes: object) -> Change:
    """The observation with one link changed."""

    def change(observation: Observation) -> Observation:
        links = (replace(link, **changes) if link.name == name else link for link in observation.links)  # type: ignore[arg-type]
        return replace(observation, links=tuple(links))

    return change


def on_joint(name: str, edit: Callable[[ObservedJoint], ObservedJoint]) -> Change:
    """The observation with one joint changed."""

    def change(observation: Observation) -> Observation:
        joints = (edit(joint) if joint.name == name else joint for joint in observation.joints)
        return replace(observation, joints=tuple(joints))

    return change


def _limit(joint: ObservedJoint, **changes: float) -> ObservedJoint:
    return replace(joint, limit=replace(joint.limit or Limit(), **changes))


def _dynamics(joint: ObservedJoint, **changes: float) -> ObservedJoint:
    return replace(joint, dynamics=replace(joint.dynamics or JointDynamics(), **changes))


def _pose_off(off: Pose) -> Change:
    """The last observed pose of the forearm, moved."""

    def change(observation: Observation) -> Observation:
        *first, last = observation.poses
        return replace(observation, poses=(*first, {**last, "forearm": last["forearm"] @ off}))

    return change


def _dynamics_off(index: int, **factors: float) -> Change:
    """The equations of motion at one configuration, scaled."""

    def change(observation: Observation) -> Observation:
        dynamics = list(observation.dynamics)
        one = dynamics[index]
        scaled = {name: np.array(getattr(one, name)) * factor for name, factor in factors.items()}
        dynamics[index] = replace(one, **scaled)
        return replace(observation, dynamics=tuple(dynamics))

    return change


ARM = seen(two_link_arm())
MASS = ARM.links[1].mass or 0.0
COM = np.array(ARM.links[1].com)
INERTIA = np.array(ARM.links[1].inertia)
TILTED = rotation_about((1, 0, 0), 2e-9)

DIFFERENCES: dict[str, tuple[Change, set[Quantity]]] = {
    "a link less": (lambda o: replace(o, links=o.links[:-1]), {Quantity.LINKS}),
    "a link more": (lambda o: replace(o, links=(*o.links, replace(o.links[0], name="more"))), {Quantity.LINKS}),
    "a link twice": (lambda o: replace(o, links=(*o.links, o.links[0])), {Quantity.LINKS}),
    "a joint less": (lambda o: replace(o, joints=o.joints[:-1]), {Quantity.JOINTS}),
    "another name": (on_joint("elbow", lambda j: replace(j, name="ellbow")), {Quantity.JOINTS}),
    "another kind": (on_joint("elbow", lambda j: replace(j, kind="prismatic")), {Quantity.JOINTS}),
    "another parent": (on_joint("elbow", lambda j: replace(j, parent="base")), {Quantity.JOINTS}),
    "another base": (lambda o: replace(o, base="floating"), {Quantity.JOINTS}),
    "axis turned": (
        on_joint("shoulder", lambda j: replace(j, axis=tuple((TILTED @ np.array(j.axis)).tolist()))),
        {Quantity.AXES},
    ),
    "axis reversed": (on_joint("shoulder", lambda j: replace(j, axis=(0.0, 0.0, -1.0))), {Quantity.AXES}),
    "axis without length": (on_joint("shoulder", lambda j: replace(j, axis=(0.0, 0.0, 0.0))), {Quantity.AXES}),
    "lower limit": (on_joint("elbow", lambda j: _limit(j, lower=-2.0 + 1e-8)), {Quantity.LIMITS}),
    "limits lost": (
        on_joint("elbow", lambda j: replace(j, limit=Limit())),
        {Quantity.LIMITS, Quantity.JOINTS},  # a revolute joint without limits counts as continuous
    ),
    "effort": (on_joint("elbow", lambda j: _limit(j, effort=8.1)), {Quantity.LIMITS}),
    "velocity not a number": (on_joint("elbow", lambda j: _limit(j, velocity=math.nan)), {Quantity.LIMITS}),
    "damping": (on_joint("elbow", lambda j: _dynamics(j, damping=0.0)), {Quantity.DYNAMICS}),
    "armature": (on_joint("shoulder", lambda j: _dynamics(j, armature=0.0)), {Quantity.DYNAMICS}),
    "mimic": (on_joint("elbow", lambda j: replace(j, mimic=Mimic("shoulder"))), {Quantity.MIMIC}),
    "mass": (on_link("upper_arm", mass=MASS * (1 + 2e-9)), {Quantity.MASS}),
    "mass not a number": (on_link("upper_arm", mass=math.nan), {Quantity.MASS}),
    "com": (on_link("upper_arm", com=tuple((COM + np.array([0, 0, 1e-9])).tolist())), {Quantity.COM}),
    "inertia": (
        on_link("upper_arm", inertia=tuple(map(tuple, (INERTIA + 2e-9 * INERTIA.max() * np.eye(3)).tolist()))),
        {Quantity.INERTIA},
    ),
    "inertia off the diagonal": (
        on_link("upper_arm", inertia=tuple(map(tuple, (INERTIA * (2 * np.eye(3) - 1)).tolist()))),
        {Quantity.INERTIA},
    ),
    "pose shifted": (_pose_off(Pose.of(position=(0, 2e-9, 0))), {Quantity.POSES}),
    "pose turned": (_pose_off(Pose.of(TILTED)), {Quantity.POSES}),
    "a pose less": (lambda o: replace(o, poses=o.poses[:-1]), {Quantity.POSES}),
    "mass matrix": (_dynamics_off(2, mass_matrix=1 + 2e-9), {Quantity.MASS_MATRIX}),
    "gravity reversed": (_dynamics_off(0, gravity=-1.0), {Quantity.GRAVITY}),
    "a coordinate less": (
        lambda o: replace(o, coordinates=("shoulder",)),
        {Quantity.MASS_MATRIX, Quantity.GRAVITY, Quantity.INVERSE_DYNAMICS},
    ),
    "efforts of a motion": (_dynamics_off(1, inverse=1 + 1e-6), {Quantity.INVERSE_DYNAMICS}),
    "box moved": (on_link("base", visual_bounds=((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0))), {Quantity.MESHES}),
    "nothing to touch": (on_link("base", has_collisions=False, collision_bounds=None), {Quantity.MESHES}),
    "mesh missing": (lambda o: replace(o, missing_meshes=("base.obj",)), {Quantity.MESHES}),
    "frame missing": (lambda o: replace(o, frames={"camera": (o.frames or {})["camera"]}), {Quantity.FRAMES}),
    "frame more": (lambda o: replace(o, frames={**(o.frames or {}), "more": ("base", Pose())}), {Quantity.FRAMES}),
    "frame elsewhere": (
        lambda o: replace(o, frames={**(o.frames or {}), "camera": ("base", Pose())}),
        {Quantity.FRAMES},
    ),
    "actuator missing": (lambda o: replace(o, actuators=(o.actuators or ())[:1]), {Quantity.ACTUATORS}),
    "actuator of another kind": (
        lambda o: replace(o, actuators=tuple(replace(a, kind=ActuatorKind.VELOCITY) for a in o.actuators or ())),
        {Quantity.ACTUATORS},
    ),
    "gain": (
        lambda o: replace(o, actuators=tuple(replace(a, kp=99.0) for a in o.actuators or ())),
        {Quantity.ACTUATORS},
    ),
    "initial pose": (lambda o: replace(o, initial={"shoulder": 0.0, "elbow": 0.0}), {Quantity.INITIAL}),
    "flies apart": (lambda o: replace(o, simulation_finite=False), {Quantity.SIMULATION}),
    "warning": (lambda o: replace(o, warnings=("no inertia",)), {Quantity.WARNINGS}),
}


@pytest.mark.parametrize("name", DIFFERENCES)
def test_a_difference_fails_its_quantity_and_no_other(name: str) -> None:
    """A difference just beyond the tolerance fails its quantity, and no other."""
    change, quantities = DIFFERENCES[name]
    assert failed(ARM, change(ARM)) == quantities


@pytest.mark.parametrize(
    "change",
    [
        on_link("upper_arm", mass=MASS * (1 + 5e-10)),
        on_link("upper_arm", com=tuple((COM + np.array([0, 0, 5e-11])).tolist())),
        on_joint("elbow", lambda j: _limit(j, lower=-2.0 + 5e-10)),
        _pose_off(Pose.of(position=(0, 5e-10, 0))),
        _dynamics_off(2, mass_matrix=1 + 5e-10),
    ],
)
def test_just_within_the_tolerance_passes(change: Change) -> None:
    """A difference just within the tolerance of 1e-9 passes, absolute or relative as in the table."""
    assert failed(ARM, change(ARM)) == set()


SILENCES: dict[str, tuple[Change, Quantity]] = {
    "mass": (lambda o: replace(o, links=tuple(replace(link, mass=None) for link in o.links)), Quantity.MASS),
    "com": (lambda o: replace(o, links=tuple(replace(link, com=None) for link in o.links)), Quantity.COM),
    "inertia": (lambda o: replace(o, links=tuple(replace(link, inertia=None) for link in o.links)), Quantity.INERTIA),
    "poses": (lambda o: replace(o, poses=()), Quantity.POSES),
    "mass matrix": (
        lambda o: replace(o, dynamics=tuple(Dynamics(None, one.gravity, one.inverse) for one in o.dynamics)),
        Quantity.MASS_MATRIX,
    ),
    "gravity": (
        lambda o: replace(o, dynamics=tuple(Dynamics(one.mass_matrix, None, one.inverse) for one in o.dynamics)),
        Quantity.GRAVITY,
    ),
    "limits": (lambda o: replace(o, joints=tuple(replace(j, limit=None) for j in o.joints)), Quantity.LIMITS),
    "dynamics": (lambda o: replace(o, joints=tuple(replace(j, dynamics=None) for j in o.joints)), Quantity.DYNAMICS),
    "axes": (lambda o: replace(o, joints=tuple(replace(j, axis=None) for j in o.joints)), Quantity.AXES),
    "frames": (lambda o: replace(o, frames=None), Quantity.FRAMES),
    "actuators": (lambda o: replace(o, actuators=None), Quantity.ACTUATORS),
    "simulation": (lambda o: replace(o, simulation_finite=None), Quantity.SIMULATION),
    "meshes": (
        lambda o: replace(
            o,
            links=tuple(
                replace(
                    link,
                    visual_bounds=None,
                    collision_bounds=None,
                    has_visuals=None,
                    has_collisions=None,
                    visuals=None,
                    collisions=None,
                )
                for link in o.links
            ),
        ),
        Quantity.MESHES,
    ),
}


@pytest.mark.parametrize("name", SILENCES)
def test_a_missing_value_is_not_run(name: str) -> None:
    """A missing value is not run, with a reason."""
    change, quantity = SILENCES[name]
    results = {one.quantity: one for one in compare(ARM, change(ARM))}
    check = check_of(Subject("file", "mjcf", "engine"), results[quantity])
    assert check.status is Status.NOT_RUN
    assert check.why == "engine does not report it"
    assert check.deviation is None


def test_a_quantity_with_a_reason_is_not_run_even_if_reported() -> None:
    """A quantity that an engine is known to get wrong is not run, even if reported."""
    silent = replace(ARM, not_run={Quantity.MASS: "it lies"})
    results = {one.quantity: one for one in compare(ARM, on_link("base", mass=0.0)(silent))}
    assert results[Quantity.MASS].not_run == "it lies"
    assert check_of(Subject("f", "mjcf", "e"), results[Quantity.MASS]).status is Status.NOT_RUN


def test_a_pitch_that_an_engine_lacks_is_not_compared() -> None:
    """The pitch of a screw is part of its axis, for engines that report it."""
    elbow = on_joint("elbow", lambda j: replace(j, kind="screw", pitch=0.002))(ARM)
    expected = {None: set(), 0.002: set(), 0.0021: {Quantity.AXES}}
    for pitch, fails in expected.items():
        assert failed(elbow, on_joint("elbow", lambda j, p=pitch: replace(j, pitch=p))(elbow)) == fails


def test_boxes_are_as_exact_as_the_engine() -> None:
    """PyBullet's collision boxes are exact to a share of their diagonal, MuJoCo's to a micrometre."""
    arm = next(link for link in ARM.links if link.name == "upper_arm")
    assert arm.collision_bounds is not None
    low, high = map(np.array, arm.collision_bounds)
    off = 1e-4 * float(np.linalg.norm(high - low))
    assert off > 1e-6
    larger = on_link("upper_arm", collision_bounds=(vector3(low), vector3(high + np.array([off, 0.0, 0.0]))))(ARM)
    assert failed(ARM, replace(larger, engine="pybullet")) == set()
    assert failed(ARM, replace(larger, engine="mujoco")) == {Quantity.MESHES}


def test_an_engine_fills_the_gaps_of_one_that_reports_more() -> None:
    """What the first engine does not report comes from the next one that does, and is named after it."""
    first = replace(ARM, engine="mujoco", frames=None, initial=None, not_run={Quantity.FRAMES: "not in a URDF"})
    second = replace(on_link("upper_arm", mass=7.0)(ARM), engine="pybullet", actuators=None, initial=None)
    whole = gather([Outcome("file", "urdf", one.engine, Fate.OBSERVED, one) for one in (first, second)])
    both = whole.observation
    assert (both.frames, both.actuators, both.links, both.not_run) == (ARM.frames, ARM.actuators, ARM.links, {})
    engines = [whole.engine(one) for one in (Quantity.FRAMES, Quantity.ACTUATORS, Quantity.MASS, Quantity.INITIAL)]
    assert engines == ["pybullet", "mujoco", "mujoco", "mujoco"]


def test_missing_fields_are_named() -> None:
    """A check that covers only part of its quantity names the missing fields."""
    observed = on_joint("elbow", lambda j: replace(j, limit_fields=("lower", "upper")))(ARM)
    results = {one.quantity: one for one in compare(ARM, observed)}
    check = check_of(Subject("f", "mjcf", "e"), results[Quantity.LIMITS])
    assert check.status is Status.PASSED
    assert check.why == "not reported: velocity, effort"


def test_what_a_robot_does_not_have_is_left_out() -> None:
    """A robot without loops has no check of loops; an engine that reports one fails."""
    assert Quantity.CLOSURES not in statuses(ARM, ARM)
    assert Quantity.MIMIC not in statuses(ARM, ARM)
    assert Quantity.AXES not in statuses(seen(ROBOTS["one_link"]()), seen(ROBOTS["one_link"]()))
    loop = seen(four_bar()).closures
    assert failed(ARM, replace(ARM, closures=loop)) == {Quantity.CLOSURES}


def test_links_without_mass_have_no_centre() -> None:
    """The com of a massless link is not compared."""
    tree = seen(ROBOTS["tree"]())
    assert failed(tree, on_link("flange", com=(1.0, 2.0, 3.0))(tree)) == set()
    assert failed(tree, on_link("flange", mass=1e-12)(tree)) == {Quantity.MASS}


def test_mimics_differ_by_leader_and_numbers() -> None:
    """Another leader, multiplier or offset of a mimic is detected."""
    gripper = seen(gripper_with_mimic())
    for mimic in (None, Mimic("thumb_pivot"), Mimic("finger", 1.0 + 3e-9), Mimic("finger", 1.0, 2e-9)):
        observed = on_joint("finger_mirrored", lambda j, m=mimic: replace(j, mimic=m))(gripper)
        assert failed(gripper, observed) == {Quantity.MIMIC}


def _closure(**changes: object) -> set[Quantity]:
    loop = seen(four_bar())
    assert loop.closures is not None
    return failed(loop, replace(loop, closures=(replace(loop.closures[0], **changes),)))  # type: ignore[arg-type]


@pytest.mark.slow
def test_closures_differ_by_place_links_and_residual() -> None:
    """Another position, link or residual of a closure is detected."""
    loop = seen(four_bar())
    assert loop.closures is not None
    assert failed(loop, replace(loop, closures=())) == {Quantity.CLOSURES}
    assert _closure(residual=2e-9) == {Quantity.CLOSURES}
    assert _closure(residual=math.nan) == {Quantity.CLOSURES}
    assert _closure(angle_error=2e-9) == {Quantity.CLOSURES}
    assert _closure(link_a="crank") == {Quantity.CLOSURES}
    assert _closure(kind="ball") == {Quantity.CLOSURES}
    assert _closure(X_AF=Pose()) == {Quantity.CLOSURES}
    assert _closure(axis=(1.0, 0.0, 0.0)) == {Quantity.CLOSURES}
    assert _closure(points=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))) == {Quantity.CLOSURES}
    assert _closure(axes=((0.0, 0.0, 1.0), (0.0, 1e-6, 1.0))) == {Quantity.CLOSURES}
    assert _closure(axes=((0.0, 0.0, 1.0), (0.0, 0.0, 1.01))) == {Quantity.CLOSURES}
    assert _closure(axes=((0.0, 0.0, -2.0), (0.0, 0.0, -2.0))) == set()
    assert _closure(axes=None) == {Quantity.CLOSURES}
    assert _closure(residual=5e-10, angle_error=5e-10) == set()


def test_a_reversed_closure_is_the_same() -> None:
    """A reversed closure is the same, since in SDFormat the root is never a child."""
    loop = seen(four_bar())
    assert loop.closures is not None
    c = loop.closures[0]
    assert c.points is not None
    assert c.axes is not None
    ends = {"X_AF": c.X_BF, "X_BF": c.X_AF, "points": c.points[::-1], "axes": c.axes[::-1]}
    turned = replace(c, link_a=c.link_b, link_b=c.link_a, **ends)  # type: ignore[arg-type]
    assert failed(loop, replace(loop, closures=(turned,))) == set()


def test_planar_mechanisms_feel_no_gravity() -> None:
    """A rounding error beside an exact zero gravity force passes; a force fails."""
    loop = seen(four_bar())
    assert all(np.abs(one.gravity).max() == 0.0 for one in loop.dynamics if one.gravity is not None)

    def pushed(force: float) -> Observation:
        dynamics = tuple(Dynamics(one.mass_matrix, np.full(3, force)) for one in loop.dynamics)
        return replace(loop, dynamics=dynamics)

    assert failed(loop, pushed(1e-17)) == set()
    assert failed(loop, pushed(1e-6)) == {Quantity.GRAVITY}


def test_a_ball_about_the_origin_feels_no_gravity() -> None:
    """All of its links are there: what is round has the length of its radius of gyration, and a force fails."""
    inertia = ((4e-6, 0.0, 0.0), (0.0, 4e-6, 0.0), (0.0, 0.0, 4e-6))
    links = tuple(Link(name, MassProperties(0.3, inertia=inertia)) for name in ("socket", "ball"))
    neck = Joint("neck", JointKind.BALL, "socket", "ball", limit=Limit(velocity=4.0, effort=3.0))
    still = seen(Robot("rod_end", links, (neck,), base=Base.FIXED))

    def pushed(force: float) -> Observation:
        return replace(still, dynamics=tuple(replace(one, gravity=np.full(3, force)) for one in still.dynamics))

    assert failed(still, pushed(7e-21)) == set()
    assert failed(still, pushed(1e-7)) == {Quantity.GRAVITY}


@pytest.mark.parametrize(("far", "passes"), [(0.3, True), (0.3, False), (3.0, True)])
def test_single_precision_loses_digits_of_a_wheel_far_from_the_root(far: float, passes: bool) -> None:
    """A moment about an axis, computed by way of the root in single precision, passes; forty times its error fails."""
    wheel, mass, offset = 3e-4, np.float32(0.34), np.float32(0.02)
    true = wheel + float(mass) * float(offset) ** 2
    hinge = np.float32(far)
    about_root = np.float32(wheel) + mass * (hinge + offset) ** 2
    first = mass * (hinge + offset)
    back = about_root - np.float32(2.0) * hinge * first + mass * hinge**2
    assert isinstance(back, np.float32)
    error = abs(float(back) - true) * (1.0 if passes else 40.0)
    assert error > 0.0
    whole = float(mass) * (far + float(offset)) ** 2
    newton = Deviations(tolerance(("newton",), Quantity.MASS_MATRIX))
    newton.off(error, "mass matrix", "SI", true, whole=whole)
    assert (not newton.failures) is passes
    exact = Deviations(tolerance(("mujoco",), Quantity.MASS_MATRIX))
    exact.off(error, "mass matrix", "SI", true, whole=whole)
    assert exact.failures


def test_an_engine_has_its_own_tolerance() -> None:
    """PyBullet's inertia has a tolerance of 3e-6; between two engines the looser tolerance applies."""
    off = tuple(map(tuple, (INERTIA * (1 + 2e-6)).tolist()))
    assert failed(ARM, on_link("upper_arm", inertia=off)(replace(ARM, engine="pybullet"))) == set()
    assert failed(ARM, on_link("upper_arm", inertia=off)(replace(ARM, engine="mujoco"))) == {Quantity.INERTIA}
    assert tolerance(("mujoco", "pybullet"), Quantity.POSES) == Tolerance(absolute=1e-6)
    assert tolerance(("mujoco", "yourdfpy"), Quantity.POSES) == Tolerance(absolute=1e-9)


def test_rounding_of_a_point_mass_beside_its_frame_is_no_inertia() -> None:
    """Drake stores inertias about the link's frame, so that those of a point mass are 1e-16 of m r², and not 0."""
    point = on_link("upper_arm", mass=3.6e-6, com=(0.0, 0.0, -1.25e-4), inertia=ZERO33)(ARM)
    for off, wrong in ((6.9e-40, set()), (1e-28, {Quantity.INERTIA})):
        rounded = tuple(tuple(off if row == column == 2 else 0.0 for column in range(3)) for row in range(3))
        assert failed(point, on_link("upper_arm", inertia=rounded)(point)) == wrong


def test_every_quantity_has_a_tolerance() -> None:
    """Every quantity has a tolerance."""
    assert set(TOLERANCES) == set(Quantity)


def test_a_failure_is_one_diagnostic_with_the_worst_first(diagnostics: ReadDiagnostics) -> None:
    """A failure is one diagnostic: engine, quantity, place and the worst number; the rest are notes."""
    observed = replace(ARM, links=tuple(replace(link, mass=(link.mass or 0.0) + 1.0) for link in ARM.links))
    subject = Subject("arm.xml", "mjcf", "mujoco")
    for one in compare(ARM, observed):
        report_failure(subject, one, "SB812", diagnostics)
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB803"
    assert diagnostic.span.file == "arm.xml"
    assert diagnostic.message.startswith("mujoco: mass: mass of link 'forearm': 1 kg off, ")
    assert len(diagnostic.notes) == 2


def test_a_check_has_place_and_deviation() -> None:
    """A passed check has the place and value of its largest deviation."""
    observed = on_link("upper_arm", mass=MASS * (1 + 5e-10))(ARM)
    results = {one.quantity: one for one in compare(ARM, observed)}
    check = check_of(Subject("arm.xml", "mjcf", "mujoco"), results[Quantity.MASS])
    assert check.status is Status.PASSED
    assert check.where == "mass of link 'upper_arm'"
    assert check.deviation == pytest.approx(MASS * 5e-10, rel=1e-3)
    assert check.tolerance == pytest.approx(MASS * 1e-9)


@pytest.mark.parametrize(
    ("fate", "load", "code"),
    [
        (Fate.ABSENT, Status.NOT_RUN, None),
        (Fate.UNREADABLE, Status.NOT_RUN, None),
        (Fate.REFUSED, Status.FAILED, "SB801"),
        (Fate.DIED, Status.FAILED, "SB802"),
        (Fate.BROKEN, Status.FAILED, "SB901"),
    ],
)
def test_a_file_without_an_observation(
    fate: Fate, load: Status, code: str | None, diagnostics: ReadDiagnostics
) -> None:
    """Without an observation the load check fails if the engine rejected the file or died; others are not run."""
    outcome = Outcome("arm.xml", "mjcf", "mujoco", fate, reason="because\nof that", last_lines=("last words",))
    quantities = (Quantity.LOAD, Quantity.MASS)
    first, second = checks_without_observation(Subject("arm.xml", "mjcf", "mujoco"), outcome, quantities, diagnostics)
    assert first.status is load
    assert second.status is Status.NOT_RUN
    assert diagnostics.codes() == ([code] if code else [])
    for diagnostic in diagnostics:
        assert diagnostic.message == "mujoco: because"
        assert diagnostic.notes == ("of that", "last words")


def test_a_number_beside_zero_tolerance_fails() -> None:
    """With a tolerance of zero any deviation fails, and zero passes."""
    deviations = Deviations(Tolerance(relative=1e-9))
    deviations.near(0.0, 0.0, "nothing", "kg")
    assert not deviations.failures
    deviations.near(1e-300, 0.0, "something", "kg")
    assert [str(failure) for failure in deviations.failures] == ["something: 1e-300 kg off, 0 allowed"]
    assert deviations.worst is deviations.failures[0]


def test_infinite_limits_are_equal() -> None:
    """Two infinite limits are equal; one is not."""
    deviations = Deviations(Tolerance(1e-9))
    deviations.near(math.inf, math.inf, "limit", "rad")
    assert not deviations.failures
    deviations.near(math.inf, 3.0, "limit", "rad")
    assert len(deviations.failures) == 1


def test_bare_links_are_frames() -> None:
    """In URDF a massless link without shapes on a fixed joint is a frame."""
    robot = two_link_arm()
    frames = {frame.name: frame for frame in robot.frames}
    tip = frames["tool0"]
    observation = seen(robot)
    as_link = replace(
        observation,
        frames=None,
        links=(
            *observation.links,
            replace(observation.links[0], name="tool0", mass=0.0, has_visuals=False, has_collisions=False),
        ),
        joints=(*observation.joints, ObservedJoint("mount", "fixed", tip.link, "tool0")),
        poses=tuple({**poses, "tool0": poses[tip.link] @ tip.X_LF} for poses in observation.poses),
    )
    ours, theirs = normalized(observation, as_link)
    assert list(theirs.frames or {}) == ["tool0"]
    assert failed(ours, theirs) == set()
    assert [link.name for link in normalized(as_link, as_link)[0].links][-1] == "tool0"


def test_a_link_called_world_is_the_world() -> None:
    """A massless root link named world, common in URDF, is the world."""
    observation = seen(primitives())
    off = Pose.from_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3))
    world = replace(observation.links[0], name="world", mass=0.0, has_visuals=False, has_collisions=False)
    as_link = replace(
        observation,
        base=None,
        links=(world, *observation.links),
        joints=(ObservedJoint("anchor", "fixed", "world", "base"), *observation.joints),
        poses=tuple({"world": Pose(), **{n: off @ X for n, X in poses.items()}} for poses in observation.poses),
    )
    ours, theirs = normalized(observation, as_link)
    assert failed(ours, theirs) == set()
    assert theirs.base == "fixed"


def test_mimics_are_compared_with_the_joint_that_leads() -> None:
    """A mimic of a mimic equals its resolved relation to the first joint."""
    gripper = seen(gripper_with_mimic())
    direct = on_joint("thumb_pivot", lambda j: replace(j, mimic=Mimic("finger", -100 / 7, 0.1)))(gripper)
    assert failed(gripper, direct) == {Quantity.MIMIC}
    assert failed(*normalized(gripper, direct)) == set()


@pytest.mark.parametrize("name", ["{0}", "{x}", "{", "a}", "%s"])
def test_names_with_braces_are_names(name: str) -> None:
    """Names of a file are no templates of messages."""
    robot = two_link_arm()
    link, *others = robot.links
    joints = tuple(replace(one, parent=name) if one.parent == link.name else one for one in robot.joints)
    frames = tuple(replace(one, link=name) if one.link == link.name else one for one in robot.frames)
    observed = seen(replace(robot, links=(replace(link, name=name), *others), joints=joints, frames=frames))
    assert not [one for one in compare(observed, observed) if one.deviations.failures]


def _changed(value: object, change: Callable[[float], float | None]) -> Iterator[tuple[str, object]]:
    """A value with each of its numbers changed, one at a time, and where that is."""
    if isinstance(value, float) and math.isfinite(value):
        yield "", change(value)
    elif isinstance(value, Pose):
        yield "p", Pose.of(value.R, (change(0.0) or 0.0, *value.position[1:]))
    elif isinstance(value, Struct):
        for name in value.__struct_fields__:
            for place, other in _changed(getattr(value, name), change):
                yield f"{name} {place}".strip(), replace(value, **{name: other})
    elif isinstance(value, dict):
        for key, one in value.items():
            yield from ((place, {**value, key: other}) for place, other in _changed(one, change))
    elif isinstance(value, tuple):
        for index, one in enumerate(value):
            for place, other in _changed(one, change):
                yield place, (*value[:index], other, *value[index + 1 :])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["equipped", "universal", "screw", "gripper_with_mimic", "four_bar"])
def test_each_number_is_compared(name: str) -> None:
    """Two observations that differ in any one number differ; where one lacks a number, nothing breaks."""
    observation, tried = seen(ROBOTS[name]()), Counter[str]()
    for place, other in _changed(observation, lambda value: 1.01 * value + 0.013):
        tried[place] += 1
        along = place in ("joints axis", "joints axis2")  # a number of an axis along x, y or z changes its length alone
        if tried[place] <= 2 and place != "joints anchor" and not along:  # poses tell anchors apart
            assert isinstance(other, Observation)
            assert failed(observation, other), place
    for place, bare in _changed(observation, lambda _: None):
        *_, last = place.split()
        if last in ("pitch", "gear", "kp", "kv", "fov", "rate", "nearest", "farthest", "mass", "gravity_compensation"):
            assert isinstance(bare, Observation)
            statuses(observation, bare)
            statuses(bare, observation)
