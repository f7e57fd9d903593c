"""The document's definitions: the content of each product, independent of its occurrences.

A definition is an assembly of other definitions, or a part with bodies. A part is split into its solids, its shells and
the remaining loose faces; curves and points count only if there is nothing else.
"""

from collections.abc import Iterator
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.collections import Sequence_TDF_Label
from OCP.TCollection import TCollection_AsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_Tool
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS_Compound, TopoDS_Iterator
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from ..exchange.length_unit import DEFAULT_PRECISION
from ..kernel import matrix_of
from .colors import Colors
from .products import Products
from .source import NONE, BodySource, Child, Definition

_GROUPS = (TopAbs_ShapeEnum.TopAbs_COMPOUND, TopAbs_ShapeEnum.TopAbs_COMPSOLID)
_ENCLOSED = (TopAbs_ShapeEnum.TopAbs_SOLID, TopAbs_ShapeEnum.TopAbs_SHELL)


class Definitions:
    """All definitions of a document, each once, and the roots among them."""

    def __init__(self, document: Any, products: Products) -> None:
        self._products = products
        self._shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._colors = Colors(document)
        self._index: dict[str, int] = {}
        self.all: list[Definition] = []
        self.color_errors = self._colors.errors
        self.roots = [self._read(label, DEFAULT_PRECISION) for label in _listed(self._shapes.GetFreeShapes)]

    def _read(self, label: Any, precision: float) -> int:
        """Index of a label's definition, read with everything below it if it is new.

        Args:
            label: A label of the document.
            precision: Uncertainty [mm] of the product above, for definitions that are not products.
        """
        entry = TCollection_AsciiString()
        TDF_Tool.Entry_s(label, entry)
        key = entry.ToCString()
        if key in self._index:
            return self._index[key]
        product = self._products.product_of(_name(label))
        name = ""
        if product != NONE:
            name, precision = self._products.products[product].name, self._products.products[product].precision
        definition = Definition(product, name, self._colors.of_label(label))
        index = self._index[key] = len(self.all)
        self.all.append(definition)
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            self._read_children(label, definition, precision)
        else:
            self._read_bodies(label, definition, precision)
        return index

    def _read_children(self, label: Any, definition: Definition, precision: float) -> None:
        components = _listed(lambda found: XCAFDoc_ShapeTool.GetComponents_s(label, found, False))
        below = []
        for component in components:
            referred = TDF_Label()
            XCAFDoc_ShapeTool.GetReferredShape_s(component, referred)
            below.append(self._read(referred, precision))
        products = [self.all[index].product for index in below]
        found = self._products.occurrences_of(definition.product, products, [_name(label) for label in components])
        children: list[tuple[int, Child]] = []
        for index, occurrence, component in zip(below, found, components, strict=True):
            matrix = matrix_of(XCAFDoc_ShapeTool.GetLocation_s(component).Transformation())
            color = self._colors.of_label(component)
            children.append((occurrence, Child(index, self._products.name_of(occurrence), matrix, color, occurrence)))
            for other, place in self._products.repeated(occurrence, matrix):
                children.append((other, Child(index, self._products.name_of(other), place, None, other)))
        # In file order; bodies beside components, which the kernel created, come last.
        children.sort(key=lambda numbered: (numbered[0] == NONE, numbered[0]))
        definition.children = [child for _, child in children]

    def _read_bodies(self, label: Any, definition: Definition, precision: float) -> None:
        shapes, wires = _taken_apart(XCAFDoc_ShapeTool.GetShape_s(label))
        is_wire = not shapes
        shapes = shapes or wires
        styles = self._colors.of_parts(label, shapes)
        definition.bodies = [
            BodySource(shape, precision, color, faces, is_wire)
            for shape, (color, faces) in zip(shapes, styles, strict=True)
        ]
        definition.has_spare_curves = bool(wires) and not is_wire


def _taken_apart(shape: Any) -> tuple[list[Any], list[Any]]:
    """The bodies of a shape in file order, and its loose curves and points, as at most one shape."""
    bodies: list[Any] = []
    faces: list[Any] = []
    curves: list[Any] = []
    for piece in _pieces(shape):
        if piece.ShapeType() in _ENCLOSED:
            bodies.append(piece)
        elif piece.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE:
            faces.append(piece)
        else:
            curves.append(piece)
    return bodies + ([_joined(faces)] if faces else []), [_joined(curves)] if curves else []


def _pieces(shape: Any) -> Iterator[Any]:
    if shape is None or shape.IsNull():
        return
    if shape.ShapeType() not in _GROUPS:
        yield shape
        return
    inside = TopoDS_Iterator(shape)
    while inside.More():
        yield from _pieces(inside.Value())
        inside.Next()


def _joined(shapes: list[Any]) -> Any:
    if len(shapes) == 1:
        return shapes[0]
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def _listed(fill: Any) -> list[Any]:
    labels = Sequence_TDF_Label()
    fill(labels)
    return [labels.Value(index) for index in range(1, labels.Length() + 1)]


def _name(label: Any) -> str:
    """The kernel's name of a label; empty if it has none, as shapes created by the kernel may."""
    if not label.IsAttribute(TDataStd_Name.GetID_s()):  # accessing a missing attribute ends the process
        return ""
    name = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return str(name.Get().ToExtString())
