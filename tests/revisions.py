"""Revisions of a STEP file, as a CAD program makes them: read by the kernel, edited, and exported again.

The export has other entity numbers and another order of statements than the source.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from robot_library.moments import Array
from robot_library.step_file import write_document


class Revision:
    """A STEP file to edit; products and occurrences are addressed by name, the first of several."""

    def __init__(self, source: Path) -> None:
        from OCP.STEPCAFControl import STEPCAFControl_Reader
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDocStd import TDocStd_Document
        from OCP.XCAFApp import XCAFApp_Application
        from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

        storage = TCollection_ExtendedString("BinXCAF")
        self._document = TDocStd_Document(storage)
        XCAFApp_Application.GetApplication_s().NewDocument(storage, self._document)
        XCAFDoc_ShapeTool.SetAutoNaming_s(False)
        reader = STEPCAFControl_Reader()
        reader.SetColorMode(False)
        reader.SetNameMode(True)
        reader.SetMatMode(True)
        reader.ReadFile(str(source))
        reader.Transfer(self._document)
        self._shapes = XCAFDoc_DocumentTool.ShapeTool_s(self._document.Main())

    def rename(self, names: Mapping[str, str]) -> "Revision":
        """Give products and occurrences other names."""
        for label in self._labels():
            _set_name(label, names.get(_name(label), _name(label)))
        return self

    def rename_all(self, name: Callable[[str], str]) -> "Revision":
        """Give every product and occurrence another name."""
        return self.rename({_name(label): name(_name(label)) for label in self._labels()})

    def move(self, occurrence: str, X_AA: Array) -> "Revision":
        """Move an occurrence by a pose [mm] in the frame of its assembly A."""
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_Location, XCAFDoc_ShapeTool

        label = self._occurrence(occurrence)
        before = XCAFDoc_ShapeTool.GetLocation_s(label)
        XCAFDoc_Location.Set_s(label, TopLoc_Location(_trsf(X_AA)) * before)
        return self

    def remove(self, occurrence: str) -> "Revision":
        """Delete an occurrence."""
        self._remove(self._occurrence(occurrence))
        return self

    def remove_number(self, product: str, number: int) -> "Revision":
        """Delete one of the occurrences of a product, counted from 1."""
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        found = []
        for label in self._labels():
            referred = TDF_Label()
            if XCAFDoc_ShapeTool.GetReferredShape_s(label, referred) and _name(referred) == product:
                found.append(label)
        self._remove(found[number - 1])
        return self

    def copy(self, occurrence: str, name: str, X_AA: Array) -> "Revision":
        """Place the product of an occurrence again, moved by a pose [mm]."""
        from OCP.TDF import TDF_Label
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        label, product = self._occurrence(occurrence), TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
        before = XCAFDoc_ShapeTool.GetLocation_s(label)
        location = TopLoc_Location(_trsf(X_AA)) * before
        _set_name(self._shapes.AddComponent(label.Father(), product, location), name)
        return self

    def reshape(self, product: str, shape: Any) -> "Revision":
        """Give a product another shape [mm]."""
        for label in self._labels():
            if _name(label) == product and self._shapes.IsSimpleShape_s(label):
                self._shapes.SetShape(label, shape)
        return self

    def write(self, target: Path) -> Path:
        """Export the file."""
        self._shapes.UpdateAssemblies()
        write_document(target, self._document)
        return target

    def _remove(self, label: Any) -> None:
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        product = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
        self._shapes.RemoveComponent(label)
        if not _listed(lambda found: XCAFDoc_ShapeTool.GetUsers_s(product, found, False)):
            self._shapes.RemoveShape(product, False)  # otherwise it would become a root

    def _occurrence(self, name: str) -> Any:
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        return next(
            label for label in self._labels() if _name(label) == name and XCAFDoc_ShapeTool.IsReference_s(label)
        )

    def _labels(self) -> Iterator[Any]:
        """Products and occurrences, each once, occurrences after the product that contains them."""
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        for product in _listed(self._shapes.GetShapes):
            yield product
            yield from _listed(lambda found, of=product: XCAFDoc_ShapeTool.GetComponents_s(of, found, False))


def _listed(fill: Callable[[Any], Any]) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label

    labels = Sequence_TDF_Label()
    fill(labels)
    return [labels.Value(index) for index in range(1, labels.Length() + 1)]


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    if not label.IsAttribute(TDataStd_Name.GetID_s()):  # searching for a missing attribute aborts the process
        return ""
    found = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), found)
    return str(found.Get().ToExtString())


def _set_name(label: Any, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def _trsf(X_AB: Array) -> Any:
    from OCP.gp import gp_Trsf

    trsf = gp_Trsf()
    trsf.SetValues(*(float(value) for value in X_AB[:3].ravel()))
    return trsf


LEVER = """\
version: 1
robot: lever
step: lever.step
base: fixed
links:
  base: {parts: [base]}
  arm: {parts: [beam, motor]}
joints:
  hinge: {type: revolute, parent: base, child: arm, limits: {lower: -0.2, upper: 0.2, effort: 1, velocity: 1}}
"""
"""A sidecar for :func:`write_lever`."""


def write_lever(path: Path, shift: float = 0.0) -> Path:
    """A plate with a pin and four equal, nameless screws; a beam that turns on the pin, with a motor on it.

    Args:
        path: File to write.
        shift: Position of the whole assembly along x [mm].
    """
    from robot_library.moments import pose
    from robot_library.step_file import Assembly, Occurrence, Part, write_step
    from tests.solids import box, cylinder

    plate = box(80, 80, 10) + cylinder(10, 20).at(0, 0, 5)
    beam = box(40, 120, 10).at(0, 45, 0) - cylinder(10.05, 10).at(0, 0, -5)
    screw = Part("M3", cylinder(1.5, 10).shape, density=7850.0, material="steel")
    screws = [Occurrence(screw, "", pose((x, y, 5.0))) for x in (-30.0, 30.0) for y in (-30.0, 30.0)]
    base = [Occurrence(Part("plate", plate.shape, density=2700.0, material="aluminium"), "plate:1"), *screws]
    arm = [
        Occurrence(Part("beam", beam.shape, density=2700.0, material="aluminium"), "beam:1", pose((0, 0, 11.0))),
        Occurrence(
            Part("motor", box(20, 30, 20).shape, density=4000.0, material="motor"), "motor:1", pose((0, 60, 26.0))
        ),
    ]
    there = pose((shift, 0, 0))
    lever = [Occurrence(Assembly("base", base), "base:1", there), Occurrence(Assembly("arm", arm), "arm:1", there)]
    write_step(path, Assembly("lever", lever))
    return path


def lock(sidecar: Path) -> None:
    """Write the lock of a sidecar, as ``stepbot lock`` does."""
    from stepbot.diagnostics import Diagnostics
    from stepbot.pipeline.conversion import Options
    from stepbot.pipeline.locking import make_locks
    from stepbot.revisions import lock_path
    from stepbot.revisions.lock_file import lock_bytes

    diagnostics = Diagnostics()
    made = make_locks(sidecar, Options(output=Path()), diagnostics)
    assert made, list(map(str, diagnostics))
    lock_path(sidecar).write_bytes(lock_bytes(made[lock_path(sidecar)]))


def write_locked_lever(folder: Path = Path(), sidecar: str = LEVER) -> Revision:
    """A lever with a sidecar and its lock; returns a revision to edit, to be written to ``lever.step``."""
    path = folder / "lever.robot.yaml"
    path.write_text(sidecar, encoding="utf-8", newline="\n")
    step = write_lever(folder / "lever.step")
    lock(path)
    return Revision(step)
