"""Names and YAML scalars of new sidecars."""

import json
import re
from pathlib import Path

from stepbot.robot.step_names import step_stem

_PLAIN = re.compile(r"[^\W\d_][\w./+-]*( [\w./+-]+)*")
"""Strings that are valid plain YAML scalars; a subset."""
_NOT_TEXTS = frozenset(("true", "false", "null", "inf", "nan"))


def starter_name(step: Path) -> str:
    """Default name of the sidecar of a STEP file: ``arm.robot.yaml`` for ``arm.step``."""
    return f"{step_stem(step.name)}.robot.yaml"


def description_starter(description: Path) -> str:
    """The text of a sidecar that changes a description, which stays as it is."""
    name = robot_name(description.name.partition(".")[0])
    lines = ("version: 1", f"robot: {scalar(name)}", "modules:", f"  {scalar(name)}:")
    return "\n".join((*lines, f"    file: {scalar(description.name)}", '    prefix: ""', ""))


def one_link_starter(step: Path) -> str:
    """The text of a sidecar by which all parts of a STEP file are one link, of a density that is not known yet."""
    lines = ("version: 1", f"robot: {scalar(robot_name(step_stem(step.name)))}", f"step: {scalar(step.name)}")
    return "\n".join((*lines, "defaults: {density: todo}", "links: {body: {rest: true}}", ""))


def robot_name(stem: str) -> str:
    """The name with invalid characters replaced."""
    return re.sub(r"[\s/<>&\"'\\:*?|.\x00-\x1f\x7f]+", "_", stem).strip("_")[:100] or "robot"


def scalar(text: str) -> str:
    """A string as a YAML scalar on one line, quoted if necessary."""
    plain = _PLAIN.fullmatch(text) and text.casefold() not in _NOT_TEXTS
    if plain:
        return text
    # JSON escapes a character beyond U+FFFF as two, which YAML rejects.
    return _PAIR.sub(_as_one_escape, json.dumps(text, ensure_ascii=not text.isprintable()))


_PAIR = re.compile(r"\\u(d[89ab][0-9a-f]{2})\\u(d[c-f][0-9a-f]{2})")


def _as_one_escape(pair: re.Match[str]) -> str:
    high, low = int(pair[1], 16), int(pair[2], 16)
    return f"\\U{0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00):08x}"
