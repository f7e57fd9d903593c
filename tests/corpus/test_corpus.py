"""Real assemblies of many CAD programs are read, measured and converted, or rejected with the right diagnostic.

The oracles: the index of the corpus, the kernel's own reader without stepbot, trimesh on fine meshes, and the volumes
that CAD programs wrote into their files.
"""

from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import pytest

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostics
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.geometry.inertia import MassProperties
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.model import Robot
from stepbot.robot.validity import check_robot
from stepbot.step.assembly import Assembly, BodyKind
from tests.corpus.files import FILES, READABLE, CorpusFile, index_row
from tests.corpus.plain_kernel import PlainSolid, plain_solids
from tests.corpus.reading import ACCURACY, DEVIATIONS, ReadFile
from tests.unit.assemble.workshop import robot_of, sidecar
from tests.unit.step.in_process import by_path

pytestmark = pytest.mark.slow

Read = Callable[[CorpusFile], ReadFile]


def each(files: tuple[CorpusFile, ...], long: tuple[str, ...]) -> pytest.MarkDecorator:
    """A parameter ``file``; tests of the same file run in the same process, so that it is read once."""
    marks = {
        file: [pytest.mark.xdist_group(file.stem), *([pytest.mark.long] if file.name in long else [])] for file in files
    }
    return pytest.mark.parametrize("file", [pytest.param(file, id=file.stem, marks=marks[file]) for file in files])


MEASURED_ELSEWHERE = "low_cost_robot_follower.step"
"""test_follower.py compares its mass properties with the integrals of the kernel's own reader."""
LARGE = (MEASURED_ELSEWHERE, "openarm_leader_gripper.step", "rotor_pump_ap203.step", "russian_names_cp1251.step")
"""Files that take longer than all others together."""
UNITS = {"box_sides_inch.step": "inch", "dm1_ideas_inch.step": "inch", "s1_autocad_foot.step": "foot"}
DENSITY = 1000.0
"""[kg/m^3]."""
ONE_LINK = 'defaults: {density: 1000}\nparts: {"**": {density: 1000}}\nmass: %s\nlinks: {all: {rest: true}}\n'
INDEX_TOLERANCE = 2e-5
"""Relative deviation allowed for volumes in the index, which another version of the kernel has computed."""


def assembly_of(file: CorpusFile, read: Read) -> Assembly:
    """The assembly of a readable file."""
    assembly = read(file).assembly
    assert assembly is not None
    return assembly


def solids(assembly: Assembly) -> list[int]:
    """For each occurrence of a solid the index of its body."""
    return [c.body for c in assembly.components if c.body >= 0 and assembly.bodies[c.body].kind == BodyKind.SOLID]


@pytest.mark.slow
@each(FILES, LARGE)
def test_reading(file: CorpusFile, read: Read, corpus: Path) -> None:
    """The solids have the number and volume of the index, or an explained one; all are watertight."""
    reading = read(file)
    assert tuple(d.code for d in reading.findings if d.severity != "note") == file.findings
    assembly = assembly_of(file, read)
    missing = {component.missing for component in assembly.components if component.missing}
    assert len(missing) == sum(d.severity == "error" for d in reading.findings)
    if missing:
        return
    by_path(assembly)
    count, volume = index_row(corpus, file.name)
    assert assembly.unit == UNITS.get(file.name, "mm")
    assert len(solids(assembly)) == count
    assert all(assembly.bodies[body].watertight for body in solids(assembly))
    exact = [assembly.bodies[body].exact for body in solids(assembly)]
    total = 1e9 * sum(properties.volume for properties in exact if properties is not None)
    assert None not in exact
    assert (abs(total - volume) > INDEX_TOLERANCE * volume) == bool(file.index_is_off)
    assert total == pytest.approx(file.volume or volume, rel=INDEX_TOLERANCE)


@each(READABLE, (*LARGE, MEASURED_ELSEWHERE))
def test_mass_properties(
    file: CorpusFile, read: Read, corpus: Path, record_property: Callable[[str, object], None]
) -> None:
    """By trimesh alone every solid is within 1e-3 of its exact B-rep; meshes further off are not used."""
    reading = read(file)
    assembly = assembly_of(file, read)
    paths = {c.body: c.path for c in reversed(assembly.components)}
    rows = []
    for number, (body, measure) in enumerate(zip(assembly.bodies, reading.measures, strict=True)):
        if body.kind != BodyKind.SOLID:
            continue
        assert body.exact is not None
        assert body.refined is not None
        assert measure is not None
        written, measuring = measure.deviation_from(body.exact), body.refined.deviation_from(body.exact)
        assert measuring[0] <= ACCURACY
        rows.append((file.name, paths[number], *written, *measuring, "mesh" if written[0] <= ACCURACY else "exact"))
    record_property(DEVIATIONS, rows)


@pytest.mark.slow
@each(READABLE, (*LARGE, MEASURED_ELSEWHERE))
def test_exact_values_are_the_kernels_own(file: CorpusFile, read: Read, corpus: Path) -> None:
    """Simple solids equal GProp's integration bit for bit; others equal its integration span by span to 1e-6.

    The deviation is at most 1.1 times the estimated error. If GProp's default rule deviates by more than 1e-4, meshes
    agree with stepbot.
    """
    plain = plain_solids(corpus / file.name)
    known = {solid.volume for solid in plain}
    bodies = [body for body in assembly_of(file, read).bodies if body.kind == BodyKind.SOLID]
    assert len(bodies) == len(plain)
    for body in bodies:
        assert body.exact is not None
        if body.exact.volume not in known:
            other = min(plain, key=lambda solid: abs(solid.volume - body.exact.volume))  # type: ignore[union-attr]
            off = abs(body.exact.volume / other.volume_by_spans() - 1)
            assert off < 1e-6
            assert off <= 1.1 * body.exact_error
            assert body.exact_error > 1e-9
            if abs(body.exact.volume / other.volume - 1) > 1e-4:
                assert_better(body.exact.unit_density, other)


def assert_better(ours: MassProperties, plain: PlainSolid) -> None:
    """Assert that meshes confirm the first of two volumes."""
    limit = plain.volume_without_integration()
    assert ours.mass == pytest.approx(limit, rel=ACCURACY)
    assert abs(ours.mass - limit) < abs(plain.volume - limit)


def one_link(assembly: Assembly, reading: ReadFile, mass: str, folder: Path) -> tuple[Robot | None, Diagnostics]:
    """A robot with the whole assembly as one link, and its diagnostics."""
    diagnostics = Diagnostics()
    loaded = sidecar(folder, ONE_LINK % mass)
    robot = robot_of(build_robot(assembly, loaded, lambda: reading.measures, diagnostics))
    if robot is not None:
        robot = share_meshes(robot)
        check_robot(robot, diagnostics, loaded.span(), assembly.unit)
    return robot, diagnostics


@pytest.mark.slow
@each(READABLE, (*LARGE, MEASURED_ELSEWHERE))
@pytest.mark.parametrize("mass", ["auto", "mesh", "exact"])
def test_one_link(file: CorpusFile, mass: str, read: Read, tmp_path: Path) -> None:
    """Every file becomes a robot of one link in every format, with the exact mass, com and inertia."""
    assembly, reading = assembly_of(file, read), read(file)
    robot, found = one_link(assembly, reading, mass, tmp_path)
    assert robot is not None
    assert not found.has_errors, "\n".join(map(str, found))
    for name in FORMATS:
        assert render(robot, name, Diagnostics())
    expected = [
        properties.unit_density.scaled(DENSITY).moved(component.X_WC)
        for component in assembly.components
        if component.body >= 0 and (properties := assembly.bodies[component.body].exact) is not None
    ]
    total = sum(part.mass for part in expected)
    link = robot.root.mass_properties
    assert link.mass == pytest.approx(total, rel=1e-12 if mass == "exact" else ACCURACY)
    if not total:
        assert "SB506" in [d.code for d in found]
        return
    com = np.sum([part.mass * np.array(part.com) for part in expected], axis=0) / total
    size = np.linalg.norm(np.subtract(*assembly.bounds(0)))  # type: ignore[misc]
    assert np.abs(np.array(link.com) - com).max() < ACCURACY * size
    inertia = sum(about(part, com) for part in expected)
    assert np.abs(np.array(link.inertia) - inertia).max() < ACCURACY * np.linalg.eigvalsh(inertia)[-1]


def about(
    part: MassProperties, point: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Inertia (3, 3) [kg m^2] about a point, by the parallel axis theorem."""
    d = np.array(part.com) - point
    moved: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = np.array(part.inertia) + part.mass * (
        d @ d * np.eye(3) - np.outer(d, d)
    )
    return moved


def test_references_to_other_files(read: Read) -> None:
    """An assembly whose parts are in four missing files is rejected, and each file is named."""
    reading = read(next(file for file in FILES if file not in READABLE))
    assert [(fault.code, fault.severity) for fault in reading.findings] == [("SB203", "error")] * 4
    for fault, name in zip(reading.findings, ("TAIL.stp", "HEAD.stp", "MAINBODY.stp", "FOOT.stp"), strict=True):
        assert f"'{name}'" in fault.message
        assert fault.help


CLOSED_FORMS = {  # [mm^3]
    "rod-assembly/nut_1": 20 * 15 * 3 - pi * 5**2 * 3,
    "rod-assembly/rod": pi * 5**2 * 200,
    "l-bracket-assembly_1/nut-bolt-assembly_1/bolt": pi * (7.5**2 * 3 + 5**2 * 34),
    "l-bracket-assembly_1/l-bracket": 100_000 - 4 * pi * 5**2 * 10,
    "plate": 180 * 150 * 20 - 6 * pi * 5**2 * 20,
}


def test_closed_forms(read: Read) -> None:
    """Boxes and cylinders drawn with rational B-splines have the volumes of the closed forms.

    The volumes stated by the CAD program deviate by up to 7e-5, as does the kernel's default rule.
    """
    assembly = assembly_of(named("as1-oc-214"), read)
    components = by_path(assembly)
    for path, volume in CLOSED_FORMS.items():
        exact = assembly.bodies[components[path].body].exact
        assert exact is not None
        assert exact.volume * 1e9 == pytest.approx(volume, rel=1e-7)


VALIDATION_VOLUMES = {  # [mm^3] as the CAD programs wrote them into their files
    "dm1_ideas_inch": {"nut_6": 664.380773, "bolt_3": 3436.11607, "l-bracket": 96858.3852},
    "s1_autocad_foot": {
        "MAINBODY/MAIN_BODY_BACK": 5.58333381e10,
        "FOOT_1/FOOT_FRONT": 68064039.7,
        "HEAD/HEAD_FRONT": 629896515.0,
        "TAIL/TAIL_MIDDLE": 571752818.0,
        "TAIL/TAIL_TURBINE_1": 7.49922464e09,
    },
}


def named(stem: str) -> CorpusFile:
    """The file of a name."""
    return next(file for file in FILES if file.stem == stem)


@pytest.mark.parametrize("stem", VALIDATION_VOLUMES)
def test_validation_properties_of_the_file(stem: str, read: Read) -> None:
    """The volumes stated by CAD programs equal those read."""
    assembly = assembly_of(named(stem), read)
    components = by_path(assembly)
    for path, volume in VALIDATION_VOLUMES[stem].items():
        exact = assembly.bodies[components[path].body].exact
        assert exact is not None
        assert exact.volume * 1e9 == pytest.approx(volume, rel=5e-6 if stem.startswith("dm1") else 2e-5)


def test_materials_in_pounds_and_inches(read: Read) -> None:
    """A part of a raw material has its name and its density, in any unit."""
    bolt = by_path(assembly_of(named("dm1_ideas_inch"), read))["bolt_3"]
    assert bolt.material == "Greek Ascoloy"
    assert bolt.density == pytest.approx(0.285230375059732 * 0.4536 / 0.0254**3, rel=1e-9)


def test_body_beside_components(read: Read) -> None:
    """The solid of a product with both a solid and components is a component called body."""
    assembly = assembly_of(named("so101_upper_arm"), read)
    assert [c.path for c in assembly.components] == [".", "Wiring_holder", "Wiring_holder v1 (1)", "body"]


@pytest.mark.long
@pytest.mark.xdist_group("low_cost_robot_follower")
def test_names_of_the_follower(read: Read) -> None:
    """Fusion's save counters are removed, bodies of one part are numbered, and the default density is reported."""
    assembly = assembly_of(named("low_cost_robot_follower"), read)
    components = by_path(assembly)
    assert {"XL-430_new:1/DC11_A01_DUMMY/body#2", "XL,XC-330:6/DC15_A01_HORN_DUMMY", "gripper/moving side"} <= set(
        components
    )
    assert components["XL-430_new:1"].product == "XL-430_new v1"
    assert components["XL-430_new:1"].occurrence == "XL-430_new v1:1"
    assert {c.density for c in assembly.components if c.body >= 0} == {7850.0}
    assert {c.material for c in assembly.components if c.body >= 0} == {"Steel"}


def test_several_roots(read: Read) -> None:
    """Several roots are children of an unnamed root, and equal names are numbered."""
    assembly = assembly_of(named("eight_cylinders_multi_root"), read)
    assert assembly.components[0].path == "."
    assert assembly.components[0].product == ""
    assert [c.path for c in assembly.components if c.parent == 0] == [f"8Cylinders#{n}" for n in range(1, 9)]


def test_triangles_without_a_solid(read: Read) -> None:
    """Tessellated AP242 geometry is displayed; it has a volume if its triangles are closed."""
    reading = read(named("tessellated_only_ap242"))
    assert reading.assembly is not None
    (body,) = reading.assembly.bodies
    assert (body.kind, body.exact) == (BodyKind.TESSELLATED, None)
    assert len(body.mesh.faces) == 128
    assert (reading.measures[0] is not None) == body.watertight
