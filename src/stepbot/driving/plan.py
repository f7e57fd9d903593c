"""Which tests apply to a robot, decided from its model, with the reason for each that does not."""

from collections.abc import Mapping
from math import isfinite

from stepbot.engines import engines
from stepbot.engines.simulation import Mechanism
from stepbot.robot.model import ActuatorKind

from .mechanism import Wheels
from .survey import Survey


def reasons(
    mechanism: Mechanism, survey: Survey, wheels: Wheels | None, limbs: tuple[str, ...], *, mjcf: bool
) -> Mapping[str, str]:
    """For each test why it does not apply; an empty string for those that do.

    Args:
        survey: Its poses and grasps.
        mjcf: Whether MuJoCo drives an MJCF, in which grasps are found.
    """
    kinds = {motor.kind for motor in mechanism.motors}
    driving = {wheel.motor for wheel in wheels.wheels} if wheels else set()
    spins = any(motor.kind is ActuatorKind.VELOCITY and motor.name not in driving for motor in mechanism.motors)
    servo = "" if ActuatorKind.POSITION in kinds else "no position actuator"
    limited = any(isfinite(motor.limit.effort) for motor in mechanism.motors)
    moving = "" if mechanism.home else "no moving joint"
    if not (mechanism.motors or survey.misses):
        return {**dict.fromkeys(TESTS, "the robot has no actuators"), "drop": moving}
    no_grasp = _no_grasp(mechanism, survey) if mjcf else "needs the MJCF and MuJoCo, in which grasps are found"
    return {
        "hold": servo,
        "step": ""
        if survey.steps or spins
        else "no position actuator with room for a step, and no velocity actuator but wheels",
        "track": "" if survey.steps else "no position actuator with room for a step",
        "sweep": servo,
        "torque": "" if limited else "no actuator on a joint with an effort limit",
        "drop": moving,
        "grip": "" if survey.grasps else no_grasp,
        "roll": ""
        if wheels
        else "no velocity actuator on a continuous joint with a horizontal axle, on a floating base",
        "turn": "" if wheels and wheels.turns else _no_turn(wheels),
        "strafe": "" if wheels and wheels.rollers else "no wheels with three or more passive rollers each",
        "stand": "" if limbs and not wheels else "no floating base with two or more limbs of two motors each",
    }


def ungripped(survey: Survey) -> Mapping[str, str]:
    """Where a robot that grips a cube elsewhere grips none, ``grip of MOTOR``, each with its reason.

    A motor that grips with two of its links is left out: links of a linkage move relative to each other without being
    fingers.
    """
    gripping = {motor for grasp in survey.grasps for motor in grasp.fingers.motors}
    missed = survey.misses.items() if survey.grasps else ()
    return {f"grip of {motor}": why for motor, why in missed if motor not in gripping}


def _no_turn(wheels: Wheels | None) -> str:
    if wheels is None or len(wheels.wheels) == 1 or not wheels.apart:
        return "no driven wheels, under a floating base, with rollers or with their axles in line"
    names = ", ".join(f"'{wheel.link}'" for wheel in wheels.wheels)
    return (
        f"the axles of {names} are up to {1e3 * wheels.apart:.0f} mm apart in the direction of driving: such wheels "
        "turn the base only by slipping sideways, and how far is a matter of friction"
    )


def _no_grasp(mechanism: Mechanism, survey: Survey) -> str:
    if not survey.misses:
        looped = mechanism.robot.closures
        links = "moved by a mimic, or through loops on one link, " if looped else ""
        single = "outside of loops " if looped else ""
        return (
            f"no two links {links}that a motor closes on each other, and no link {single}that could close on the one "
            "that carries it"
        )
    motors: dict[str, list[str]] = {}
    for motor, why in survey.misses.items():
        motors.setdefault(why, []).append(motor)
    return "; ".join(f"{', '.join(names)}: {why}" for why, names in motors.items())


TESTS: Mapping[str, str] = {
    "hold": "random poses are held",
    "step": "each motor steps to a new target",
    "track": "each motor follows a slow sine",
    "sweep": "each motor visits both ends of its range",
    "torque": "random efforts up to the limits",
    "drop": "falls on the floor, or limp if the base is fixed",
    "grip": "holds a cube",
    "roll": "drives straight ahead and back",
    "turn": "turns once on the spot",
    "strafe": "drives to the left and back",
    "stand": "stands, and is pushed",
}
"""All tests, in the order in which they run, and what the robot does."""
ENGINES: Mapping[str, str] = {
    engine.name: engine.drives for engine in sorted(engines(), key=lambda engine: engine.order) if engine.drives
}
"""The engines that drive, and the format that each drives."""
SURVEYOR = next(name for name, driven in ENGINES.items() if driven == "mjcf")
"""The engine that finds poses and grasps, and that drives with the gains of the model."""
