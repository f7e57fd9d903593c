"""Magnitudes beyond which a number of a robot is a mistake, whatever its source."""

GREATEST = 1e30
"""In SI units: OpenUSD and several engines store single precision."""
FARTHEST = 1e6
"""Distance [m]: the squares of farther ones overflow."""
DENSEST = 25_000.0
"""Density [kg/m^3]; osmium, the densest element, has 22590."""
