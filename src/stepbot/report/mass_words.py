"""The masses of links in words, for the terminal."""

from collections import Counter
from collections.abc import Mapping, Sequence

from stepbot.geometry.fixed_point import exact_sum

from .results import LinkCollision

_KILOGRAM = 0.9995
"""Mass [kg] from which it is written in kilograms."""


def mass_words(mass: float) -> str:
    """A mass [kg] to three digits: ``1.04 kg``, ``57.2 g``."""
    return f"{mass:.3g} kg" if not mass or mass >= _KILOGRAM else f"{1e3 * mass:.3g} g"


def mass_summary(masses: Mapping[str, float]) -> str:
    """All links in one line: the total, the lightest and the heaviest; empty without links.

    Args:
        masses: Mass of each link [kg].
    """
    heavy = {link: mass for link, mass in masses.items() if mass > 0.0}
    words = f"mass: {mass_words(exact_sum(masses.values()))} in {len(masses)} link" + "s" * (len(masses) != 1)
    if len(heavy) < 2:
        return words if masses else ""
    least, most = min(heavy, key=heavy.__getitem__), max(heavy, key=heavy.__getitem__)
    return f"{words}, from {mass_words(heavy[least])} ({least}) to {mass_words(heavy[most])} ({most})"


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
