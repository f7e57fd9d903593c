"""Writes STEP files (ISO 10303-21, AP214) statement by statement, so that large files need little memory."""

from collections.abc import Iterable, Sequence
from typing import TextIO

from msgspec import Struct

Point = tuple[float, float, float]

_HEADER = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('generated'),'2;1');
FILE_NAME('generated.step','2000-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""
X: Point = (1.0, 0.0, 0.0)
Z: Point = (0.0, 0.0, 1.0)


class Product(Struct, frozen=True):
    """Statements of a product that occurrences refer to."""

    definition: int
    shape: int
    """Its representation."""
    axes: int
    """The placement of its shape."""


class Exchange:
    """A STEP file in millimetres that is being written."""

    def __init__(self, file: TextIO) -> None:
        self._file, self._last = file, 0
        file.write(_HEADER)
        application = self.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})")
        self._product_context = self.add(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
        self._design = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')")
        length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        accuracy = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#{length},'distance_accuracy_value','')"
        )
        self._context = self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{accuracy}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT({_list((length, angle, solid))})REPRESENTATION_CONTEXT('',''))"
        )

    def add(self, text: str) -> int:
        """Write a statement; returns its number."""
        self._last += 1
        self._file.write(f"#{self._last}={text};\n")
        return self._last

    def close(self) -> None:
        """Write the end; the file itself stays open."""
        self._file.write("ENDSEC;\nEND-ISO-10303-21;\n")

    def part(self, name: str, solid: int) -> Product:
        """A product with one ``MANIFOLD_SOLID_BREP``."""
        axes = self.placement((0.0, 0.0, 0.0))
        shape = self.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('{name}',{_list((axes, solid))},#{self._context})")
        return self._product(name, shape, axes)

    def assembly(self, name: str, occurrences: Sequence[tuple[str, Product, Point]]) -> Product:
        """A product made of others: name, product and position [mm] of each occurrence."""
        axes = self.placement((0.0, 0.0, 0.0))
        places = [self.placement(position) for _, _, position in occurrences]
        shape = self.add(f"SHAPE_REPRESENTATION('{name}',{_list((axes, *places))},#{self._context})")
        made = self._product(name, shape, axes)
        for (label, child, _), place in zip(occurrences, places, strict=True):
            self._occurrence(label, made, child, place)
        return made

    def _occurrence(self, label: str, parent: Product, child: Product, place: int) -> None:
        use = self.add(
            f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{label}','{label}','',#{parent.definition},#{child.definition},$)"
        )
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{use})")
        moved = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',#{child.axes},#{place})")
        relation = self.add(
            f"(REPRESENTATION_RELATIONSHIP('','',#{child.shape},#{parent.shape})"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})")

    def _product(self, name: str, shape: int, axes: int) -> Product:
        product = self.add(f"PRODUCT('{name}','{name}','',(#{self._product_context}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
        definition = self.add(f"PRODUCT_DEFINITION('design','',#{formation},#{self._design})")
        own = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION(#{own},#{shape})")
        return Product(definition, shape, axes)

    def point(self, p: Point) -> int:
        """A point [mm]."""
        return self.add(f"CARTESIAN_POINT('',{_numbers(p)})")

    def direction(self, p: Point) -> int:
        """A direction; its length does not matter."""
        return self.add(f"DIRECTION('',{_numbers(p)})")

    def placement(self, p: Point, z: Point = Z, x: Point = X) -> int:
        """A right-handed frame."""
        return self.add(f"AXIS2_PLACEMENT_3D('',#{self.point(p)},#{self.direction(z)},#{self.direction(x)})")

    def vertex(self, p: Point) -> int:
        """A corner."""
        return self.add(f"VERTEX_POINT('',#{self.point(p)})")

    def line(self, start: tuple[int, Point], end: tuple[int, Point]) -> int:
        """A straight edge between two vertices."""
        (v1, a), (v2, b) = start, end
        along = self.add(f"VECTOR('',#{self.direction((b[0] - a[0], b[1] - a[1], b[2] - a[2]))},1.)")
        curve = self.add(f"LINE('',#{self.point(a)},#{along})")
        return self.add(f"EDGE_CURVE('',#{v1},#{v2},#{curve},.T.)")

    def circle(self, vertex: int, center: Point, radius: float) -> int:
        """A closed edge in a horizontal plane, anticlockwise, from a vertex along x."""
        curve = self.add(f"CIRCLE('',#{self.placement(center)},{_number(radius)})")
        return self.add(f"EDGE_CURVE('',#{vertex},#{vertex},#{curve},.T.)")

    def loop(self, edges: Iterable[tuple[int, bool]], *, is_outer: bool) -> int:
        """A bound of a face: edges, each with whether it is traversed in its own direction."""
        oriented = [self.add(f"ORIENTED_EDGE('',*,*,#{edge},{_truth(forward)})") for edge, forward in edges]
        loop = self.add(f"EDGE_LOOP('',{_list(oriented)})")
        return self.add(f"{'FACE_OUTER_BOUND' if is_outer else 'FACE_BOUND'}('',#{loop},.T.)")

    def plane(self, bounds: Sequence[int], p: Point, normal: Point, x: Point) -> int:
        """A plane face; ``x`` is a direction in it."""
        surface = self.add(f"PLANE('',#{self.placement(p, normal, x)})")
        return self.add(f"ADVANCED_FACE('',{_list(bounds)},#{surface},.T.)")

    def bore(self, bounds: Sequence[int], p: Point, radius: float) -> int:
        """The inner face of a vertical cylinder."""
        surface = self.add(f"CYLINDRICAL_SURFACE('',#{self.placement(p)},{_number(radius)})")
        return self.add(f"ADVANCED_FACE('',{_list(bounds)},#{surface},.F.)")

    def solid(self, faces: Sequence[int]) -> int:
        """A solid bounded by faces."""
        shell = self.add(f"CLOSED_SHELL('',{_list(faces)})")
        return self.add(f"MANIFOLD_SOLID_BREP('',#{shell})")


def _list(numbers: Iterable[int]) -> str:
    return "(" + ",".join(f"#{number}" for number in numbers) + ")"


def _numbers(p: Point) -> str:
    return "(" + ",".join(map(_number, p)) + ")"


def _number(value: float) -> str:
    return f"{value:.6f}".rstrip("0")


def _truth(value: bool) -> str:
    return ".T." if value else ".F."
