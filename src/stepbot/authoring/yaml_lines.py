"""Values and comments of a drafted sidecar as YAML, one line each and the same on every machine."""

import textwrap
from collections.abc import Iterable
from math import degrees

from stepbot.diagnostics import one_line
from stepbot.geometry.spatial import Vector3
from stepbot.step.structure.paths import quoted

WIDTH = 120
"""Column at which comments are wrapped."""


def number(value: float) -> str:
    """A number with at most 10 significant digits, without minus zero."""
    return f"{value + 0.0:.10g}"


def millimetres(metres: float) -> str:
    """A length, to a nanometre: ``12.5 mm``; ``0`` for zero."""
    rounded = round(metres * 1e3, 6) + 0.0
    return f"{number(rounded)} mm" if rounded else "0"


def angle(radians: float) -> str:
    """An angle, to 1e-9 of a degree: ``-90 deg``."""
    rounded = round(degrees(radians), 9) + 0.0
    return f"{number(rounded)} deg" if rounded else "0"


def position(value: float, *, slides: bool) -> str:
    """A position of a joint for a comment: of a slide to a micrometre, else to a hundredth of a degree."""
    rounded = round(value * 1e3, 3) if slides else round(degrees(value), 2)
    return f"{number(rounded)} {'mm' if slides else 'deg'}"


def lengths(point: Vector3) -> str:
    """A point in millimetres: ``[0, 0, 12.5 mm]``."""
    return f"[{', '.join(map(millimetres, point))}]"


def angles(rpy: Vector3) -> str:
    """Roll, pitch and yaw: ``[0, 90 deg, 0]``."""
    return f"[{', '.join(map(angle, rpy))}]"


def axis(given: str | Vector3) -> str:
    """An axis: its letter, or a vector of three numbers."""
    return given if isinstance(given, str) else f"[{', '.join(number(round(c, 12)) for c in given)}]"


def flow(entries: Iterable[tuple[str, str]]) -> str:
    """A mapping on one line; values are already YAML."""
    return "{" + ", ".join(f"{key}: {value}" for key, value in entries) + "}"


def listed(paths: Iterable[str]) -> str:
    """Component paths as a list on one line."""
    return f"[{', '.join(map(quoted, paths))}]"


def comment(text: str, indent: int = 0) -> list[str]:
    """A text as wrapped comment lines; no character in it can end the comment."""
    space = " " * indent
    text = one_line(text)
    return textwrap.wrap(
        text, WIDTH, initial_indent=f"{space}# ", subsequent_indent=f"{space}#   ", break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
