"""Silhouettes, hidden points and light, against closed forms."""

from math import asin, pi, tan

import numpy as np
import pytest
import trimesh

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Pose
from stepbot.pictures import raytrace
from stepbot.pictures.camera import TANGENT, VIEWS, View, camera_of
from stepbot.pictures.raytrace import BACKGROUND, Renderer, Scene
from stepbot.pictures.scene import Shape, Subject, scene_of
from stepbot.runtime.worker import Worker

GREY = np.array((0.5, 0.5, 0.5))
WIDTH, HEIGHT = 320, 240


def shape(mesh: trimesh.Trimesh, X_WG: Pose = IDENTITY, owner: int = 0) -> Shape:
    """A grey shape."""
    return Shape(TriMesh.of(mesh.vertices, mesh.faces), X_WG, GREY, owner)


def scene_with(*shapes: Shape, view: View = VIEWS["front"]) -> Scene:
    """The triangles of shapes, with a name for each."""
    found = scene_of(Subject(shapes, tuple(f"link_{i}" for i in range(len(shapes)))), view)
    assert found is not None
    return found


def test_the_silhouette_of_a_sphere_has_its_area() -> None:
    """A sphere of radius r at distance d is a disc of radius tan(asin(r / d)) at distance 1."""
    scene = scene_with(shape(trimesh.creation.icosphere(5, radius=0.3)))
    camera = camera_of(scene.vertices, VIEWS["front"], WIDTH, HEIGHT)
    distance = float(np.linalg.norm(camera.position))
    radius = tan(asin(0.3 / distance)) / TANGENT * HEIGHT / 2
    count = np.count_nonzero(Renderer(scene, camera).triangles() != BACKGROUND)
    assert count == pytest.approx(pi * radius**2, rel=3e-3)


@pytest.mark.parametrize("view", ["front", "left", "top"])
def test_the_silhouette_of_a_box_is_its_near_face(view: str) -> None:
    """Seen along an axis, a box is the rectangle of its near face: rows and columns to the pixel."""
    size = np.array((0.4, 0.6, 0.3))
    scene = scene_with(shape(trimesh.creation.box(extents=size)), view=VIEWS[view])
    camera = camera_of(scene.vertices, VIEWS[view], WIDTH, HEIGHT)
    depth, across, up = {"front": (0, 1, 2), "left": (1, 0, 2), "top": (2, 1, 0)}[view]
    scale = HEIGHT / TANGENT / 2 / (float(np.linalg.norm(camera.position)) - size[depth] / 2)
    rows, columns = np.nonzero(Renderer(scene, camera).triangles() != BACKGROUND)
    assert columns.max() - columns.min() + 1 == pytest.approx(scale * size[across], abs=1.0)
    assert rows.max() - rows.min() + 1 == pytest.approx(scale * size[up], abs=1.0)
    assert len(rows) == (columns.max() - columns.min() + 1) * (rows.max() - rows.min() + 1)


def test_points_behind_a_surface_are_hidden() -> None:
    """A box hides what is behind and inside of it, not what is in front of or beside it."""
    scene = scene_with(shape(trimesh.creation.box(extents=(0.2, 0.2, 0.2))))
    camera = camera_of(scene.vertices, VIEWS["front"], WIDTH, HEIGHT)
    points = np.array([(-0.5, 0, 0), (0, 0, 0), (0.09, 0, 0), (0.11, 0, 0), (0.3, 0, 0), (0, 0.15, 0)])
    assert Renderer(scene, camera).hides(points, 1e-4).tolist() == [True, True, True, False, False, False]


def test_the_nearer_of_two_shapes_is_visible() -> None:
    """The owner of the visible triangle is the shape nearer to the camera."""
    box = trimesh.creation.box(extents=(0.1, 0.1, 0.1))
    found = scene_with(shape(box, Pose.of(position=(-0.5, 0, 0)), 0), shape(box, Pose.of(position=(0.5, 0, 0)), 1))
    camera = camera_of(found.vertices, VIEWS["front"], WIDTH, HEIGHT)
    assert found.owners[Renderer(found, camera).triangles()[HEIGHT // 2, WIDTH // 2]] == 1


@pytest.mark.slow
def test_the_background_is_plain_and_shadows_are_dark() -> None:
    """Above the horizon every pixel is paper; in the shadow of a box on the floor it is darker."""
    found = scene_with(shape(trimesh.creation.box(extents=(0.2, 0.2, 0.2))), view=View(0.0, 20.0))
    camera = camera_of(found.vertices, View(0.0, 20.0), WIDTH, HEIGHT)
    picture = Renderer(found, camera).picture(2)
    paper = picture[0, 0]
    assert (picture[0] == paper).all()
    (beside,) = np.rint(camera.project((0.0, 0.12, -0.1))).astype(int)  # the key light comes from the left
    assert picture[beside[1], beside[0]].max() < paper.min() - 40


@pytest.mark.long
def test_soft_light_has_no_noise() -> None:
    """On a ball and in the penumbra of its shadow, no pixel differs from the mean of its neighbours by 2 levels."""
    view = VIEWS["corner"]
    found = scene_with(shape(trimesh.creation.icosphere(5, radius=0.3)), view=view)
    camera = camera_of(found.vertices, view, WIDTH, HEIGHT)
    renderer = Renderer(found, camera)
    grey = renderer.picture(3).mean(axis=2)
    around = np.stack([np.roll(grey, shift, axis) for axis in (0, 1) for shift in (-1, 1)])
    seen = renderer.triangles() != BACKGROUND
    near = np.stack([np.roll(seen, (y, x), (0, 1)) for y in range(-3, 4) for x in range(-3, 4)])
    inside = near.all(axis=0) | ~near.any(axis=0)
    inside[[0, -1]] = inside[:, [0, -1]] = False
    assert np.ptp(grey[inside & ~seen]) > 20  # there is a shadow
    assert np.ptp(grey[inside & seen]) > 60
    assert np.abs(grey - around.mean(axis=0))[inside].max() < 2.0


def test_a_scene_gives_the_same_pixels_again() -> None:
    """Nothing in the light is random."""
    found = scene_with(shape(trimesh.creation.icosphere(2, radius=0.3)), view=VIEWS["corner"])
    camera = camera_of(found.vertices, VIEWS["corner"], 80, 60)
    first, second = (Renderer(found, camera).picture(2) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_processes_draw_the_same_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture whose bands three processes draw is that of one process."""
    found = scene_with(shape(trimesh.creation.icosphere(2, radius=0.3)), view=VIEWS["corner"])
    camera = camera_of(found.vertices, VIEWS["corner"], 160, 120)
    alone = Renderer(found, camera).picture(1)
    monkeypatch.setattr(raytrace, "_RAYS_OF_A_PROCESS", 160 * 40)
    monkeypatch.setattr(raytrace, "core_count", lambda: 8)
    started = []
    monkeypatch.setattr(raytrace, "Worker", lambda function: started.append(function) or Worker(function))
    np.testing.assert_array_equal(Renderer(found, camera).picture(1), alone)
    assert len(started) == 2
