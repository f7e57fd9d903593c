"""Conversion of Drake's poses."""

from typing import Any

from stepbot.geometry.spatial import Pose


def pose(X: Any) -> Pose:
    """A pose from Drake's."""
    return Pose.of(X.rotation().matrix(), X.translation())
