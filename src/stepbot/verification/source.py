"""Compares converted files with the file that they were converted from.

Quantities with a declared loss are not compared: their difference is the loss that was reported.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from math import inf, isfinite, isnan
from pathlib import Path, PurePath
from typing import TypeVar

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, Span
from stepbot.engines import own_parsers
from stepbot.engines.file_references import openable
from stepbot.engines.observation import (
    Observation,
    ObservedActuator,
    ObservedClosure,
    ObservedLink,
    ObservedSensor,
    ObservedShape,
    Quantity,
)
from stepbot.engines.resources import box_around
from stepbot.report.robot import Check
from stepbot.robot.mesh_names import free_name, valid_name
from stepbot.robot.model import ActuatorKind, Limit
from stepbot.robot.renaming import NewNames
from stepbot.robot.surfaces import PLAIN, SURFACE_FIELDS, Surface
from stepbot.runtime.worker import Workers

from .files import observed
from .judging import OWN_RESULT, Subject, compared_with_first, judged, ranked
from .merged_observation import Gathered, gather
from .normalized import joined
from .shapes import plain_name
from .stand_ins import without_stand_ins

Bounds = tuple[float, float]


def with_effective_ranges(observation: Observation) -> Observation:
    """The observation with inputs and forces of actuators within the limits of their joints."""
    if observation.actuators is None:
        return observation
    limits = {step.name: step.limit or Limit() for joint in observation.joints for step in (joint, *joint.steps)}
    actuators = tuple(_effective(actuator, limits.get(actuator.joint, Limit())) for actuator in observation.actuators)
    return replace(observation, actuators=actuators)


def _effective(actuator: ObservedActuator, limit: Limit) -> ObservedActuator:
    gear = actuator.gear or 1.0
    force = _within(actuator.force, _symmetric(limit.effort / gear))
    if actuator.kind == ActuatorKind.MOTOR:
        control = _within(_within(actuator.control, _symmetric(limit.effort / gear)), force)
        return replace(actuator, control=control, force=_within(force, control))
    if actuator.kind == ActuatorKind.POSITION:
        ends = (limit.lower * gear, limit.upper * gear)
        return replace(actuator, control=_within(actuator.control, ends if gear > 0.0 else ends[::-1]), force=force)
    if actuator.kind == ActuatorKind.VELOCITY:
        return replace(actuator, control=_within(actuator.control, _symmetric(limit.velocity * gear)), force=force)
    return actuator


def _symmetric(bound: float) -> Bounds:
    return -abs(bound), abs(bound)


def _within(bounds: Bounds | None, limits: Bounds | None) -> Bounds | None:
    """The common part of two ranges; unknown bounds have none, and limits that an engine cannot express are ignored."""
    if bounds is None or limits is None:
        return bounds
    low, high = (-inf if isnan(limits[0]) else limits[0]), (inf if isnan(limits[1]) else limits[1])
    return max(bounds[0], low), min(bounds[1], high)


NOT_CONFIRMED = "SB867"


class Converted(Struct, frozen=True):
    """A file that was written."""

    name: str
    """Its name in the report."""
    names: NewNames = field(default_factory=NewNames)
    """The model's names of what its format needs other names for."""
    lost: Mapping[Quantity, str] = field(default_factory=dict)
    """Quantities with losses that its format declares, each with the reason not to compare it."""


def verify_against_source(
    source: Path,
    span: Span,
    files: Mapping[Path, Converted],
    lost: Mapping[Quantity, str],
    names: NewNames,
    pieces: Mapping[str, str],
    of_robot: Callable[[Observation], Observation],
    diagnostics: Diagnostics,
    workers: Workers,
    included: Sequence[Path] = (),
) -> tuple[Check, ...]:
    """The checks of every file against the file that it was converted from.

    Args:
        source: The file that was converted, or a copy of it.
        span: It, for messages; its last part is its name in the report.
        lost: Quantities with declared losses, each with the reason not to compare it.
        names: Names that the conversion changed.
        pieces: For each written visual the first one of the same visual in the source.
        of_robot: What an observation of the source has of the robot, without its surroundings.
        diagnostics: Receives differences, and SB867 if no engine reads the source.
        included: Folders from which an MJCF may include files, in addition to its own.
    """
    name = PurePath(span.file).name
    reported = Diagnostics()  # engines that reject a written file are reported by the comparison with the model
    asked, outcomes = observed(
        (source, *files),
        reported,
        workers,
        included=included,
        renamed={str(openable(source)): names, **{str(openable(path)): one.names for path, one in files.items()}},
    )
    of_source = [outcome for outcome in outcomes if outcome.key == source.as_posix()]
    first = ranked(of_source)
    if all(outcome.engine in own_parsers() for outcome in first):
        by = "stepbot's own parser alone read it" if first else "no engine read it"
        reasons = [f"{one.engine}: {one.reason}" for one in of_source if one.observation is None]
        diagnostics.add(NOT_CONFIRMED, f"not confirmed by an engine: {by}", span, notes=reasons)
    if not first:
        return ()
    source_seen = gather(first)
    ours = _comparable(replace(source_seen, observation=of_robot(source_seen.observation)))
    checks = list[Check]()
    differences = Diagnostics()
    for path, written in files.items():
        seen = ranked([outcome for outcome in outcomes if outcome.key == path.as_posix()])
        if not seen:
            continue
        gathered = gather(seen)
        whole = _with_whole_visuals(without_stand_ins(gathered.observation), pieces)
        theirs = replace(gathered, observation=with_effective_ranges(whole))
        for compared in compared_with_first(ours, theirs, asked, springs_alone=True):
            if compared.quantity in OWN_RESULT:
                continue
            reason = lost.get(compared.quantity) or written.lost.get(compared.quantity)
            if reason:
                compared = replace(compared, not_run=reason)
            against = f"{name} ({ours.engine(compared.quantity)})"
            subject = Subject(written.name, theirs.format, theirs.engine(compared.quantity), against)
            checks.append(judged(subject, compared, differences))
    diagnostics.extend(difference.after("convert") for difference in differences)
    return tuple(checks)


def _comparable(gathered: Gathered) -> Gathered:
    """The source without what the written files have by conventions of their own.

    These are the name of the robot, names of shapes to which the source gives none or that several of a link have,
    names that are not valid, shapes without end, colours of shapes without one, contact properties that are PyBullet's
    own, groups of shapes, ranges of actuators beyond the limits of their joints, limits of 0, and ambient colours: one
    that is not the diffuse colour is reported as lost.
    """
    seen = gathered.observation

    def plain(shapes: tuple[ObservedShape, ...] | None, kind: str) -> tuple[ObservedShape, ...] | None:
        shapes = _with_valid_names(shapes, kind)
        often = Counter(shape.name for shape in shapes or ())
        return shapes and tuple(
            replace(
                shape,
                name=shape.name if shape.name and often[shape.name] == 1 else None,
                rgba=shape.rgba or None,
                groups=None,
                ambient=None,
                surface=_stated(shape),
                surface_default=shape.surface_default and PLAIN,
            )
            for shape in shapes
        )

    links = tuple(
        replace(link, visuals=plain(link.visuals, "visual"), collisions=plain(link.collisions, "collision"))
        for link in map(_with_ends, seen.links)
    )
    bare = replace(
        without_stand_ins(replace(seen, name=None, links=links)),
        closures=_with_valid_names(seen.closures, "closure"),
        actuators=_with_own_names(_with_valid_names(seen.actuators, "actuator")),
        sensors=_with_own_names(_with_valid_names(seen.sensors, "sensor")),
    )
    return replace(gathered, observation=with_effective_ranges(bare))


_Named = TypeVar("_Named", ObservedShape, ObservedClosure, ObservedActuator, ObservedSensor)


def _with_valid_names(seen: tuple[_Named, ...] | None, kind: str) -> tuple[_Named, ...] | None:
    """What the source has, by the names that written files have in place of those that no format holds."""
    return seen and tuple(replace(one, name=one.name and valid_name(one.name, kind)) for one in seen)


def _with_own_names(seen: tuple[_Named, ...] | None) -> tuple[_Named, ...] | None:
    """The same, with a name for each: a source may name devices of two links alike, and written files do not."""
    taken = set[str]()
    return seen and tuple(replace(one, name=one.name and free_name(one.name, "_2", taken)) for one in seen)


def _with_ends(link: ObservedLink) -> ObservedLink:
    """The link without planes and height fields, which are reported as not converted."""
    for kind in ("visual", "collision"):
        shapes: tuple[ObservedShape, ...] = getattr(link, f"{kind}s") or ()
        kept = tuple(shape for shape in shapes if shape.bounds is None or isfinite(shape.bounds[0][0]))
        if len(kept) < len(shapes):
            known = {f"{kind}s": kept, f"{kind}_bounds": box_around(kept), f"has_{kind}s": bool(kept)}
            link = replace(link, **known)
    return link


def _stated(shape: ObservedShape) -> Surface | None:
    """Contact properties without PyBullet's own: what a URDF states for Gazebo alone, written files have for both."""
    own, surface = shape.surface_default, shape.surface
    if own is None or surface is None:
        return surface
    given = {name: getattr(surface, name) for name in SURFACE_FIELDS}
    return Surface(**{name: value for name, value in given.items() if value != getattr(own, name)})


def _with_whole_visuals(observation: Observation, first: Mapping[str, str]) -> Observation:
    """The observation with one visual in place of those for the colours of one mesh.

    Args:
        first: For each visual the first one of the same mesh.
    """

    def whole(shapes: tuple[ObservedShape, ...] | None) -> tuple[ObservedShape, ...] | None:
        groups: dict[str, list[ObservedShape]] = {}
        for number, shape in enumerate(shapes or ()):
            name = plain_name(shape.name or "")
            groups.setdefault(first.get(name, name) or str(number), []).append(shape)
        return shapes and tuple(joined(parts) if len(parts) > 1 else parts[0] for parts in groups.values())

    links = (replace(link, visuals=whole(link.visuals)) for link in observation.links)
    return replace(observation, links=tuple(links))
