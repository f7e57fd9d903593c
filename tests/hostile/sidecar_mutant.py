"""A mutant of a sidecar, and the valid ones that mutants are made of: those of the robot library."""

import pickle
import shutil
from collections.abc import Sequence
from functools import cache
from itertools import cycle, product
from pathlib import Path
from random import Random

from msgspec import Struct

from stepbot.assemble.masses import read_options
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mass_properties import measured
from stepbot.geometry.volume import VolumeProperties
from stepbot.sidecar.load import load_sidecar
from stepbot.step.assembly import Assembly
from stepbot.step.reader import start_reading
from tests.conftest import ROOT

from .sidecar_damage import KINDS, damaged
from .sidecar_tree import Table, read_tree

LIBRARY = ROOT / "robot_library"
SMALL = ("stepbot_arm2", "stepbot_four_bar")
"""Robots of the short form: quickly read, and together with most of the keys."""
Measured = tuple[Assembly, tuple[VolumeProperties | None, ...]]
_SIDECAR = "base.robot.yaml"
_ASSEMBLY = "assembly.pickle"


class SidecarMutant(Struct, frozen=True):
    """The origin of a damaged sidecar."""

    base: str
    """Folder of the valid one in the library."""
    kind: str
    """One of :data:`.sidecar_damage.KINDS`."""
    seed: int
    number: int

    @property
    def name(self) -> str:
        """``base:kind:seed:number``."""
        return f"{self.base}:{self.kind}:{self.seed}:{self.number}"

    @staticmethod
    def named(name: str) -> "SidecarMutant":
        """The mutant of a name."""
        base, kind, seed, number = name.split(":")
        return SidecarMutant(base, kind, int(seed), int(number))

    def content(self, bases: Path) -> bytes:
        """The damaged file; the bytes are deterministic."""
        return damaged(_tree(bases / self.base), self.kind, Random(self.name))


def plan(bases: Sequence[str], count: int, seed: int) -> list[SidecarMutant]:
    """``count`` mutants in which every pair of base and kind is equally frequent, in an order given by the seed."""
    pairs = list(product(bases, KINDS))
    Random(seed).shuffle(pairs)
    return [SidecarMutant(*pair, seed, number) for number, pair in zip(range(count), cycle(pairs), strict=False)]


def collect(names: Sequence[str], folder: Path) -> None:
    """Put valid sidecars into separate folders, each with its assembly as read by the kernel."""
    for name in names:
        place = folder / name
        place.mkdir(parents=True)
        (source,) = (LIBRARY / name).glob("*.robot.yaml")
        shutil.copyfile(source, place / _SIDECAR)
        diagnostics = Diagnostics()
        sidecar = load_sidecar(source, diagnostics)
        assert sidecar is not None, list(map(str, diagnostics))
        assembly = start_reading(sidecar.step_path, read_options(sidecar.document)).finish(diagnostics)
        assert assembly is not None, list(map(str, diagnostics))
        measures = tuple(measured(body.mesh) for body in assembly.bodies)
        (place / _ASSEMBLY).write_bytes(pickle.dumps((assembly, measures)))


@cache
def assembly_of(base: Path) -> Measured:
    """The assembly of a valid sidecar, and trimesh's measures of its bodies."""
    loaded: Measured = pickle.loads((base / _ASSEMBLY).read_bytes())
    return loaded


@cache
def _tree(base: Path) -> Table:
    return read_tree(base / _SIDECAR)
