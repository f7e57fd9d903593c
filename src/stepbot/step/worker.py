"""Converts a STEP file to an Assembly, in the kernel's process.

    one_file   entities, unit, materials, names; shapes, not healed; definitions
    content    all files of the assembly; the tree of components
    bodies     each healed, measured, meshed, in parallel

Only modules imported from here import the geometry kernel.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np
from msgspec.structs import replace
from OCP.TopAbs import TopAbs_ShapeEnum

from stepbot.diagnostics import Diagnostic, Diagnostics, Finding, Span
from stepbot.geometry.mass_properties import prepare as prepare_measuring
from stepbot.geometry.mesh import TriMesh
from stepbot.runtime.parallel import Attempt, Died, Raised, run
from stepbot.runtime.processes import thread_count

from . import BODY_SECONDS
from .assembly import Assembly, Body, BodyKind, Component, Quantity, ReadOptions, Validation
from .content import Content, read_content
from .exchange.encodings import encoding_fact
from .exchange.file_set import StepFile
from .exchange.part21 import Part21
from .kernel import OUT_OF_MEMORY, mapped
from .one_file import optional
from .shapes.bodies import BodyRequest, ReadBody, read_body
from .shapes.splitting import variant
from .structure.repetition import definition_tolerances
from .structure.source import NONE, BodySource
from .validation.comparison import compare


def read(
    files: tuple[StepFile, ...], options: ReadOptions, attempt: Attempt | None = None
) -> tuple[Assembly | None, tuple[Diagnostic, ...]]:
    """Read an assembly.

    Args:
        files: Its STEP file, and then the files that this one refers to.
        attempt: Records the current body for the case that this process ends, if bodies have no processes of their own.

    Returns:
        The assembly, None after an error, and the diagnostics.
    """
    diagnostics = Diagnostics()
    content = read_content(files, diagnostics)
    if content is None:
        return None, tuple(diagnostics)
    place, part21 = files[0].place, files[0].part21
    bodies = _Bodies(content, place, diagnostics)
    made = bodies.make(options, attempt)
    components = content.tree.components
    stated = content.stated if options.geometry else []
    validations: tuple[Validation, ...] = optional(
        *("validation properties", place, diagnostics),
        lambda: compare(stated, content.definitions, components, made, place, diagnostics),
        (),
    )
    assembly = Assembly(
        source=files[0].name.encode("utf-8", "backslashreplace").decode(),
        schema=part21.header.schema,
        originating_system=part21.header.originating_system,
        unit=content.unit.name,
        unit_scale=content.unit.scale,
        components=components,
        bodies=bodies.variants(made),
        definitions=content.tree.definition_count,
        external_files=content.external,
        validations=validations,
        diagnostics=tuple(diagnostics),
        facts=_facts(part21, content),
    )
    return assembly, tuple(diagnostics)


def _facts(part21: Part21, content: Content) -> dict[str, str]:
    header = part21.header
    facts = {
        "encoding": encoding_fact(part21.encoding),
        "written": header.time_stamp,
        "preprocessor": header.preprocessor,
        "further units": ", ".join(content.unit.others),
        "further files": ", ".join(content.external),
        "mechanisms": f"{content.mechanisms}; `stepbot init` drafts joints from them" if content.mechanisms else "",
    }
    return {name: value for name, value in facts.items() if value}


class _Bodies:
    """Makes the bodies of a file: every one once, then the mirrored and scaled ones from them."""

    def __init__(self, content: Content, place: str, diagnostics: Diagnostics) -> None:
        self._place, self._diagnostics = place, diagnostics
        self._components = content.tree.components
        self._variants = content.tree.variants
        keys = dict.fromkeys((v.definition, v.body) for v in self._variants)
        self._number = {key: number for number, key in enumerate(keys)}
        self._areas = any(stated.quantity is Quantity.AREA for stated in content.stated)
        self._sources = [content.definitions[definition].bodies[body] for definition, body in keys]
        self._first = self._first_components()
        for definition, _ in keys:
            if content.definitions[definition].has_spare_curves:
                message = f"'{content.definitions[definition].name}': its curves and points are ignored"
                diagnostics.add("SB216", message, Span(place))

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

        count = len(self._sources)
        failed: dict[int, str] = {}

        def make(number: int) -> ReadBody:
            """A body; with ``count`` added to its number, its mesh alone."""
            whose = number % count
            what = options.refine_mass_to, self._areas, options.faces, failed.get(whose, "")
            return read_body(self._sources[whose], BodyRequest(tolerances[whose], *what))

        if options.refine_mass_to > 0.0:
            prepare_measuring()  # once, before there are several processes
        edges = [mapped(source.shape, TopAbs_ShapeEnum.TopAbs_EDGE).Extent() for source in self._sources]
        order = sorted(range(count), key=lambda number: -edges[number])
        # Processes with threads cannot fork safely: then this process makes all bodies.
        processes, seconds = (None, BODY_SECONDS) if thread_count() == 1 else (1, 0.0)

        made = partial(
            run, make, processes=processes, failures=(Exception,), seconds=seconds, attempt=attempt, work="bodies"
        )
        results = made(order)
        failed |= {number: _reason(result) for number, result in results.items() if not isinstance(result, ReadBody)}
        again = made([number + count for number in failed]) if failed else {}
        results |= {number - count: second for number, second in again.items() if isinstance(second, ReadBody)}
        bodies = []
        for number in range(count):
            result = results[number]
            if isinstance(result, ReadBody):
                for finding in result.findings:
                    self._report(number, finding)
            bodies.append(result.body if isinstance(result, ReadBody) else self._failed(number, result))
        return bodies

    def _failed(self, number: int, result: Died | Raised) -> Body:
        reason = _reason(result)
        help = "repair the body in CAD and export again"
        if isinstance(result, Raised) and result.kind in (kind.__name__ for kind in OUT_OF_MEMORY):
            reason, help = "out of memory", "raise `--memory-limit`, or use a coarser mesh"
        message = f"the geometry kernel failed ({reason})"
        self._report(number, Finding("SB213", message, (help,)))
        # A conversion must not miss its mass, whatever it is.
        return replace(_outline(self._sources[number]), kind=BodyKind.SOLID, defect=message)

    def _report(self, number: int, finding: Finding) -> None:
        """Add a diagnostic of a body, with the first component that displays it."""
        component, others = self._first[number]
        more = f" ({others} more like it)" if others else ""
        message = f"'{component.path}'{more}: {finding.message}"
        self._diagnostics.add(finding.code, message, Span(self._place), help=finding.help)

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


def _reason(result: Died | Raised) -> str:
    """Why a body failed, for messages."""
    return result.reason if isinstance(result, Died) else f"{result.kind} {result.text}".rstrip()


def _outline(source: BodySource) -> Body:
    """A body by its type only."""
    holds_solid = not source.is_wire and source.shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    kind = BodyKind.WIRE if source.is_wire else BodyKind.SOLID if holds_solid else BodyKind.SURFACE
    return Body(kind, TriMesh.of(np.empty((0, 3)), np.empty((0, 3))), np.empty(0, np.int32), (None,), False)
