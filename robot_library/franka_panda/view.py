"""Where the picture is taken from."""

from robot_library.preview import View

VIEW = View(azimuth=48, elevation=14, zoom=1.08)
