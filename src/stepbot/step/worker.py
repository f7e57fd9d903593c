"""Converts a STEP file to an Assembly, in the kernel's process.

    read       entities, unit, materials, names
    transfer   shapes, not healed; definitions; the tree of components
    bodies     each healed, measured, meshed, in parallel

Only modules imported from here import the geometry kernel.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.StepShape import StepShape_SolidModel
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp

from stepbot.diagnostics import Diagnostic, Diagnostics, Span
from stepbot.geometry.mass_properties import prepare as prepare_measuring
from stepbot.geometry.mesh import TriMesh
from stepbot.runtime.processes import thread_count

from .assembly import Assembly, Body, BodyKind, Component, Quantity, ReadOptions
from .attempts import BODY_SECONDS, Attempt
from .exchange.encodings import as_utf8, encoding_fact
from .exchange.integrity import check_integrity
from .exchange.length_unit import LengthUnit, read_length_unit
from .exchange.operators import correct_operators
from .exchange.part21 import Part21
from .exchange.selection import entities, mechanism_count
from .kernel import StepUnreadable, read_model, transfer
from .kernel_errors import KERNEL_ERRORS, OUT_OF_MEMORY
from .parallel import Died, Raised, run
from .shapes.bodies import BodyRequest, Finding, ReadBody, read_body
from .shapes.mirroring import variant
from .structure.definitions import Definitions
from .structure.materials import Materials
from .structure.products import Products
from .structure.repetition import MisplacedOccurrence
from .structure.source import NONE, BodySource, Definition, StepMaterial
from .structure.tolerances import definition_tolerances
from .structure.tree import MAX_COMPONENTS, Tree, grow, report_too_large
from .validation.comparison import Stated, compare
from .validation.properties import read_statements
from .validation.subjects import Subjects


@dataclass(frozen=True, eq=False)
class _Content:
    """A STEP file before its bodies are made."""

    unit: LengthUnit
    definitions: list[Definition]
    tree: Tree
    stated: list[Stated]
    """Values stated in the file for comparison."""
    mechanisms: int
    """Number of kinematic mechanisms in the file."""


def read(
    path: str, place: str, part21: Part21, options: ReadOptions, attempt: Attempt | None = None
) -> tuple[Assembly | None, tuple[Diagnostic, ...]]:
    """Read a STEP file.

    Args:
        path: The file.
        place: Name of the file in diagnostics.
        part21: Its text, already checked.
        options: What to compute.
        attempt: Records the current body for the case that this process ends, if bodies have no processes of their own.

    Returns:
        The assembly, or None, and the diagnostics.
    """
    found = Diagnostics()
    content = _read_content(path, place, part21, found)
    if content is None:
        return None, tuple(found)
    bodies = _Bodies(content, place, found)
    made = bodies.make(options, attempt)
    components = content.tree.components
    stated = content.stated if options.geometry else []
    assembly = Assembly(
        source=Path(path).name.encode("utf-8", "backslashreplace").decode(),
        schema=part21.header.schema,
        originating_system=part21.header.originating_system,
        unit=content.unit.name,
        unit_scale=content.unit.scale,
        components=components,
        bodies=bodies.variants(made),
        definitions=content.tree.definition_count,
        validations=compare(stated, content.definitions, components, made, place, found),
        diagnostics=tuple(found),
        facts=_facts(part21, content),
    )
    return assembly, tuple(found)


def _read_content(path: str, place: str, part21: Part21, found: Diagnostics) -> _Content | None:
    """Everything but the bodies; None, with the reason in ``found``, after an error."""
    remedy = ["open it in another CAD program and export it again"]
    try:
        try:
            content = _read_products(path, place, part21, found, take_out=True)
        except MisplacedOccurrence:
            content = _read_products(path, place, part21, found, take_out=False)
    except StepUnreadable as error:
        found.add("SB205", str(error), Span(place), help=remedy)
        return None
    except OUT_OF_MEMORY:
        raise MemoryError from None  # the process ends, and its parent reports why
    except KERNEL_ERRORS as error:
        message = f"kernel error: {type(error).__name__} {error}".rstrip()
        found.add("SB205", message, Span(place), help=remedy)
        return None
    if content is not None and not content.tree.variants:
        found.add("SB206", "the kernel could build no geometry", Span(place), help=["export it as a B-rep"])
        return None
    return content


def _read_products(path: str, place: str, part21: Part21, found: Diagnostics, *, take_out: bool) -> _Content | None:
    with as_utf8(Path(path), part21.encoding) as text:
        model = read_model(text)
        if not check_integrity(model.session, text, place, found):
            return None
    unit = read_length_unit(model.session, place, found)
    if unit is None:
        return None
    materials = Materials(model.session, place, found)
    products = Products(model.session, take_out=take_out)
    if products.tree_size() > MAX_COMPONENTS:  # the kernel would expand each of them
        report_too_large(products.tree_size(), place, found)
        return None
    correct_operators(model.session)
    definitions = Definitions(transfer(model), products)
    _check_solids(len(entities(model.session, StepShape_SolidModel)), definitions.all, place, found)
    made_of = [_material(definition, materials, products) for definition in definitions.all]
    tree = grow(definitions.all, definitions.roots, made_of, place, found)
    if tree is None:
        return None
    stated = _stated(model.session, products, definitions.all, tree)
    return _Content(unit, definitions.all, tree, stated, mechanism_count(model.session))


def _stated(session: Any, products: Products, definitions: list[Definition], tree: Tree) -> list[Stated]:
    statements = read_statements(session)
    if not statements:
        return []
    subjects = Subjects(session, products, definitions, tree)
    return [Stated(subjects.of(s.subject), s.quantity, s.value) for s in statements]


def _check_solids(written: int, definitions: list[Definition], place: str, found: Diagnostics) -> None:
    """Report if the kernel built fewer solids than the file describes."""
    sources = [source for definition in definitions for source in definition.bodies]
    read = sum(source.shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID for source in sources)
    if read < written:
        found.add(
            "SB220",
            f"{written - read} of the {written} solids in the file are not part of a product, or could not be built",
            Span(place),
            help=["compare the solids of `stepbot inspect` with those in CAD"],
        )


def _material(definition: Definition, materials: Materials, products: Products) -> StepMaterial:
    if definition.product == NONE:
        return StepMaterial()
    return materials.of(products.products[definition.product].entity, definition.name)


def _facts(part21: Part21, content: _Content) -> dict[str, str]:
    header = part21.header
    facts = {
        "encoding": encoding_fact(part21.encoding),
        "written": header.time_stamp,
        "preprocessor": header.preprocessor,
        "further units": ", ".join(content.unit.others),
        "mechanisms": f"{content.mechanisms}; `stepbot init` drafts joints from them" if content.mechanisms else "",
    }
    return {name: value for name, value in facts.items() if value}


class _Bodies:
    """Makes the bodies of a file: every one once, then the mirrored and scaled ones from them."""

    def __init__(self, content: _Content, place: str, found: Diagnostics) -> None:
        self._place, self._found = place, found
        self._components = content.tree.components
        self._variants = content.tree.variants
        keys = dict.fromkeys((v.definition, v.body) for v in self._variants)
        self._number = {key: number for number, key in enumerate(keys)}
        self._areas = any(stated.quantity is Quantity.AREA for stated in content.stated)
        self._sources = [content.definitions[definition].bodies[body] for definition, body in keys]
        self._first = self._first_components()
        for definition, _ in keys:
            if content.definitions[definition].has_spare_curves:
                self._report_curves(content.definitions[definition])

    def make(self, options: ReadOptions, attempt: Attempt | None) -> dict[tuple[int, int], Body]:
        """Each body once, by the number of its definition and its own number in it."""
        made = self._make(options, attempt) if options.geometry else map(_outline, self._sources)
        return dict(zip(self._number, made, strict=True))

    def variants(self, made: Mapping[tuple[int, int], Body]) -> tuple[Body, ...]:
        """The bodies that components refer to."""
        return tuple(
            variant(made[v.definition, v.body], is_mirrored=v.is_mirrored, scale=v.scale) for v in self._variants
        )

    def _make(self, options: ReadOptions, attempt: Attempt | None) -> list[Body]:
        tolerances = definition_tolerances(
            self._components, [self._number[v.definition, v.body] for v in self._variants], options
        )

        def make(number: int) -> ReadBody:
            return read_body(
                self._sources[number],
                BodyRequest(tolerances[number], options.refine_mass_to, self._areas, options.faces),
            )

        if options.refine_mass_to > 0.0:
            prepare_measuring()  # once, before there are several processes
        weights = [_edge_count(source) for source in self._sources]
        order = sorted(range(len(weights)), key=lambda number: -weights[number])
        # Processes with threads cannot fork safely: then this process makes all bodies.
        processes, seconds = (None, BODY_SECONDS) if thread_count() == 1 else (1, 0.0)
        results = run(make, order, processes=processes, failures=KERNEL_ERRORS, seconds=seconds, attempt=attempt)
        bodies = []
        for number in range(len(self._sources)):
            result = results[number]
            if isinstance(result, Died | Raised):
                bodies.append(self._failed(number, result))
                continue
            for finding in result.findings:
                self._report(number, finding)
            bodies.append(result.body)
        return bodies

    def _failed(self, number: int, result: Died | Raised) -> Body:
        reason = result.reason if isinstance(result, Died) else f"{result.kind} {result.text}".rstrip()
        help = "repair the body in CAD and export again"
        if isinstance(result, Raised) and result.kind in (kind.__name__ for kind in OUT_OF_MEMORY):
            reason, help = "out of memory", "raise `--memory-limit`, or use a coarser mesh"
        message = f"the geometry kernel failed ({reason})"
        self._report(number, Finding("SB213", message, (help,)))
        return replace(_outline(self._sources[number]), defect=message)

    def _report(self, number: int, finding: Finding) -> None:
        """Add a diagnostic of a body, with the first component that displays it."""
        component, others = self._first[number]
        more = f" ({others} more like it)" if others else ""
        message = f"'{component.path}'{more}: {finding.message}"
        self._found.add(finding.code, message, Span(self._place), help=finding.help)

    def _report_curves(self, definition: Definition) -> None:
        self._found.add("SB218", f"'{definition.name}': its curves and points are ignored", Span(self._place))

    def _first_components(self) -> dict[int, tuple[Component, int]]:
        """For each body, the first component that displays it, and the number of others."""
        first: dict[int, tuple[Component, int]] = {}
        for component in self._components:
            if component.body != NONE:
                v = self._variants[component.body]
                number = self._number[v.definition, v.body]
                shown, others = first.get(number, (component, -1))
                first[number] = (shown, others + 1)
        return first


def _outline(source: BodySource) -> Body:
    """A body by its type only."""
    holds_solid = not source.is_wire and source.shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    kind = BodyKind.WIRE if source.is_wire else BodyKind.SOLID if holds_solid else BodyKind.SURFACE
    return Body(kind, TriMesh.of(np.empty((0, 3)), np.empty((0, 3))), np.empty(0, np.int32), (None,), False)


def _edge_count(source: BodySource) -> int:
    """Estimated work for a body."""
    edges = ShapeMap()
    TopExp.MapShapes_s(source.shape, TopAbs_ShapeEnum.TopAbs_EDGE, edges)
    return int(edges.Extent())
