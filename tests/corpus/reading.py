"""A file of the corpus, read by the kernel's process with measuring meshes."""

from pathlib import Path

from msgspec import Struct

from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.geometry.mass_properties import measured
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import Assembly, ReadOptions
from stepbot.step.reader import start_reading

ACCURACY = 1e-3
"""Relative deviation from exact up to which mass properties count as right."""
DEVIATIONS = "deviations of solids"
"""Property of a test's report: file, solid, deviation of the written and the measuring mesh, the chosen one."""


class ReadFile(Struct, frozen=True, eq=False):
    """The result of reading a file."""

    assembly: Assembly | None
    measures: tuple[VolumeProperties | None, ...]
    """Mass properties of the written meshes, by trimesh."""
    findings: tuple[Diagnostic, ...]


def read_file(step: Path) -> ReadFile:
    """Read a file in the kernel's own process."""
    diagnostics = Diagnostics()
    assembly = start_reading(step, ReadOptions(refine_mass_to=ACCURACY)).finish(diagnostics)
    measures = () if assembly is None else tuple(measured(body.mesh) for body in assembly.bodies)
    return ReadFile(assembly, measures, tuple(diagnostics))
