"""References of a STEP file to other files that hold the shapes of its products, as its text states them.

CAD programs write an assembly with "external references" as one file with the structure alone, and one file per part. A
product definition then refers to a DOCUMENT_FILE (ISO 10303-41), whose external identification is the file's name; see
the CAx-IF recommended practices for external references. The text is read without the kernel.
"""

import re
from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping

from msgspec import Struct

from stepbot.robot.step_names import is_step_name

from . import DOCUMENT_FILE
from .encodings import FALLBACK, LIKELY, Text, lines_of
from .entities import Entities
from .part21_values import Record, Value, decode_string
from .statements import find_statements

_CAD_NAME = re.compile(
    r"\.(stpxz?|igs|iges|prt|asm|sldprt|sldasm|catpart|catproduct|ipt|iam|par|psm|jt|x_t|x_b|sat|3dm|f3d)(\.\d+)?$",
    re.IGNORECASE,
)
_WANTED = re.compile(rb"DOCUMENT|EXTERNAL|SPECIFICATION_REFERENCE|PRODUCT")
_REFERRING = (
    "APPLIED_DOCUMENT_REFERENCE",
    "CC_DESIGN_SPECIFICATION_REFERENCE",
    "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS",
)
"""Entities that connect a document with the described product."""
_DOCUMENT = "DOCUMENT"
_EQUIVALENT = ("DOCUMENT_PRODUCT_EQUIVALENCE", "DOCUMENT_PRODUCT_ASSOCIATION")
"""Entities that connect a document under version control with the product that stands for it."""


class ExternalReference(Struct, frozen=True):
    """A product definition whose shape is in another file."""

    definition: int
    """Entity number of the product definition; 0 if the file does not state it."""
    product: str
    """Name of its product; may be empty."""
    raw: bytes
    """Name of the other file, raw text between the quotes."""
    name: str
    """The same, decoded."""
    line: int
    """Line of the document, from 1."""

    @property
    def is_step(self) -> bool:
        """Whether the other file is a STEP file by its name."""
        return is_step_name(self.name)

    @property
    def is_cad(self) -> bool:
        """Whether it is a file of another CAD format by its name."""
        return _CAD_NAME.search(self.name) is not None

    @property
    def readings(self) -> tuple[str, ...]:
        """The name in each possible encoding, the likeliest first; a file that exists decides between them."""
        texts: dict[str, None] = {}
        for encoding in ("utf-8", *LIKELY):
            try:
                texts[decode_string(self.raw, encoding)] = None
            except UnicodeDecodeError:
                continue
        return tuple(texts)


def external_references(data: Text, encoding: str, *, with_products: bool = True) -> tuple[ExternalReference, ...]:
    """The references of a file, in file order, without duplicates.

    Args:
        encoding: Encoding of bytes above 127; empty if unknown.
        with_products: Whether to return one reference per product; otherwise one per document, without a product, which
            takes linear time for any content.
    """
    if data.find(DOCUMENT_FILE) < 0:
        return ()
    bodies: dict[int, bytes] = {}
    starts: dict[int, int] = {}
    for statement in find_statements(data):
        if _WANTED.search(statement.body) and statement.number not in bodies:
            bodies[statement.number], starts[statement.number] = statement.body, statement.start
    entities = Entities(bodies, encoding)
    definitions, names = _definitions(entities) if with_products else {}, _file_names(entities)
    documents = entities.of(DOCUMENT_FILE.decode())
    lines = lines_of(data, [starts[document] for document in documents])
    references_by_key: dict[tuple[int, bytes], ExternalReference] = {}
    for document in documents:
        raw = names[document]
        name = decode_string(raw, encoding or FALLBACK, "replace").strip()
        for definition in definitions.get(document, (0,)) if name else ():
            product = entities.product_name(definition) if definition else ""
            reference = ExternalReference(definition, product, raw, name, lines[starts[document]])
            references_by_key.setdefault((definition, raw), reference)
    return tuple(references_by_key.values())


def _definitions(entities: Entities) -> dict[int, tuple[int, ...]]:
    """For each document the product definitions that it describes.

    A document under version control is a product of its own, to which its file belongs: what that document describes
    takes the place of this product.
    """
    of_formation: dict[int, list[int]] = defaultdict(list)
    kinds = ("PRODUCT_DEFINITION", "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS")
    product_definitions = dict.fromkeys(number for kind in kinds for number in entities.of(kind))
    for definition in product_definitions:
        for referred in entities.references(definition):
            of_formation[referred].append(definition)
    described = _described(entities, product_definitions, of_formation)
    controlled: dict[int, int] = {}
    for number in (n for keyword in _EQUIVALENT for n in entities.of(keyword)):
        ends = entities.references(number)
        for document in (end for end in ends if entities.keyword(end, _DOCUMENT)):
            controlled.update((definition, document) for end in ends for definition in of_formation[end])
    for items in described.values():
        for definition in [item for item in items if described.get(controlled.get(item, 0))]:
            del items[definition]
            items.update(described[controlled[definition]])
    return {document: tuple(items) for document, items in described.items() if items}


def _described(
    entities: Entities, product_definitions: Container[int], of_formation: Mapping[int, Iterable[int]]
) -> dict[int, dict[int, None]]:
    """For each document, with or without a file, the product definitions that it is connected with."""
    described: dict[int, dict[int, None]] = defaultdict(dict)
    for keyword in _REFERRING:
        for number in entities.of(keyword):
            own = [number] if number in product_definitions else []
            items = entities.references(number)
            for document in (r for r in items if set(entities.keywords(r)) & {_DOCUMENT, DOCUMENT_FILE.decode()}):
                for item in own or items:
                    if item in product_definitions:
                        described[document][item] = None
                    elif any(word.startswith("PRODUCT_DEFINITION_FORMATION") for word in entities.keywords(item)):
                        described[document].update(dict.fromkeys(of_formation.get(item, ())))
    return described


def _file_names(entities: Entities) -> dict[int, bytes]:
    """For each document its folder and file name, raw; empty without a name."""
    names: dict[int, bytes] = {}
    for number in entities.of("APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT"):
        referred = entities.references(number)
        name, folder = _first_text(*entities.records(number)), b""
        for source in (r for r in referred if entities.keyword(r, "EXTERNAL_SOURCE")):
            folder = _first_text(*entities.records(source)).strip().rstrip(b"/\\")
        if re.split(rb"[/\\\\]", folder)[-1] == name:  # the kernel's own writer repeats the file's name there
            name = folder
        elif name and folder not in (b"", b"."):
            name = folder + b"/" + name
        for document in referred:
            names.setdefault(document, name)
    for document in entities.of(DOCUMENT_FILE.decode()):
        records = [r for r in entities.records(document) if r.keyword in ("DOCUMENT", "DOCUMENT_FILE")]
        names[document] = names.get(document) or _first_text(*records)
    return names


def _first_text(*records: Record) -> bytes:
    return next((value for record in records for value in _texts(record.parameters)), b"")


def _texts(values: tuple[Value, ...]) -> Iterator[bytes]:
    for value in values:
        if isinstance(value, bytes):
            yield value
        elif isinstance(value, Record):
            yield from _texts(value.parameters)
