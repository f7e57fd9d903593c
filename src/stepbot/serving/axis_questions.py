"""Answers that compute: axes that two parts share or a joint could have, and links that overlap."""

import threading
from collections.abc import Sequence
from math import isfinite

from msgspec.structs import asdict

from stepbot.pipeline.scenes import ShownScene
from stepbot.report.plain import Json
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.model import JointKind
from stepbot.robot.multi_dof import unfolded
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.origins import AutoOrigin, AxisOrigin, MateOrigin
from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import Selector
from stepbot.step.structure.paths import ComponentPaths
from stepbot.verification.self_collision.shapes import available
from stepbot.verification.self_collision.worker import ContactSearch
from stepbot.viewing.joining import lines_of_origin, shared_lines

from .local_server import Refused
from .questions import text

_TIMEOUT = 30.0
"""Time limit [s] of an answer."""


class Contacts:
    """Compares the links of the robot that is shown, in a process of its own."""

    def __init__(self, memory_limit: int | None) -> None:
        self._memory_limit = memory_limit
        self._lock = threading.Lock()
        self._shown: ShownScene | None = None
        self._search: ContactSearch | None = None
        self._closed = False

    def answer(self, shown: ShownScene | None, question: Json) -> Json:
        """The links that overlap: ``{q}``, positions [rad] or [m] of all moving joints.

        ``{pairs}`` is None, with the reason ``why``, where links cannot be compared.
        """
        if shown is None or shown.robot is None:
            return {"pairs": []}
        q = question.get("q")
        names = [joint.name for joint in moving_joints(unfolded(shown.robot))]
        if not isinstance(q, dict) or not all(_is_finite(q.get(name)) for name in names):
            raise Refused("positions of all moving joints are expected")
        reason = available()
        if reason:
            return {"pairs": None, "why": reason}
        with self._lock:
            if self._closed:  # a request that was under way when the server ended
                raise Refused("the server has ended")
            try:
                if self._search is None or shown is not self._shown:
                    self._close()
                    self._shown, self._search = shown, ContactSearch(shown.robot, self._memory_limit)
                answer = self._search.at({name: float(q[name]) for name in names}, _TIMEOUT)
            except (WorkerDied, RemoteError) as error:
                self._close()
                return {"pairs": None, "why": f"python-fcl ended: {error}"}
        return {"pairs": [asdict(one) for one in answer]}

    def close(self) -> None:
        """End the process, for good."""
        with self._lock:
            self._closed = True
            self._close()

    def _close(self) -> None:
        if self._search is not None:
            self._search.close()
        self._search = None


def _is_finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def axes_between(shown: ShownScene | None, question: Json) -> Json:
    """The axes that two components share: ``{a, b}``."""
    if shown is None or shown.assembly is None:
        return {"lines": []}
    assembly = shown.assembly
    indices = {component.path: component.index for component in assembly.components}
    a, b = (indices.get(text(question, name)) for name in ("a", "b"))
    if a is None or b is None:
        raise Refused("no such part")
    path = assembly.components[a].path
    link = next((parts for parts in _links(shown).values() if path in parts), [])
    axes = shared_lines(assembly, a, b, [indices[one] for one in link])
    return {"lines": [asdict(axis) for axis in axes]}


def axes_of_joint(shown: ShownScene | None, sidecar: Sidecar, question: Json) -> Json:
    """The lines that the origin of a joint or closure selects among: ``{joint}``; none for numbers."""
    name, document = text(question, "joint"), sidecar.document
    if shown is None or shown.assembly is None:
        return {"lines": []}
    assembly = shown.assembly
    joint, closure = document.joints.get(name), document.closures.get(name)
    if joint is not None:
        kind, ends, origin = joint.type, (joint.parent, joint.child), joint.origin
    elif closure is not None:
        kind, ends, origin = closure.type, (closure.link_a, closure.link_b), closure.origin
    else:
        raise Refused(f"no joint '{name}'")
    if origin == "auto":
        origin = AutoOrigin()
    if not isinstance(origin, AxisOrigin | MateOrigin | AutoOrigin):
        return {"lines": []}
    is_doubted = any(one["name"] == name and one["doubt"] for one in (shown.scene or {}).get("connections", ()))
    b: Sequence[int] | None = None
    if isinstance(origin, AxisOrigin):
        a: Sequence[int] = _below(assembly, origin.axis_of)
    elif isinstance(origin, MateOrigin):
        a, b = (_below(assembly, path) for path in origin.mate)
    else:
        indices, links = {component.path: component.index for component in assembly.components}, _links(shown)
        a, b = ([indices[path] for path in links.get(link, [])] for link in ends)
    selected = Selector(origin.radius, origin.near)
    axes = lines_of_origin(
        assembly, a, b, selected, direction_only=kind is JointKind.PRISMATIC, all_explicit=is_doubted
    )
    return {"lines": [asdict(axis) for axis in axes]}


def _below(assembly: Assembly, pattern: str) -> Sequence[int]:
    """A component and all below it; nothing for a pattern without a component of its own."""
    component = ComponentPaths(assembly.components).find_one(pattern).topmost
    return list(assembly.subtree(component[0])) if len(component) == 1 else []


def _links(shown: ShownScene) -> dict[str, list[str]]:
    """Paths of the components with a body of each link."""
    return {link["name"]: link["components"] for link in (shown.scene or {}).get("links", ())}
