"""Where the picture is taken from."""

from robot_library.preview import View

VIEW = View(azimuth=24, elevation=16, zoom=1.12)
