"""Closures and mimics in MJCF: sites, equality constraints, their stiffness, and the damping of motors that move them.

Closures constrain sites: ``<closure>::a`` and ``<closure>::b`` are the two F frames. A revolute closure is two
``connect``, at F and at a second point of its axis: six rows, five of which are independent, two in a planar loop.
Sites, not anchors, because MuJoCo places an anchor in the second body by the pose at q = 0, where the loop need not
close; the keyframe ``home`` is the drawn pose, where it does.
"""

from math import sqrt

import numpy as np

from stepbot.robot.closures import Loops
from stepbot.robot.dynamics import mobilities
from stepbot.robot.gains import actuator_limit, line_damping
from stepbot.robot.kinematics import mimic_relation
from stepbot.robot.mesh_names import MOTOR_LINE, SCOPE
from stepbot.robot.model import Actuator, JointKind, Link, Mimic, Robot
from stepbot.robot.multi_dof import split, steps_by_child
from stepbot.robot.simulation_settings import Settings, settings_of

from ..lowering.joints import closure_points
from ..xml import Element, Value, element
from .devices import MARK, mjcf_pose

_IMPEDANCE = (0.99, 0.999, 0.001)
"""`solimp` of equality constraints: almost rigid at once, and more so beyond a gap of 1 mm or 1 mrad."""
_LEAST, _MOST = 1e-4, 1e4
"""Range of the damping that MuJoCo's impedance, of at most 0.9999, expresses, times time step and mobility."""
_FAR = 10.0
"""Multiple of the effort limit at which the line ends: at as many times the velocity limit."""
_CLOSURE = "closure"
"""Class of equality constraints."""


def stiffness(default: Element, robot: Robot) -> None:
    """Add the class of equality constraints."""
    if is_constrained(robot):
        stiff = {"solref": _reference(settings_of(robot)), "solimp": _IMPEDANCE}
        element(element(default, "default", class_=_CLOSURE), "equality", **stiff)


def is_constrained(robot: Robot) -> bool:
    """Whether a robot has closures or mimics."""
    return bool(robot.closures or _mimics(robot))


def _mimics(robot: Robot) -> list[tuple[str, Mimic]]:
    """The mimics of all joints, by the name of the joint that follows."""
    steps = [step for chain in steps_by_child(robot).values() for step in chain]
    return [(step.name, step.mimic) for step in steps if step.mimic is not None]


def _reference(settings: Settings) -> tuple[float, float]:
    """`solref`: time constant [s] and damping ratio of a constraint that closes a share of its gap within one step.

    MuJoCo derives from them the damping 2 / time constant, which here stops the gap's velocity within one step, and the
    stiffness 1 / (time constant * damping ratio)^2. A time constant below two steps it replaces by two steps.
    """
    return 2.0 * settings.timestep, 0.5 / sqrt(settings.closure_stiffness)


def closure_sites(body: Element, link: Link, robot: Robot) -> None:
    """Add the sites of the closures of a link."""
    for closure in robot.closures:
        for side, holder, X_LF in (("a", closure.link_a, closure.X_AF), ("b", closure.link_b, closure.X_BF)):
            if holder == link.name:
                name = f"{closure.name}{SCOPE}{side}"
                element(body, "site", name=name, class_=MARK, **mjcf_pose(X_LF))
                if closure.kind is JointKind.REVOLUTE:
                    _, on_axis = closure_points(closure)
                    point = X_LF.apply(on_axis).tolist()
                    element(body, "site", name=f"{name}{SCOPE}axis", class_=MARK, pos=point)


def equality(top: Element, robot: Robot) -> None:
    """Add the equality constraints."""
    mimics = _mimics(robot)
    if not (mimics or robot.closures):
        return
    xml = element(top, "equality")
    for name, mimic in mimics:
        given: dict[str, Value] = {}
        if (mimic.offset, mimic.multiplier) != (0.0, 1.0):
            given["polycoef"] = (mimic.offset, mimic.multiplier)
        element(xml, "joint", class_=_CLOSURE, joint1=name, joint2=mimic.joint, **given)
    for closure in robot.closures:
        kind = "weld" if closure.kind is JointKind.FIXED else "connect"
        sides = {"site1": f"{closure.name}{SCOPE}a", "site2": f"{closure.name}{SCOPE}b"}
        element(xml, kind, name=closure.name, class_=_CLOSURE, **sides)
        if closure.kind is JointKind.REVOLUTE:
            on_axis = {side: f"{site}{SCOPE}axis" for side, site in sides.items()}
            element(xml, kind, name=f"{closure.name}{SCOPE}axis", class_=_CLOSURE, **on_axis)


def motor_lines(robot: Robot) -> dict[str, tuple[float, float]]:
    """Time constant [s] and impedance of the line of each actuator that moves others through mimics or loops, by name.

    As a constraint with the damping 2 / (time constant * impedance) and MuJoCo's regularization, (1 - impedance) /
    impedance times the mobility of the joint at q = 0, it is the implicit damping of one step.
    """
    coupled = _coupled(robot)
    lines = [(one, _line(one, robot)) for one in robot.actuators if one.joint in coupled]
    if not any(line for _, line in lines):
        return {}
    try:
        mobility = mobilities(robot)
    except np.linalg.LinAlgError:
        return {}
    step, ranges = settings_of(robot).timestep, {}
    for actuator, line in lines:
        strength = line * step * mobility[actuator.joint]
        if _LEAST < strength < _MOST:
            impedance = strength / (1.0 + strength)
            ranges[actuator.name] = 2.0 * step / impedance, impedance
    return ranges


def _coupled(robot: Robot) -> set[str]:
    """Joints that move others by mimics or loops."""
    robot = split(robot, JointKind.SCREW)
    mimics = {joint.name for joint in robot.joints if joint.mimic is not None}
    return (
        mimics
        | {mimic_relation(robot, name)[0] for name in mimics}
        | set(Loops(robot).involved if robot.closures else ())
    )


def _line(actuator: Actuator, robot: Robot) -> float:
    """The damping at the joint that is not cut off by the effort limit."""
    return min(line_damping(actuator, robot.joint_by_name[actuator.joint]), actuator.kv * actuator.gear**2)


def tendons(top: Element, robot: Robot, lines: dict[str, tuple[float, float]]) -> None:
    """Add the tendons that brake motors along their torque-speed lines."""
    if lines:
        xml = element(top, "tendon")
        for actuator in robot.actuators:
            if actuator.name in lines:
                time, impedance = lines[actuator.name]
                effort = actuator_limit(actuator, robot.joint_by_name[actuator.joint]).effort
                name = f"{actuator.name}{MOTOR_LINE}"
                soft = {"solreffriction": (time, 1.0), "solimpfriction": (impedance, impedance, 0.001)}
                tendon = element(xml, "fixed", name=name, frictionloss=_FAR * effort, **soft)
                element(tendon, "joint", joint=actuator.joint, coef=1.0)
