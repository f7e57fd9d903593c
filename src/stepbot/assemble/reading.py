"""Options of the STEP reader set by the sidecar: mesh tolerances, and whether mass is measured on finer meshes."""

from stepbot.sidecar.document import Document, MassMode, MeshSection
from stepbot.step.assembly import MeshTolerance, ReadOptions

MASS_TOLERANCE = 1e-3
"""Relative deviation from the exact mass properties up to which a mesh counts as equal."""


def read_options(document: Document) -> ReadOptions:
    """Options for reading the sidecar's STEP; a link's own tolerance applies to its parts.

    If a link has its own, the paths of all links count: a part of one link may be inside a subassembly of another.
    """
    common = _tolerance(document.mesh, MeshTolerance())
    links = [(link, common if link.mesh is None else _tolerance(link.mesh, common)) for link in document.links.values()]
    is_own = any(tolerance != common for _, tolerance in links)
    return ReadOptions(
        tolerance=next((tolerance for link, tolerance in links if link.rest), common),
        tolerance_of=tuple((path, tolerance) for link, tolerance in links for path in link.parts) if is_own else (),
        encoding=document.step_encoding or "",
        refine_mass_to=MASS_TOLERANCE if document.mass == MassMode.MESH else 0.0,
    )


def _tolerance(section: MeshSection, inherited: MeshTolerance) -> MeshTolerance:
    relative, absolute = inherited.relative, inherited.absolute
    if section.tolerance is not None:
        relative, absolute = section.tolerance
    angle = inherited.angle if section.angle is None else section.angle
    return MeshTolerance(relative, absolute, angle)
