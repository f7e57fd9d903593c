"""PyBullet, which reads URDF, and of SDFormat and MJCF a part."""

import sys
from importlib.util import find_spec

from ..engine import Engine, Tolerance

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
    drives="urdf",
    tolerances={
        # PyBullet converts every inertia to principal axes, by an iteration that stops at products below 1e-6 of the
        # trace, which is up to three times the largest entry.
        "inertia": Tolerance(relative=3e-6),
        "poses": Tolerance(absolute=1e-6),
        "mass matrix": Tolerance(relative=1e-6),
        "gravity forces": Tolerance(relative=1e-6),
        "inverse dynamics": Tolerance(relative=1e-6),
        # Loops are closed by constraints of a simulation with steps of 1 ms, with gaps of 2e-6 of the links' lengths.
        "closures": Tolerance(absolute=1e-5, relative=5e-6),
        # Hulls of collision meshes are computed on a grid of 1/10216 of their extent.
        "meshes": Tolerance(absolute=1e-6, relative=2e-4),
    },
    # The solver handles the constraints of a step one by one, and converges late where loops share links.
    several_loops=Tolerance(absolute=3e-4),
    driven_angle=1e-3,
)
