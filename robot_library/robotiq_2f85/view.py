"""Where the picture is taken from."""

from robot_library.preview import View

VIEW = View(azimuth=25, elevation=14)
