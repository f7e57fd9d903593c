"""What can be done about a failed drive test, as far as the robot's report and the numbers of the test say."""

from collections.abc import Iterator, Mapping
from typing import Any

from msgspec import Struct

from stepbot.robot.model import Robot

from .results import Grip, Loss, Spin

_COMPUTE = "`gains: auto`"
_REMEDIES = {
    "overshoot": f"raise kv, lower kp, or let stepbot compute both: {_COMPUTE}",
    "lag": f"raise kp, lower the damping of the joint, or let stepbot compute the gains: {_COMPUTE}",
    "speed of limit": f"raise kv, or let stepbot compute the gains: {_COMPUTE}",
    "angle error": "raise kp, or the joint's effort limit if the motor is at it",
    "travel error": "raise kp, or the joint's effort limit if the motor is at it",
    "angle drift": "raise kv, or lower kp: the joint does not come to rest",
    "travel drift": "raise kv, or lower kp: the joint does not come to rest",
    "loop opening": "lower the efforts, or shorten the time step in the sidecar: `simulation: {timestep: 0.5 ms}`",
    "energy gain": "shorten the time step, or look for tiny masses and inertias behind large ones",
    "penetration": "give the colliding links collision shapes with faces, not edges",
    "tilt": "lower the centre of mass, or move the wheels or casters apart",
    "tilt at rest": "check the home pose: all feet are to be on the floor",
    "sinking": "raise kp of the legs' actuators",
    "tilt after push": "raise kp and kv of the legs' actuators, or spread the legs in the home pose",
}
_REMEDY = "see the test in `stepbot docs drive`; draw its curves with --plots"
_HOLLOW = ("auto", "decompose", "given")
"""Rules of collision shapes that keep links hollow, or that are not stepbot's."""
_TURNED = 0.9
"""Angle of a wheel, relative to the one asked for, from which its motor is not what holds the base up."""
_FEW = 3
"""Number of links that are named."""
_STRONG = 0.9
"""Effort, relative to its limit, from which a larger kp gains nothing."""


_MOST_OVERLAPS = 3
"""Number of overlaps that a message names, the deepest ones."""


class Facts(Struct, frozen=True):
    """What the report of a robot states about remedies."""

    computed: frozenset[str] = frozenset()
    """Joints whose motors have `gains: auto`."""
    filled: frozenset[str] = frozenset()
    """Links whose collision shapes may fill hollows."""
    light: frozenset[str] = frozenset()
    """Joints with motors and without armature."""
    overlaps: Mapping[tuple[str, str], float] = {}
    """How deep [m] links are in each other in the initial pose, in MuJoCo."""


def facts_of(document: Mapping[str, Any], robot: Robot) -> Facts:
    """The facts of a report, and of its robot."""
    actuators = document["robot"]["actuators"]
    shapes = document.get("collision_shapes", [])
    driven = {actuator["joint"] for actuator in actuators}
    return Facts(
        frozenset(actuator["joint"] for actuator in actuators if actuator.get("computed") is not None),
        frozenset(shape["link"] for shape in shapes if shape["rule"] not in _HOLLOW),
        frozenset(j.name for j in robot.joints if j.name in driven and not j.dynamics.armature),
    )


def remedy(quantity: str, where: str, facts: Facts) -> str:
    """What usually helps if a quantity is beyond its limit.

    Args:
        where: The joint or link that it was measured at.
    """
    usual = _REMEDIES.get(quantity.partition(" with ")[0], _REMEDY)
    if not (where in facts.computed and _COMPUTE in usual):
        return usual
    shorter = "shorten the time step, `simulation: {timestep: 0.5 ms}`"
    if where in facts.light:
        return f"state the inertia of the motor's rotor at the joint, `dynamics: {{armature: ...}}`, or {shorter}"
    return f"correct the masses or the limits of the joint, from which its gains are computed, or {shorter}"


def overlap_words(overlaps: Mapping[tuple[str, str], float]) -> tuple[str, str]:
    """Which links overlap in the initial pose, and what helps; the deepest first."""
    deepest = sorted(overlaps, key=lambda pair: (-round(overlaps[pair], 6), pair))
    shown = [f"'{a}' and '{b}' by {1e3 * overlaps[a, b]:.3g} mm" for a, b in deepest[:_MOST_OVERLAPS]]
    pairs = ", ".join(f"[{a}, {b}]" for a, b in deepest[:_MOST_OVERLAPS])
    return (
        f"links overlap in the initial pose, and their contacts push them apart: {'; '.join(shown)}",
        f"likely the overlaps: `collision` with closer shapes for these links, or `excluded_contacts: [{pairs}]`",
    )


def spin_words(spin: Spin, *, gains: bool) -> tuple[str, str]:
    """What the wheels of a base did that is not where it should be, and what can be done about it.

    Args:
        spin: The wheel that turned least.
        gains: Whether the motor has the gains of the file, as in MuJoCo; URDF has none.
    """
    names = " and ".join(f"'{one}'" for one in spin.standing[:_FEW])
    drags = f"; {names} touch{'es' * (len(spin.standing) == 1)} the floor as well" if names else ""
    turned = f"the wheel of '{spin.joint}' turned {100.0 * spin.share:.0f} % of what was asked for"
    if spin.dragged:
        names = " and ".join(f"'{one}'" for one in spin.dragged[:_FEW])
        rolls = "rolls on an axle that does" if len(spin.dragged) == 1 else "roll on axles that do"
        turned = "the wheels turned as asked for" if spin.share > _TURNED else turned
        return (
            f"{turned}; {names} {rolls} not swivel, and slipped sideways",
            "put the wheel of a caster on its fork, and the fork on a joint with a vertical axis, or give it little "
            "friction: `contact`",
        )
    if spin.share > _TURNED:
        return (
            f"the wheels turned as asked for, and slipped or lost the floor{drags}",
            "let only wheels and casters touch the floor, with the weight on the wheels and friction under them",
        )
    if spin.effort is not None and spin.effort >= _STRONG:
        brakes = "raise the effort limit, or look for a link that brakes on the floor"
        return f"{turned}, at its effort limit{drags}", brakes
    if gains:
        weak = f"{turned}: its kv of {spin.kv:.2g} is too weak{drags}"
        return weak, "raise kv, or let stepbot compute it: `gains: auto`"
    return turned + drags, "look for friction or damping of the joint, and for a link that brakes on the floor"


def fate(grip: Grip) -> str:
    """What became of a cube that was lost."""
    cube = f"the {grip.cube}"
    if grip.loss is Loss.PUSHED:
        return f"{cube} was pushed out of the grip of '{grip.joint}' before it got its weight"
    if grip.loss is Loss.FREE:
        return f"{cube} fell freely as it got its weight: '{grip.joint}' did not hold it"
    return f"{cube} slipped out of the grip of '{grip.joint}' and fell, {grip.seconds:.2f} s after it got its weight"


def grip_remedies(grip: Grip, facts: Facts, *, gains: bool) -> Iterator[str]:
    """What can be done about a cube that was lost, or that slipped.

    Args:
        gains: Whether the motor has the gains of the file, as in MuJoCo; URDF has none.
    """
    if grip.loss is Loss.FREE:
        narrowest, widest = (1e3 * gap for gap in grip.gaps)
        yield f"check the direction and the limits of the joint: the gap closes from {widest:.0f} to {narrowest:.0f} mm"
        if grip.gaps[0] >= grip.cube.edge:  # whatever the force
            return
    if grip.loss is Loss.PUSHED:
        yield "let the faces that close be parallel where the cube is between them"
    if gains and (grip.effort is None or grip.effort < _STRONG):
        yield from _stiffer(grip, facts)
    elif grip.effort is not None:
        yield "raise the effort limit of the joint: the motor presses with all of it"
    if filled := sorted(facts.filled & grip.links):
        yield f"give hollow jaws `collision: auto`: {', '.join(filled)}"


def _stiffer(grip: Grip, facts: Facts) -> Iterator[str]:
    """What makes a position motor press harder: its effort is kp times the way to its target."""
    share = "" if grip.effort is None else f", {100.0 * grip.effort:.0f} % of its effort limit"
    yield f"raise kp, or let the joint close further: kp times the rest of its range presses on the cube{share}"
    computed = grip.joint in facts.computed
    if grip.joint in facts.light:
        follow = ", which `gains: auto` follows" if computed else ", without which MuJoCo's contacts are soft"
        yield f"state the inertia of the motor's rotor at the joint, `dynamics: {{armature: ...}}`{follow}"
    if computed:
        yield "`gains: auto` sets kp: write `kp` and `kv` in its place"
