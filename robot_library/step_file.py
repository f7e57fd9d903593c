"""Write an assembly as STEP, with deterministic bytes: products, occurrences, names, colours, densities, length unit.

Shapes are drawn in millimetres. The file may be in millimetres, centimetres, metres, inches or feet: the kernel scales
the coordinates and declares the unit, so that the geometry is the same. It writes 13 significant digits.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Literal, get_args

from .moments import Array, pose
from .step_text import in_canonical_order

LengthUnit = Literal["mm", "cm", "m", "inch", "foot"]
UNITS: tuple[LengthUnit, ...] = get_args(LengthUnit)

_KERNEL_UNIT: dict[LengthUnit, str] = {"mm": "MM", "cm": "CM", "m": "M", "inch": "INCH", "foot": "FT"}
_TIME_STAMP = "2000-01-01T00:00:00"
"""The header requires a time; with the current one no two files would be equal."""


@dataclass(frozen=True, eq=False)
class Part:
    """A product with a shape. An object placed twice is one product with two occurrences."""

    name: str
    shape: Any
    """A ``TopoDS_Shape`` [mm]."""
    color: str = ""
    """``#rrggbb``; empty for none."""
    face_colors: Sequence[tuple[Any, str]] = ()
    """Faces of the shape and their own colours."""
    material: str = ""
    density: float = 0.0
    """[kg/m^3]; 0 for none."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A product that consists of others."""

    name: str
    children: Sequence["Occurrence"]


@dataclass(frozen=True, eq=False)
class Occurrence:
    """A product with its pose in an assembly."""

    product: Part | Assembly
    name: str = ""
    X_AP: Array | None = None
    """Pose of the product P in the assembly A, shape (4, 4) [mm]; None for the identity. A reflection makes the
    occurrence a mirror image."""
    color: str = ""
    """Colour of this occurrence alone, ``#rrggbb``; empty for the product's own."""


def write_step(path: Path, *roots: Part | Assembly, unit: LengthUnit = "mm", name: str = "") -> None:
    """Write one or several roots as a STEP file.

    Args:
        path: File to write.
        roots: Usually one; several are siblings on the first level of the file.
        unit: Length unit of the file and its coordinates.
        name: File name in the header; by default that of ``path``.

    Raises:
        ValueError: The kernel rejects a shape.
        OSError: The file cannot be written.
    """
    document = _Document()
    for root in roots:
        document.add(root)
    document.finish()
    write_document(path, document.document, unit=unit, name=name)


def write_document(path: Path, document: Any, unit: LengthUnit = "mm", name: str = "") -> None:
    """Write a document of the kernel, drawn or read from another file, as a STEP file.

    Args:
        path: File to write.
        document: A ``TDocStd_Document`` of products.
        unit: Length unit of the file and its coordinates.
        name: File name in the header; by default that of ``path``.

    Raises:
        ValueError: The kernel rejects a shape.
        OSError: The file cannot be written.
    """
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType

    content = BytesIO()
    with _quiet(), _settings(unit):
        writer = STEPCAFControl_Writer()
        for switch in (writer.SetColorMode, writer.SetNameMode, writer.SetMaterialMode):
            switch(True)
        if not writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
            raise ValueError(f"{path}: the kernel cannot turn these shapes into STEP")
        model = writer.Writer().Model()
        _correct_density_units(model)
        _fill_header(APIHeaderSection_MakeHeader(model), name or path.name)
        if writer.WriteStream(content) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise ValueError(f"{path}: the kernel cannot write these shapes")
    path.write_bytes(in_canonical_order(content.getvalue()))


def moved(shape: Any, X_AB: Array) -> Any:
    """A copy of a shape, given in B, expressed in A [mm]. Its geometry is transformed, so X_AB may be a reflection."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform

    return BRepBuilderAPI_Transform(shape, _trsf(X_AB), True).Shape()


class _Document:
    """The kernel's document of products, filled from the roots downwards."""

    def __init__(self) -> None:
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDocStd import TDocStd_Document
        from OCP.XCAFApp import XCAFApp_Application
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        storage = TCollection_ExtendedString("BinXCAF")
        self.document = TDocStd_Document(storage)
        XCAFApp_Application.GetApplication_s().NewDocument(storage, self.document)
        XCAFDoc_DocumentTool.SetLengthUnit_s(self.document, 0.001)
        main = self.document.Main()
        self._shapes = XCAFDoc_DocumentTool.ShapeTool_s(main)
        self._colors = XCAFDoc_DocumentTool.ColorTool_s(main)
        self._materials = XCAFDoc_DocumentTool.MaterialTool_s(main)
        self._shapes.SetAutoNaming_s(False)
        self._labels: dict[int, Any] = {}

    def add(self, product: Part | Assembly) -> Any:
        """The label of a product, made on its first use."""
        known = self._labels.get(id(product))
        if known is not None:
            return known
        label = self._add_part(product) if isinstance(product, Part) else self._add_assembly(product)
        _name(label, product.name)
        self._labels[id(product)] = label
        return label

    def finish(self) -> None:
        """Update the shapes of the assemblies from their children."""
        self._shapes.UpdateAssemblies()

    def _add_part(self, part: Part) -> Any:
        from OCP.TCollection import TCollection_HAsciiString

        label = self._shapes.AddShape(_without_location(part.shape), False)
        self._color(label, part.color)
        for face, color in part.face_colors:
            self._color(self._shapes.AddSubShape(label, face), color)
        if part.density:
            words = (part.material, "", "density measure", "POSITIVE_RATIO_MEASURE")
            name, description, quantity, measure = (TCollection_HAsciiString(word) for word in words)
            self._materials.SetMaterial(label, name, description, part.density / 1000, quantity, measure)
        return label

    def _add_assembly(self, assembly: Assembly) -> Any:
        from OCP.TopLoc import TopLoc_Location

        label = self._shapes.NewShape()
        for child in assembly.children:
            X_AP = pose() if child.X_AP is None else child.X_AP
            occurrence = self._shapes.AddComponent(label, self.add(child.product), TopLoc_Location(_trsf(X_AP)))
            _name(occurrence, child.name)
            self._color(occurrence, child.color)
        return label

    def _color(self, label: Any, color: str) -> None:
        from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
        from OCP.XCAFDoc import XCAFDoc_ColorType

        if color:
            red, green, blue = (int(color[i : i + 2], 16) / 255 for i in (1, 3, 5))
            value = Quantity_Color(red, green, blue, Quantity_TypeOfColor.Quantity_TOC_sRGB)
            self._colors.SetColor(label, value, XCAFDoc_ColorType.XCAFDoc_ColorSurf)


def _without_location(shape: Any) -> Any:
    """The shape with its location applied to its geometry: the kernel writes a located shape as a nameless assembly."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.TopLoc import TopLoc_Location

    if shape.Location().IsIdentity():
        return shape
    return BRepBuilderAPI_Transform(shape.Located(TopLoc_Location()), shape.Location().Transformation(), True).Shape()


def _name(label: Any, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def _trsf(X_AB: Array) -> Any:
    from OCP.gp import gp_Trsf

    trsf = gp_Trsf()
    trsf.SetValues(*(float(value) for value in X_AB[:3].ravel()))
    return trsf


@contextmanager
def _settings(unit: LengthUnit) -> Iterator[None]:
    """Set the kernel's options for writing, which are global in the process, and restore them.

    Parameter curves on both faces of every edge would more than double the size of a file with curved shells; readers
    can compute them.
    """
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller

    STEPCAFControl_Controller.Init_s()
    wanted = {"write.step.unit": _KERNEL_UNIT[unit], "write.surfacecurve.mode": "0"}
    before = {key: Interface_Static.CVal_s(key) for key in wanted}
    for key, value in wanted.items():
        if not Interface_Static.SetCVal_s(key, value):
            raise OSError(f"the kernel cannot write STEP with {key} = {value}")
    try:
        yield
    finally:
        for key, value in before.items():
            Interface_Static.SetCVal_s(key, value)


@contextmanager
def _quiet() -> Iterator[None]:
    """Suppress the kernel's progress messages on the standard output."""
    from OCP.Message import Message, Message_Gravity

    printers = list(Message.DefaultMessenger_s().Printers())
    levels = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, levels, strict=True):
            printer.SetTraceLevel(level)


def _correct_density_units(model: Any) -> None:
    """Correct the unit of densities to g/cm^3: the kernel writes the right factors with the exponents of g^3 cm^2."""
    from OCP.StepBasic import StepBasic_DerivedUnitElement, StepBasic_SiUnitAndMassUnit

    for entity in _entities(model):
        if isinstance(entity, StepBasic_DerivedUnitElement):
            entity.SetExponent(1.0 if isinstance(entity.Unit(), StepBasic_SiUnitAndMassUnit) else -3.0)


def _entities(model: Any) -> list[Any]:
    return [model.Value(i) for i in range(1, model.NbEntities() + 1)]


def _fill_header(header: Any, name: str) -> None:
    """Name the program that wrote the file, without place or time."""
    from OCP.TCollection import TCollection_HAsciiString

    header.SetName(TCollection_HAsciiString(name))
    header.SetTimeStamp(TCollection_HAsciiString(_TIME_STAMP))
    header.SetAuthorValue(1, TCollection_HAsciiString(""))
    header.SetOrganizationValue(1, TCollection_HAsciiString(""))
    header.SetPreprocessorVersion(TCollection_HAsciiString("Open CASCADE Technology"))
    header.SetOriginatingSystem(TCollection_HAsciiString("stepbot robot_library"))
    header.SetAuthorisation(TCollection_HAsciiString(""))
    header.SetDescriptionValue(1, TCollection_HAsciiString("drawn by a script"))
