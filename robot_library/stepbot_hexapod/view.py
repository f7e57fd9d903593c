"""Where the picture is taken from: rather from above, so that all six legs are seen."""

from ..preview import View

VIEW = View(azimuth=32, elevation=30)
