"""Missing, duplicate, unterminated or mistyped entities are reported by line, with what refers to them."""

import re
from pathlib import Path

import pytest

from stepbot.diagnostics import Diagnostic, Diagnostics
from tests import parts
from tests.unit.step.in_process import read_here


@pytest.fixture
def text(tmp_path: Path) -> str:
    """The text of an assembly of several parts."""
    return parts.write_nested(tmp_path / "whole.step").path.read_text(encoding="utf-8")


def complaints(text: str, folder: Path) -> list[Diagnostic]:
    """The diagnostics of a file."""
    path = folder / "damaged.step"
    path.write_text(text, encoding="utf-8", newline="\n")
    diagnostics = Diagnostics()
    assembly = read_here(path, diagnostics)
    assert (assembly is None) == any(d.severity == "error" for d in diagnostics)
    return list(diagnostics)


def first(pattern: str, text: str) -> re.Match[str]:
    """The first statement of a kind: its number, its keyword and the rest."""
    match = re.search(rf"^#(\d+)=({pattern})(\(.*?\));$", text, re.MULTILINE | re.DOTALL)
    assert match is not None
    return match


def line_of(match: re.Match[str], text: str) -> int:
    """The line of a text, counted from 1."""
    return text.count("\n", 0, match.start()) + 1


@pytest.mark.parametrize("keyword", ["CARTESIAN_POINT", "ADVANCED_FACE", "CLOSED_SHELL", "ITEM_DEFINED_TRANSFORMATION"])
def test_something_a_shape_is_made_of_is_missing(keyword: str, text: str, tmp_path: Path) -> None:
    """A missing entity, which the kernel would skip, is an error that names the references to it with their lines."""
    dropped = first(keyword, text)
    damaged = text.replace(dropped[0], "")
    (fault,) = complaints(damaged, tmp_path)
    assert fault.code == "SB221"
    assert fault.help
    user = re.search(rf"^#(\d+)=[^;]*?#{dropped[1]}\b", damaged, re.MULTILINE | re.DOTALL)
    assert user is not None
    assert any(f"#{dropped[1]} is not defined" in note for note in fault.notes)
    assert f"line {line_of(user, damaged)}: #{user[1]} " in "\n".join(fault.notes)


@pytest.mark.parametrize("is_last", [False, True])
def test_a_reference_to_the_wrong_kind(text: str, tmp_path: Path, *, is_last: bool) -> None:
    """A face whose surface is a point is an error with its line, wherever it is in the file."""
    point, plane = first("CARTESIAN_POINT", text), first("PLANE", text)
    face = re.search(rf"^#(\d+)=ADVANCED_FACE\([^;]*#{plane[1]},[^;]*;\n", text, re.MULTILINE)
    assert face is not None
    wrong = face[0].replace(f"#{plane[1]},", f"#{point[1]},")
    damaged = text.replace(face[0], "" if is_last else wrong)
    if is_last:
        start, end, rest = damaged.rpartition("ENDSEC;")
        damaged = start + wrong + end + rest
    (fault,) = complaints(damaged, tmp_path)
    assert fault.code == "SB221"
    line = damaged.count("\n", 0, damaged.index(wrong)) + 1
    assert fault.notes[0].startswith(f"line {line}: #{face[1]} ADVANCED_FACE")
    assert "has the wrong type" in fault.notes[0]


def test_a_statement_that_does_not_end(text: str, tmp_path: Path) -> None:
    """A missing parenthesis is reported at its line."""
    point = first("CARTESIAN_POINT", text)
    damaged = text.replace(point[0], f"#{point[1]}=CARTESIAN_POINT{point[3][:-1]};")
    faults = complaints(damaged, tmp_path)
    assert [d.severity for d in faults] == ["error"] * len(faults)
    broken = next(d for d in faults if d.code == "SB221")
    assert broken.span.line == pytest.approx(line_of(point, text), abs=1)  # the kernel may report the line of its end


@pytest.mark.parametrize("layout", ["#{}=", "# 0{} ="])
@pytest.mark.parametrize("end", ["\n", "\r", ""])
def test_two_entities_with_one_number(layout: str, end: str, text: str, tmp_path: Path) -> None:
    """Two entities of one number are an error, wherever lines end and however the number is written."""
    point, direction = first("CARTESIAN_POINT", text), first("DIRECTION", text)
    damaged = text.replace(f"#{direction[1]}=", layout.format(point[1]), 1).replace("\n", end)
    (fault,) = complaints(damaged, tmp_path)
    assert fault.code == "SB221"
    assert "duplicate entity number" in fault.notes[0]


def test_a_string_that_looks_like_an_entity(text: str, tmp_path: Path) -> None:
    """A line of a string that begins like an entity with the number of another is no duplicate."""
    point, name = first("CARTESIAN_POINT", text), first("PRODUCT", text)
    changed = text.replace(name[0], name[0].replace("'", f"'\n#{point[1]}=", 1))
    assert changed != text
    assert "SB221" not in [d.code for d in complaints(changed, tmp_path)]


def test_styles_that_lead_nowhere_are_a_warning(tmp_path: Path) -> None:
    """A missing colour is a warning, and the assembly is read without it."""
    text = parts.write_colored_faces(tmp_path / "whole.step").path.read_text(encoding="utf-8")
    colour = first("COLOUR_RGB|DRAUGHTING_PRE_DEFINED_COLOUR", text)
    faults = complaints(text.replace(colour[0], ""), tmp_path)
    assert [(d.code, d.severity) for d in faults] == [("SB223", "warning")]
    assert any(f"#{colour[1]} is not defined" in note for note in faults[0].notes)


def test_many_faults_are_counted(text: str, tmp_path: Path) -> None:
    """Five places are listed, and further ones counted."""
    damaged = re.sub(r"^#\d+=CARTESIAN_POINT\(.*?\);$", "", text, flags=re.MULTILINE | re.DOTALL)
    (fault,) = complaints(damaged, tmp_path)
    assert len(fault.notes) == 6
    assert re.fullmatch(r"and \d+ more", fault.notes[-1])


_ANCHORS = "ANCHOR;\n<a>=#5;\nENDSEC;\nREFERENCE;\n#90000=<other.step#1>;\nENDSEC;\n"
_SIGNATURE = "SIGNATURE;\nMIIB\nENDSEC;\nEND-ISO-10303-21;"


def test_sections_of_the_third_edition(text: str, tmp_path: Path) -> None:
    """Anchors, references and signatures, which the kernel does not know, are no syntax errors; other text there is."""
    later = text.replace("DATA;", f"{_ANCHORS}DATA;", 1)
    assert complaints(later, tmp_path) == []
    for unsigned in (text, later):
        assert complaints(unsigned.replace("END-ISO-10303-21;", _SIGNATURE), tmp_path) == []
    assert [one.code for one in complaints(text.replace("DATA;", "DATTA;\nENDSEC;\nDATA;", 1), tmp_path)] == ["SB221"]


def test_an_entity_of_another_file_is_missing(text: str, tmp_path: Path) -> None:
    """A surface that a reference section places in another file is named with what needs it."""
    plane = first("PLANE", text)
    elsewhere = text.replace("DATA;", f"{_ANCHORS.replace('90000', plane[1])}DATA;", 1).replace(plane[0], "")
    (fault,) = complaints(elsewhere, tmp_path)
    assert fault.code == "SB221"
    assert any(f"#{plane[1]} is not defined" in note for note in fault.notes)
