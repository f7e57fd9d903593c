"""Sort the statements of a STEP file into an order that does not depend on memory addresses.

The kernel numbers the geometry in the order of drawing, but appends the colours of each product in the order of memory
addresses, which differs between processes. Here they follow in the order of the products, one statement per line.
The format is ISO 10303-21, "clear text encoding of the exchange structure".
"""

import re

_STATEMENT = re.compile(rb"#(\d+)\s*=\s*((?:'[^']*'|[^';])*);")
_TOKEN = re.compile(rb"'[^']*'|#\d+|\s*\n\s*")
_COLORS = b"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"


def in_canonical_order(content: bytes) -> bytes:
    """The same exchange structure with its colours in the order of their products.

    Raises:
        ValueError: A statement after the first colour belongs to no colour.
    """
    start, end = content.index(b"DATA;"), content.rindex(b"ENDSEC;")
    bodies = {int(number): _one_line(body) for number, body in _STATEMENT.findall(content, start, end)}
    styles = [number for number, body in bodies.items() if body.startswith(_COLORS)]
    order = [number for number in bodies if not styles or number < min(styles)]

    known = set(order)
    # The last reference of a representation is its context, which belongs to one product and was numbered with it.
    pending = sorted(styles, key=lambda number: _references(bodies[number])[-1], reverse=True)
    while pending:
        number = pending.pop()
        if number not in known:
            known.add(number)
            order.append(number)
            pending += reversed(_references(bodies[number]))
    if len(order) != len(bodies):
        raise ValueError(f"{len(bodies) - len(order)} statements after the first colour belong to none")

    place = {number: i for i, number in enumerate(order, start=1)}
    lines = [b"#%d=%s;" % (place[number], _renumbered(bodies[number], place)) for number in order]
    header = content[:start].replace(b"\r\n", b"\n")
    return b"\n".join((header.rstrip(b"\n"), b"DATA;", *lines, b"ENDSEC;", b"END-ISO-10303-21;", b""))


def _one_line(body: bytes) -> bytes:
    return _TOKEN.sub(lambda token: b"" if token[0].isspace() else token[0], body)


def _references(body: bytes) -> list[int]:
    return [int(token[1:]) for token in _TOKEN.findall(body) if token.startswith(b"#")]


def _renumbered(body: bytes, place: dict[int, int]) -> bytes:
    return _TOKEN.sub(lambda token: b"#%d" % place[int(token[0][1:])] if token[0].startswith(b"#") else token[0], body)
