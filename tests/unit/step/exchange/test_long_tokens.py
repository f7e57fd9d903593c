"""Strings and comments that exceed the buffer of the kernel's parser."""

from pathlib import Path

import pytest

from stepbot.step.exchange.statements import LONGEST
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here

ROOM = LONGEST - 2
"""Bytes between the quotes."""


def written(folder: Path, string: str = "", comment: str = "") -> Path:
    """An assembly with a string as the name of a product, and a comment before the data."""
    path = parts.write_nested(folder / "long.step").path
    head, product, rest = path.read_text(encoding="utf-8").partition("PRODUCT('")
    name, quote, rest = rest.partition("'")
    text = f"{head}{product}{string or name}{quote}{rest}".replace("DATA;", f"DATA;\n{comment}", 1)
    path.write_text(text, encoding="utf-8", newline="\n")
    return path


@pytest.mark.parametrize(
    "string", ["a" * ROOM, "''" * (ROOM // 2), "a\n" * (ROOM // 2)], ids=["letters", "quotes", "lines"]
)
def test_longest_string_is_read(string: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A string of the kernel's maximum length is read, and a comment of any length in short lines."""
    assert read_here(written(tmp_path, string, f"/*{'comment ' * 9}{'* and more' * 9_999}*/"), diagnostics) is not None
    assert diagnostics.codes() == []


@pytest.mark.parametrize(
    ("string", "comment", "message"),
    [
        ("a" * (ROOM + 1), "", f"string of {ROOM + 1} bytes, the kernel supports {LONGEST}"),
        ("''" * (ROOM // 2 + 1), "", f"string of {ROOM + 2} bytes, the kernel supports {LONGEST}"),
        ("\xe4" * (ROOM // 2 + 1), "", f"string of {ROOM + 2} bytes, the kernel supports {LONGEST}"),
        ("", f"/* it's\n{'c' * 20_000}*/", f"comment with 20000 bytes in a line, the kernel supports {LONGEST}"),
        ("b" * 70_000, f"/*{'c' * 20_000}*/", "comment with 20000 bytes in a line"),
    ],
    ids=["letters", "quotes", "not ASCII", "comment", "both"],
)
def test_longer_ones_are_reported_by_line(
    string: str, comment: str, message: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """A longer string is an error with the line, the length and a remedy."""
    path = written(tmp_path, string, comment)
    assert read_here(path, diagnostics) is None
    (error,) = diagnostics
    assert error.code == "SB205"
    assert error.message.startswith(message)
    assert error.help
    line = path.read_text(encoding="utf-8").split("/*" if comment else string)[0].count("\n") + 1
    assert error.span.line == line
    assert len(error.notes) == bool(string and comment)
