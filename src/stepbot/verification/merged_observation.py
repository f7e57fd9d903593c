"""Merges the observations of one file by all engines: each engine fills the gaps of those that report more."""

from collections.abc import Container, Mapping, Sequence
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.engines.observation import Observation, ObservedJoint, ObservedLink, ObservedShape, Quantity
from stepbot.engines.workers import Outcome

_WHOLE: Mapping[str, Quantity] = {
    "closures": Quantity.CLOSURES,
    "frames": Quantity.FRAMES,
    "actuators": Quantity.ACTUATORS,
    "sensors": Quantity.SENSORS,
    "initial": Quantity.INITIAL,
    "gravity": Quantity.GRAVITY_SETTINGS,
    "excluded_pairs": Quantity.CONTACTS,
}
"""Fields of an observation that an engine reports as a whole."""


class Gathered(Struct, frozen=True, eq=False):
    """The merged observation of one file."""

    key: str
    """The user's path of the file."""
    format: str
    observation: Observation
    sources: Mapping[Quantity, tuple[str, ...]]
    """Engines that added values to a quantity which the first engine does not report."""

    def engine(self, quantity: Quantity) -> str:
        """The engines that a quantity comes from, for tables and messages."""
        return ", ".join(self.sources.get(quantity) or (self.observation.engine,))


def gather(outcomes: Sequence[Outcome]) -> Gathered:
    """Merge the observations of one file.

    Args:
        outcomes: Outcomes with an observation, at least one; the preferred engine comes first.
    """
    first, *others = [_given(outcome.observation) for outcome in outcomes if outcome.observation is not None]
    whole, added = first, dict[Quantity, tuple[str, ...]]()
    for other in others:
        whole, filled = _filled(whole, other)
        for quantity in filled:
            # A quantity that the first engine does not report at all comes from the other only.
            before = () if quantity in _WHOLE.values() else added.get(quantity, (first.engine,))
            added[quantity] = (*before, other.engine)
    return Gathered(outcomes[0].key, outcomes[0].format, whole, added)


def _given(observation: Observation) -> Observation:
    """The observation without colours and contact properties that may be the engine's own."""

    def given(shapes: tuple[ObservedShape, ...] | None) -> tuple[ObservedShape, ...] | None:
        return shapes and tuple(
            replace(
                shape,
                rgba=None if shape.rgba_is_default else shape.rgba,
                surface=None if shape.surface == shape.surface_default else shape.surface,
            )
            for shape in shapes
        )

    links = (
        replace(link, visuals=given(link.visuals), collisions=given(link.collisions)) for link in observation.links
    )
    return replace(observation, links=tuple(links))


def _filled(whole: Observation, other: Observation) -> tuple[Observation, set[Quantity]]:
    """The observation with gaps filled from another, and the quantities that were filled."""
    filled = set[Quantity]()
    not_run, changes = dict(whole.not_run), dict[str, Any]()
    for name, quantity in _WHOLE.items():
        value = getattr(other, name)
        if getattr(whole, name) is None and value is not None and quantity not in other.not_run:
            changes[name] = value
            not_run.pop(quantity, None)
            filled.add(quantity)
    joints = {joint.child: joint for joint in other.joints}
    links = {link.name: link for link in other.links}
    seen: Any = replace(
        whole,
        joints=tuple(_joint(joint, joints.get(joint.child), other.not_run, filled) for joint in whole.joints),
        links=tuple(_link(link, links.get(link.name), filled) for link in whole.links),
        not_run=not_run,
    )
    return replace(seen, **changes), filled


def _joint(
    joint: ObservedJoint, other: ObservedJoint | None, not_run: Container[Quantity], filled: set[Quantity]
) -> ObservedJoint:
    """A joint with the limits and passive forces that another engine adds to the first."""
    if other is None or (other.name and joint.name and other.name != joint.name):
        return joint
    if joint.limit is not None and other.limit is not None and Quantity.LIMITS not in not_run:
        new = _new(other.limit_fields, joint.limit_fields)
        if new:
            limit = replace(joint.limit, **{name: getattr(other.limit, name) for name in new})
            joint = replace(joint, limit=limit, limit_fields=(*joint.limit_fields, *new))
            filled.add(Quantity.LIMITS)
    if joint.dynamics is not None and other.dynamics is not None and Quantity.DYNAMICS not in not_run:
        new = _new(other.dynamics_fields, joint.dynamics_fields)
        if new:
            dynamics = replace(joint.dynamics, **{name: getattr(other.dynamics, name) for name in new})
            joint = replace(joint, dynamics=dynamics, dynamics_fields=(*joint.dynamics_fields, *new))
            filled.add(Quantity.DYNAMICS)
    return joint


def _new(theirs: Sequence[str], mine: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for name in theirs if name not in mine)


def _link(link: ObservedLink, other: ObservedLink | None, filled: set[Quantity]) -> ObservedLink:
    """A link with what another engine reads of its shapes, and whether gravity acts on it."""
    if other is None:
        return link
    if link.gravity_compensation is None and other.gravity_compensation is not None:
        link = replace(link, gravity_compensation=other.gravity_compensation)
        filled.add(Quantity.GRAVITY_SETTINGS)
    whole = replace(
        link, visuals=_shapes(link.visuals, other.visuals), collisions=_shapes(link.collisions, other.collisions)
    )
    if whole != link:
        filled.add(Quantity.SHAPES)
    return whole


def _shapes(
    mine: tuple[ObservedShape, ...] | None, theirs: tuple[ObservedShape, ...] | None
) -> tuple[ObservedShape, ...] | None:
    if mine is None or theirs is None or len(mine) != len(theirs):
        return theirs if mine is None else mine
    return tuple(map(_shape, mine, theirs))


def _shape(shape: ObservedShape, other: ObservedShape) -> ObservedShape:
    gaps = {name: getattr(other, name) for name in shape.__struct_fields__ if getattr(shape, name) is None}
    return replace(shape, **gaps)
