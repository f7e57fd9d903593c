"""Volume, centroid and second moments of a solid, and how far two measurements of them differ."""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from .inertia import MassProperties


@dataclass(frozen=True)
class VolumeProperties:
    """Volume, centroid and second moments of a solid of density 1 kg/m^3."""

    volume: float
    """[m^3]."""
    unit_density: MassProperties
    """Mass [kg] equals ``volume``; com and inertia in the definition's frame."""

    @staticmethod
    def of(volume: float, com: NDArray[np.float64], inertia: NDArray[np.float64]) -> "VolumeProperties":
        """From volume [m^3], com (3,) [m] and inertia (3, 3) [kg m^2] about the com at 1 kg/m^3."""
        return VolumeProperties(float(volume), MassProperties.of(volume, com.tolist(), inertia))

    def deviation_from(self, exact: "VolumeProperties") -> tuple[float, str]:
        """Largest relative deviation, and of what: ``volume``, ``com`` or ``inertia``.

        The com's is in radii of gyration, the inertia's about the axis where it is worst.
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
        return max((volume, "volume"), (float(np.linalg.norm(shift)) / gyration, "com"), (inertia, "inertia"))
