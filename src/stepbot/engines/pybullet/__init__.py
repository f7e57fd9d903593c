"""PyBullet, which reads URDF, and of SDFormat and MJCF a part."""

import sys
from importlib.util import find_spec

from ..engine import Engine

_NO_WHEELS = (3, 14)
"""The first Python that neither `pybullet` nor `pybullet-arm64` has wheels for."""


def available() -> str | None:
    """Why the engine cannot run here; None if it can."""
    if find_spec("pybullet") is not None:
        return None
    no_wheel = f": it has no wheel for Python {sys.version_info[0]}.{sys.version_info[1]}"
    return "pybullet is not installed" + (no_wheel if sys.version_info >= _NO_WHEELS else "")


ENGINE = Engine(
    __name__,
    "pybullet",
    formats=("urdf", "sdf", "mjcf"),
    available=available,
    order=40,
    install="pip install pybullet-arm64",  # the same module, with wheels for more systems
    title="PyBullet",
)
