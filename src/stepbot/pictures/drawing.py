"""Lines, arrows and text over a rendered picture.

Lines are drawn four times as large and averaged, so that they are smooth; text is drawn by FreeType with the font that
comes with Pillow, so that a picture does not depend on the fonts of a machine.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from math import hypot

import numpy as np
from numpy.typing import NDArray

from .layout import Place

Color = tuple[int, int, int]

_FINER = 4
_PAPER: Color = (246, 246, 247)
_HALO = 2
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

    def dashes(self, start: Place, end: Place, color: Color, width: float, dash: float) -> None:
        """A dashed line."""
        length = hypot(end[0] - start[0], end[1] - start[1])
        for number in range(int(length / (2 * dash)) + 1):
            a, b = 2 * number * dash, min((2 * number + 1) * dash, length)
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
