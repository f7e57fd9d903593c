"""Where the picture is taken from."""

from robot_library.preview import View

VIEW = View(azimuth=20, elevation=13, zoom=1.1)
