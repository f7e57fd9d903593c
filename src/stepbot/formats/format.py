"""What is known of a format before its writer is imported."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from stepbot.robot.model import Robot

    from .companion import Companion
    from .features import Feature, Support


class Writer(Protocol):
    """The module ``writer`` of a format."""

    EXPRESSES: "Mapping[Feature, Support]"
    """What the format can say."""

    def reserves(self, name: str) -> bool:
        """Whether the name means something else to the format."""

    def render(self, robot: "Robot") -> bytes:
        """The main file of a lowered robot."""

    def companions(self, robot: "Robot") -> "tuple[Companion, ...]":
        """Files for readers that cannot do with the main one."""


@dataclass(frozen=True, eq=False)
class Format:
    """The declaration of a format. Its writer is imported when it is asked for."""

    package: str
    """Package of the format, which has a module ``writer``: ``__name__``."""
    name: str
    """What users call it: ``urdf``."""
    title: str
    """What people call it: ``URDF``."""
    suffix: str
    """What the name of its main file ends with."""
    root: str
    """The first element of its files, which ``stepbot verify`` knows them by."""
    order: int
    """Least for the format that is named and written first."""
    aliases: tuple[str, ...] = ()
    """What else users may call it, in lower case."""
    default: bool = True
    """Whether it is written where no format is asked for."""

    @property
    def writer(self) -> Writer:
        """The module that writes; imported now."""
        return cast(Writer, import_module(f"{self.package}.writer"))

    @property
    def expresses(self) -> "Mapping[Feature, Support]":
        """What the format can say."""
        return self.writer.EXPRESSES
