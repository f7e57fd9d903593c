"""Poses and rigid bodies for tests, written from the formats' specifications, independent of stepbot's code."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def pose(xyz: Sequence[float], rpy: Sequence[float]) -> Array:
    """X, shape (4, 4), from a position [m] and rotations [rad] about fixed x, then y, then z (URDF, SDFormat)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    X = np.eye(4)
    X[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    X[:3, 3] = xyz
    return X


def numbers(text: str | None) -> list[float]:
    """Numbers separated by blanks."""
    return [float(word) for word in (text or "").split()]


def sdf_pose(element: Any) -> Array:
    """The ``<pose>`` of an element of an SDFormat file, which must be flat; the identity if missing."""
    found = element.find("pose")
    if found is None:
        return np.eye(4)
    assert not found.attrib, f"<{element.tag} name='{element.get('name')}'>: the pose is not flat: {dict(found.attrib)}"
    values = numbers(found.text)
    return pose(values[:3], values[3:])


def reported_pose(given: Mapping[str, Sequence[float]]) -> Array:
    """X of a pose in a report."""
    return pose(given["xyz"], given["rpy"])


def urdf_links(root: etree._Element) -> tuple[str, dict[str, Array]]:
    """The root of a URDF's tree, and the pose of each link in it at q = 0."""
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    names = [link.get("name") for link in root.findall("link")]
    (top,) = (name for name in names if name not in joints)

    def X_TL(name: str) -> Array:
        if name == top:
            return np.eye(4)
        joint = joints[name]
        origin = joint.find("origin")
        X_PC = np.eye(4) if origin is None else pose(*(numbers(origin.get(name, "0 0 0")) for name in ("xyz", "rpy")))
        X: Array = X_TL(joint.find("parent").get("link")) @ X_PC
        return X

    return top, {name: X_TL(name) for name in names}


def deviations(
    found: tuple[float, ArrayLike, ArrayLike], expected: Mapping[str, Any]
) -> tuple[float, float, float, float]:
    """Relative deviations of a body's mass, com and inertia from the expected ones.

    Returns:
        Mass relative to the mass, com relative to the radius of gyration, inertia relative to its largest entry, and
        the worst of the principal moments relative to itself.
    """
    mass, com, inertia = found[0], np.asarray(found[1]), np.asarray(found[2])
    true_com, true_inertia = np.asarray(expected["com"]), np.asarray(expected["inertia"])
    largest = float(np.max(np.abs(true_inertia)))
    gyration = float(np.sqrt(largest / expected["mass"]))
    moments, true_moments = np.linalg.eigvalsh(inertia), np.linalg.eigvalsh(true_inertia)
    return (
        abs(mass / expected["mass"] - 1),
        float(np.max(np.abs(com - true_com))) / gyration,
        float(np.max(np.abs(inertia - true_inertia))) / largest,
        float(np.max(np.abs(moments / true_moments - 1))),
    )
