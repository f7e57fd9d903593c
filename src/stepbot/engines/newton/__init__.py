"""Newton, NVIDIA's, Google DeepMind's and Disney Research's simulator, which reads OpenUSD."""

from ..engine import SINGLE_PRECISION, Engine, Tolerance, installed


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
    tolerances={  # Newton computes in single precision throughout, and turns inertias from their principal axes
        **SINGLE_PRECISION,
        "inertia": Tolerance(relative=5e-6),
        "poses": Tolerance(absolute=5e-6),
        # It adds inertias about the root, with four roundings of 6e-8: a light wheel far from it keeps fewer digits.
        "mass matrix": Tolerance(relative=2e-5, of_whole=2.4e-7),
    },
)
