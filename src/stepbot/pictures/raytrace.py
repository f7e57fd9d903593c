"""A ray tracer for triangles: soft shadows, light from the whole sky, a floor that fades into the background.

It needs no window and no graphics card: Embree intersects rays with triangles, shading is done here. Soft light has no
noise: the pixels of a tile share one low-discrepancy sequence of light rays, and visibility is averaged over the same
tile, on the same surface only (interleaved sampling, Keller and Heidrich 2001). Nothing is random: the same processor,
numpy and Embree render the same picture each time; on others it may differ in last bits.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from stepbot.geometry.shading import corner_normals
from stepbot.geometry.spatial import Array
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.processes import core_count
from stepbot.runtime.worker import Worker

from .camera import Camera
from .camera import unit_vectors as _unit

Band = tuple[int, int]
"""The first row, and the row after the last one."""
PAPER = np.array((0.93, 0.93, 0.94))
"""Linear colour of floor and background."""
BACKGROUND = -1
"""Triangle of a pixel that shows none."""
SUN = np.array((-0.45, -0.62, 0.85))
"""Towards the key light, seen from a camera that looks along +y."""
_SUN_SPREAD = 0.16
"""Tangent of the key light's half angle: the softness of shadows."""
_SUN_LIGHT, _SKY_LIGHT, _GROUND_LIGHT = 0.78, 0.62, 0.28
_GLOSS, _GLOSS_POWER = 0.22, 48.0
_NEAR = 2e-4
"""Distance of the start of a ray from its surface, relative to the size of the scene."""
_ROWS = 24
"""Rows of the picture that are rendered at once."""
_RAYS_OF_A_PROCESS = 1_000_000
"""Rays from the camera that take much longer than the start of a process."""
_DRAW = "stepbot.pictures.raytrace:draw_bands"
_TILE = 5
"""Pixels along the edge of the tile that shares its light rays."""
_SAME_DIRECTION, _SAME_PLANE = 0.9, 1e-3
"""Cosine between normals, and distance from the tangent plane relative to the size of the scene, up to which two pixels
show one surface."""


class Scene(Struct, frozen=True, eq=False):
    """Triangles in the world."""

    vertices: Array
    """Shape (n, 3) [m]."""
    triangles: NDArray[np.int32]
    """Shape (m, 3)."""
    colors: Array
    """Linear colour of each triangle, shape (m, 3)."""
    floor: float
    """Height [m] of the floor; ``-inf`` for none."""
    owners: NDArray[np.int32]
    """Whose each triangle is, shape (m,): an index of names."""


class Renderer:
    """A scene as one camera sees it."""

    def __init__(self, scene: Scene, camera: Camera) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._scene, self._camera, self._embree = scene, camera, EmbreeScene()
        TriangleMesh(self._embree, scene.vertices.astype(np.float32), scene.triangles)
        corners = scene.vertices[scene.triangles]
        self._size = float(np.linalg.norm(np.ptp(scene.vertices, axis=0)))
        self._normals = corner_normals(scene.vertices, scene.triangles)
        self._first = corners[:, 0]
        self._edges = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        x, y, z = SUN
        right, _, _ = camera.axes
        level = np.cross((0.0, 0.0, 1.0), right)
        self._sun = _unit(x * right + y * level + z * np.array((0.0, 0.0, 1.0)))

    def picture(self, samples: int) -> NDArray[np.uint8]:
        """The picture, shape (height, width, 3), sRGB; ``samples`` squared rays for each pixel, on all cores.

        Raises:
            WorkerDied: A process that draws a part of it ended.
        """
        bands = list(_bands(self._camera.height))
        rays = self._camera.width * self._camera.height * samples**2
        count = max(1, min(core_count(), rays // _RAYS_OF_A_PROCESS))
        shares = [bands[number::count] for number in range(count)]
        rows: dict[int, NDArray[np.uint8]] = {}
        with ExitStack() as running:
            workers = [
                running.enter_context(Worker(_DRAW)).submit(self._scene, self._camera, samples, share)
                for share in shares[1:]
            ]
            rows |= self.bands(shares[0], samples)
            for worker in workers:
                rows |= worker.result(DEFAULT_TIMEOUT)
        return np.concatenate([rows[first] for first, _ in bands])

    def bands(self, bands: Sequence[Band], samples: int) -> dict[int, NDArray[np.uint8]]:
        """Bands of rows in sRGB, by their first rows."""
        return {first: _encoded(self._rows(first, last, samples)) for first, last in bands}

    def triangles(self) -> NDArray[np.int32]:
        """The triangle that is visible in the middle of each pixel, shape (height, width); else ``BACKGROUND``."""
        rows = []
        for first, last in _bands(self._camera.height):
            directions = self._camera.directions(first, last, np.array((0.5, 0.5)))
            rows.append(self._cast(self._eyes(directions), directions).reshape(last - first, -1))
        return np.concatenate(rows)

    def hides(self, points: Array, slack: float) -> NDArray[np.bool_]:
        """Whether a surface is between the camera and each of points (n, 3), nearer by more than ``slack`` [m]."""
        away = points - self._camera.position
        directions = _unit(away)
        met = self._cast(self._eyes(directions), directions)
        hidden = np.zeros(len(points), dtype=bool)
        hit = np.flatnonzero(met >= 0)
        if hit.size:
            surface, _ = self._where(met[hit], directions[hit])
            nearer = np.linalg.norm(surface - self._camera.position, axis=1)
            hidden[hit] = nearer < np.linalg.norm(away[hit], axis=1) - slack
        return hidden

    def _rows(self, first: int, last: int, samples: int) -> Array:
        """Linear colours of the rows from ``first`` to ``last``, shape (last - first, width, 3)."""
        width, margin = self._camera.width, _TILE // 2
        start, stop = max(first - margin, 0), min(last + margin, self._camera.height)
        tile = _TILE * (np.arange(start, stop) % _TILE)[:, None] + np.arange(width) % _TILE
        total = np.zeros((stop - start, width, 3))
        for number in range(samples**2):
            directions = self._camera.directions(start, stop, _spread(number, 2))
            quadruples = _spread(tile.reshape(-1, 1) + _TILE**2 * number, 4)
            total += self._shade(directions, quadruples).reshape(total.shape)
        return total[first - start : last - start] / samples**2

    def _eyes(self, directions: Array) -> Array:
        return np.asarray(np.broadcast_to(self._camera.position, directions.shape))

    def _shade(self, directions: Array, quadruples: Array) -> Array:
        """Linear colours seen by rays from the camera, shape (n, 3), of whole rows; four numbers for each ray."""
        colors = np.broadcast_to(PAPER, directions.shape).copy()
        met = self._cast(self._eyes(directions), directions)
        points, flat, normals = (np.zeros(directions.shape) for _ in range(3))
        hit = np.flatnonzero(met >= 0)
        if hit.size:
            points[hit], flat[hit], normals[hit] = self._surface(met[hit], directions[hit])
        down = self._floor(directions, met, points)
        flat[down] = normals[down] = (0.0, 0.0, 1.0)
        shown = np.concatenate((hit, down))
        if not shown.size:
            return colors
        light = np.zeros((len(directions), 2))
        starts = points[shown] + _NEAR * self._size * flat[shown]
        light[shown] = self._light(starts, normals[shown], quadruples[shown])
        lit, sky = _averaged(light, points / self._size, normals, self._camera.width).T
        colors[hit] = self._surface_colors(met[hit], directions[hit], normals[hit], lit[hit], sky[hit])
        colors[down] = self._floor_colors(points[down], lit[down], sky[down])
        return colors

    def _surface(self, triangles: NDArray[np.int32], directions: Array) -> tuple[Array, Array, Array]:
        """Points on triangles, their flat normals towards the camera, and their smooth ones."""
        points, weights = self._where(triangles, directions)
        flat = _unit(np.cross(self._edges[0][triangles], self._edges[1][triangles]))
        flat *= -np.sign(np.einsum("ij,ij->i", flat, directions))[:, None]
        normals = _unit(np.einsum("ic,icj->ij", weights, self._normals[triangles]))
        normals = np.where(np.einsum("ij,ij->i", normals, flat)[:, None] > 0.0, normals, flat)
        return points, flat, normals

    def _surface_colors(
        self, triangles: NDArray[np.int32], directions: Array, normals: Array, lit: Array, sky: Array
    ) -> Array:
        half = _unit(self._sun - directions)
        facing = np.clip(normals @ self._sun, 0.0, 1.0)
        shine = np.clip(np.einsum("ij,ij->i", normals, half), 0.0, 1.0) ** _GLOSS_POWER * _GLOSS * (facing > 0.0)
        colors = self._scene.colors[triangles]
        rim = 0.10 * (1.0 + np.einsum("ij,ij->i", normals, directions)).clip(0.0, 1.0) ** 4
        return np.asarray(colors * (_SUN_LIGHT * facing * lit + sky)[:, None] + (lit * shine + rim * sky)[:, None])

    def _floor(self, directions: Array, met: NDArray[np.int32], points: Array) -> NDArray[np.intp]:
        """Rays that meet the floor near the robot; their ``points`` are set."""
        down = np.flatnonzero((met < 0) & (directions[:, 2] < -1e-6) & np.isfinite(self._scene.floor))
        if not down.size:
            return down
        eye = self._camera.position
        meets = eye + directions[down] * ((self._scene.floor - eye[2]) / directions[down, 2])[:, None]
        near = self._distance(meets) < 1.0
        points[down[near]] = meets[near]
        return down[near]

    def _floor_colors(self, points: Array, lit: Array, sky: Array) -> Array:
        """Linear colours of the floor: the background's, darker in shadows."""
        share = (0.42 * lit + 0.58 * sky / _SKY_LIGHT).clip(0.0, 1.0)
        fade = np.clip(2.5 * (1.0 - self._distance(points)), 0.0, 1.0)
        return np.asarray(PAPER * (1.0 - fade * 0.62 * (1.0 - share))[:, None])

    def _distance(self, points: Array) -> Array:
        """Horizontal distance from the target of the camera, relative to that at which the floor ends."""
        return np.asarray(np.linalg.norm(points[:, :2] - self._camera.target[:2], axis=1) / (1.3 * self._size))

    def _light(self, points: Array, normals: Array, quadruples: Array) -> Array:
        """Whether one point of the key light is visible, and the light of one point of the sky: shape (n, 2)."""
        angle, radius = 2 * np.pi * quadruples[:, 0], np.sqrt(quadruples[:, 1])
        a, b = _beside(self._sun[None, :])
        spread = _SUN_SPREAD * radius
        toward = _unit(self._sun + (spread * np.cos(angle))[:, None] * a + (spread * np.sin(angle))[:, None] * b)
        lit = self._free(points, toward, np.einsum("ij,ij->i", normals, toward) > 0.0)

        # One direction of a cosine lobe; a hit occludes the sky.
        angle, square = 2 * np.pi * quadruples[:, 2], quadruples[:, 3]
        a, b = _beside(normals)
        radius = np.sqrt(square)
        lobe = (radius * np.cos(angle))[:, None] * a + (radius * np.sin(angle))[:, None] * b
        lobe += np.sqrt(1.0 - square)[:, None] * normals
        free = self._free(points, lobe, np.ones(len(points), dtype=bool))
        height = 0.5 + 0.5 * lobe[:, 2]
        sky = free * (_GROUND_LIGHT + (_SKY_LIGHT - _GROUND_LIGHT) * height) + (1.0 - free) * 0.10
        return np.stack((lit, np.where(normals[:, 2] > 0.999, free * _SKY_LIGHT, sky)), axis=1)

    def _free(self, points: Array, directions: Array, wanted: NDArray[np.bool_]) -> Array:
        """1 for rays without a hit, else 0; also 0 for points that are not ``wanted``."""
        free = np.zeros(len(points))
        index = np.flatnonzero(wanted)
        if index.size:
            free[index] = self._cast(points[index], directions[index], "OCCLUDED") < 0
        return free

    def _cast(self, origins: Array, directions: Array, query: str = "INTERSECT") -> NDArray[np.int32]:
        """The first triangle that each ray hits, -1 for none; for ``OCCLUDED`` 0 for any triangle, which is faster."""
        starts, along = (np.ascontiguousarray(vectors, dtype=np.float32) for vectors in (origins, directions))
        met: NDArray[np.int32] = self._embree.run(starts, along, query=query)
        return met

    def _where(self, triangles: NDArray[np.int32], directions: Array) -> tuple[Array, Array]:
        """Intersections of camera rays with their triangles, and barycentric weights there (Moeller, Trumbore)."""
        a, b = self._edges[0][triangles], self._edges[1][triangles]
        p = np.cross(directions, b)
        s = self._camera.position - self._first[triangles]
        inverse = 1.0 / np.einsum("ij,ij->i", a, p)
        u = np.einsum("ij,ij->i", s, p) * inverse
        q = np.cross(s, a)
        v = np.einsum("ij,ij->i", directions, q) * inverse
        t = np.einsum("ij,ij->i", b, q) * inverse
        return self._camera.position + t[:, None] * directions, np.stack((1.0 - u - v, u, v), axis=1)


def draw_bands(scene: Scene, camera: Camera, samples: int, bands: Sequence[Band]) -> dict[int, NDArray[np.uint8]]:
    """Some rows of a picture in sRGB, by the first row of each band; to be called in a process of its own."""
    return Renderer(scene, camera).bands(bands, samples)


def _bands(height: int) -> Iterator[Band]:
    for first in range(0, height, _ROWS):
        yield first, min(first + _ROWS, height)


def _averaged(light: Array, points: Array, normals: Array, width: int) -> Array:
    """Light (n, k) of pixels in rows, averaged over the tile around each, on the surface that the pixel shows.

    Args:
        light: Shape (n, k).
        points: Shape (n, 3), relative to the size of the scene.
        normals: Shape (n, 3); zero for a pixel without a surface.
        width: Pixels of a row.
    """
    margin = _TILE // 2
    shown = np.flatnonzero(normals.any(axis=1).reshape(-1, width).any(axis=0))
    averaged = np.zeros((len(light) // width, width, light.shape[1]))
    if not shown.size:
        return averaged.reshape(light.shape)
    columns = slice(int(shown[0]), int(shown[-1]) + 1)
    planes = [
        [
            np.ascontiguousarray(values[:, axis].reshape(-1, width)[:, columns], np.float32)
            for axis in range(values.shape[1])
        ]
        for values in (light, points, normals)
    ]
    height, across = planes[0][0].shape
    values, places, ups = ([np.pad(plane, margin) for plane in of_pixels] for of_pixels in planes)
    normal, offset = planes[2], _inner(planes[1], planes[2])
    totals, count = [np.zeros_like(plane) for plane in planes[0]], np.zeros((height, across), np.float32)
    for dy, dx in np.ndindex(_TILE, _TILE):
        window = np.s_[dy : dy + height, dx : dx + across]
        same = _inner([up[window] for up in ups], normal) > _SAME_DIRECTION
        same &= np.abs(_inner([place[window] for place in places], normal) - offset) < _SAME_PLANE
        for total, value in zip(totals, values, strict=True):
            total += value[window] * same
        count += same
    averaged[:, columns] = np.stack(totals, axis=2) / np.maximum(count, 1.0)[..., None]
    return averaged.reshape(light.shape)


def _inner(a: Sequence[NDArray[np.float32]], b: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Inner products of vectors whose components are arrays of their own, which is faster than arrays of vectors."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _spread(number: int | NDArray[np.int64], dimensions: int) -> Array:
    """Points of the low-discrepancy sequence R_d in the unit cube (Roberts 2018), of shape (..., dimensions)."""
    phi = 2.0
    for _ in range(40):
        phi = (1.0 + phi) ** (1.0 / (dimensions + 1))
    return np.asarray((0.5 + number * phi ** -np.arange(1.0, dimensions + 1)) % 1.0)


def _beside(normals: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to each normal and to each other (Duff et al. 2017)."""
    sign = np.where(normals[:, 2] >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + normals[:, 2])
    b = normals[:, 0] * normals[:, 1] * a
    first = np.stack((1.0 + sign * normals[:, 0] ** 2 * a, sign * b, -sign * normals[:, 0]), axis=1)
    return first, np.stack((b, sign + normals[:, 1] ** 2 * a, -normals[:, 1]), axis=1)


def linear(srgb: Array) -> Array:
    """Linear light from sRGB values between 0 and 1."""
    return np.asarray(np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4))


def _encoded(light: Array) -> NDArray[np.uint8]:
    clipped = np.clip(light, 0.0, 1.0)
    srgb = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return np.round(255 * srgb).astype(np.uint8)
