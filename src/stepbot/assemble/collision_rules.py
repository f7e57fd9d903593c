"""The collision rule of each component and link: its own, or that of the defaults, with all budgets filled in."""

from msgspec import Struct

from stepbot.geometry.solids.collision_sets import CLOSE, FEW, MAX_HULLS, MAX_VERTICES
from stepbot.sidecar.contact import Contact
from stepbot.sidecar.document import Document
from stepbot.sidecar.shapes import CollisionSettings, CollisionShape, Derived, MergedCollision, is_for_mjx

MJX_FACES, MJX_HULLS = 20, 1
"""Maximum number of flat faces of a hull, and of hulls of a link, for MJX.

MJX compares each face of a hull with all of the other, and compiles a function for each pair of hulls that can touch
(decision 0045).
"""
_ROUND_OR_HOLLOW = (CollisionShape.CYLINDER, CollisionShape.MESH)
"""Shapes that MJX lacks: it takes the hull of a mesh, with all of its faces."""
DECOMPOSED = (CollisionShape.AUTO, CollisionShape.DECOMPOSE)
"""Types that treat a link as one solid."""


class CollisionRule(Struct, frozen=True):
    """A type of collision geometry and its budgets."""

    shape: CollisionShape
    max_hulls: int = MAX_HULLS
    """Only for :data:`DECOMPOSED`."""
    max_vertices: int | None = None
    """Of each hull; None for no limit."""
    max_faces: int | None = None
    """Of each hull; None for no limit, and :data:`MJX_FACES` for MJX, where no shape is a cylinder or a mesh."""

    @property
    def filled(self) -> float:
        """Share of the total volume of its shapes that a link has to fill."""
        return CLOSE if self.shape is CollisionShape.DECOMPOSE else FEW

    @property
    def is_decomposed(self) -> bool:
        """Whether it treats a link as one solid."""
        return self.shape in DECOMPOSED


def rule_of(derived: Derived, document: Document) -> CollisionRule:
    """A rule of the sidecar; budgets that it lacks are the defaults' or else stepbot's."""
    default = document.defaults.collision
    budgets = default if isinstance(default, CollisionSettings) else CollisionSettings()
    own = derived if isinstance(derived, CollisionSettings) else CollisionSettings(shape=derived)
    max_vertices = budgets.max_vertices if own.max_vertices is None else own.max_vertices
    if max_vertices is None and own.shape in DECOMPOSED:
        max_vertices = MAX_VERTICES
    max_hulls = own.max_hulls or budgets.max_hulls
    if not (is_for_mjx(own) or is_for_mjx(budgets)):
        return CollisionRule(own.shape, max_hulls or MAX_HULLS, max_vertices)
    shape = CollisionShape.HULL if own.shape in _ROUND_OR_HOLLOW else own.shape
    return CollisionRule(shape, max_hulls or MJX_HULLS, max_vertices, MJX_FACES)


def link_rule(link: str, document: Document) -> CollisionRule | None:
    """The rule for the components of a link that have none of their own; None if the link lists its shapes."""
    given = document.links[link].collision
    if isinstance(given, tuple):
        return None
    if isinstance(given, MergedCollision):
        return rule_of(given.merge, document)
    return rule_of(given or document.defaults.collision or CollisionShape.HULL, document)


def part_rule(own: Derived | None, contact: Contact | None, link: str, document: Document) -> CollisionRule | None:
    """The rule of a component that has shapes apart from its link's: by a rule or contact properties of its own."""
    if own is not None:
        return rule_of(own, document)
    return link_rule(link, document) if contact is not None else None


def is_merged(link: str, document: Document) -> bool:
    """Whether all components of a link without a rule of their own get one shape."""
    return isinstance(document.links[link].collision, MergedCollision)


def useless_budgets(document: Document) -> list[tuple[tuple[str, ...], CollisionShape, list[str]]]:
    """Keys of the section, shape, and budgets that do not apply to it, of every `collision`.

    A budget in ``defaults`` is for any rule.
    """
    places: list[tuple[tuple[str, ...], object]] = [
        *((("parts", name), rule.collision) for name, rule in document.parts.items()),
        *((("links", name), link.collision) for name, link in document.links.items()),
    ]
    return [(place, given.shape, _useless(given)) for place, given in places if isinstance(given, CollisionSettings)]


def _useless(settings: CollisionSettings) -> list[str]:
    allowed = {"max_hulls", "max_vertices"} if settings.shape in DECOMPOSED else set()
    if settings.shape is CollisionShape.HULL:
        allowed = {"max_vertices"}
    budgets = ("max_hulls", "max_vertices")
    return [name for name in budgets if getattr(settings, name) is not None and name not in allowed]
