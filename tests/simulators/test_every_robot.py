"""Every named robot in every format passes in every engine that can read it."""

from collections import defaultdict
from math import isinf
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostics
from stepbot.engines import engines
from stepbot.formats import FORMATS
from stepbot.formats.lowering import lower
from stepbot.report.robot import Report, Status
from stepbot.robot.model import Base, JointKind
from stepbot.verification.conversion import Provers, verify
from tests.conftest import ReadDiagnostics
from tests.robots import ROBOTS
from tests.simulators.conftest import write

NAMES = {"load", "links", "joints"}
JOINTS = {"axes", "limits", "dynamics"}
BODIES = {"mass", "com", "inertia"}
MOTION = {"poses", "mass matrix", "gravity forces", "inverse dynamics"}
REST = {"meshes", "simulation", "warnings"}

COMPARED = {
    ("urdf", "mujoco"): NAMES | JOINTS | BODIES | MOTION | REST | {"mimic", "shapes"},
    ("urdf", "pybullet"): NAMES | JOINTS | BODIES | MOTION | REST | {"closures", "shapes"},
    ("urdf", "yourdfpy"): NAMES | JOINTS | BODIES | {"poses", "warnings", "mimic", "shapes"},
    ("urdf", "extensions"): {"load", "dynamics", "actuators", "sensors", "warnings"},
    ("sdf", "pybullet"): NAMES | JOINTS | {"mass", "com", "poses", "gravity forces", "meshes", "shapes", "warnings"},
    ("sdf", "reader"): NAMES | JOINTS | BODIES | MOTION
    | {"meshes", "warnings", "mimic", "closures", "frames", "actuators", "sensors", "shapes"},
    ("mjcf", "mujoco"): NAMES | JOINTS | BODIES | MOTION | REST
    | {"mimic", "closures", "frames", "actuators", "sensors", "initial pose", "shapes", "contacts"},
    ("mjcf", "pybullet"): {"load"},
    ("usd", "usd"): NAMES | JOINTS | BODIES | MOTION
    | {"meshes", "warnings", "mimic", "closures", "frames", "actuators", "initial pose", "shapes", "contacts"},
    ("webots", "vrml"): NAMES | JOINTS | BODIES | MOTION | {"meshes", "frames", "sensors", "initial pose"},
    ("urdf", "pinocchio"): NAMES | JOINTS | BODIES | MOTION | {"warnings", "mimic"},
    ("mjcf", "pinocchio"): NAMES | {"axes"} | BODIES | MOTION | {"warnings"},
    ("urdf", "drake"): NAMES | JOINTS | BODIES | MOTION | REST | {"shapes"},
    ("sdf", "drake"): NAMES | JOINTS | BODIES | MOTION | REST | {"frames", "shapes"},
    ("drake.sdf", "drake"): NAMES | JOINTS | BODIES | MOTION | REST | {"closures", "frames", "shapes"},
    ("mjcf", "drake"): NAMES | {"axes", "dynamics"} | BODIES | MOTION | REST,
    ("usd", "newton"): NAMES | JOINTS | BODIES
    | {"poses", "mass matrix", "warnings", "mimic", "closures", "actuators"},
    ("sdf", "libsdformat"): {"load", "warnings"},
    ("drake.sdf", "libsdformat"): {"load", "warnings"},
}  # fmt: skip
"""Quantities that each engine can compare in each format, if the robot has them."""


UNKNOWN_TO_PYBULLET = {JointKind.BALL, JointKind.UNIVERSAL, JointKind.SCREW, JointKind.FLOATING}
"""Kinds of joints that SDFormat has, or that are written as such, and that PyBullet does not read there."""


def _reported(written_in: str, engine: str, name: str) -> set[str]:
    """The quantities that an engine compares in a robot's file."""
    kinds = {joint.kind for joint in ROBOTS[name]().joints}
    if (written_in, engine) == ("sdf", "pybullet") and kinds & UNKNOWN_TO_PYBULLET:
        return set()
    if _unreadable(written_in, engine, name):
        return set()
    lacks = _lacks(name)
    if (written_in, engine) == ("sdf", "pybullet") and ROBOTS[name]().base is Base.FLOATING:
        lacks |= {"gravity forces"}  # of a floating base they depend on inertias, which PyBullet does not read
    if written_in == "usd":  # mimics between angles and distances are left out, sensors too
        lowered = lower(ROBOTS[name](), FORMATS["usd"], Diagnostics())
        lacks |= set() if any(joint.mimic for joint in lowered.joints) else {"mimic"}
        # Newton's velocities of a ball joint are not those of its coordinates.
        balls = engine == "newton" and any(joint.kind is JointKind.BALL for joint in lowered.joints)
        lacks |= {"mass matrix"} if balls else set()
    if written_in == "urdf" and JointKind.SCREW in kinds:
        # One half of the screw mimics the other, which is later in the tree: Pinocchio supports no such mimic.
        lacks = lacks | {"mimic"} if engine == "pinocchio" else lacks - {"mimic"}
    # A ball joint has no axis to compare.
    if kinds <= {JointKind.FIXED, JointKind.BALL, JointKind.FLOATING}:
        lacks |= {"axes"}
    return COMPARED[written_in, engine] - lacks


IN_ONE_BODY = {JointKind.UNIVERSAL, JointKind.CYLINDRICAL, JointKind.SCREW, JointKind.PLANAR, JointKind.FLOATING}
"""Joint types that are several joints in one MJCF body, which Drake and Pinocchio read differently."""


def _unreadable(written_in: str, engine: str, name: str) -> bool:
    """Whether an engine of `stepbot[verify]` cannot read a robot's file, as documented."""
    robot = ROBOTS[name]()
    kinds = {joint.kind for joint in robot.joints}
    if written_in == "drake.sdf" and not robot.closures:
        return True
    if written_in == "mjcf" and engine in ("drake", "pinocchio") and kinds & IN_ONE_BODY:
        return True
    if (written_in, engine) == ("mjcf", "drake"):
        half_open = any(isinf(joint.limit.lower) != isinf(joint.limit.upper) for joint in robot.joints)
        return half_open or any(link.mass_properties.mass == 0.0 for link in robot.links[1:])
    if (written_in, engine) == ("sdf", "drake"):
        return bool(robot.closures)
    # libsdformat 12, the version in distributions, supports neither mimics nor pitches.
    later = any(joint.mimic or joint.kind is JointKind.SCREW for joint in robot.joints)
    return engine == "libsdformat" and later


def _lacks(name: str) -> set[str]:
    """The quantities that a robot lacks."""
    robot = ROBOTS[name]()
    lacks = set() if any(joint.axis for joint in robot.joints) else JOINTS | {"mass matrix", "gravity forces"}
    lacks |= set() if any(joint.mimic for joint in robot.joints) else {"mimic"}
    lacks |= set() if robot.joints else {"inverse dynamics"}
    lacks |= set() if robot.closures else {"closures"}
    lacks |= set() if any(link.visuals or link.collisions for link in robot.links) else {"shapes"}
    lacks |= set() if len([link for link in robot.links if link.collisions]) > 1 else {"contacts"}
    lacks |= set() if robot.frames else {"frames"}
    lacks |= set() if robot.actuators else {"actuators"}
    lacks |= set() if robot.sensors else {"sensors"}
    lacks |= set() if any(joint.drawn_position for joint in robot.joints) else {"initial pose"}
    return lacks


LONG = (
    *("cylindrical", "delta", "floating", "four_bar_with_zeros", "gear", "left_screw", "one_sided", "pendulum"),
    *("planar", "screw", "slider", "slider_crank", "sliding_closure", "stewart", "tree", "two_link_arm", "universal"),
)
"""Robots that resemble others, whose joints test_equivalent_joints.py compares, and those with the most loops."""


def _marks(name: str) -> list[pytest.MarkDecorator]:
    """Tests of a robot run in one process."""
    group = pytest.mark.xdist_group(f"every_robot_{name}")
    return [group, pytest.mark.long] if name in LONG else [group]


@pytest.fixture(scope="module", params=[pytest.param(name, marks=_marks(name)) for name in ROBOTS])
def proof(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Report, list[str]]:
    """Name of a robot, its report, and its diagnostics."""
    name: str = request.param
    folder = write(ROBOTS[name](), tmp_path_factory.mktemp("files"))
    found = ReadDiagnostics()
    with Provers(FORMATS) as provers:
        report = verify(folder.robot, folder.written, provers, found, timeout=120.0)
    return name, report, [str(diagnostic) for diagnostic in found]


@pytest.mark.slow
def test_nothing_fails(proof: tuple[str, Report, list[str]]) -> None:
    """No check fails, and there is no diagnostic."""
    _, report, diagnostics = proof
    failed = [check for check in report.checks if check.status is Status.FAILED]
    assert not failed
    assert not diagnostics


@pytest.mark.slow
def test_what_can_be_compared_is_compared(proof: tuple[str, Report, list[str]]) -> None:
    """Each engine compares every quantity that it can report of this robot."""
    name, report, _ = proof
    installed = {engine.name for engine in engines() if engine.available() is None}
    passed: dict[tuple[str, str], set[str]] = defaultdict(set)
    for check in report.checks:
        if check.status is Status.PASSED:
            passed[check.format, check.engine].add(check.quantity)
    for written_in, engine in COMPARED:
        if engine in installed:
            assert passed[written_in, engine] == _reported(written_in, engine, name)


def test_self_collision_is_checked(proof: tuple[str, Report, list[str]]) -> None:
    """python-fcl checks self-collision once per robot."""
    _, report, _ = proof
    assert [check.status for check in report.checks if check.quantity == "self-collision"] == [Status.PASSED]


def test_deviations_are_far_below_the_tolerances(proof: tuple[str, Report, list[str]]) -> None:
    """Engines in double precision agree to 1e-12; only floats and loop constraints come near their tolerance."""
    _, report, _ = proof
    for check in report.checks:
        if check.ratio > 1e-3:
            single = check.engine in ("pybullet", "usd", "newton")
            assert check.quantity in ("meshes", "shapes", "closures") or single, check


def test_no_folder_of_this_machine_is_in_the_report(proof: tuple[str, Report, list[str]], tmp_path: Path) -> None:
    """The report has file names only, no folders."""
    _, report, _ = proof
    text = repr([report.checks, report.notes])
    assert str(tmp_path.parent) not in text
    assert all("/" not in check.file for check in report.checks)
