"""What a composing sidecar says of its own STEP and links alone, and what its defaults say of its modules."""

from fnmatch import fnmatchcase
from typing import Any

from msgspec.structs import replace

from stepbot.robot.model import JointKind

from .document import Document, JointSection
from .located import Sidecar
from .origins import ExplicitOrigin
from .shapes import CollisionSettings, CollisionShape, CollisionTarget, is_for_mjx

TIE = "/"
"""Start of the names of joints that :func:`own_part` adds; names of a sidecar cannot contain it."""


def is_foreign(document: Document, reference: str | None) -> bool:
    """Whether a reference is, or can only be, one to a module."""
    return reference is not None and ("/" in reference or reference in document.modules)


def own_part(sidecar: Sidecar) -> Sidecar:
    """The sidecar without its modules and everything that refers to them, for the own links and STEP alone.

    Own links that only modules connect are tied together by fixed joints whose names begin with :data:`TIE`.
    """
    document = sidecar.document
    if not document.modules:
        return sidecar
    frames = {
        name: frame
        for name, frame in document.frames.items()
        if not (is_foreign(document, frame.link) or is_foreign(document, _relative_to(frame.origin)))
    }

    def is_own(*references: str | None) -> bool:
        return not any(is_foreign(document, reference) or (reference in document.frames) for reference in references)

    joints = {name: joint for name, joint in document.joints.items() if is_own(joint.parent, joint.child)}
    closures = {name: one for name, one in document.closures.items() if is_own(one.link_a, one.link_b)}
    own_joints = {name for name in document.actuators if document.actuators[name].joint in joints}
    sensors = {
        name: sensor
        for name, sensor in document.sensors.items()
        if (sensor.joint in joints if sensor.joint else not is_foreign(document, sensor.link))
        and not is_foreign(document, _relative_to(sensor.origin))
    }
    update: dict[str, Any] = {
        "modules": {},
        "expect": None,
        "frames": frames,
        "joints": joints | _ties(document, {joint.child for joint in joints.values()}),
        "joint_defaults": {
            pattern: rule
            for pattern, rule in document.joint_defaults.items()
            if not any(fnmatchcase(name, pattern) for name in document.joints if name not in joints)
        },
        "closures": closures,
        "actuators": {name: one for name, one in document.actuators.items() if name in own_joints},
        "sensors": sensors,
        "excluded_contacts": tuple(pair for pair in document.excluded_contacts if is_own(*pair)),
    }
    return replace(sidecar, document=document.model_copy(update=update))


def with_defaults_of(composing: Document, module: Sidecar) -> Sidecar:
    """The sidecar of a module, with shapes for MJX if the composing one asks for them: they concern the whole robot."""
    defaults = module.document.defaults
    given = defaults.collision or CollisionShape.AUTO
    if not is_for_mjx(composing.defaults.collision) or is_for_mjx(given):
        return module
    settings = given if isinstance(given, CollisionSettings) else CollisionSettings(shape=given)
    collision = settings.model_copy(update={"for_": CollisionTarget.MJX})
    update = {"defaults": defaults.model_copy(update={"collision": collision})}
    return replace(module, document=module.document.model_copy(update=update))


def _relative_to(origin: Any) -> str | None:
    return origin.relative_to if isinstance(origin, ExplicitOrigin) else None


def _ties(document: Document, children: set[str]) -> dict[str, Any]:
    """Fixed joints between the first own link without a joint above it and the others."""
    first, *others = [link for link in document.links if link not in children] or [""]
    return {
        TIE + link: JointSection(type=JointKind.FIXED, parent=first, child=link, origin=ExplicitOrigin())
        for link in others
    }
