"""Components and units of MuJoCo's sensors."""

import mujoco

from .model import Model, joint_kind

_XYZ = ("x", "y", "z")
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
        return [(part, "") for part in ("qw", "qx", "qy", "qz")]
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
