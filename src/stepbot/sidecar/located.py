"""The values of a sidecar with their places in the text."""

import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from msgspec import Struct, field

from stepbot.diagnostics import Span
from stepbot.robot.motors import Motor

from .document import Document
from .motor_sections import MotorSection
from .tree import Keys, Listing, Scalar, Tree, key_span, span, value_at, way

OwnMotors = Mapping[str, MotorSection]
"""A user's motors by name, beside those of the catalogue."""
NO_MOTORS: OwnMotors = MappingProxyType({})


class Sidecar(Struct, frozen=True):
    """A sidecar that was read, and the places of all its values."""

    document: Document
    path: Path
    """The user's path."""
    text: str
    """With line feeds at line ends."""
    root: Tree
    """The values with their places."""
    motors: Mapping[str, Motor] = field(default_factory=dict)
    """What the motor of each actuator gives it."""
    own_motors: OwnMotors = field(default_factory=dict)
    """Its own ones, and those of the files that it is a module of."""
    variant: str = ""
    """The variant of the file that it is."""
    is_changed: bool = False
    """Whether another file has changed values in it."""

    @property
    def step_path(self) -> Path:
        """The STEP file that it refers to."""
        return self.path.parent / self.document.step

    def span(self, *keys: str | int) -> Span:
        """Span of the value at ``keys``, or of the nearest existing value above it."""
        return span(self.root, keys)

    def key_span(self, *keys: str | int) -> Span:
        """Span of the last of ``keys`` itself, or of the nearest existing one above it."""
        return key_span(self.root, keys)

    def written(self, *keys: str | int) -> str:
        """A scalar as written in the file, without quotes; empty if there is none."""
        value = self._scalar(keys)
        return value.text if value is not None else ""

    def quoting_hints(self, *keys: str | int) -> tuple[str, ...]:
        """Remedies for a path that matches nothing, where missing quotes may have cut it short.

        Without quotes ``[XL,XC-330 v1]`` is a list of two, and ``ID #71`` ends before its ``#``, a comment.
        """
        value = self._scalar(keys)
        if value is None or not value.plain or not value.span.end_column or value.span.file != self.root.span.file:
            return ()
        line = self.text.split("\n")[value.span.line - 1]
        before, after = line[: value.span.column - 1], line[value.span.end_column - 1 :]
        if comment := re.match(r" +#\S[^,\]}]*", after):
            return (f'# after a space starts a comment; quote the text: "{value.text}{comment[0].rstrip()}"',)
        above = way(self.root, keys)[-2] if keys else None
        if isinstance(above, Listing) and above.flow and (before.endswith(",") or re.match(r",\S", after)):
            whole = _cut_at_commas(line, value)
            return (f'an unquoted comma separates list items; quote a name that contains a comma: ["{whole}"]',)
        return ()

    def plain_number(self, *keys: str | int) -> float | None:
        """A value that is written as a number without a unit; None for anything else."""
        value = self._scalar(keys)
        if value is None or isinstance(value.value, bool) or not isinstance(value.value, int | float):
            return None
        return float(value.value)

    def _scalar(self, keys: Keys) -> Scalar | None:
        value = value_at(self.root, keys)
        return value if isinstance(value, Scalar) else None


def _cut_at_commas(line: str, value: Scalar) -> str:
    """The text around a value of a list, up to the spaces and brackets on both sides: ``XL,XC-330`` around ``XL``."""
    return next(
        run[0].strip()
        for run in re.finditer(r"(?:[^\[\],]|,(?=\S))+", line)
        if run.start() < value.span.column <= run.end()
    )
