"""Kinematic pairs of a STEP file (ISO 10303-105, in AP214 and AP242), read from its text.

The kernel parses them but does not expose them to Python. A pair binds two placements, one on each link, by a joint:
revolute, prismatic, cylindrical, spherical, planar, screw, universal, rigid, or any combination of the six degrees of
freedom. The parts of a link are those of the occurrence that its representation is associated with; files without such
an association name links like occurrences or products.
"""

from pathlib import Path

from msgspec import Struct

from stepbot.geometry.spatial import Pose, cross, unit

from .entities import Entities, read_entities
from .part21 import opened

_MARK = b"KINEMATIC_JOINT"

_TX, _TY, _TZ, _RX, _RY, _RZ = range(6)
_DOFS: dict[str, tuple[int, ...]] = {
    "REVOLUTE_PAIR": (_RZ,),
    "PRISMATIC_PAIR": (_TX,),
    "CYLINDRICAL_PAIR": (_TZ, _RZ),
    "SPHERICAL_PAIR": (_RX, _RY, _RZ),
    "SPHERICAL_PAIR_WITH_PIN": (_RX, _RZ),
    "PLANAR_PAIR": (_TX, _TY, _RZ),
    "SCREW_PAIR": (_TZ, _RZ),
    "UNIVERSAL_PAIR": (_RX, _RZ),
    "UNCONSTRAINED_PAIR": (_TX, _TY, _TZ, _RX, _RY, _RZ),
    "FULLY_CONSTRAINED_PAIR": (),
}
"""Degrees of freedom of each pair type in its placement, which files may omit as derived."""
_GENERAL = "LOW_ORDER_KINEMATIC_PAIR"
"""A pair whose degrees of freedom are given by its flags."""
_SUFFIXES = ("_WITH_RANGE", "_RANGE")


class Occurrence(Struct, frozen=True):
    """A usage of a product in an assembly, as a link refers to it."""

    assembly: str
    """Name of the assembly's product."""
    product: str
    ordinal: int
    """n among the usages of this product name in this assembly, from 1 in file order."""


class KinematicLink(Struct, frozen=True):
    """A link of a mechanism."""

    name: str
    occurrences: tuple[Occurrence, ...] = ()
    """Its components, if the file states them."""


class KinematicPair(Struct, frozen=True):
    """A pair, in radians and in the file's unit of length."""

    name: str
    kind: str
    """``REVOLUTE_PAIR``, ``SCREW_PAIR``, ...: without the suffix of those that have ranges."""
    links: tuple[int, int]
    """Indices of the first and the second link."""
    placements: tuple[Pose, Pose]
    """On the first and on the second link, each in its own link's frame [file's unit of length]."""
    dofs: tuple[int, ...]
    """The free ones among translations along and rotations about x, y, z of the placement: 0 to 5."""
    is_stated: bool
    """Whether the file states the degrees of freedom, not only the type."""
    bounds: tuple[float | None, float | None] = (None, None)
    """Range of a single degree of freedom [rad, or file's unit of length]."""
    pitch: float | None = None
    """Pitch of a screw [file's unit of length per turn]."""


class Mechanism(Struct, frozen=True):
    """Links and pairs."""

    links: tuple[KinematicLink, ...]
    pairs: tuple[KinematicPair, ...]
    base: int | None
    """Index of the base link; None if the file does not state it."""
    unread: tuple[str, ...] = ()
    """Pairs without an equivalent joint, such as gears and cams, with their type."""


def has_mechanism(path: Path) -> bool:
    """Whether a STEP file contains kinematic pairs; False for a file that cannot be read."""
    try:
        with opened(path) as data:
            return data.find(_MARK) >= 0
    except OSError:
        return False


def read_mechanism(path: Path, encoding: str) -> Mechanism | None:
    """The kinematic pairs of a STEP file; None if there are none.

    Args:
        path: The file, which has been checked.
    """
    with opened(path) as data:
        if data.find(_MARK) < 0:
            return None
        entities = read_entities(data[:], encoding)
    return mechanism_of(entities)


def mechanism_of(entities: Entities) -> Mechanism | None:
    """The mechanism that entities describe; None without pairs."""
    numbers = entities.of("KINEMATIC_LINK")
    index = {number: i for i, number in enumerate(numbers)}
    occurrences = _occurrences_of_links(entities)
    links = tuple(KinematicLink(entities.name(n), tuple(occurrences.get(n, ()))) for n in numbers)
    ranges = _separate_ranges(entities)
    pairs, unread = [], []
    for number in entities.with_part("_PAIR", _SUFFIXES):
        kind = _kind(entities, number)
        joint = next((r for r in entities.references(number) if entities.keyword(r, "KINEMATIC_JOINT")), None)
        ends = [index[r] for r in entities.references(joint) if r in index] if joint is not None else []
        placements = [p for r in entities.references(number) if (p := placement(entities, r)) is not None]
        is_known = kind in _DOFS or (kind == _GENERAL and len(entities.flags(number)) == 6)
        if not is_known or len(ends) != 2 or len(placements) != 2:
            if joint is not None:
                unread.append(f"{entities.name(number) or f'#{number}'} ({kind.lower()})")
            continue
        pairs.append(_pair(entities, number, kind, (ends[0], ends[1]), (placements[0], placements[1]), ranges))
    return Mechanism(links, tuple(pairs), _base(entities, index), tuple(unread)) if pairs or unread else None


def placement(entities: Entities, number: int) -> Pose | None:
    """An ``AXIS2_PLACEMENT_3D`` or ``RIGID_PLACEMENT`` in the file's unit of length; None for other entities."""
    if not entities.keyword(number, "AXIS2_PLACEMENT_3D"):
        return None
    parts = [entities.numbers_below(r) for r in entities.references(number)]
    kinds = [entities.keyword(r, "DIRECTION") for r in entities.references(number)]
    points = [values for values, is_direction in zip(parts, kinds, strict=True) if not is_direction]
    directions = [values for values, is_direction in zip(parts, kinds, strict=True) if is_direction]
    if len(points) != 1 or any(len(values) != 3 for values in (*points, *directions)):
        return None
    try:
        z = unit(directions[0] if directions else (0.0, 0.0, 1.0))
        x = unit(directions[1] if len(directions) > 1 else ((0.0, 0.0, 1.0) if abs(z[0]) > 0.9 else (1.0, 0.0, 0.0)))
        y = unit(cross(z, x))
    except ValueError:
        return None
    columns = cross(y, z), y, z
    return Pose.of([[column[i] for column in columns] for i in range(3)], points[0])


def _kind(entities: Entities, number: int) -> str:
    """The most derived keyword of a pair, without the suffix for ranges."""
    for keyword in entities.keywords(number):
        base = keyword
        for suffix in _SUFFIXES:
            base = base.removesuffix(suffix)
        if base.endswith("_PAIR") and base not in ("KINEMATIC_PAIR", _GENERAL):
            return base
        if base.startswith("SPHERICAL_PAIR_WITH_PIN"):
            return "SPHERICAL_PAIR_WITH_PIN"
    return _GENERAL if entities.keyword(number, _GENERAL) else "KINEMATIC_PAIR"


def _pair(
    entities: Entities,
    number: int,
    kind: str,
    links: tuple[int, int],
    placements: tuple[Pose, Pose],
    ranges: dict[int, tuple[float | None, ...]],
) -> KinematicPair:
    flags = entities.flags(number)
    is_stated = len(flags) == 6 and kind != "SCREW_PAIR"
    dofs = tuple(i for i, free in enumerate(flags) if free) if is_stated else _DOFS[kind]  # a screw couples two of them
    own = entities.own_numbers(number)
    pitch = own[0] if kind == "SCREW_PAIR" and own else None
    bounds = (*(own[1:] if kind == "SCREW_PAIR" else own),) or ranges.get(number, ())
    low, high = (bounds[0], bounds[1]) if len(bounds) == 2 else (None, None)
    if any(freedom >= _RX for freedom in dofs):
        low, high = (None if bound is None else bound * angle_unit(entities) for bound in (low, high))
    name = entities.name(number)
    return KinematicPair(name, kind, links, placements, dofs, is_stated, (low, high), pitch)


def _separate_ranges(entities: Entities) -> dict[int, tuple[float | None, ...]]:
    """Ranges of AP214, which are separate entities: by the pair that they apply to."""
    ranges: dict[int, tuple[float | None, ...]] = {}
    for number in entities.with_part("_PAIR", ("_RANGE",)):
        referred = [r for r in entities.references(number) if _kind(entities, r) in _DOFS]
        if len(entities.references(number)) == 1 and referred:
            ranges[referred[0]] = entities.own_numbers(number)
    return ranges


def _base(entities: Entities, index: dict[int, int]) -> int | None:
    """The link whose representation the mechanism declares as its base."""
    for keyword in ("KINEMATIC_PROPERTY_MECHANISM_REPRESENTATION", "KINEMATIC_PROPERTY_REPRESENTATION_RELATION"):
        for number in entities.of(keyword):
            for representation in entities.references(number):
                if entities.keyword(representation, "RIGID_LINK_REPRESENTATION"):
                    links = [index[r] for r in entities.references(representation) if r in index]
                    if links:
                        return links[0]
    return None


def _occurrences_of_links(entities: Entities) -> dict[int, list[Occurrence]]:
    """For each link, the occurrences that its representation is associated with."""
    occurrences: dict[int, list[Occurrence]] = {}
    usages = _occurrences(entities)
    for number in entities.of("CONTEXT_DEPENDENT_KINEMATIC_LINK_REPRESENTATION"):
        reached = entities.reachable(number, depth=3)
        links = [r for r in reached if entities.keyword(r, "KINEMATIC_LINK")]
        for usage in (r for r in reached if r in usages):
            for link in links[:1]:
                occurrences.setdefault(link, []).append(usages[usage])
    return occurrences


def _occurrences(entities: Entities) -> dict[int, Occurrence]:
    occurrences: dict[int, Occurrence] = {}
    counts: dict[tuple[int, str], int] = {}
    for number in entities.of("NEXT_ASSEMBLY_USAGE_OCCURRENCE"):
        products = [r for r in entities.references(number) if entities.keyword(r, "PRODUCT_DEFINITION")]
        if len(products) != 2:
            continue
        above, below = (entities.product_name(product) for product in products)
        key = (products[0], below)
        counts[key] = counts.get(key, 0) + 1
        occurrences[number] = Occurrence(above, below, counts[key])
    return occurrences


def angle_unit(entities: Entities) -> float:
    """Radians per unit of plane angle of the mechanisms' context; 1 if none is declared."""
    contexts = [
        r
        for keyword in ("MECHANISM_REPRESENTATION", "KINEMATIC_TOPOLOGY_STRUCTURE", "RIGID_LINK_REPRESENTATION")
        for number in entities.of(keyword)
        for r in entities.references(number)
    ]
    for context in (*contexts, *entities.of("GLOBAL_UNIT_ASSIGNED_CONTEXT")):
        if not entities.keyword(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT"):
            continue
        for declared in entities.references(context):
            if entities.keyword(declared, "PLANE_ANGLE_UNIT"):
                factors = [value for r in entities.references(declared) for value in entities.numbers_below(r)]
                return factors[0] if entities.keyword(declared, "CONVERSION_BASED_UNIT") and factors else 1.0
    return 1.0
