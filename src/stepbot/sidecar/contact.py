"""Contact properties of parts, links and shapes, and the named pairs of materials with the source of their figures."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, NamedTuple

from pydantic import Tag

from stepbot.robot.surfaces import PLAIN, Surface

from . import units
from .quantities import bounded
from .section import MAPPING_OR_WORD, Section


class ContactMaterial(StrEnum):
    """A material on another one."""

    RUBBER_ON_FLOOR = "rubber-on-floor"
    RUBBER_ON_WET_FLOOR = "rubber-on-wet-floor"
    SHOE_ON_WOOD = "shoe-on-wood"
    SILICONE_ON_OILED_STEEL = "silicone-on-oiled-steel"
    PLASTIC_ON_STEEL = "plastic-on-steel"
    STEEL_ON_STEEL = "steel-on-steel"
    STEEL_ON_OILED_STEEL = "steel-on-oiled-steel"
    PTFE_ON_STEEL = "ptfe-on-steel"
    METAL_ON_WOOD = "metal-on-wood"
    WOOD_ON_WOOD = "wood-on-wood"


class Friction(NamedTuple):
    """A coefficient of friction and where it is from."""

    sliding: float
    source: str


_OPENSTAX = "OpenStax, College Physics, table 5.1, kinetic"
MATERIALS: Mapping[ContactMaterial, Friction] = {
    ContactMaterial.RUBBER_ON_FLOOR: Friction(0.7, f"{_OPENSTAX}: rubber on dry concrete"),
    ContactMaterial.RUBBER_ON_WET_FLOOR: Friction(0.5, f"{_OPENSTAX}: rubber on wet concrete"),
    ContactMaterial.SHOE_ON_WOOD: Friction(0.7, f"{_OPENSTAX}: shoes on wood"),
    ContactMaterial.SILICONE_ON_OILED_STEEL: Friction(
        0.3, "Robotiq, Hand-E Instruction Manual, payload and force: silicone fingertips, lubricated steel, tested"
    ),
    ContactMaterial.PLASTIC_ON_STEEL: Friction(
        0.18, "Lust, CDA3000 Engineering Guide, table 7.21, sliding, dry: steel on plastic, 0.18 to 0.35"
    ),
    ContactMaterial.STEEL_ON_STEEL: Friction(0.3, f"{_OPENSTAX}: steel on steel, dry"),
    ContactMaterial.STEEL_ON_OILED_STEEL: Friction(0.03, f"{_OPENSTAX}: steel on steel, oiled"),
    ContactMaterial.PTFE_ON_STEEL: Friction(0.04, f"{_OPENSTAX}: Teflon on steel"),
    ContactMaterial.METAL_ON_WOOD: Friction(0.3, f"{_OPENSTAX}: metal on wood"),
    ContactMaterial.WOOD_ON_WOOD: Friction(0.3, f"{_OPENSTAX}: wood on wood"),
}
"""Sliding friction: the smaller figure, which an engine with one coefficient can rely on; of a range the lowest."""

_Coefficient = Annotated[float, *bounded(units.RATIO, low=0.0, high=10.0)]
_Arm = Annotated[float, *bounded(units.LENGTH, low=0.0)]
_Restitution = Annotated[float, *bounded(units.RATIO, low=0.0, high=1.0)]
_Softness = Annotated[float, *bounded(units.TIME, above=0.0, high=1.0)]


class ContactSection(Section):
    """Contact properties; what is left out is the simulator's default."""

    material: ContactMaterial | None = None
    """A pair of materials whose friction is known, such as `rubber-on-floor`."""
    friction: _Coefficient | None = None
    """Coefficient of sliding friction; overrides the material's."""
    torsional: _Arm | None = None
    """Torsional friction [m]: torque against spinning / normal force."""
    rolling: _Arm | None = None
    """Rolling friction [m]: torque against rolling / normal force."""
    restitution: _Restitution | None = None
    """Speed after an impact / speed before it."""
    softness: _Softness | None = None
    """Time constant [s] with which a contact pushes shapes apart, for MuJoCo."""


Contact = Annotated[
    Annotated[ContactMaterial, Tag("<word>")] | Annotated[ContactSection, Tag("<mapping>")], MAPPING_OR_WORD
]
"""A pair of materials, or properties."""


def surface_of(*given: Contact | None) -> Surface:
    """The surface that the first `contact` of several places gives."""
    first = next((one for one in given if one is not None), None)
    if first is None:
        return PLAIN
    own = first if isinstance(first, ContactSection) else ContactSection(material=first)
    friction = MATERIALS[own.material].sliding if own.friction is None and own.material else own.friction
    return Surface(friction, own.torsional, own.rolling, own.restitution, own.softness)
