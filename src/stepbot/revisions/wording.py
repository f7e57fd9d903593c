"""Descriptions of differences."""

from math import degrees

import numpy as np

from stepbot.geometry.spatial import Pose, angle_between

from .shapes import ANGLE, PLACE, Motion
from .snapshot import AREA, Joint, Part, Shape


def moved_words(found: Motion) -> str:
    """``moved by 12 mm and turned by 5 deg``."""
    words = []
    if found.distance > PLACE:
        words.append(f"moved by {length(found.distance)}")
    if found.angle is None:
        words.append("turned")
    elif found.angle > ANGLE:
        words.append(f"turned by {angle(found.angle)}")
    return " and ".join(words)


def common_words(X_WW: Pose) -> str:
    """The motion of a whole assembly."""
    return moved_words(Motion(X_WW.distance_to(Pose())[0], X_WW.distance_to(Pose())[1])) or "did not move"


def shape_words(old: Shape, new: Shape) -> str:
    """``volume 12.3 -> 12.9 cm^3 (+4.9 %)``; the number of faces if the size is the same."""
    if old.basis != new.basis:
        return f"from {_kind_words(old)} to {_kind_words(new)}"
    noun, unit, scale = ("area", "cm^2", 1e4) if new.basis == AREA else ("volume", "cm^3", 1e6)
    before, after = (sum(count for _, count in shape.faces) for shape in (old, new))
    faces = f", {before} -> {after} faces" if before != after else ""
    if f"{old.measure:.6g}" == f"{new.measure:.6g}":
        return f"{noun} {new.measure * scale:.6g} {unit} as before, but other moments{faces}"
    return f"{noun} {change(old.measure * scale, new.measure * scale, unit)}{faces}"


def mass_words(old: float, new: float) -> str:
    """``mass 33 -> 34.8 g (+5.5 %)``."""
    scale, unit = (1.0, "kg") if max(old, new) >= 1.0 else (1e3, "g")
    return f"mass {change(old * scale, new * scale, unit)}"


def stuff_words(old: Part, new: Part) -> str:
    """``density 2700 -> 7850 kg/m^3 (+191 %)``, ``material 'steel' -> 'brass'``; empty if both are the same."""
    words = []
    if old.material != new.material:
        words.append(f"material '{old.material}' -> '{new.material}'")
    if old.density != new.density:
        words.append(f"density {change(old.density, new.density, 'kg/m^3')}")
    return ", ".join(words)


def change(old: float, new: float, unit: str) -> str:
    """Two different numbers, with as many digits as needed, and their difference."""
    digits = next((n for n in range(4, 12) if f"{old:.{n}g}" != f"{new:.{n}g}"), 12)
    share = f" ({100.0 * (new - old) / old:+.3g} %)" if old else ""
    return f"{old:.{digits}g} -> {new:.{digits}g} {unit}".rstrip() + share


def length(value: float) -> str:
    """A length [m] in millimetres."""
    return f"{value * 1e3:.4g} mm"


def angle(value: float) -> str:
    """An angle [rad] in degrees."""
    return f"{degrees(value):.4g} deg"


def _kind_words(shape: Shape) -> str:
    return "a surface" if shape.basis == AREA else "a solid" if shape.measure else "no geometry"


def axis_words(old: Joint, new: Joint, common: Pose) -> str:
    """How a joint has moved, for messages; empty if it has not.

    Args:
        old: The joint in the old revision.
        new: The joint in the new revision.
        common: The motion of the whole assembly, which is subtracted.
    """
    start, end = common.apply(old.origin), np.array(new.origin)
    shift = end - start
    if old.axis is None or new.axis is None:
        distance = float(np.linalg.norm(shift))
        return f"origin moved by {length(distance)}" if distance > PLACE else ""
    before, after = common.turn(old.axis), np.array(new.axis)
    turned = angle_between(before, after)
    along = float(shift @ after)
    across = float(np.linalg.norm(shift - along * after))
    words = []
    if across > PLACE:
        words.append(f"moved by {length(across)}")
    if turned > ANGLE:
        words.append(f"turned by {angle(turned)}")
    if words:
        return f"axis {' and '.join(words)}"
    return f"origin moved by {length(abs(along))} along its axis" if abs(along) > PLACE else ""
