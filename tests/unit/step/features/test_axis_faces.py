"""Extents of cylindrical faces along their axis, against closed forms."""

import math

import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeHalfSpace
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pln, gp_Pnt

from stepbot.step.features.axis_faces import axis_faces
from stepbot.step.topology import faces_of


@pytest.mark.parametrize("turn", [0.0, 0.05, 1.0, 3.1, math.pi, 3.2, 6.25])
def test_cylinder_cut_aslant(turn: float) -> None:
    """The end of an obliquely cut cylinder is that of its ellipse, for any position of the seam."""
    seam = gp_Dir(math.cos(turn), math.sin(turn), 0.0)
    rod = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(), gp_Dir(0.0, 0.0, 1.0), seam), 5.0, 30.0).Shape()
    plane = gp_Pln(gp_Ax3(gp_Pnt(0.0, 0.0, 15.0), gp_Dir(0.5, 0.0, 1.0)))
    face = BRepBuilderAPI_MakeFace(plane, -50.0, 50.0, -50.0, 50.0).Face()
    below = BRepPrimAPI_MakeHalfSpace(face, gp_Pnt()).Solid()
    (found,) = axis_faces(faces_of(BRepAlgoAPI_Common(rod, below).Shape()))
    assert (found.low, found.high) == pytest.approx((0.0, 15e-3 + 0.5 * 5e-3), abs=1e-12)
