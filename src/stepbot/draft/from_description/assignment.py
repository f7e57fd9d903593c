"""Assigns components to the links of a description.

A component whose faces contain vertices of one link's shapes belongs to that link. The others are assigned by the parts
they move with (the inferred links), by bounding box, or to the link of the nearest assigned component.
"""

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
from msgspec import Struct, field

from stepbot.draft.from_description.lines import ON_LINE
from stepbot.draft.from_description.placement import Placement
from stepbot.draft.from_description.skeleton import Skeleton
from stepbot.draft.from_description.surfaces import ON_FACE, Surfaces, spread
from stepbot.draft.inference import InferredMechanism
from stepbot.draft.mechanism.loops import TreeJoint
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.parts import box_gap
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array, corners
from stepbot.robot.model import JointKind
from stepbot.step.assembly import Assembly

_SAMPLE = 200
_RECOGNIZED, _AHEAD = 0.6, 0.2
"""Share of a component's faces from which it is recognized, and its required lead over other links'."""
_SLACK = 5e-4
"""Distance [m] by which a component may extend beyond the bounding box of a link's shapes."""
_INSIDE = 0.98
_CENTRE = 0.15
"""Deviation of a link's centre from the described centre of mass, as a share of its size, for unknown densities."""
_SLIDING = 1e-3


class Assignment(Struct, eq=False):
    """A link for each component with a body."""

    link_of: dict[int, str] = field(default_factory=dict)
    recognized: set[int] = field(default_factory=set)
    """Components whose faces contain vertices of the link's shapes."""
    guesses: dict[int, str] = field(default_factory=dict)
    """Reasons for guessed assignments."""
    inferred: set[int] = field(default_factory=set)
    """Components assigned by an inferred link with the same joint axes."""

    def members(self, link: str) -> list[int]:
        """The components of a link, ascending."""
        return sorted(i for i, name in self.link_of.items() if name == link)


def assign(
    described: Skeleton, placement: Placement, assembly: Assembly, inferred: InferredMechanism, surfaces: Surfaces
) -> Assignment:
    """Assign every component with a body to a described link."""
    return _Assigning(described, placement, assembly, inferred, surfaces).made()


class _Assigning:
    def __init__(
        self,
        described: Skeleton,
        placement: Placement,
        assembly: Assembly,
        inferred: InferredMechanism,
        surfaces: Surfaces,
    ) -> None:
        self._described, self._placement, self._inferred, self._surfaces = described, placement, inferred, surfaces
        self._parts = inferred.survey.parts
        self._group_of = described.rigid_groups()
        self._assembly = assembly
        self._result = Assignment()

    def made(self) -> Assignment:
        self._recognize()
        groups = self._groups_of_clusters()
        for n, members in enumerate(self._inferred.links):
            for i in members:
                if i not in self._result.link_of:
                    self._settle(i, n, groups.get(n))
        return self._result

    def _recognize(self) -> None:
        """Components with faces that the vertices of one link lie on."""
        with_points = {name: link for name, link in self._described.links.items() if len(link.points)}
        clouds = {name: self._placement.poses[name].apply(link.points) for name, link in with_points.items()}
        for i, part in self._parts.items():
            shares = []
            for name, cloud in clouds.items():
                near = cloud[((cloud >= part.box[0] - ON_FACE) & (cloud <= part.box[1] + ON_FACE)).all(axis=1)]
                shares.append((self._surfaces.covered(i, near), name))
            shares.sort(reverse=True)
            if not shares or shares[0][0] < _RECOGNIZED:
                continue
            if len(shares) == 1 or shares[0][0] - shares[1][0] >= _AHEAD:
                self._result.link_of[i] = shares[0][1]
                self._result.recognized.add(i)

    def _sample(self, i: int) -> Array:
        component = self._assembly.components[i]
        vertices = self._assembly.bodies[component.body].mesh.vertices
        return component.X_WC.apply(spread(np.asarray(vertices), _SAMPLE)) if len(vertices) else np.zeros((0, 3))

    def _groups_of_clusters(self) -> dict[int, str]:
        """For inferred links the rigid group with most of their recognized volume, else the one with their axes."""
        groups = {}
        incident = self._incident()
        for n, members in enumerate(self._inferred.links):
            volumes: dict[str, float] = defaultdict(float)
            for i in members:
                if i in self._result.recognized:
                    volumes[self._group_of[self._result.link_of[i]]] += self._parts[i].volume + 1e-15
            if volumes:
                groups[n] = max(volumes, key=lambda group: (volumes[group], group))
                continue
            group = self._by_axes(n, incident)
            if group is not None:
                groups[n] = group
        return groups

    def _incident(self) -> dict[str, dict[str, Axis]]:
        """For each rigid group its joints, with their axes as drawn."""
        axes: dict[str, dict[str, Axis]] = {group: {} for group in self._group_of.values()}
        for child, joint in self._described.joints.items():
            if joint.kind is not JointKind.FIXED:
                X_WC = self._placement.poses[child]
                axis = Axis(X_WC.p, None if joint.kind is JointKind.BALL else X_WC.turn(joint.axis))
                for end in (joint.parent, child):
                    axes[self._group_of[end]][child] = axis
        return axes

    def _by_axes(self, n: int, incident: Mapping[str, Mapping[str, Axis]]) -> str | None:
        """The group whose joints are on the axes of an inferred link; of several the one with its centre of mass."""
        own = [
            arc for arc in self._inferred.arcs if n in (arc.parent, arc.child) and arc.evidence.type != JointKind.FIXED
        ]
        best = None
        for group, axes in incident.items():
            common = sum(any(_is_on(arc, axis, self._kind(child)) for arc in own) for child, axis in axes.items())
            if common:
                rank = common - 0.5 * (len(own) + len(axes) - 2 * common), -self._apart(n, group)
                best = max(best or (rank, group), (rank, group))
        return None if best is None else best[1]

    def _kind(self, child: str) -> JointKind:
        return self._described.joints[child].kind

    def _apart(self, n: int, group: str) -> float:
        """Distance of an inferred link's centre from the group's centre of mass, relative to the assembly's size."""
        links = [self._described.links[name] for name, own in self._group_of.items() if own == group]
        mass = exact_sum(link.inertial.mass for link in links)
        if not mass:
            return 0.5
        coms = [link.inertial.mass * self._placement.poses[link.name].apply(link.inertial.com) for link in links]
        return float(np.linalg.norm(np.sum(coms, axis=0) / mass - self._centre(n))) / self._inferred.survey.extent

    def _centre(self, n: int) -> Array:
        members = self._inferred.links[n]
        weights = np.array([self._parts[i].volume + 1e-15 for i in members])
        return np.asarray(weights @ np.array([self._parts[i].com for i in members]) / weights.sum())

    def _settle(self, i: int, n: int, group: str | None) -> None:
        """Assign a component that was not recognized."""
        inside, sibling = self._inside(i), self._sibling(i)
        if sibling is not None:
            is_agreed = group is not None and self._group_of[sibling] == group
            self._put(i, sibling, "" if is_agreed else "it is with the other bodies of its part")
        elif group is not None:
            links = [name for name, own in self._group_of.items() if own == group]
            if len(links) == 1:
                guess = "" if self._is_sure(n, group) else "it moves with parts of this link by contacts"
                self._put(i, links[0], guess)
            else:
                within = [name for name in links if name in inside] or links
                named = [name for name in within if _plain(name) in self._words(i)]
                link = min(named or within, key=lambda name: (self._distance(i, name), name))
                chosen = "the one of its name" if named else "the nearest"
                self._put(i, link, f"one of several links that fixed joints hold together: {chosen}")
        elif len(inside) == 1:
            self._put(i, inside[0], "it is in the box around the shapes of this link")
        else:
            self._put(i, self._nearest(i), "nothing recognized it: it is with the nearest component")

    def _put(self, i: int, link: str, guess: str) -> None:
        self._result.link_of[i] = link
        if guess:
            self._result.guesses[i] = guess
        else:
            self._result.inferred.add(i)

    def _is_sure(self, n: int, group: str) -> bool:
        """Whether an inferred link without guesses has the described centre of mass."""
        members = self._inferred.links[n]
        if any(i in self._inferred.guesses for i in members):
            return False
        if any(i in self._result.recognized for i in members):
            return True
        return self._apart(n, group) * self._inferred.survey.extent < _CENTRE * self._inferred.survey.size_of(members)

    def _inside(self, i: int) -> list[str]:
        """Links whose bounding box contains a component."""
        sample = self._sample(i)
        inside = []
        for name, link in self._described.links.items():
            if len(link.points) and len(sample):
                own = self._placement.poses[name].inverse().apply(sample)
                low, high = corners(link.points)
                if ((own >= low - _SLACK) & (own <= high + _SLACK)).all(axis=1).mean() >= _INSIDE:
                    inside.append(name)
        return inside

    def _sibling(self, i: int) -> str | None:
        """The link of all recognized bodies of the same part; None if there is none, or more than one."""
        above = self._assembly.components[i].parent
        near = {self._result.link_of[k] for k in self._assembly.children[above] if k in self._result.recognized}
        return near.pop() if len(near) == 1 and above > 0 and self._is_part(above) else None

    def _is_part(self, component: int) -> bool:
        """Whether a component is a part with several bodies, not a subassembly."""
        return all(not self._assembly.children[k] for k in self._assembly.children[component])

    def _words(self, i: int) -> set[str]:
        """Names of a component and its ancestors."""
        return {_plain(segment) for segment in self._assembly.components[i].path.split("/")}

    def _distance(self, i: int, link: str) -> float:
        """Distance [m] of a component from the centre of mass of a link; infinite if the link is massless."""
        one = self._described.links[link]
        if not one.inertial.mass:
            return np.inf
        centre = self._placement.poses[link].apply(one.inertial.com)
        return float(np.linalg.norm(centre - self._parts[i].com))

    def _nearest(self, i: int) -> str:
        box = self._parts[i].box
        known = sorted(self._result.recognized)
        if known:
            nearest = min(
                known,
                key=lambda k: (
                    round(box_gap(box, self._parts[k].box), 9),
                    round(float(np.linalg.norm(self._parts[k].com - self._parts[i].com)), 9),
                    k,
                ),
            )
            return self._result.link_of[nearest]
        return min(self._described.links, key=lambda name: (self._distance(i, name), name))


def _plain(name: str) -> str:
    return "".join(c for c in name.casefold() if c.isalnum())


def _is_on(arc: TreeJoint, axis: Axis, kind: JointKind) -> bool:
    """Whether an inferred joint is on a described axis; for prismatic joints only the direction counts."""
    own = arc.evidence.axis
    if own.direction is None or axis.direction is None:
        return float(np.linalg.norm(own.point - axis.point)) < ON_LINE
    if kind is JointKind.PRISMATIC:
        return arc.evidence.type == JointKind.PRISMATIC and own.is_along(axis.d, _SLIDING)
    return own.same(axis, ON_LINE)
