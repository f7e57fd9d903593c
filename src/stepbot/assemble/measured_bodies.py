"""Selects the volume, centre of mass and inertia of each body: the mesh's, by trimesh, or the exact solid's.

``auto`` uses the mesh if it agrees with the solid within a thousandth, else the exact value; ``mesh`` uses the finest
mesh available; ``exact`` uses the solid. If only one of them encloses a volume, that one is used. Of a solid on which
two integration methods agree to a tenth only, the exact value is used, and reported; a solid on which they differ
more is not used.
"""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from math import ceil, floor, log10

from stepbot.geometry.volume import VolumeProperties
from stepbot.report.robot import MeasuredBody
from stepbot.sidecar.document import MassMode
from stepbot.step.assembly import CERTAIN, USABLE, Assembly, Body, BodyKind

from .binder import Binder, listed
from .masses import MASS_TOLERANCE


def measured_bodies(
    assembly: Assembly, measures: Sequence[VolumeProperties | None], mode: MassMode
) -> tuple[MeasuredBody, ...]:
    """Each body of the assembly, measured on its mesh and exactly, and which of the two is used.

    Args:
        measures: trimesh's mass properties of the mesh of each of ``assembly.bodies``.
    """
    occurrences = Counter(component.body for component in assembly.components)
    names: dict[int, str] = {}
    for component in assembly.components:
        names.setdefault(component.body, component.path)
    return tuple(
        _measured(names.get(number, ""), occurrences[number], body, body.refined or measure, mode)
        for number, (body, measure) in enumerate(zip(assembly.bodies, measures, strict=True))
    )


def report_choices(binder: Binder, bodies: Sequence[MeasuredBody], components: Collection[int]) -> None:
    """Report the robot's components whose mass properties are not the mesh's, and why."""
    first: dict[int, int] = {}
    for index in sorted(components):
        first.setdefault(binder.assembly.components[index].body, index)
    mode = binder.document.mass
    deviating = tuple(
        f"{binder.path(index)}: {bodies[number].written}"
        for number, index in first.items()
        if bodies[number].used is not None and ":" in bodies[number].written
    )
    if not deviating:
        return
    span = binder.span(("mass",))
    which = f"{len(deviating)} of {len(first)} bodies"
    if mode is MassMode.MESH:
        message = f"{which}: mesh and exact solid differ by more than {MASS_TOLERANCE:g}, or one of them is missing"
        binder.diagnostics.add("SB511", f"mass: {message}", span, notes=listed(deviating))
    else:
        used = "mesh's" if mode is MassMode.EXACT else "exact solid's"
        message = f"{which}: {used} mass properties used"
        binder.diagnostics.add("SB505", f"mass: {message}", span, notes=listed(deviating))


def report_massless(binder: Binder, bodies: Sequence[MeasuredBody], components: Collection[int]) -> None:
    """Report components without mass properties: expected for surfaces, an error for solids."""
    surfaces: dict[int, list[int]] = {}
    broken: dict[int, list[int]] = {}
    uncertain: dict[int, list[int]] = {}
    for index in sorted(components):
        number = binder.assembly.components[index].body
        if bodies[number].used is None:
            body = binder.assembly.bodies[number]
            group = uncertain if _is_unknown(body) else broken if body.kind is BodyKind.SOLID else surfaces
            group.setdefault(number, []).append(index)

    def report(code: str, group: Mapping[int, list[int]], one: str, several: str, help: str) -> None:
        if group:
            count = sum(map(len, group.values()))
            message = f"{binder.assembly.source}: {several.format(count) if count > 1 else one}"
            binder.diagnostics.add(code, message, binder.span(("links",)), help=[help], notes=_bodies(binder, group))

    given = "if one represents a heavy part, give its link an `inertial` with mass, com and inertia"
    report("SB506", surfaces, "one surface body has no mass", "{} surface bodies have no mass", given)
    repair = "repair them in the CAD, ignore them in `parts`, or give the link an `inertial` with com and inertia"
    unknown = "mass properties of one solid do not converge", "mass properties of {} solids do not converge"
    report("SB516", uncertain, *unknown, repair)
    report("SB507", broken, "one solid encloses no volume", "{} solids enclose no volume", repair)


def _bodies(binder: Binder, components: Mapping[int, list[int]]) -> tuple[str, ...]:
    """Bodies for the notes of a message: the first component of each, the number of others, and the cause."""
    notes = []
    for number, indices in components.items():
        more = f" and {len(indices) - 1} more like it" if len(indices) > 1 else ""
        defect = binder.assembly.bodies[number].defect
        notes.append(f"{binder.path(indices[0])}{more}" + (f": {defect}" if defect else ""))
    return listed(tuple(notes))


def _is_unknown(body: Body) -> bool:
    """Whether the exact mass properties of the body may be off by more than engineers would accept."""
    return body.exact is not None and body.exact_error > USABLE


def _measured(name: str, occurrences: int, body: Body, mesh: VolumeProperties | None, mode: MassMode) -> MeasuredBody:
    exact = body.exact
    deviation, quantity = mesh.deviation_from(exact) if mesh is not None and exact is not None else (None, "")
    used, written = None, body.defect or f"a {body.kind} has no volume"
    if exact is not None and CERTAIN < body.exact_error <= USABLE:
        used, written = exact, f"exact: accurate to {_shown(body.exact_error):.1%} only"
    elif not _is_unknown(body):
        if deviation is None:
            used, written = _only_one(exact, mesh, mode, body.defect) or (used, written)
        elif mode is MassMode.EXACT:
            used, written = exact, "exact"
        elif deviation <= MASS_TOLERANCE:
            used, written = mesh, "mesh"
        else:
            differs = f"differs by {deviation:.1e} in {quantity}"
            used, written = (mesh, f"mesh: {differs}") if mode is MassMode.MESH else (exact, f"exact: mesh {differs}")
    return MeasuredBody(
        name,
        occurrences,
        mesh=mesh.unit_density if mesh is not None else None,
        exact=exact.unit_density if exact is not None else None,
        deviation=deviation,
        error=_shown(body.exact_error) if exact is not None and body.exact_error else None,
        used=used.unit_density if used is not None else None,
        written=written,
    )


def _only_one(
    exact: VolumeProperties | None, mesh: VolumeProperties | None, mode: MassMode, defect: str
) -> tuple[VolumeProperties, str] | None:
    """The mass properties available if the solid or its mesh encloses no volume."""
    if exact is not None:
        return exact, "exact" if mode is MassMode.EXACT else f"exact: {defect or 'the mesh is not watertight'}"
    if mesh is not None:
        return mesh, "mesh" if mode is not MassMode.EXACT else "mesh: there is no exact solid"
    return None


def _shown(error: float) -> float:
    """One digit, rounded up: further digits differ between processors."""
    size = 10.0 ** floor(log10(error))
    return float(f"{ceil(error / size - 1e-6) * size:.0e}")
