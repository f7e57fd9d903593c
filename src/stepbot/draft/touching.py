"""Contact properties of what touches the ground and the objects around a robot: wheels, casters, feet, fingers.

Each is a proposal by the place of a link: on the ground, or at the end of a gripper by its name.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from msgspec.structs import replace

from stepbot.draft.draft import Draft, DraftContact
from stepbot.draft.parts.names import Role, roles
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.inertia import vector
from stepbot.geometry.spatial import ZERO3, Array, perpendicular_frame
from stepbot.robot.joint_types import HINGES
from stepbot.robot.model import JointKind
from stepbot.sidecar.contact import ContactMaterial
from stepbot.step.assembly import Assembly

_NEAR = 0.1
"""Distance from the ground, as a share of a wheel's radius or a foot's size, of what touches it: meshes are coarse."""
_SLIDING = 0.02
"""The same share for what slides beside wheels, by its exact faces."""
_LEVEL = 0.05
"""Cosine of the angle between a wheel's axle and the vertical up to which it is level."""
_SEVERAL = 2
"""Number of wheels or feet on which a robot stands."""
_ROLLERS = 3
"""Number of links on a wheel from which they are its rollers."""
_LIMB = 2
"""Number of joints between the root and a foot."""


def contacts_of(draft: Draft, assembly: Assembly) -> tuple[DraftContact, ...]:
    """The contact properties of wheels, casters, feet and fingers, in the order of the links."""
    touching = _Touching(draft, assembly)
    wheels = list(touching.wheels())
    proposed = list(touching.on_wheels(wheels)) if len(wheels) >= _SEVERAL else list(touching.on_feet())
    taken = {one.link for one in proposed}
    proposed += [finger for finger in touching.fingers() if finger.link not in taken]
    order = {link.name: n for n, link in enumerate(draft.links)}
    return tuple(sorted(proposed, key=lambda one: (order[one.link], one.part)))


class _Touching:
    def __init__(self, draft: Draft, assembly: Assembly) -> None:
        self._draft, self._components, self._scene = draft, assembly.components, Scene(assembly)
        self._up = vector(draft.standing.up if draft.standing is not None else "z")
        bodies = assembly.bodies
        self._corners = {
            c.index: c.X_WC.apply(bodies[c.body].mesh.vertices)
            for c in assembly.components
            if c.body >= 0 and len(bodies[c.body].mesh.vertices)
        }
        self._members = {link.name: [i for i in link.components if i in self._corners] for link in draft.links}
        self._moving = {joint.child: joint for joint in draft.joints if joint.written is not JointKind.FIXED}
        self._below: dict[str, list[str]] = {link.name: [] for link in draft.links}
        for joint in draft.joints:
            self._below[joint.parent].append(joint.child)

    def wheels(self) -> Iterator[tuple[str, float]]:
        """The links that turn about level axles and whose rims are round and on the ground, with their radii [m]."""
        for name, joint in self._moving.items():
            axle = np.array(joint.direction or ZERO3)
            corners = self._points([name, *self._rollers(name)])
            is_level = joint.written in HINGES and abs(float(axle @ self._up)) < _LEVEL
            if not is_level or not len(corners) or self._rollers(joint.parent):
                continue
            spokes = (corners - joint.point) @ perpendicular_frame(axle)[:, :2]
            radius = float(np.linalg.norm(spokes, axis=1).max())
            sides = np.array([spokes.max(axis=0), -spokes.min(axis=0)])
            height = float(np.array(joint.point) @ self._up) - self._ground
            if sides.min() > (1.0 - _NEAR) * radius and abs(height - radius) < _NEAR * radius:
                yield name, radius

    def on_wheels(self, wheels: Sequence[tuple[str, float]]) -> Iterator[DraftContact]:
        """The tyres or rollers of wheels, and casters that do not roll."""
        names = {name for name, _ in wheels}
        axles = {name: float(np.array(self._moving[name].point) @ self._up) for name in names}
        level = min(axles[name] - radius for name, radius in wheels) + _SLIDING * min(radius for _, radius in wheels)
        for name in names:
            rollers = self._rollers(name)
            for link in rollers or [name]:
                what = "a roller" if rollers else "a tyre"
                yield replace(_rubber(link, f"{what} on the ground, of one of {len(names)} wheels"), rolls=not rollers)
        others = {link.name for link in self._draft.links} - names
        heights = {(link, i): self._lowest(i) for link in others - self._rolling(names) for i in self._members[link]}
        why = "on the ground beside wheels, and no joint rolls it: little friction instead"
        slide = level - min(axles[name] - radius for name, radius in wheels)
        supports = others & self._rolling(names) or any(height < level for height in heights.values())
        if not supports and heights and self._in_line(wheels):
            level = min(heights.values()) + slide
            why = "the lowest part of a base on wheels in one line, which leans on it: little friction"
        for (link, i), height in heights.items():
            if height < level:
                yield DraftContact(link, self._components[i].path, ContactMaterial.PTFE_ON_STEEL, why)

    def _in_line(self, wheels: Sequence[tuple[str, float]]) -> bool:
        """Whether wheels are on one axle line."""
        joints = [self._moving[name] for name, _ in wheels]
        axle = np.array(joints[0].direction or ZERO3)
        across = np.array([joint.point for joint in joints]) @ perpendicular_frame(axle)[:, :2]
        return float(np.ptp(across, axis=0).max()) < _SLIDING * wheels[0][1]

    def _lowest(self, index: int) -> float:
        """Height [m] of the lowest point of a part in the assembly."""
        has_faces = index in self._scene.boxes
        return self._scene.span(index, self._up)[0] if has_faces else self._height([index]) + self._ground

    def on_feet(self) -> Iterator[DraftContact]:
        """The ends of limbs on the ground, if the root is above it."""
        in_loops = {name for closure in self._draft.closures for name in (closure.link_a, closure.link_b)}
        turning = {name for name, joint in self._moving.items() if joint.written is JointKind.CONTINUOUS}
        ends = {name for name in self._members if not self._below[name] and self._joints_above(name) >= _LIMB} - turning
        feet = [name for name in self._members if name in ends - in_loops and self._is_on_ground(self._members[name])]
        if len(feet) >= _SEVERAL and not self._is_on_ground(self._members[self._draft.root]):
            yield from (_rubber(name, f"the end of one of {len(feet)} limbs on the ground") for name in feet)

    def fingers(self) -> Iterator[DraftContact]:
        """Moving links at the end of the tree with the name of a finger, or a part with such a name."""
        for link in self._draft.links:
            products = (self._components[i].product for i in self._members[link.name])
            named = any(Role.JAW in roles(name) for name in (link.name, link.drawn, *products))
            if named and link.name in self._moving and not self._below[link.name]:
                yield DraftContact(link.name, "", ContactMaterial.SILICONE_ON_OILED_STEEL, "a finger by its name")

    @cached_property
    def _ground(self) -> float:
        """Height [m] of the lowest point."""
        return min((float((points @ self._up).min()) for points in self._corners.values()), default=0.0)

    def _height(self, members: Sequence[int]) -> float:
        """Height [m] of the lowest point of parts above the ground."""
        return min(float((self._corners[i] @ self._up).min()) for i in members) - self._ground

    def _is_on_ground(self, members: Sequence[int]) -> bool:
        points = np.concatenate([self._corners[i] for i in members] or [np.zeros((1, 3))])
        return bool(members) and self._height(members) < _NEAR * float(np.linalg.norm(np.ptp(points, axis=0)))

    def _points(self, links: Sequence[str]) -> Array:
        return np.concatenate([np.zeros((0, 3)), *(self._corners[i] for name in links for i in self._members[name])])

    def _rollers(self, wheel: str) -> list[str]:
        """The links that turn on a wheel, if they are as many as rollers are."""
        turning = [name for name in self._below[wheel] if name in self._moving]
        return turning if len(turning) >= _ROLLERS and wheel in self._moving else []

    def _rolling(self, wheels: set[str]) -> set[str]:
        """Rollers of wheels, and balls in sockets."""
        balls = {name for name, joint in self._moving.items() if joint.written is JointKind.BALL}
        return balls.union(*(self._rollers(name) for name in wheels))

    def _joints_above(self, link: str) -> int:
        """Number of moving joints between a link and the root."""
        parents = {joint.child: joint.parent for joint in self._draft.joints}
        count = 0
        while link in parents:
            count += link in self._moving
            link = parents[link]
        return count


def _rubber(link: str, why: str) -> DraftContact:
    return DraftContact(link, "", ContactMaterial.RUBBER_ON_FLOOR, why)
