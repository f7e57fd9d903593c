"""Subjects of messages about places in the sidecar: ``joint 'elbow': limits``."""

from .tree import Keys

_SUBJECTS = {
    "materials": "material",
    "parts": "parts rule",
    "links": "link",
    "joint_defaults": "joint default",
    "joints": "joint",
    "closures": "closure",
    "frames": "frame",
    "actuators": "actuator",
    "motors": "motor",
    "sensors": "sensor",
}

SECTIONS = tuple(_SUBJECTS)
"""Sections of members by name."""

ELEMENTS = ("links", "joints", "closures", "frames", "actuators", "sensors")
"""Sections whose members are elements of the robot."""


def subject(keys: Keys) -> str:
    """The subject of the value at ``keys``, with the path to the value: ``link 'jaw': inertial.com[1]``."""
    if not keys:
        return "sidecar"
    if len(keys) > 1 and keys[0] in _SUBJECTS and isinstance(keys[1], str):
        name, rest = f"{_SUBJECTS[str(keys[0])]} '{keys[1]}'", keys[2:]
        return f"{name}: {_joined(rest)}" if rest else name
    return _joined(keys)


def _joined(keys: Keys) -> str:
    text = ""
    for key in keys:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text
