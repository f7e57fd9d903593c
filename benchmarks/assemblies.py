"""Large assemblies, byte-identical each time: many definitions, many occurrences, many faces, many bytes."""

import math
from pathlib import Path

from msgspec import Struct

from .exchange import Exchange, Point, Product
from .solids import Plate, Relief

SIDECAR = """\
version: 1
robot: generated
step: {step}
defaults: {{density: 2700 kg/m^3}}
links:
  base: {{rest: true}}
frames:
  probe: {{link: base, origin: {{xyz: [0, 0, 0.001]}}}}
"""
_SPACING = 120.0
"""Distance between occurrences [mm], so that no two touch."""


class Assembly(Struct, frozen=True):
    """Plates, with ``definitions`` separate definitions, each placed ``occurrences`` times; or one relief."""

    definitions: int = 0
    occurrences: int = 1
    columns: int = 7
    rows: int = 2
    cells: int = 0

    @property
    def volume(self) -> float:
        """Volume of all occurrences [mm^3], in closed form."""
        if self.cells:
            return Relief(self.cells).volume
        return self.occurrences * sum(self._plate(number).volume for number in range(self.definitions))

    def write(self, path: Path) -> None:
        """Write it as a STEP file."""
        with path.open("w", encoding="ascii", newline="\n") as file:
            to = Exchange(file)
            if self.cells:
                to.part("relief", Relief(self.cells).write(to))
            else:
                self._write_plates(to)
            to.close()

    def _write_plates(self, to: Exchange) -> None:
        parts = []
        for number in range(self.definitions):
            name = f"plate{number:05d}"
            parts.append((name, to.part(name, self._plate(number).write(to))))
        side = math.ceil(math.sqrt(self.definitions * self.occurrences))
        placed: list[tuple[str, Product, Point]] = []
        for name, part in parts:
            for copy in range(self.occurrences):
                row, column = divmod(len(placed), side)
                placed.append((f"{name}:{copy + 1}", part, (_SPACING * column, _SPACING * row, 0.0)))
        to.assembly("assembly", placed)

    def _plate(self, number: int) -> Plate:
        length, width = 60.0 + number % 37, 50.0 + number % 23
        radius = round(0.3 * min(length / self.columns, width / self.rows), 3)
        return Plate(length, width, 3.0 + number % 7, self.columns, self.rows, radius)


ASSEMBLIES = {
    "definitions": Assembly(definitions=1000),
    "occurrences": Assembly(definitions=1, occurrences=10_000),
    "faces": Assembly(cells=100),
    "large": Assembly(definitions=1000, columns=14, rows=8),
}
"""By name: 1,000 definitions once each (30 MB), one definition 10,000 times, one solid of 20,005 faces, 200 MB."""


def generate(assembly: Assembly, folder: Path, name: str) -> Path:
    """Write ``NAME.step`` and a sidecar for it; returns the path of the sidecar."""
    folder.mkdir(parents=True, exist_ok=True)
    assembly.write(folder / f"{name}.step")
    sidecar = folder / f"{name}.robot.yaml"
    sidecar.write_text(SIDECAR.format(step=f"{name}.step"), encoding="utf-8", newline="\n")
    return sidecar
