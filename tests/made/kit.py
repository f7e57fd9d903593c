"""Draws the parts of one assembly and notes their links: bodies, screws and pins in a random style."""

from collections.abc import Sequence
from math import cos, pi, sin
from random import Random
from typing import Any

import numpy as np
from msgspec import Struct, field

from robot_library.moments import Array, pose, turn
from robot_library.step_file import moved
from stepbot.geometry.spatial import Pose
from stepbot.step.assembly import Assembly
from tests.assembled import Node, assembled
from tests.solids import Solid, cylinder

_WORDS: dict[str, tuple[str, str, str, str]] = {
    "base": ("base", "Grundplatte", "底座", "bancada"),
    "arm": ("arm", "Ausleger", "大臂", "brazo"),
    "link": ("link", "Glied", "连杆", "eslabon"),
    "servo": ("servo MG996R", "Servomotor", "舵机", "servomotor"),
    "motor": ("DC motor", "Getriebemotor", "电机", "motor"),
    "horn": ("servo horn", "Servohorn", "舵盘", "horn"),
    "screw": ("M3x10 screw", "Schraube M3", "螺钉", "tornillo M3"),
    "nut": ("M3 nut", "Mutter M3", "螺母", "tuerca M3"),
    "pin": ("pin", "Stift", "销", "pasador"),
    "bracket": ("bracket", "Halter", "支架", "soporte"),
    "wheel": ("wheel", "Rad", "轮子", "rueda"),
    "rim": ("rim", "Felge", "轮毂", "llanta"),
    "tyre": ("tyre", "Reifen", "轮胎", "neumatico"),
    "gear": ("gear", "Zahnrad", "齿轮", "engranaje"),
    "finger": ("finger", "Finger", "手指", "dedo"),
    "plate": ("plate", "Blech", "板", "placa"),
    "rail": ("rail", "Schiene", "导轨", "riel"),
    "carriage": ("carriage", "Schlitten", "滑块", "carro"),
    "shaft": ("shaft", "Welle", "轴", "eje"),
    "bearing": ("bearing 608", "Kugellager", "轴承", "rodamiento"),
    "tube": ("tube", "Rohr", "管", "tubo"),
    "cover": ("cover", "Deckel", "盖", "tapa"),
    "pulley": ("pulley", "Riemenscheibe", "带轮", "polea"),
    "leg": ("leg", "Bein", "腿", "pata"),
    "crank": ("crank", "Kurbel", "曲柄", "manivela"),
    "body": ("chassis", "Rumpf", "机身", "cuerpo"),
    "fork": ("fork", "Gabel", "叉", "horquilla"),
    "flange": ("flange", "Flansch", "法兰", "brida"),
    "gearbox": ("CSF-17 unit", "Getriebe HFUS", "谐波减速器", "reductor"),
    "drawer": ("drawer", "Schublade", "抽屉", "cajon"),
    "cabinet": ("cabinet", "Korpus", "柜体", "mueble"),
    "ball": ("stud", "Bolzen", "球头", "rotula"),
    "spindle": ("lead screw", "Spindel", "丝杠", "husillo"),
    "cylinder": ("hydraulic cylinder", "Zylinder", "液压缸", "cilindro"),
    "rod": ("piston rod", "Kolbenstange", "活塞杆", "vastago"),
    "leaf": ("hinge leaf", "Lappen", "合页", "hoja"),
    "frame": ("frame", "Rahmen", "框架", "marco"),
    "ring": ("slewing ring", "Drehkranz", "转盘轴承", "corona"),
}
SCREWS = "_screws"
"""The link of what may be anywhere."""


class Truth(Struct, frozen=True):
    """A joint that was drawn: its type, both links, and its line [m]."""

    kind: str
    a: str
    b: str
    point: Array
    direction: Array


class Kit(Struct, dict=True):
    """One assembly while it is drawn [mm]."""

    rng: Random
    is_varied: bool = False
    """Whether it has the further styles: everything in one coordinate system, several bodies in one product, units."""
    is_messy: bool = False
    """Whether some trees are imports, each with parts of several links, besides."""
    joints: list[Truth] = field(default_factory=list)
    root: str = "base"

    def __post_init__(self) -> None:
        self.language = self.rng.choice((0, 0, 1, 2, 3, -1))
        self.nested = self.rng.random() < 0.4
        self.clearance = self.rng.choice((0.0, 0.0, 0.05, 0.1, 0.2, -0.02))
        """Difference of radii of what turns."""
        self.fasteners = self.rng.random() < 0.6
        self.whole = pose((self.rng.uniform(-300, 300), self.rng.uniform(-300, 300), 0.0))
        if self.rng.random() < 0.5:
            self.whole = self.whole @ pose(rotation=turn("z", self.rng.uniform(-3, 3)))
        self.gap, self.is_baked, self.has_bodies, self.has_units = 0.0, False, False, False
        """Play along axes, and whether all is drawn in one coordinate system, the parts of a link are bodies of one
        product, and the pieces of what is bought are in one subassembly."""
        if self.is_varied:
            self.clearance, self.gap = (
                self.rng.choice((0.0, 0.05, 0.1, 0.2, 0.3)),
                self.rng.choice((0, 0, 0.05, 0.2, 0.5)),
            )
            self.is_baked, self.has_bodies = self.rng.random() < 0.25, self.rng.random() < 0.2
            self.has_units = self.rng.random() < 0.4
        self.has_imports = self.is_messy and self.rng.random() < 0.2
        self._nodes: dict[str, list[Node]] = {}
        self._units: dict[str, list[tuple[str, Node]]] = {}
        self._count: dict[str, int] = {}

    def name(self, word: str) -> str:
        """A name of a part in the assembly's language; a machine's name in an assembly without names."""
        if self.language < 0:
            number = self._count[""] = self._count.get("", 0) + 1
            return f"Part {number}"
        text = _WORDS[word][self.language]
        number = self._count[text] = self._count.get(text, 0) + 1
        return text if number == 1 else f"{text} {number}"

    def add(self, link: str, word: str, solid: Solid, X: Array | None = None, unit: str = "") -> None:
        """Add a part of a link at a pose (4, 4); pieces of one ``unit`` may be in one subassembly."""
        placed = self.whole @ (np.eye(4) if X is None else X)
        shape = moved(solid.shape, placed) if self.is_baked else solid.shape
        placed = np.eye(4) if self.is_baked else placed
        placed[:3, 3] *= 1e-3
        node = Node(self.name(word), shape, X=Pose.from_matrix(placed))
        if unit and self.has_units:
            self._units.setdefault(unit, []).append((link, node))
        else:
            self._nodes.setdefault(link, []).append(node)

    def joint(self, kind: str, a: str, b: str, point: Any, direction: Any) -> None:
        """Note a joint with a line [mm] in the frame of the drawing."""
        at = self.whole @ np.append(np.asarray(point, float), 1.0)
        self.joints.append(Truth(kind, a, b, at[:3] * 1e-3, self.whole[:3, :3] @ np.asarray(direction, float)))

    def screw(self, X: Array, radius: float, length: float) -> None:
        """A screw along z of a pose, its shank from 0 to ``length`` and its head above; only if the style has any."""
        if not self.fasteners:
            return
        self.add(SCREWS, "screw", cylinder(radius, length) + _head(radius).at(0, 0, length), X)

    def assembly(self, *, is_meshed: bool = False) -> tuple[Assembly, dict[str, str]]:
        """The assembly, and the link of each path."""
        nodes: list[Node] = []
        link_of: dict[str, str] = {}
        for unit, pieces in self._units.items():
            group = f"Asm {len(nodes)}" if self.language < 0 else unit
            nodes.append(Node(group, children=tuple(piece for _, piece in pieces)))
            link_of.update({f"{group}/{piece.name}": link for link, piece in pieces})
        for link, parts in self._nodes.items():
            if (self.nested or self.has_bodies) and link != SCREWS and len(parts) > 1:
                group = f"Asm {len(nodes)}" if self.language < 0 else f"{link} assembly"
                nodes.append(Node(group, children=tuple(parts), has_bodies=self.has_bodies))
                link_of.update({f"{group}/{part.name}": link for part in parts})
            else:
                nodes += parts
                link_of.update({part.name: link for part in parts})
        if self.has_imports:
            self.rng.shuffle(nodes)
            half = len(nodes) // 2
            folder = {node.name: f"Import {1 + (n >= half)}" for n, node in enumerate(nodes)}
            link_of = {f"{folder[path.split('/')[0]]}/{path}": link for path, link in link_of.items()}
            nodes = [Node(f"Import {n}", children=tuple(some)) for n, some in ((1, nodes[:half]), (2, nodes[half:]))]
        return assembled(*nodes, is_meshed=is_meshed), link_of


def _head(radius: float) -> Solid:
    return cylinder(1.8 * radius, 1.6 * radius) - cylinder(0.8 * radius, radius).at(0, 0, 0.6 * radius)


def drilled(solid: Solid, *holes: Sequence[float], depth: float = 400.0) -> Solid:
    """A solid with bores along z: x, y and radius of each."""
    for x, y, radius in holes:
        solid -= cylinder(radius, depth).at(x, y, -depth / 2)
    return solid


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Array:
    """A shift."""
    return pose((x, y, z))


def rot(axis: str, angle: float) -> Array:
    """A rotation."""
    return pose(rotation=turn(axis, angle))


TO_X, TO_Y = rot("y", pi / 2), rot("x", -pi / 2)
"""Turn z to x, and z to y."""


def circle(count: int, radius: float, size: float) -> list[tuple[float, float, float]]:
    """Holes in a circle: x, y, radius of each."""
    return [(radius * cos(a), radius * sin(a), size) for a in np.linspace(0, 2 * pi, count, endpoint=False).tolist()]


def across(radius: float, width: float, x: float = 0.0, z: float = 0.0) -> Solid:
    """A cylinder along y, centred there."""
    return cylinder(radius, width).at(0, 0, -width / 2).moved(at(x, 0, z) @ TO_Y)


def bolt(kit: Kit, T: Array, radius: float, length: float) -> None:
    """A screw along y of a pose, with a nut."""
    start = T @ at(0, -length / 2, 0) @ TO_Y
    kit.screw(start, radius, length)
    if kit.fasteners:
        nut = cylinder(2 * radius, 1.5 * radius) - cylinder(radius, 1.5 * radius)
        kit.add(SCREWS, "nut", nut, start)
