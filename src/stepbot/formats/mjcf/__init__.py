"""MJCF, MuJoCo's own format."""

from ..format import Format

FORMAT = Format(
    __name__,
    "mjcf",
    "MJCF",
    suffix=".xml",
    root="mujoco",
    order=30,
    scene=".scene.xml",
    aliases=("mujoco",),
    programs=("dmcontrol", "genesis", "mjx"),
)
