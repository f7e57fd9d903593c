"""Kinematic pairs read from the text of a STEP file."""

from math import pi

import pytest

from stepbot.step.exchange.entities import read_entities
from stepbot.step.exchange.mechanisms import KinematicPair, Mechanism, Occurrence, mechanism_of

LINKS = """
#1=KINEMATIC_LINK('base'); #2=KINEMATIC_LINK('arm'); #3=KINEMATIC_JOINT('j',#1,#2);
#4=CARTESIAN_POINT('',(1.,2.,3.)); #5=DIRECTION('',(0.,1.,0.)); #6=DIRECTION('',(0.,0.,2.));
#7=AXIS2_PLACEMENT_3D('',#4,#5,#6); #8=AXIS2_PLACEMENT_3D('',#4,$,$);
"""
FLAGS = ".F.,.F.,.F.,.F.,.F.,.T."


def mechanism(text: str) -> Mechanism:
    """The mechanism of some statements with two links, a joint and two placements."""
    found = mechanism_of(read_entities((LINKS + text).encode(), "utf-8"))
    assert found is not None
    return found


def pair(text: str) -> KinematicPair:
    """The only pair of some statements."""
    (only,) = mechanism(text).pairs
    return only


def test_placements_are_right_handed_and_default_where_left_out() -> None:
    """The z axis is the given axis, x the perpendicular part of the reference direction; both have defaults."""
    first, second = pair(f"#9=REVOLUTE_PAIR('p','','',#7,#8,#3,{FLAGS});").placements
    assert first.position == (1.0, 2.0, 3.0)
    assert first.rotation == ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))  # columns: the file's z, x, y
    assert second.rotation == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("text", "dofs", "is_stated"),
    [
        (f"REVOLUTE_PAIR('p','','',#7,#8,#3,{FLAGS})", (5,), True),
        ("REVOLUTE_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (5,), False),
        ("REVOLUTE_PAIR('p','',#7,#8,#3)", (5,), False),
        ("PRISMATIC_PAIR('p','','',#7,#8,#3,.F.,.F.,.T.,.F.,.F.,.F.)", (2,), True),
        ("PRISMATIC_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (0,), False),
        ("CYLINDRICAL_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (2, 5), False),
        ("SPHERICAL_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (3, 4, 5), False),
        ("PLANAR_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (0, 1, 5), False),
        ("UNIVERSAL_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*,$)", (3, 5), False),
        ("FULLY_CONSTRAINED_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*)", (), False),
        ("LOW_ORDER_KINEMATIC_PAIR('p','','',#7,#8,#3,.F.,.T.,.F.,.F.,.T.,.F.)", (1, 4), True),
        (
            f"(GEOMETRIC_REPRESENTATION_ITEM() ITEM_DEFINED_TRANSFORMATION('','',#7,#8) KINEMATIC_PAIR(#3)"
            f" LOW_ORDER_KINEMATIC_PAIR({FLAGS}) REPRESENTATION_ITEM('p') REVOLUTE_PAIR())",
            (5,),
            True,
        ),
    ],
)
def test_degrees_of_freedom_of_each_kind(text: str, dofs: tuple[int, ...], is_stated: bool) -> None:
    """Degrees of freedom are the file's flags, or those of the standard for the kind if omitted."""
    found = pair(f"#9={text};")
    assert (found.name, found.links, found.dofs, found.is_stated) == ("p", (0, 1), dofs, is_stated)


@pytest.mark.parametrize(
    ("text", "bounds"),
    [
        (f"#9=REVOLUTE_PAIR_WITH_RANGE('p','','',#7,#8,#3,{FLAGS},-1.5,0.5);", (-1.5, 0.5)),
        (f"#9=REVOLUTE_PAIR_WITH_RANGE('p','','',#7,#8,#3,{FLAGS},$,0.5);", (None, 0.5)),
        (f"#9=REVOLUTE_PAIR('p','','',#7,#8,#3,{FLAGS});", (None, None)),
        ("#9=REVOLUTE_PAIR('p','',#7,#8,#3);"
         " #10=REVOLUTE_PAIR_RANGE(#9,PLANE_ANGLE_MEASURE(-1.),PLANE_ANGLE_MEASURE(2.));", (-1.0, 2.0)),
        ("#9=REVOLUTE_PAIR('p','',#7,#8,#3); #10=REVOLUTE_PAIR_RANGE(#9,.UNLIMITED_RANGE.,PLANE_ANGLE_MEASURE(2.));",
         (None, 2.0)),
        ("#9=PRISMATIC_PAIR_WITH_RANGE('p','','',#7,#8,#3,*,*,*,*,*,*,-20.,30.);", (-20.0, 30.0)),
        ("#9=(GEOMETRIC_REPRESENTATION_ITEM() ITEM_DEFINED_TRANSFORMATION('','',#7,#8) KINEMATIC_PAIR(#3)"
         " LOW_ORDER_KINEMATIC_PAIR(*,*,*,*,*,*) REPRESENTATION_ITEM('p') REVOLUTE_PAIR()"
         " REVOLUTE_PAIR_WITH_RANGE(-1.,1.));", (-1.0, 1.0)),
    ],
)  # fmt: skip
def test_ranges(text: str, bounds: tuple[float | None, float | None]) -> None:
    """Ranges are in the pair, in a part of a complex one, or in a separate entity in AP214."""
    assert pair(text).bounds == bounds


def test_ranges_in_degrees_are_converted() -> None:
    """Angles are converted by the unit of the mechanism's context; lengths stay in the file's unit."""
    text = f"""
    #9=REVOLUTE_PAIR_WITH_RANGE('p','','',#7,#8,#3,{FLAGS},-90.,180.);
    #20=MECHANISM_REPRESENTATION('',(#9),#21,$);
    #21=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#22)) REPRESENTATION_CONTEXT('',''));
    #22=(CONVERSION_BASED_UNIT('DEGREE',#23) NAMED_UNIT($) PLANE_ANGLE_UNIT());
    #23=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(1.745329251994E-02),#24);
    #24=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
    """
    assert pair(text).bounds == pytest.approx((-pi / 2, pi), rel=1e-9)


def test_screw_has_a_pitch_and_perhaps_a_range() -> None:
    """A screw has a pitch, followed by an optional range."""
    assert pair("#9=SCREW_PAIR('p','','',#7,#8,#3,*,*,*,*,*,*,2.5);").pitch == 2.5
    found = pair("#9=SCREW_PAIR_WITH_RANGE('p','','',#7,#8,#3,*,*,*,*,*,*,2.5,-1.,6.);")
    assert (found.pitch, found.bounds, found.dofs) == (2.5, (-1.0, 6.0), (2, 5))


def test_links_know_their_occurrences() -> None:
    """A link's representation refers to the usage of a product in an assembly, counted in file order."""
    text = f"""
    #9=REVOLUTE_PAIR('p','','',#7,#8,#3,{FLAGS});
    #30=PRODUCT('r','robot','',()); #31=PRODUCT_DEFINITION_FORMATION('','',#30); #32=PRODUCT_DEFINITION('','',#31,$);
    #33=PRODUCT('b','','',()); #34=PRODUCT_DEFINITION_FORMATION('','',#33); #35=PRODUCT_DEFINITION('','',#34,$);
    #36=NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','b:1','',#32,#35,$);
    #37=NEXT_ASSEMBLY_USAGE_OCCURRENCE('2','b:2','',#32,#35,$);
    #40=RIGID_LINK_REPRESENTATION('',(#8),$,#2);
    #41=KINEMATIC_LINK_REPRESENTATION_ASSOCIATION('','',#40,$);
    #42=PRODUCT_DEFINITION_RELATIONSHIP_KINEMATICS('','',#37);
    #43=CONTEXT_DEPENDENT_KINEMATIC_LINK_REPRESENTATION(#41,#42);
    #44=RIGID_LINK_REPRESENTATION('',(#7),$,#1);
    #45=KINEMATIC_PROPERTY_MECHANISM_REPRESENTATION($,$,#44);
    """
    found = mechanism(text)
    assert [link.occurrences for link in found.links] == [(), (Occurrence("robot", "b", 2),)]
    assert found.base == 0


def test_pairs_that_are_no_joint_are_named() -> None:
    """A gear pair, and a pair without placements, are listed as unsupported."""
    found = mechanism(
        "#9=GEAR_PAIR('g','','',#7,#8,#3,*,*,*,*,*,*,1.,2.,0.,0.,1.); #10=REVOLUTE_PAIR('r','','',$,#8,#3);"
    )
    assert (found.pairs, found.unread) == ((), ("g (gear_pair)", "r (revolute_pair)"))
    assert mechanism_of(read_entities(LINKS.encode(), "utf-8")) is None
    assert mechanism_of(read_entities(b"#1=REVOLUTE_PAIR('broken',(;#2=KINEMATIC_JOINT('',#1", "")) is None
