"""The table of diagnostic codes, one module per range.

SB0xx files and environment, SB1xx sidecar syntax and schema, SB2xx STEP, SB3xx component paths, SB4xx kinematics,
SB5xx mass and inertia, SB6xx meshes, SB7xx format limitations, SB8xx verification in engines, SB9xx internal errors.
A code is never renumbered or reused.
"""

from . import (
    assembly,
    binding,
    environment,
    formats,
    internal,
    kinematics,
    mass,
    mechanism,
    meshes,
    packages,
    revisions,
    self_collision,
    sidecar,
    simulators,
    sources,
)
from .code import Code, Severity

CODES: dict[str, Code] = {
    code.id: code
    for module in (
        environment,
        sidecar,
        assembly,
        binding,
        revisions,
        kinematics,
        mechanism,
        mass,
        meshes,
        self_collision,
        packages,
        formats,
        simulators,
        sources,
        internal,
    )
    for code in module.CODES
}

RETIRED = frozenset({"SB307"})
"""Codes of earlier versions, which are not reused."""

__all__ = ["CODES", "RETIRED", "Code", "Severity"]
