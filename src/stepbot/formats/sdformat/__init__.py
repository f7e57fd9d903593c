"""SDFormat, as Gazebo and Drake read it."""

from ..format import Format

FORMAT = Format(
    __name__,
    "sdf",
    "SDFormat",
    suffix=".sdf",
    root="sdf",
    order=20,
    scene=".world.sdf",
    aliases=("sdformat",),
    programs=("drake",),
)
