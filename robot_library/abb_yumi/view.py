"""Where the picture is taken from."""

from ..preview import View

VIEW = View(azimuth=28.0, elevation=14.0)
