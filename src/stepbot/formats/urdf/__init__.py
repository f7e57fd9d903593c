"""URDF, as ROS and most simulators read it."""

from ..format import Format

FORMAT = Format(
    __name__,
    "urdf",
    "URDF",
    suffix=".urdf",
    root="robot",
    order=10,
    programs=("bullet", "coppelia", "pybullet", "raisim", "rviz", "sapien", "unity"),
)
