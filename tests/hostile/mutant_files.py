"""Mutants of every file that stepbot reads: sidecars, STEP, URDF, SDFormat, MJCF and the meshes beside them.

A mutant is reproducible from its name, ``base:kind:seed:number``, where ``base`` is a folder with a valid file.
"""

import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from itertools import cycle
from pathlib import Path
from random import Random

from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.formats.rendering import render
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.model import Robot
from tests.conftest import ROOT
from tests.fuzz import mutant as step_mutant
from tests.random_robots import drawn_robot
from tests.robots import ROBOTS

from . import sidecar_damage, xml_damage
from .sidecar_tree import read_tree

SIDECAR, STEP, MESH = "robot.yaml", "step", "mesh"
DESCRIPTIONS = {"urdf": "urdf", "sdf": "sdf", "mjcf": "xml"}
"""Formats of descriptions, and their suffixes."""
_FOREIGN = Path(__file__).parent / "foreign"
_ROBOTS = ("equipped", "four_bar", "gripper_with_mimic", "odd_names")
"""Robots of the tests with devices, closed loops, mimics, and names that formats cannot hold."""
_DRAWN = range(4)
"""Seeds of robots drawn at random."""
_LARGEST_STEP = 200_000
"""Size [bytes] of STEP files: larger ones would take most of the time."""
_SIDECARS = ("stepbot_arm2", "stepbot_diff_drive", "stepbot_four_bar", "robotiq_2f85")
COMPOSED = "sidecar-composed"
VARIANTS = ("bare", "far", "hung")
"""Of the composed sidecar."""
PART = "v 0 0 0\nv 60 0 0\nv 0 80 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
"""A mesh in millimetres, which the foreign descriptions name."""
FILES = ("sidecar", "step", "urdf", "sdf", "mjcf", "mesh")
"""Groups of mutants; each gets the same share, sidecars the double of meshes."""


class FileMutant(Struct, frozen=True):
    """The origin of a damaged file."""

    base: str
    """Folder of the valid file, ``group-name``."""
    kind: str
    seed: int
    number: int

    @property
    def name(self) -> str:
        """``base:kind:seed:number``."""
        return f"{self.base}:{self.kind}:{self.seed}:{self.number}"

    @property
    def group(self) -> str:
        """One of :data:`FILES`."""
        return self.base.partition("-")[0]

    @staticmethod
    def named(name: str) -> "FileMutant":
        """The mutant of a name."""
        base, kind, seed, number = name.split(":")
        return FileMutant(base, kind, int(seed), int(number))

    def source(self, bases: Path) -> Path:
        """The valid file to damage."""
        folder = bases / self.base
        return next(path for name in ("main", "part") for path in sorted(folder.glob(f"{name}.*")))

    def damaged(self, bases: Path) -> tuple[str, bytes]:
        """The name of the file to damage, and its new content; the bytes are deterministic."""
        rng = Random(self.name)
        source = self.source(bases)
        if self.group == "mesh":
            source = rng.choice(_meshes(bases / self.base))
            return source.relative_to(bases / self.base).as_posix(), _damaged_mesh(source, self.kind, rng)
        return source.name, _DAMAGE[self.group](source, self.kind, rng)


def _meshes(base: Path) -> list[Path]:
    return sorted(path for path in base.rglob("*") if path.suffix in (".obj", ".stl", ".dae"))


def _damaged_sidecar(source: Path, kind: str, rng: Random) -> bytes:
    return sidecar_damage.damaged(_sidecar_tree(source), kind, rng)


def _damaged_step(source: Path, kind: str, rng: Random) -> bytes:
    text = step_mutant.step_text(source)
    return step_mutant.damaged(text, kind, rng)


def _damaged_xml(source: Path, kind: str, rng: Random) -> bytes:
    return xml_damage.damaged(_xml(source), kind, rng)


_MESH_KINDS = ("bytes", "numbers", "header", "faces", "empty")


def _damaged_mesh(source: Path, kind: str, rng: Random) -> bytes:
    data = source.read_bytes()
    if kind == "bytes" or not data:
        return xml_damage.spoiled_bytes(data or b"x", rng)
    if kind == "header":  # the number of triangles of a binary STL, the first lines of a text
        return data[:80] + rng.randbytes(4) + data[84:] if rng.random() < 0.5 else rng.randbytes(84) + data[84:]
    if kind == "empty":
        return rng.choice((b"", b"\n", b"solid x\nendsolid x\n", b"v 0 0 0\n", b"# nothing\n", bytes(84)))
    lines = data.split(b"\n")
    chosen = [index for index, line in enumerate(lines) if line[:2] == (b"f " if kind == "faces" else b"v ")]
    for index in rng.sample(chosen, min(len(chosen), rng.choice((1, 3, 50)))):
        words = lines[index].split()
        numbers = ("0", "-1", "99999999999", "1/2/3", "1//", "nan", "inf", "1e300", "-1e-300", "", "x", "1e39")
        words[rng.randrange(1, len(words))] = rng.choice(numbers).encode()
        lines[index] = b" ".join(words)
    return b"\n".join(lines)


_DAMAGE: dict[str, Callable[[Path, str, Random], bytes]] = {
    "sidecar": _damaged_sidecar,
    "step": _damaged_step,
    "urdf": _damaged_xml,
    "sdf": _damaged_xml,
    "mjcf": _damaged_xml,
}
_KINDS = {
    "sidecar": sidecar_damage.KINDS,
    "step": step_mutant.ALL_KINDS,
    "urdf": xml_damage.KINDS,
    "sdf": xml_damage.KINDS,
    "mjcf": xml_damage.KINDS,
    "mesh": _MESH_KINDS,
}


def plan(bases: Path, count: int, seed: int) -> list[FileMutant]:
    """``count`` mutants: groups in turn, and in each every pair of base and kind equally often, in a random order."""
    names = sorted(path.name for path in bases.iterdir())
    rng = Random(seed)
    pairs = {}
    for group in FILES:
        of_group = [(name, kind) for name in names for kind in _KINDS[group] if name.startswith(f"{group}-")]
        rng.shuffle(of_group)
        pairs[group] = cycle(of_group)
    groups = cycle((*FILES[:-1], *FILES[:-1], "mesh"))
    return [FileMutant(*next(pairs[group]), seed, number) for number, group in zip(range(count), groups, strict=False)]


def collect(folder: Path) -> None:
    """Put all valid files into folders of their own, with the meshes and other files that they name."""
    for name in _SIDECARS:
        place = folder / f"sidecar-{name}"
        place.mkdir(parents=True)
        (source,) = (ROOT / "robot_library" / name).glob("*.robot.yaml")
        (step,) = (ROOT / "robot_library" / name).glob("*.step")
        shutil.copyfile(source, place / "main.robot.yaml")
        shutil.copyfile(step, place / step.name)
    _compose(folder / COMPOSED)
    steps = folder / "steps"
    subprocess.run([sys.executable, "-m", "tests.fuzz.bases", str(steps)], cwd=ROOT, check=True)
    for path in sorted(steps.iterdir()):
        if path.stat().st_size <= _LARGEST_STEP:
            place = folder / f"step-{path.stem}"
            place.mkdir()
            shutil.copyfile(path, place / "main.step")
            (place / "one.robot.yaml").write_text(_ONE_LINK, encoding="utf-8")
    shutil.rmtree(steps)
    robots = {name: ROBOTS[name]() for name in _ROBOTS} | {f"drawn{n}": drawn_robot(Random(n)) for n in _DRAWN}
    for name, robot in robots.items():
        for written_in in DESCRIPTIONS:
            _write(robot, written_in, folder / f"{written_in}-{name}")
    _write(robots["drawn1"], "urdf", folder / "mesh-urdf")
    _write(robots["equipped"], "mjcf", folder / "mesh-mjcf")
    for written_in, source in (("urdf", "arm.urdf"), ("sdf", "cell.sdf"), ("mjcf", "leg.xml")):
        place = folder / f"{written_in}-foreign"
        place.mkdir()
        shutil.copyfile(_FOREIGN / source, place / f"main.{DESCRIPTIONS[written_in]}")
        put_part(place)


def _compose(place: Path) -> None:
    """A sidecar of a URDF, another sidecar, its mirror image and an MJCF, with variants."""
    place.mkdir()
    arm = ROOT / "robot_library" / "stepbot_arm2"
    for source, name in (
        (_FOREIGN / "pair.robot.yaml", "main.robot.yaml"),
        (_FOREIGN / "arm.urdf", "arm.urdf"),
        (arm / "arm2.robot.yaml", "arm2.robot.yaml"),
        (arm / "arm2.step", "arm2.step"),
        (ROOT / "robot_library" / "composed" / "cell_cube.xml", "cube.xml"),
    ):
        shutil.copyfile(source, place / name)
    put_part(place)


_ONE_LINK = """\
version: 1
robot: mutant
step: main.step
defaults: {density: 1000 kg/m^3}
links:
  body: {rest: true}
"""


def put_part(place: Path) -> None:
    """Put the mesh that foreign descriptions name into a folder, as OBJ and as STL."""
    import trimesh

    (place / "part.obj").write_text(PART, encoding="ascii")
    trimesh.load(place / "part.obj", process=False).export(place / "part.stl")


def _write(robot: Robot, written_in: str, place: Path) -> None:
    diagnostics = Diagnostics()
    files = render(share_meshes(robot), written_in, diagnostics)
    main, *_ = files
    for path, content in files.items():
        target = place / (f"main.{DESCRIPTIONS[written_in]}" if path == main else path)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


@cache
def _sidecar_tree(source: Path) -> sidecar_damage.Table:
    return read_tree(source)


@cache
def _xml(source: Path) -> xml_damage.Element:
    return xml_damage.parse(source.read_bytes())
