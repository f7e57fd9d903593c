"""The line about the masses of links."""

import pytest

from stepbot.report.words import mass_summary


@pytest.mark.parametrize(
    ("masses", "words"),
    [
        ({"base": 0.2478, "jaw": 0.0257, "arm": 1.2}, "mass: 1.47 kg in 3 links, from 25.7 g (jaw) to 1.2 kg (arm)"),
        ({"base": 55.0, "tool": 0.0, "arm": 0.9999}, "mass: 56 kg in 3 links, from 1 kg (arm) to 55 kg (base)"),
        ({"base": 0.0, "body": 0.5}, "mass: 500 g in 2 links"),
        ({"base": 0.0}, "mass: 0 kg in 1 link"),
        ({}, ""),
    ],
)
def test_total_and_extremes(masses: dict[str, float], words: str) -> None:
    """The total, and the lightest and heaviest link with a mass, to three digits."""
    assert mass_summary(masses) == words
