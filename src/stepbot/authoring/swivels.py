"""Removes idle rotations of rods and struts between ball joints.

A rod with a ball joint at each end can spin about its own axis, which moves nothing else: the end nearer to the root is
drafted as a universal joint. A shaft in a bore with one swivel on each side is a strut: prismatic.
"""

from collections import defaultdict, deque
from collections.abc import Sequence

import numpy as np

from stepbot.geometry.spatial import perpendicular_frame, unit
from stepbot.robot.model import JointKind

from .axis import Axis
from .evidence import Rank
from .freedom import FreedomKind
from .mechanism import Link

_SWIVELS = (JointKind.BALL, JointKind.UNIVERSAL)


def stop_spinning_rods(joints: Sequence[Link], root: int) -> None:
    """Make one end of each rod between two ball joints a universal joint; each is to be reviewed."""
    of = _by_cluster(joints)
    depth = _depths(of, root)
    for rod in sorted(of):
        ends = of[rod]
        if rod == root or len(ends) != 2 or any(j.hinge.type != JointKind.BALL for j in ends):
            continue
        if any(j.hinge.rank == Rank.STATED for j in ends):
            continue
        near, far = sorted(ends, key=lambda j: (depth.get(j.other(rod), len(of)), j.hinge.a, j.hinge.b))
        along = far.hinge.axis.point - near.hinge.axis.point
        if float(np.linalg.norm(along)) < 1e-6:
            continue
        across = perpendicular_frame(unit(along))
        h = near.hinge
        h.type, h.axis2 = JointKind.UNIVERSAL, Axis(h.axis.point, across[:, 1])
        h.axis = Axis(h.axis.point, across[:, 0])
        h.review = "universal instead of ball, to keep the rod from spinning; could also be the other end"


def slide_in_struts(joints: Sequence[Link]) -> None:
    """Make a shaft in a bore between two swivels prismatic."""
    of = _by_cluster(joints)
    for j in joints:
        r = j.hinge.relation
        if j.hinge.type != JointKind.REVOLUTE or r is None or r.freedom.kind != FreedomKind.CYLINDRICAL:
            continue
        others = [[k for k in of[side] if k is not j] for side in (j.a, j.b)]
        if all(len(rest) == 1 and rest[0].hinge.type in _SWIVELS for rest in others):
            j.hinge.type, j.hinge.review = JointKind.PRISMATIC, "a strut between two swivels; could also be revolute"


def _by_cluster(joints: Sequence[Link]) -> dict[int, list[Link]]:
    of: dict[int, list[Link]] = defaultdict(list)
    for j in joints:
        of[j.a].append(j)
        of[j.b].append(j)
    return of


def _depths(of: dict[int, list[Link]], root: int) -> dict[int, int]:
    """The number of joints between each cluster and the root."""
    depth, waiting = {root: 0}, deque([root])
    while waiting:
        here = waiting.popleft()
        for j in of.get(here, ()):
            other = j.other(here)
            if other not in depth:
                depth[other] = depth[here] + 1
                waiting.append(other)
    return depth
