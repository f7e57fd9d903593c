"""Which parts of an assembly have no density, and whether the densities that are there look made up."""

from stepbot.step.assembly import Assembly, BodyKind

_SEVERAL = 4
"""Solids from which one density for all of them looks like a CAD program's default."""


def without_density(assembly: Assembly) -> tuple[str, ...]:
    """Materials of solids that have no density in the STEP, each once, sorted; ``""`` for solids without a material."""
    return tuple(
        sorted({c.material for c in assembly.components if _has_volume(assembly, c.index) and c.density <= 0.0})
    )


def equal_density(assembly: Assembly) -> float:
    """Density [kg/m^3] that all of several solids have; 0 where they differ, or are few."""
    densities = [c.density for c in assembly.components if _has_volume(assembly, c.index)]
    return densities[0] if len(densities) >= _SEVERAL and len(set(densities)) == 1 else 0.0


def _has_volume(assembly: Assembly, index: int) -> bool:
    body = assembly.components[index].body
    kind = assembly.bodies[body].kind if body >= 0 else None
    return kind is BodyKind.SOLID or (kind is BodyKind.TESSELLATED and assembly.bodies[body].watertight)
