"""What a new sidecar is called, and how texts are written in it."""

import json
import re
from pathlib import Path

_PLAIN = re.compile(r"[^\W\d_][\w./+-]*( [\w./+-]+)*")
"""Texts that mean themselves in YAML without quotes; a few that do not match would, too."""
_NOT_TEXTS = frozenset(("true", "false", "null", "inf", "nan"))


def starter_name(step: Path) -> str:
    """What to call the sidecar of a STEP file: ``arm.step`` has ``arm.robot.yaml``."""
    return f"{step.stem}.robot.yaml"


def robot_name(stem: str) -> str:
    """The name with what no robot's name may hold replaced."""
    return re.sub(r"[\s/<>&\"'\\:*?|.\x00-\x1f\x7f]+", "_", stem).strip("_")[:100] or "robot"


def scalar(text: str) -> str:
    """A text as a value or key of YAML on one line, without quotes where it needs none."""
    plain = _PLAIN.fullmatch(text) and text.casefold() not in _NOT_TEXTS
    return text if plain else json.dumps(text, ensure_ascii=not text.isprintable())
