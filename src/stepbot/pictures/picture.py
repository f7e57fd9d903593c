"""A picture of a subject, with or without labels, as the bytes of a PNG file."""

import io
from collections.abc import Iterator
from colorsys import hls_to_rgb

import numpy as np
from msgspec import Struct, field
from numpy.typing import ArrayLike, NDArray

from stepbot.geometry.spatial import Array, perpendicular_frame

from .camera import VIEWS, Camera, View, camera_of
from .layout import Color, Columns, Drawing, LabelRequest, Place, PlacedLabel, anchors, extent, placed
from .raytrace import Renderer, Scene
from .scene import Axis, Subject, scene_of

AXIS_COLOR: Color = (196, 64, 16)
_FAINT = 0.38
_HALF = 0.085
"""Half the length of an axis, relative to the size of the scene."""
_RADIUS = 0.032
"""Radius of the arrow about it, likewise."""
_SWEEP = np.radians(280.0)
_PIECES = 48
_WIDTH = 2.2
_SLACK = 2e-3


def draw_axis(drawing: Drawing, renderer: Renderer, camera: Camera, axis: Axis, size: float) -> None:
    """Draw the axis of a joint; what is behind a surface is faint.

    Args:
        renderer: The scene, which hides parts of the axis.
        size: Of the scene [m].
    """
    middle, direction = np.array(axis.point), np.array(axis.direction)
    along = np.linspace(-_HALF, _HALF, _PIECES)[:, None] * size
    _draw_curve(drawing, renderer, camera, middle + along * direction, size)
    ends = _places(camera, middle + np.array(((_HALF,), (-_HALF,))) * size * direction)
    if axis.slides:
        drawing.arrowhead(ends[0], ends[1], 12.0, AXIS_COLOR)
    if axis.turns:
        arc = _arc(middle + 0.55 * _HALF * size * direction, direction, _RADIUS * size)
        _draw_curve(drawing, renderer, camera, arc, size)
        tip = _places(camera, arc[-2:])
        drawing.arrowhead(tip[1], tip[0], 10.0, AXIS_COLOR)


def _draw_curve(drawing: Drawing, renderer: Renderer, camera: Camera, points: Array, size: float) -> None:
    hidden = renderer.hides((points[:-1] + points[1:]) / 2, _SLACK * size)
    places = _places(camera, points)
    for first, last, faint in _runs(hidden.tolist()):
        drawing.line(places[first : last + 1], AXIS_COLOR, _WIDTH, _FAINT if faint else 1.0)


def _runs(flags: list[bool]) -> Iterator[tuple[int, int, bool]]:
    """Start, end and value of each run of equal flags."""
    first = 0
    for i in range(1, len(flags) + 1):
        if i == len(flags) or flags[i] != flags[first]:
            yield first, i, flags[first]
            first = i


def _arc(centre: Array, direction: Array, radius: float) -> Array:
    """Points of a circle about a direction, by the right-hand rule."""
    R = perpendicular_frame(direction)
    angles = np.linspace(0.0, _SWEEP, _PIECES)[:, None]
    return centre + radius * (np.cos(angles) * R[:, 0] + np.sin(angles) * R[:, 1])


def _places(camera: Camera, points: ArrayLike) -> list[Place]:
    return [(x, y) for x, y in camera.project(points).tolist()]


_GOLDEN = 0.6180339887498949
"""Multiples of the golden ratio are spread evenly over the circle of hues, however many there are."""
_FIRST = 0.58


def distinct_color(number: int) -> Array:
    """A muted colour, sRGB, shape (3,)."""
    lightness, saturation = (0.66, 0.74, 0.58)[number % 3], (0.34, 0.28, 0.36)[number % 3]
    return np.array(hls_to_rgb((_FIRST + number * _GOLDEN) % 1.0, lightness, saturation))


PACKAGES = ("embreex", "PIL", "scipy")
"""What drawing imports, in addition to stepbot's own dependencies."""
_LINK_COLOR: Color = (38, 42, 48)
_LEADER: Color = (84, 88, 95)
_GAP = 14.0
"""Between a label and its leader line, and between labels and the picture's edge [px]."""
_INSET = 0.4
"""Between a leader line and its text, relative to the size of the text."""
_WIDEST_COLUMN = 0.24
"""Share of the picture's width that a column of labels may take."""


class NothingToDraw(ValueError):
    """The subject has no surface."""


class Sheet(Struct, frozen=True):
    """The form of a picture."""

    width: int = 1200
    """[px]."""
    height: int = 900
    """[px]."""
    samples: int = 3
    """Square root of the number of rays for each pixel."""
    view: View = VIEWS["corner"]
    labels: bool = False

    @property
    def text_size(self) -> int:
        """Of the letters [px]."""
        return max(11, round(self.height / 46))


class Picture(Struct, frozen=True, eq=False):
    """A drawn picture."""

    pixels: NDArray[np.uint8]
    """Shape (height, width, 3), sRGB."""
    hidden: tuple[str, ...] = ()
    """Names whose shapes are not visible in it."""
    places: dict[str, Place] = field(default_factory=dict)
    """Where each visible name is in it [px]."""
    unlabelled: tuple[str, ...] = ()
    """Names that have no label because there is no room for all."""


def draw(subject: Subject, sheet: Sheet) -> Picture:
    """Draw a subject.

    Raises:
        NothingToDraw: No shape of the subject has a surface.
        ModuleNotFoundError: A package of the extra ``render`` is missing.
    """
    scene = scene_of(subject, sheet.view)
    if scene is None:
        raise NothingToDraw("nothing to draw: no visible part has a surface")
    room = 1.0 - 2.0 * _column_share(subject, sheet) if sheet.labels else 1.0
    camera = camera_of(scene.vertices, sheet.view, sheet.width, sheet.height, room)
    renderer = Renderer(scene, camera)
    triangles = renderer.triangles()
    visible = np.where(triangles >= 0, scene.owners[triangles], -1)
    places = anchors(visible)
    pixels = renderer.picture(sheet.samples)
    unlabelled: tuple[str, ...] = ()
    if sheet.labels:
        drawing = Drawing(pixels, sheet.text_size)
        size = float(np.linalg.norm(np.ptp(scene.vertices, axis=0)))
        for axis in subject.axes:
            draw_axis(drawing, renderer, camera, axis, size)
        unlabelled = _label(drawing, subject, scene, camera, sheet, visible, places)
        pixels = drawing.done()
    drawn = set(scene.owners.tolist())
    hidden = tuple(name for owner, name in enumerate(subject.names) if owner in drawn and owner not in places)
    return Picture(pixels, hidden, {subject.names[owner]: place for owner, place in places.items()}, unlabelled)


def png_bytes(pixels: NDArray[np.uint8], texts: dict[str, str] | None = None) -> bytes:
    """A PNG file of a picture, shape (height, width, 3), with text chunks."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    for keyword, text in (texts or {}).items():
        info.add_text(keyword, text)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG", pnginfo=info, optimize=True)
    return file.getvalue()


def _label(
    drawing: Drawing,
    subject: Subject,
    scene: Scene,
    camera: Camera,
    sheet: Sheet,
    visible: NDArray[np.int32],
    places: dict[int, Place],
) -> tuple[str, ...]:
    """Add the labels; returns the names for which there is no room."""
    wanted = _wanted(subject, scene, camera, places)
    size = sheet.text_size
    left, _, right, _ = extent(visible)
    column = _column_share(subject, sheet) * sheet.width
    columns = Columns(
        min(left - _GAP, max(column, _GAP)),
        max(right + _GAP, sheet.width - max(column, _GAP)),
        top=size,
        bottom=sheet.height - size,
        pitch=1.45 * size,
    )
    kept = _most_important(wanted, columns.capacity, visible, places, subject)
    labels = placed(kept, columns)
    rooms: dict[str, float] = {}
    for label in labels:
        room = (columns.left if label.on_left else sheet.width - columns.right) - _INSET * size - 0.4 * _GAP
        rooms[label.label.text] = min(room, rooms.get(label.label.text, room))
    shown = drawing.shortened_names(rooms)
    for label in labels:
        _draw_label(drawing, label, shown[label.label.text], columns, size)
    texts = {label.text for label in kept}
    return tuple(label.text for label in wanted if label.text not in texts)


def _wanted(subject: Subject, scene: Scene, camera: Camera, places: dict[int, Place]) -> list[LabelRequest]:
    labels = []
    for owner in dict.fromkeys(scene.owners.tolist()):
        if owner in places:
            labels.append(LabelRequest(subject.names[owner], places[owner]))
            continue
        points = scene.vertices[np.unique(scene.triangles[scene.owners == owner])]
        (place,) = _places(camera, 0.5 * (points.min(axis=0) + points.max(axis=0)))
        labels.append(LabelRequest(subject.names[owner], place, hidden=True))
    labels += [LabelRequest(axis.name, _places(camera, axis.point)[0], kind="joint") for axis in subject.axes]
    return labels


def _most_important(
    labels: list[LabelRequest], most: int, visible: NDArray[np.int32], places: dict[int, Place], subject: Subject
) -> list[LabelRequest]:
    """Up to ``most`` labels: joints first, then names by visible area."""
    if len(labels) <= most:
        return labels
    areas = np.bincount(visible[visible >= 0].ravel(), minlength=len(subject.names))
    area_of = {subject.names[owner]: int(areas[owner]) for owner in places}
    ranked = sorted(labels, key=lambda label: (label.kind != "joint", -area_of.get(label.text, 0), label.text))
    kept = set(map(id, ranked[:most]))
    return [label for label in labels if id(label) in kept]


def _draw_label(drawing: Drawing, label: PlacedLabel, text: str, columns: Columns, size: float) -> None:
    wanted, joint = label.label, label.label.kind == "joint"
    x = columns.left if label.on_left else columns.right
    outward = -1.0 if label.on_left else 1.0
    color = AXIS_COLOR if joint else _LINK_COLOR
    line_color = AXIS_COLOR if joint else _LEADER
    start = (x, label.y)
    if wanted.hidden:
        drawing.dashes(start, wanted.anchor, line_color, 1.2)
    else:
        drawing.line([start, wanted.anchor], line_color, 1.2)
    drawing.dot(wanted.anchor, 0.16 * size, color, filled=not wanted.hidden)
    drawing.text((x + outward * _INSET * size, label.y), text, color, anchor="rm" if label.on_left else "lm")


def _column_share(subject: Subject, sheet: Sheet) -> float:
    """Share of the picture's width that a column of labels takes."""
    drawing = Drawing(np.zeros((1, 1, 3), dtype=np.uint8), sheet.text_size)
    names = [*subject.names, *(axis.name for axis in subject.axes)]
    widest = max((drawing.width_of(name) for name in names), default=0.0)
    return min(_WIDEST_COLUMN, (widest + 2 * _GAP + 0.4 * sheet.text_size) / sheet.width)
