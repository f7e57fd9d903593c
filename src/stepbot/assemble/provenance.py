"""The sources of a robot's numbers and names, for its report."""

from collections import Counter
from collections.abc import Sequence
from math import ceil, floor, log10

from stepbot.geometry.volume import VolumeProperties
from stepbot.report.record import MeasuredBody
from stepbot.robot.model import Robot
from stepbot.sidecar.document import MassMode
from stepbot.step.assembly import Assembly

from .weigh import weigh


def measured_bodies(
    assembly: Assembly, measures: Sequence[VolumeProperties | None], mode: MassMode
) -> tuple[MeasuredBody, ...]:
    """Each body of the assembly, measured on its mesh and exactly; a body without volume has the reason.

    Args:
        assembly: The content of the STEP file.
        measures: trimesh's mass properties of the mesh of each of ``assembly.bodies``.
        mode: Which mass properties the sidecar selects.
    """
    occurrences = Counter(component.body for component in assembly.components)
    paths: dict[int, str] = {}
    for component in assembly.components:
        paths.setdefault(component.body, component.path)
    found = []
    for index, (body, weighing) in enumerate(zip(assembly.bodies, weigh(assembly, measures, mode), strict=True)):
        mesh = body.refined or measures[index]
        found.append(
            MeasuredBody(
                name=paths.get(index, ""),
                occurrences=occurrences[index],
                mesh=mesh.unit_density if mesh is not None else None,
                exact=body.exact.unit_density if body.exact is not None else None,
                deviation=mesh.deviation_from(body.exact)[0] if mesh is not None and body.exact is not None else None,
                error=_shown(body.exact_error) if body.exact is not None and body.exact_error else None,
                written=weighing.method or body.defect or f"a {body.kind} has no volume",
            )
        )
    return tuple(found)


def _shown(error: float) -> float:
    """One digit, rounded up: further digits differ between processors."""
    size = 10.0 ** floor(log10(error))
    return float(f"{ceil(error / size - 1e-6) * size:.0e}")


def emitted_names(robot: Robot) -> dict[str, str]:
    """For each mesh file, the component in the STEP that it was first made for."""
    return {asset.path: asset.source for asset in robot.meshes}
