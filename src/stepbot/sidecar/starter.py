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


def robot_name(stem: str) -> str:
    """The name with invalid characters replaced."""
    return re.sub(r"[\s/<>&\"'\\:*?|.\x00-\x1f\x7f]+", "_", stem).strip("_")[:100] or "robot"


def scalar(text: str) -> str:
    """A string as a YAML scalar on one line, quoted if necessary."""
    plain = _PLAIN.fullmatch(text) and text.casefold() not in _NOT_TEXTS
    return text if plain else json.dumps(text, ensure_ascii=not text.isprintable())
