"""Reference values of low_cost_robot_follower.step, measured independently of stepbot.

``python -m tests.corpus.measure_follower STEP`` writes low_cost_robot_follower.expected.json beside this file. The
kernel reads the file with its own healing, in one process, without a mesh; volumes, centres and inertias are exact
(GProp; for B-spline faces its Gauss-Kronrod rule, span by span, to 1e-9), once per definition and moved to every
occurrence. The axis of a joint is that of the widest cylinder of one known part of its motor. Separate regular
expressions assign parts to links.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from robot_library.command import kernel_properties
from robot_library.expected import mass_properties, write_expected
from robot_library.moments import NOTHING, Array, Moments, pose

PLA = 1240.0
"""[kg/m^3]."""
MOTOR_MASS = {"XL-430_new": 0.0572, "XL,XC-330": 0.018}
"""[kg]."""

ABOUT = """\
Written by measure_follower.py: the kernel's own reader, GProp of each solid (where faces are B-splines \
by its Gauss-Kronrod rule, to 1e-9), once per definition and times its \
occurrences; surface bodies have no volume. PLA has 1240 kg/m^3; motors weigh 57.2 g and 18 g, spread over their \
volume. An axis is that of the widest cylinder of the motor's horn or idler: the point nearest to the assembly's \
origin, and a direction with the sign of the sidecar's rule. Links as drawn, in the assembly's frame [kg, m], inertia \
about the centre of mass."""

LINKS = (
    # The first match applies; from the horns, which are children of another link's motor, to the rest.
    (r"gripper:1/moving side|gripper:1/XL,XC-330:1/(.*HORN|.*IDLE_CAP|BTS2)", "jaw"),
    (r"gripper:1|XL,XC-330:6/(DC15_A01_HORN_DUMMY|BTS2_M2_6X8:1)", "gripper"),
    (r"servo connector angle|XL,XC-330:6|XL,XC-330:8/(.*HORN|.*IDLE_CAP|BTS2)", "wrist"),
    (r"XL330_to_XL330_straight|XL,XC-330:8|XL,XC-330:7/(.*HORN|.*IDLE_CAP|BTS2)", "forearm"),
    (r"XL430 to XL330 new connector|XL,XC-330:7|XL-430_new:2/DC11_A01_IDLER", "upper_arm"),
    (r"rotation connector|XL-430_new:2", "shoulder"),
    (r"Simple Base|XL-430_new:1", "base"),
)

HORNS = {
    "shoulder_pan": r"XL-430_new:1/DC11_A01_IDLER_DUMMY:1",
    "shoulder_lift": r"XL-430_new:2/DC11_A01_IDLER_DUMMY:1",
    "elbow_flex": r"XL,XC-330:7/DC15_A01_HORN_DUMMY:1",
    "wrist_flex": r"XL,XC-330:8/DC15_A01_HORN_DUMMY:1",
    "wrist_roll": r"XL,XC-330:6/DC15_A01_HORN_DUMMY:1",
    "gripper_jaw": r"gripper:1/XL,XC-330:1/DC15_A01_HORN_DUMMY:1",
}


class Occurrence(Struct, frozen=True, eq=False):
    """One part with its pose."""

    path: str
    """Occurrence names from below the root, without the CAD's save counters."""
    definition: str
    """Entry of the product in the kernel's document."""
    X_WC: Array
    """Pose in the assembly, shape (4, 4) [mm]."""
    shape: Any
    """In the frame of the definition [mm]."""


def occurrences(step: Path) -> list[Occurrence]:
    """All parts of a STEP file in file order."""
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    storage = TCollection_ExtendedString("BinXCAF")
    document = TDocStd_Document(storage)
    XCAFApp_Application.GetApplication_s().NewDocument(storage, document)
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.ReadFile(str(step))
    reader.Transfer(document)
    (root,) = _labels(XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes)
    if not XCAFDoc_ShapeTool.IsAssembly_s(root):
        return [Occurrence(".", _entry(root), pose(), XCAFDoc_ShapeTool.GetShape_s(root))]
    return list(_below(root, "", pose()))


def _below(assembly: Any, above: str, X_WP: Array) -> Iterator[Occurrence]:
    from OCP.TDF import TDF_Label
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    for component in _labels(lambda found: XCAFDoc_ShapeTool.GetComponents_s(assembly, found, False)):
        product = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(component, product)
        X_WC = X_WP @ _pose(XCAFDoc_ShapeTool.GetLocation_s(component))
        path = above + re.sub(r" v\d+(?=:|$)", "", _name(component))
        if XCAFDoc_ShapeTool.IsAssembly_s(product):
            yield from _below(product, f"{path}/", X_WC)
        else:
            yield Occurrence(path, _entry(product), X_WC, XCAFDoc_ShapeTool.GetShape_s(product))


def _entry(label: Any) -> str:
    from OCP.TCollection import TCollection_AsciiString
    from OCP.TDF import TDF_Tool

    entry = TCollection_AsciiString()
    TDF_Tool.Entry_s(label, entry)
    return str(entry.ToCString())


def _labels(fill: Any) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label

    found = Sequence_TDF_Label()
    fill(found)
    return [found.Value(i) for i in range(1, found.Length() + 1)]


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return ""
    name = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return str(name.Get().ToExtString())


def _pose(location: Any) -> Array:
    trsf = location.Transformation()
    X = np.eye(4)
    X[:3] = [[trsf.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
    return X


def _explored(shape: Any, kind: str) -> Iterator[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _solids(shape: Any) -> list[Any]:
    return list(_explored(shape, "SOLID"))


def solid_moments(shape: Any) -> Moments:
    """The solids of a shape together at density 1 [mm]; surfaces do not count."""
    found = NOTHING
    for solid in _solids(shape):
        volume, com, inertia = _integrated(solid) if _has_splines(solid) else kernel_properties(solid)
        if not volume > 0:
            raise ValueError(f"a solid with a volume of {volume} mm^3")
        central = np.trace(inertia) / 2 * np.eye(3) - inertia
        found += Moments(volume, volume * com, central + volume * np.outer(com, com))
    return found


def _integrated(solid: Any) -> tuple[float, Array, Array]:
    """Volume, com and inertia [mm] by a rule that divides faces at their knots."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    reached = BRepGProp.VolumePropertiesGK_s(solid, properties, 1e-9, False, True, True, True, False)
    assert 0.0 <= reached < 1e-8
    com, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    inertia = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return properties.Mass(), np.array([com.X(), com.Y(), com.Z()]), inertia


def _has_splines(solid: Any) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopoDS import TopoDS

    surfaces = (BRepAdaptor_Surface(TopoDS.Face(face)) for face in _explored(solid, "FACE"))
    return any(surface.GetType() == GeomAbs_SurfaceType.GeomAbs_BSplineSurface for surface in surfaces)


def widest_cylinder(occurrence: Occurrence) -> dict[str, Any]:
    """The axis of the widest cylindrical face: its point nearest to the assembly's origin [mm], direction, radius."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopoDS import TopoDS

    surfaces = (BRepAdaptor_Surface(TopoDS.Face(face)) for face in _explored(occurrence.shape, "FACE"))
    cylinders = (s.Cylinder() for s in surfaces if s.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder)
    widest = max(cylinders, key=lambda cylinder: cylinder.Radius())
    location, direction = widest.Axis().Location(), widest.Axis().Direction()
    p = occurrence.X_WC @ (location.X(), location.Y(), location.Z(), 1.0)
    z = occurrence.X_WC[:3, :3] @ (direction.X(), direction.Y(), direction.Z())
    z *= next(np.sign(z[i]) for i in (2, 1, 0) if abs(z[i]) > 1e-6)
    foot = p[:3] - (p[:3] @ z) * z
    # Nine decimals of a millimetre, the accuracy of the placements in the file.
    return {"point_mm": foot.round(9), "direction": z.round(9), "radius_mm": widest.Radius()}


def motor_of(path: str) -> str:
    """The motor that a part belongs to, as a path; empty for a printed part."""
    found = re.match(r"(?:gripper:1/)?(?:XL-430_new|XL,XC-330):\d+", path)
    return found[0] if found else ""


def measure(step: Path) -> dict[str, Any]:
    """The expected values of the arm."""
    parts = occurrences(step)
    unit_bodies = {part.definition: solid_moments(part.shape) for part in parts}
    counts = {name: sum(part.definition == name for part in parts) for name in unit_bodies}
    bodies = {part.path: unit_bodies[part.definition].moved(part.X_WC).in_metres() for part in parts}
    assert len(bodies) == len(parts)

    motor_volumes: dict[str, float] = {}
    for path, body in bodies.items():
        motor_volumes[motor_of(path)] = motor_volumes.get(motor_of(path), 0.0) + body.mass
    links = {name: NOTHING for _, name in reversed(LINKS)}
    for path, body in bodies.items():
        motor = motor_of(path)
        kind = motor.rpartition("/")[2].rpartition(":")[0]
        density = MOTOR_MASS[kind] / motor_volumes[motor] if motor else PLA
        links[next(link for pattern, link in LINKS if re.match(pattern, path))] += body.weighing(density)

    by_path = {part.path: part for part in parts}
    first = {part.definition: part.path for part in reversed(parts)}
    return {
        "robot": "follower",
        "about": ABOUT,
        "counts": {"parts": len(parts), "solids": sum(len(_solids(part.shape)) for part in parts)},
        "volume_mm3": {"all": sum(body.mass for body in bodies.values()) * 1e9, "printed": motor_volumes[""] * 1e9},
        "mass": sum(link.mass for link in links.values()),
        "axes": {joint: widest_cylinder(by_path[path]) for joint, path in HORNS.items()},
        "links": {name: mass_properties(body) for name, body in links.items()},
        "definitions": {
            first[name]: {"occurrences": counts[name], "volume_mm3": body.mass} for name, body in unit_bodies.items()
        },
    }


if __name__ == "__main__":
    write_expected(Path(__file__).with_name("low_cost_robot_follower.expected.json"), measure(Path(sys.argv[1])))
