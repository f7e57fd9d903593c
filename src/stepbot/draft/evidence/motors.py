"""Finds motors: one part, or a subassembly of case, output and screws; by name, else by the use of equal parts."""

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct

from stepbot.draft.contacts.relations import Relation, Via, is_even
from stepbot.draft.contacts.roles import spoken_names
from stepbot.draft.contacts.shafts import HALF_ROUND
from stepbot.draft.contacts.survey import Survey
from stepbot.draft.evidence import rule
from stepbot.draft.evidence.evidence import Apart, Evidence
from stepbot.draft.parts.axis import Axis
from stepbot.draft.parts.clusters import Clusters
from stepbot.draft.parts.names import Role, roles
from stepbot.draft.parts.parts import largest
from stepbot.geometry.spatial import perpendicular_frame
from stepbot.step.assembly import Component

_LARGEST = 0.6
"""Share of the assembly's size from which a subassembly is more than a motor."""
_BLOCK = 0.35
"""Share of its bounding box that a motor fills; a bracket, a folded sheet, fills less."""
_SHEET, _PLATE, _TOOTHED = 0.2, 0.1, 0.4
"""Shares of its bounding box, and of its width, up to which what is named after a motor is a bent sheet, or a plate;
radius of teeth, as a share of its middle dimension, from which it is a gear.
"""
_WIRE = 5e-7
"""Volume [m^3] below which what is named after a motor is a wire, a plug or a screw of it."""
_PIECE = 0.15
"""Share of the volume of a motor's case up to which another part of it is its shaft or horn."""
_FLANGES = ((7.5e-3, 11.31e-3), (11e-3, 16.26e-3), (11e-3, 18.38e-3), (11e-3, 21.92e-3), (19.05e-3, 33.34e-3),
            (36.5e-3, 49.21e-3))  # fmt: skip
"""Radii [m] of the spigot and the circle of holes of NEMA 8, 11, 14, 17, 23 and 34."""
_FLANGE_OFF, _CORNERS = 1.5e-4, 4
"""Difference [m] of these radii up to which a flange is one; number of holes."""
_GUEST, _ONE_CASE = 0.01, 0.95
"""Share of a motor's case from which what is in its bores is no dowel or stud; score of a linear actuator's case."""
_LEAST = 5e-3
"""Share of the assembly's volume from which an unnamed part may be a motor: screws and rings are smaller."""
_NUMBERED = re.compile(r"(?<=\w)[\s_.:-]*\d*$")
"""The number at the end of the name of one of several pieces."""
_SAME_AXIS = 5e-5
"""Distance [m] up to which axes of equal parts agree."""


_AROUND = 1.6
"""Ratio of the sizes of a subassembly and of a part in it, up to which it is a motor and this its case."""
_JOURNAL = 0.1
"""Radius of a journal, as a share of the size of a part, from which it is a bearing block and no motor with a screw."""
_AS_WIDE = 0.95
"""Ratio of radii from which two axes of a part are used alike."""
_PIN, _RIM, _BAR = 4.0, 0.45, 4.0
"""Width in radii of its fit, up to which what turns in a part is a pin; share of a part's width, from which the radius
of what is around it is that of a tyre or a clamp; length in widths from which a part with a bore in its end is a bar.
"""
_ABOUT = (Via.RING, Via.FACE, Via.PIN)


class _Vote(Struct, eq=False):
    """An axis in the frame of a kind of parts, and which of these touch something about it."""

    axis: Axis
    radius: float
    voters: set[int]


class Motor(Struct, frozen=True, eq=False):
    """A motor."""

    path: str
    """Of its component: several motors have one name."""
    parts: tuple[int, ...]
    case: int
    outputs: tuple[int, ...] = ()
    """Parts that are named a horn or an idler."""
    is_named: bool = True


def find_motors(survey: Survey) -> list[Motor]:
    """All motors; by use only if no name and no flange indicates one."""
    by_name = [m for m in _named_motors(survey) if not _pistons(survey, m)] if survey.sources.names else []
    known = {i for motor in by_name for i in motor.parts}
    by_size = [motor for motor in _motors_by_size(survey) if known.isdisjoint(motor.parts)]
    return [*by_name, *by_size] or _motors_by_use(survey)


def _pistons(survey: Survey, motor: Motor) -> set[int]:
    """The parts of a motor with room to travel in another one: it is a linear actuator, whose output slides."""
    inside = [r for i in motor.parts for r in survey.near.get(i, ()) if r.is_piston and r.other(i) in motor.parts]
    return {fit.shaft for r in inside for fit in r.shafts}


@rule(15)
def actuator_evidence(survey: Survey, evidence: Evidence) -> None:
    """Bodies of a linear actuator that are named a motor and touch are one case; its pistons are apart from them."""
    for motor in _named_motors(survey) if survey.sources.names else ():
        pistons = _pistons(survey, motor)
        named = [i for i in motor.parts if i in pistons or Role.MOTOR in survey.parts[i].roles] if pistons else []
        for a, b in combinations(sorted(named), 2):
            if pistons & {a, b}:
                evidence.apart.append(Apart(_ONE_CASE, a, b))
            elif survey.relation(a, b) is not None:
                evidence.weld(_ONE_CASE, a, b, "bodies of a linear actuator")


def _named_motors(survey: Survey) -> list[Motor]:
    """The highest component of each motor that is one motor and not a folder of several."""
    assembly, parts = survey.assembly, survey.parts
    named = {c.index for c in assembly.components[1:] if _is_named_motor(spoken_names(c))}
    in_pieces = {c.index for c in assembly.components[1:] if _is_in_pieces(survey, c.index, named)}
    named |= in_pieces
    taken: set[int] = set()
    cases: list[tuple[Component, tuple[int, ...]]] = []
    for c in assembly.components[1:]:
        if c.index not in named or c.index in taken or _is_folder(survey, c.index, named):
            continue
        below = assembly.subtree(c.index)
        members = tuple(i for i in below if i in parts)
        is_one = len(members) in (1, len(parts))
        if members and (is_one or survey.size_of(members) <= _LARGEST * survey.extent):
            taken.update(below)
            cases.append((c, members))
    motors = []
    shafts = _shafts(survey, [members for _, members in cases])
    for c, members in _reunited(survey, cases, shafts):
        if survey.total_volume(members) < _WIRE:
            continue
        turning = {i for i in members if {Role.WHEEL, Role.HORN} & {*parts[i].roles}}
        case = largest([parts[i] for i in members if i not in turning] or [parts[i] for i in members]).index
        if _is_bracket(survey, case, members) or (len(members) == 1 and not _is_block(survey, case)):
            continue
        turning |= {i for i in members if i in shafts or (c.index in in_pieces and _is_piece(survey, i, case))}
        outputs = tuple(i for i in members if i in turning - {case} and Role.FASTENER not in parts[i].roles)
        motors.append(Motor(c.path, members, case, outputs))
    return motors


def _is_bracket(survey: Survey, case: int, members: Sequence[int]) -> bool:
    """Whether what is named after a motor has others in bores on two lines, as the end of an axis beside its motor."""
    least, lines = _GUEST * survey.parts[case].volume, list[Axis]()
    for other, r in survey.around(case):
        if other not in members and survey.parts[other].volume > least:
            lines += [fit.axis for fit in r.shafts if fit.shaft == other and fit.full]
    return any(not line.same(lines[0], _SAME_AXIS) for line in lines[1:])


def _shafts(survey: Survey, motors: Sequence[tuple[int, ...]]) -> dict[int, int]:
    """Shafts that are products named after a motor: for each the part of the one motor that it turns in.

    A piece with the name of the case and a number may be anything of a motor.
    """
    named = {i: members for members in motors for i in members}
    shafts = {}
    for part in (members[0] for members in motors if len(members) == 1):
        inside = [(i, r) for i, r in survey.around(part) if i in named and named[i] != named[part]]
        if any(_own_name(survey, i) == _own_name(survey, part) for i, _ in inside):
            continue
        least = survey.parts[part].volume / _PIECE
        if len({named[i] for i, _ in inside}) != 1 or survey.total_volume(named[inside[0][0]]) < least:
            continue
        if all(r.turns is not None and survey.parts[part].is_balanced(r.turns) for _, r in inside):
            shafts[part] = inside[0][0]
    return shafts


def _own_name(survey: Survey, part: int) -> str:
    return _NUMBERED.sub("", survey.parts[part].name)


def _reunited(
    survey: Survey, cases: Sequence[tuple[Component, tuple[int, ...]]], shafts: Mapping[int, int]
) -> list[tuple[Component, tuple[int, ...]]]:
    """Motors, those that were imported as several products as one, named after its largest part.

    Such products are shafts, and pieces with numbered names.

    The pieces of one motor touch each other, and no two of them are equal.
    """
    numbered: dict[tuple[int, str], list[int]] = defaultdict(list)
    for n, (c, _) in enumerate(cases):
        numbered[c.parent, _NUMBERED.sub("", c.product)].append(n)
    owner = {i: n for n, (_, members) in enumerate(cases) for i in members}
    tied = Clusters(range(len(cases)))
    for shaft, inside in shafts.items():
        tied.join(owner[shaft], owner[inside])
    for alike in numbered.values():
        for n in alike:
            touching = {owner.get(r.other(i), n) for i in cases[n][1] for r in survey.near.get(i, ())}
            for m in sorted(touching.intersection(alike)):
                kinds = [survey.equal.kinds(cases[k][1]) for k in {*tied.members(n), *tied.members(m)}]
                if len(set(kinds)) == len(kinds):
                    tied.join(n, m)
    motors = []
    for group in tied.groups().values():
        first = max(group, key=lambda n: (survey.total_volume(cases[n][1]), -n))
        motors.append((cases[first][0], tuple(sorted(i for n in group for i in cases[n][1]))))
    return motors


def _is_named_motor(names: list[str]) -> bool:
    """Whether the first role is a motor's: a screw of a motor is a screw."""
    named_roles = [role for name in names for role in roles(name)]
    return bool(named_roles) and named_roles[0] == Role.MOTOR


def _is_in_pieces(survey: Survey, index: int, named: set[int]) -> bool:
    """Whether all parts of a subassembly are named after one motor, and one of them is its case."""
    children = survey.assembly.children[index]
    if index in named or len(children) < 2 or not named.issuperset(children):
        return False
    volumes = sorted(survey.total_volume(_parts_below(survey, child)) for child in children)
    return volumes[-2] < _PIECE * volumes[-1]


def _is_piece(survey: Survey, part: int, case: int) -> bool:
    """Whether a part of a motor is its shaft or horn: smaller than its case, and no body of the same product."""
    assembly = survey.assembly
    same = assembly.components[part].parent == assembly.components[case].parent
    is_own = same and not assembly.components[part].product
    return part != case and not is_own and survey.parts[part].volume < _PIECE * survey.parts[case].volume


def _is_folder(survey: Survey, index: int, named: set[int]) -> bool:
    """Whether a component contains motors: subassemblies of their own, or several of one product.

    Equal ones may be products of their own with a number each.
    """
    assembly = survey.assembly
    motors = [i for i in assembly.children[index] if i in named]
    if any(assembly.components[j].product for i in motors for j in assembly.children[i]):
        return True
    kinds = Counter(
        (_NUMBERED.sub("", assembly.components[i].product), f"{survey.total_volume(_parts_below(survey, i)):.4g}")
        for i in motors
    )
    return any(n > 1 for n in kinds.values())


def _parts_below(survey: Survey, index: int) -> list[int]:
    return [i for i in survey.assembly.subtree(index) if i in survey.parts]


def _motors_by_size(survey: Survey) -> list[Motor]:
    """Unnamed blocks with the spigot and the four holes of a stepper motor's flange."""
    bosses: dict[int, list[tuple[Axis, float]]] = defaultdict(list)
    holes: dict[int, list[Axis]] = defaultdict(list)
    for line in survey.contacts.lines:
        for i, faces in line.faces.items():
            part = survey.parts[i]
            if part.role is None and i not in survey.small and part.volume > _WIRE:
                full = [face for face in faces if face.span > HALF_ROUND and not face.cone]
                bosses[i] += [(line.axis, face.radius) for face in full if not face.bore]
                holes[i] += [line.axis] if any(face.bore for face in full) else []
    cases = [i for i in sorted(bosses) if _has_flange(bosses[i], holes[i]) and survey.scene.fill(i) > _BLOCK]
    motors = []
    for i in cases:
        equal = [k for k in cases if survey.equal.kind(k) == survey.equal.kind(i)]
        motors.append(Motor(survey.parts[i].path, _around_case(survey, i, equal), i, is_named=False))
    return motors


def _has_flange(bosses: Sequence[tuple[Axis, float]], holes: Sequence[Axis]) -> bool:
    """Whether one of some spigots has four holes around it, as a flange of NEMA ICS 16 has."""
    for axis, radius in bosses:
        for spigot, circle in _FLANGES:
            if abs(radius - spigot) < _FLANGE_OFF:
                around = [h for h in holes if h.is_along(axis.d) and abs(axis.distance(h.point) - circle) < _FLANGE_OFF]
                if len(around) == _CORNERS:
                    return True
    return False


def _motors_by_use(survey: Survey) -> list[Motor]:
    """Equal blocks that are mounted off an axis and drive about it, each about the same axis of their shape.

    Mirror images are links of a left and a right limb: motors are bought.
    """
    equal: dict[tuple[int, bool], list[int]] = defaultdict(list)
    sliding = {i for pair, captured in survey.captured.items() if captured.is_profile for i in pair}
    for i, part in survey.parts.items():
        if (
            i not in sliding
            and not part.is_small
            and part.volume > _LEAST * survey.volume
            and survey.scene.fill(i) > _BLOCK
            and _is_block(survey, i)
        ):
            equal[survey.equal.turned_kind(i)].append(i)
    cases = [i for members in equal.values() if _is_used_like_motors(survey, members) for i in members]
    motors: dict[tuple[int, ...], Motor] = {}
    for i in sorted(cases, key=lambda i: (-survey.parts[i].volume, i)):
        members = _around_case(survey, i, cases)
        count = len(equal[survey.equal.turned_kind(i)])
        carries = any(len(equal[survey.equal.turned_kind(k)]) > count for k in members if k in cases)
        if not carries and not any(i in known for known in motors):
            motors[members] = Motor(survey.parts[i].path, members, i, is_named=False)
    return list(motors.values())


def _around_case(survey: Survey, case: int, cases: Sequence[int]) -> tuple[int, ...]:
    """The parts of the highest subassembly that is hardly larger than a motor's case, around each equal case."""
    members: tuple[int, ...] = (case,)
    if not survey.sources.tree:
        return members
    assembly = survey.assembly
    nodes = [i for i in cases if survey.equal.kind(i) == survey.equal.kind(case)]
    mine = nodes.index(case)
    while True:
        nodes = [assembly.components[node].parent for node in nodes]
        inside = [tuple(i for i in assembly.subtree(node) if i in survey.parts) for node in nodes if node > 0]
        if len(set(inside)) < len(nodes) or len({len(parts) for parts in inside}) > 1:
            return members
        if survey.size_of(inside[mine]) > _AROUND * survey.parts[case].size:
            return members
        members = inside[mine]


def _is_block(survey: Survey, part: int) -> bool:
    """Whether a part may be all of a motor: no plate or bent sheet, and no gear, whose teeth are around it."""
    thin, middle, wide = sorted(survey.scene.extent(part).tolist())
    if any(rim.tip > _TOOTHED * middle for rim in survey.rims.get(part, ())):
        return False
    return survey.scene.fill(part) > _SHEET and thin > _PLATE * wide


def _is_worn(survey: Survey, case: int, other: int, r: Relation) -> bool:
    """Whether a fit is that of a pin in a bar, of a foot in its end, or of a tyre on its rim: the output of neither."""
    if r.via != Via.PIN or r.axis is None:
        return False
    across = perpendicular_frame(r.axis.d)[:, 0]
    widths = {k: float(np.ptp(survey.scene.span(k, across))) for k in (case, other)}
    is_bar = float(np.ptp(survey.scene.span(case, r.axis.d))) > _BAR * widths[case]
    is_pin = survey.parts[other].is_balanced(r.axis) and (
        is_bar or any(fit.shaft == other and widths[other] < _PIN * fit.radius for fit in r.shafts)
    )
    return any(is_pin if fit.shaft == other else fit.radius > _RIM * widths[case] for fit in r.shafts)


def _is_used_like_motors(survey: Survey, members: list[int]) -> bool:
    """Whether most members turn something about one axis of their definition, and are held off it."""
    if _are_of_limbs(survey, members):
        return False
    votes: list[_Vote] = []
    held = 0
    for i in members:
        kind, volume = survey.equal.kind(i), survey.parts[i].volume
        others = [(other, r) for other, r in survey.around(i) if survey.equal.kind(other) != kind]
        about = [(other, r) for other, r in others if r.via in _ABOUT and r.axis is not None and not _holds_corners(r)]
        least = _JOURNAL * survey.parts[i].size
        if any(fit.shaft != i and fit.radius > least for _, r in about for fit in r.journals):
            return False  # a shaft runs in it: a bearing block
        if any(fit.shaft == other and survey.parts[other].volume > volume for other, r in others for fit in r.shafts):
            return False  # what is in it is heavier: a clamp around a motor
        on = [r for other, r in about if not _is_worn(survey, i, other, r)]
        off = any((r.turns is None or _holds_corners(r)) and (r.is_rigid or r.patches) for _, r in others)
        held += bool(on) and off
        for r in on:
            assert r.axis is not None
            local, radius = survey.equal.axes(i, r.axis), max(r.radius, r.ring_radius)
            for vote in votes:
                if any(vote.axis.same(axis, _SAME_AXIS) for axis in local):
                    vote.voters.add(i)
                    vote.radius = max(vote.radius, radius)
                    break
            else:
                votes.append(_Vote(local[0], radius, {i}))
    common = [vote.radius for vote in votes if len(vote.voters) >= max(2, 0.5 * len(members))]
    # A motor has one output. Several axes of one radius are those of screws.
    widest = max(common, default=0.0)
    return held >= 2 and sum(radius > _AS_WIDE * widest for radius in common) == 1


def _are_of_limbs(survey: Survey, members: Sequence[int]) -> bool:
    """Whether two products of one shape are in equal places: links of a left and a right limb.

    All that is connected to one is equal to what is connected to the other, but for what both are connected to.
    """
    if len(members) != 2 or len({survey.parts[i].definition for i in members}) == 1:
        return False
    sides = [{i} for i in members]
    front = [{i} for i in members]
    while front[0] or front[1]:
        front = [{k for i in some for k, _ in survey.around(i)} - side for some, side in zip(front, sides, strict=True)]
        sides = [side | some for some, side in zip(front, sides, strict=True)]
        front = [some - sides[1 - n] for n, some in enumerate(front)]
        one, two = map(survey.equal.kinds, front)
        if one != two:
            return False
    return True


def _holds_corners(r: Relation) -> bool:
    """Whether holes in a circle are at the corners of a rectangle, as the ears of a servo are."""
    return r.via == Via.RING and r.axis is not None and not is_even(r, r.axis)
