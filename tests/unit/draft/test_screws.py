"""Fasteners by their shape."""

from math import cos, pi, sin

import pytest

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.draft.parts.names import Role
from tests.assembled import BARE, assembled, cut, part
from tests.solids import Solid, box, cylinder, joined


def prism(across: float, height: float) -> Solid:
    """A hexagonal prism along +z, by the distance of its flats."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    corner = across / 3**0.5
    polygon = BRepBuilderAPI_MakePolygon()
    for k in range(6):
        polygon.Add(gp_Pnt(corner * cos(k * pi / 3), corner * sin(k * pi / 3), 0.0))
    polygon.Close()
    face = BRepBuilderAPI_MakeFace(polygon.Wire()).Face()
    return Solid(BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, height)).Shape(), box(1, 1, 1).moments)


def role(solid: Solid) -> Role | None:
    """The role of a part with a shape, without a name."""
    return Survey(assembled(part("x", solid)), BARE).parts[1].role


def test_socket_head_screw() -> None:
    """A shank and a wider head with a hexagonal recess are a screw."""
    head = cylinder(5, 5).at(0, 0, 20)
    assert role(cylinder(3, 20) + (head - prism(5, 3).at(0, 0, 22))) == Role.FASTENER


def test_nut() -> None:
    """A hexagon with a bore is a nut."""
    assert role(prism(10, 5) - cylinder(3, 5)) == Role.FASTENER


def flange() -> Solid:
    """A hub on a shank with a hexagonal recess, and three lugs with a hole each, balanced about the shank."""
    solid = cylinder(3, 20) + (cylinder(5, 5).at(0, 0, 20) - prism(5, 3).at(0, 0, 22))
    spots = [(9 * cos(k * 2 * pi / 3), 9 * sin(k * 2 * pi / 3)) for k in range(3)]
    for x, y in spots:
        solid = solid + cylinder(4.5, 5).at(x, y, 20)
    return cut(solid, *(cylinder(1.5, 5).at(x, y, 20) for x, y in spots))


def hub() -> Solid:
    """A bored hub on a disc with three holes inside of its rim, as the plate of a planet carrier."""
    spots = [(10.5 * cos(k * 2 * pi / 3), 10.5 * sin(k * 2 * pi / 3)) for k in range(3)]
    solid = joined(cylinder(13.7, 5), cylinder(9, 17).at(0, 0, 5)) - cylinder(4.7, 22)
    return cut(solid, *(cylinder(1.6, 5).at(x, y, 0) for x, y in spots))


@pytest.mark.parametrize(
    "solid",
    [
        flange(),
        hub(),
        cylinder(3, 20),
        joined(cylinder(3, 20), cylinder(5, 5).at(0, 0, 20)),
        joined(cylinder(30, 200), cylinder(50, 50).at(0, 0, 200)),
        box(20, 10, 5) - cylinder(2, 5).at(0, 0, -2.5),
    ],
    ids=["flange", "hub", "plain shaft", "stepped shaft", "large", "plate"],
)
def test_parts_that_are_no_fasteners(solid: Solid) -> None:
    """A flange that others are screwed to, a plain or stepped shaft, a large spindle and a plate are not fasteners."""
    assert role(solid) is None


def test_a_spool_is_no_screw() -> None:
    """A drum with a bore between two flanges is no screw; with one flange it may be one."""
    drum = cylinder(7, 8) - cylinder(2, 8)
    flange = cylinder(9, 2) - cylinder(2, 2)
    assert role(joined(drum, flange.at(0, 0, 8))) == Role.FASTENER
    assert role(joined(drum, flange.at(0, 0, 8), flange.at(0, 0, -2))) is None


def small_parts(lines: int) -> set[str]:
    """What moves with its host, of a block that is named a nut and of rods through it on some lines, and a frame."""
    at = [(x, 0.0) for x in (-12.0, 12.0)[:lines]]
    nut = box(40, 16, 14)
    for x, y in at:
        nut = nut - cylinder(2, 14).at(x, y, -7)
    rods = [part(f"rod {n}", cylinder(2, 80).at(x, y, -40)) for n, (x, y) in enumerate(at)]
    survey = Survey(assembled(part("nut_block", nut), *rods, part("frame", box(200, 200, 10), z=-45)), ALL_SOURCES)
    return {survey.parts[i].path for i in survey.small}


def test_a_pulley_by_the_name_of_its_belt_is_neither_a_belt_nor_a_screw() -> None:
    """A pulley with flanges, turned to any place, is a link of its own on a shaft; a flat loop is a belt."""
    drum = joined(cylinder(6.1, 8), cylinder(8, 7).at(0, 0, -7), cylinder(8, 1.2).at(0, 0, 8)) - cylinder(2.5, 17).at(
        0, 0, -7
    )
    loop = box(60, 20, 6) - box(58, 18, 6)
    nodes = part("Belt 20T", drum, 11.1, -3.3, 7.7, (0.3, 0.7, 1.1)), part("Belt 200", loop, z=50)
    survey = Survey(assembled(part("frame", box(200, 200, 10), z=-30), *nodes), ALL_SOURCES)
    assert {survey.parts[i].path for i in survey.small} == {"Belt 200"}


@pytest.mark.parametrize(("nut", "is_rod"), [("lead screw nut", False), ("nut", True)])
def test_a_threaded_rod_in_a_drive_nut_is_no_fastener(nut: str, *, is_rod: bool) -> None:
    """A long rod that is named after its thread is the screw of a drive nut around it, and a fastener in any other."""
    block = box(40, 40, 20) - cylinder(4.1, 20).at(0, 0, -10)
    nodes = (
        part("threaded rod M8", cylinder(4, 300).at(0, 0, -150)),
        part(nut, block),
        part("frame", box(9, 9, 900), 90),
    )
    survey = Survey(assembled(*nodes), ALL_SOURCES)
    assert (1 in survey.small) == is_rod
