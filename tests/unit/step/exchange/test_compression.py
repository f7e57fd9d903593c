"""Compressed STEP files have the assembly of the plain file; damaged and hostile archives are rejected."""

import gzip
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest

from stepbot.robot.step_names import is_step_name, step_stem
from stepbot.step.exchange.compression import ALWAYS
from stepbot.step.exchange.input_files import input_digest
from tests import parts
from tests.conftest import ReadDiagnostics
from tests.separate_files import Component, write_structure
from tests.unit.step.in_process import by_path, read_here, read_quietly


def gzipped(path: Path, content: bytes, name: str = "arm.stp") -> None:
    """The content in gzip format."""
    path.write_bytes(gzip.compress(content))


def zipped(path: Path, content: bytes, name: str = "arm.stp", method: int = zipfile.ZIP_DEFLATED) -> None:
    """A zip archive of one file."""
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr(name, content)


def two_members(path: Path, content: bytes) -> None:
    """A gzip file of two members, as by `cat a.gz b.gz`."""
    path.write_bytes(gzip.compress(content[:1000]) + gzip.compress(content[1000:]))


def in_a_folder(path: Path, content: bytes) -> None:
    """A zip archive with the STEP in a folder, and a text beside it."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("parts/", b"")
        archive.writestr("README.txt", b"hello")
        archive.writestr("parts/arm.STEP", content)


@pytest.mark.parametrize("name", ["arm.stpZ", "arm.step.gz", "arm.step"])
@pytest.mark.parametrize("write", [gzipped, zipped, two_members, in_a_folder])
def test_same_assembly(
    write: Callable[[Path, bytes], None], name: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """A compressed file has the assembly of the plain one, for any file name."""
    drawing = parts.write_nested(tmp_path / "plain.step")
    write(tmp_path / name, drawing.path.read_bytes())
    plain, packed = read_quietly(drawing.path), read_quietly(tmp_path / name)
    assert packed.source == name
    assert list(by_path(packed)) == list(by_path(plain))
    assert [b.exact for b in packed.bodies] == [b.exact for b in plain.bodies]


def test_names_in_a_code_page(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Encodings are detected and declared as for a plain file."""
    text = parts.write_box(tmp_path / "plain.step").path.read_text(encoding="utf-8").replace("'block'", "'корпус'")
    gzipped(tmp_path / "box.stpZ", text.encode("cp1251"))
    assembly = read_here(tmp_path / "box.stpZ", diagnostics)
    assert assembly is not None
    assert diagnostics.codes() == ["SB210"]


def test_parts_in_compressed_files(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Files of an assembly may be compressed, each or all; they are inputs."""
    gzipped(tmp_path / "box.stpZ", parts.write_box(tmp_path / "box.step").path.read_bytes())
    root = write_structure(tmp_path / "root.step", "root", [Component("box", "box.stpZ")])
    zipped(tmp_path / "root.stpz", root.read_bytes())
    pin = parts.write_cylinder(tmp_path / "pin.step").path.read_bytes()
    box = (tmp_path / "box.step").read_bytes()
    for path in (root, tmp_path / "root.stpz"):
        gzipped(tmp_path / "box.stpZ", box)
        assembly = read_here(path, diagnostics)
        assert diagnostics.codes() == []
        assert assembly is not None
        assert assembly.external_files == ("box.stpZ",)
        before = input_digest(path)
        gzipped(tmp_path / "box.stpZ", pin)
        assert input_digest(path) != before


def faulty(tmp_path: Path, kind: str) -> Path:
    """An archive that cannot be read."""
    content = parts.write_box(tmp_path / "plain.step").path.read_bytes()
    path = tmp_path / "box.stpZ"
    packed = gzip.compress(content)
    match kind:
        case "cut gzip":
            path.write_bytes(packed[:-2000])
        case "flipped gzip":
            path.write_bytes(packed[:900] + bytes(255 - b for b in packed[900:910]) + packed[910:])
        case "wrong checksum":
            path.write_bytes(packed[:-8] + struct.pack("<I", zlib.crc32(content) ^ 1) + packed[-4:])
        case "cut zip":
            zipped(path, content)
            path.write_bytes(path.read_bytes()[:-30])
        case "flipped zip":
            zipped(path, content)
            data = path.read_bytes()
            path.write_bytes(data[:900] + bytes(255 - b for b in data[900:910]) + data[910:])
        case "several":
            with zipfile.ZipFile(path, "w") as archive:
                for name in ("a.stp", "b.step", "c.p21"):
                    archive.writestr(name, content)
        case "none":
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("a.txt", b"")
                archive.writestr("b.txt", b"")
        case "empty zip":
            zipfile.ZipFile(path, "w").close()
        case "encrypted":
            zipped(path, content)
            data = bytearray(path.read_bytes())
            data[6] |= 1
            data[data.index(b"PK\x01\x02") + 8] |= 1
            path.write_bytes(data)
    return path


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        ("cut gzip", "damaged"),
        ("flipped gzip", "damaged"),
        ("wrong checksum", "damaged"),
        ("cut zip", "damaged"),
        ("flipped zip", "damaged"),
        ("several", "it contains 3 STEP files: 'a.stp', 'b.step', 'c.p21'"),
        ("none", "it contains no STEP file"),
        ("empty zip", "it contains no STEP file"),
        ("encrypted", "encrypted"),
    ],
)
def test_unreadable_archives(kind: str, reason: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Each unreadable archive is an error with the reason and a remedy; its digest is that of its bytes."""
    path = faulty(tmp_path, kind)
    assert read_here(path, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB201"
    assert reason in fault.message
    assert fault.help
    assert input_digest(path)


@pytest.mark.slow
@pytest.mark.parametrize("write", [gzipped, zipped])
def test_bombs(write: Callable[[Path, bytes], None], tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Decompression stops at a hundred times the size of the archive, and writes no more than that."""
    start = parts.write_box(tmp_path / "plain.step").path.read_bytes()
    path = tmp_path / "bomb.stpZ"
    write(path, start + b" " * (ALWAYS + 1000))
    assert path.stat().st_size < 1 << 20
    assert read_here(path, diagnostics) is None
    (fault,) = diagnostics
    assert fault.code == "SB201"
    assert "more than 100 times as large" in fault.message
    write(path, start + b" " * (ALWAYS // 8))  # a small file may have any ratio
    assert read_here(path, ReadDiagnostics()) is not None


def test_what_is_in_it(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An archive without STEP is reported with its content; XML with the remedy."""
    for content in (b"<?xml version='1.0'?><n0:Uos/>", b"solid x", b""):
        gzipped(tmp_path / "arm.stpxz", content)
        assert read_here(tmp_path / "arm.stpxz", diagnostics) is None
    first, second, third = diagnostics
    assert [first.code, second.code, third.code] == ["SB201", "SB201", "SB201"]
    assert "XML" in first.message
    assert "text form" in first.help[0]


@pytest.mark.parametrize(
    ("name", "stem"),
    [("arm.step", "arm"), ("arm.stpZ", "arm"), ("a.b.STP.GZ", "a.b"), ("arm.p21.zip", "arm"), ("arm.stp.z", "arm")],
)
def test_names(name: str, stem: str) -> None:
    """Suffixes of compressed files count as one."""
    assert is_step_name(name)
    assert step_stem(name) == stem


def test_other_names() -> None:
    """Other files keep their usual stem."""
    assert not is_step_name("arm.sldasm")
    assert not is_step_name("arm.stpx")
    assert [step_stem(name) for name in ("arm.sldasm", "arm", ".step")] == ["arm", "arm", ""]
