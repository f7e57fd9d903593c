"""The table of diagnostic codes, one module per range.

SB0xx files and environment, SB1xx sidecar text and schema, SB2xx STEP, SB3xx binding the sidecar to the assembly,
SB4xx kinematics, SB5xx mass and inertia, SB6xx meshes, SB7xx what a format cannot say, SB8xx a simulator disagrees,
SB9xx our own faults. A code is never renumbered and never used again for something else.
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
    sidecar,
    simulators,
)
from .code import Code, Severity

CODES: dict[str, Code] = {
    code.id: code
    for module in (
        environment,
        sidecar,
        assembly,
        binding,
        kinematics,
        mechanism,
        mass,
        meshes,
        formats,
        simulators,
        internal,
    )
    for code in module.CODES
}

__all__ = ["CODES", "Code", "Severity"]
