"""Compares the geometry of a STEP file with its validation properties.

Values are summed over definitions, each once, so that the cost does not depend on the number of occurrences.
"""

from collections.abc import Mapping, Sequence
from math import dist, inf, isnan, sqrt

import numpy as np
from msgspec import Struct, field

from stepbot.diagnostics import Diagnostics, Span, cut
from stepbot.geometry.fixed_point import exact_sum
from stepbot.geometry.spatial import Array
from stepbot.step.structure.source import NONE, Definition

from ..assembly import Body, BodyKind, Component, Quantity, Validation
from .properties import StatedValue, Subject

TOLERANCES = {Quantity.VOLUME: 1e-3, Quantity.AREA: 1e-2, Quantity.CENTROID: 1e-3}
"""Deviation from a validation property up to which a value counts as equal. CAD programs integrate areas coarsely: in
real files those of cylinders and turbine blades deviate by up to 6e-3 from a closed form or a fine mesh."""
_SHOWN = 8
"""Maximum number of differences in the warning."""


class _Sums(Struct, frozen=True):
    """Integrals over a shape, in its own frame, in powers of metres."""

    volume: float = 0.0
    area: float = 0.0
    centroid: Array = field(default_factory=lambda: np.zeros(3))
    spread: float = 0.0
    """Integral of the squared distance from the centroid."""
    is_exact: bool = True
    """Whether it contains no body of triangles only."""

    def moved(self, matrix: Array) -> "_Sums":
        """In a frame where this one is placed by a matrix (4, 4)."""
        scale = abs(float(np.linalg.det(matrix[:3, :3]))) ** (1.0 / 3.0)
        centroid = matrix[:3, :3] @ self.centroid + matrix[:3, 3]
        return _Sums(self.volume * scale**3, self.area * scale**2, centroid, self.spread * scale**5, self.is_exact)


def compare(
    stated: Sequence[StatedValue],
    definitions: Sequence[Definition],
    components: Sequence[Component],
    bodies: Mapping[tuple[int, int], Body],
    place: str,
    diagnostics: Diagnostics,
) -> tuple[Validation, ...]:
    """Compare each value with the geometry, and report differences and values that cannot be compared.

    Args:
        bodies: The bodies read, by the number of the definition and of the body in it.
        diagnostics: Receives SB226 and SB227.
    """
    sums = _Summing(definitions, bodies)
    validations, left_out = [], 0
    for value in stated:
        read = sums.of(value.subject) if value.subject is not None and value.value else None
        if (
            value.subject is None
            or read is None
            or not read.is_exact
            or (value.quantity is Quantity.AREA and isnan(read.area))
        ):
            left_out += 1
        else:
            validations.append(_validation(value.subject.component, value, read))
    _report(validations, left_out, components, place, diagnostics)
    return tuple(validations)


class _Summing:
    """Sums up definitions, each once."""

    def __init__(self, definitions: Sequence[Definition], bodies: Mapping[tuple[int, int], Body]) -> None:
        self._definitions, self._bodies = definitions, bodies
        self._known: dict[int, _Sums] = {}

    def of(self, subject: Subject) -> _Sums:
        """The measured value of a subject; for an occurrence, in the frame of the assembly."""
        if subject.body != NONE:
            return _of_body(self._bodies.get((subject.definition, subject.body)))
        sums = self._of_definition(subject.definition)
        return sums if subject.matrix is None else sums.moved(subject.matrix)

    def _of_definition(self, index: int) -> _Sums:
        if index not in self._known:
            definition = self._definitions[index]
            parts = [_of_body(self._bodies.get((index, number))) for number in range(len(definition.bodies))]
            parts += [self._of_definition(child.definition).moved(child.matrix) for child in definition.children]
            self._known[index] = _total(parts)
        return self._known[index]


def _of_body(body: Body | None) -> _Sums:
    if body is None or body.kind is BodyKind.TESSELLATED:
        return _Sums(is_exact=False)
    if body.exact is None:
        return _Sums(area=body.area)
    spread = float(np.trace(np.array(body.exact.unit_density.inertia))) / 2.0
    return _Sums(body.exact.volume, body.area, np.array(body.exact.unit_density.com), spread)


def _total(parts: Sequence[_Sums]) -> _Sums:
    volume = exact_sum(part.volume for part in parts)
    moment = sum((part.volume * part.centroid for part in parts), np.zeros(3))
    centroid = moment / volume if volume > 0.0 else np.zeros(3)
    squares = (part.volume * float((part.centroid - centroid) @ (part.centroid - centroid)) for part in parts)
    spread = exact_sum(part.spread for part in parts) + exact_sum(squares)
    return _Sums(volume, exact_sum(p.area for p in parts), centroid, spread, all(part.is_exact for part in parts))


def _validation(component: int, statement: StatedValue, read: _Sums) -> Validation:
    stated, tolerance = statement.value, TOLERANCES[statement.quantity]
    if statement.quantity is Quantity.CENTROID:
        center = (float(read.centroid[0]), float(read.centroid[1]), float(read.centroid[2]))
        gyration = sqrt(read.spread / read.volume) if read.volume > 0.0 else 0.0
        deviation = dist(stated, center) / gyration if gyration > 0.0 else inf
        return Validation(component, statement.quantity, stated, center, deviation, tolerance)
    value = read.volume if statement.quantity is Quantity.VOLUME else read.area
    deviation = abs(value - stated[0]) / abs(stated[0]) if stated[0] else (inf if value else 0.0)
    return Validation(component, statement.quantity, stated, (value,), deviation, tolerance)


def _report(
    validations: Sequence[Validation],
    left_out: int,
    components: Sequence[Component],
    place: str,
    diagnostics: Diagnostics,
) -> None:
    differing = [validation for validation in validations if not validation.agrees]
    if differing:
        described = dict.fromkeys(f"'{components[v.component].path}': {_described(v)}" for v in differing)
        differ = "differ" if len(differing) > 1 else "differs"
        diagnostics.add(
            "SB226",
            f"{len(differing)} of {len(validations)} validation properties in the file {differ} from the geometry read",
            Span(place),
            help=["compare these parts with the CAD: the export may have lost or changed geometry"],
            notes=cut(list(described), _SHOWN),
        )
    if left_out:
        count = f"{left_out} validation properties" if left_out > 1 else "one validation property"
        diagnostics.add("SB227", f"{count} of the file could not be compared", Span(place))


def _described(validation: Validation) -> str:
    """A validation property and the measured value, for messages."""
    unit, factor = {Quantity.VOLUME: ("cm^3", 1e6), Quantity.AREA: ("cm^2", 1e4), Quantity.CENTROID: ("mm", 1e3)}[
        validation.quantity
    ]
    stated, read = (
        ", ".join(f"{value * factor + 0.0:.6g}" for value in values) for values in (validation.stated, validation.read)
    )
    if validation.quantity is Quantity.CENTROID:
        away = dist(validation.stated, validation.read) * factor
        far = f"{away:.3g} {unit} apart, of the radius of gyration {_share(validation)}"
        return f"{validation.quantity} [{stated}] {unit} in the file, [{read}] read, {far}"
    return f"{validation.quantity} {stated} {unit} in the file, {read} read, off by {_share(validation)}"


def _share(validation: Validation) -> str:
    if validation.deviation == inf:
        return "infinitely far"
    return f"{validation.deviation:.2%} (tolerance {validation.tolerance:.1%})"
