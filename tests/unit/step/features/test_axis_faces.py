"""Cylindrical and conical faces: extents against closed forms, axes of surfaces that are written as B-splines."""

import math
from typing import Any

import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_NurbsConvert
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeHalfSpace
from OCP.Geom import Geom_CylindricalSurface, Geom_RectangularTrimmedSurface
from OCP.GeomAbs import GeomAbs_C1
from OCP.GeomConvert import GeomConvert_ApproxSurface
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Lin, gp_Pln, gp_Pnt

from stepbot.step.assembly import AxisFace
from stepbot.step.features.axis_faces import axis_faces
from stepbot.step.kernel import faces_of

AXIS = gp_Ax2(gp_Pnt(300.0, -200.0, 150.0), gp_Dir(0.3, 0.5, 0.8))


@pytest.mark.parametrize("turn", [0.0, 0.05, 1.0, 3.1, math.pi, 3.2, 6.25])
def test_cylinder_cut_aslant(turn: float) -> None:
    """The end of an obliquely cut cylinder is that of its ellipse, for any position of the seam."""
    seam = gp_Dir(math.cos(turn), math.sin(turn), 0.0)
    rod = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(), gp_Dir(0.0, 0.0, 1.0), seam), 5.0, 30.0).Shape()
    plane = gp_Pln(gp_Ax3(gp_Pnt(0.0, 0.0, 15.0), gp_Dir(0.5, 0.0, 1.0)))
    face = BRepBuilderAPI_MakeFace(plane, -50.0, 50.0, -50.0, 50.0).Face()
    below = BRepPrimAPI_MakeHalfSpace(face, gp_Pnt()).Solid()
    (found,) = axis_faces(faces_of(BRepAlgoAPI_Common(rod, below).Shape()), [])
    assert (found.low, found.high) == pytest.approx((0.0, 15e-3 + 0.5 * 5e-3), abs=1e-12)


def deviation(found: AxisFace) -> tuple[float, float]:
    """Distance [m] and angle [rad] of a face's axis from :data:`AXIS`."""
    line = gp_Lin(AXIS.Axis())
    point = gp_Pnt(*(1e3 * x for x in found.point))
    angle = gp_Dir(*found.direction).Angle(line.Direction())
    return line.Distance(point) / 1e3, min(angle, math.pi - angle)


@pytest.mark.parametrize("radius", [2.0, 5.0, 20.0])
@pytest.mark.parametrize("solid", [BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeCone], ids=["cylinder", "cone"])
def test_axis_of_a_solid_of_splines(radius: float, solid: Any) -> None:
    """The axis of a cylinder or cone that is exported as rational B-splines is that of the original, to 1e-12 m."""
    radii = (radius,) if solid is BRepPrimAPI_MakeCylinder else (radius, radius / 2)
    exact = solid(AXIS, *radii, 30.0).Shape()
    (expected,) = axis_faces(faces_of(exact), [])
    (found,) = axis_faces(faces_of(BRepBuilderAPI_NurbsConvert(exact, True).Shape()), [])
    assert deviation(found) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert (found.radius, found.high - found.low) == pytest.approx((radius / 1e3, 0.03), abs=1e-11)
    assert (found.bore, found.cone) == (expected.bore, expected.cone)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-5])
def test_axis_of_an_approximated_cylinder(accuracy: float) -> None:
    """A third of a cylinder that polynomials approximate to 1e-4 mm has its axis within 1e-6 m and 1e-6 rad."""
    cylinder = Geom_CylindricalSurface(gp_Ax3(AXIS), 5.0)
    third = Geom_RectangularTrimmedSurface(cylinder, 0.0, 2.0, 0.0, 30.0, True, True)
    spline = GeomConvert_ApproxSurface(third, accuracy, GeomAbs_C1, GeomAbs_C1, 5, 5, 50, 1)
    assert not spline.Surface().IsURational()
    (found,) = axis_faces([BRepBuilderAPI_MakeFace(spline.Surface(), 1e-6).Face()], [])
    distance, angle = deviation(found)
    assert distance < 1e-6
    assert angle < 1e-6
    assert found.radius == pytest.approx(5e-3, abs=1e-6)


def test_free_form_near_a_cylinder_is_none() -> None:
    """The same third, approximated so coarsely that it is off by micrometres, is not taken for a cylinder."""
    cylinder = Geom_CylindricalSurface(gp_Ax3(AXIS), 20.0)
    third = Geom_RectangularTrimmedSurface(cylinder, 0.0, 2.0, 0.0, 30.0, True, True)
    spline = GeomConvert_ApproxSurface(third, 1e-1, GeomAbs_C1, GeomAbs_C1, 3, 3, 4, 1)
    assert spline.MaxError() > 1e-3
    assert axis_faces([BRepBuilderAPI_MakeFace(spline.Surface(), 1e-6).Face()], []) == ()
