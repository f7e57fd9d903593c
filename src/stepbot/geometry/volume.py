"""Volume, centroid and second moments of a solid, and the deviation between two measurements."""

from math import inf, sqrt

import numpy as np
from msgspec import Struct

from .inertia import MassProperties
from .spatial import Array

_DIGITS = 12
"""Digits of integrals that are free of rounding errors, on every processor."""


class VolumeProperties(Struct, frozen=True):
    """Volume, centroid and second moments of a solid of density 1 kg/m^3."""

    unit_density: MassProperties
    """Mass [kg] equals :attr:`volume`; com and inertia in the definition's frame."""

    @property
    def volume(self) -> float:
        """[m^3]."""
        return self.unit_density.mass

    @staticmethod
    def of(volume: float, com: Array, inertia: Array) -> "VolumeProperties":
        """From volume [m^3], com (3,) [m] and inertia (3, 3) [kg m^2] about the com at 1 kg/m^3."""
        return VolumeProperties(MassProperties.of(volume, com.tolist(), inertia))

    @staticmethod
    def rounded(volume: float, com: Array, inertia: Array) -> "VolumeProperties":
        """Same as :meth:`of`, rounded to twelve digits of the solid's size.

        Sums of many terms differ in the last digits between processors and between versions of numpy.
        """
        largest = float(np.abs(inertia).max())
        return VolumeProperties.of(
            float(_to_twelve_digits(np.array(volume), volume)),
            _to_twelve_digits(com, sqrt(largest / volume)),
            _to_twelve_digits(inertia, largest),
        )

    def deviation_from(self, exact: "VolumeProperties") -> tuple[float, str]:
        """Largest relative deviation, and its quantity: ``volume``, ``com`` or ``inertia``; to twelve decimals.

        The com's is in radii of gyration, the inertia's about the axis with the largest one.
        """
        volume = abs(self.volume - exact.volume) / exact.volume
        moments, axes = np.linalg.eigh(np.array(exact.unit_density.inertia))
        if moments[0] <= 0.0:
            return inf, "inertia"
        shift = np.array(self.unit_density.com) - np.array(exact.unit_density.com)
        gyration = sqrt(float(moments.sum()) / (2.0 * exact.volume))
        scaled = axes / np.sqrt(moments)  # in these axes the exact inertia is 1 about every axis
        difference = np.array(self.unit_density.inertia) - np.array(exact.unit_density.inertia)
        inertia = float(np.abs(np.linalg.eigvalsh(scaled.T @ difference @ scaled)).max())
        worst, what = max((volume, "volume"), (float(np.linalg.norm(shift)) / gyration, "com"), (inertia, "inertia"))
        return round(worst, _DIGITS), what


def _to_twelve_digits(values: Array, size: float) -> Array:
    if size == 0.0:
        return values
    return values.round(_DIGITS - int(np.floor(np.log10(size)))) + 0.0  # no minus zero
