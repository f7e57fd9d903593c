"""STEP to URDF as a plain script does it: every solid a link on a fixed joint, meshes as STL, one density.

``python plain_converter.py FILE FOLDER``. No joints, names as the kernel gives them, nothing checked; one process. It
stands for the scripts that export an assembly with the kernel's Python bindings.
"""

import math
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from bare_occt import meshed_solids
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.StlAPI import StlAPI_Writer

DENSITY = 1000.0
"""[kg/m^3]."""
MILLIMETRE = 1e-3


def main(path: str, folder: str, deflection: float = 0.002, angle: float = math.radians(15.0)) -> None:
    """Write a URDF and an STL for each solid."""
    output = Path(folder)
    output.mkdir(exist_ok=True)
    robot = ET.Element("robot", name="assembly")
    ET.SubElement(robot, "link", name="base")
    for number, solid in enumerate(meshed_solids(path, deflection, angle), 1):
        _add_link(robot, solid, output, f"solid_{number}")
    ET.ElementTree(robot).write(output / "assembly.urdf", encoding="utf-8", xml_declaration=True)


def _add_link(robot: ET.Element, solid: Any, output: Path, name: str) -> None:
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    centre, moments = properties.CentreOfMass(), properties.MatrixOfInertia()
    StlAPI_Writer().Write(solid, str(output / f"{name}.stl"))
    link = ET.SubElement(robot, "link", name=name)
    inertial = ET.SubElement(link, "inertial")
    xyz = " ".join(f"{value * MILLIMETRE:.9g}" for value in (centre.X(), centre.Y(), centre.Z()))
    ET.SubElement(inertial, "origin", xyz=xyz)
    ET.SubElement(inertial, "mass", value=f"{properties.Mass() * MILLIMETRE**3 * DENSITY:.9g}")
    entries = {"ixx": (1, 1), "ixy": (1, 2), "ixz": (1, 3), "iyy": (2, 2), "iyz": (2, 3), "izz": (3, 3)}
    inertia = {key: f"{moments.Value(*at) * MILLIMETRE**5 * DENSITY:.9g}" for key, at in entries.items()}
    ET.SubElement(inertial, "inertia", inertia)
    for kind in ("visual", "collision"):
        geometry = ET.SubElement(ET.SubElement(link, kind), "geometry")
        ET.SubElement(geometry, "mesh", filename=f"{name}.stl", scale="0.001 0.001 0.001")
    joint = ET.SubElement(robot, "joint", name=f"{name}_joint", type="fixed")
    ET.SubElement(joint, "parent", link="base")
    ET.SubElement(joint, "child", link=name)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
