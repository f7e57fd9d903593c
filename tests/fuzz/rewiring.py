"""Damage to the content of a STEP file: numbers, entities, references, keywords, arguments; it stays well-formed."""

from random import Random

from .damage import flipped_bytes
from .step_text import Edit, Statement, StepText, Token

_NUMBERS = (
    b"0.", b"-0.", b"0", b"1.", b"-1.", b"1.E308", b"-1.E308", b"1.E-308", b"5.E-324", b"1.E400", b"-1.E400",
    b"1.E150", b"1.E18", b"1.E10", b"-1.E10", b"1.E-10", b"1.E5", b"NaN", b"nan", b"-nan(ind)", b"1.#QNAN", b"1.#INF",
    b"INF", b"-inf", b"Infinity", b"1,5", b"1.5.5", b"1e", b"--1.", b"0x10", b"", b"$", b"*", b"'1.'", b".T.",
    b"2147483647", b"-2147483648", b"4294967296", b"9223372036854775808", b"3", b"2", b"7", b"1000000", b"(1.)",
    b"9" * 400 + b".",
)  # fmt: skip


def numbers(step: StepText, rng: Random) -> bytes:
    """Replace numbers by zero, huge, tiny or negative ones, or a textual NaN."""
    statements = [statement for statement in _some(step, rng) if step.within(statement, "number")]
    edits = []
    for statement in statements:
        found = step.within(statement, "number")
        chosen = found if rng.random() < 0.15 else [rng.choice(found)]
        edits += [Edit(token.start, token.end, _other_number(step.text(token), rng)) for token in chosen]
    return step.edited(edits) if edits else flipped_bytes(step, rng)


def _other_number(text: bytes, rng: Random) -> bytes:
    way = rng.randrange(10)
    if way <= 5:
        return rng.choice(_NUMBERS)
    value = float(text) if b"." in text or b"E" in text.upper() else int(text)
    if isinstance(value, int):
        return str(value + rng.choice((-2, -1, 1, 2, 1000))).encode()
    factor = rng.choice((-1.0, 1e-3, 0.5, 1.001, 2.0, 1e3, 1e6, 1.0 + 1e-9))
    return repr(value * factor).upper().encode()


def dropped_entities(step: StepText, rng: Random) -> bytes:
    """Remove or duplicate statements."""
    if not step.statements:
        return flipped_bytes(step, rng)
    way = rng.randrange(5)
    if way == 0:
        dropped = step.by_keyword[rng.choice(sorted(step.by_keyword))]
    elif way == 1:
        first = rng.randrange(len(step.statements))
        dropped = step.statements[first : first + rng.choice((2, 10, 100))]
    else:
        dropped = _some(step, rng)
    if way == 4:  # again, with another body
        other = rng.choice(step.statements)
        body = step.data[step.tokens[other.first].start : other.end]
        twice = [b"\n#%d%s" % (statement.number, body) for statement in dropped]
        return step.edited(Edit(s.end, s.end, text) for s, text in zip(dropped, twice, strict=True))
    return step.edited(Edit(statement.start, statement.end, b"") for statement in dropped)


def rewired_references(step: StepText, rng: Random) -> bytes:
    """Redirect references: to another entity of the same kind or of any, to nothing, to themselves."""
    statements = [statement for statement in _some(step, rng) if step.within(statement, "reference")]
    edits = []
    for statement in statements:
        found = step.within(statement, "reference")
        token = rng.choice(found)
        if rng.random() < 0.1 and len(found) > 1:
            other = rng.choice(found)
            edits += [Edit(token.start, token.end, step.text(other)), Edit(other.start, other.end, step.text(token))]
        else:
            edits.append(Edit(token.start, token.end, b"#%d" % _other_target(step, statement, token, rng)))
    return step.edited(edits) if edits else flipped_bytes(step, rng)


_USAGE = b"NEXT_ASSEMBLY_USAGE_OCCURRENCE"


def circles(step: StepText, rng: Random) -> bytes:
    """Create cycles of references: a subassembly in its own part, a unit in terms of itself."""
    if not step.statements:
        return flipped_bytes(step, rng)
    edits = []
    for _ in range(rng.choice((1, 1, 3))):
        way = [_one(step, rng)]
        for _ in range(rng.choice((1, 2, 3, 6))):
            targets = [_target(step, token) for token in step.within(way[-1], "reference")]
            below = [step.by_number[target] for target in targets if target in step.by_number]
            if not below:
                break
            way.append(rng.choice(below))
        references = step.within(way[-1], "reference")
        if references:
            token = rng.choice(references)
            edits.append(Edit(token.start, token.end, b"#%d" % way[0].number))
    # The last two references of a usage are the assembly and the component in it.
    usages = [step.within(usage, "reference")[-2:] for usage in step.by_keyword.get(_USAGE, [])]
    usages = [pair for pair in usages if len(pair) == 2]
    if usages and (rng.random() < 0.4 or not edits):
        assembly, component = rng.choice(usages)
        for token, other in zip(rng.choice(usages), (component, assembly), strict=True):
            edits.append(Edit(token.start, token.end, step.text(other)))
    return step.edited(edits) if edits else rewired_references(step, rng)


def swapped_keywords(step: StepText, rng: Random) -> bytes:
    """Change the type of entities: to another one in the file, a subtype, an unknown word."""
    edits = []
    for statement in _some(step, rng):
        keywords = step.within(statement, "keyword")
        if keywords:
            token = rng.choice(keywords)
            edits.append(Edit(token.start, token.end, _other_keyword(step, token, rng)))
    return step.edited(edits) if edits else flipped_bytes(step, rng)


_KEYWORDS = (
    b"MANIFOLD_SOLID_BREP", b"BREP_WITH_VOIDS", b"FACETED_BREP", b"SHELL_BASED_SURFACE_MODEL", b"OPEN_SHELL",
    b"CLOSED_SHELL", b"ADVANCED_FACE", b"FACE_SURFACE", b"FACE_BOUND", b"EDGE_LOOP", b"VERTEX_LOOP", b"POLY_LOOP",
    b"EDGE_CURVE", b"LINE", b"CIRCLE", b"ELLIPSE", b"PLANE", b"CYLINDRICAL_SURFACE", b"CONICAL_SURFACE",
    b"SPHERICAL_SURFACE", b"TOROIDAL_SURFACE", b"B_SPLINE_CURVE_WITH_KNOTS", b"B_SPLINE_SURFACE_WITH_KNOTS",
    b"SURFACE_OF_REVOLUTION", b"SURFACE_OF_LINEAR_EXTRUSION", b"OFFSET_SURFACE", b"MAPPED_ITEM",
    b"REPRESENTATION_MAP", b"CARTESIAN_TRANSFORMATION_OPERATOR_3D", b"AXIS2_PLACEMENT_3D", b"AXIS2_PLACEMENT_2D",
    b"SHAPE_REPRESENTATION", b"ADVANCED_BREP_SHAPE_REPRESENTATION", b"GEOMETRIC_CURVE_SET", b"SI_UNIT",
    b"CONVERSION_BASED_UNIT", b"MASS_UNIT", b"TRIANGULATED_FACE", b"TESSELLATED_SOLID", b"COORDINATES_LIST",
    b"PRODUCT_DEFINITION", b"PRODUCT", b"DOCUMENT_FILE", b"NONSENSE", b"", b"!USER_DEFINED", b"manifold_solid_brep",
)  # fmt: skip


def _other_keyword(step: StepText, token: Token, rng: Random) -> bytes:
    way = rng.randrange(4)
    if way == 0:
        return rng.choice(_KEYWORDS)
    if way == 1:
        text = step.text(token)
        at = rng.randrange(len(text))
        return text[:at] + text[at + 1 :]
    return rng.choice(sorted(step.by_keyword))


_ARGUMENTS = (
    b"$", b"*", b"()", b"(())", b"(*)", b"($,$)", b"''", b"0.", b"0", b".T.", b".F.", b".U.", b"#0", b"", b"," * 5,
    b"(" * 20_000,
)  # fmt: skip
_ENUMERATIONS = (
    b".T.", b".F.", b".U.", b".MILLI.", b".KILO.", b".CENTI.", b".EXA.", b".ATTO.", b".METRE.", b".GRAM.", b".RADIAN.",
    b".DEGREE.", b".UNSPECIFIED.", b".PCURVE_S1.", b".NONSENSE.", b"..", b"$", b"1",
)  # fmt: skip


def spoiled_arguments(step: StepText, rng: Random) -> bytes:
    """Omit, duplicate, empty or deeply nest arguments, or choose another option."""
    edits = []
    for statement in _some(step, rng):
        tokens = step.tokens[statement.first : statement.last]
        values = [token for token in tokens if token.kind in ("string", "reference", "number", "enumeration")]
        options = [token for token in values if token.kind == "enumeration"]
        if options and rng.random() < 0.5:
            token = rng.choice(options)
            edits.append(Edit(token.start, token.end, rng.choice(_ENUMERATIONS)))
        elif lists := _lists(step, tokens) if rng.random() < 0.4 else []:
            edits.append(_changed_list(step, rng.choice(lists), rng))
        elif values:
            token = rng.choice(values)
            text = step.text(token)
            edits.append(
                Edit(token.start, token.end, rng.choice((*_ARGUMENTS, text + b"," + text, b"(" + text + b")")))
            )
    return step.edited(edits) if edits else flipped_bytes(step, rng)


def _lists(step: StepText, tokens: list[Token]) -> list[list[Token]]:
    """The innermost lists of a statement, without their parentheses."""
    found: list[list[Token]] = []
    inside: list[Token] | None = None
    for token in tokens:
        mark = step.text(token) if token.kind == "mark" else b""
        if mark == b"(":
            inside = []
        elif mark == b")":
            found += [inside] if inside else []
            inside = None
        elif inside is not None:
            inside.append(token)
    return found


def _changed_list(step: StepText, inside: list[Token], rng: Random) -> Edit:
    start, end = inside[0].start, inside[-1].end
    parts = [step.text(token) for token in inside if token.kind != "mark"]
    way = rng.randrange(5)
    if way == 0:
        parts = []
    elif way == 1 and parts:
        del parts[rng.randrange(len(parts))]
    elif way == 2:
        parts = parts[::-1]
    elif way == 3:
        parts *= rng.choice((2, 50))
    else:
        rng.shuffle(parts)
    return Edit(start, end, b",".join(parts))


def _some(step: StepText, rng: Random) -> list[Statement]:
    """One or several statements, of equally likely kinds."""
    if not step.statements:
        return []
    if rng.random() < 0.1:
        return step.by_keyword[rng.choice(sorted(step.by_keyword))]
    return list({_one(step, rng): None for _ in range(rng.choice((1, 1, 1, 2, 3, 8)))})


def _one(step: StepText, rng: Random) -> Statement:
    return rng.choice(step.by_keyword[rng.choice(sorted(step.by_keyword))])


def _target(step: StepText, token: Token) -> int:
    return int(step.data[token.start + 1 : token.end])


def _other_target(step: StepText, statement: Statement, token: Token, rng: Random) -> int:
    way = rng.randrange(8)
    if way == 0:
        return statement.number
    if way == 1:
        return rng.choice((0, max(step.by_number) + 1, 2**31, 99_999_999_999_999_999_999))
    target = step.by_number.get(_target(step, token))
    if way <= 4 and target is not None:
        return rng.choice(step.by_keyword[target.keyword]).number
    return _one(step, rng).number
