"""Faces of bodies for contacts, against closed forms and the kernel's integrals."""

import math
from typing import Any

import numpy as np
import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps

from stepbot.geometry.spatial import Array
from stepbot.step.faces import Face, FaceKind
from stepbot.step.features.face_reading import read_faces
from stepbot.step.kernel import faces_of


def drilled_block() -> Any:
    """A block of 40 x 30 x 10 mm with a bore of r 4 mm through its middle."""
    block = BRepPrimAPI_MakeBox(gp_Pnt(-20.0, -15.0, 0.0), 40.0, 30.0, 10.0).Shape()
    bore = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.0, 0.0, -1.0), gp_Dir(0.0, 0.0, 1.0)), 4.0, 12.0).Shape()
    return BRepAlgoAPI_Cut(block, bore).Shape()


def as_splines(shape: Any) -> Any:
    """The same shape with all surfaces as rational B-splines."""
    return BRepBuilderAPI_NurbsConvert(shape, True).Shape()


def of_kind(shape: Any, kind: FaceKind) -> list[Face]:
    """The faces of one kind."""
    return [face for face in read_faces(faces_of(shape), []) if face.kind == kind]


def shoelace(ring: Array, normal: Array) -> float:
    """Area [m^2] enclosed by a ring, positive if anticlockwise about the normal."""
    return float(0.5 * np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) @ normal)


@pytest.mark.parametrize("written", [drilled_block(), as_splines(drilled_block())], ids=["exact", "splines"])
def test_block_with_a_bore(written: Any) -> None:
    """Six planes face outwards; the bore has its axis, radius and length, also with B-spline surfaces."""
    planes = of_kind(written, FaceKind.PLANE)
    (bore,) = of_kind(written, FaceKind.CYLINDER)
    middle = np.array([0.0, 0.0, 5e-3])
    assert len(planes) == 6
    assert all((np.array(p.point) - middle) @ np.array(p.direction) > 0.0 for p in planes)
    assert (bore.radius, bore.length, bore.bore) == (pytest.approx(4e-3, abs=1e-9), pytest.approx(0.01, abs=1e-9), True)
    assert bore.span == pytest.approx(2 * math.pi, abs=1e-9)
    assert bore.point == pytest.approx((0.0, 0.0, 5e-3), abs=1e-9)
    assert abs(bore.direction[2]) == pytest.approx(1.0, abs=1e-12)


def test_outlines_enclose_the_area_of_their_faces() -> None:
    """The rings of a face with a hole, outer first, enclose its area except for chords of the circle."""
    shape = drilled_block()
    faces = faces_of(shape)
    for kernel_face, face in zip(faces, read_faces(faces, []), strict=True):
        if face.kind != FaceKind.PLANE:
            continue
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(kernel_face, properties)
        areas = [shoelace(ring, np.array(face.direction)) for ring in face.rings]
        assert abs(areas[0]) == max(abs(area) for area in areas)
        chords = math.pi * 16e-6 * 0.03 if len(areas) > 1 else 1e-15
        assert abs(sum(areas)) == pytest.approx(properties.Mass() * 1e-6, abs=chords)


def test_ball_and_socket_differ() -> None:
    """The face of a ball points away from its centre, that of a socket towards it."""
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(1.0, 2.0, 3.0), 5.0).Shape()
    block = BRepPrimAPI_MakeBox(gp_Pnt(-20.0, -20.0, 3.0), 40.0, 40.0, 10.0).Shape()
    (outside,) = of_kind(ball, FaceKind.SPHERE)
    (socket,) = of_kind(BRepAlgoAPI_Cut(block, ball).Shape(), FaceKind.SPHERE)
    assert (outside.bore, socket.bore) == (False, True)
    assert outside.point == socket.point == pytest.approx((1e-3, 2e-3, 3e-3))


def test_mirrored_face_keeps_its_outline_on_its_plane() -> None:
    """A mirrored and scaled face has the mirrored and scaled outline on its plane."""
    factors = 2.0 * np.array([1.0, 1.0, -1.0])
    for face in of_kind(drilled_block(), FaceKind.PLANE):
        made = face.scaled(factors, 2.0)
        assert np.abs((made.rings[0] - np.array(made.point)) @ np.array(made.direction)).max() < 1e-15
        assert np.allclose(made.rings[0], face.rings[0] * factors)
        assert np.all(np.array(made.box[0]) <= np.array(made.box[1]))
