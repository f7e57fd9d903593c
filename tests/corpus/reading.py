"""A file of the corpus as the kernel's process reads it, measuring meshes and all."""

from dataclasses import dataclass
from pathlib import Path

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.geometry.mass_properties import measured
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.reader import start_reading

ACCURACY = 1e-3
"""Relative deviation from exact up to which mass properties are right."""
DEVIATIONS = "deviations of solids"
"""Property of a test's report: file, solid, deviation of the written and the measuring mesh, what is taken."""


@dataclass(frozen=True, eq=False)
class ReadFile:
    """What came of reading a file."""

    assembly: Assembly | None
    measures: tuple[VolumeProperties | None, ...]
    """By trimesh, of the written meshes."""
    findings: tuple[Diagnostic, ...]


def read_file(step: Path) -> ReadFile:
    """Read a file in the kernel's own process."""
    found = Diagnostics()
    assembly = start_reading(step, ReadOptions(refine_mass_to=ACCURACY)).finish(found)
    measures = () if assembly is None else tuple(measured(body.mesh) for body in assembly.bodies)
    return ReadFile(assembly, measures, tuple(found))
