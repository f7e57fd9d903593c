"""Small STEP files, drawn when a test needs them; names, poses, volumes, centres and inertias are known beforehand.

Every ``write_*`` draws one file and returns a :class:`Drawing` with the expected values, which come from closed forms,
never from the kernel. Arguments are in millimetres, results in SI. W is the assembly.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import pi
from pathlib import Path

from msgspec import Struct, field

from robot_library.moments import NOTHING, Array, Moments, mirror, pose, total, turn
from robot_library.step_file import Assembly, LengthUnit, Occurrence, Part, write_step

from .solids import Solid, box, compound, cone, cylinder, faces, joined, solid_of, sphere, triangles

STEEL, ALUMINIUM = 7850.0, 2700.0
"""[kg/m^3]."""


@dataclass(frozen=True, eq=False)
class Drawn(Part):
    """A product and the integrals of its bodies at density 1 [mm], in its own frame; None for a surface."""

    bodies: tuple[Moments, ...] = ()


def drawn(name: str, solid: Solid, color: str = "", density: float = 0.0) -> Drawn:
    """A product of one solid; with a density also a material name."""
    return Drawn(name, solid.shape, color, (), f"stuff of {density:g}" if density else "", density, (solid.moments,))


class Piece(Struct, frozen=True, eq=False):
    """One body with its pose."""

    path: str
    """Canonical component path."""
    product: str
    occurrence: str
    X_WC: Array
    """Pose of the component in the assembly, shape (4, 4) [m]."""
    body: Moments
    """Integrals at density 1 [m], in the assembly's frame; None for a surface."""
    density: float
    """[kg/m^3] in the STEP; 0 for none."""
    color: str
    """``#rrggbb`` in the STEP; empty for none."""


class Line(Struct, frozen=True):
    """An axis that two components share."""

    point: tuple[float, float, float]
    """The middle of the overlap of both sides [m]."""
    direction: tuple[float, float, float]
    """With the sign of the sidecar's rule."""


class Drawing(Struct, frozen=True, eq=False):
    """A STEP file and its content."""

    path: Path
    unit: LengthUnit
    pieces: tuple[Piece, ...] = ()
    lines: tuple[Line, ...] = field(default=())

    @property
    def body(self) -> Moments:
        """All bodies together at density 1 [m]."""
        return total(*(piece.body for piece in self.pieces))

    @property
    def mass(self) -> Moments:
        """All bodies together [kg, m], each with the density of the STEP."""
        return total(*(piece.body.weighing(piece.density) for piece in self.pieces))

    def __getitem__(self, path: str) -> Piece:
        """The piece with a canonical path."""
        return next(piece for piece in self.pieces if piece.path == path)


def draw(path: Path, root: Drawn | Assembly, unit: LengthUnit = "mm", lines: Sequence[Line] = ()) -> Drawing:
    """Write a tree of products as STEP, and return its content."""
    write_step(path, root, unit=unit)
    return Drawing(path, unit, tuple(_pieces(root)), tuple(lines))


def _pieces(root: Drawn | Assembly) -> Iterator[Piece]:
    if isinstance(root, Assembly):
        yield from _below(root, "", pose())
    else:
        yield from _bodies(root, ".", root.name, pose(), root.color)


def _below(parent: Assembly, above: str, X_WP: Array) -> Iterator[Piece]:
    names = [child.product.name for child in parent.children]
    for child in parent.children:
        segment = _segment(child.product.name if names.count(child.product.name) == 1 else child.name)
        X_WC = X_WP if child.X_AP is None else X_WP @ child.X_AP
        if isinstance(child.product, Assembly):
            yield from _below(child.product, f"{above}{segment}/", X_WC)
        else:
            assert isinstance(child.product, Drawn)
            yield from _bodies(child.product, above + segment, child.name, X_WC, child.color or child.product.color)


def _segment(name: str) -> str:
    """A name in a component path: stripped of blanks and save counter, a backslash before `/`, `*` and `#`."""
    return re.sub(r"([/*#])", r"\\\1", re.sub(r" v\d+(?=(:\d+)?$)", "", name.strip()))


def _bodies(part: Drawn, path: str, occurrence: str, X_WC: Array, color: str) -> Iterator[Piece]:
    X = pose(X_WC[:3, 3] / 1000, X_WC[:3, :3])
    bodies = part.bodies or (NOTHING,)
    for i, body in enumerate(bodies, start=1):
        own = path if len(bodies) == 1 else f"{path}/body#{i}"
        yield Piece(own, part.name, occurrence, X, body.in_metres().moved(X), part.density, color)


# One body


def write_box(
    path: Path,
    size: tuple[float, float, float] = (100.0, 60.0, 40.0),
    unit: LengthUnit = "mm",
    density: float = 0.0,
    color: str = "#3366cc",
) -> Drawing:
    """A box whose corner is the origin: its com is half its size."""
    x, y, z = size
    return draw(path, drawn("block", box(x, y, z).at(x / 2, y / 2, z / 2), color, density), unit)


def write_cylinder(path: Path, radius: float = 20.0, height: float = 70.0, unit: LengthUnit = "mm") -> Drawing:
    """A cylinder along +z with its base at the origin."""
    return draw(path, drawn("pin", cylinder(radius, height)), unit)


def write_cone(path: Path, lower: float = 20.0, upper: float = 8.0, height: float = 50.0) -> Drawing:
    """A truncated cone along +z with its base at the origin."""
    return draw(path, drawn("cone", cone(lower, upper, height)))


def write_sphere(path: Path, radius: float = 30.0, unit: LengthUnit = "mm") -> Drawing:
    """A sphere around the origin: of all bodies the one with the largest error of a coarse mesh."""
    return draw(path, drawn("ball", sphere(radius)), unit)


def write_bored_plate(path: Path, unit: LengthUnit = "mm", density: float = 0.0) -> Drawing:
    """A plate with a wide bore and four narrow ones, none in the middle."""
    plate = box(120, 80, 10) - cylinder(15, 10).at(20, 10, -5)
    for x, y in product((-50, 50), (-30, 30)):
        plate -= cylinder(3, 10).at(x, y, -5)
    return draw(path, drawn("plate", plate, "#808080", density), unit)


def write_two_solids(path: Path) -> Drawing:
    """One part with two separate solids."""
    first, second = box(20, 30, 40), box(10, 10, 10).at(50, 0, 0)
    pair = Drawn("pair", compound(first.shape, second.shape), "#cc6633", bodies=(first.moments, second.moments))
    return draw(path, Assembly("root", [Occurrence(pair, "pair:1", pose((0, 0, 100)))]))


def write_surface_body(path: Path) -> Drawing:
    """A block, and beside it a sheet: an open face without mass."""
    sheet = Drawn("sheet", faces(box(80, 50, 10).shape)[0], "#00aa00")
    block = drawn("block", box(10, 20, 30))
    return draw(path, Assembly("root", [Occurrence(block, "block:1"), Occurrence(sheet, "sheet:1", pose((60, 0, 0)))]))


def write_open_solid(path: Path) -> Drawing:
    """A box declared as a solid that lacks one face; its volume is undefined."""
    return draw(path, Drawn("open box", solid_of(faces(box(40, 40, 40).shape)[1:])))


def write_tessellated(path: Path, closed: bool = True) -> Drawing:
    """A box of twelve triangles without exact geometry or, not closed, of eleven."""
    block = box(30, 40, 50)
    return draw(path, Drawn("scan", triangles(30, 40, 50, closed), bodies=(block.moments,) if closed else ()))


def write_colored_faces(path: Path) -> Drawing:
    """A blue box with one red face, x = -15."""
    block = box(30, 40, 50)
    red = ((faces(block.shape)[0], "#ff0000"),)
    return draw(path, Drawn("block", block.shape, "#0000ff", red, bodies=(block.moments,)))


# Assemblies


def write_nested(path: Path, unit: LengthUnit = "mm") -> Drawing:
    """Three levels, a subassembly that occurs twice, colours, two densities, and a part without density.

    machine / frame / {plate, bolt:1, bolt:2}, machine / slide:1, slide:2 / {carriage, bolt, knob}.
    """
    bolt = drawn("bolt", cylinder(4, 20) + cylinder(7, 5).at(0, 0, 20), "#222222", STEEL)
    plate = drawn("plate", box(200, 100, 10), "#b0b0b0", ALUMINIUM)
    carriage = drawn("carriage", box(40, 30, 20) - cylinder(5, 20).at(8, 4, -10), "#dd8800", ALUMINIUM)
    knob = drawn("knob", sphere(6), "#cc0000")
    frame = Assembly(
        "frame",
        [
            Occurrence(plate, "plate:1"),
            Occurrence(bolt, "bolt:1", pose((80, 30, 5))),
            Occurrence(bolt, "bolt:2", pose((-80, 30, 5), turn("x", pi)), color="#00cccc"),
        ],
    )
    slide = Assembly(
        "slide",
        [
            Occurrence(carriage, "carriage:1"),
            Occurrence(bolt, "bolt:1", pose((0, 0, 10), turn("y", pi / 2))),
            Occurrence(knob, "knob:1", pose((0, 0, 40))),
        ],
    )
    tilted = turn("z", 0.3) @ turn("x", -0.7)
    return draw(
        path,
        Assembly(
            "machine",
            [
                Occurrence(frame, "frame:1"),
                Occurrence(slide, "slide:1", pose((50, 0, 60))),
                Occurrence(slide, "slide:2", pose((-50, 20, 80), tilted)),
            ],
        ),
        unit,
    )


def write_mirrored(path: Path) -> Drawing:
    """A chiral bracket, and an occurrence of it mirrored through x = 0."""
    bracket = box(40, 10, 10).at(20, 0, 0) + box(10, 30, 10).at(35, 20, 0) + box(10, 10, 50).at(35, 30, 30)
    part = drawn("bracket", bracket, "#558855", ALUMINIUM)
    root = Assembly(
        "pair of brackets",
        [Occurrence(part, "left", pose((10, 0, 0))), Occurrence(part, "right", pose((-10, 0, 0), mirror("x")))],
    )
    return draw(path, root)


def write_many(path: Path, count: int = 100) -> Drawing:
    """Many occurrences of one pin in a row."""
    pin = drawn("pin", cylinder(2, 10), density=STEEL)
    return draw(path, Assembly("row", [Occurrence(pin, f"pin:{i + 1}", pose((5 * i, 0, 0))) for i in range(count)]))


def write_same_names(path: Path) -> Drawing:
    """Three occurrences of one product with the same name, distinguished only by their order."""
    pin = drawn("pin", cylinder(2, 10))
    children = [Occurrence(pin, "pin", pose((20 * i, 0, 0))) for i in range(3)]
    drawing = draw(path, Assembly("row", children))
    pieces = (Piece(f"pin#{i}", *_rest(piece)) for i, piece in enumerate(drawing.pieces, start=1))
    return Drawing(path, drawing.unit, tuple(pieces))


AWKWARD_NAMES = ("a/b", "x*y", "n#1", "back\\slash", "XL,XC-330", "it's", "Wälzlager Ø12", "трубка", "螺丝", " padded ")
"""Product names that are special in a path, in YAML or in an encoding."""


def write_awkward_names(path: Path) -> Drawing:
    """Products with special names, and one with the save counters of Fusion: ``Motor v3``, ``Motor v3:1``."""
    blocks = (drawn(name, box(10, 10, 10)) for name in (*AWKWARD_NAMES, "Motor v3"))
    children = [Occurrence(block, f"{block.name}:1", pose((0, 20 * i, 0))) for i, block in enumerate(blocks)]
    return draw(path, Assembly("names", children))


def write_several_roots(path: Path) -> Drawing:
    """A file without a common root: a block and a pin side by side."""
    block, pin = drawn("block", box(10, 20, 30)), drawn("pin", cylinder(5, 40).at(50, 0, 0))
    write_step(path, block, pin)
    pieces = (_bodies(part, part.name, "", pose(), "") for part in (block, pin))
    return Drawing(path, "mm", tuple(piece for of_one in pieces for piece in of_one))


# Parts that joints bind to


STRAIGHT_ARM_GAP = 228.0
"""[mm]."""


def write_straight_arm(path: Path, pin: bool = True) -> Drawing:
    """Two links of an arm drawn straight: an elbow along y, and a wide horn and a bracket 228 mm apart on one line.

    Args:
        path: File to write.
        pin: Whether the upper link has the pin of the elbow; without it, only horn and bracket share a line.
    """
    top = 5.0 + STRAIGHT_ARM_GAP
    upper = cylinder(20, 5) + box(30, 20, top - 13).at(0, 0, 5 + (top - 13) / 2)
    lower = box(30, 10, 48).at(0, 15, top - 24) + box(60, 60, 8).at(0, 0, top + 4) - cylinder(20.2, 8).at(0, 0, top)
    along_y = pose((0, 0, 0), turn("x", -pi / 2))
    lower -= cylinder(8.05, 10).moved(along_y).at(0, 10, top - 28)
    if pin:
        upper += cylinder(8, 12).moved(along_y).at(0, 10, top - 28)
    children = [Occurrence(drawn("upper", upper), "upper:1"), Occurrence(drawn("lower", lower), "lower:1")]
    elbow = Line((0.0, 0.015, (top - 28) * 1e-3), (0.0, 1.0, 0.0))
    return draw(path, Assembly("straight arm", children), lines=(elbow,) if pin else ())


def write_hinge(path: Path, miss: float = 0.0, bolts: bool = False, unit: LengthUnit = "mm") -> Drawing:
    """A plate with a pin and an arm with a bore around it, along y.

    Args:
        path: File to write.
        miss: Distance of the bore from the pin along x [mm]; above 0.01 mm the two no longer mate.
        bolts: Whether a bolt circle adds four narrow lines that both parts share.
        unit: Length unit of the file.
    """
    plate = box(80, 80, 10) + cylinder(10, 20).at(0, 0, 5)
    arm = box(40, 120, 10).at(0, 45, 0) - cylinder(10.05, 10).at(miss, 0, -5)
    if bolts:
        for x, y in product((-14, 14), (-14, 14)):
            plate -= cylinder(1.5, 10).at(x, y, -5)
            arm -= cylinder(1.6, 10).at(x, y, -5)
    upright = turn("x", -pi / 2)
    root = Assembly(
        "hinge",
        [
            Occurrence(drawn("plate", plate, "#707070", STEEL), "plate:1", pose((100, 0, 50), upright)),
            Occurrence(drawn("arm", arm, "#d08000", ALUMINIUM), "arm:1", pose((100, 11, 50), upright)),
        ],
    )
    # Pin from 5 to 25 above the middle of the plate, arm from 6 to 16.
    lines = () if miss > 0.01 else (Line((0.1, 0.011, 0.05), (0.0, 1.0, 0.0)),)
    return draw(path, root, unit, lines)


def write_turntable(path: Path, X: Array | None = None) -> Drawing:
    """An arm on the pin of a foot, drawn upright or moved by a pose (4, 4) [mm]: a robot without symmetry."""
    X = pose() if X is None else X
    foot = box(120, 80, 10).at(0, 10, 5) + cylinder(10, 50).at(0, 0, 5)
    arm = box(40, 40, 20).at(0, 0, 50) - cylinder(10.05, 20).at(0, 0, 40) + box(30, 10, 140).at(30, 5, 130)
    tip = arm + cylinder(4, 20).at(30, 5, 200)
    return draw(
        path,
        Assembly(
            "turntable",
            [
                Occurrence(drawn("foot", foot, "#707070", STEEL), "foot:1", X),
                Occurrence(drawn("arm", tip, "#d08000", ALUMINIUM), "arm:1", X),
            ],
        ),
    )


def write_slider(path: Path) -> Drawing:
    """Two parallel rods in a holder, and a block that slides on both along x."""
    along = turn("y", pi / 2)
    rods = (cylinder(4, 100).moved(pose((5, y, 0), along)) for y in (-20, 20))
    holder = joined(box(10, 60, 20), *rods)
    block = box(30, 60, 20).at(40, 0, 0)
    for y in (-20, 20):
        block -= cylinder(4.1, 30).moved(pose((25, y, 0), along))
    lines = (Line((0.04, y, 0.0), (1.0, 0.0, 0.0)) for y in (-0.02, 0.02))
    children = [Occurrence(drawn("holder", holder), "holder:1"), Occurrence(drawn("block", block), "block:1")]
    return draw(path, Assembly("slider", children), lines=tuple(lines))


# Files that a reader rejects or reports


def write_empty(path: Path) -> Drawing:
    """An assembly without parts: valid STEP with one product and no shape."""
    _write_text(path, _PRODUCT)
    return Drawing(path, "mm")


def write_external_reference(path: Path) -> Drawing:
    """A product whose shape is in another file, ``elsewhere.step``, which is missing."""
    _write_text(path, _PRODUCT + _EXTERNAL)
    return Drawing(path, "mm")


def write_needless_reference(path: Path) -> Drawing:
    """A box whose product also refers to another file, ``elsewhere.step``."""
    drawing = write_box(path)
    text = path.read_text(encoding="utf-8")
    definition = re.search(r"(#\d+) *= *PRODUCT_DEFINITION *\(", text)
    assert definition is not None
    reference = (
        "#900001=DOCUMENT_TYPE('geometry');\n#900002=DOCUMENT_FILE('elsewhere.step','','',#900001,'',$);\n"
        f"#900003=APPLIED_DOCUMENT_REFERENCE(#900002,'',({definition[1]}));\n"
    )
    path.write_text(text.replace("ENDSEC;\nEND-ISO", f"{reference}ENDSEC;\nEND-ISO"), encoding="utf-8", newline="\n")
    return drawing


def write_without_unit(path: Path) -> Drawing:
    """A box in a file without a length unit."""
    drawing = write_box(path)
    text = path.read_text(encoding="utf-8")
    context = "GLOBAL_UNIT_ASSIGNED_CONTEXT(("
    before, after = text.split(context)
    length, others = after.split(",", 1)
    assert f"{length}=( LENGTH_UNIT()" in text
    path.write_text(before + context + others, encoding="utf-8", newline="\n")
    return drawing


_PRODUCT = """\
#1=APPLICATION_CONTEXT('automotive design');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT('nothing','nothing','',(#2));
#4=PRODUCT_DEFINITION_FORMATION('','',#3);
#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#6=PRODUCT_DEFINITION('design','',#4,#5);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#10=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#11=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#8,'distance_accuracy_value','');
#12=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#11))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#8,#9,#10))REPRESENTATION_CONTEXT('',''));
#13=CARTESIAN_POINT('',(0.,0.,0.));
#14=AXIS2_PLACEMENT_3D('',#13,$,$);
#15=SHAPE_REPRESENTATION('',(#14),#12);
#16=SHAPE_DEFINITION_REPRESENTATION(#7,#15);
"""
_EXTERNAL = """\
#17=DOCUMENT_TYPE('geometry');
#18=DOCUMENT_FILE('elsewhere.step','','',#17,'',$);
#19=APPLIED_DOCUMENT_REFERENCE(#18,'',(#6));
#20=EXTERNAL_SOURCE(IDENTIFIER(''));
#21=IDENTIFICATION_ROLE('external document id and location',$);
#22=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('elsewhere.step',#21,#20,(#18));
#23=DOCUMENT_REPRESENTATION_TYPE('digital',#18);
#24=PROPERTY_DEFINITION('external definition','',#6);
#25=PROPERTY_DEFINITION_REPRESENTATION(#24,#15);
"""


def _write_text(path: Path, statements: str) -> None:
    header = (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
        "FILE_NAME('','2000-01-01T00:00:00',(''),(''),'','','');\n"
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
    )
    path.write_text(f"{header}{statements}ENDSEC;\nEND-ISO-10303-21;\n", encoding="utf-8", newline="\n")


def _rest(piece: Piece) -> tuple[str, str, Array, Moments, float, str]:
    return (piece.product, piece.occurrence, piece.X_WC, piece.body, piece.density, piece.color)
