"""Write the files that are generated from the code, or list outdated ones with ``--check``."""

import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

from click import Context
from drive_table import drive_table
from mapping_page import mapping_page
from reference import REFERENCE, reference_page  # beside this file

from stepbot.driving.limits import LIMITS, UNITS
from stepbot.sidecar.schema import motors_schema_text, schema_text
from stepbot_cli.application import application

ROOT = Path(__file__).resolve().parents[1]
_HELP = re.compile(r"(<!-- generated: help -->\n).*?(<!-- end -->)", re.DOTALL)

_TEACHES = re.compile(r"= help: .*`.*:.*`")
"""A remedy with YAML to paste."""
_SECTION = re.compile(r"^### (SB\d{3}): .*?\n(?=\n#)", re.DOTALL | re.MULTILINE)
_EXAMPLE = re.compile(r"\n```text\n.*?\n```\n", re.DOTALL)
"""Section of a code, and the example at its end."""
_OF_SIDECARS = ("SB1", "SB3", "SB4", "SB5")
_MOST_LINES = 8
"""Maximum number of lines of a diagnostic's example."""
_LAYERS = re.compile(r"(## Who may import whom\n\n```text\n).*?(```\n)", re.DOTALL)


def commands() -> str:
    """docs/commands.md with ``stepbot --help``."""
    context = Context(application, info_name="stepbot", terminal_width=100, help_option_names=["-h", "--help"])
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    return _HELP.sub(lambda match: f"{match[1]}```text\n{application.get_help(context)}\n```\n{match[2]}", text)


def architecture() -> str:
    """docs/architecture.md with the layers of the import contract."""
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (layers,) = (contract["layers"] for contract in contracts if contract["id"] == "layers")
    line = " > ".join(["stepbot_cli", *layers])
    return _LAYERS.sub(lambda match: f"{match[1]}{line}\n{match[2]}", text)


def diagnostics() -> str:
    """docs/diagnostics.md; where the remedy is YAML to paste, with the beginning of the first transcript."""
    folders = sorted((ROOT / "tests" / "diagnostics").glob("SB[0-9][0-9][0-9]_*"), reverse=True)
    texts = {folder.name[:5]: _example(folder) for folder in folders if folder.name.startswith(_OF_SIDECARS)}
    examples = {code: f"\n```text\n{text}\n```\n" for code, text in texts.items() if _TEACHES.search(text)}
    page = _EXAMPLE.sub("", (ROOT / "docs" / "diagnostics.md").read_text(encoding="utf-8"))
    return _SECTION.sub(lambda section: section[0] + examples.get(section[1], ""), page)


def _example(folder: Path) -> str:
    """The command of a transcript, if it has one, and the first diagnostic of its code."""
    code = f"[{folder.name[:5]}"
    blocks = (folder / "expected.txt").read_text(encoding="utf-8").rstrip().split("\n\n")
    block = next(block for block in blocks if code in block.partition("\n")[0])
    lines = block.splitlines()
    shown = [*lines[:_MOST_LINES], "..."] if len(lines) > _MOST_LINES else lines
    command = folder / "command"
    if command.exists():
        shown.insert(0, f"$ stepbot {command.read_text(encoding='utf-8').strip()}")
    elif (folder / "robot.robot.yaml").exists():
        shown.insert(0, "$ stepbot check robot.robot.yaml")
    return "\n".join(shown)


_LIMITS = re.compile(r"(<!-- limits -->\n).*?(<!-- end of limits -->)", re.DOTALL)
_LIBRARY = re.compile(r"(<!-- library -->\n).*?(<!-- end of library -->)", re.DOTALL)


def drive() -> str:
    """docs/drive.md with the default limits and the table of the library."""
    rows = ["| test | quantity | limit | reason |", "| --- | --- | --- | --- |"]
    rows += [
        f"| {test} | {quantity} | {bound.value:g} {UNITS[quantity]} | {bound.why} |"
        for test, bounds in LIMITS.items()
        for quantity, bound in sorted(bounds.items())
    ]
    text = (ROOT / "docs" / "drive.md").read_text(encoding="utf-8")
    for pattern, lines in ((_LIMITS, rows), (_LIBRARY, drive_table())):
        text = pattern.sub(lambda match, lines=lines: "\n".join([match[1], *lines, "", match[2]]), text)
    return text


def api() -> str:
    """docs/api.md with the reference at its end."""
    examples = (ROOT / "docs" / "api.md").read_text(encoding="utf-8").partition(REFERENCE)[0].rstrip()
    return f"{examples}\n\n{reference_page()}"


GENERATED: dict[str, Callable[[], str]] = {
    "docs/architecture.md": architecture,
    "schemas/robot-1.schema.json": schema_text,
    "schemas/motors-1.schema.json": motors_schema_text,
    "docs/diagnostics.md": diagnostics,
    "docs/mapping.md": mapping_page,
    "docs/drive.md": drive,
    "docs/commands.md": commands,
    "docs/api.md": api,
}


def main(arguments: list[str]) -> int:
    """Write all generated files; with ``--check`` only compare, and return 1 if one is outdated."""
    stale = []
    for path, text in GENERATED.items():
        file, wanted = ROOT / path, text()
        if not file.is_file() or file.read_text(encoding="utf-8") != wanted:
            stale.append(path)
            if arguments != ["--check"]:
                file.write_text(wanted, encoding="utf-8", newline="\n")
    for path in stale:
        print(f"{path}: {'stale, run `make generate`' if arguments == ['--check'] else 'written'}")
    return 1 if stale and arguments == ["--check"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
