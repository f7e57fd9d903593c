"""Gazebo's own parser of SDFormat, libsdformat, which validates a file."""

from stepbot.runtime.programs import sdf_programs

from ..engine import Engine


def available() -> str | None:
    """Why the engine cannot run here; None if it can."""
    return None if any(sdf_programs()) else "libsdformat is not installed"


ENGINE = Engine(
    __name__,
    "libsdformat",
    formats=("sdf", "drake.sdf"),
    available=available,
    order=70,
    optional=True,
    install="apt-get install libsdformat-dev ignition-tools",
)
