"""Contacts: how stiff they are, the surfaces of geoms, and which bodies have none."""

from stepbot.robot.kinematics import rigid_bodies, without_contacts
from stepbot.robot.model import Base, JointKind, Robot
from stepbot.robot.simulation_settings import settings_of
from stepbot.robot.surfaces import Surface, damping_ratio

from ..xml import Element, Value, element

FRICTION: dict[str, Value] = {"cone": "elliptic", "impratio": 100.0}
"""Friction is a damper, a hundred times as stiff as MuJoCo's default, with which a gripped cube slides out."""
_CONTACT_TIME = 0.004
"""Time constant [s] of contacts, at least two steps: with the default of 20 ms, fingers sink into what they grip."""
_CONTACT = (0.95, 0.99, 0.001)
"""`solimp` of contacts."""
_DEFAULT = (1.0, 0.005, 0.0001)
"""MuJoCo's sliding, torsional [m] and rolling [m] friction."""
_WORLD = "world"


def stiffness(robot: Robot) -> dict[str, Value]:
    """The attributes of all collisions."""
    return {"solref": (max(_CONTACT_TIME, 2.0 * settings_of(robot).timestep), 1.0), "solimp": _CONTACT}


def surface(given: Surface, timestep: float) -> dict[str, Value]:
    """The attributes of a geom with contact properties, which count instead of those of the geom that it touches.

    A contact with a damping ratio z and a natural frequency w has the time constant 1 / (z w). Restitution lowers z and
    leaves w, which the time step limits.
    """
    if not given.is_stated:
        return {}
    attributes: dict[str, Value] = {"priority": 1}
    friction = (given.friction, given.torsional, given.rolling)
    if friction != (None, None, None):
        stated = [default if value is None else value for value, default in zip(friction, _DEFAULT, strict=True)]
        count = max(i for i, value in enumerate(friction, start=1) if value is not None)
        attributes["friction"] = stated[:count]
        attributes |= {"condim": (4, 6)[count - 2]} if count > 1 else {}
    if given.restitution is not None or given.softness is not None:
        ratio = 1.0 if given.restitution is None else damping_ratio(given.restitution)
        time = max(_CONTACT_TIME, 2.0 * timestep) if given.softness is None else given.softness
        attributes["solref"] = (time / ratio, ratio)
    return attributes


def has_payload(robot: Robot) -> bool:
    """Whether a floating joint connects a link to one that moves, which it may touch: MuJoCo's filter forbids that."""
    weld = _welds(robot)
    return any(joint.kind is JointKind.FLOATING and weld[joint.parent] != _WORLD for joint in robot.joints)


def excludes(top: Element, robot: Robot) -> None:
    """Excludes for adjacent links, as MuJoCo's own filter covers neither bodies fixed to the world nor closures.

    And for the links whose contacts are excluded because of how often they overlap.
    """
    close, weld = without_contacts(robot), _welds(robot)
    filtered = () if has_payload(robot) else robot.joints
    left_out = {frozenset((weld[joint.parent], weld[joint.child])) for joint in filtered}
    touching = [link.name for link in robot.links if link.collisions]
    pairs = [
        (a, b)
        for i, a in enumerate(touching)
        for b in touching[i + 1 :]
        if weld[a] != weld[b]
        and frozenset((a, b)) in close
        and (_WORLD in (weld[a], weld[b]) or frozenset((weld[a], weld[b])) not in left_out)
    ]
    if pairs:
        contact = element(top, "contact")
        for a, b in pairs:
            element(contact, "exclude", body1=a, body2=b)


def _welds(robot: Robot) -> dict[str, str]:
    """For each link, the topmost link that it is fixed to, or the world."""
    root = robot.root.name
    top = _WORLD if robot.base is Base.FIXED else root
    return {link: top if body == root else body for link, body in rigid_bodies(root, robot.joints).items()}
