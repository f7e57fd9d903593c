"""Where the picture is taken from."""

from ..preview import View

VIEW = View(azimuth=35.0, elevation=12.0)
