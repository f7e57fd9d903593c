"""What is observed: joint coordinates and sensors, with names and units."""

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Array
from stepbot.robot.mesh_names import SCOPE

from .model import Model, floating_base, joint_kind, joint_name, name

_XYZ, _QUATERNION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
_VECTORS = {
    "ACCELEROMETER": "m/s^2",
    "VELOCIMETER": "m/s",
    "GYRO": "rad/s",
    "FORCE": "N",
    "TORQUE": "N*m",
    "MAGNETOMETER": "T",
    "BALLANGVEL": "rad/s",
    "FRAMEPOS": "m",
    "FRAMEXAXIS": "",
    "FRAMEYAXIS": "",
    "FRAMEZAXIS": "",
    "FRAMELINVEL": "m/s",
    "FRAMEANGVEL": "rad/s",
    "FRAMELINACC": "m/s^2",
    "FRAMEANGACC": "rad/s^2",
    "SUBTREECOM": "m",
    "SUBTREELINVEL": "m/s",
    "SUBTREEANGMOM": "kg*m^2/s",
    "GEOMNORMAL": "",
}
_SCALARS = {
    "TOUCH": "N",
    "RANGEFINDER": "m",
    "TENDONPOS": "m",
    "TENDONVEL": "m/s",
    "TENDONACTFRC": "N",
    "GEOMDIST": "m",
    "INSIDESITE": "",
    "CLOCK": "s",
    "E_POTENTIAL": "J",
    "E_KINETIC": "J",
}
_JOINT = {
    "JOINTPOS": ("rad", "m"),
    "JOINTVEL": ("rad/s", "m/s"),
    "JOINTACTFRC": ("N*m", "N"),
    "JOINTLIMITPOS": ("rad", "m"),
    "JOINTLIMITVEL": ("rad/s", "m/s"),
    "JOINTLIMITFRC": ("N*m", "N"),
}
"""Units at a hinge and at a slide."""
_CONTACT = (
    ("found", "", 1),
    ("force", "N", 3),
    ("torque", "N*m", 3),
    ("dist", "m", 1),
    ("pos", "m", 3),
    ("normal", "", 3),
    ("tangent", "", 3),
    ("linvel", "m/s", 3),
    ("angvel", "rad/s", 3),
)
"""Fields of a contact in the order of the bits that select them, ``mjtConDataField``: name, unit, size."""


def sensor_parts(model: Model, sensor: int) -> list[tuple[str, str]]:
    """Name and unit of each number of a sensor; no name if it is the only one, no unit where that is unknown."""
    kind = str(mujoco.mjtSensor(int(model.sensor_type[sensor])).name).removeprefix("mjSENS_")
    size = int(model.sensor_dim[sensor])
    if kind == "CONTACT":
        return _contact_parts(int(model.sensor_intprm[sensor, 0]), size)
    if kind in ("FRAMEQUAT", "BALLQUAT"):
        return [(part, "") for part in _QUATERNION]
    if kind in _VECTORS and size == len(_XYZ):
        return [(part, _VECTORS[kind]) for part in _XYZ]
    unit = _SCALARS.get(kind, "")
    if kind in _JOINT:
        unit = _JOINT[kind][joint_kind(model, int(model.sensor_objid[sensor])) == "slide"]
    return [("", unit)] if size == 1 else [(str(number), unit) for number in range(size)]


def _contact_parts(selected: int, size: int) -> list[tuple[str, str]]:
    parts: list[tuple[str, str]] = []
    for bit, (field, unit, length) in enumerate(_CONTACT):
        if selected >> bit & 1:
            parts += [(field, unit)] if length == 1 else [(f"{field}_{part}", unit) for part in _XYZ]
    count = size // len(parts)
    return parts if count == 1 else [(f"{number}/{part}", unit) for number in range(count) for part, unit in parts]


LARGEST = {"m": 1e2, "rad": 1e2, "m/s": 1e2, "rad/s": 1e3, "m/s^2": 1e4, "rad/s^2": 1e5, "N": 1e5, "N*m": 1e4}
"""Magnitudes beyond which values of a unit are clipped, far above those of a robot."""
UNKNOWN = 1e6
"""The same for values of other units."""
_BEYOND = 2.0
"""Ratio of that of a limited joint's position and its limit."""
CHOICES = ("all", "state", "sensors")
_JOINT_SENSORS = (mujoco.mjtSensor.mjSENS_JOINTPOS, mujoco.mjtSensor.mjSENS_JOINTVEL)


class Value(Struct, frozen=True):
    """One number of an observation."""

    name: str
    unit: str
    """Empty for pure numbers, and where it is unknown."""
    source: str
    """``qpos``, ``cos``, ``sin``, ``qvel`` or ``sensordata``."""
    index: int
    most: float = np.inf
    """Largest magnitude; infinite for that of the unit, :data:`LARGEST`."""


class Observations:
    """The values of a model that are observed, in the order of its joints and sensors.

    Positions come first, then velocities, then sensors. An unlimited hinge has the cosine and the sine of its angle
    instead of the angle. x and y of a floating base are omitted: nothing depends on them. ``jointpos`` and ``jointvel``
    sensors are omitted where the joints are observed.
    """

    def __init__(self, model: Model, choice: str) -> None:
        """Choose the values.

        Args:
            model: The compiled model.
            choice: ``all``; ``state``, the joints alone; ``sensors``, what the robot itself can measure.

        Raises:
            ValueError: The choice is unknown, or there are no sensors.
        """
        if choice not in CHOICES:
            raise ValueError(f"unknown choice of observations '{choice}'; there are {', '.join(CHOICES)}")
        if choice == "sensors" and model.nsensor == 0:
            raise ValueError("the model has no sensors; add `sensors` to the sidecar, or pass observe='state'")
        values = [] if choice == "sensors" else [*_positions(model), *_velocities(model)]
        if choice != "state":
            values += _sensors(model, but=_JOINT_SENSORS if values else ())
        self.values = tuple(values)
        starts = {"qpos": 0, "cos": model.nq, "sin": 2 * model.nq, "qvel": 3 * model.nq}
        starts["sensordata"] = starts["qvel"] + model.nv
        self._index = np.array([starts[value.source] + value.index for value in values], dtype=np.intp)
        self._turns = any(value.source in ("cos", "sin") for value in values)

    def read(self, data: Any) -> Array:
        """The values (n,) of a state."""
        q = data.qpos
        cos, sin = (np.cos(q), np.sin(q)) if self._turns else (q, q)
        return np.asarray(np.concatenate((q, cos, sin, data.qvel, data.sensordata))[self._index])


def _positions(model: Model) -> Iterator[Value]:
    base = floating_base(model)
    for joint in range(model.njnt):
        kind, start, of = joint_kind(model, joint), int(model.jnt_qposadr[joint]), joint_name(model, joint)
        if kind == "free":
            for offset in range(2 if joint == base else 0, 3):
                yield Value(f"{of}/{_XYZ[offset]}", "m", "qpos", start + offset)
        if kind in ("free", "ball"):
            first = start + (3 if kind == "free" else 0)
            yield from (Value(f"{of}/{part}", "", "qpos", first + i, 1.0) for i, part in enumerate(_QUATERNION))
        elif kind == "hinge" and not model.jnt_limited[joint]:
            yield from (Value(f"{of}/{source}", "", source, start, 1.0) for source in ("cos", "sin"))
        else:
            most = _BEYOND * float(np.abs(model.jnt_range[joint]).max()) if model.jnt_limited[joint] else np.inf
            yield Value(f"{of}/position", "rad" if kind == "hinge" else "m", "qpos", start, most)


def _velocities(model: Model) -> Iterator[Value]:
    for joint in range(model.njnt):
        kind, start, of = joint_kind(model, joint), int(model.jnt_dofadr[joint]), joint_name(model, joint)
        if kind == "free":
            yield from (Value(f"{of}/v{part}", "m/s", "qvel", start + i) for i, part in enumerate(_XYZ))
        if kind in ("free", "ball"):
            first = start + (3 if kind == "free" else 0)
            yield from (Value(f"{of}/w{part}", "rad/s", "qvel", first + i) for i, part in enumerate(_XYZ))
        else:
            yield Value(f"{of}/velocity", "rad/s" if kind == "hinge" else "m/s", "qvel", start)


def _sensors(model: Model, but: tuple[Any, ...]) -> Iterator[Value]:
    for sensor in range(model.nsensor):
        if mujoco.mjtSensor(int(model.sensor_type[sensor])) in but:
            continue
        start, sensor_name = int(model.sensor_adr[sensor]), name(model, "SENSOR", sensor).replace(SCOPE, "/")
        cutoff = float(model.sensor_cutoff[sensor])
        # A range finder without an echo measures -1.
        most = max(cutoff, 1.0) if cutoff > 0.0 else np.inf
        for offset, (part, unit) in enumerate(sensor_parts(model, sensor)):
            yield Value(f"{sensor_name}/{part}" if part else sensor_name, unit, "sensordata", start + offset, most)
