"""The bytes of a sidecar."""

from pathlib import Path

import pytest

from stepbot.diagnostics import NOT_TEXT, Diagnostics
from stepbot.sidecar.text import LARGEST_FILE, read_text


def test_line_ends_and_byte_order_mark(tmp_path: Path, diagnostics: Diagnostics) -> None:
    """Line ends of every system become line feeds, and a byte order mark is removed."""
    path = tmp_path / "a.robot.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\r\nb: \xc3\xb6\rc: 3\n")
    assert read_text(path, diagnostics) == "a: 1\nb: ö\nc: 3\n"


def test_largest_file(tmp_path: Path, diagnostics: Diagnostics) -> None:
    """A file of the maximum size is read, one byte more is an error."""
    path = tmp_path / "a.robot.yaml"
    path.write_bytes(b"#" * LARGEST_FILE)
    assert read_text(path, diagnostics) == "#" * LARGEST_FILE
    path.write_bytes(b"#" * (LARGEST_FILE + 1))
    assert read_text(path, diagnostics) is None
    assert [d.code for d in diagnostics] == ["SB102"]


def test_huge_file_is_not_read(tmp_path: Path, diagnostics: Diagnostics) -> None:
    """Of a sparse file of 100 GB only the start is read."""
    path = tmp_path / "a.robot.yaml"
    with path.open("wb") as stream:
        stream.truncate(100 * 1024**3)
    assert read_text(path, diagnostics) is None
    assert [d.code for d in diagnostics] == ["SB102"]


@pytest.mark.parametrize(("make", "reason"), [(None, "file not found"), ("folder", "is a folder, not a file")])
def test_what_cannot_be_read(make: str | None, reason: str, tmp_path: Path, diagnostics: Diagnostics) -> None:
    """A missing file and a folder are reported as such."""
    path = tmp_path / "a.robot.yaml"
    if make:
        path.mkdir()
    assert read_text(path, diagnostics) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB001"
    assert diagnostic.message == reason
    assert diagnostic.span.file == path.as_posix()


def test_sidecar_that_is_meant(tmp_path: Path, diagnostics: Diagnostics) -> None:
    """A misspelt name has a suggestion, a folder its sidecars, and an empty folder general help."""
    assert read_text(tmp_path / "arm.robot.yaml", diagnostics) is None
    (tmp_path / "arm.robot.yml").touch()
    assert read_text(tmp_path / "amr.robot.yml", diagnostics) is None
    assert read_text(tmp_path, diagnostics) is None
    helps = [diagnostic.help for diagnostic in diagnostics]
    assert helps == [
        ("sidecars are usually named `<robot>.robot.yaml`",),
        ("did you mean 'arm.robot.yml'?",),
        ("use a file in it: arm.robot.yml",),
    ]


def test_place_of_a_byte_that_is_not_utf_8(tmp_path: Path, diagnostics: Diagnostics) -> None:
    """The column of an invalid byte counts characters, not bytes."""
    path = tmp_path / "a.robot.yaml"
    path.write_bytes("a: 1\nöö: ".encode() + b"\xff\n")
    assert read_text(path, diagnostics) is None
    (diagnostic,) = diagnostics
    assert (diagnostic.code, diagnostic.span.line, diagnostic.span.column) == ("SB102", 2, 5)


@pytest.mark.slow
def test_characters_of_a_sidecar() -> None:
    """Those that YAML allows (1.2, production 1), without its three rare line ends."""
    printable = ((0x20, 0x7E), (0xA0, 0xD7FF), (0xE000, 0xFFFD), (0x10000, 0x10FFFF))
    allowed = {"\t", "\n", *(chr(c) for first, last in printable for c in range(first, last + 1))}
    every = "".join(map(chr, range(0x110000)))
    assert set(NOT_TEXT.findall(every)) == set(every) - (allowed - set("\x85\u2028\u2029"))
