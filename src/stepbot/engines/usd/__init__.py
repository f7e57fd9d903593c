"""OpenUSD with UsdPhysics, read by a parser of stepbot's own through USD's library."""

from ..engine import SINGLE_PRECISION, Engine, Tolerance, installed

ENGINE = Engine(
    __name__,
    "usd",
    formats=("usd",),
    available=installed("pxr", "usd-core"),
    order=20,
    own_parser=True,
    install="pip install 'stepbot[usd]'",
    title="OpenUSD",
    tolerances={  # UsdPhysics stores numbers in single precision
        **SINGLE_PRECISION,
        "inertia": Tolerance(relative=5e-7),
        "poses": Tolerance(absolute=1e-6),
        "mass matrix": Tolerance(relative=1e-6),
        "gravity forces": Tolerance(relative=1e-6),
        "inverse dynamics": Tolerance(relative=1e-6),
        "initial pose": Tolerance(absolute=1e-6),
    },
)
