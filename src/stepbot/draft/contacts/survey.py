"""The facts about an assembly before anything is decided: parts, contacts, relations, subassemblies, motors."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.draft.contacts.captured import Captured, find_captured
from stepbot.draft.contacts.contacts import Contacts, Pair
from stepbot.draft.contacts.near_fits import ANGLE, OFFSET, NearFit, find_near_fits
from stepbot.draft.contacts.planes import find_patches
from stepbot.draft.contacts.relations import Relation, Via, find_relations, neighbours, turned_lines
from stepbot.draft.contacts.roles import find_loops, read_parts, spoken_names
from stepbot.draft.contacts.settling import is_tilted, settled
from stepbot.draft.contacts.shafts import find_fits, find_sockets
from stepbot.draft.contacts.teeth import (
    Gear,
    Mesh,
    Rack,
    RackMesh,
    Rim,
    find_gears,
    find_meshes,
    find_rack_meshes,
    teeth_of,
)
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.equal import EqualParts
from stepbot.draft.parts.names import Role, is_belt, is_drive, roles
from stepbot.draft.parts.parts import Boxes, joint_box, largest
from stepbot.draft.parts.scene import Scene
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import IDENTITY, Array, Pose
from stepbot.step.assembly import Assembly
from stepbot.step.features.axes import ANGLE_TOLERANCE, DISTANCE_TOLERANCE
from stepbot.step.features.ground import grounds

_BALL = 0.3
"""Ratio of the radius of a ball and the size of its stud, up to which it is no spherical washer."""
_SMALL_SHARE = 0.35
"""Share of the assembly's size from which a part is not a fastener, whatever its name."""
_BLOCK = 2
"""Holes in line with those of each of two parts, from which what is no turned part holds both together."""
_LARGE = 0.2
"""Share of the assembly's volume from which a turned part is not a fastener, whatever its name."""
_SPINDLE = 20.0
"""Length in radii from which a turned part is a rod."""
_SCREW_REACH = 4e-3
"""Distance [m] from a screw's bounding box within which it clamps."""


class Sources(Struct, frozen=True):
    """Sources of evidence besides the geometry."""

    names: bool = True
    tree: bool = True
    """Whether to use subassemblies."""


ALL_SOURCES = Sources()


class Survey:
    """The facts that all evidence is drawn from."""

    def __init__(self, assembly: Assembly, sources: Sources, moved: Mapping[int, Pose] | None = None) -> None:
        self.assembly, self.sources = assembly, sources
        self.moved = moved or {}
        """How parts were moved in the assembly before anything was compared: those that are drawn off what they fit."""
        self.scene = Scene(assembly)
        self.contacts = find_contacts(self.scene)
        self.relations = find_relations(self.scene, self.contacts)
        self.near = neighbours(self.relations)
        self.turned = turned_lines(self.contacts)
        self.parts = read_parts(self.scene, self.contacts, use_names=sources.names)
        self.box = joint_box(self.parts.values())
        self.extent = self.size_of(self.parts)
        self.volume = exact_sum(part.volume for part in self.parts.values()) or 1.0
        self.cut: dict[str, None] = {}
        """Searches that a bound cut short, in words, in the order in which they were."""
        self.equal = EqualParts(self.scene, self.cut)
        named = {i for i, p in self.parts.items() if sources.names and is_belt(p.name) and not self._is_turned(i)}
        self._belts = find_loops(self.scene, self.parts, self.contacts.lines, named)
        self.small = {*self._belts} | {i for i, p in self.parts.items() if p.is_small and self._is_trifle(i)}
        """Parts that move with their host and form no joint: fasteners, seals, and belts, which are no rigid bodies."""

    @staticmethod
    def settled(assembly: Assembly, sources: Sources) -> "Survey":
        """The facts once pieces that touch nothing are where their nearly coaxial faces belong."""
        drawn = Survey(assembly, sources)
        contacts = drawn.relations, drawn.near_fits
        moved = settled(drawn.scene, drawn.parts, drawn.small, *contacts, drawn.one_part, drawn.cut)
        if not moved:
            return drawn
        components = tuple(
            replace(component, X_WC=moved[component.index] @ component.X_WC) if component.index in moved else component
            for component in assembly.components
        )
        return Survey(replace(assembly, components=components), sources, moved)

    @cached_property
    def slack(self) -> tuple[float, float]:
        """Distance [m] and angle [rad] up to which faces that do not touch are on one line: more if parts are off."""
        is_off = self.moved or any(is_tilted(patch) for r in self.relations.values() for patch in r.patches)
        return (0.5 * OFFSET, 0.5 * ANGLE) if is_off else (DISTANCE_TOLERANCE, ANGLE_TOLERANCE)

    def as_drawn(self, axis: Axis, parts: Sequence[int]) -> Axis:
        """Where an axis is in the assembly as drawn, by that of some parts which has moved least."""
        shifts = [float(np.linalg.norm(self.moved[i].apply(axis.point) - axis.point)) for i in parts if i in self.moved]
        if len(shifts) < len(parts):
            return axis
        return axis.moved(self.moved[[*parts][int(np.argmin(shifts))]].inverse())

    def drawn_off(self, parts: Iterable[int], at: Array) -> float:
        """How far some parts are drawn off each other at a point [m], at most."""
        places = np.array([self.moved.get(i, IDENTITY).inverse().apply(at).reshape(3) for i in parts])
        return float(np.max(np.linalg.norm(places[:, None] - places[None], axis=2)))

    def _is_trifle(self, part: int) -> bool:
        """Whether a part that is named a fastener may be one: it is small, or turned, and no ball stud in a socket."""
        one = self.parts[part]
        if any(r.via == Via.BALL and r.radius < _BALL * one.size for r in self.near.get(part, ())):
            return False
        is_turned = self._is_turned(part)
        if is_turned and part in self._spindles:
            return False
        if not is_turned and sum(r.holes >= _BLOCK for r in self.near.get(part, ())) > 1:
            return False  # a block that is screwed to two parts
        if one.size < _SMALL_SHARE * self.extent:
            return True
        return one.volume < _LARGE * self.volume and is_turned

    def _is_turned(self, part: int) -> bool:
        """Whether a part is symmetric about one of its lines: a pulley, though it is named after its belt."""
        return any(self.parts[part].is_balanced(axis) for axis in self.turned.get(part, ())[:3])

    @cached_property
    def _spindles(self) -> set[int]:
        """Long rods, though named after their thread, in a drive nut or in line with the shaft of a motor."""
        spindles = set[int]()
        for line in self.contacts.lines:
            for part, faces in line.faces.items():
                shanks = [f.radius for f in faces if not f.bore and not f.cone]
                if not shanks or self.parts[part].size < _SPINDLE * max(shanks):
                    continue
                others = ((self.parts[i], f) for i, own in line.faces.items() if i != part for f in own)
                if any(is_drive(one.name) if f.bore else Role.MOTOR in one.roles for one, f in others):
                    spindles.add(part)
        return spindles

    def relation(self, a: int, b: int) -> Relation | None:
        """The relation of two parts; None if they do not touch."""
        return self.relations.get((min(a, b), max(a, b)))

    def around(self, part: int) -> Iterator[tuple[int, Relation]]:
        """The larger parts in contact with a part, with the relation."""
        for relation in self.near.get(part, ()):
            other = relation.other(part)
            if other not in self.small:
                yield other, relation

    def pairs(self) -> Iterator[tuple[Pair, Relation]]:
        """Relations between larger parts."""
        for pair, relation in self.relations.items():
            if not self.small.intersection(pair):
                yield pair, relation

    def holders(self, part: int) -> set[int]:
        """The parts that a part is fastened to."""
        return {other for other, r in self.around(part) if r.is_rigid or r.via == Via.RING}

    def node_roles(self, component: int) -> set[Role]:
        """The roles that a component's names indicate."""
        if not self.sources.names:
            return set()
        return {role for name in spoken_names(self.assembly.components[component]) for role in roles(name)}

    def bodies_of_same_part(self, part: int) -> list[int]:
        """The bodies of the product that a body belongs to, itself included; none where the tree does not count."""
        above = self.assembly.components[part].parent
        if not self.sources.tree or above <= 0:
            return []
        siblings = [i for i in self.assembly.children[above] if i in self.parts]
        return [i for i in siblings if not self.assembly.components[i].product]

    def are_bodies_of_one_part(self, a: int, b: int) -> bool:
        """Whether two bodies are of one product."""
        one, two = self.assembly.components[a], self.assembly.components[b]
        return self.sources.tree and one.parent == two.parent > 0 and not (one.product or two.product)

    @cached_property
    def one_part(self) -> list[list[int]]:
        """The bodies of each product with several, but for one that has all: no placement moves them apart."""
        one_of_each = {self.assembly.components[i].parent: i for i in self.parts}
        groups = map(self.bodies_of_same_part, one_of_each.values())
        return sorted(bodies for bodies in groups if 1 < len(bodies) < len(self.parts))

    def has_screw_at(self, axis: Axis) -> bool:
        """Whether a screw is on a line, near the given position."""
        lines, boxes, places = self._screws
        some, _ = places.within(np.array([axis.point, axis.point]), 2.0 * _SCREW_REACH)
        near = (axis.point > boxes[some, 0] - _SCREW_REACH) & (axis.point < boxes[some, 1] + _SCREW_REACH)
        return any(axis.same(lines[k]) for k in some[near.all(axis=1)].tolist())

    @cached_property
    def near_fits(self) -> dict[Pair, list[NearFit]]:
        """Nearly coaxial faces of larger parts: what their contacts may have meant to be."""
        return find_near_fits(self.scene, self.parts, self.small, self.contacts)

    def near_fits_of(self, parts: Iterable[int]) -> Iterator[tuple[Pair, list[NearFit]]]:
        """Those of some parts with any others."""
        pairs = sorted({pair for part in parts for pair in self._nearly_fitted.get(part, ())})
        return ((pair, self.near_fits[pair]) for pair in pairs)

    @cached_property
    def _nearly_fitted(self) -> dict[int, list[Pair]]:
        fitted: dict[int, list[Pair]] = defaultdict(list)
        for pair in self.near_fits:
            for part in pair:
                fitted[part].append(pair)
        return fitted

    @cached_property
    def captured(self) -> dict[Pair, Captured]:
        """Larger parts that others hold across a line, and not along it."""
        larger = [i for i in self.parts if i not in self.small]
        return find_captured(self.scene, self.relations, larger, self.cut)

    @cached_property
    def rims(self) -> dict[int, list[Rim]]:
        """Toothed rims of larger parts, about axes of their round faces."""
        larger = (self.scene.component(part) for part in self.parts if part not in self.small)
        return {
            one.index: [rim.placed(one.X_WC) for rim in rims]
            for one in larger
            if (rims := self.scene.of_definition(one.index, teeth_of).rims)
        }

    @cached_property
    def gears(self) -> list[Gear]:
        """Larger parts with teeth, or named gears or pulleys."""
        larger = {i: part for i, part in self.parts.items() if i not in self.small}
        return list(find_gears(larger, self.rims, self.contacts.lines))

    @cached_property
    def belted(self) -> dict[int, Axis]:
        """Larger parts that belts run around, with their axes."""
        return {i: axis for inner in self._belts.values() for i, axis in inner.items() if i not in self.small}

    @cached_property
    def meshes(self) -> list[Mesh]:
        """All pairs of gears that mesh, and of pulleys with one belt."""
        belts = [self.parts[i] for i in sorted(self._belts)]
        return list(find_meshes(self.scene, self.parts, self.gears, belts))

    @cached_property
    def rack_meshes(self) -> list[RackMesh]:
        """All gears that mesh with racks of larger parts."""
        racks: dict[int, Rack] = {}
        for part in self.parts if self.rims else ():
            rack = self.scene.of_definition(part, teeth_of).rack
            if rack is not None and part not in self.small:
                racks[part] = rack.placed(self.scene.component(part).X_WC)
        return list(find_rack_meshes(self.scene, self.gears, racks))

    @cached_property
    def top(self) -> int:
        """The highest component with more than one child."""
        top, children = 0, self.assembly.children
        while len(children[top]) == 1 and children[children[top][0]]:
            top = children[top][0]
        return top

    @cached_property
    def tops(self) -> set[int]:
        """Components that are no link: the highest one with more than one child, those above it, and machines in it.

        A machine is a subassembly that touches nothing else, and stands on the ground beside all of it.
        """
        tops, above = {-1, 0, self.top}, self.assembly.components[self.top].parent
        while above > 0:
            tops.add(above)
            above = self.assembly.components[above].parent
        apart: dict[int, set[int]] = {}
        for index in self.assembly.children[self.top] if self.sources.tree else ():
            if any(self.assembly.components[i].product for i in self.assembly.children[index]):
                inside = {i for i in self.assembly.subtree(index) if i in self.parts}
                if all(r.other(i) in inside for i in inside for r in self.near.get(i, ())):
                    apart[index] = inside
        if not apart:
            return tops
        every = grounds(self.assembly).items()
        up, standing = max(every, key=lambda one: exact_sum(one[1].values()), default=("z", {}))
        level = [k for k in range(3) if "xyz"[k] != up[-1]]
        numbers = [i for i, part in self.parts.items() if part.size]
        boxes = np.array([self.parts[i].box for i in numbers]).reshape(-1, 2, 3)[:, :, level]
        for index, inside in apart.items():
            others = boxes[np.isin(numbers, sorted(inside), invert=True)]
            if inside.isdisjoint(standing) or not len(others):
                continue
            low, high = self.box_of(inside)[:, level]
            if bool(((others[:, 0] > high) | (others[:, 1] < low)).any(axis=1).all()):
                tops.add(index)
        return tops

    def islands(self, members: Iterable[int]) -> list[list[int]]:
        """Parts in groups that touch each other."""
        inside = set(members)
        groups = Clusters(sorted(inside))
        for i in inside:
            for r in self.near.get(i, ()):
                if r.other(i) in inside:
                    groups.join(i, r.other(i))
        return list(groups.groups().values())

    def total_volume(self, members: Iterable[int]) -> float:
        """[m^3]."""
        return exact_sum(self.parts[i].volume for i in members)

    def parts_near(self, box: Array, reach: float) -> list[int]:
        """Parts whose bounding boxes are up to ``reach`` [m] from another box (2, 3)."""
        numbers, boxes = self._boxes
        return [numbers[k] for k in boxes.within(box, reach)[0].tolist()]

    def boxes_of(self, parts: Iterable[int]) -> tuple[list[int], Boxes]:
        """Those parts that have a bounding box, and these, to search the nearest."""
        numbers = [i for i in parts if self.parts[i].size]
        return numbers, Boxes(np.array([self.parts[i].box for i in numbers]).reshape(-1, 2, 3))

    def box_of(self, members: Iterable[int]) -> Array:
        """The bounding box (2, 3) [m] of parts."""
        return joint_box(self.parts[i] for i in members)

    def size_of(self, members: Iterable[int]) -> float:
        """Diagonal [m] of the bounding box of parts along the own axes of the largest, however all of it is turned."""
        drawn = [part for i in members if (part := self.parts[i]).size]
        return self.scene.size_of([part.index for part in drawn], largest(drawn).index) if drawn else 1.0

    @cached_property
    def larger(self) -> tuple[list[int], Boxes]:
        """The parts that are no fasteners, and their bounding boxes."""
        return self.boxes_of(i for i in self.parts if i not in self.small)

    @cached_property
    def _boxes(self) -> tuple[list[int], Boxes]:
        """The parts with a bounding box, and these."""
        return self.boxes_of(self.parts)

    @cached_property
    def _screws(self) -> tuple[list[Axis], Array, Boxes]:
        """Lines of fasteners, and the fasteners' bounding boxes (n, 2, 3), also sorted."""
        screws = self.small - self._belts.keys()
        rows = [(line.axis, part) for line in self.contacts.lines for part in line.faces if part in screws]
        boxes = np.array([self.parts[part].box for _, part in rows]).reshape(-1, 2, 3)
        return [axis for axis, _ in rows], boxes, Boxes(boxes)


def find_contacts(scene: Scene) -> Contacts:
    """All contacts between the parts of an assembly."""
    contacts = Contacts()
    find_fits(scene, contacts)
    find_patches(scene, contacts)
    find_sockets(scene, contacts)
    return contacts
