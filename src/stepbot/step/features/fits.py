"""Whether a shaft fits its bore: one rule and one table of tolerances for ``check``, ``convert`` and ``init``."""

import numpy as np

from stepbot.geometry.spatial import Array

TIGHTEST = 1e-5
"""Clearance [m] that every fit may have, and difference of radii that count as equal."""
LOOSEST = 5e-4
"""Maximum clearance [m] of a fit."""
SLACK_SHARE = 0.06
"""Maximum clearance of a fit, as a share of the bore's radius."""
INTERFERENCE = 1.5e-4
"""Maximum interference [m] of a shaft drawn wider than its bore, for a press fit; never more than its clearance might
be."""
ENGAGED = 2e-4
"""Minimum engaged length [m] of a shaft in its bore: less is a chamfer or a centring edge."""
BESIDE = 1.5e-3
"""Gap [m] along the line up to which faces count as touching: a washer, or two edges chamfered by 0.75 mm."""


def fits(bore: Array | float, shaft: Array | float, engaged: Array | float) -> Array:
    """Whether shafts fit bores, by their radii and engaged lengths [m]; arrays are broadcast."""
    bores = np.asarray(bore)
    slack, widest = bores - shaft, np.maximum(TIGHTEST, np.minimum(LOOSEST, SLACK_SHARE * bores))
    is_engaged = np.asarray(engaged) >= ENGAGED
    return np.asarray(is_engaged & (slack <= widest) & (slack >= -np.minimum(widest, INTERFERENCE)))
