"""A maker's description of a robot in expected.json: joints, limits, masses, and poses of links.

Such an expected.json has a ``source`` beside ``links`` and ``joints``: the published description and its commit.
``drawn`` has the joint positions of the drawing, 0 by default.

Everything is in SI. A joint's ``xyz`` and ``rpy`` place its child in its parent at q = 0, rpy about the fixed axes x,
y, z as in URDF; a link's ``inertia`` is about its centre of mass, along its own axes.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from .moments import Array, pose, turn


@dataclass(frozen=True)
class DescribedMimic:
    """q = multiplier * q_leader + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class DescribedJoint:
    """A joint of the maker's description."""

    name: str
    kind: str
    parent: str
    child: str
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    lower: float = -inf
    upper: float = inf
    velocity: float = inf
    effort: float = inf
    mimic: DescribedMimic | None = None

    @property
    def X_PC(self) -> Array:
        """Pose of the child in the parent at q = 0, shape (4, 4) [m]."""
        roll, pitch, yaw = self.rpy
        return pose(self.xyz, turn("z", yaw) @ turn("y", pitch) @ turn("x", roll))

    def motion(self, q: float) -> Array:
        """The child's motion in its own axes, shape (4, 4) [m], at a position [rad] or [m]."""
        axis = np.array(self.axis)
        if self.kind == "prismatic":
            return pose(q * axis)
        return pose() if self.kind == "fixed" else pose(rotation=_about(axis, q))


@dataclass(frozen=True)
class Description:
    """The maker's description: a tree of links and joints."""

    root: str
    joints: Mapping[str, DescribedJoint]
    """By name, each after the joint of its parent."""
    drawn: Mapping[str, float]

    def positions(self, given: Mapping[str, float]) -> dict[str, float]:
        """The position of every movable joint [rad] or [m]: 0 by default; mimics follow their leaders."""
        q = {name: given.get(name, 0.0) for name, joint in self.joints.items() if joint.kind != "fixed"}
        for name, joint in self.joints.items():
            if joint.mimic is not None:
                q[name] = joint.mimic.multiplier * q[joint.mimic.joint] + joint.mimic.offset
        return q

    def poses(self, given: Mapping[str, float]) -> dict[str, Array]:
        """X_RL of every link in the root's frame, shape (4, 4) [m], at joint positions [rad] or [m]."""
        q = self.positions(given)
        found = {self.root: pose()}
        for name, joint in self.joints.items():
            found[joint.child] = found[joint.parent] @ joint.X_PC @ joint.motion(q.get(name, 0.0))
        return found

    def random_positions(self, count: int, seed: int) -> Iterator[dict[str, float]]:
        """Random positions [rad] or [m] within the limits and within +-pi; the same for the same seed."""
        generator = np.random.default_rng(seed)
        for _ in range(count):
            at = {
                name: float(generator.uniform(max(joint.lower, -np.pi), min(joint.upper, np.pi)))
                for name, joint in self.joints.items()
                if joint.kind != "fixed"
            }
            yield self.positions(at)


def load_description(expected: Path) -> Description:
    """Read an expected.json with a source.

    Raises:
        KeyError: It has no joints.
        ValueError: Its joints are not a tree, or not in the order of the tree.
    """
    content = json.loads(expected.read_text(encoding="utf-8"))
    joints = {name: _joint(name, said) for name, said in content["joints"].items()}
    children = {joint.child for joint in joints.values()}
    roots = [link for link in content["links"] if link not in children]
    if len(roots) != 1 or len(children) != len(joints):
        raise ValueError(f"{expected}: a tree has one root and one joint above each other link, not {roots}")
    known = {roots[0]}
    for joint in joints.values():
        if joint.parent not in known:
            raise ValueError(f"{expected}: joint '{joint.name}' stands before the one that carries '{joint.parent}'")
        known.add(joint.child)
    return Description(roots[0], joints, content.get("drawn", {}))


def _joint(name: str, said: Mapping[str, Any]) -> DescribedJoint:
    given: dict[str, Any] = {key: said[key] for key in ("lower", "upper", "velocity", "effort") if key in said}
    for key in ("xyz", "rpy", "axis"):
        if key in said:
            given[key] = _three(said[key])
    if "mimic" in said:
        given["mimic"] = DescribedMimic(**said["mimic"])
    return DescribedJoint(name, said["kind"], said["parent"], said["child"], **given)


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z


def _about(axis: Array, angle: float) -> Array:
    """Rotation, shape (3, 3), about a unit axis, shape (3,), by an angle [rad]: Rodrigues' formula."""
    x, y, z = axis
    K = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    R: Array = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
    return R
