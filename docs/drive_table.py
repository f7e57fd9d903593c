"""The table of docs/drive.md: the worst number of each robot of the library and engine, from the robots' pages."""

import re

from stepbot.driving.limits import UNITS
from stepbot.driving.plan import ENGINES
from stepbot.runtime.robot_library import LibraryRobot, library_robots

_NAMES = "|".join(sorted(map(re.escape, UNITS), key=len, reverse=True))
_NUMBER = re.compile(
    rf"(?P<name>{_NAMES})(?: of \S.*?)? (?P<value>[-+.\de]+)(?: (?:%|rad|mm|deg|m/s))?(?: \(limit .*\))?"
)

_SMALLEST = 0.01
"""Smallest number shown as other than 0."""
_COLUMNS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    # Title: (unit, test or all of them, quantities, of which the largest is shown).
    "lag": ("%", "track", ("lag", "lag with other gains", "lag with limited effort")),
    "overshoot": ("%", "step", ("overshoot", "overshoot with other gains")),
    "hold": ("mrad", "hold", ("angle error", "angle error with other gains")),
    "hold, slides": ("mm", "hold", ("travel error",)),
    "speed": ("%", "step", ("speed of limit", "speed of limit with other gains")),
    "pushed": ("%", "step", ("pushed speed of limit",)),
    "grip": ("mm", "grip", ("slip",)),
    "depth": ("mm", "grip", ("penetration",)),
    "roll": ("%", "roll", ("distance error",)),
    "turn": ("%", "turn", ("turn error",)),
    "loops": ("mm", "", ("loop opening",)),
    "stand": ("deg", "stand", ("tilt after push",)),
}


def drive_table() -> list[str]:
    """Lines of the Markdown table."""
    titles = [f"{title} [{unit}]" for title, (unit, _, _) in _COLUMNS.items()]
    lines = [f"| robot | engine | {' | '.join(titles)} |", "| --- " * (2 + len(titles)) + "|"]
    for robot in library_robots():
        for engine in ENGINES:
            numbers = _numbers(robot, engine)
            if numbers:
                lines.append(f"| {robot.name} | {engine} | {' | '.join(_cells(numbers))} |")
    return lines


def _numbers(robot: LibraryRobot, engine: str) -> list[tuple[str, str, float]]:
    """Test, quantity and value of each number on a robot's page."""
    found = []
    for test, name, _, numbers in robot.table("Drive tests")[1:]:
        matches = [_NUMBER.fullmatch(words) for words in numbers.split("; ")] if name == engine else []
        found += [(test, match["name"], float(match["value"])) for match in matches if match]
    return found


def _cells(numbers: list[tuple[str, str, float]]) -> list[str]:
    cells = []
    for unit, test, quantities in _COLUMNS.values():
        values = [value for at, quantity, value in numbers if quantity in quantities and test in ("", at)]
        largest = (1e3 if unit == "mrad" else 1.0) * max(values, default=0.0)
        cells.append((f"{largest:.3g}" if largest >= _SMALLEST else "0") if values else "")
    return cells
