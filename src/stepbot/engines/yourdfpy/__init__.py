"""yourdfpy, which reads URDF and has no dynamics."""

from ..engine import Engine, installed

ENGINE = Engine(
    __name__,
    "yourdfpy",
    formats=("urdf",),
    available=installed("yourdfpy"),
    order=60,
    probe_order=30,  # it reads mimics
)
