"""MuJoCo, which reads MJCF and URDF."""

from ..engine import Engine, installed

ENGINE = Engine(
    __name__, "mujoco", formats=("urdf", "mjcf"), available=installed("mujoco"), order=10, title="MuJoCo", drives="mjcf"
)
