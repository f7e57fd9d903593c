"""Values and comments of a drafted sidecar as YAML, one line each and the same on every machine."""

import textwrap
from collections.abc import Iterable
from math import atan2, degrees, hypot

from stepbot.diagnostics import one_line
from stepbot.draft.draft import OriginForm, OriginSnippet
from stepbot.geometry.spatial import ZERO3, Vector3
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


def origin_text(origin: OriginSnippet) -> str:
    """The value of ``origin:``."""
    if origin.form is OriginForm.XYZ:
        return _numbers(origin.xyz, origin.rpy)
    entries = [
        ("mate", listed(origin.paths)) if origin.form is OriginForm.MATE else ("axis_of", quoted(origin.paths[0]))
    ]
    if origin.radius is not None:
        entries.append(("radius", millimetres(origin.radius)))
    if origin.near is not None:
        entries.append(("near", lengths(origin.near)))
    return flow(entries)


def alternative_origin(point: Vector3, direction: Vector3 | None) -> str:
    """A numeric frame with z along ``direction``."""
    return _numbers(point, ZERO3 if direction is None else z_along(direction))


def z_along(direction: Vector3) -> Vector3:
    """Roll, pitch and yaw [rad] of a frame whose z axis is a unit direction, without its rounding errors."""
    x, y, z = (round(value, 9) for value in direction)
    return (0.0, atan2(hypot(x, y), z), atan2(y, x) if x or y else 0.0)


def _numbers(xyz: Vector3, rpy: Vector3) -> str:
    entries = [("xyz", lengths(xyz))]
    if any(rpy):
        entries.append(("rpy", angles(rpy)))
    return flow(entries)
