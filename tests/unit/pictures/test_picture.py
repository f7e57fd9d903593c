"""Pictures as a whole: labels, exploded views, text, bytes."""

import io

import numpy as np
import pytest
import trimesh
from PIL import Image

from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import Pose
from stepbot.pictures.camera import VIEWS, camera_of
from stepbot.pictures.layout import Drawing, anchors
from stepbot.pictures.picture import AXIS_COLOR, NothingToDraw, Sheet, distinct_color, draw, png_bytes
from stepbot.pictures.scene import Axis, Shape, Subject, exploded

SMALL = Sheet(400, 300, samples=1, view=VIEWS["front"])


def cube(y: float, owner: int) -> Shape:
    """A cube beside the middle of the picture."""
    box = trimesh.creation.box(extents=(0.2, 0.2, 0.2))
    return Shape(TriMesh.of(box.vertices, box.faces), Pose.of(position=(0, y, 0)), np.array((0.8, 0.4, 0.1)), owner)


def two_cubes(**more: object) -> Subject:
    """Two cubes side by side."""
    return Subject((cube(-0.3, 0), cube(0.3, 1)), ("left part", "right part"), **more)  # type: ignore[arg-type]


def test_names_are_where_their_shapes_are_in_the_picture() -> None:
    """The place of the name of a ball is the middle of its disc."""
    ball = trimesh.creation.icosphere(4, radius=0.1)
    mesh, middles = TriMesh.of(ball.vertices, ball.faces), [(0.0, -0.3, 0.1), (0.0, 0.3, -0.1)]
    shapes = [Shape(mesh, Pose.of(position=middle), np.ones(3), i) for i, middle in enumerate(middles)]
    picture = draw(Subject(tuple(shapes), ("a", "b")), SMALL)
    points = np.concatenate([mesh.vertices + middle for middle in middles])
    expected = camera_of(points, VIEWS["front"], 400, 300).project(middles)
    np.testing.assert_allclose([picture.places["a"], picture.places["b"]], expected, atol=1.5)


def test_a_name_behind_another_is_reported() -> None:
    """What the picture does not show is listed."""
    behind = Subject((cube(0.0, 0), Shape(cube(0.0, 0).mesh, Pose.of(position=(-1, 0, 0)), np.ones(3), 1)), ("a", "b"))
    picture = draw(behind, SMALL)
    assert (picture.hidden, set(picture.places)) == (("b",), {"a"})


def test_labels_are_beside_the_robot() -> None:
    """There is ink in both columns, which the shapes leave free."""
    picture = draw(two_cubes(), Sheet(600, 300, samples=1, view=VIEWS["front"], labels=True))
    for column in (picture.pixels[:, :60].astype(int), picture.pixels[:, -60:].astype(int)):
        assert column.min() < 100
        assert not (column[..., 0] > column[..., 2] + 60).any()  # the cubes are orange


def test_an_axis_is_drawn_through_its_point() -> None:
    """Between the cubes, a vertical line of the colour of axes, as long as a share of the scene."""
    axis = Axis("hinge", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), turns=False, slides=False)
    sheet = Sheet(600, 300, samples=1, view=VIEWS["front"], labels=True)
    red = (np.abs(draw(two_cubes(axes=(axis,)), sheet).pixels.astype(int) - AXIS_COLOR) < 12).all(axis=2)
    rows = np.nonzero(red[:, 299:301].any(axis=1))[0]
    assert len(rows) > 20
    assert (rows.min() + rows.max()) / 2 == pytest.approx(149.5, abs=2.0)


def test_more_labels_than_room_are_reported() -> None:
    """The smallest names have no label, and are listed."""
    shapes, names = [], []
    for i in range(40):
        size = 0.02 + 0.002 * i
        box = trimesh.creation.box(extents=(size, size, size))
        place = Pose.of(position=(0, 0.15 * (i % 8), 0.15 * (i // 8)))
        shapes.append(Shape(TriMesh.of(box.vertices, box.faces), place, np.ones(3), i))
        names.append(f"part {i:02d}")
    sheet = Sheet(400, 200, samples=1, view=VIEWS["front"], labels=True)
    picture = draw(Subject(tuple(shapes), tuple(names)), sheet)
    assert picture.unlabelled == tuple(names[: len(picture.unlabelled)])
    assert 0 < len(picture.unlabelled) < 40


def test_a_subject_without_surface_cannot_be_drawn() -> None:
    """There is an error instead of an empty picture."""
    with pytest.raises(NothingToDraw):
        draw(Subject((), ("base",)), SMALL)


@pytest.mark.slow
def test_a_file_has_the_same_bytes_again_and_the_pixels_of_the_picture() -> None:
    """PNG is lossless and has no time in it; text chunks are kept."""
    sheet = Sheet(200, 150, samples=2, labels=True)
    first, second = (png_bytes(draw(two_cubes(), sheet).pixels, {"made-from": "abc"}) for _ in range(2))
    assert first == second
    read = Image.open(io.BytesIO(first))
    np.testing.assert_array_equal(np.asarray(read), draw(two_cubes(), sheet).pixels)
    assert read.text == {"made-from": "abc"}


def test_characters_without_a_glyph_are_escaped() -> None:
    """Names in other scripts stay distinguishable; no two become the same boxes."""
    drawing = Drawing(np.zeros((10, 10, 3), dtype=np.uint8), 12)
    assert drawing.legible("arm_1 (left)") == "arm_1 (left)"
    assert drawing.legible("плечо") == r"\u043f\u043b\u0435\u0447\u043e"
    assert drawing.legible("a\x1bb") == r"a\x1bb"


def test_a_long_name_loses_its_middle() -> None:
    """The ellipsis is part of the width; the end, which has the number of equal parts, is kept."""
    drawing = Drawing(np.zeros((10, 10, 3), dtype=np.uint8), 12)
    name = drawing.shortened("a_very_long_name_of_a_component x16", 100.0)
    assert name.startswith("a_very")
    assert name.endswith("x16")
    assert "..." in name
    assert 80.0 < drawing.width_of(name) <= 100.0
    assert drawing.shortened("short", 100.0) == "short"


@pytest.mark.slow
def test_long_names_stay_distinct() -> None:
    """Names that differ in the part that would be left out keep it; one that no share tells apart is shortened, too."""
    drawing = Drawing(np.zeros((1, 1, 3), dtype=np.uint8), 12)
    names = ["Follower_Gripper_Static_Part_joint", "Follower_Gripper_Moving_Part_joint", "Follower_Base", "a" * 50]
    shown = drawing.shortened_names(dict.fromkeys(names, 130.0))
    assert shown["Follower_Base"] == "Follower_Base"
    assert len(set(shown.values())) == 4
    assert all("..." in shown[name] for name in names if name != "Follower_Base")
    assert all(drawing.width_of(text) <= 130.0 for text in shown.values())
    alike = drawing.shortened_names({f"{'x' * 40}{number}{'x' * 40}": 100.0 for number in (1, 2)})
    assert len(set(alike.values())) == 1


def test_the_place_of_a_name_is_inside_its_outline() -> None:
    """For an L, whose centroid is outside of it, too."""
    visible = np.full((40, 40), -1, dtype=np.int32)
    visible[2:38, 2:8] = 0
    visible[32:38, 2:38] = 0
    visible[5:9, 20:24] = 3
    found = anchors(visible)
    assert set(found) == {0, 3}
    x, y = found[0]
    assert visible[int(y), int(x)] == 0
    assert found[3] == pytest.approx((22.0, 7.0), abs=1.0)


def test_parts_move_away_from_the_middle_of_their_assembly() -> None:
    """Displacements add up from the root down, and end at the units, whose parts stay together."""
    root, left, right = [(-2, -1, 0), (2, 1, 0)], [(-2, -1, 0), (0, 1, 0)], [(0, -1, 0), (2, 1, 0)]
    above, below, empty = [(0, 0, 0), (2, 1, 0)], [(0, -1, 0), (2, 0, 0)], [(np.nan,) * 3] * 2
    boxes = np.array([root, left, right, above, below, empty], dtype=float)
    parents = [-1, 0, 0, 2, 2, 0]
    moves = exploded(boxes, parents, units=(1, 3, 4), apart=0.5)
    expected = [(0, 0, 0), (-0.5, 0, 0), (0.5, 0, 0), (0.5, 0.25, 0), (0.5, -0.25, 0), (0, 0, 0)]
    np.testing.assert_allclose(moves, expected)
    together = exploded(boxes, parents, units=(1, 2), apart=0.5)
    np.testing.assert_allclose(together[3:5], [(0.5, 0, 0), (0.5, 0, 0)])


def test_colors_of_neighbours_differ() -> None:
    """Successive colours are at least 0.15 apart in sRGB, within the range of sRGB."""
    colors = np.array([distinct_color(i) for i in range(64)])
    assert ((colors >= 0.0) & (colors <= 1.0)).all()
    assert np.linalg.norm(np.diff(colors, axis=0), axis=1).min() > 0.15
