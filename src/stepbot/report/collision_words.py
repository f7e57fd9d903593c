"""Collision shapes in words, for the terminal and the page."""

from collections import Counter
from collections.abc import Mapping, Sequence

from .results import LinkCollision

_PLURALS = {"box": "boxes", "mesh": "meshes"}


def shape_words(shapes: Mapping[str, int]) -> str:
    """``2 boxes, 1 cylinder, 3 hulls``."""
    return ", ".join(f"{n} {name if n == 1 else _PLURALS.get(name, name + 's')}" for name, n in sorted(shapes.items()))


def collision_summary(shapes: Sequence[LinkCollision]) -> str:
    """All links in one line: the number of shapes, the worst intersection over union, the largest overshoot."""
    counts: Counter[str] = Counter()
    for one in shapes:
        counts.update(one.shapes)
    links = f"{len(shapes)} link" + "s" * (len(shapes) != 1)
    words = f"collision shapes of {links}: {shape_words(counts)}"
    scored = [one for one in shapes if one.iou is not None and one.overshoot is not None]
    if scored:
        least = min(scored, key=lambda one: one.iou or 0.0)
        most = max(scored, key=lambda one: one.overshoot or 0.0)
        words += f"; intersection / union at least {least.iou:.2f} ({least.link})"
        words += f", overshoot at most {1e3 * (most.overshoot or 0.0):.1f} mm ({most.link})"
    return words
