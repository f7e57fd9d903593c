"""Assemblies as CAD programs export them with "external references": the structure in one file, each part in its own.

The files follow the CAx-IF recommended practices for external references: a product without a shape, a DOCUMENT_FILE
with the other file's name, and an APPLIED_DOCUMENT_REFERENCE between them.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from msgspec import Struct

from robot_library.moments import Array, pose
from robot_library.step_file import Assembly, LengthUnit, Occurrence, Part, write_step

_UNITS: dict[LengthUnit, tuple[float, str]] = {
    "mm": (1.0, "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"),
    "cm": (10.0, "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.))"),
    "m": (1000.0, "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))"),
}
"""Millimetres per unit, and the unit's entity, for the files with the structure."""


class Component(Struct, frozen=True):
    """A product with its pose, in a file with the structure alone."""

    product: str
    file: str
    """The file name in the reference."""
    occurrence: str = ""
    X_AP: Array | None = None
    """Pose of the product in the assembly, shape (4, 4) [mm]; None for the identity."""
    folder: str = ""
    """The file location in the reference."""


def write_separately(
    folder: Path, root: Assembly, units: Mapping[str, LengthUnit] | None = None, suffix: str = ".step"
) -> Path:
    """Write each product of a tree into a separate file, named after it; returns the path of the first one.

    Args:
        folder: Existing folder for the files.
        root: The tree.
        units: Unit of the file of each product; millimetres by default.
        suffix: Suffix of the files.
    """
    units = units or {}
    written: set[int] = set()
    pending: list[Part | Assembly] = [root]
    while pending:
        product = pending.pop()
        if id(product) in written:
            continue
        written.add(id(product))
        path, unit = folder / f"{product.name}{suffix}", units.get(product.name, "mm")
        if isinstance(product, Part):
            write_step(path, product, unit=unit)
            continue
        pending += [child.product for child in product.children]
        components = [_component(child, suffix) for child in product.children]
        write_structure(path, product.name, components, unit)
    return folder / f"{root.name}{suffix}"


def _component(child: Occurrence, suffix: str) -> Component:
    return Component(child.product.name, f"{child.product.name}{suffix}", child.name, child.X_AP)


def write_structure(path: Path, name: str, components: Sequence[Component], unit: LengthUnit = "mm") -> Path:
    """Write a file that places products whose shapes are in other files; equal names and files are one product."""
    text = _Text(*_UNITS[unit])
    own = text.product(name)
    products: dict[tuple[str, str, str], tuple[int, int, int]] = {}
    for index, component in enumerate(components):
        key = (component.product, component.folder, component.file)
        if key not in products:
            products[key] = text.product(component.product)
            text.document(products[key][0], component.file, component.folder)
        text.place(own, products[key], component, index)
    text.save(path)
    return path


class _Text:
    """Statements of a STEP file, in millimetres unless stated otherwise."""

    def __init__(self, millimetres: float, length_unit: str) -> None:
        self._millimetres = millimetres
        self._statements: list[str] = []
        self._items: dict[int, list[int]] = {}
        self._application = self.add("APPLICATION_CONTEXT('automotive design')")
        self._product_context = self.add(f"PRODUCT_CONTEXT('',#{self._application},'mechanical')")
        self._definition_context = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{self._application},'')")
        length = self.add(length_unit)
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid_angle = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        self._context = self.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))REPRESENTATION_CONTEXT('',''))"
        )
        self._document_type = self.add("DOCUMENT_TYPE('geometry')")
        self._role = self.add("IDENTIFICATION_ROLE('external document id and location',$)")

    def add(self, statement: str) -> int:
        self._statements.append(statement)
        return len(self._statements)

    def product(self, name: str) -> tuple[int, int, int]:
        """Product definition, number of its shape representation, and one of its items."""
        product = self.add(f"PRODUCT('{_quoted(name)}','{_quoted(name)}','',(#{self._product_context}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
        definition = self.add(f"PRODUCT_DEFINITION('design','',#{formation},#{self._definition_context})")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        origin = self.placement(pose())
        representation = self.add("")
        self._items[representation] = [origin]
        self.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
        return definition, representation, origin

    def placement(self, X: Array) -> int:
        x, y, z = (float(value) / self._millimetres for value in X[:3, 3])
        point = self.add(f"CARTESIAN_POINT('',({x!r},{y!r},{z!r}))")
        axis, ref = (self.add("DIRECTION('',({!r},{!r},{!r}))".format(*map(float, X[:3, column]))) for column in (2, 0))
        return self.add(f"AXIS2_PLACEMENT_3D('',#{point},#{axis},#{ref})")

    def document(self, definition: int, file: str, folder: str) -> None:
        document = self.add(f"DOCUMENT_FILE('{_quoted(file)}','','',#{self._document_type},'',$)")
        self.add(f"APPLIED_DOCUMENT_REFERENCE(#{document},'',(#{definition}))")
        source = self.add(f"EXTERNAL_SOURCE(IDENTIFIER('{_quoted(folder)}'))")
        self.add(f"APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{_quoted(file)}',#{self._role},#{source},(#{document}))")
        self.add(f"DOCUMENT_REPRESENTATION_TYPE('digital',#{document})")
        item = self.add("DESCRIPTIVE_REPRESENTATION_ITEM('STEP AP214','')")
        context = self.add("REPRESENTATION_CONTEXT('','')")
        representation = self.add(f"REPRESENTATION('document format',(#{item}),#{context})")
        property_definition = self.add(f"PROPERTY_DEFINITION('external definition','',#{document})")
        self.add(f"PROPERTY_DEFINITION_REPRESENTATION(#{property_definition},#{representation})")

    def place(self, above: tuple[int, int, int], below: tuple[int, int, int], component: Component, index: int) -> None:
        target = self.placement(component.X_AP if component.X_AP is not None else pose())
        self._items[above[1]].append(target)
        name = _quoted(component.occurrence)
        usage = self.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{index}','{name}','{name}',#{above[0]},#{below[0]},$)")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{usage})")
        motion = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',#{below[2]},#{target})")
        relation = self.add(
            f"(REPRESENTATION_RELATIONSHIP('','',#{below[1]},#{above[1]})"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{motion})SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})")

    def save(self, path: Path) -> None:
        for representation, items in self._items.items():
            listed = ",".join(f"#{item}" for item in items)
            self._statements[representation - 1] = f"SHAPE_REPRESENTATION('',({listed}),#{self._context})"
        statements = "".join(f"#{i}={statement};\n" for i, statement in enumerate(self._statements, start=1))
        header = (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            "FILE_NAME('','2000-01-01T00:00:00',(''),(''),'','','');\n"
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
        )
        path.write_text(f"{header}{statements}ENDSEC;\nEND-ISO-10303-21;\n", encoding="utf-8", newline="\n")


def _quoted(text: str) -> str:
    return text.replace("\\", "\\\\").replace("'", "''")
