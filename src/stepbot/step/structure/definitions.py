"""The document's definitions: the content of each product, independent of its occurrences.

A definition is an assembly of other definitions, or a part with bodies. A part is split into its solids, its shells and
the remaining loose faces; curves and points count only if there is nothing else.

The colour nearest to the triangle wins, as in viewers based on this kernel: a face's own colour, else the occurrence's,
else the body's, else the part's, else the assembly's above. So a part that is coloured as a whole in an assembly keeps
the colours of single faces in the part.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.collections import Sequence_TDF_Label
from OCP.Quantity import Quantity_ColorRGBA, Quantity_TypeOfColor
from OCP.TCollection import TCollection_AsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_Tool
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS_Compound, TopoDS_Iterator
from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from stepbot.robot.model import Rgba

from ..exchange.length_unit import DEFAULT_PRECISION
from ..kernel import evaluated, mapped, matrices_of
from .products import Products
from .source import NONE, BodySource, Child, Definition

_KINDS = (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen)
_DIGITS = 6
"""The kernel stores colours in single precision; further digits are noise."""

BodyStyle = tuple[Rgba | None, dict[int, Rgba]]
"""Colour of a body, and of its faces with own colours."""


class Colors:
    """The colours of one document."""

    def __init__(self) -> None:
        self.errors: list[str] = []
        """Failures of the kernel; what they concern has no colour of its own."""

    def of_label(self, label: Any) -> Rgba | None:
        """The colour of a part or an occurrence; None if it has none of its own."""
        return next(iter(evaluated(self._of_label, [label], self.errors)), None)

    def of_parts(self, label: Any, bodies: Sequence[Any]) -> list[BodyStyle]:
        """The colours of a part's bodies and of their faces."""
        plain: list[BodyStyle] = [(None, {}) for _ in bodies]
        return next(iter(evaluated(lambda part: self._of_parts(part, bodies), [label], self.errors)), plain)

    def _of_label(self, label: Any) -> Rgba | None:
        color = Quantity_ColorRGBA()
        for kind in _KINDS:
            if XCAFDoc_ColorTool.GetColor_s(label, kind, color):
                red, green, blue = color.GetRGB().Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)
                return (round(red, _DIGITS), round(green, _DIGITS), round(blue, _DIGITS), round(color.Alpha(), _DIGITS))
        return None

    def _of_parts(self, label: Any, bodies: Sequence[Any]) -> list[BodyStyle]:
        styles: list[BodyStyle] = [(None, {}) for _ in bodies]
        labels = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetSubShapes_s(label, labels)
        owners: _FaceOwners | None = None
        for index in range(1, labels.Length() + 1):
            color = self.of_label(labels.Value(index))
            if color is None:
                continue
            shape = XCAFDoc_ShapeTool.GetShape_s(labels.Value(index))
            if shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE:
                owners = owners or _FaceOwners(bodies)
                for body, face in owners.of(shape):
                    styles[body][1][face] = color
                continue
            for number, body_shape in enumerate(bodies):
                if body_shape.IsSame(shape) or shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_COMPOUND:
                    styles[number] = (color, styles[number][1])
        return styles


class _FaceOwners:
    """The bodies that contain a face, and its index in them."""

    def __init__(self, bodies: Sequence[Any]) -> None:
        self._faces = ShapeMap()
        self._places: list[list[tuple[int, int]]] = []
        for number, body in enumerate(bodies):
            own = mapped(body, TopAbs_ShapeEnum.TopAbs_FACE)
            for place in range(own.Extent()):
                index = self._faces.Add(own.FindKey(place + 1))
                if index > len(self._places):
                    self._places.append([])
                self._places[index - 1].append((number, place))

    def of(self, face: Any) -> list[tuple[int, int]]:
        """Pairs of the body's number and the face's index in it, both from 0."""
        index = self._faces.FindIndex(face)
        return self._places[index - 1] if index > 0 else []


_GROUPS = (TopAbs_ShapeEnum.TopAbs_COMPOUND, TopAbs_ShapeEnum.TopAbs_COMPSOLID)
_ENCLOSED = (TopAbs_ShapeEnum.TopAbs_SOLID, TopAbs_ShapeEnum.TopAbs_SHELL)


class Definitions:
    """All definitions of a document, each once, and the roots among them."""

    def __init__(self, document: Any, products: Products) -> None:
        self._products = products
        self._shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._colors = Colors()
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
        components = _listed(lambda occurrence: XCAFDoc_ShapeTool.GetComponents_s(label, occurrence, False))
        below = []
        for component in components:
            referred = TDF_Label()
            XCAFDoc_ShapeTool.GetReferredShape_s(component, referred)
            below.append(self._read(referred, precision))
        products = [self.all[index].product for index in below]
        occurrences = self._products.occurrences_of(
            definition.product, products, [_name(label) for label in components]
        )
        children: list[tuple[int, Child]] = []
        for index, occurrence, component in zip(below, occurrences, components, strict=True):
            matrix = matrices_of([XCAFDoc_ShapeTool.GetLocation_s(component).Transformation()])[0]
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
