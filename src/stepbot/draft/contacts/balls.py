"""Balls in sockets: concentric convex and concave spheres of nearly equal radius."""

from collections import defaultdict

import numpy as np

from stepbot.draft.contacts.contacts import Contacts, Socket
from stepbot.draft.parts.scene import PlacedFace, Scene
from stepbot.geometry.spatial import Array
from stepbot.step.faces import FaceKind
from stepbot.step.features.axis_contacts import LOOSEST, SLACK_SHARE

_CELL = 1e-4
"""Size [m] of the cells that centres are sorted into."""
_CENTRES = 2e-5
"""Distance [m] up to which centres are equal."""
_NEIGHBOURS = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]


def find_sockets(scene: Scene, found: Contacts) -> None:
    """Add all balls in sockets to the contacts, each pair of parts and centre once."""
    cells: dict[tuple[int, ...], list[PlacedFace]] = defaultdict(list)
    for row in scene.faces(FaceKind.SPHERE):
        cells[_cell(row.point)].append(row)
    for ball in (row for row in scene.faces(FaceKind.SPHERE) if not row.face.bore):
        x, y, z = _cell(ball.point)
        for dx, dy, dz in _NEIGHBOURS:
            for socket in cells.get((x + dx, y + dy, z + dz), ()):
                if socket.face.bore and socket.part != ball.part and _fits(ball, socket):
                    a, b = sorted((ball.part, socket.part))
                    known = found.sockets[a, b]
                    if not any(np.linalg.norm(s.point - ball.point) < _CENTRES for s in known):
                        known.append(Socket(a, b, ball.point, ball.face.radius))


def _fits(ball: PlacedFace, socket: PlacedFace) -> bool:
    radii = ball.face.radius, socket.face.radius
    slack = max(LOOSEST, SLACK_SHARE * max(radii))
    return float(np.linalg.norm(ball.point - socket.point)) <= _CENTRES and abs(radii[0] - radii[1]) <= slack


def _cell(point: Array) -> tuple[int, ...]:
    return tuple(np.floor(point / _CELL).astype(int).tolist())
