"""The generated parts of README.md: tables of each robot, and the gallery of all."""

import re
from collections.abc import Mapping, Sequence
from math import degrees, isinf
from pathlib import Path
from typing import TYPE_CHECKING

from . import fingerprints

if TYPE_CHECKING:
    from stepbot.diagnostics import Diagnostics
    from stepbot.pipeline.stages import Conversion
    from stepbot.report.robot import Report
    from stepbot.robot.model import Joint, MassProperties, Robot
    from stepbot.runtime.robot_library import LibraryRobot

START, END = "<!-- generated: do not edit below -->", "<!-- end of the generated part -->"
_PART = re.compile(f"{re.escape(START)}.*{re.escape(END)}\n?", re.DOTALL)
_MADE_FROM = re.compile(r"<!-- drawn from ([0-9a-f]+), converted from ([0-9a-f]+) -->")
_COLUMNS = 3
_WHOLE = "robot"
"""In place of a format, for checks of the robot itself."""
_LOWERED = re.compile(r"SB7\d\d")


def robot_part(
    folder: Path, conversion: "Conversion", own: Mapping[str, "MassProperties"], drive: Sequence[str]
) -> str:
    """The generated part of a robot's README.

    Args:
        folder: The robot's folder.
        conversion: The verified conversion.
        own: Mass properties of links from their shapes only, for those whose maker publishes others.
        drive: Lines of the section on drive tests.
    """
    robot, report = conversion.robot, conversion.report
    assert robot is not None
    assert report is not None
    lines = [START, f"<!-- drawn from {fingerprints.drawing(folder)}, converted from {fingerprints.robot(folder)} -->"]
    lines += ["", facts_of(conversion), ""]
    lines += ["## Joints", "", *_joints(robot), ""]
    lines += ["## Links", "", *_links(robot, own), ""]
    lines += ["## Verification", "", *_verification(report, conversion.diagnostics), ""]
    lines += [*drive, END]
    return "\n".join(lines) + "\n"


def with_part(page: str, part: str) -> str:
    """A page with its generated part replaced, or appended if it has none."""
    if START not in page:
        return f"{page.rstrip()}\n\n{part}"
    return _PART.sub(lambda _: part, page)


def made_from(page: str) -> tuple[str, str] | None:
    """Hashes of the inputs of a robot's STEP and tables, from its README; None if missing."""
    found = _MADE_FROM.search(page)
    return None if found is None else (found[1], found[2])


def gallery(robots: Sequence["LibraryRobot"], composed: Sequence["LibraryRobot"] = ()) -> str:
    """The generated part of the library's README, from the robots' pages: pictures and verification results.

    Args:
        robots: Those that are drawn.
        composed: Those that are composed of them and have a picture.
    """
    lines = [START, "", "<table>"]
    shown = [*robots, *composed]
    for first in range(0, len(shown), _COLUMNS):
        lines.append("<tr>")
        for robot in shown[first : first + _COLUMNS]:
            place = robot.picture.relative_to(robot.folder.parent).as_posix()
            picture = f'<a href="{robot.folder.name}"><img src="{place}" alt="{robot.name}" width="300"></a>'
            lines.append(f'<td align="center">{picture}<br><b>{robot.name}</b><br>{robot.summary()}</td>')
        lines.append("</tr>")
    results = {robot.name: _results(robot) for robot in robots}
    ran = [pair for found in results.values() for pair, result in found.items() if not result.startswith("not run")]
    pairs = list(dict.fromkeys(ran))
    lines += ["</table>", "", "| robot | | driven | " + " | ".join(pairs) + " |"]
    lines.append("| --- | --- | --- | " + " | ".join("---" for _ in pairs) + " |")
    for robot in robots:
        cells = [results[robot.name].get(pair, "") for pair in pairs]
        facts = f"[{robot.name}]({robot.name}) | {robot.facts()} | {_drives(robot)}"
        lines.append(f"| {facts} | " + " | ".join(cells) + " |")
    lines += [
        "",
        "Reasons for what is lowered or not run, and engines that were not installed, are in the README of each",
    ]
    lines += ["robot.", "", END]
    return "\n".join(lines) + "\n"


def _results(robot: "LibraryRobot") -> dict[str, str]:
    """For each format and engine the verification result on the robot's page."""
    rows = robot.table("Verification")[1:]
    return {f"{format_} in {engine}": result for format_, engine, result, *_ in rows if format_ != _WHOLE}


def _drives(robot: "LibraryRobot") -> str:
    """The number of drive tests on the robot's page that passed and failed."""
    results = [result for _, _, result, *_ in robot.table("Drive tests")[1:]]
    words = [f"{results.count(word)} {word}" for word in ("passed", "failed") if word in results]
    return ", ".join(words)


def facts_of(conversion: "Conversion") -> str:
    """Links, degrees of freedom, loops and mass in a few words."""
    robot, report = conversion.robot, conversion.report
    assert robot is not None
    assert report is not None
    mass = sum(link.mass_properties.mass for link in robot.links)
    freedom = report.degrees_of_freedom
    loops = f", {len(robot.closures)} loop{'s' * (len(robot.closures) > 1)}" if robot.closures else ""
    return f"{len(robot.links)} links, {freedom} DoF{loops}, {_number(mass)} kg"


def _joints(robot: "Robot") -> list[str]:
    lines = ["| joint | type | parent | child | axis | lower | upper | velocity | effort |", "|" + " --- |" * 9]
    for joint in robot.joints:
        limit, angular = joint.limit, joint.kind.value != "prismatic"
        bounds = [_position(value, angular) for value in (limit.lower, limit.upper)]
        rates = [_rate(limit.velocity, "rad/s" if angular else "m/s"), _rate(limit.effort, "N m" if angular else "N")]
        axis = " ".join(_number(value) for value in joint.axis) if joint.kind.value not in ("fixed", "ball") else ""
        cells = [joint.name, _kind(joint), joint.parent, joint.child, axis, *bounds, *rates]
        lines.append("| " + " | ".join(cells) + " |")
    for closure in robot.closures:
        kind = f"{closure.kind.value}, closes a loop"
        lines.append(f"| {closure.name} | {kind} | {closure.link_a} | {closure.link_b} | | | | | |")
    return lines


def _kind(joint: "Joint") -> str:
    if joint.mimic is None:
        return joint.kind.value
    return f"{joint.kind.value}, {_number(joint.mimic.multiplier)} × {joint.mimic.joint}"


def _links(robot: "Robot", own: Mapping[str, "MassProperties"]) -> list[str]:
    lines = ["| link | mass [kg] | com [mm] | inertia xx, yy, zz [kg m²] |", "|" + " --- |" * 4]
    for link in robot.links:
        lines.append(f"| {link.name} | {_mass_cells(link.mass_properties)} |")
        if link.name in own:
            scaled = own[link.name].scaled(_ratio(link.mass_properties.mass, own[link.name].mass))
            lines.append(f"| – its shape, evenly filled | {_mass_cells(scaled)} |")
    return lines


def _ratio(mass: float, of: float) -> float:
    return mass / of if of else 0.0


def _mass_cells(body: "MassProperties") -> str:
    com = ", ".join(f"{1000 * value + 0.0:.1f}".replace("-0.0", "0.0") for value in body.com)
    inertia = ", ".join(_number(body.inertia[i][i]) for i in range(3))
    return f"{_number(body.mass)} | {com} | {inertia}"


def _verification(report: "Report", diagnostics: "Diagnostics") -> list[str]:
    lines = ["| format | engine | result | compared | not compared, and why |", "|" + " --- |" * 5]
    by_other_means = {d.span.file for d in diagnostics if _LOWERED.match(d.code) and d.severity == "warning"}
    for row in report.rows():
        result = row.status.value + (", lowered" if row.format and row.file in by_other_means else "")
        cells = (row.format or _WHOLE, row.engine, result, ", ".join(row.compared), row.why)
        lines.append("| " + " | ".join(cells) + " |")
    lowered = [diagnostic.message for diagnostic in diagnostics if _LOWERED.match(diagnostic.code)]
    lines += ["", *(f"- {message}" for message in lowered)]
    return [line.replace("<", "&lt;") for line in lines]


def _position(value: float, angular: bool) -> str:
    if isinf(value):
        return ""
    return f"{degrees(value):.5g}°" if angular else f"{1000 * value:.5g} mm"


def _rate(value: float, unit: str) -> str:
    return "" if isinf(value) else f"{value:.5g} {unit}"


def _number(value: float) -> str:
    return f"{value + 0.0:.4g}"
