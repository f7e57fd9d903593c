"""Joints with their evidence, masses with their sources, collision shapes with their scores, bodies measured twice.

Every text and attribute of an HTML or SVG element is escaped, so that no name becomes markup.
"""

from collections.abc import Callable, Iterable
from functools import partial
from html import escape
from math import degrees, floor, isfinite

from stepbot.diagnostics import counted
from stepbot.geometry.fixed_point import exact_sum
from stepbot.report.robot import LinkCollision, MeasuredBody, Report, Status
from stepbot.report.words import direction_words, evidence_words, point_words, rival_words, shape_words, sheet_blocks
from stepbot.robot.datasheet import ArmFigures, data_sheet
from stepbot.robot.joint_table import JointRow
from stepbot.robot.kinematics import NO_BOUND
from stepbot.robot.model import ComponentMass, Joint, JointKind, Link, Robot


class Markup(str):
    """HTML that is safe to put into a page."""

    __slots__ = ()


def element(kind: str, *children: object, **attributes: object) -> Markup:
    """An element.

    Args:
        kind: Tag and classes: ``td.number``.
        children: Texts, elements, or iterables of them; None is left out.
        attributes: Attributes; ``_`` in a name becomes ``-``, None is left out.
    """
    tag, *classes = kind.split(".")
    names = {name.strip("_").replace("_", "-"): value for name, value in attributes.items()}
    given = {"class": " ".join(classes) or None, **names}
    written = "".join(f' {name}="{escape(str(value))}"' for name, value in given.items() if value is not None)
    return Markup(f"<{tag}{written}>{joined(children)}</{tag}>")


def joined(children: Iterable[object]) -> Markup:
    """Texts and elements one after the other."""
    return Markup("".join(_content(child) for child in children))


def _content(child: object) -> str:
    if child is None:
        return ""
    if isinstance(child, Markup):
        return child
    if isinstance(child, str):
        return escape(child)
    if isinstance(child, Iterable):
        return joined(child)
    return escape(str(child))


def cell(value: float | None, words: Callable[[float], str]) -> Markup:
    """A cell of a table with a number in words; a dash without one."""
    if value is None or not isfinite(value):
        return element("td.number", "–")
    return element("td.number", words(value), data_value=repr(float(value)))


def table_row(head: object, *cells: object, **attributes: object) -> Markup:
    """A row of a table: its heading, and cells; a text is a cell of its own."""
    shown = (one if isinstance(one, Markup) else element("td", one) for one in cells)
    return element("tr", element("th", head), *shown, **attributes)


def section(heading: str, *content: object, name: str) -> Markup:
    """A section of the page."""
    return element("section", element("h2", heading), *content, id=name)


def mass_text(mass: float) -> str:
    """A mass [kg] in kilograms, grams or milligrams."""
    if mass >= 1.0 or mass == 0.0:
        return f"{mass:.4g} kg"
    return f"{mass * 1e3:.4g} g" if mass >= 1e-3 else f"{mass * 1e6:.4g} mg"


def position_text(value: float, slides: bool) -> str:
    """A joint's position [rad] or [m] in degrees or millimetres."""
    return f"{round(value * 1e3, 6) + 0.0:.6g} mm" if slides else f"{round(degrees(value), 6) + 0.0:.6g}°"


def short(value: float) -> str:
    """A number of any size in few letters."""
    return f"{value:.2e}" if value and not 1e-3 <= abs(value) < 1e5 else f"{value:.4g}"


def table(headings: Iterable[str], rows: Iterable[Markup]) -> Markup:
    """A table that scrolls sideways where the page is narrow."""
    head = element("thead", element("tr", (element("th", heading) for heading in headings)))
    return element("div.scroll", element("table", head, element("tbody", rows)))


def modules_section(robot: Robot, report: Report) -> Markup | None:
    """The robots that this one is composed of, and what each was compared with; None without modules."""
    headings = ("module", "file", "on link", "mirrored", "links", "mass", "compared with the file alone")
    rows = []
    for module in robot.modules:
        checks = [check for check in report.checks if check.against == f"module '{module.name}' alone"]
        ran = [check for check in checks if check.status is not Status.NOT_RUN]
        failed = [check.status for check in ran].count(Status.FAILED)
        engines = ", ".join(dict.fromkeys("model" if check.engine == "stepbot" else check.engine for check in ran))
        words = f"{failed} of {len(ran)} checks failed" if failed else f"{len(ran)} checks passed"
        mass = exact_sum(robot.link_by_name[link].mass_properties.mass for link in module.links)
        count = element("td.number", len(module.links))
        proof = f"{words}: {engines}" if ran else "as a part of its module" if "/" in module.name else "–"
        rows.append(
            table_row(
                module.name, module.file, module.at or "–", module.mirror or "–", count, cell(mass, mass_text), proof
            )
        )
    return section("Modules", table(headings, rows), name="modules") if rows else None


def joints_section(robot: Robot, rows: Iterable[JointRow]) -> Markup:
    """Every joint and closure, and how its axis was found."""
    listed = list(rows)
    weak = [row.name for row in listed if row.evidence.doubt]
    note = element("p.warn", f"On weak evidence: {', '.join(weak)}. Check these axes.") if weak else None
    headings = ("joint", "type", "links", "lower", "upper", "axis", "through", "found by")
    shown = (_joint_row(row, robot.joint_by_name.get(row.name)) for row in listed)
    body = table(headings, shown) if listed else element("p.quiet", "The robot has no joints.")
    return section("Joints", note, body, name="joint-table")


def _joint_row(row: JointRow, joint: Joint | None) -> Markup:
    evidence = row.evidence
    axis = "–" if row.axis is None else direction_words(row.axis)
    second = "" if row.axis2 is None else f", {direction_words(row.axis2)}"
    others = (
        element(
            "details",
            element("summary", f"{len(evidence.rivals)} other lines"),
            element("ul", (element("li", rival_words(rival)) for rival in evidence.rivals)),
        )
        if evidence.rivals
        else None
    )
    weak = element("div.warn", f"weak: {evidence.doubt}") if evidence.doubt else None
    return table_row(
        f"{'? ' if evidence.doubt else ''}{row.name}",
        f"{row.kind}{' closure' if row.is_closure else ''}",
        f"{row.parent} → {row.child}",
        *_limits(joint),
        element("td.number", axis + second),
        element("td.number", "not reported" if row.origin is None else point_words(row.origin)),
        (evidence_words(evidence), weak, others),
        data_joint=row.name,
    )


def _limits(joint: Joint | None) -> tuple[object, object]:
    if joint is None or not joint.kind.has_axis:
        return "", ""
    if joint.mimic is not None:
        return f"{joint.mimic.multiplier:g} × {joint.mimic.joint}", ""
    words, limit = partial(position_text, slides=joint.kind is JointKind.PRISMATIC), joint.limit
    lower = limit.lower if limit.lower > -NO_BOUND else None
    upper = limit.upper if limit.upper < NO_BOUND else None
    return cell(lower, words), cell(upper, words)


def masses_section(robot: Robot) -> Markup:
    """Mass, centre and inertia of every link, and the source of the mass of every component."""
    total = exact_sum(link.mass_properties.mass for link in robot.links)
    headings = ("link", "mass", "share", "centre of mass [mm]", "inertia xx, yy, zz [kg m²]", "from")
    rows = [_link_row(link, total) for link in robot.links]
    rows.append(element("tr.total", element("th", "total"), cell(total, mass_text), [element("td")] * 4))
    note = "Centre and inertia in the frame of the link, the inertia about its centre of mass."
    return section("Masses", table(headings, rows), element("p.quiet", note), name="mass-table")


def _link_row(link: Link, total: float) -> Markup:
    body = link.mass_properties
    share = body.mass / total if total > 0.0 else 0.0
    center = ", ".join(f"{round(1e3 * value, 4) + 0.0:.6g}" for value in body.com)
    moments = ", ".join(short(body.inertia[i][i]) for i in range(3))
    return table_row(
        link.name,
        cell(body.mass, mass_text),
        (_bar(share), f" {100 * share:.1f} %"),
        element("td.number", center if body.mass else "–"),
        element("td.number", moments if body.mass else "–"),
        (_sources(link.masses),),
        data_link=link.name,
    )


def _bar(share: float) -> Markup:
    """A share as a bar."""
    filled = element("rect.filled", width=f"{100 * share:.2f}", height=8)
    return element(
        "svg.bar", element("rect.empty", width=100, height=8), filled, viewBox="0 0 100 8", aria_hidden="true"
    )


def _sources(masses: tuple[ComponentMass, ...]) -> Markup | None:
    """Where the grams of a link come from: one line, or a table to open."""
    if not masses:
        return None
    origins = list(dict.fromkeys(mass.origin for mass in masses))
    summary = f"{counted(len(masses), 'part')}: {', '.join(origins)}"
    headings = ("component", "mass", "density [kg/m³]", "volume [cm³]", "source", "computed from")
    rows = (
        element(
            "tr",
            element("td", mass.component or "the whole link"),
            cell(mass.mass, mass_text),
            cell(mass.density, "{:.6g}".format),
            cell(mass.volume, lambda volume: f"{1e6 * volume:.6g}"),
            element("td", mass.origin),
            element("td", mass.method),
        )
        for mass in masses
    )
    return element("details", element("summary", summary), table(headings, rows))


def motors_section(robot: Robot) -> Markup | None:
    """Each figure that a motor of the catalogue gives, with its source, and the doubts."""
    driven = [(actuator, actuator.motor) for actuator in robot.actuators if actuator.motor is not None]
    rows = [
        table_row(
            actuator.name,
            motor.name,
            figure.quantity,
            cell(figure.value, f"{{:.6g}} {figure.unit}".format),
            figure.source,
        )
        for actuator, motor in driven
        for figure in motor.figures
    ]
    if not rows:
        return None
    doubts = dict.fromkeys(f"{motor.name}: {doubt}" for _, motor in driven for doubt in motor.doubts)
    headings = ("actuator", "motor", "quantity", "value", "source")
    note = "Limits and dynamics that the sidecar sets for a joint apply in place of these."
    listed = element("ul", (element("li", doubt) for doubt in doubts)) if doubts else None
    return section("Motors", table(headings, rows), listed, element("p.quiet", note), name="motor-table")


def datasheet_section(robot: Robot) -> Markup:
    """What geometry, masses and limits allow, and where the tip of each arm gets."""
    sheet = data_sheet(robot)
    pictures = {f"## {arm.tip}": _workspace(arm) for arm in sheet.arms}
    content: list[Markup | None] = []
    for block in sheet_blocks(sheet):
        if not isinstance(block, str):
            heads, rows = block
            content.append(table(heads, (table_row(*row) for row in rows)))
        elif block in pictures:
            content += [element("h3", block.removeprefix("## ")), pictures[block]]
        else:
            content.append(element("p", block.removeprefix("- ")))
    note = "The worst of many postures in the range of all joints, and peak efforts of motors, not thermal ones."
    return section("Data sheet", *content, element("p.quiet", note), name="data-sheet")


def _workspace(arm: ArmFigures) -> Markup:
    """The side view of a workspace: distance from the first axis to the right, height upwards; a grid of 0.1 or 1 m."""
    heights = [z for z, _, _ in arm.workspace]
    tall = (heights[-1] - heights[0]) / max(1, len(heights) - 1) or 0.01
    low, high, far = heights[0] - 0.5 * tall, heights[-1] + 0.5 * tall, max(r for _, _, r in arm.workspace) or 0.01
    scale = 300.0 / max(high - low, far)
    width, height = far * scale, (high - low) * scale
    step = 0.1 if max(high - low, far) < 3.0 else 1.0
    rows = (
        element(
            "rect.filled",
            x=f"{scale * near:.1f}",
            y=f"{scale * (high - z - 0.5 * tall):.1f}",
            width=f"{scale * (r - near):.1f}",
            height=f"{scale * tall:.1f}",
        )
        for z, near, r in arm.workspace
    )
    lines = [element("line.grid", x1=x, x2=x, y1=0, y2=f"{height:.1f}") for x in _ticks(0.0, far, step, scale)]
    lines += [element("line.grid", x1=0, x2=f"{width:.1f}", y1=y, y2=y) for y in _ticks(high, high - low, step, scale)]
    words = f"distance 0 to {far:.3g} m from the axis of {arm.joints[0]}, height {low:.3g} to {high:.3g} m"
    picture = element(
        "svg.reach",
        element("title", words),
        rows,
        lines,
        viewBox=f"0 0 {width:.1f} {height:.1f}",
        width=f"{width:.0f}",
        height=f"{height:.0f}",
    )
    return element("div", picture, element("p.quiet", f"Workspace from the side, {words}; lines are {step:g} m apart."))


def _ticks(start: float, length: float, step: float, scale: float) -> list[str]:
    """Places of multiples of a step: upwards from 0, or downwards from a height."""
    first = start - step * floor(start / step)
    return [f"{scale * (first + i * step):.1f}" for i in range(int((length - first) / step) + 1)]


def collisions_section(shapes: Iterable[LinkCollision]) -> Markup | None:
    """The collision shapes of every link, and how well they match its solids."""
    rows = [
        table_row(
            shape.link,
            shape.rule,
            shape_words(shape.shapes),
            element("td.number", shape.vertices),
            cell(shape.iou, "{:.3f}".format),
            cell(shape.overshoot, lambda overshoot: f"{1e3 * overshoot:.2f} mm"),
            data_link=shape.link,
        )
        for shape in shapes
    ]
    if not rows:
        return None
    headings = ("link", "rule", "shapes", "vertices", "intersection / union", "overshoot")
    note = "Intersection over union of the shapes and the solids, by volume; overshoot is how far the shapes reach."
    return section("Collision shapes", table(headings, rows), element("p.quiet", note), name="collision-table")


def bodies_section(bodies: Iterable[MeasuredBody]) -> Markup | None:
    """Every body, measured on its mesh and on the exact solid."""
    rows = [
        table_row(
            body.name,
            element("td.number", body.occurrences),
            cell(body.deviation, short),
            cell(body.error, short),
            body.written,
        )
        for body in bodies
    ]
    if not rows:
        return None
    headings = ("body", "count", "mesh against exact solid", "error of the exact", "used")
    return section("Bodies", table(headings, rows), name="body-table")
