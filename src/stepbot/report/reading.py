"""The robot of a ``report.json``, the inverse of :mod:`stepbot.report.robot`: everything but shapes and sensors."""

from collections.abc import Mapping
from typing import Any, TypeVar

from stepbot.geometry.inertia import MassProperties
from stepbot.robot.model import Actuator, Base, Frame, Joint, Link, LoopClosure, Robot
from stepbot.robot.tuning import Tuning

from .plain import unpicked
from .robot import ACTUATOR, CLOSURE, FRAME, JOINT, MASS, TUNING

Json = Mapping[str, Any]
T = TypeVar("T")


def robot_of_report(document: Json) -> Robot:
    """The robot of a parsed ``report.json``, without shapes and sensors.

    Raises:
        KeyError, TypeError, ValueError: The document does not have the report's schema, or has no robot.
    """
    content = document["robot"]

    def records(key: str, kind: type[T], keys: str) -> tuple[T, ...]:
        return tuple(unpicked(kind, one, keys, key, has_defaults=True) for one in content[key])

    return Robot(
        name=str(content["name"]),
        links=tuple(Link(one["name"], unpicked(MassProperties, one, MASS, "links")) for one in content["links"]),
        joints=records("joints", Joint, JOINT),
        closures=records("closures", LoopClosure, CLOSURE),
        frames=records("frames", Frame, FRAME),
        actuators=tuple(map(_actuator, content["actuators"])),
        base=Base(content["base"]),
        source=str(content["source"]),
    )


def _actuator(content: Json) -> Actuator:
    """An actuator without the figures of its motor, and with what its computed gains were asked for."""
    computed = content.get("computed")
    tuning = None if computed is None else unpicked(Tuning, computed, TUNING, "actuators")
    given = {"tuning": tuning, "motor": None}
    return unpicked(Actuator, content, ACTUATOR, "actuators", has_defaults=True, **given)
