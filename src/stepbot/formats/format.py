"""The declaration of a format, readable without importing its writer."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

if TYPE_CHECKING:
    from stepbot.robot.model import Robot

    from .features import Feature, Support


class Companion(NamedTuple):
    """A file beside the main one, for a reader that cannot use the main file."""

    path: str
    """Relative to the output folder."""
    format: str
    """The name of its format, for the engines that read it; empty if none does."""
    robot: "Robot"
    """Its content."""
    content: bytes


class Writer(Protocol):
    """The module ``writer`` of a format."""

    EXPRESSES: "Mapping[Feature, Support]"
    """How the format expresses each feature."""

    def reserves(self, name: str) -> bool:
        """Whether the format reserves the name, so that links, joints and frames may not have it."""

    def render(self, robot: "Robot") -> bytes:
        """The main file of a robot lowered to ``EXPRESSES``, as bytes; deterministic and without side effects."""

    def companions(self, robot: "Robot") -> tuple[Companion, ...]:
        """Additional files of a lowered robot, for readers that cannot use the main file alone."""

    def scenes(self, robot: "Robot") -> "Mapping[str, bytes]":
        """The file with :attr:`Format.scene`, if there is one: a lowered robot with floor, light and camera."""


class Format(NamedTuple):
    """The declaration of a format. Its writer is imported on first use."""

    package: str
    """Package of the format, which has a module ``writer``: ``__name__``."""
    name: str
    """Name in commands and reports: ``urdf``."""
    title: str
    """Name in prose: ``URDF``."""
    suffix: str
    """Suffix of its main file."""
    root: str
    """Root element of its files, by which ``stepbot verify`` recognizes them; empty if they are not XML."""
    order: int
    """Lowest for the format that is listed and written first."""
    scene: str = ""
    """Suffix of its scene: the robot with floor and light; empty without one."""
    aliases: tuple[str, ...] = ()
    """Further names in commands, in lower case."""
    programs: tuple[str, ...] = ()
    """Beginnings of the names of programs that read it, in lower case, for advice on formats of these names."""
    default: bool = True
    """Whether it is written when no format is selected."""
    signatures: tuple[bytes, ...] = ()
    """First bytes of files that are not XML, by which ``stepbot verify`` recognizes them."""
    mesh_files: bool = True
    """Whether its files refer to meshes as files of their own; otherwise they contain them."""

    stem: Callable[[str], str] = str
    """The name of its files without suffix, from the robot's: some formats allow identifiers alone."""

    @property
    def writer(self) -> Writer:
        """The module ``writer`` of the package, imported on first use."""
        return cast(Writer, import_module(f"{self.package}.writer"))

    def version_of(self, robot: "Robot") -> float:
        """The version of the format in which a robot is written; 0 for a format with one."""
        return float(getattr(robot.versions, self.name, 0.0))

    @property
    def expresses(self) -> "Mapping[Feature, Support]":
        """How the format expresses each feature."""
        return self.writer.EXPRESSES
