"""Where the picture is taken from: nearly from the front, at the height of its chest."""

from ..preview import View

VIEW = View(azimuth=24, elevation=13)
