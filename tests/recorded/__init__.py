"""Results of many inputs as they were recorded: a digest of each, so that any change of a result is noticed.

``python -m tests.recorded`` records them again; ``python -m tests.recorded --show 'drafts rods 1'`` prints the result
behind a digest, to compare it with that of another revision. Results have closed forms and oracles elsewhere; here a
change that was not meant is seen.
"""

import hashlib
import re
from collections.abc import Callable, Mapping
from enum import Enum
from functools import cache
from pathlib import Path

import numpy as np
from msgspec import Struct

from stepbot import __version__

_LONG_NUMBER = re.compile(r"-?\d+(\.\d{5,}(e[-+]?\d+)?|(\.\d+)?e[-+]?\d+)")
FOLDER = Path(__file__).parent
_NOISE = 1e-16
"""How much positions [m] are changed to see what rounding decides: other processors round otherwise."""
Results = Mapping[str, Callable[[float], Mapping[str, object]]]
"""By name, what makes the parts of a result, of positions with so much noise."""


def text(value: object) -> str:
    """A result as text: the fields of data classes by name, numbers to six digits, sets in order, bytes by digest."""
    if isinstance(value, Enum):
        return str(value)
    if isinstance(value, Struct):
        fields = (f"{name}={text(getattr(value, name))}" for name in value.__struct_fields__)
        return f"{type(value).__name__}({', '.join(fields)})"
    if isinstance(value, bytes):
        return _readable(value)
    if isinstance(value, float | np.floating):
        return f"{round(float(value), 9) + 0.0:.6g}"
    if isinstance(value, Mapping):
        return "{" + ",\n".join(f"{text(key)}: {text(one)}" for key, one in value.items()) + "}"
    if isinstance(value, set | frozenset):
        return "{" + ", ".join(sorted(map(text, value))) + "}"
    if isinstance(value, np.ndarray):
        return text(value.tolist())
    if isinstance(value, tuple | list):
        return "[" + ", ".join(map(text, value)) + "]"
    return str(value)


def _readable(content: bytes) -> str:
    """Text with its numbers rounded, since an old processor has other last digits; other content by its digest."""
    try:
        return _LONG_NUMBER.sub(lambda found: text(float(found[0])), content.decode("utf-8"))
    except UnicodeDecodeError:
        return hashlib.sha256(content).hexdigest()


def digest(value: object) -> str:
    """Digits that two results share only if their texts are equal."""
    plain = text(value).replace(f"stepbot {__version__}", "stepbot")
    return hashlib.sha256(plain.encode()).hexdigest()[:12]


@cache
def recorded(of: str) -> dict[str, dict[str, str]]:
    """The digest of each part of each result, by name."""
    lines = (line.split(" = ") for line in (FOLDER / f"{of}.txt").read_text(encoding="utf-8").splitlines())
    return {name: dict(part.split(":") for part in parts.split()) for name, parts in lines}


def record(of: str, results: Results) -> None:
    """Record results as they are, without the parts of them that rounding decides.

    Parts that a recorded result lacks stay left out: another processor rounds them otherwise. Remove its line to try.
    """
    lines, known = [], recorded(of)
    for name, make in results.items():
        parts, disturbed = make(0.0), make(_NOISE)
        digests = {part: digest(one) for part, one in parts.items()}
        tried = known.get(name, digests)
        kept = (f"{part}:{digests[part]}" for part in tried if digests[part] == digest(disturbed[part]))
        lines.append(f"{name} = {' '.join(kept)}\n")
    (FOLDER / f"{of}.txt").write_text("".join(lines), encoding="utf-8", newline="\n")
