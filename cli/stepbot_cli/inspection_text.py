"""An assembly as text: a line per component, below it the axes that a joint can bind to."""

from collections import Counter
from collections.abc import Iterator

from stepbot.cad.assembly import Assembly, Body, BodyKind, Component, Quantity
from stepbot.cad.axes import AxisLine, axis_faces, lines, millimetres, selectors
from stepbot.cad.paths import quoted
from stepbot.diagnostics import one_line
from stepbot.pipeline import Inspection
from stepbot.spatial import Vector3

from .columns import aligned
from .contents import Contents, contents
from .render import printable
from .shared_axes import SharedAxes

_VALIDATION_HEADINGS = ("component", "validation property", "in the file", "read", "deviation", "")
_MEASURES = {Quantity.VOLUME: ("cm^3", 1e6), Quantity.AREA: ("cm^2", 1e4), Quantity.CENTROID: ("mm", 1e3)}
"""Unit, and how many of it are one of SI."""
_HEADINGS = ("component", "solids", "volume", "center [mm]", "density", "product, occurrence", "")


def inspection_text(inspection: Inspection, *, features: bool) -> str:
    """The head of the file, then each component.

    Args:
        inspection: What was read and measured.
        features: Whether to list axis lines below each component.
    """
    assembly = inspection.assembly
    assert assembly is not None  # errors end the command before
    sums = contents(assembly, inspection.measures)
    rows = [_row(assembly, component, sums[component.index]) for component in assembly.components]
    table = aligned([_HEADINGS, *rows])
    text = [*_head(assembly, sums[0]), "", table[0]]
    for component, line in zip(assembly.components, table[1:], strict=True):
        text.append(line)
        if features:
            text += (f"    {axis}" for axis in _component_axes(assembly, component))
    return printable("\n".join([*text, *_validations(assembly)]))


def shared_axes_text(shared: SharedAxes) -> str:
    """The lines that two components or links share, or nearly share."""
    text = [f"{shared.words[0]} and {shared.words[1]} share {_count(len(shared.lines), 'axis', 'axes')}"]
    for line, snippet in zip(shared.lines, shared.snippets, strict=True):
        chosen = ", taken by itself" if line is shared.chosen else ""
        text.append(f"    {_described(line)}, weight {millimetres(line.weight)}{chosen}  origin: {snippet}")
    for miss, (a, b) in zip(shared.misses, shared.miss_places, strict=True):
        tilt = f" and {miss.angle * 1e3:.3g} mrad" if miss.angle > 1e-6 else ""
        text.append(f"    {millimetres(miss.distance)}{tilt} apart: {quoted(a)} is not where {quoted(b)} is")
        text += [f"        {quoted(path)}: {_described(line)}" for path, line in ((a, miss.line_a), (b, miss.line_b))]
    return printable("\n".join(text))


def _head(assembly: Assembly, total: Contents) -> Iterator[str]:
    system = f", written by {one_line(assembly.originating_system)}" if assembly.originating_system else ""
    yield f"{assembly.source}: {one_line(assembly.schema) or 'unknown schema'}, length unit {assembly.unit}{system}"
    parts = [
        _count(assembly.definitions, "definition"),
        _count(len(assembly.components) - 1, "component"),
        _count(total.solids, "solid") + _closed(assembly),
        *([_count(total.surfaces, "surface body", "surface bodies")] if total.surfaces else []),
        f"{_volume(total.volume)} in all",
    ]
    yield ", ".join(parts)
    yield from (f"{name}: {one_line(value)}" for name, value in assembly.facts.items())
    if materials := _materials(assembly):
        yield f"materials: {materials}"


def _solids(assembly: Assembly) -> Iterator[tuple[Component, Body]]:
    """The components that are, or mean to be, solids, each with its body."""
    for component in assembly.components:
        if component.body >= 0 and assembly.bodies[component.body].kind in (BodyKind.SOLID, BodyKind.TESSELLATED):
            yield component, assembly.bodies[component.body]


def _closed(assembly: Assembly) -> str:
    """How many meshes of solids are watertight."""
    closed = [body.watertight for _, body in _solids(assembly)]
    if not closed:
        return ""
    return " (watertight)" if all(closed) else f" ({sum(closed)} of {len(closed)} watertight)"


def _materials(assembly: Assembly) -> str:
    """Each material and density in the STEP, and how many solids are of it; empty where the STEP gives none."""
    counts = Counter((component.material, component.density) for component, _ in _solids(assembly))
    if not any(material or density for material, density in counts):
        return ""
    words = []
    for (material, density), count in counts.items():
        name = f"'{one_line(material)}'" if material else "without name" if density else "none"
        weight = f" {density:.6g} kg/m^3" if density else " without density" if material else ""
        words.append(f"{name}{weight} ({count})")
    return ", ".join(words)


def _row(assembly: Assembly, component: Component, inside: Contents) -> tuple[str, ...]:
    names = ", ".join(f"'{one_line(name)}'" if name else "-" for name in (component.product, component.occurrence))
    return (
        quoted(component.path),
        str(inside.solids) if inside.solids else "-",
        _volume(inside.volume) if inside.volume else "-",
        _numbers(inside.center) if inside.center else "-",
        f"{component.density:.6g} kg/m^3" if component.density else "-",
        names,
        one_line("; ".join(_remarks(assembly, component))),
    )


def _remarks(assembly: Assembly, component: Component) -> Iterator[str]:
    if component.body >= 0:
        body = assembly.bodies[component.body]
        if body.kind is not BodyKind.SOLID:
            yield {
                BodyKind.SURFACE: "surface, weighs nothing",
                BodyKind.TESSELLATED: "triangles only",
                BodyKind.WIRE: "curves only",
            }[body.kind]
        if body.defect:
            yield body.defect
        elif body.kind is BodyKind.SOLID and not body.watertight:
            yield "not watertight"
    if component.material:
        yield f"material '{component.material}'"
    if component.by_ordinal_only:
        yield "only #n tells it from its siblings"


def _validations(assembly: Assembly) -> list[str]:
    """What the file states for readers to compare, beside what was read."""
    if not assembly.validations:
        return []
    agree = sum(validation.agrees for validation in assembly.validations)
    rows = [
        (
            quoted(assembly.components[v.component].path),
            f"{v.quantity} [{_MEASURES[v.quantity][0]}]",
            _values(v.quantity, v.stated),
            _values(v.quantity, v.read),
            f"{v.deviation:.1e}",
            "" if v.agrees else "differs",
        )
        for v in assembly.validations
    ]
    head = f"{agree} of {_count(len(rows), 'validation property', 'validation properties')} of the file as read"
    return ["", head, *aligned([_VALIDATION_HEADINGS, *rows])]


def _values(quantity: Quantity, values: tuple[float, ...]) -> str:
    factor = _MEASURES[quantity][1]
    return ", ".join(f"{round(value * factor, 9) + 0.0:.6g}" for value in values)


def _component_axes(assembly: Assembly, component: Component) -> Iterator[str]:
    """The lines that carry cylinders and cones of a component, each with the origin that means it."""
    found = lines(axis_faces(assembly, [component.index]))
    for line, selector in zip(found, selectors(found), strict=True):
        yield f"{_described(line)}  origin: {{axis_of: {quoted(component.path)}{selector}}}"


def _described(line: AxisLine) -> str:
    direction = ", ".join(f"{round(c, 4) + 0.0:.4g}" for c in line.direction)
    radii = ", ".join(_number(radius) for radius in line.radii)
    return (
        f"axis [{direction}] at [{_numbers(line.point)}] mm, "
        f"from {_number(line.low)} to {millimetres(line.high)}, radius {radii} mm"
    )


def _number(length: float) -> str:
    """A length [m] as a number of millimetres."""
    return millimetres(length).removesuffix(" mm")


def _numbers(point: Vector3) -> str:
    return ", ".join(map(_number, point))


def _volume(value: float) -> str:
    """A volume [m^3] as text."""
    return f"{value * 1e6:.6g} cm^3"


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number or 'no'} {one if number == 1 else many or one + 's'}"
