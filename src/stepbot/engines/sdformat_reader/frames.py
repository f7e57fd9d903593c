"""Poses of the frames of an SDFormat model: poses with ``relative_to``, axes with ``expressed_in``.

http://sdformat.org/tutorials?tut=pose_frame_semantics
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Array, Pose

from ..observation import EngineRefused
from ..xml import Element

MODEL = "__model__"
WORLD = "world"
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def numbers(text: str | None) -> list[float]:
    """The numbers in a text.

    Raises:
        EngineRefused: One of them is not a finite number.
    """
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        values = [math.nan]
    if not all(map(math.isfinite, values)):
        raise EngineRefused(f"'{text}' is not a list of finite numbers")
    return values


def three_at(element: Element, path: str, default: str = "") -> tuple[float, float, float]:
    """The three numbers in a child element: a size, a scale.

    Raises:
        EngineRefused: They are not three finite numbers.
    """
    text = element.findtext(path) or default
    values = numbers(text)
    if len(values) != 3:
        raise EngineRefused(f"<{path.rpartition('/')[2]}> is '{text.strip()}', three numbers expected")
    return values[0], values[1], values[2]


def number_at(element: Element | None, path: str, default: float) -> float:
    """The number in a child element, or the default if it is missing.

    Raises:
        EngineRefused: It is something else.
    """
    node: Any = None if element is None else element.find(path)  # the stubs lack `sourceline`
    if node is None:
        return default
    text = (node.text or "").strip()
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        raise EngineRefused(f"line {node.sourceline}: <{node.tag}> is '{text}', not a number")
    return value


def finite_at(element: Element | None, path: str, default: float) -> float:
    """The finite number in a child element, or the default if it is missing.

    Raises:
        EngineRefused: It is something else.
    """
    value = number_at(element, path, default)
    if math.isinf(value):
        raise EngineRefused(f"<{path.rpartition('/')[2]}> is infinite")
    return value


def count_at(element: Element | None, path: str, default: int) -> int:
    """The whole number in a child element, or the default if it is missing; raises as :func:`finite_at`."""
    return int(finite_at(element, path, default))


def bool_at(element: Element | None, path: str, default: bool) -> bool:
    """The truth value below an element, or the default where there is none.

    Raises:
        EngineRefused: It is neither true nor false.
    """
    text = None if element is None else element.findtext(path)
    if text is None:
        return default
    value = _BOOLEANS.get(text.strip().lower())
    if value is None:
        raise EngineRefused(f"<{path}> is '{text.strip()}', true or false expected")
    return value


def ends(joint: Element) -> tuple[str, str]:
    """Names of the parent and the child link of a joint."""
    return (joint.findtext("parent") or "").strip(), (joint.findtext("child") or "").strip()


def read_pose(element: Element | None) -> Pose:
    """The ``<pose>`` of an element, in the frame that it is relative to; the identity if it is missing.

    Raises:
        EngineRefused: The number of values does not match its format, or one is not finite.
    """
    pose = None if element is None else element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return Pose()
    values = numbers(pose.text)
    if pose.get("rotation_format") == "quat_xyzw":
        if len(values) != 7:
            raise EngineRefused(f"a pose with {len(values)} numbers, 7 expected")
        x, y, z, w = values[3:]
        return Pose.from_quaternion((w, x, y, z), values[:3])
    if len(values) != 6:
        raise EngineRefused(f"a pose with {len(values)} numbers, 6 expected")
    angles = [math.radians(angle) for angle in values[3:]] if pose.get("degrees") == "true" else values[3:]
    return Pose.from_xyz_rpy(values[:3], angles)


def relative_to(element: Element) -> str:
    """The frame that the pose of an element is relative to; empty if it names none."""
    pose = element.find("pose")
    return "" if pose is None else pose.get("relative_to", "")


class Frames:
    """The frames of a model: the model itself, its links, joints and frames."""

    def __init__(self, model: Element) -> None:
        self._element: dict[str, Element] = {}
        for kind in ("link", "joint", "frame"):
            for element in model.findall(kind):
                self._element.setdefault(element.get("name", ""), element)
        self._known: dict[str, Pose] = {MODEL: Pose()}

    def X_M(self, name: str) -> Pose:
        """Pose of a frame in the model, with all joints at 0.

        Raises:
            EngineRefused: There is no such frame, or its definition is circular.
        """
        return self._resolved(name, ())

    def axis(self, joint: Element, axis: Element) -> Array:
        """Direction (3,) of a joint's axis, in the model, not normalized."""
        xyz = axis.find("xyz")
        text = "0 0 1" if xyz is None else xyz.text
        direction = numbers(text)
        if len(direction) != 3 or not any(direction) or not all(map(math.isfinite, direction)):
            raise EngineRefused(f"joint '{joint.get('name', '')}': the axis is '{text}', not a direction")
        frame = (xyz.get("expressed_in", "") if xyz is not None else "") or joint.get("name", "")
        if axis.findtext("use_parent_model_frame", "").strip() in ("1", "true"):
            frame = MODEL
        return self.X_M(frame).turn(np.array(direction))

    def link_of(self, name: str) -> str:
        """The link that a frame is attached to.

        Raises:
            EngineRefused: There is no such frame, or its definition is circular.
        """
        for _ in self._element:
            element = self._element.get(name)
            if element is None and name not in (MODEL, WORLD):
                raise EngineRefused(f"no link or frame '{name}'")
            if element is None or element.tag == "link":
                return name
            name = (element.get("attached_to") or MODEL) if element.tag == "frame" else ends(element)[1]
        raise EngineRefused(f"frame '{name}' is attached to itself")

    def _resolved(self, name: str, above: tuple[str, ...]) -> Pose:
        if name in self._known:
            return self._known[name]
        if name in above:
            raise EngineRefused(f"frame '{name}' is relative to itself")
        element = self._element.get(name)
        if element is None:
            raise EngineRefused(f"no frame '{name}'")
        base = relative_to(element) or _DEFAULT_BASE[str(element.tag)](element)
        X = self._resolved(base, (*above, name)) @ read_pose(element)
        self._known[name] = X
        return X


_DEFAULT_BASE: dict[str, Callable[[Element], str]] = {
    "link": lambda link: MODEL,
    "joint": lambda joint: ends(joint)[1],
    "frame": lambda frame: frame.get("attached_to") or MODEL,
}
