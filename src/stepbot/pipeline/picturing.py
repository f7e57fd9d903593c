"""What a picture of a sidecar's robot or of a STEP file shows."""

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.spatial import Array, Pose, corners
from stepbot.pictures.picture import distinct_color
from stepbot.pictures.scene import Shape, Subject, exploded, rgb, robot_subject
from stepbot.robot.kinematics import Configuration
from stepbot.robot.model import GREY, Robot
from stepbot.robot.posing import NotReached, posed
from stepbot.robot.step_names import is_step_name
from stepbot.step.assembly import Assembly, Body, Component
from stepbot.step.structure.paths import nearest_claim, plain_name

from .conversion import Options
from .describing import described_robot
from .sidecars import SIDECAR_SUFFIXES
from .stages import inspect, produce

_UNNAMED = re.compile(r"body(#\d+)?")
"""Segments of paths that stepbot made for bodies without names."""


def robot_to_draw(
    target: Path, options: Options, diagnostics: Diagnostics, progress: Callable[[str], None] = lambda stage: None
) -> Robot | None:
    """The robot of a sidecar, or of a URDF, SDFormat or MJCF; None after errors."""
    if target.suffix.lower() in SIDECAR_SUFFIXES:
        built = produce(target, options._replace(formats=(), verify=False), progress)
        diagnostics.extend(built.diagnostics)
        return built.robot
    progress("read")
    return described_robot(target, options, diagnostics)


def assembly_to_draw(step: Path, options: Options, diagnostics: Diagnostics) -> Subject | None:
    """A STEP file with the names of the root's children; None after errors."""
    inspection = inspect(step, options)
    diagnostics.extend(inspection.diagnostics)
    assembly = inspection.assembly
    if assembly is None:
        return None
    return assembly_subject(assembly, part_labels(assembly, assembly.children[0], folded=True))


def subject_of(target: Path, options: Options, positions: Configuration, diagnostics: Diagnostics) -> Subject | None:
    """A robot with some joints at given positions [rad] or [m], or a STEP file; None after errors.

    Raises:
        ValueError: A name is not that of a moving joint, or the loops do not close there.
    """
    if is_step_name(target.name):
        if positions:
            raise ValueError("a STEP file has no joints; give a sidecar")
        return assembly_to_draw(target, options, diagnostics)
    robot = robot_to_draw(target, options, diagnostics)
    if robot is None:
        return None
    try:
        return robot_subject(robot, posed(robot, positions))
    except KeyError as error:
        raise ValueError(error.args[0]) from None
    except NotReached as error:
        raise ValueError(f"the loops or limits stop the mechanism at {dict(error.reached)}") from None


class Label(Struct, frozen=True):
    """A name for components of an assembly."""

    text: str
    components: tuple[int, ...]
    """Indices of equal components."""


def part_labels(assembly: Assembly, chosen: Iterable[int], *, folded: bool) -> list[Label]:
    """Labels for components.

    Args:
        chosen: Indices of the components to name; bodies without a name of their own are left to their part.
        folded: Whether occurrences of one part share a label, anywhere in the assembly.
    """
    groups: dict[tuple[object, ...], list[Component]] = {}
    for index in chosen:
        component = assembly.components[index]
        if component.parent >= 0 and not _UNNAMED.fullmatch(component.segment):
            same = folded and component.definition >= 0
            key = (component.definition, component.product) if same else (index,)
            groups.setdefault(key, []).append(component)
    return [Label(_label_text(group), tuple(one.index for one in group)) for group in groups.values()]


def _label_text(group: Sequence[Component]) -> str:
    first = group[0]
    if len(group) == 1:
        return first.segment
    return f"{plain_name(first.product) or first.segment} x{len(group)}"


def assembly_subject(assembly: Assembly, labels: Sequence[Label], apart: float = 0.0) -> Subject:
    """The bodies of an assembly where they are, or apart from each other.

    An assembly of a single colour is drawn with a colour for each label.

    Args:
        labels: Names of components; a body belongs to the nearest labelled component above it, else to the root.
        apart: How far to move labelled components, relative to their distance from the middle of what they belong to.
    """
    rest = len(labels)
    owners = nearest_claim(assembly.components, ((label.components, i) for i, label in enumerate(labels)), rest)
    units = {
        index
        for label in labels
        for index in label.components
        if all(owners[below] == owners[index] for below in assembly.subtree(index))
    }
    moves = exploded(_boxes(assembly), [c.parent for c in assembly.components], units, apart)
    drawn = [c for c in assembly.components if c.body >= 0 and len(assembly.bodies[c.body].mesh.faces)]
    own = {c.index: _body_colors(assembly.bodies[c.body], c) for c in drawn}
    plain = len({tuple(color) for colors in own.values() for color in np.unique(colors, axis=0).tolist()}) <= 1
    shapes = [
        Shape(
            assembly.bodies[c.body].mesh,
            Pose.of(c.X_WC.R, c.X_WC.p + moves[c.index]),
            distinct_color(owners[c.index]) if plain and owners[c.index] != rest else own[c.index],
            owners[c.index],
        )
        for c in drawn
    ]
    return Subject(tuple(shapes), (*(label.text for label in labels), assembly.source))


def _boxes(assembly: Assembly) -> Array:
    """Bounding boxes of all subtrees, shape (n, 2, 3) [m]; NaN for those without geometry."""
    boxes = np.full((len(assembly.components), 2, 3), np.nan)
    for component in reversed(assembly.components):
        if component.body >= 0 and len(assembly.bodies[component.body].mesh.vertices):
            points = component.X_WC.apply(assembly.bodies[component.body].mesh.vertices)
            _join(boxes, component.index, np.stack(corners(points)))
        if component.parent >= 0:
            _join(boxes, component.parent, boxes[component.index])
    return boxes


def _join(boxes: Array, index: int, box: Array) -> None:
    boxes[index, 0] = np.fmin(boxes[index, 0], box[0])
    boxes[index, 1] = np.fmax(boxes[index, 1], box[1])


def _body_colors(body: Body, component: Component) -> Array:
    """sRGB of each face of a body in an occurrence, shape (m, 3)."""
    colors = np.array([rgb(color or component.color or GREY) for color in body.colors] or [rgb(GREY)])
    used = body.face_colors if len(body.colors) else np.zeros(len(body.mesh.faces), dtype=int)
    return np.asarray(colors[used])
