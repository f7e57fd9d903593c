"""Where the picture is taken from: the open side of the cylinder."""

from ..preview import View

VIEW = View(azimuth=62, elevation=18)
