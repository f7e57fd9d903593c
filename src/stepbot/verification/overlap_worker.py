"""The process that searches for overlapping links; results for a known robot come from the cache."""

from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache, Digest, TypedCache, codec_of, environment
from stepbot.runtime.worker import Start, Worker

from .self_collision import Overlap, without_visuals

_Overlaps = tuple[Overlap, ...]


class Collider:
    """A started worker, waiting for its robot."""

    def __init__(self, memory_limit: int | None = None, start: Start | None = None) -> None:
        self._worker = Worker("stepbot.verification.self_collision:overlaps", memory_limit=memory_limit, start=start)
        self._results: TypedCache[_Overlaps] = TypedCache(None, _Overlaps)
        self._key = ""
        self._known: _Overlaps | None = None

    def submit(self, robot: Robot, cache: Cache | None) -> None:
        """Send the robot, unless the cache has its result; returns at once."""
        subject = without_visuals(robot)
        if cache is not None:
            self._results = TypedCache(cache, _Overlaps)
            self._key = Digest("overlaps").add(environment(), codec_of(Robot).encode(subject)).key
            self._known = self._results.get(self._key)
        if self._known is None:
            self._worker.submit(subject)
        else:
            self._worker.close()

    def result(self, timeout: float) -> _Overlaps:
        """The pairs of links that overlap.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
            RemoteError: The function raised.
        """
        if self._known is None:
            self._known = self._worker.result(timeout)
            if self._key:
                self._results.put(self._key, self._known)
        return self._known

    def close(self) -> None:
        """End the process if it still runs."""
        self._worker.close()
