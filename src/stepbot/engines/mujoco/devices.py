"""Actuators, sensors and frames of a MuJoCo model.

Each of MuJoCo's sensors has one reading: sensors whose names share a prefix up to ``::`` are one sensor, and in other
files those that measure what one does, at one site or joint. The type of a group follows from its readings; an unknown
group keeps MuJoCo's names.
"""

from collections.abc import Iterator, Sequence
from math import atan, inf, pi, radians, tan
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose
from stepbot.robot.mesh_names import MOTOR_LINE, SCOPE
from stepbot.robot.model import ActuatorKind
from stepbot.robot.sensors import SensorKind

from ..observation import ObservedActuator, ObservedSensor

if TYPE_CHECKING:
    from .compiled import Compiled

_GROUPS = {
    frozenset({"accelerometer", "gyro", "framequat"}): SensorKind.IMU,
    frozenset({"force", "torque"}): SensorKind.FORCE_TORQUE,
    frozenset({"jointpos", "jointvel"}): SensorKind.JOINT,
    frozenset({"ballquat", "ballangvel"}): SensorKind.JOINT,
    frozenset({"jointpos", "jointvel", "ballquat", "ballangvel"}): SensorKind.JOINT,
    frozenset({"rangefinder"}): SensorKind.LIDAR,
    frozenset({"contact"}): SensorKind.CONTACT,
}
_OF_OTHERS = (
    frozenset({"accelerometer", "gyro", "framequat"}),
    frozenset({"accelerometer", "gyro"}),
    frozenset({"force", "torque"}),
    frozenset({"jointpos", "jointvel"}),
    frozenset({"ballquat", "ballangvel"}),
)
"""Readings that are one sensor wherever they are at one site or joint; the first that are all there."""
_FOUND_FORCE_TORQUE, _NET_FORCE = 0b111, 3
"""The settings of stepbot's contact sensors: `data` and `reduce`, as MuJoCo stores them."""
# Axes of a camera, and of a ray, in those of the sensor: a camera looks along -z with y up, a ray goes along z.
_R_SC = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
_R_SRay = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
_EVEN = 1e-9
"""Deviation [m or rad] of a ray from even spacing, at most."""


def observed_frames(compiled: "Compiled", sensors: Sequence[ObservedSensor]) -> dict[str, tuple[str, Pose]]:
    """Sites by name, without those that only mark the pose of a sensor."""
    marks = {sensor.name for sensor in sensors}
    model = compiled.model
    names = [(s, compiled.name("SITE", s)) for s in range(model.nsite)]
    named = [(s, name) for s, name in names if name]
    return {name: _site(compiled, s) for s, name in named if SCOPE not in name or name.split(SCOPE)[0] not in marks}


def _site(compiled: "Compiled", s: int) -> tuple[str, Pose]:
    model = compiled.model
    link = compiled.name("BODY", int(model.site_bodyid[s]))
    return link, Pose.from_quaternion(model.site_quat[s].tolist(), model.site_pos[s])


def observed_actuators(compiled: "Compiled") -> tuple[ObservedActuator, ...]:
    """The actuators."""
    return tuple(_actuator(compiled, a) for a in range(compiled.model.nu))


def _actuator(compiled: "Compiled", a: int) -> ObservedActuator:
    """An actuator; its kind follows from its bias, as MuJoCo's shortcuts set it."""
    model = compiled.model
    gain, bias = float(model.actuator_gainprm[a][0]), model.actuator_biasprm[a][:3].tolist()
    trn = compiled.engine.mjtTrn(model.actuator_trntype[a])
    if trn != compiled.engine.mjtTrn.mjTRN_JOINT:
        return ObservedActuator(compiled.name("ACTUATOR", a), "", f"on a {_word(trn)}")
    joint = compiled.name("JOINT", int(model.actuator_trnid[a][0]))
    gear = float(model.actuator_gear[a][0])
    control = _range(model.actuator_ctrlrange[a], model.actuator_ctrllimited[a])
    force = _range(model.actuator_forcerange[a], model.actuator_forcelimited[a])
    seen = ObservedActuator(compiled.name("ACTUATOR", a), joint, ActuatorKind.MOTOR.value, gear=gear)
    seen = replace(seen, control=control, force=force)
    strange = _strange(compiled, a)
    if strange:
        return replace(seen, kind=strange)
    if bias[1]:
        kv = motor_damping(compiled, a) / gear**2 - bias[2]
        return replace(seen, kind=ActuatorKind.POSITION.value, kp=gain, kv=kv)
    if bias[2]:
        return replace(seen, kind=ActuatorKind.VELOCITY.value, kv=gain)
    return replace(seen, gear=gear * gain)


def motor_damping(compiled: "Compiled", a: int) -> float:
    """Damping at the joint of an actuator [N m s/rad] or [N s/m] that its limit of force does not cut off."""
    model, name = compiled.model, f"{compiled.name('ACTUATOR', a)}{MOTOR_LINE}"
    tendon = int(compiled.engine.mj_name2id(model, compiled.engine.mjtObj.mjOBJ_TENDON, name))
    damping = float(model.actuator_damping[a] * model.actuator_gear[a][0] ** 2)
    if tendon < 0 or not model.tendon_frictionloss[tendon]:
        return damping
    time = max(float(model.tendon_solref_fri[tendon][0]), 2.0 * float(model.opt.timestep))
    compliance = (1.0 - float(model.tendon_solimp_fri[tendon][0])) * float(model.tendon_invweight0[tendon])
    return damping + 2.0 / (time * compliance)


def _word(value: Any) -> str:
    """MuJoCo's word for a value of an enumeration: ``mjTRN_TENDON`` is a tendon."""
    return str(value.name).partition("_")[2].lower()


def _strange(compiled: "Compiled", a: int) -> str:
    """The kind of an actuator that the model does not have; empty for one of the model's kinds."""
    engine, model = compiled.engine, compiled.model
    for what, value, plain in (
        ("activation", engine.mjtDyn(model.actuator_dyntype[a]), (engine.mjtDyn.mjDYN_NONE,)),
        ("gain", engine.mjtGain(model.actuator_gaintype[a]), (engine.mjtGain.mjGAIN_FIXED,)),
        (
            "bias",
            engine.mjtBias(model.actuator_biastype[a]),
            (engine.mjtBias.mjBIAS_NONE, engine.mjtBias.mjBIAS_AFFINE),
        ),
    ):
        if value not in plain:
            return f"general with {what} '{_word(value)}'"
    gain, bias = float(model.actuator_gainprm[a][0]), model.actuator_biasprm[a][:3].tolist()
    if engine.mjtBias(model.actuator_biastype[a]) == engine.mjtBias.mjBIAS_NONE:
        return ""
    servo = bias[1] and (bias[0] != 0.0 or bias[1] != -gain)
    damper = not bias[1] and bias[2] and (bias[0] != 0.0 or bias[2] != -gain)
    constant = bias[0] and not (bias[1] or bias[2])
    return "general with a bias of its own" if servo or damper or constant else ""


def _range(bounds: Any, limited: Any) -> tuple[float, float]:
    low, high = bounds.tolist() if limited else (-inf, inf)
    return low, high


def observed_sensors(compiled: "Compiled") -> tuple[ObservedSensor, ...]:
    """The sensors: groups of readings, and cameras; a reading without a name is a group of its own."""
    groups: dict[str, list[_Reading]] = {}
    others: dict[tuple[str, int], list[_Reading]] = {}
    for s in range(compiled.model.nsensor):
        engine, model = compiled.engine, compiled.model
        word = engine.mjtSensor(model.sensor_type[s]).name.removeprefix("mjSENS_").lower()
        on = engine.mjtObj(model.sensor_objtype[s]).name.removeprefix("mjOBJ_")
        reading = _Reading(s, compiled.name("SENSOR", s), word, (on, int(model.sensor_objid[s])))
        if SCOPE in reading.name:
            groups.setdefault(reading.name.split(SCOPE)[0], []).append(reading)
        else:
            others.setdefault(reading.on, []).append(reading)
    sensors = [_sensor(compiled, name, readings) for name, readings in groups.items()]
    for on, readings in others.items():
        sensors += _sensors_of_others(compiled, on, readings, set(groups))
    return (*sensors, *_cameras(compiled))


def _sensors_of_others(
    compiled: "Compiled", on: tuple[str, int], readings: "Sequence[_Reading]", taken: set[str]
) -> Iterator[ObservedSensor]:
    """The sensors of one site, joint or body: one with its name if it can be, and one for each further reading."""
    left = {reading.word: reading for reading in reversed(readings)}
    name = compiled.name(*on) if on[0] in ("SITE", "JOINT") else ""
    together = next((words for words in _OF_OTHERS if words <= left.keys()), frozenset[str]())
    group = [left[word] for word in sorted(together)]
    if name and name not in taken and len({_interval(compiled, reading.index) for reading in group}) == 1:
        sensor = _sensor(compiled, name, group, _GROUPS.get(together, SensorKind.IMU))
        if sensor.kind in set(SensorKind):
            yield sensor
            readings = [reading for reading in readings if reading not in group]
    yield from (_sensor(compiled, reading.name or f"sensor_{reading.index}", [reading]) for reading in readings)


class _Reading(Struct, frozen=True):
    """One of MuJoCo's sensors."""

    index: int
    name: str
    word: str
    """MuJoCo's name of its reading."""
    on: tuple[str, int]
    """Type and index of the element it is attached to."""


def _sensor(
    compiled: "Compiled", name: str, readings: Sequence[_Reading], kind: SensorKind | None = None
) -> ObservedSensor:
    """The sensor that a group of readings forms, of a kind that is known or follows from the readings."""
    words = sorted({reading.word for reading in readings})
    kind = kind or _GROUPS.get(frozenset(words))
    rates = {_interval(compiled, reading.index) for reading in readings}
    interval = rates.pop()
    seen = ObservedSensor(name, " and ".join(words), rate=1.0 / interval if interval else 0.0)
    if kind is None or rates:
        return seen
    properties = dict(_PROPERTIES[kind](compiled, readings))
    return replace(seen, **{"kind": kind.value, **properties}) if properties else seen


def _interval(compiled: "Compiled", s: int) -> float:
    """Time [s] between the measurements of a sensor; 0 for one in every step, as without a buffer."""
    model = compiled.model
    return float(model.sensor_interval[s][0]) if model.sensor_history[s][0] > 0 else 0.0


def _at_a_site(compiled: "Compiled", readings: Sequence[_Reading]) -> Iterator[tuple[str, Any]]:
    """Pose of an IMU: all of its readings are at one site."""
    places = {reading.on for reading in readings}
    if len(places) == 1 and len(readings) == len({reading.word for reading in readings}):
        on, s = places.pop()
        if on == "SITE":
            link, X_LS = _site(compiled, s)
            yield from (("link", link), ("X_LS", X_LS))


def _in_a_joint(compiled: "Compiled", readings: Sequence[_Reading]) -> Iterator[tuple[str, Any]]:
    """Pose of a force-torque sensor: at a site of the child of its joint."""
    yield from _at_a_site(compiled, readings)
    model = compiled.model
    body = int(model.site_bodyid[readings[0].on[1]])
    if model.body_jntnum[body] == 1:
        yield "joint", compiled.name("JOINT", int(model.body_jntadr[body]))


def _of_joints(compiled: "Compiled", readings: Sequence[_Reading]) -> Iterator[tuple[str, Any]]:
    """The joint, or the common prefix of several joints; each has a position and a velocity reading."""
    words: dict[str, set[str]] = {}
    for reading in readings:
        words.setdefault(compiled.name("JOINT", reading.on[1]), set()).add(reading.word)
    if all(len(properties) == 2 for properties in words.values()) and len(readings) == 2 * len(words):
        names = list(words)
        stems = {name.rpartition("_")[0] for name in names}
        yield "joint", names[0] if len(names) == 1 else stems.pop() if len(stems) == 1 else ""


def _of_a_body(compiled: "Compiled", readings: Sequence[_Reading]) -> Iterator[tuple[str, Any]]:
    """The link of a contact sensor, if it measures the net force of all contacts."""
    on, body = readings[0].on
    asked = compiled.model.sensor_intprm[readings[0].index].tolist()
    if len(readings) == 1 and on == "BODY" and asked[:2] == [_FOUND_FORCE_TORQUE, _NET_FORCE]:
        yield "link", compiled.name("BODY", body)


def _of_rays(compiled: "Compiled", readings: Sequence[_Reading]) -> Iterator[tuple[str, Any]]:
    """The field of view of evenly spaced rays, and its centre."""
    if {reading.on[0] for reading in readings} != {"SITE"}:
        return
    places = [_site(compiled, reading.on[1]) for reading in readings]
    rays = [Pose.of(X_LR.R @ _R_SRay.T, X_LR.p) for _, X_LR in places]
    step = _turn_about_z(rays[0], rays[1]) if len(rays) > 1 else 0.0
    fov = step * (len(rays) - 1)
    X_LS = rays[0] @ _about_z(0.5 * fov)
    even = [X_LS @ _about_z(i * step - 0.5 * fov) for i in range(len(rays))]
    off = max(max(ray.distance_to(wanted)) for ray, wanted in zip(rays, even, strict=True))
    farthest = {float(compiled.model.sensor_cutoff[reading.index]) for reading in readings}
    if off < _EVEN and len(farthest) == 1 and len({link for link, _ in places}) == 1:
        yield from (("link", places[0][0]), ("X_LS", X_LS), ("fov", fov), ("columns", len(rays)), ("rows", 1))
        yield "farthest", farthest.pop() or inf


def _about_z(angle: float) -> Pose:
    return Pose.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, angle))


def _turn_about_z(a: Pose, b: Pose) -> float:
    """Angle [rad] from one ray to the next, to the left and less than a turn."""
    R_AB = a.R.T @ b.R
    return float(np.arctan2(R_AB[1, 0], R_AB[0, 0])) % (2.0 * pi)


_PROPERTIES = {
    SensorKind.IMU: _at_a_site,
    SensorKind.FORCE_TORQUE: _in_a_joint,
    SensorKind.JOINT: _of_joints,
    SensorKind.LIDAR: _of_rays,
    SensorKind.CONTACT: _of_a_body,
}
"""Further properties of each kind; empty if the readings do not belong together."""


def _cameras(compiled: "Compiled") -> Iterator[ObservedSensor]:
    """Cameras attached to a body; they render on request, all with the same near and far plane."""
    model = compiled.model
    for c in range(model.ncam):
        X_LC = Pose.from_quaternion(model.cam_quat[c].tolist(), model.cam_pos[c])
        columns, rows = model.cam_resolution[c].tolist()
        fov = 2.0 * atan(tan(0.5 * radians(float(model.cam_fovy[c]))) * columns / rows)
        stays = model.cam_mode[c] == compiled.engine.mjtCamLight.mjCAMLIGHT_FIXED
        yield ObservedSensor(
            compiled.name("CAMERA", c),
            SensorKind.CAMERA.value if stays else "camera with its own rotation",
            compiled.name("BODY", int(model.cam_bodyid[c])),
            X_LS=Pose.of(X_LC.R @ _R_SC.T, X_LC.p),
            fov=fov,
            columns=columns,
            rows=rows,
        )
