"""One STEP file read by the kernel: its products, before any body is made."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from msgspec import Struct
from OCP.StepShape import StepShape_SolidModel
from OCP.TopAbs import TopAbs_ShapeEnum

from stepbot.diagnostics import Diagnostics, Span

from .exchange.encodings import as_utf8
from .exchange.file_set import NONE as NO_FILE
from .exchange.file_set import Link, StepFile
from .exchange.integrity import check_integrity, check_numbers
from .exchange.length_unit import LengthUnit, read_length_unit
from .exchange.operators import correct_operators
from .exchange.selection import entities, entity_of, forget_external_files, mechanism_count
from .exchange.statements import report_long_tokens
from .kernel import KERNEL_ERRORS, OUT_OF_MEMORY, StepUnreadable, read_model, transfer
from .structure.definitions import Definitions
from .structure.materials import Materials
from .structure.products import Products
from .structure.repetition import MisplacedOccurrence
from .structure.source import NONE, Definition, StepMaterial
from .structure.tree import MAX_COMPONENTS, report_too_large

T = TypeVar("T")


class FileContent(Struct, frozen=True, eq=False):
    """The content of a file."""

    session: Any
    """Work session of its reader."""
    unit: LengthUnit
    products: Products
    definitions: Definitions
    materials: list[StepMaterial]
    mechanisms: int
    elsewhere: Mapping[int, int]
    """For each definition whose shape is in another file the index of that file."""


def guarded(place: str, diagnostics: Diagnostics, read: Callable[[], T | None]) -> T | None:
    """The result of a function that reads; None, with SB205 in ``diagnostics``, if the kernel fails on the file."""
    remedy = ["open it in another CAD program and export it again"]
    try:
        return read()
    except StepUnreadable as error:
        diagnostics.add("SB205", str(error), Span(place), help=remedy)
        return None
    except OUT_OF_MEMORY:
        raise MemoryError from None  # the process ends, and its parent reports why
    except KERNEL_ERRORS as error:
        message = f"kernel error: {type(error).__name__} {error}".rstrip()
        diagnostics.add("SB205", message, Span(place), help=remedy)
        return None


def optional(what: str, place: str, diagnostics: Diagnostics, read: Callable[[], T], instead: T) -> T:
    """What a file can be read without; where it fails that is reported."""
    try:
        return read()
    except OUT_OF_MEMORY:
        raise MemoryError from None
    except Exception as error:  # noqa: BLE001 - whatever it is, it costs this result alone
        diagnostics.add(
            "SB233", f"reading {what} failed ({type(error).__name__} {error})".replace(" )", ")"), Span(place)
        )
        return instead


def read_file(file: StepFile, diagnostics: Diagnostics) -> FileContent | None:
    """Read a file; None, with the reason in ``diagnostics``, after an error."""

    def read() -> FileContent | None:
        try:
            return _read(file, diagnostics, take_out=True)
        except MisplacedOccurrence:
            return _read(file, diagnostics, take_out=False)

    return guarded(file.place, diagnostics, read)


def _read(file: StepFile, diagnostics: Diagnostics, *, take_out: bool) -> FileContent | None:
    place = file.place
    with as_utf8(file.path, file.part21.encoding) as text:
        if not check_numbers(text, place, diagnostics):
            return None
        try:
            reader, session = read_model(text)
        except StepUnreadable:
            if report_long_tokens(text, place, diagnostics):
                return None
            raise
        if not check_integrity(session, text, place, diagnostics):
            return None
    unit = read_length_unit(session, place, diagnostics)
    if unit is None:
        return None
    materials = optional("materials", place, diagnostics, lambda: Materials(session, place, diagnostics), None)
    products = Products(session, take_out=take_out)
    if products.tree_size() > MAX_COMPONENTS:  # the kernel would expand each of them
        report_too_large(products.tree_size(), place, diagnostics)
        return None
    correct_operators(session)
    forget_external_files(session)
    definitions = Definitions(transfer(reader), products)
    if definitions.color_errors:
        message = f"reading {len(definitions.color_errors)} colors failed ({definitions.color_errors[0]})"
        diagnostics.add("SB233", message, Span(place))
    written = optional("its solids", place, diagnostics, lambda: len(entities(session, StepShape_SolidModel)), 0)
    _check_solids(written, definitions.all, place, diagnostics)
    elsewhere = _elsewhere(file, session, products, definitions.all, diagnostics)
    if elsewhere is None:
        return None

    def materials_of(materials: Materials) -> list[StepMaterial]:
        return [
            StepMaterial() if one.product == NONE else materials.of(products.products[one.product].entity, one.name)
            for one in definitions.all
        ]

    made_of = [StepMaterial()] * len(definitions.all)
    if materials is not None:
        made_of = optional("materials", place, diagnostics, lambda: materials_of(materials), made_of)
    mechanisms = optional("mechanisms", place, diagnostics, lambda: mechanism_count(session), 0)
    return FileContent(session, unit, products, definitions, made_of, mechanisms, elsewhere)


def _elsewhere(
    file: StepFile, session: Any, products: Products, definitions: list[Definition], diagnostics: Diagnostics
) -> dict[int, int] | None:
    """For each definition without own shape the index of the file with its shape.

    A missing file is an error in ``diagnostics``; its definition has no shape and is marked. None if a missing file
    belongs to no definition.
    """
    product_of = {id(product.entity): index for index, product in enumerate(products.products)}
    definition_of = {definition.product: index for index, definition in enumerate(definitions)}
    elsewhere: dict[int, int] = {}
    is_complete = True
    for link in file.links:
        reference = link.reference
        product = product_of.get(id(entity_of(session, reference.definition)), NONE)
        index = definition_of.get(product, NONE) if product != NONE else NONE
        if index != NONE and (definitions[index].bodies or definitions[index].children or index in elsewhere):
            if elsewhere.get(index) != link.file:
                message = f"'{reference.product}': external file '{reference.name}' is not needed and was not read"
                diagnostics.add("SB231", message, Span(file.place, reference.line, 1))
        elif index == NONE:
            _report_missing(link, file.place, diagnostics)
            is_complete = False
        elif link.file == NO_FILE:
            _report_missing(link, file.place, diagnostics)
            definitions[index].missing = reference.name
        else:
            elsewhere[index] = link.file
    return elsewhere if is_complete else None


def _report_missing(link: Link, place: str, diagnostics: Diagnostics) -> None:
    reference, fault = link.reference, link.fault or "but the assembly does not define its pose"
    message = f"the geometry of '{reference.product}' is in file '{reference.name}', {fault}"
    if not reference.definition:
        message = f"geometry is in file '{reference.name}', but the assembly does not say which part it is"
    help = link.help or ("export the assembly as one STEP file, with external references switched off",)
    diagnostics.add("SB203", message, Span(place, reference.line, 1), help=help)


def _check_solids(written: int, definitions: list[Definition], place: str, diagnostics: Diagnostics) -> None:
    """Report if the kernel built fewer solids than the file describes."""
    sources = [source for definition in definitions for source in definition.bodies]
    read = sum(source.shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID for source in sources)
    if read < written:
        diagnostics.add(
            "SB220",
            f"{written - read} of the {written} solids in the file are not part of a product, or could not be built",
            Span(place),
            help=["compare the solids of `stepbot inspect` with those in CAD"],
        )
