"""Mass counted twice by overlapping solids, against closed forms, and pairs that do not overlap."""

import os
import signal
import sys
from collections.abc import Mapping, Sequence
from math import pi
from pathlib import Path

import numpy as np
import pytest
import trimesh
from msgspec.structs import force_setattr, replace

from stepbot.assemble.binder import Binder
from stepbot.assemble.claims import claim
from stepbot.assemble.double_counting import DoubleCounting, OverlapSearch
from stepbot.assemble.masses import masses
from stepbot.assemble.material_assignment import assign_materials
from stepbot.assemble.measured_bodies import measured_bodies
from stepbot.diagnostics import Diagnostics
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.mesh_worker import MESH_WORKER
from stepbot.geometry.solids import overlapping
from stepbot.geometry.solids.manifolds import Solid, union_volume
from stepbot.geometry.solids.overlapping import Candidate, Group, Overlaps, Search, overlaps_of
from stepbot.geometry.spatial import Pose, rotation_about
from stepbot.runtime.cache import Cache
from stepbot.runtime.worker import Worker
from tests.conftest import ReadDiagnostics
from tests.processes import call_isolated
from tests.unit.assemble.workshop import Workshop, at, build, sidecar

ONE = "    links: {base: {rest: true}}\n"
WATER = "    defaults: {density: 1000}\n"
CUBE = 1e-6
"""Volume [m^3] of the cube of 10 mm."""


def _overlaps(shop: Workshop, folder: Path, text: str, max_faces: int = 10**6) -> Overlaps:
    """The overlaps of the only link."""
    diagnostics = Diagnostics()
    binder = Binder(shop.assembly, sidecar(folder, text), diagnostics)
    materials = assign_materials(binder)
    claims = claim(binder, materials)
    weighed = masses(binder, materials, measured_bodies(shop.assembly, shop.measures, binder.document.mass))
    (overlaps,) = OverlapSearch(shop.assembly, {"base": claims.parts_of("base")}, weighed, max_faces).result().values()
    return overlaps


def test_boxes_that_overlap(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Two boxes that share a quarter are a warning at the link, with both names, the volume and the mass."""
    shop = Workshop()
    shop.box("left", (40, 10, 10))
    shop.box("right", (40, 10, 10), at(30, 0, 0))
    assert build(shop, tmp_path, WATER + ONE, diagnostics) is not None
    (fault,) = diagnostics
    assert (fault.code, fault.severity, fault.span.line) == ("SB512", "warning", 5)
    assert "link 'base'" in fault.message
    assert "1 g of 8 g" in fault.message
    assert fault.notes == ('"left" and "right": 1000 mm^3, 1 g',)


def test_the_mass_in_the_file_is_not_changed(tmp_path: Path) -> None:
    """Mass counted twice is reported and not subtracted."""
    shop = Workshop()
    shop.box("a", density=1000)
    shop.box("b", X_PC=at(5, 0, 0), density=1000)
    robot = build(shop, tmp_path, ONE + "    step_density: use\n", Diagnostics())
    assert robot is not None
    assert robot.root.mass_properties.mass == pytest.approx(2000 * CUBE)


@pytest.mark.parametrize(
    ("gap", "pairs"),
    [(10.0, 0), (10.5, 0), (9.9995, 0), (9.995, 0), (9.98, 1)],
    ids=["touch", "apart", "press fit of half a micron", "5e-4 of each", "2e-3 of each"],
)
def test_touching_and_press_fits_are_none(gap: float, pairs: int, tmp_path: Path) -> None:
    """Adjacent cubes of 10 mm do not overlap; an overlap counts from 1e-3 of the smaller one."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(gap, 0, 0))
    overlaps = _overlaps(shop, tmp_path, WATER + ONE)
    assert len(overlaps.pairs) == pairs
    if pairs:
        assert overlaps.mass == pytest.approx((10 - gap) * 1e-3 * 1e-4 * 1000, rel=1e-6)


def test_a_shaft_in_its_bore_is_none(tmp_path: Path) -> None:
    """The prisms of two cylinders that touch along a line have a negligible overlap."""
    shop = Workshop()
    shop.rod("a", radius=5, sides=24)
    shop.rod("b", radius=5, X_PC=at(9.95, 0, 0, (0, 0, 0.13)), sides=24)
    assert not _overlaps(shop, tmp_path, WATER + ONE).pairs


def test_the_lighter_material_gives_way(tmp_path: Path) -> None:
    """A steel rod in plastic without a hole counts the plastic in its place, at the density of plastic."""
    shop = Workshop()
    shop.box("block", (40, 40, 40), density=1200)
    shop.rod("screw", 4, 20, density=7850, sides=256)
    overlaps = _overlaps(shop, tmp_path, ONE)
    screw = shop.measures[1]
    assert screw is not None
    assert overlaps.mass == pytest.approx(1200 * screw.volume, rel=1e-6)


def test_what_was_measured_is_not_counted_twice(tmp_path: Path) -> None:
    """A weighed motor in a bracket counts the bracket's share; two weighed parts count nothing."""
    shop = Workshop()
    shop.box("bracket", (40, 40, 40), density=2700)
    shop.box("motor", (20, 20, 20), density=9000)
    rule = "    parts: {motor: {mass: 57 g}%s}\n"
    assert _overlaps(shop, tmp_path, rule % "" + ONE).mass == pytest.approx(2700 * 8e-6)
    assert not _overlaps(shop, tmp_path, rule % ", bracket: {mass: 90 g}" + ONE).pairs


def test_a_solid_without_triangles(tmp_path: Path) -> None:
    """A solid without triangles has its exact mass; the others are compared without it."""
    shop = Workshop()
    for name, x in (("a", 0), ("b", 5), ("c", 5)):
        shop.box(name, X_PC=at(x, 0, 0), density=1000)
    shop.bodies[2] = replace(shop.bodies[2], mesh=TriMesh.of(np.empty((0, 3)), np.empty((0, 3))))
    (pair,) = _overlaps(shop, tmp_path, ONE).pairs
    assert pair.mass == pytest.approx(0.5e-3)


def test_links_that_are_given_their_mass_are_left_alone(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A link with an ``inertial`` counts nothing twice, and parts in two links are not compared."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(5, 0, 0))
    build(shop, tmp_path, "    links: {base: {rest: true, inertial: {mass: 10 g}}}\n", diagnostics)
    two = """
    links: {base: {rest: true}, arm: {parts: [b]}}
    joints: {j: {type: fixed, parent: base, child: arm, origin: {xyz: [0, 0, 0]}}}
"""
    assert build(shop, tmp_path, WATER + two, diagnostics) is not None
    assert not len(diagnostics)


def test_equal_pairs_are_intersected_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Twenty pairs of the same parts in the same relative pose cost one intersection, in any orientation."""
    from stepbot.geometry.solids.manifolds import Intersection, Solid
    from stepbot.geometry.spatial import Pose

    calls = []
    original = Solid.intersection

    def counted(self: Solid, other: Solid, X_AB: Pose) -> Intersection:
        calls.append(X_AB)
        return original(self, other, X_AB)

    monkeypatch.setattr(Solid, "intersection", counted)
    shop = Workshop()
    case = screw = -1
    for i in range(20):
        motor = shop.group("motor", X_PC=at(100 * i, 3 * i, -i, (0.1 * i, 0.2, -0.3 * i)))
        if i == 0:
            case = shop.box("case", (30, 30, 30), parent=motor)
            screw = shop.box("screw", (4, 4, 10), at(0, 0, 16), parent=motor)
        else:
            shop.again(case, at(0, 0, 0), motor)
            shop.again(screw, at(0, 0, 16), motor)
    overlaps = _overlaps(shop, tmp_path, WATER + ONE)
    assert len(calls) == 1
    assert len(overlaps.pairs) == 20
    assert overlaps.mass == pytest.approx(20 * 4 * 4 * 4 * 1e-6)


def test_what_three_share_counts_twice_and_not_thrice(tmp_path: Path) -> None:
    """A part three times at one place has three overlapping pairs, and counts twice too often."""
    shop = Workshop()
    first = shop.box("a")
    shop.again(first, at(0, 0, 0))
    shop.again(first, at(0, 0, 0))
    overlaps = _overlaps(shop, tmp_path, WATER + ONE)
    assert [pair.is_repeated for pair in overlaps.pairs] == [True] * 3
    assert overlaps.mass == pytest.approx(2 * CUBE * 1000)


def test_a_part_that_is_there_twice_is_named(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The help for a copy at the same place is a snippet that ignores it, and the snippet works."""
    shop = Workshop()
    first = shop.box("bolt", occurrence="bolt:1")
    shop.again(first, at(0, 0, 0), occurrence="bolt:2")
    build(shop, tmp_path, WATER + ONE, diagnostics)
    (fault,) = diagnostics
    assert '`parts: {"bolt:2": {ignore: true}}`' in fault.help[0]
    again = Diagnostics()
    robot = build(shop, tmp_path, WATER + '    parts: {"bolt:2": {ignore: true}}\n' + ONE, again)
    assert robot is not None
    assert not list(again)


def test_little_overlaps_are_a_note(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """An overlap below 1e-3 of the link's mass is a note with the heaviest pair."""
    shop = Workshop()
    shop.box("block", (100, 100, 100))
    shop.box("pin", (4, 4, 10), at(0, 0, 50))
    shop.box("label", (2, 2, 2), at(30, 0, 50))
    assert build(shop, tmp_path, WATER + ONE, diagnostics) is not None
    (note,) = diagnostics
    assert (note.code, note.severity) == ("SB513", "note")
    assert "2 pairs of solids" in note.message
    assert note.notes == ('link \'base\': 0.084 g are counted twice, most of it in "block" and "pin": 80 mm^3, 0.08 g',)


def test_unchecked_pairs_are_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """Pairs beyond the limit of faces, or with open meshes, are listed with their largest possible mass."""
    shop = Workshop()
    shop.box("a", (40, 10, 10))
    shop.box("b", (40, 10, 10), at(20, 0, 0))
    shop.box("c", (40, 10, 10), at(50, 0, 0))
    overlaps = _overlaps(shop, tmp_path, WATER + ONE, max_faces=24)
    assert [(pair.first, pair.second) for pair in overlaps.pairs] == [(1, 2)]
    assert [(pair.first, pair.second) for pair in overlaps.unchecked] == [(2, 3)]
    assert overlaps.unchecked[0].mass == pytest.approx(1e-3)

    binder = Binder(shop.assembly, sidecar(tmp_path, WATER + ONE), diagnostics)
    materials = assign_materials(binder)
    weighed = masses(binder, materials, measured_bodies(shop.assembly, shop.measures, binder.document.mass))
    DoubleCounting(binder, claim(binder, materials), weighed, max_faces=0).report()
    (note,) = diagnostics
    assert (note.code, note.severity) == ("SB514", "note")
    assert "2 pairs of solids were not checked" in note.message
    assert note.notes[0] == '"a" and "b": all pairs together have more than 0 faces; at most 2 g are counted twice'


def overlap_with_an_open_mesh() -> Workshop:
    """Two overlapping boxes, one of them with an open mesh."""
    shop = Workshop()
    shop.box("a")
    shop.box("b", X_PC=at(5, 0, 0))
    mesh = shop.bodies[0].mesh
    force_setattr(shop.bodies[0], "mesh", TriMesh.of(mesh.vertices, mesh.faces[1:]))
    shop.measures[0] = None
    return shop


def test_an_open_mesh_cannot_be_checked(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A solid with an open mesh has its exact mass; its unknown overlaps are reported."""
    assert build(overlap_with_an_open_mesh(), tmp_path, WATER + ONE, diagnostics) is not None
    assert diagnostics.codes() == ["SB505", "SB514"]
    assert list(diagnostics)[1].notes == ('"a" and "b": a mesh is not watertight; at most 0.5 g are counted twice',)


def test_what_was_found_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same solids are intersected once; another pose, density or link is a separate cache entry."""
    asked: list[Solid] = []
    intersection = Solid.intersection
    monkeypatch.setattr(Solid, "intersection", lambda a, b, X_AB: (asked.append(a), intersection(a, b, X_AB))[1])
    cache = Cache(tmp_path / "kept")

    def found(x: float, text: str) -> Mapping[str, Overlaps]:
        shop = Workshop()
        shop.box("a")
        shop.box("b", X_PC=at(x, 0, 0))
        binder = Binder(shop.assembly, sidecar(tmp_path, text), Diagnostics())
        materials = assign_materials(binder)
        claims = claim(binder, materials)
        weighed = masses(binder, materials, measured_bodies(shop.assembly, shop.measures, binder.document.mass))
        parts = {link: claims.parts_of(link) for link in binder.document.links}
        return OverlapSearch(shop.assembly, parts, weighed, cache=cache).result()

    first = found(5, WATER + ONE)
    assert len(first["base"].pairs) == len(asked) == 1
    assert found(5, WATER + ONE) == first
    assert len(asked) == 1
    assert found(6, WATER + ONE)["base"].mass == pytest.approx(0.4e-3)
    assert found(5, WATER.replace("1000", "2000") + ONE)["base"].mass == pytest.approx(2 * first["base"].mass)
    assert found(5, WATER + ONE.replace("base", "foot")) == {"foot": first["base"]}
    assert len(asked) == 4


def _search(shop: Workshop, folder: Path, diagnostics: Diagnostics, process: Worker) -> DoubleCounting:
    binder = Binder(shop.assembly, sidecar(folder, WATER + ONE), diagnostics)
    materials = assign_materials(binder)
    weighed = masses(binder, materials, measured_bodies(shop.assembly, shop.measures, binder.document.mass))
    return DoubleCounting(binder, claim(binder, materials), weighed, process=process)


def _row_of_blocks(count: int) -> Workshop:
    shop = Workshop()
    for number in range(count):
        shop.box(f"block {number}", (12, 10, 10), at(10 * number, 0, 0))
    return shop


def test_another_process_finds_the_same(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """The mesh worker finds the same overlaps as this process."""
    shop = _row_of_blocks(4)
    with Worker(MESH_WORKER) as process:
        meshes = tuple(body.mesh for body in shop.assembly.bodies)
        assert len(process.submit("measures", meshes, more=True).result()) == len(meshes)
        _search(shop, tmp_path, diagnostics, process).report()
    here = Diagnostics()
    assert build(shop, tmp_path, WATER + ONE, here) is not None
    assert list(diagnostics) == list(here)
    assert diagnostics.codes() == ["SB512"]


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_the_death_of_the_worker_is_reported(tmp_path: Path, diagnostics: ReadDiagnostics) -> None:
    """A worker that dies is an error: the mass counted twice is unknown."""
    with Worker(MESH_WORKER) as process:
        os.kill(process.pid, signal.SIGKILL)
        _search(_row_of_blocks(2), tmp_path, diagnostics, process).report()
    (error,) = diagnostics
    assert (error.code, error.severity) == ("SB902", "error")
    assert "the process that intersects solids ended: killed by SIGKILL" in error.message


@pytest.mark.slow
def test_many_pairs_are_intersected_in_processes() -> None:
    """Balls in a row, intersected in forked processes and in this one: the same to the last digit, as lenses are."""
    radius, step, count = 0.01, 0.008, 5
    ball = trimesh.creation.icosphere(4, radius=radius)
    pairs = [(i, j) for i in range(count) for j in range(i + 1, count) if (j - i) * step < 2.0 * radius]
    groups = tuple(
        Group((i, j), Pose.of(position=((j - i) * step, 0.0, 0.0)), ball.volume, (Candidate("row", i, j, 1.0, 1.0),))
        for i, j in pairs
    )
    meshes = {i: TriMesh.of(ball.vertices, ball.faces) for i in range(count)}
    poses = {i: Pose.of(position=(i * step, 0.0, 0.0)) for i in range(count)}
    search = Search(("row",), groups, meshes, poses, 10_000_000)
    assert sum(2 * len(ball.faces) for _ in pairs) > 20_000, "else no process is started"
    here = overlaps_of(search)["row"]
    there = call_isolated(MESH_WORKER, "overlaps", search)["row"]
    assert here == there
    assert len(here.pairs) == len(pairs) == 7
    lenses = {n: pi / 12.0 * (4.0 * radius + n * step) * (2.0 * radius - n * step) ** 2 for n in (1, 2)}
    for pair in here.pairs:
        assert pair.volume == pytest.approx(lenses[pair.second - pair.first], rel=0.02)


def test_equal_instances_share_one_union(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three balls that overlap, in several places and each time turned: one union, and its mass for each of them."""
    radius, step = 0.01, 0.006
    ball = trimesh.creation.icosphere(2, radius=radius)
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    instances = [Pose.of(rotation_about(axis, 0.7 * k), (0.1 * k, 0.03 * k, 0.0)) for k in range(4)]
    poses = {3 * k + i: X @ Pose.of(position=(i * step, 0.0, 0.0)) for k, X in enumerate(instances) for i in range(3)}
    groups = tuple(
        Group(
            (i, j),
            Pose.of(position=((j - i) * step, 0.0, 0.0)),
            ball.volume,
            tuple(Candidate(f"link {k}", 3 * k + i, 3 * k + j, 1.0, 1.0) for k in range(len(instances))),
        )
        for i, j in ((0, 1), (0, 2), (1, 2))
    )
    meshes = {i: TriMesh.of(ball.vertices, ball.faces) for i in range(3)}
    calls: list[int] = []

    def counted(parts: Sequence[tuple[TriMesh, Pose]]) -> float:
        calls.append(len(parts))
        return union_volume(parts)

    monkeypatch.setattr(overlapping, "union_volume", counted)
    links = tuple(f"link {k}" for k in range(len(instances)))
    found = overlaps_of(Search(links, groups, meshes, poses, 10_000_000))
    assert calls == [2]
    masses = [found[link].mass for link in links]
    assert masses == [masses[0]] * len(links)
    pairs = {(p.first, p.second): p.mass for p in found["link 0"].pairs}
    assert max(pairs.values()) < masses[0] < sum(pairs.values()), "what all three share counts once"
