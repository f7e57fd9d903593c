"""Selects the volume, centre of mass and inertia of each body: the mesh's, by trimesh, or the exact solid's.

``auto`` uses the mesh if it agrees with the solid within a thousandth, else the exact value; ``mesh`` uses the finest
mesh available; ``exact`` uses the solid. If only one of them encloses a volume, that one is used. A solid on which no
two integration methods agree is not used.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.document import MassMode
from stepbot.step.assembly import CERTAIN, Assembly, Body, BodyKind

from .binder import Binder, listed
from .reading import MASS_TOLERANCE


@dataclass(frozen=True)
class Weighing:
    """Volume properties of a body, and their source."""

    properties: VolumeProperties | None
    """None if the body encloses no volume."""
    method: str = ""
    """``mesh`` or ``exact``, with the reason if it differs from the requested one."""
    deviation: float = 0.0
    """Largest relative deviation of the mesh from the exact solid; 0 if one of them is missing."""


def weigh(assembly: Assembly, measures: Sequence[VolumeProperties | None], mode: MassMode) -> tuple[Weighing, ...]:
    """Volume properties of each body; ``measures`` are trimesh's, of the written meshes."""
    return tuple(_weigh(body, measure, mode) for body, measure in zip(assembly.bodies, measures, strict=True))


def report_weighing(binder: Binder, weighings: Sequence[Weighing], components: Collection[int]) -> None:
    """Report the robot's components whose mass properties are not the mesh's, and why."""
    first: dict[int, int] = {}
    for index in sorted(components):
        first.setdefault(binder.assembly.components[index].body, index)
    mode = binder.document.mass
    deviating = tuple(
        f"{binder.path(index)}: {weighings[body].method}"
        for body, index in first.items()
        if weighings[body].properties is not None and ":" in weighings[body].method
    )
    if not deviating:
        return
    span = binder.span(("mass",))
    bodies = f"{len(deviating)} of {len(first)} bodies"
    if mode is MassMode.MESH:
        message = f"{bodies}: mesh and exact solid differ by more than {MASS_TOLERANCE:g}, or one of them is missing"
        binder.found.add("SB511", f"mass: {message}", span, notes=listed(deviating))
    else:
        used = "mesh's" if mode is MassMode.EXACT else "exact solid's"
        message = f"{bodies}: {used} mass properties used"
        binder.found.add("SB505", f"mass: {message}", span, notes=listed(deviating))


def report_weightless(binder: Binder, weighings: Sequence[Weighing], components: Collection[int]) -> None:
    """Report components without mass properties: expected for surfaces, an error for solids."""
    surfaces: dict[int, list[int]] = {}
    broken: dict[int, list[int]] = {}
    uncertain: dict[int, list[int]] = {}
    for index in sorted(components):
        number = binder.assembly.components[index].body
        if weighings[number].properties is None:
            body = binder.assembly.bodies[number]
            group = uncertain if _is_uncertain(body) else broken if body.kind is BodyKind.SOLID else surfaces
            group.setdefault(number, []).append(index)
    source, span = binder.assembly.source, binder.span(("links",))
    if surfaces:
        count = sum(map(len, surfaces.values()))
        what = f"{count} surface bodies have" if count > 1 else "one surface body has"
        binder.found.add(
            "SB506",
            f"{source}: {what} no mass",
            span,
            help=("if one represents a heavy part, give its link an `inertial` with mass, com and inertia",),
            notes=_bodies(binder, surfaces),
        )
    if uncertain:
        count = sum(map(len, uncertain.values()))
        what = f"mass properties of {count} solids do" if count > 1 else "mass properties of one solid do"
        binder.found.add(
            "SB516",
            f"{source}: {what} not converge",
            span,
            help=(
                "repair them in the CAD, ignore them in `parts`, or give the link an `inertial` with com and inertia",
            ),
            notes=_bodies(binder, uncertain),
        )
    if broken:
        count = sum(map(len, broken.values()))
        what = f"{count} solids enclose" if count > 1 else "one solid encloses"
        binder.found.add(
            "SB507",
            f"{source}: {what} no volume",
            span,
            help=(
                "repair them in the CAD, ignore them in `parts`, or give the link an `inertial` with com and inertia",
            ),
            notes=_bodies(binder, broken),
        )


def _bodies(binder: Binder, components: Mapping[int, list[int]]) -> tuple[str, ...]:
    """Bodies for the notes of a message: the first component of each, the number of others, and the cause."""
    notes = []
    for number, indices in components.items():
        more = f" and {len(indices) - 1} more like it" if len(indices) > 1 else ""
        defect = binder.assembly.bodies[number].defect
        notes.append(f"{binder.path(indices[0])}{more}" + (f": {defect}" if defect else ""))
    return listed(tuple(notes))


def _is_uncertain(body: Body) -> bool:
    """Whether the body has unconfirmed exact mass properties."""
    return body.exact is not None and body.exact_error > CERTAIN


def _weigh(body: Body, measure: VolumeProperties | None, mode: MassMode) -> Weighing:
    if _is_uncertain(body):
        return Weighing(None)
    exact = body.exact
    mesh = body.refined or measure if mode is MassMode.MESH else measure
    if exact is None or mesh is None:
        return _only_one(exact, mesh, mode, body.defect)
    worst, quantity = mesh.deviation_from(exact)
    differs = f"differs by {worst:.1e} in {quantity}"
    if mode is MassMode.EXACT:
        return Weighing(exact, "exact", worst)
    if mode is MassMode.MESH:
        return Weighing(mesh, "mesh" if worst <= MASS_TOLERANCE else f"mesh: {differs}", worst)
    return (
        Weighing(mesh, "mesh", worst) if worst <= MASS_TOLERANCE else Weighing(exact, f"exact: mesh {differs}", worst)
    )


def _only_one(exact: VolumeProperties | None, mesh: VolumeProperties | None, mode: MassMode, defect: str) -> Weighing:
    """The mass properties available if the solid or its mesh encloses no volume."""
    if exact is not None:
        return Weighing(
            exact, "exact" if mode is MassMode.EXACT else f"exact: {defect or 'the mesh is not watertight'}"
        )
    if mesh is not None:
        return Weighing(mesh, "mesh" if mode is not MassMode.EXACT else "mesh: there is no exact solid")
    return Weighing(None)
