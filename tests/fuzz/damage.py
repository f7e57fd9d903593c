"""Damage to a STEP file as bytes and text: truncation, flipped bits, damaged strings and header.

Each kind of damage is a function ``(StepText, Random) -> bytes``; the random numbers are its only choice.
"""

from random import Random

from .step_text import Edit, StepText, Token

_END = b"ENDSEC;\nEND-ISO-10303-21;\n"


def truncation(step: StepText, rng: Random) -> bytes:
    """Remove the end or the middle, as by a full disk, a broken download or a crashed export."""
    data = step.data
    cut = rng.randrange(len(data))
    way = rng.randrange(5)
    if way == 0 or not step.statements:
        return data[:cut]
    if way == 1:  # whole statements and a proper end, as by a program that cleaned up
        return data[: rng.choice(step.statements).end] + b"\n" + _END
    if way == 2:  # in the middle of a statement, with a proper end
        return data[:cut] + b"\n" + _END
    if way == 3:
        return data[:cut] + data[min(cut + 1 + rng.randrange(len(data) // 4 + 1), len(data)) :]
    return data[:cut] + bytes(len(data) - cut)  # a file system that lost blocks but kept the size


def flipped_bytes(step: StepText, rng: Random) -> bytes:
    """Flip, insert, remove or swap bytes."""
    data = bytearray(step.data)
    # Mostly after the header, in the data that the kernel reads.
    low = step.header_end if rng.random() < 0.8 else 0
    for _ in range(rng.choice((1, 1, 2, 4, 16, 64))):
        if len(data) <= low:
            break
        at = rng.randrange(low, len(data))
        way = rng.randrange(6)
        if way <= 1:
            data[at] ^= 1 << rng.randrange(8)
        elif way == 2:
            data[at] = rng.randrange(256)
        elif way == 3:
            del data[at : at + rng.choice((1, 2, 8))]
        elif way == 4:
            data[at:at] = rng.randbytes(rng.choice((1, 2, 8)))
        else:
            other = rng.randrange(low, len(data))
            data[at], data[other] = data[other], data[at]
    return bytes(data)


_BAD_STRINGS = (
    b"''", b"'\\X2\\D83D\\X0\\'", b"'\\X2\\04\\X0\\'", b"'\\X2\\0421'", b"'\\X4\\FFFFFFFF\\X0\\'",
    b"'\\X4\\0000D800\\X0\\'", b"'\\X\\00'", b"'\\X\\0A\\X\\0D'", b"'\\X\\FF\\X\\FE'", b"'\\S\\'", b"'\\S\\D\\S\\'",
    b"'\\PZ\\\\S\\A'", b"'\\'", b"'\\\\'", b"'\\N\\'", b"'\\X2\\0000\\X0\\'", b"'\\X2\\202E\\X0\\gnirts'", b"'..'",
    b"'../../x'", b"'/'", b"'CON'", b"'a/b*c#1'", b"'\xd2\xf0\xf3\xe1\xea\xe0'", b"'\xc2\xdd\xcb\xbf'", b"'\xff\xfe'",
    b"'\xed\xa0\x80'", b"'\xf4\x90\x80\x80'", b"'\x00'", b"'a\x00b'", b"'a\nb'", b"'\t\x1b[31m'", b"'<&\">'",
    b"'%s%n%d'", b"'{0}'", b"'" + b"x" * 70_000 + b"'", b"'" + b"\\X2\\" + b"0416" * 5000 + b"\\X0\\'", b"'#1=(;'",
    b"'/*'", b"'ENDSEC;'", b"'NAUO1'", b"'product-x'", b"'product-9'", b"'occurrence-99'", b"' '", b"$", b"*",
)  # fmt: skip
"""Texts that are special in an encoding, a path, XML or a terminal."""


def spoiled_strings(step: StepText, rng: Random) -> bytes:
    """Put broken escapes, foreign encodings, unclosed quotes and control characters into names and descriptions."""
    strings = [token for token in step.tokens if token.kind == "string" and token.start >= step.header_end]
    named = [
        token
        for keyword in (b"PRODUCT", b"NEXT_ASSEMBLY_USAGE_OCCURRENCE", b"MANIFOLD_SOLID_BREP")
        for statement in step.by_keyword.get(keyword, ())
        for token in step.within(statement, "string")
    ]
    if not strings:
        return flipped_bytes(step, rng)
    pool = named if named and rng.random() < 0.7 else strings
    chosen = pool if rng.random() < 0.15 else [rng.choice(pool) for _ in range(rng.choice((1, 1, 2, 5)))]
    return step.edited(Edit(token.start, token.end, _bad_string(step, token, rng)) for token in chosen)


def _bad_string(step: StepText, token: Token, rng: Random) -> bytes:
    inside = step.data[token.start + 1 : token.end - 1]
    way = rng.randrange(8)
    if way <= 3:
        return rng.choice(_BAD_STRINGS)
    if way == 4:
        return b"'" + inside  # without closing quote
    if way == 5:
        return inside + b"'"  # without opening quote
    if way == 6:
        return b"'" + inside[: len(inside) // 2] + b"'" + inside[len(inside) // 2 :] + b"'"
    return b"'" + rng.randbytes(rng.randrange(40)) + b"'"


_SCHEMAS = (
    b"'IFC4'", b"''", b"'AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }'",
    b"'CONFIG_CONTROL_DESIGN'", b"'AUTOMOTIVE_DESIGN'", b"'automotive_design { 1 0'", b"'ISO13584_LIBRARY'", b"$",
    b"()", b"'\xd2\xf0'", b"'\\X2\\D83D\\X0\\'",
)  # fmt: skip
_LINES = (
    b"ISO-10303-21;", b"HEADER;", b"ENDSEC;", b"DATA;", b"END-ISO-10303-21;", b"FILE_DESCRIPTION", b"FILE_NAME",
    b"FILE_SCHEMA",
)  # fmt: skip
_OTHER_LINES = (
    b"", b"ISO-10303-28;", b"iso-10303-21;", b"HEADER", b"DATA('part',('AUTOMOTIVE_DESIGN'));",
    b"DATA;\nENDSEC;\nDATA;", b"/*", b"*/", b"ANCHOR;\n<a>=#1;\nENDSEC;\nREFERENCE;\n#99=<x.stp#a>;\nENDSEC;\nDATA;",
    b"\xef\xbb\xbf", b";;", b"FILE_POPULATION",
)  # fmt: skip


def spoiled_header(step: StepText, rng: Random) -> bytes:
    """Damage sections, schema and header entities, or change the encoding of the file."""
    data, end = step.data, step.header_end
    way = rng.randrange(8)
    if way <= 2:
        line = rng.choice([line for line in _LINES if line in data] or [b""])
        at = data.rfind(line) if line == b"ENDSEC;" and rng.random() < 0.5 else data.find(line)
        return data[:at] + rng.choice(_OTHER_LINES) + data[at + len(line) :]
    header = [token for token in step.tokens if token.start < end]
    if way == 3 and header:
        chosen = [rng.choice(header) for _ in range(rng.choice((1, 2, 6)))]
        return step.edited(
            Edit(token.start, token.end, rng.choice((b"", b"(", b")", b"$", b"'", b"''"))) for token in chosen
        )
    if way == 4:
        start = data.find(b"FILE_SCHEMA")
        schema = next((t for t in header if t.kind == "string" and t.start > start), None)
        return step.edited([Edit(schema.start, schema.end, rng.choice(_SCHEMAS))] if schema else [])
    if way == 5:
        entities = (b"FILE_NAME('','',(''),(''),'','','');", b"FILE_DESCRIPTION((),'1');", b"SECTION_LANGUAGE('de');")
        return data[:end].replace(b"ENDSEC;", rng.choice(entities) + b"ENDSEC;", 1) + data[end:]
    if way == 6:
        return data[: rng.randrange(end + 1)] + data[end:]
    changed = (
        b"\xef\xbb\xbf" + data, data.decode("latin-1").encode("utf-16"), data.replace(b"\n", b"\r\n"),
        data.replace(b"\n", b"\r"), data.replace(b"\n", b""), data.lower(), b"\n\n /* made by hand */\n" + data,
        data + data, bytes(64) + data, data + bytes(512),
    )  # fmt: skip
    return rng.choice(changed)
