"""Pinocchio, which reads URDF and MJCF."""

from importlib.util import find_spec
from pathlib import Path

from stepbot.runtime.file import is_file

from ..engine import Engine


def available() -> str | None:
    """Why the engine cannot run here; None if it can."""
    # A test framework of the same name is on the package index as well; it has no robots.
    spec = find_spec("pinocchio")
    folders = spec.submodule_search_locations if spec is not None else None
    has_robots = any(is_file(Path(folder, "robot_wrapper.py")) for folder in folders or ())
    return None if has_robots else "pinocchio is not installed"


ENGINE = Engine(
    __name__,
    "pinocchio",
    formats=("urdf", "mjcf"),
    available=available,
    order=50,
    optional=True,
    install="pip install 'stepbot[verify]'",
    distribution="pin",
    title="Pinocchio",
)
