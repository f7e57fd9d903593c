"""Solids with their volume, centre and inertia in closed form: the material of :mod:`tests.parts`.

A :class:`Solid` is a shape of the kernel with its integrals, and a cut applies to both; the integrals come from
:mod:`robot_library.moments`, never from the kernel. Lengths are in millimetres.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from msgspec import Struct

from robot_library import moments
from robot_library.moments import Array, Moments, pose
from robot_library.step_file import moved


class Solid(Struct, frozen=True, eq=False):
    """A shape of the kernel and its integrals at density 1, both in millimetres and in one frame."""

    shape: Any
    moments: Moments

    def __add__(self, other: "Solid") -> "Solid":
        """Both as one solid; they must touch and not overlap."""
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

        return Solid(_one_solid(BRepAlgoAPI_Fuse(self.shape, other.shape).Shape()), self.moments + other.moments)

    def __sub__(self, other: "Solid") -> "Solid":
        """This solid without ``other``, which must be inside it."""
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

        return Solid(_one_solid(BRepAlgoAPI_Cut(self.shape, other.shape).Shape()), self.moments - other.moments)

    def moved(self, X_AB: Array) -> "Solid":
        """This solid, given in B, expressed in A."""
        return Solid(moved(self.shape, X_AB), self.moments.moved(X_AB))

    def at(self, x: float, y: float, z: float) -> "Solid":
        """This solid, shifted."""
        return self.moved(pose((x, y, z)))


def box(x: float, y: float, z: float) -> Solid:
    """A box around the origin."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    corner = gp_Pnt(-x / 2, -y / 2, -z / 2)
    return Solid(BRepPrimAPI_MakeBox(corner, x, y, z).Solid(), moments.box(x, y, z))


def cylinder(radius: float, height: float) -> Solid:
    """A cylinder along +z with its base at the origin."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    return Solid(BRepPrimAPI_MakeCylinder(radius, height).Solid(), moments.cylinder(radius, height))


def cone(lower: float, upper: float, height: float) -> Solid:
    """A truncated cone along +z with its base at the origin."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    return Solid(BRepPrimAPI_MakeCone(lower, upper, height).Solid(), moments.frustum(lower, upper, height))


def sphere(radius: float) -> Solid:
    """A sphere around the origin."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    return Solid(BRepPrimAPI_MakeSphere(radius).Solid(), moments.sphere(radius))


def joined(first: Solid, *others: Solid) -> Solid:
    """Several solids as one, each touching those before it."""
    for other in others:
        first += other
    return first


def triangles(x: float, y: float, z: float, closed: bool = True) -> Any:
    """A box around the origin as a solid of triangles, without surfaces; an open one lacks one triangle."""
    from OCP.BRep import BRep_Builder
    from OCP.gp import gp_Pnt
    from OCP.Poly import Poly_Triangle, Poly_Triangulation
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shell, TopoDS_Solid

    corners = list(product((-x / 2, x / 2), (-y / 2, y / 2), (-z / 2, z / 2)))
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    drawn = [corner for a, b, c, d in quads for corner in ((a, b, c), (a, c, d))][: 12 if closed else 11]
    mesh = Poly_Triangulation(len(corners), len(drawn), False)
    for i, corner in enumerate(corners, start=1):
        mesh.SetNode(i, gp_Pnt(*corner))
    for i, triangle in enumerate(drawn, start=1):
        mesh.SetTriangle(i, Poly_Triangle(*triangle))
    builder, face, shell, solid = BRep_Builder(), TopoDS_Face(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeFace(face, mesh)
    builder.MakeShell(shell)
    builder.Add(shell, face)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def compound(*shapes: Any) -> Any:
    """Several shapes as a compound, not joined."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def solid_of(*shells: Sequence[Any]) -> Any:
    """A solid bounded by shells of these faces, without any check that they close or intersect."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for of_shell in shells:
        shell = TopoDS_Shell()
        builder.MakeShell(shell)
        for face in of_shell:
            builder.Add(shell, face)
        builder.Add(solid, shell)
    return solid


def unsewn(shape: Any, gap: float = 0.0) -> Any:
    """A solid of copies of a shape's faces, which share no edges, each displaced by a gap [mm]."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy

    copies = (BRepBuilderAPI_Copy(face).Shape() for face in faces(shape))
    return solid_of([moved(face, pose([gap * ((i + k) % 3 - 1) for k in range(3)])) for i, face in enumerate(copies)])


def faces(shape: Any) -> list[Any]:
    """The faces of a shape."""
    from OCP.TopAbs import TopAbs_ShapeEnum

    return list(_explored(shape, TopAbs_ShapeEnum.TopAbs_FACE))


def _one_solid(shape: Any) -> Any:
    """The only solid in the result of a Boolean operation, with faces on one surface merged."""
    from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
    from OCP.TopAbs import TopAbs_ShapeEnum

    unify = ShapeUpgrade_UnifySameDomain(shape)
    unify.Build()
    (solid,) = _explored(unify.Shape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    return solid


def _explored(shape: Any, kind: Any) -> Iterator[Any]:
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()
