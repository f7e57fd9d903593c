"""Closures and mimics in MJCF: sites, equality constraints, and their stiffness.

Closures constrain sites: ``<closure>::a`` and ``<closure>::b`` are the two F frames. A revolute closure is two
``connect``, at F and at a second point of its axis: six rows, five of which are independent, two in a planar loop.
Sites, not anchors, because MuJoCo places an anchor in the second body by the pose at q = 0, where the loop need not
close; the keyframe ``home`` is the drawn pose, where it does.
"""

from math import sqrt

import numpy as np

from stepbot.robot.mesh_names import SCOPE
from stepbot.robot.model import JointKind, Link, LoopClosure, Mimic, Robot
from stepbot.robot.multi_dof import steps_by_child
from stepbot.robot.simulation_settings import Settings, settings_of

from ..xml import Element, Value, element
from .devices import MARK, mjcf_pose

_IMPEDANCE = (0.99, 0.999, 0.001)
"""`solimp` of equality constraints: almost rigid at once, and more so beyond a gap of 1 mm or 1 mrad."""
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
                    point = X_LF.apply(_second_point(closure)).tolist()
                    element(body, "site", name=f"{name}{SCOPE}axis", class_=MARK, pos=point)


def _second_point(closure: LoopClosure) -> list[float]:
    """A point of the axis, in F [m], as far from F as F is from the links' frames, so that all rows weigh the same."""
    reach = max(float(np.linalg.norm(X.p)) for X in (closure.X_AF, closure.X_BF)) or 0.1
    return [reach * direction for direction in closure.axis]


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
