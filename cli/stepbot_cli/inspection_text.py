"""An assembly as text: a line per component, below it the axes that a joint can bind to."""

import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from math import floor, log10

from stepbot.assemble.axis_evidence import met
from stepbot.diagnostics import counted, one_line
from stepbot.geometry.spatial import Vector3
from stepbot.pipeline.stages import Inspection
from stepbot.step.assembly import Assembly, Body, BodyKind, Component, Quantity
from stepbot.step.features.axes import AxisLine, millimetres
from stepbot.step.structure.paths import plain_name, quoted

from .columns import aligned, cells, wrapped
from .contents import Contents, contents
from .diagnostic_text import printable
from .inspection_rows import Choice, Row, Rows, SharedAxes, component_axes, listed

_VALIDATION_HEADINGS = ("component", "validation property", "stored", "computed", "deviation", "")
_MEASURES = {Quantity.VOLUME: ("cm^3", 1e6), Quantity.AREA: ("cm^2", 1e4), Quantity.CENTROID: ("mm", 1e3)}
"""Unit, and its number per SI unit."""
_HEADINGS = ("component", "count", "solids", "volume", "size [mm]", "center [mm]", "density", "product, occurrence", "")
_INDENT = "    "
_SHOWN_LINES, _SHOWN_MISSES = 6, 3
"""Axes that two components share, or nearly share, that are listed without ``-v``."""


def inspection_text(
    inspection: Inspection,
    choice: Choice,
    *,
    features: bool,
    tree: bool = False,
    verbose: bool = False,
    width: int | None,
) -> str:
    """The header of the file, then the components, as a table or, if that is too wide, in blocks; or as a tree.

    Args:
        features: Whether to list axis lines below each component; not in a tree.
        verbose: Whether to list validation properties that match, too.
        width: Width of the screen; None for unlimited.

    Raises:
        click.BadParameter: Nothing matches the glob of the choice.
    """
    assembly = inspection.assembly
    assert assembly is not None  # errors have ended the command before
    sums = contents(assembly, inspection.measures, inspection.tolerance)
    rows = listed(assembly, choice)
    cells_of_rows = [_row(assembly, row, sums[row.component.index]) for row in rows.rows]
    names = [_telling_names(row.component) for row in rows.rows]
    text = [*_fitted(_head(assembly, sums[0]), width), ""]
    if tree:
        text += tree_lines(assembly.components, rows.rows, list(map(_facts, cells_of_rows, names)), width)
    else:
        blocks = _blocks(cells_of_rows, names, width)
        text += blocks.pop(0)
        for row, block in zip(rows.rows, blocks, strict=True):
            text += block
            if features:
                axes = component_axes(assembly, row.component)
                text += _fitted((f"{_INDENT}{_described(line)}  origin: {origin}" for line, origin in axes), width)
    text += [*_fitted(_left_out(rows, choice), width), *_validations(assembly, verbose=verbose)]
    return printable("\n".join(text))


def _blocks(rows: list[tuple[str, ...]], telling_names: list[str], width: int | None) -> list[list[str]]:
    """The lines of the headings, then those of each component: one each, or its path with its properties below.

    Args:
        rows: The cells of each component.
        telling_names: For each component its names, or an empty string if its path has them already.
    """
    table = aligned([_HEADINGS, *rows])
    if width is None or max(map(cells, table)) <= width:
        return [[line] for line in table]
    blocks = [[_HEADINGS[0], f"{_INDENT}count, solids, volume, size, center, density, names"]]
    for row, names in zip(rows, telling_names, strict=True):
        blocks.append([row[0], *_fitted([_INDENT + _facts(row, names)], width)])
    return blocks


def _facts(row: tuple[str, ...], names: str) -> str:
    """The properties of a component in words."""
    _, count, solids, volume, size, center, density, _, remarks = row
    facts = [
        f"{count} times" if count else "",
        counted(int(solids), "solid") if solids != "-" else "",
        volume if volume != "-" else "",
        f"{size} mm" if size != "-" else "",
        f"at {center} mm" if center != "-" else "",
        density if density != "-" else "",
        names,
        remarks,
    ]
    return "; ".join(filter(None, facts))


def _left_out(rows: Rows, choice: Choice) -> Iterator[str]:
    """The number of components left out of the list."""
    if rows.deeper or rows.unmatched:
        yield ""
    if rows.deeper:
        yield f"{counted(rows.deeper, 'component')} below depth {choice.depth} not shown"
    if rows.unmatched:
        verb = "does" if rows.unmatched == 1 else "do"
        yield f"{counted(rows.unmatched, 'component')} that {verb} not match '{choice.glob}' not shown"


def _fitted(lines: Iterable[str], width: int | None) -> list[str]:
    """Lines broken at spaces; words are never broken, because paths and snippets are pasted."""
    if width is None:
        return list(lines)
    fitted = []
    for line in lines:
        indent = line[: len(line) - len(line.lstrip())]
        below = indent + ("  " if indent else _INDENT)
        broken = textwrap.wrap(line, width, subsequent_indent=below, break_long_words=False, break_on_hyphens=False)
        fitted += broken or [""]
    return fitted


def shared_axes_text(shared: SharedAxes, width: int | None, *, verbose: bool = False) -> str:
    """The lines that two components or links share, or nearly share.

    Args:
        shared: The lines, the strongest first.
        verbose: Whether to list all; else the strongest, and lines that are nearly shared only if none is shared.
    """
    text = [f"{shared.words[0]} and {shared.words[1]} share {counted(len(shared.lines), 'axis', 'axes')}"]
    shown = len(shared.lines) if verbose else _SHOWN_LINES
    for line, snippet, radii in list(zip(shared.lines, shared.snippets, shared.radii, strict=True))[:shown]:
        chosen = ", selected by default" if line is shared.chosen else ""
        of = "; ".join(f"{_radii(side)} of {name}" for side, name in zip(radii, shared.words, strict=True))
        text.append(f"    {_placed(line)}{chosen}: {met(line)}  origin: {snippet}  ({of})")
    if len(shared.lines) > shown:
        text.append(f"    {counted(len(shared.lines) - shown, 'weaker axis', 'weaker axes')} not shown; -v shows all")
    shown = len(shared.misses) if verbose else 0 if shared.lines else _SHOWN_MISSES
    for miss, (a, b) in list(zip(shared.misses, shared.miss_places, strict=True))[:shown]:
        tilt = f" and {miss.angle * 1e3:.3g} mrad" if miss.angle > 1e-6 else ""
        text.append(f"    {millimetres(miss.distance)}{tilt} apart: {quoted(a)} and {quoted(b)} are misaligned")
        text += [f"        {quoted(path)}: {_described(line)}" for path, line in ((a, miss.line_a), (b, miss.line_b))]
    if len(shared.misses) > shown:
        text.append(f"    {counted(len(shared.misses) - shown, 'misaligned pair')} of axes not shown; -v shows all")
    return printable("\n".join(_fitted(text, width)))


def _head(assembly: Assembly, total: Contents) -> Iterator[str]:
    system = f", written by {one_line(assembly.originating_system)}" if assembly.originating_system else ""
    yield f"{assembly.source}: {one_line(assembly.schema) or 'unknown schema'}, length unit {assembly.unit}{system}"
    parts = [
        counted(assembly.definitions, "definition"),
        counted(len(assembly.components) - 1, "component"),
        counted(total.solids, "solid") + _closed(assembly),
        *([counted(total.surfaces, "surface body", "surface bodies") + _enclosing(assembly)] if total.surfaces else []),
        f"{_volume(total.volume)} in total",
    ]
    yield ", ".join(parts)
    yield from (f"{name}: {one_line(value)}" for name, value in assembly.facts.items())
    if materials := _materials(assembly):
        yield f"materials: {materials}"


def _solids(assembly: Assembly) -> Iterator[tuple[Component, Body]]:
    """The components that are, or should be, solids, each with its body."""
    for component in assembly.components:
        if component.body >= 0 and assembly.bodies[component.body].kind in (BodyKind.SOLID, BodyKind.TESSELLATED):
            yield component, assembly.bodies[component.body]


def _closed(assembly: Assembly) -> str:
    """Number of watertight meshes of solids."""
    closed = [body.watertight for _, body in _solids(assembly)]
    if not closed:
        return ""
    return " (watertight)" if all(closed) else f" ({sum(closed)} of {len(closed)} watertight)"


def _enclosing(assembly: Assembly) -> str:
    """Number of surfaces that are closed, and have a mass; empty if none is."""
    surfaces = [assembly.bodies[component.body] for component in assembly.components if component.body >= 0]
    closed = sum(body.kind is BodyKind.SURFACE and body.watertight for body in surfaces)
    return f" ({closed} closed)" if closed else ""


def _materials(assembly: Assembly) -> str:
    """Each material and density in the STEP with the number of its solids; empty without any."""
    counts = Counter((component.material, component.density) for component, _ in _solids(assembly))
    if not any(material or density for material, density in counts):
        return ""
    words = []
    for (material, density), count in counts.items():
        name = f"'{one_line(material)}'" if material else "unnamed" if density else "none"
        weight = f" {density:.6g} kg/m^3" if density else " without density" if material else ""
        words.append(f"{name}{weight} ({count})")
    return ", ".join(words)


def _row(assembly: Assembly, row: Row, inside: Contents) -> tuple[str, ...]:
    component = row.component
    return (
        quoted(component.path),
        str(row.count) if row.count > 1 else "",
        str(inside.solids) if inside.solids else "-",
        _volume(inside.volume) if inside.volume else "-",
        " x ".join(map(_extent, inside.size, inside.size_slack)) if inside.size else "-",
        _numbers(inside.center) if inside.center else "-",
        f"{component.density:.6g} kg/m^3" if component.density else "-",
        _names(component),
        one_line("; ".join([*([f"to {quoted(row.last)}"] if row.last else []), *_remarks(assembly, component)])),
    )


def _names(component: Component) -> str:
    """Product and occurrence; the product alone if the occurrence is empty or the product with a number."""
    product, occurrence = component.product, component.occurrence
    if product and re.fullmatch(rf"({re.escape(product)}:\d+)?", occurrence):
        return f"'{one_line(product)}'"
    return ", ".join(f"'{one_line(name)}'" if name else "-" for name in (product, occurrence))


def _telling_names(component: Component) -> str:
    """The names; an empty string if the last name of the path is the product's, without version and number."""
    names = _names(component)
    same = plain_name(component.product) == re.sub(r":\d+$", "", component.segment)
    return "" if same and names == f"'{one_line(component.product)}'" else names


def _remarks(assembly: Assembly, component: Component) -> Iterator[str]:
    if component.missing:
        yield f"MISSING: file '{component.missing}' was not read"
    if component.body >= 0:
        body = assembly.bodies[component.body]
        is_closed = body.kind is BodyKind.SURFACE and body.watertight
        if body.kind is not BodyKind.SOLID:
            yield {
                BodyKind.SURFACE: "closed surface, weighed as a solid" if is_closed else "surface, no mass",
                BodyKind.TESSELLATED: "mesh only",
                BodyKind.WIRE: "curves only",
            }[body.kind]
        if is_closed:
            pass  # its defect: it is no solid
        elif body.defect:
            yield body.defect
        elif body.kind is BodyKind.SOLID and not body.watertight:
            yield "not watertight"
    if component.material:
        yield f"material '{component.material}'"
    if component.by_ordinal_only:
        yield "distinguished from siblings by #n only"


def _validations(assembly: Assembly, *, verbose: bool) -> list[str]:
    """The validation properties of the file that differ from the measured values, or, with ``verbose``, all of them."""
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
        if verbose or not v.agrees
    ]
    rows = list(dict.fromkeys(rows))
    count = counted(len(assembly.validations), "validation property", "validation properties")
    head = f"{agree} of {count} match{'' if verbose or not agree else '; -v lists them'}"
    return ["", head, *(aligned([_VALIDATION_HEADINGS, *rows]) if rows else [])]


def _values(quantity: Quantity, values: tuple[float, ...]) -> str:
    factor = _MEASURES[quantity][1]
    return ", ".join(f"{round(value * factor, 9) + 0.0:.6g}" for value in values)


def _described(line: AxisLine) -> str:
    return f"{_placed(line)}, {_radii(line.radii)}"


def _placed(line: AxisLine) -> str:
    direction = ", ".join(f"{round(c, 4) + 0.0:.4g}" for c in line.direction)
    return f"axis [{direction}] at [{_numbers(line.point)}] mm, from {_number(line.low)} to {millimetres(line.high)}"


def _radii(radii: Iterable[float]) -> str:
    return f"radius {', '.join(map(_number, radii))} mm"


def _number(length: float) -> str:
    """A length [m] as a number of millimetres."""
    return millimetres(length).removesuffix(" mm")


def _extent(length: float, slack: float) -> str:
    """A length [m] as a number of millimetres, without the digits that a mesh which is ``slack`` [m] off lacks."""
    return _number(length) if slack <= 0.0 else f"{round(length * 1e3, -floor(log10(slack * 1e3))) + 0.0:.10g}"


def _numbers(point: Vector3) -> str:
    return ", ".join(map(_number, point))


def _volume(value: float) -> str:
    """A volume [m^3] as text."""
    return f"{value * 1e6:.6g} cm^3"


def tree_lines(
    components: Sequence[Component], rows: Sequence[Row], facts: Sequence[str], width: int | None
) -> list[str]:
    """One branch per row, below those of the subassemblies that it is in.

    Args:
        components: All components; parents come before their children.
        rows: The components to show. Subassemblies that are not among them are shown by their name alone.
        facts: For each row its properties in words.
    """
    words_of = {row.component.index: words for row, words in zip(rows, facts, strict=True)}
    below: dict[int, list[int]] = {0: []}
    for row in rows:
        path, index = list[int](), row.component.index
        while index not in below:
            path.append(index)
            index = components[index].parent
        for index in reversed(path):
            below[index] = []
            below[components[index].parent].append(index)

    def branch(index: int, first: str, further: str) -> Iterator[str]:
        label = printable(": ".join(filter(None, (quoted(components[index].segment), words_of.get(index, "")))))
        is_wide = width is not None and cells(first + label) > width
        head, *rest = wrapped(label, max(width - cells(first), 1)) if is_wide and width is not None else [label]
        yield f"{first}{head}"
        yield from (f"{further}{line}" for line in rest)
        *others, last = below[index] or [-1]
        for child in others:
            yield from branch(child, f"{further}├── ", f"{further}│   ")
        if last >= 0:
            yield from branch(last, f"{further}└── ", f"{further}    ")

    return [line.rstrip() for line in branch(0, "", "")]
