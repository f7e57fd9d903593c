"""The declaration of an engine, readable without importing the engine."""

import importlib.util
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from msgspec import Struct, field

if TYPE_CHECKING:
    from .observation import Observation, Request


class Tolerance(Struct, frozen=True):
    """The tolerance of a quantity."""

    absolute: float = 0.0
    relative: float = 0.0
    of_whole: float = 0.0
    """For a small part of something large, the rounding of the latter."""

    def allowed(self, scale: float, whole: float = 0.0) -> float:
        """Largest deviation that passes."""
        return self.absolute + self.relative * scale + self.of_whole * whole


SINGLE_PRECISION: "Mapping[str, Tolerance]" = {
    "axes": Tolerance(absolute=1e-6),
    "limits": Tolerance(absolute=1e-9, relative=2e-7),
    "dynamics": Tolerance(absolute=1e-9, relative=2e-7),
    "mimic": Tolerance(absolute=1e-9, relative=2e-7),
    "mass": Tolerance(relative=1e-7),
    "com": Tolerance(relative=2e-7),
    "closures": Tolerance(absolute=1e-6),
    "actuators": Tolerance(absolute=1e-9, relative=2e-7),
}
"""Of numbers in single precision, accurate to 6e-8 of each; a pose is a product of several."""


class Observer(Protocol):
    """The module ``observer`` of an engine."""

    def prepare(self) -> None:
        """Import the engine's slow modules."""

    def observe(self, request: "Request") -> "Observation":
        """Load a file and report its content; runs in a worker process.

        Raises:
            EngineRefused: The engine rejects the file.
            EngineCannotRead: The engine is known not to read such a file; its checks are not run.
        """


class Engine(Struct, eq=False):
    """The declaration of an engine. It imports neither the engine nor the module that observes with it."""

    package: str
    """Package of the engine, which has a module ``observer``: ``__name__``."""
    name: str
    """Name in commands and reports: ``mujoco``."""
    formats: tuple[str, ...]
    """Names of the formats that it reads, including those of companion files."""
    available: Callable[[], str | None]
    """Returns why the engine cannot run here; None if it can."""
    order: int
    """Lowest for the engine that reports most: without an expectation, the other engines are compared with it."""
    probe_order: int | None = None
    """Lowest for the engine that is asked first which joints a file has; None for ``order``."""
    optional: bool = False
    """Whether most installations lack it, so that its absence is not reported."""
    own_parser: bool = False
    """Whether it is one of stepbot's own parsers, which confirms the text of a file but simulates nothing."""
    install: str = ""
    """Command that installs it; empty for ``pip install NAME``."""
    distribution: str = ""
    """The distribution or module whose version is the engine's; empty for ``name``."""
    title: str = ""
    """Name in prose: ``MuJoCo``; empty for ``name``."""
    drives: str = ""
    """The format that drive tests load in it, by ``SIMULATION`` of its module ``simulation``; empty for none."""

    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    """By :class:`.observation.Quantity` value, the tolerances that differ from those of the comparison."""
    several_loops: Tolerance | None = None
    """Gap of coupled loops over their range, if the engine does not solve them simultaneously."""
    driven_angle: float | None = None
    """Deviation [rad] or [m] of following joints in a simulation; None for that of the closures."""

    @property
    def observe_function(self) -> str:
        """``module:function`` for a worker."""
        return f"{self.package}.observer:observe"

    @property
    def shared_import(self) -> str:
        """What the fork server imports once for all processes; with the slow import if it reads several formats."""
        return f"{self.package}.observer:prepare" if len(self.formats) > 1 else f"{self.package}.observer"

    @property
    def probing_order(self) -> int:
        """Lowest for the engine that is asked first which joints a file has."""
        return self.order if self.probe_order is None else self.probe_order

    @property
    def observer(self) -> Observer:
        """The module ``observer`` of the package, imported on first use."""
        return cast(Observer, import_module(f"{self.package}.observer"))


def installed(module: str, name: str = "") -> Callable[[], str | None]:
    """A function that returns why a module cannot be imported, or None if it can.

    Args:
        module: Name of a top-level module.
        name: Name in the reason; empty for the module's name.
    """
    return lambda: None if importlib.util.find_spec(module) is not None else f"{name or module} is not installed"


def always() -> None:
    """Return None, as ``available`` of an engine that is part of stepbot."""
