"""Adds validation properties to STEP files: volumes, areas and centroids, as a CAD program states them."""

import re
from collections.abc import Sequence
from pathlib import Path

from stepbot.step.assembly import Quantity

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
_PREFIX = {"mm": ".MILLI.", "cm": ".CENTI.", "m": "$"}
_MEASURES = {
    Quantity.VOLUME: ("volume", "volume measure", "VOLUME_MEASURE", 3),
    Quantity.AREA: ("surface area", "surface area measure", "AREA_MEASURE", 2),
}


class StepEditor:
    """A STEP file with added statements."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._text = path.read_text(encoding="utf-8")
        self._next = max(map(int, re.findall(r"^#(\d+)", self._text, re.MULTILINE))) + 1
        self._added: list[str] = []

    def find(self, pattern: str) -> int:
        """Number of the only statement that matches."""
        (number,) = re.findall(rf"^#(\d+)\s*=\s*{pattern}", self._text, re.MULTILINE)
        return int(number)

    def definition(self, product: str) -> int:
        """Product definition of a product."""
        number = self.find(rf"PRODUCT\('{product}'")
        formation = self.find(rf"PRODUCT_DEFINITION_FORMATION\('[^']*','[^']*',#{number}\)")
        return self.find(rf"PRODUCT_DEFINITION\('[^']*','[^']*',#{formation},")

    def shape(self, definition: int) -> int:
        """Shape of a product definition, or of an occurrence."""
        return self.find(rf"PRODUCT_DEFINITION_SHAPE\('[^']*','[^']*',#{definition}\)")

    def representation(self, definition: int) -> int:
        """Shape representation of a product definition."""
        pattern = rf"SHAPE_DEFINITION_REPRESENTATION\(#{self.shape(definition)},#(\d+)\)"
        (number,) = re.findall(pattern, self._text)
        return int(number)

    def context(self, representation: int) -> int:
        """Context of a representation."""
        (number,) = re.findall(rf"^#{representation}\s*=.*#(\d+)\);", self._text, re.MULTILINE)
        return int(number)

    def add(self, statement: str) -> int:
        """Add a statement; returns its number."""
        self._added.append(f"#{self._next}={statement};")
        self._next += 1
        return self._next - 1

    def measure(self, subject: int, quantity: Quantity, value: float, unit: str = "mm", power: int = 0) -> None:
        """State a volume or an area of a subject."""
        name, item, kind, exponent = _MEASURES[quantity]
        length = self.add(f"(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT({_PREFIX[unit]},.METRE.))")
        element = self.add(f"DERIVED_UNIT_ELEMENT(#{length},{power or exponent}.)")
        derived = self.add(f"DERIVED_UNIT((#{element}))")
        measure = self.add(f"MEASURE_REPRESENTATION_ITEM('{item}',{kind}({value!r}),#{derived})")
        self._relate(subject, name, measure, self._any_context())

    def centroid(self, subject: int, point: Sequence[float], context: int) -> None:
        """State the centroid of a subject, in the length unit of a context."""
        coordinates = ",".join(repr(float(value)) for value in point)
        self._relate(subject, "centroid", self.add(f"CARTESIAN_POINT('centre point',({coordinates}))"), context)

    def write(self) -> Path:
        """Write the file with all added statements."""
        end = self._text.rindex("ENDSEC;")
        text = self._text[:end] + "\n".join(self._added) + "\n" + self._text[end:]
        self.path.write_text(text, encoding="utf-8", newline="\n")
        return self.path

    def _any_context(self) -> int:
        return int(re.findall(r"^#(\d+)\s*=\s*\(\s*GEOMETRIC_REPRESENTATION_CONTEXT", self._text, re.MULTILINE)[0])

    def _relate(self, subject: int, name: str, item: int, context: int) -> None:
        definition = self.add(f"PROPERTY_DEFINITION('geometric validation property','{name}',#{subject})")
        representation = self.add(f"REPRESENTATION('{name}',(#{item}),#{context})")
        self.add(f"PROPERTY_DEFINITION_REPRESENTATION(#{definition},#{representation})")
