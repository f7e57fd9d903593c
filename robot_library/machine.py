"""A robot drawn by a script: links, each an assembly of parts in its own frame, and the frames of its joints.

The placement of a link's assembly is the link's frame: ``origin: {component: forearm}`` in the sidecar is exactly the
joint frame of the script. Masses follow from the densities that the parts have in the STEP; the kernel integrates them
over the exact surfaces, not over meshes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import shapes
from .command import kernel_properties, run
from .expected import joint, link, mass_properties
from .moments import Array, Moments, pose, total
from .step_file import Assembly, Occurrence, Part


@dataclass(frozen=True)
class Material:
    """The material of a part."""

    name: str
    density: float
    """[kg/m^3]"""
    color: str
    """``#rrggbb``"""


METAL = Material("aluminium 6082", 2700.0, shapes.ALUMINIUM)
STEEL = Material("steel", 7850.0, shapes.STEEL)
CAST = Material("cast aluminium", 2650.0, shapes.DARK)
PLASTIC = Material("ABS", 1040.0, shapes.WHITE)
PRINTED = Material("PLA, printed", 900.0, shapes.ORANGE)
"""Walls and infill together."""
RUBBER = Material("rubber", 1100.0, shapes.BLACK)
CARBON = Material("carbon fibre", 1600.0, shapes.BLACK)
DRIVE = Material("drive, as weighed", 1750.0, shapes.BLACK)
"""A small servo or motor as a whole: case, windings and gears."""


def part(name: str, shape: Any, material: Material, color: str = "") -> Part:
    """A part with one solid, a material, and a colour, by default that of the material.

    Raises:
        ValueError: The shape is not one solid.
    """
    solids = shape.solids()
    if len(solids) != 1:
        raise ValueError(f"{name}: {len(solids)} solids instead of one")
    return Part(name, solids[0].wrapped, color or material.color, material=material.name, density=material.density)


def placed(product: Part | Assembly, *places: Array, name: str = "") -> list[Occurrence]:
    """Occurrences of a product at these poses; without a pose, one at the identity.

    Raises:
        ValueError: A pose is not a rigid transform; the kernel would orthogonalize it without a warning.
    """
    for X in places:
        if float(np.max(np.abs(X[:3, :3].T @ X[:3, :3] - np.eye(3)))) > 1e-12:
            raise ValueError(f"{product.name}: its axes are not at right angles: {X[:3, :3].tolist()}")
    label = name or product.name
    numbered = len(places) > 1
    return [
        Occurrence(product, f"{label}_{i}" if numbered else label, X)
        for i, X in enumerate(places or (pose(),), start=1)
    ]


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body: its parts, placed in its frame L, and the pose of L in the drawing W."""

    name: str
    X_WL: Array
    """Shape (4, 4) [mm]."""
    parts: Sequence[Occurrence]

    def body(self) -> Moments:
        """Mass properties in W [kg, m], from the densities of the parts."""
        pieces = (kernel_moments(p.shape).moved(self.X_WL @ X_LP).weighing(p.density) for p, X_LP in _parts(self.parts))
        return total(*pieces).in_metres()


@dataclass(frozen=True, eq=False)
class JointFrame:
    """Frame and axis of a joint or a closure in the drawing."""

    X_WJ: Array
    """Shape (4, 4) [mm]."""
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    """In J."""


@dataclass(frozen=True, eq=False)
class Machine:
    """A robot: its links, the frames of its joints, and more content of expected.json."""

    name: str
    links: Sequence[Link]
    joints: Mapping[str, JointFrame]
    known: Mapping[str, Any] = field(default_factory=dict)
    """More content of expected.json, such as motions in closed form."""

    def assembly(self) -> Assembly:
        """One subassembly for each link."""
        bodies = (Occurrence(Assembly(link.name, link.parts), link.name, link.X_WL) for link in self.links)
        return Assembly(self.name, list(bodies))

    def expected(self) -> dict[str, Any]:
        """The content of expected.json."""
        bodies = {link.name: link.body() for link in self.links}
        return {
            "robot": self.name,
            "about": "From the script that draws the robot [m, kg, rad]: frames from its dimensions, mass properties "
            "from the kernel's integrals over the exact surfaces, motions from closed forms. Poses and centres of mass "
            "are those of the drawing, in the frame of the assembly; inertias are about the centre of mass.",
            "links": {part.name: link(bodies[part.name], in_metres(part.X_WL)) for part in self.links},
            "total": mass_properties(total(*bodies.values())),
            "joints": {
                name: joint(in_metres(j.X_WJ), (j.X_WJ[:3, :3] @ np.asarray(j.axis, dtype=np.float64)).tolist())
                for name, j in self.joints.items()
            },
            **self.known,
        }


def draw(script: str, build: Callable[[], Machine]) -> None:
    """Write the STEP and the expected.json of a machine.

    Args:
        script: The ``__file__`` of the build.py; the STEP is written beside it, named after the folder.
        build: Draws the machine.
    """
    folder = Path(script).parent
    machine = build()
    run(folder / f"{folder.name.partition('_')[2]}.step", machine.assembly, None, machine.expected)


def in_metres(X_AB: Array) -> Array:
    """A pose given in millimetres, converted to metres."""
    return pose(X_AB[:3, 3] / 1000, X_AB[:3, :3])


def kernel_moments(shape: Any) -> Moments:
    """The integrals of 1, x and x x^T over a shape, by the kernel, at density 1 [mm]."""
    volume, com, inertia = kernel_properties(shape)
    central = np.trace(inertia) / 2 * np.eye(3) - inertia
    return Moments(volume, volume * com, central + volume * np.outer(com, com))


def _parts(occurrences: Sequence[Occurrence]) -> Iterator[tuple[Part, Array]]:
    for occurrence in occurrences:
        X = pose() if occurrence.X_AP is None else occurrence.X_AP
        if isinstance(occurrence.product, Part):
            yield occurrence.product, X
        else:
            yield from ((part, X @ inner) for part, inner in _parts(occurrence.product.children))
