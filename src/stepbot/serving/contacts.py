"""Answers about links that overlap while the page moves the robot."""

import threading
from dataclasses import asdict
from math import isfinite
from typing import Any

from stepbot.pipeline.scenes import Shown
from stepbot.robot.kinematics import moving_joints
from stepbot.robot.multi_dof import unfolded
from stepbot.runtime.worker import RemoteError, WorkerDied
from stepbot.verification.self_collision.worker import ContactSearch

from .local_server import Refused

Json = dict[str, Any]
_TIMEOUT = 30.0
"""Time limit [s] of an answer."""


class Contacts:
    """Compares the links of the robot that is shown, in a process of its own."""

    def __init__(self, memory_limit: int | None) -> None:
        self._memory_limit = memory_limit
        self._lock = threading.Lock()
        self._shown: Shown | None = None
        self._search: ContactSearch | None = None
        self._closed = False

    def answer(self, shown: Shown | None, question: Json) -> Json:
        """The links that overlap: ``{q}``, positions [rad] or [m] of all moving joints.

        ``{pairs}`` is None, with the reason ``why``, where links cannot be compared.
        """
        if shown is None or shown.robot is None:
            return {"pairs": []}
        q = question.get("q")
        names = [joint.name for joint in moving_joints(unfolded(shown.robot))]
        if not isinstance(q, dict) or not all(_is_finite(q.get(name)) for name in names):
            raise Refused("positions of all moving joints are expected")
        reason = ContactSearch.unavailable()
        if reason:
            return {"pairs": None, "why": reason}
        with self._lock:
            if self._closed:  # a request that was under way when the server ended
                raise Refused("the server has ended")
            try:
                if self._search is None or shown is not self._shown:
                    self._close()
                    self._shown, self._search = shown, ContactSearch(shown.robot, self._memory_limit)
                found = self._search.at({name: float(q[name]) for name in names}, _TIMEOUT)
            except (WorkerDied, RemoteError) as error:
                self._close()
                return {"pairs": None, "why": f"python-fcl ended: {error}"}
        return {"pairs": [asdict(one) for one in found]}

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
