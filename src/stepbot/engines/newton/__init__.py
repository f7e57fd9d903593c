"""Newton, NVIDIA's, Google DeepMind's and Disney Research's simulator, which reads OpenUSD."""

from ..engine import Engine, installed


def available() -> str | None:
    """Why the engine cannot run here; None if it can."""
    needed = (("newton", "newton"), ("pxr", "usd-core"), ("newton_usd_schemas", "newton-usd-schemas"))
    reasons = (installed(module, name)() for module, name in needed)
    return next((reason for reason in reasons if reason is not None), None)


ENGINE = Engine(
    __name__,
    "newton",
    formats=("usd",),
    available=available,
    order=50,
    optional=True,
    install="pip install 'stepbot[newton]'",
    title="Newton",
)
