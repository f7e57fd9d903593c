"""Where the picture is taken from."""

from ..preview import View

VIEW = View(azimuth=38.0, elevation=20.0)
