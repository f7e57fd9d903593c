"""Parts of an assembly without a density, and suspicious densities in the STEP."""

from stepbot.step.assembly import Assembly, BodyKind

_SEVERAL = 4
"""Number of solids from which a common density is suspected to be a CAD program's default."""


def without_density(assembly: Assembly) -> tuple[str, ...]:
    """Materials of solids without a density in the STEP, unique and sorted; ``""`` for solids without a material."""
    return tuple(
        sorted({c.material for c in assembly.components if _has_volume(assembly, c.index) and c.density is None})
    )


def equal_density(assembly: Assembly) -> float:
    """Density [kg/m^3] shared by all of several solids; 0 if they differ, or are few."""
    densities = [c.density for c in assembly.components if _has_volume(assembly, c.index)]
    return (densities[0] or 0.0) if len(densities) >= _SEVERAL and len(set(densities)) == 1 else 0.0


def _has_volume(assembly: Assembly, index: int) -> bool:
    body = assembly.components[index].body
    kind = assembly.bodies[body].kind if body >= 0 else None
    return kind is BodyKind.SOLID or (kind is BodyKind.TESSELLATED and assembly.bodies[body].watertight)
