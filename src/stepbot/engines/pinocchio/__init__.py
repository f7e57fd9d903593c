"""Pinocchio, which reads URDF and MJCF."""

import importlib.metadata

from ..engine import Engine


def available() -> str | None:
    """Why the engine cannot run here; None if it can."""
    # A test framework of the same name is on the package index as well; only the real one is installed as `pin`.
    try:
        importlib.metadata.version("pin")
    except importlib.metadata.PackageNotFoundError:
        return "pinocchio is not installed"
    return None


ENGINE = Engine(
    __name__,
    "pinocchio",
    formats=("urdf", "mjcf"),
    available=available,
    order=50,
    optional=True,
    install="pip install 'stepbot[verify]'",
)
