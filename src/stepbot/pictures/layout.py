"""Places labels in two columns beside the picture, close to what they name, without overlaps and crossings.

Each label goes to the column on the side of its anchor while there is room. In a column, labels are in the order in
which no two leader lines cross; their heights are the least-squares solution that keeps the distance between them.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations
from math import hypot

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

Place = tuple[float, float]
"""[px], x to the right, y down."""
Color = tuple[int, int, int]

_FINER = 4
_PAPER: Color = (246, 246, 247)
_HALO = 2
_DASH = 4.0
_ELLIPSIS = "..."
_TAILS = (0.4, 0.6, 0.8, 0.2)
"""Shares of the end of a shortened name, until no other name looks the same."""
_MISSING = "\uffff"
"""A character that no font has."""


class Drawing:
    """A picture that lines and text are added to."""

    def __init__(self, picture: NDArray[np.uint8], text_size: int) -> None:
        """Draw on a picture, shape (height, width, 3), with letters of ``text_size`` pixels."""
        from PIL import Image, ImageDraw, ImageFont

        height, width = picture.shape[:2]
        self._base = Image.fromarray(picture)
        self._lines = Image.new("RGBA", (_FINER * width, _FINER * height))
        self._pen = ImageDraw.Draw(self._lines)
        self._texts: list[tuple[Place, str, Color, str]] = []
        font = ImageFont.load_default(text_size)
        if not isinstance(font, ImageFont.FreeTypeFont):
            raise ModuleNotFoundError("Pillow was built without FreeType", name="PIL")
        self._font = font

    def line(self, points: Sequence[Place], color: Color, width: float, opacity: float = 1.0) -> None:
        """A polyline with round joints."""
        finer = [(_FINER * x, _FINER * y) for x, y in points]
        ink = (*color, round(255 * opacity))
        self._pen.line(finer, fill=ink, width=max(1, round(_FINER * width)), joint="curve")

    def dashes(self, start: Place, end: Place, color: Color, width: float) -> None:
        """A dashed line."""
        length = hypot(end[0] - start[0], end[1] - start[1])
        for number in range(int(length / (2 * _DASH)) + 1):
            a, b = 2 * number * _DASH, min((2 * number + 1) * _DASH, length)
            if b > a:
                self.line([_between(start, end, a / length), _between(start, end, b / length)], color, width)

    def dot(self, at: Place, radius: float, color: Color, *, filled: bool = True) -> None:
        """A disc with a light rim, or a ring."""
        x, y = _FINER * at[0], _FINER * at[1]
        r, rim = _FINER * radius, _FINER * 1.2
        if filled:
            self._pen.ellipse((x - r - rim, y - r - rim, x + r + rim, y + r + rim), fill=(*_PAPER, 255))
            self._pen.ellipse((x - r, y - r, x + r, y + r), fill=(*color, 255))
        else:
            self._pen.ellipse((x - r, y - r, x + r, y + r), outline=(*color, 255), width=round(_FINER * 1.4))

    def arrowhead(self, tip: Place, origin: Place, size: float, color: Color) -> None:
        """A triangle at ``tip`` that points away from ``origin``."""
        dx, dy = tip[0] - origin[0], tip[1] - origin[1]
        length = hypot(dx, dy)
        if length < 1e-9:
            return
        dx, dy = dx / length, dy / length
        corners = [
            (tip[0] + 0.6 * size * dx, tip[1] + 0.6 * size * dy),
            (tip[0] - 0.6 * size * dx - 0.5 * size * dy, tip[1] - 0.6 * size * dy + 0.5 * size * dx),
            (tip[0] - 0.6 * size * dx + 0.5 * size * dy, tip[1] - 0.6 * size * dy - 0.5 * size * dx),
        ]
        self._pen.polygon([(_FINER * x, _FINER * y) for x, y in corners], fill=(*color, 255))

    def text(self, at: Place, text: str, color: Color, *, anchor: str) -> None:
        """Text over everything else; ``anchor`` as Pillow's: ``lm`` has ``at`` at the left in the middle."""
        self._texts.append((at, self.legible(text), color, anchor))

    def width_of(self, text: str) -> float:
        """Width of a text [px]."""
        return float(self._font.getlength(self.legible(text)))

    def shortened_names(self, widths: Mapping[str, float]) -> dict[str, str]:
        """Each name within its width [px]; names that would look the same keep more or less of their ends."""
        shown: dict[str, str] = {}
        left = dict(widths)
        for share in _TAILS:
            shown |= {name: self.shortened(name, width, share) for name, width in left.items()}
            count = Counter(shown.values())
            left = {name: width for name, width in widths.items() if count[shown[name]] > 1}
        return shown

    def shortened(self, text: str, width: float, tail_share: float = 0.4) -> str:
        """``text`` in ``width`` pixels, with an ellipsis for its middle: the end often has a number.

        Args:
            width: [px].
            tail_share: Share of the end in the characters that are kept.
        """
        text = self.legible(text)
        kept = len(text)
        shown = text
        while kept and self.width_of(shown) > width:
            kept -= 1
            tail = int(kept * tail_share)
            shown = f"{text[: kept - tail].rstrip()}{_ELLIPSIS}{text[len(text) - tail :].lstrip()}"
        return shown

    def legible(self, text: str) -> str:
        """``text`` with characters that the font lacks as Python escapes."""
        return "".join(c if self._has(c) else c.encode("unicode_escape").decode("ascii") for c in text)

    def done(self) -> NDArray[np.uint8]:
        """The picture, shape (height, width, 3)."""
        from PIL import Image, ImageDraw

        # Averaged with premultiplied colours: transparent black must not darken the edges.
        overlay = self._lines.convert("RGBa").resize(self._base.size, Image.Resampling.BOX).convert("RGBA")
        result: Image.Image = Image.alpha_composite(self._base.convert("RGBA"), overlay)
        pen = ImageDraw.Draw(result)
        for at, text, color, anchor in self._texts:
            pen.text(
                at, text, fill=color, font=self._font, anchor=anchor, stroke_width=_HALO, stroke_fill=(*_PAPER, 255)
            )
            pen.text(at, text, fill=color, font=self._font, anchor=anchor)
        return np.asarray(result.convert("RGB"))

    def _has(self, character: str) -> bool:
        return character == " " or (character.isprintable() and self._bitmap(character) != self._no_glyph)

    @cached_property
    def _no_glyph(self) -> bytes:
        return self._bitmap(_MISSING)

    def _bitmap(self, character: str) -> bytes:
        return bytes(self._font.getmask(character))


def _between(a: Place, b: Place, share: float) -> Place:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def anchors(visible: NDArray[np.int32]) -> dict[int, Place]:
    """A place well inside the visible area of each owner.

    Args:
        visible: Owner of each pixel, shape (height, width); negative for none.

    Returns:
        Owners with at least one pixel, and a place in the picture.
    """
    from scipy.ndimage import distance_transform_edt, find_objects

    places: dict[int, Place] = {}
    for owner, window in enumerate(find_objects(visible + 1)):
        if window is None:
            continue
        mask = np.pad(visible[window] == owner, 1)
        depth = distance_transform_edt(mask)
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        places[owner] = (float(window[1].start + column - 1) + 0.5, float(window[0].start + row - 1) + 0.5)
    return places


def extent(visible: NDArray[np.int32]) -> tuple[float, float, float, float]:
    """Left, top, right and bottom [px] of everything that is visible; the whole picture if nothing is."""
    rows, columns = np.nonzero(visible >= 0)
    if not len(rows):
        return 0.0, 0.0, float(visible.shape[1]), float(visible.shape[0])
    return float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1)


class LabelRequest(Struct, frozen=True):
    """A label to place."""

    text: str
    anchor: Place
    """Where its leader line ends."""
    kind: str = "link"
    """``link`` or ``joint``: its colour."""
    hidden: bool = False
    """Whether what it names is behind something else."""


class PlacedLabel(Struct, frozen=True):
    """A label in a column."""

    label: LabelRequest
    on_left: bool
    y: float
    """Middle of the text [px]."""


class Columns(Struct, frozen=True):
    """Where labels may be [px]."""

    left: float
    """x of the inner edge of the left column, where its leader lines start."""
    right: float
    """x of the inner edge of the right column."""
    top: float
    bottom: float
    pitch: float
    """Smallest distance between the middles of two labels."""

    @property
    def capacity(self) -> int:
        """Number of labels that both columns hold."""
        return 2 * (int((self.bottom - self.top) / self.pitch) + 1)


def placed(labels: Sequence[LabelRequest], columns: Columns) -> list[PlacedLabel]:
    """The labels in two columns."""
    left, right = _sides(labels, columns)
    placed_labels = []
    for side, x, on_left in ((left, columns.left, True), (right, columns.right, False)):
        ordered = sorted(side, key=lambda label: (label.anchor[1], label.anchor[0], label.text))
        heights = _spread([label.anchor[1] for label in ordered], columns)
        placed_labels += [
            PlacedLabel(label, on_left, y) for label, y in zip(_untangled(ordered, heights, x), heights, strict=True)
        ]
    return placed_labels


def _sides(labels: Sequence[LabelRequest], columns: Columns) -> tuple[list[LabelRequest], list[LabelRequest]]:
    """The labels of the left and of the right column; those near the middle balance the columns."""
    ordered = sorted(labels, key=lambda label: (label.anchor[0], label.anchor[1], label.text))
    middle, most = (columns.left + columns.right) / 2, columns.capacity // 2
    natural = sum(label.anchor[0] < middle for label in ordered)
    half, slack = len(ordered) / 2, max(1, len(ordered) // 8)
    count = int(min(max(natural, half - slack, len(ordered) - most), half + slack, max(most, half)))
    return ordered[:count], ordered[count:]


def _untangled(labels: list[LabelRequest], heights: Sequence[float], x: float) -> list[LabelRequest]:
    """Exchange labels while that shortens the leader lines: lines of least total length do not cross."""

    def length(label: LabelRequest, y: float) -> float:
        return hypot(label.anchor[0] - x, label.anchor[1] - y)

    moved = list(labels)
    shortened = True
    while shortened:
        shortened = False
        for (i, a), (j, b) in combinations(enumerate(heights), 2):
            kept = length(moved[i], a) + length(moved[j], b)
            if length(moved[j], a) + length(moved[i], b) < kept - 1e-9:
                moved[i], moved[j] = moved[j], moved[i]
                shortened = True
    return moved


def _spread(wanted: Sequence[float], columns: Columns) -> list[float]:
    """Heights with at least the pitch between them, as close as possible to the wanted ones (pool adjacent violators).

    If the column is too short for all of them, they share it evenly.
    """
    count, top, bottom, pitch = len(wanted), columns.top, columns.bottom, columns.pitch
    if count > 1 and (count - 1) * pitch > bottom - top:
        return [top + i * (bottom - top) / (count - 1) for i in range(count)]
    blocks: list[tuple[float, int]] = []  # mean of wanted heights less their offsets, number of labels
    for i, y in enumerate(wanted):
        mean, size = y - i * pitch, 1
        while blocks and blocks[-1][0] > mean:
            other, many = blocks.pop()
            mean, size = (mean * size + other * many) / (size + many), size + many
        blocks.append((mean, size))
    lowest, highest = top, bottom - (count - 1) * pitch
    starts = [min(max(mean, lowest), highest) for mean, size in blocks for _ in range(size)]
    return [start + i * pitch for i, start in enumerate(starts)]
