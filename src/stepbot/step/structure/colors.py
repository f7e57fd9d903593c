"""Colours in the document, from the face up to the occurrence.

The colour nearest to the triangle wins, as in viewers based on this kernel: a face's own colour, else the occurrence's,
else the body's, else the part's, else the assembly's above. So a part that is coloured as a whole in an assembly keeps
the colours of single faces in the part.
"""

from collections.abc import Sequence
from typing import Any

from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.collections import Sequence_TDF_Label
from OCP.Quantity import Quantity_ColorRGBA, Quantity_TypeOfColor
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from stepbot.robot.model import Rgba
from stepbot.step.kernel import evaluated

_KINDS = (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen)
_DIGITS = 6
"""The kernel stores colours in single precision; further digits are noise."""

BodyStyle = tuple[Rgba | None, dict[int, Rgba]]
"""Colour of a body, and of its faces with own colours."""


class Colors:
    """The colours of one document."""

    def __init__(self, document: Any) -> None:
        # Accessing the tool creates it: a document without colours would have none.
        XCAFDoc_DocumentTool.ColorTool_s(document.Main())
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
            own = ShapeMap()
            TopExp.MapShapes_s(body, TopAbs_ShapeEnum.TopAbs_FACE, own)
            for place in range(own.Extent()):
                index = self._faces.Add(own.FindKey(place + 1))
                if index > len(self._places):
                    self._places.append([])
                self._places[index - 1].append((number, place))

    def of(self, face: Any) -> list[tuple[int, int]]:
        """Pairs of the body's number and the face's index in it, both from 0."""
        index = self._faces.FindIndex(face)
        return self._places[index - 1] if index > 0 else []
