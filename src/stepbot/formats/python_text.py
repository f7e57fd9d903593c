"""A robot's names and numbers as text of Python files: foreign names stay in strings and docstrings."""

import json
import re
from collections.abc import Mapping

from stepbot.robot.bounding_boxes import standing_height
from stepbot.robot.kinematics import initial_configuration
from stepbot.robot.model import Base, Robot


def home(robot: Robot) -> dict[str, float]:
    """The drawn position of each joint with one coordinate."""
    drawn = initial_configuration(robot)
    return {joint.name: drawn[joint.name] for joint in robot.joints if joint.name in drawn}


def height(robot: Robot) -> float:
    """Height [m] of the root link above the floor that a floating robot stands on."""
    return standing_height(robot, initial_configuration(robot)) if robot.base is Base.FLOATING else 0.0


def table(values: Mapping[str, object], indent: int = 0) -> str:
    """A dictionary, one row per line."""
    space = " " * indent
    rows = "".join(f"{space}    {literal(name)}: {literal(value)},\n" for name, value in values.items())
    return f"{{\n{rows}{space}}}"


def words(robot: Robot) -> str:
    """The robot's name in a docstring, which nothing in a foreign name may end."""
    return re.sub(r"[^\w .-]", "_", robot.name)


def class_name(robot: Robot) -> str:
    """The robot's name as that of a class."""
    name = "".join(word.capitalize() for word in re.findall(r"[A-Za-z0-9]+", robot.name)) or "Robot"
    return f"Robot{name}" if name[0].isdigit() else name


def literal(value: object) -> str:
    """A value as formatters of Python write it: with double quotes."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        inner = ", ".join(map(literal, value))
        return f"[{inner}]" if isinstance(value, list) else f"({inner}{',' * (len(value) == 1)})"
    return repr(value)
