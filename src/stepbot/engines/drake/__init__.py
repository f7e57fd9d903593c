"""Drake, which reads SDFormat, URDF and MJCF."""

from ..engine import Engine, installed

ENGINE = Engine(
    __name__,
    "drake",
    formats=("urdf", "sdf", "mjcf", "drake.sdf"),
    available=installed("pydrake", "drake"),
    order=30,
    probe_order=60,  # it reads no mimics
    optional=True,
    install="pip install 'stepbot[verify]'",
    distribution="pydrake",
    title="Drake",
)
