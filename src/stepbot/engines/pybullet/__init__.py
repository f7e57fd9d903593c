"""PyBullet, which reads URDF, and of SDFormat and MJCF a part."""

from ..engine import Engine, installed

ENGINE = Engine(__name__, "pybullet", formats=("urdf", "sdf", "mjcf"), available=installed("pybullet"), order=40)
