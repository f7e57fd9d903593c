"""Names in code pages are decoded as declared, and never wrongly without a diagnostic."""

import codecs
from pathlib import Path

import pytest

from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.exchange.encodings import as_utf8, check_encoding
from tests import parts, solids
from tests.conftest import ReadDiagnostics
from tests.unit.step.in_process import read_here

RUSSIAN, CHINESE, JAPANESE = "Корпус №1", "螺丝 乗S\\", "表示ソ"
"""The second bytes of some of these characters are backslashes: 乗 in GBK, 表 and ソ in Shift JIS."""


def named(path: Path, name: bytes) -> Path:
    """A box whose product's name has these bytes."""
    parts.draw(path, parts.drawn("TO BE NAMED", solids.box(10, 20, 30)))
    content = path.read_bytes()
    assert b"'TO BE NAMED'" in content
    path.write_bytes(content.replace(b"TO BE NAMED", name))
    return path


def read(path: Path, encoding: str, diagnostics: ReadDiagnostics) -> Assembly | None:
    """The tree of a file, without geometry."""
    return read_here(path, diagnostics, ReadOptions(geometry=False, encoding=encoding))


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (RUSSIAN, "cp1251"),
        (CHINESE.replace("\\", ""), "gbk"),
        (JAPANESE, "cp932"),
        ("부품", "cp949"),
        ("Wälzlager", "cp1252"),
        ("Wälzlager", "utf-8"),
    ],
)
def test_names_in_a_declared_code_page(text: str, encoding: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A name in a declared code page is decoded without diagnostics."""
    assembly = read(named(tmp_path / "box.step", text.encode(encoding)), encoding, diagnostics)
    assert assembly is not None
    assert [component.product for component in assembly.components] == [text]
    assert assembly.facts["encoding"] == (f"{encoding}, as declared" if encoding != "utf-8" else "UTF-8")


@pytest.mark.parametrize(
    ("raw", "encoding", "text"),
    [
        ("螺".encode("gbk") + rb"\X2\4E1D\X0\ \X\E9 \\", "gbk", "螺丝 é \\"),
        ("乗".encode("gbk") + rb"\S\d", "gbk", "乗ä"),
        ("表".encode("cp932") + rb"\X2\8868\X0\''", "cp932", "表表'"),
        ("é".encode("cp1252") + rb"\X\E9", "", "éé"),
    ],
)
def test_escapes_beside_bytes(
    raw: bytes, encoding: str, text: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """Escapes are decoded beside any bytes."""
    assembly = read(named(tmp_path / "box.step", raw), encoding, diagnostics)
    assert assembly is not None
    assert assembly.components[0].product == text
    assert diagnostics.codes() == ([] if encoding else ["SB210"])


def test_a_declaration_does_not_touch_ascii(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A file in ASCII with escapes is independent of the declaration."""
    assembly = read(named(tmp_path / "box.step", rb"\X2\04210431\X0\ \X\E9"), "cp932", diagnostics)
    assert assembly is not None
    assert (assembly.components[0].product, assembly.facts["encoding"]) == ("Сб é", "ASCII")


@pytest.mark.parametrize(
    ("text", "written", "declared", "byte"),
    [
        (RUSSIAN, "cp1251", "gbk", "0xb9"),
        (RUSSIAN, "cp1251", "cp932", "0xef"),
        (RUSSIAN, "cp1251", "utf-8", "0xca"),
        ("Ы" * 3 + "“", "cp1251", "iso8859-1", "0x93"),
        (CHINESE, "gbk", "cp1252", "0x81"),
        ("ÿ", "cp1252", "gbk", "0xff"),
    ],
)
def test_a_wrong_code_page(
    text: str, written: str, declared: str, byte: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """Bytes that are invalid in the declared code page are an error with the line and suggestions."""
    path = named(tmp_path / "box.step", text.encode(written))
    assert read(path, declared, diagnostics) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB224"
    assert f"declared encoding {declared}: byte {byte}" in diagnostic.message
    assert byte[2:] in path.read_bytes().split(b"\n")[diagnostic.span.line - 1].hex()
    assert any(written in note and text[:3] in note for note in diagnostic.notes) or written == "gbk"
    assert diagnostic.help


def test_undeclared_encoding_is_a_warning(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Without a declaration a warning shows the first name in each code page in which all names are valid."""
    assembly = read(named(tmp_path / "box.step", RUSSIAN.encode("cp1251")), "", diagnostics)
    assert assembly is not None
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB210"
    assert "--encoding" in diagnostic.help[0]
    assert f"in cp1251 the first reads '{RUSSIAN}'" in diagnostic.notes
    assert not any("cp932" in note for note in diagnostic.notes)
    assert assembly.facts["encoding"] == "unknown, shown as cp1252"


def test_utf8_that_is_declared_otherwise(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """UTF-8 is read as UTF-8 despite another declaration, with a warning."""
    assembly = read(named(tmp_path / "box.step", "é".encode()), "cp1252", diagnostics)
    assert assembly is not None
    assert assembly.components[0].product == "Ã©"
    (diagnostic,) = diagnostics
    assert diagnostic.code == "SB210"
    assert diagnostic.notes == ("in cp1252 the first reads 'Ã©'", "in utf-8 the first reads 'é'")


@pytest.mark.slow
def test_real_names(corpus: Path, diagnostics: ReadDiagnostics) -> None:
    """An assembly drawn in Russian is read in its code page."""
    assembly = read(corpus / "russian_names_cp1251.step", "cp1251", diagnostics)
    assert assembly is not None
    names = [component.product for component in assembly.components]
    assert names[:2] == ["Сборка1", "Дет1"]
    assert set(names[1:]) == {f"Дет{n}" for n in range(1, 9)}


@pytest.mark.parametrize("encoding", ["gbk", "cp932", "utf-8", "cp1251"])
@pytest.mark.parametrize("before", [0, 1, (1 << 20) - 1, 1 << 20])
@pytest.mark.parametrize("letter", ["Ж", "р"])  # the second one ends with 0x80 in UTF-8
def test_places_across_chunks(letter: str, encoding: str, before: int, diagnostics: ReadDiagnostics) -> None:
    """An invalid byte is located, also beside a character that crosses two chunks of the file."""
    good = letter.encode(encoding) + b"x"
    assert check_encoding(b"\n" * before + good, encoding, "x", diagnostics) == encoding
    bad = {"cp1251": b"\x98"}.get(encoding, b"\xff")
    assert check_encoding(b"\n" * before + good + bad + b"\n" * 10, encoding, "x", diagnostics) is None
    (diagnostic,) = [d for d in diagnostics if d.code == "SB224"]
    assert diagnostic.span.line == before + 1
    assert f"0x{bad.hex()}" in diagnostic.message


def test_byte_order_mark(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Editors put one before a file; the kernel, which refuses it, does not see it."""
    path = tmp_path / "box.step"
    parts.write_box(path)
    path.write_bytes(codecs.BOM_UTF8 + path.read_bytes())
    assert read(path, "", diagnostics) is not None
    assert not diagnostics.codes()


def test_transcoding(tmp_path: Path) -> None:
    """The kernel's copy is the same text in UTF-8, line by line; a plain file is not copied."""
    path = tmp_path / "x.step"
    text = "'螺丝'\r\n" * 300_000
    path.write_bytes(b"\xef\xbb\xbf" + text.encode("gbk"))
    with as_utf8(path, "gbk") as copy:
        assert copy.read_bytes() == text.encode()
    assert not copy.exists()
    path.write_text(text, encoding="utf-8")
    with as_utf8(path, "utf-8") as copy:
        assert copy == path
