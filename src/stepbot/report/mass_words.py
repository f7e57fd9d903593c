"""The masses of links in words, for the terminal."""

from collections.abc import Mapping

from stepbot.geometry.sums import exact_sum

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
