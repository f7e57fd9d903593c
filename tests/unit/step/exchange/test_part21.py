"""Checks of a file before the kernel runs: whether it is STEP, and its errors by line."""

import os
from pathlib import Path

import pytest

from stepbot.step.exchange.encodings import line_of
from stepbot.step.exchange.part21 import check_step
from tests.conftest import ReadDiagnostics

HEADER = """ISO-10303-21;
HEADER;
/* made by hand; FILE_SCHEMA(('WRONG')) */
FILE_DESCRIPTION(('x'),'2;1');
FILE_NAME('arm ''7''','2024-05-23T20:24:58',('a','b'),(''),
  'ST-DEVELOPER v20','Fusion \\X2\\00E9\\X0\\','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 3 1 1 }'));
ENDSEC;
"""
DATA = "DATA;\n#1=ADVANCED_FACE('',(),#2,.T.);\nENDSEC;\nEND-ISO-10303-21;\n"


def write(tmp_path: Path, content: str | bytes) -> Path:
    """A file with this content."""
    path = tmp_path / "file.step"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_header(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Fields of the header are decoded; comments are ignored."""
    part21 = check_step(write(tmp_path, HEADER + DATA), "arm.step", diagnostics)
    assert part21 is not None
    assert part21.encoding == "ascii"
    assert (part21.header.name, part21.header.time_stamp) == ("arm '7'", "2024-05-23T20:24:58")
    assert (part21.header.preprocessor, part21.header.originating_system) == ("ST-DEVELOPER v20", "Fusion é")
    assert part21.header.schema == "AP214"


def test_a_text_between_the_records_of_the_header(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """It is no record, in whatever encoding it is."""
    start = HEADER.index("FILE_NAME")
    damaged = HEADER[:start].encode() + b"'\x99';" + HEADER[start:].encode()
    part21 = check_step(write(tmp_path, damaged + DATA.encode()), "arm.step", diagnostics)
    assert part21 is not None
    assert part21.header.name == "arm '7'"


@pytest.mark.parametrize(
    ("schema", "name"),
    [
        ("CONFIG_CONTROL_DESIGN", "AP203"),
        ("AP203_CONFIGURATION_CONTROLLED_3D_DESIGN_OF_MECHANICAL_PARTS_AND_ASSEMBLIES_MIM_LF", "AP203"),
        ("AP214IS", "AP214"),
        ("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }", "AP242"),
        ("SOMETHING_ELSE { 1 }", "SOMETHING_ELSE"),
    ],
)
def test_schemas(schema: str, name: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A schema has its usual short name."""
    text = HEADER.replace("AUTOMOTIVE_DESIGN { 1 0 10303 214 3 1 1 }", schema)
    part21 = check_step(write(tmp_path, text + DATA), "x", diagnostics)
    assert part21 is not None
    assert part21.header.schema == name


@pytest.mark.parametrize(
    ("content", "code", "word", "line"),
    [
        (b"", "SB201", "empty", 0),
        (b"\0\0\0\0", "SB201", "empty", 0),
        (b"# a readme\n", "SB201", "not a STEP file", 1),
        (b"PK\x03\x04 and more", "SB201", "zip", 0),
        (b"version https://git-lfs.github.com/spec/v1\n", "SB201", "Git LFS", 1),
        (b"<?xml version='1.0'?>", "SB201", "XML", 1),
        (b"<?xml version='1.0'?>\n<!-- <mujoco> -->\n<robot name='a'>", "SB201", "a robot description (URDF)", 1),
        (b"\xef\xbb\xbf<sdf version='1.9'>", "SB201", "a robot description (SDFormat)", 1),
        (b"<mujoco/>", "SB201", "a robot description (MJCF)", 1),
        (b"<?xml version='1.0'?><robotics>", "SB201", "is XML", 1),
        (b"S".rjust(73) + b"      1\n" + b"x" * 90, "SB201", "IGES", 1),
        (HEADER.encode() + b"DATA;\nENDSEC;\nEND-ISO-10303-21;\n", "SB201", "DATA section is empty", 9),
        (HEADER.encode() + DATA.encode()[:30], "SB201", "unexpected end of file", 10),
        (HEADER.encode()[:60], "SB201", "unexpected end of file", 3),
        (HEADER.replace("AUTOMOTIVE_DESIGN", "IFC4").encode() + DATA.encode(), "SB201", "building", 0),
        (HEADER.encode() + DATA.encode().replace(b"ADVANCED_FACE", b"DIRECTION"), "SB205", "no geometry", 0),
    ],
)
def test_files_that_cannot_be_read(
    content: bytes, code: str, word: str, line: int, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """Each error is one diagnostic at its line, with a remedy."""
    assert check_step(write(tmp_path, content), "given/name.step", diagnostics) is None
    (diagnostic,) = diagnostics
    assert diagnostic.code == code
    assert word in diagnostic.message
    assert (diagnostic.span.file, diagnostic.span.line) == ("given/name.step", line)
    assert diagnostic.help


def test_missing_folder_and_unreadable(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A path that is not a file is an error."""
    assert check_step(tmp_path / "none.step", "none.step", diagnostics) is None
    assert check_step(tmp_path, "folder", diagnostics) is None
    assert [(d.code, d.message) for d in diagnostics] == [
        ("SB001", "file not found"),
        ("SB001", "is a folder, not a STEP file"),
    ]


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="rights hold neither on Windows nor for root")
def test_file_without_rights(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A file without read permission is an error."""
    path = write(tmp_path, HEADER + DATA)
    path.chmod(0)
    assert check_step(path, "x", diagnostics) is None
    assert diagnostics.codes() == ["SB001"]


EXTERNAL = "#7=DOCUMENT_FILE('TAIL.sldprt','','',#8,'',$);\n#9=DOCUMENT_FILE('manual.pdf','','',#8,'',$);\n"


def test_geometry_in_other_files(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """References to other files without own geometry, or to native CAD files, are an error."""
    only = DATA.replace("#1=ADVANCED_FACE('',(),#2,.T.);\n", EXTERNAL)
    beside = DATA.replace("DATA;\n", "DATA;\n" + EXTERNAL)
    for text in (only, beside):
        assert check_step(write(tmp_path, HEADER + text), "x", diagnostics) is None
    first, second = diagnostics
    assert (first.code, first.span.line) == ("SB203", 10)
    assert first.message == "all geometry is in files that are not STEP: 'TAIL.sldprt', 'manual.pdf'"
    assert second.message == "parts of the geometry is in files that are not STEP: 'TAIL.sldprt'"


def test_references_to_step_files(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """References have product definition, product, name and line; other files may contain shapes only."""
    text = """#1=PRODUCT('id','tail','',(#2));
#3=PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE('','',#1,.NOT_KNOWN.);
#4=PRODUCT_DEFINITION('','',#3,#5);
#6=DOCUMENT_FILE('document 6','','',#8,'',$);
#7=APPLIED_DOCUMENT_REFERENCE(#6,'',(#3));
#9=EXTERNAL_SOURCE(IDENTIFIER('parts/'));
#10=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('tail ''7''.stp',#11,#9,(#6));
#12=DOCUMENT_FILE('unplaced.p21','','',#8,'',$);
#13=(CHARACTERIZED_OBJECT('a','b')DOCUMENT('wing.stpz','','',#8)DOCUMENT_FILE());
#14=PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS('','',#3,#5,(#13));
#15=DOCUMENT_FILE('manual.pdf','','',#8,'',$);
"""
    part21 = check_step(
        write(tmp_path, HEADER + DATA.replace("#1=ADVANCED_FACE('',(),#2,.T.);\n", text)), "x", diagnostics
    )
    assert part21 is not None
    assert [(r.definition, r.product, r.name, r.line) for r in part21.references] == [
        (4, "tail", "parts/tail '7'.stp", 13),
        (14, "tail", "parts/tail '7'.stp", 13),
        (0, "", "unplaced.p21", 17),
        (14, "tail", "wing.stpz", 18),
    ]


@pytest.mark.parametrize(
    ("source", "expected"),
    [("tail.stp", "tail.stp"), ("parts/tail.stp", "parts/tail.stp"), ("tail.stp/parts", "tail.stp/parts/tail.stp")],
)
def test_a_source_that_repeats_the_name(
    source: str, expected: str, tmp_path: Path, diagnostics: ReadDiagnostics
) -> None:
    """The location of a file may end with its name; a document under version control is between part and file."""
    text = f"""#1=PRODUCT('id','tail','',(#2));
#3=PRODUCT_DEFINITION_FORMATION('','',#1);
#4=PRODUCT_DEFINITION('','',#3,#5);
#11=PRODUCT('doc','tail.stp-Doc','',(#2));
#12=PRODUCT_DEFINITION_FORMATION('','',#11);
#13=PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS('','',#12,#5,(#16));
#14=DOCUMENT('','',$,#8);
#15=DOCUMENT_PRODUCT_EQUIVALENCE('equivalence',$,#14,#12);
#16=DOCUMENT_FILE('tail.stp','',$,#8,'',$);
#17=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('tail.stp',#18,#19,(#16));
#19=EXTERNAL_SOURCE(IDENTIFIER('{source}'));
#20=APPLIED_DOCUMENT_REFERENCE(#14,'',(#4));
"""
    part21 = check_step(
        write(tmp_path, HEADER + DATA.replace("#1=ADVANCED_FACE('',(),#2,.T.);\n", text)), "x", diagnostics
    )
    assert part21 is not None
    assert [(r.definition, r.product, r.name) for r in part21.references] == [(4, "tail", expected)]


def test_references_to_other_documents_are_ignored(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A reference to a manual is not a reference to a part."""
    text = DATA.replace("DATA;\n", "DATA;\n#9=DOCUMENT_FILE('manual.pdf','','',#8,'',$);\n")
    assert check_step(write(tmp_path, HEADER + text), "x", diagnostics) is not None


@pytest.mark.parametrize(
    ("name", "encoding"), [("Deckel", "ascii"), ("Wälzlager", "utf-8"), ("螺丝" * 400_000, "utf-8")], ids=[*"abc"]
)
def test_encodings(name: str, encoding: str, tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """UTF-8 is detected, also if a character crosses two chunks of the file."""
    text = HEADER + DATA.replace("''", f"'{name}'")
    part21 = check_step(write(tmp_path, text), "x", diagnostics)
    assert part21 is not None
    assert part21.encoding == encoding


def test_names_in_an_unknown_encoding_are_a_warning(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Bytes that are not UTF-8 are a warning with their line."""
    content = (HEADER + DATA).encode().replace(b"ADVANCED_FACE(''", "ADVANCED_FACE('Деталь'".encode("cp1251"))
    part21 = check_step(write(tmp_path, content), "x", diagnostics)
    assert part21 is not None
    assert part21.encoding == ""
    (diagnostic,) = diagnostics
    assert (diagnostic.code, diagnostic.span.line) == ("SB210", 10)


def test_lines() -> None:
    """Lines of bytes count from 1 and across chunks."""
    data = b"x\n" * 800_000
    assert [line_of(data, offset) for offset in (0, 1, 2, 1_500_000)] == [1, 1, 2, 750_001]
