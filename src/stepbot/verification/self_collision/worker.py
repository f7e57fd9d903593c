"""The processes that search for overlapping links; results for a known robot come from the cache."""

from collections.abc import Mapping
from math import isinf

import numpy as np
from msgspec import Struct

from stepbot.geometry.spatial import Vector3, vector3
from stepbot.robot.kinematics import Tree
from stepbot.robot.model import Robot
from stepbot.robot.self_collision import SelfCollision
from stepbot.runtime.cache import Cache, Digest, TypedCache, codec_of, environment
from stepbot.runtime.worker import Start, Worker, Workers

from .search import Overlap, placed, separate_links
from .shapes import only_collisions, prepare

__all__ = ["Contact", "contacts", "prepare"]


class Contact(Struct, frozen=True):
    """Two links that overlap."""

    link_a: str
    link_b: str
    depth: float | None
    """Penetration [m]; None between two surfaces, which have none."""
    point: Vector3 | None
    """Where the shapes overlap most [m], in the frame of ``link_a``; None for a link inside another."""


class _Search:
    """The links of one robot."""

    def __init__(self, robot: Robot) -> None:
        self.tree, self.pairs = Tree(robot), tuple(separate_links(robot))

    def contacts(self, q: Mapping[str, float]) -> tuple[Contact, ...]:
        """The links that overlap."""
        X = self.tree.frames(np.array([[q[name] for name in self.tree.joints]], dtype=np.float64))
        contacts = []
        for pair in self.pairs:
            (R,), (p,) = placed(self.tree, X, pair)
            if not pair.boxes_meet(R, p):
                continue
            deepest = pair.deepest(R, p)
            if deepest is not None:
                depth, point = deepest
                at = None if point is None else vector3(point)
                contacts.append(Contact(pair.a, pair.b, None if isinf(depth) else depth, at))
        return tuple(contacts)


class _Kept:
    """What this process keeps from one call to the next."""

    search: _Search | None = None


def contacts(robot: Robot | None, q: Mapping[str, float]) -> tuple[Contact, ...]:
    """The pairs of links that overlap in a configuration, except adjacent ones, in the order of the links.

    Args:
        robot: The robot; None for that of the previous call.
        q: Positions [rad] or [m] of all moving joints, by name.

    Raises:
        KeyError: A position is missing.
    """
    if robot is not None:
        _Kept.search = _Search(robot)
    assert _Kept.search is not None  # the first call has a robot
    return _Kept.search.contacts(q)


_Overlaps = tuple[Overlap, ...]
_ROOM = "stepbot.verification.self_collision"


class ContactSearch:
    """A worker that compares the links of one robot in one configuration after the other."""

    def __init__(self, robot: Robot, memory_limit: int | None = None) -> None:
        self._worker = Worker(f"{_ROOM}.worker:contacts", memory_limit=memory_limit)
        self._robot: Robot | None = only_collisions(robot)

    def at(self, q: Mapping[str, float], timeout: float) -> tuple[Contact, ...]:
        """The links that overlap at positions [rad] or [m] of all moving joints.

        Raises:
            WorkerDied: The process ended without a result, or took longer than ``timeout`` [s].
            RemoteError: The function raised.
        """
        self._worker.submit(self._robot, q, more=True)
        contacts: tuple[Contact, ...] = self._worker.result(timeout)
        self._robot = None  # the process keeps it
        return contacts

    def close(self) -> None:
        """End the process."""
        self._worker.close()


class Collider:
    """A started worker that searches the drawn pose, waiting for its robot."""

    def __init__(self, memory_limit: int | None = None, start: Start | None = None) -> None:
        self._worker = Worker(f"{_ROOM}.search:overlaps", memory_limit=memory_limit, start=start)
        self._known: _Overlaps | None = None

    def submit(self, robot: Robot, cache: Cache | None) -> None:
        """Send the robot, unless the cache has its result; returns at once."""
        subject = only_collisions(robot)
        self._results: TypedCache[_Overlaps] = TypedCache(cache, _Overlaps)
        self._key = _key("overlaps", subject)
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
            self._results.put(self._key, self._known)
        return self._known

    def close(self) -> None:
        """End the process if it still runs."""
        self._worker.close()


def find_self_collision(robot: Robot, samples: int, cache: Cache | None, workers: Workers) -> SelfCollision:
    """The classes of all pairs of links, from the cache or from a process of its own.

    Raises:
        WorkerDied: The process ended without a result, or took too long.
        RemoteError: The function raised; of kind ``DoesNotClose`` if the drawn pose is not closed.
    """
    subject = only_collisions(robot)
    results: TypedCache[SelfCollision] = TypedCache(cache, SelfCollision)
    key = _key("self-collision", subject, str(samples))
    known = results.get(key)
    if known is None:
        known = workers.call(f"{_ROOM}.search:matrix", subject, samples)
        results.put(key, known)
    return known


def _key(what: str, subject: Robot, *more: str) -> str:
    return Digest(what).add(environment(), codec_of(Robot).encode(subject), *more).key
