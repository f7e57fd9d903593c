"""OpenUSD with UsdPhysics, read by a parser of stepbot's own through USD's library."""

from ..engine import Engine, installed

ENGINE = Engine(
    __name__,
    "usd",
    formats=("usd",),
    available=installed("pxr", "usd-core"),
    order=20,
    own_parser=True,
    install="pip install 'stepbot[usd]'",
    title="OpenUSD",
)
