"""The expected.json of a robot: the values that a program should read from its STEP; the bytes are deterministic."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .moments import Array, Moments, inverse

_DIGITS = 12
"""Significant digits: one fewer than in the STEP, and equal on every platform."""


def mass_properties(body: Moments) -> dict[str, Any]:
    """Mass [kg], com [m] and inertia [kg m^2] about the com, in the body's frame."""
    return {"mass": body.mass, "com": body.com, "inertia": body.inertia}


def link(body_W: Moments, X_WL: Array) -> dict[str, Any]:
    """A link's mass properties in the assembly's frame W, the pose of its frame L, and the same properties in L."""
    body_L = body_W.moved(inverse(X_WL))
    return {**mass_properties(body_W), "frame": frame(X_WL), "in_link_frame": mass_properties(body_L)}


def frame(X_AB: Array) -> dict[str, Any]:
    """A pose as position [m] and rotation matrix, row by row."""
    return {"position": X_AB[:3, 3], "rotation": X_AB[:3, :3]}


def joint(X_WJ: Array, axis_W: Sequence[float]) -> dict[str, Any]:
    """A joint's frame, and its axis in the assembly's frame."""
    return {"frame": frame(X_WJ), "axis": list(axis_W)}


def write_expected(path: Path, content: dict[str, Any]) -> None:
    """Write expected.json; arrays of numbers are on one line."""
    path.write_text(_text(content) + "\n", encoding="utf-8", newline="\n")


def _text(value: Any, indent: str = "") -> str:
    if isinstance(value, dict) and not all(isinstance(inner, int | float) for inner in value.values()):
        inner = indent + "  "
        lines = (f"{inner}{json.dumps(key)}: {_text(item, inner)}" for key, item in value.items())
        return "{\n" + ",\n".join(lines) + f"\n{indent}}}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(f"{indent}  {_text(item, indent + '  ')}" for item in value) + f"\n{indent}]"
    return json.dumps(_rounded(value))


def _rounded(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        scale = float(np.max(np.abs(value), initial=0.0))
        # Values below 1e-14 of their neighbours are rounding errors of a sum that is exactly 0.
        return _rounded(np.where(np.abs(value) < 1e-14 * scale, 0.0, value).tolist())
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}") + 0.0
    return value
