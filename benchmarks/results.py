"""Results in benchmarks/results.json, and as text."""

import json
import os
import platform
from collections.abc import Sequence
from pathlib import Path

from msgspec.structs import asdict

from .comparison import Row

FILE = Path(__file__).with_name("results.json")


def keep(kind: str, case: str, rows: Sequence[Row], rounds: int) -> None:
    """Store results, replacing those of the same kind and case."""
    known = load()
    entry = {"machine": machine(), "rounds": rounds, "rows": [_rounded(row) for row in rows]}
    known.setdefault(kind, {})[case] = entry
    FILE.write_text(json.dumps(known, indent=1, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")


def load() -> dict[str, dict[str, dict[str, object]]]:
    """By kind and case: the machine, the number of rounds, and the rows."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}  # type: ignore[no-any-return]


def rows_of(entry: dict[str, object]) -> list[Row]:
    """The rows of a case in the result of :func:`load`."""
    rows = entry["rows"]
    assert isinstance(rows, list)
    return [Row(**{name: _plain(row.get(name)) for name in Row.__struct_fields__}) for row in rows]


def _plain(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


def table(rows: Sequence[Row]) -> str:
    """Rows as a Markdown table, with ratios to the first."""
    has_memory = any(row.memory is not None for row in rows)
    lines = ["| | wall s | ratio | cpu s | ratio |" + (" peak MiB |" if has_memory else "")]
    lines.append("| --- | --: | --: | --: | --: |" + (" --: |" if has_memory else ""))
    for row in rows:
        line = f"| {row.contender} | {row.wall:.2f} | {row.wall_ratio:.2f} | {row.cpu:.2f} | {row.cpu_ratio:.2f} |"
        memory = "" if row.memory is None else f"{row.memory:.0f}"
        lines.append(line + (f" {memory} |" if has_memory else ""))
    return "\n".join(lines)


def machine() -> str:
    """Processors, system and Python."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{cores} cores, {platform.system()} {platform.machine()}, Python {platform.python_version()}"


def _rounded(row: Row) -> dict[str, object]:
    return {name: _shortened(value) for name, value in asdict(row).items()}


def _shortened(value: object) -> object:
    if isinstance(value, tuple):
        return [_shortened(one) for one in value]
    return round(value, 4) if isinstance(value, float) else value
