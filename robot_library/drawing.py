"""Draw a robot from its links, for the build.py of a robot with a maker's description.

Each link is drawn in its own frame [mm], as a list of bodies. The STEP has one product per link, named after it and
placed at the link's drawn pose, so that the sidecar finds links by name.
"""

import argparse
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .description import load_description
from .moments import Array
from .step_file import Assembly, Occurrence, Part, write_step


@dataclass(frozen=True, eq=False)
class Body:
    """One solid of a link, in the link's frame."""

    name: str
    shape: Any
    """A build123d shape [mm]."""
    color: str
    """``#rrggbb``."""


def draw_described(folder: Path, links: Mapping[str, Sequence[Body]]) -> None:
    """Write ``<robot>.step`` of a robot whose expected.json is its maker's description.

    Args:
        folder: The robot's folder.
        links: The bodies of each link that has a shape.

    Raises:
        SystemExit: The description has no such link, or a shape is not a valid solid.
    """
    description = load_description(folder / "expected.json")
    poses = description.poses(description.drawn)
    unknown = [link for link in links if link not in poses]
    if unknown:
        raise SystemExit(f"{folder.name}: expected.json has no link {unknown}")
    draw_at(folder, links, {link: _in_millimetres(X) for link, X in poses.items()})


def draw_at(folder: Path, links: Mapping[str, Sequence[Body]], places: Mapping[str, Array]) -> None:
    """Write ``<robot>.step`` with each link at its pose.

    Args:
        folder: The robot's folder; its sidecar names the robot.
        links: The bodies of each link.
        places: X_WL of each link, shape (4, 4) [mm].

    Raises:
        SystemExit: A shape is not a valid solid.
    """
    name = robot_name(folder)
    parser = argparse.ArgumentParser(description=f"Draw {name}.step.")
    parser.add_argument("-o", "--output", type=Path, default=folder / f"{name}.step", help="STEP file to write")
    options = parser.parse_args()
    children = [Occurrence(assembly_of(link, bodies), link, places[link]) for link, bodies in links.items()]
    write_step(options.output, Assembly(name, children), name=f"{name}.step")


def assembly_of(link: str, bodies: Iterable[Body]) -> Assembly:
    """One product of several bodies; duplicate names are numbered."""
    children = []
    seen: dict[str, int] = {}
    for body in bodies:
        seen[body.name] = seen.get(body.name, 0) + 1
        name = body.name if seen[body.name] == 1 else f"{body.name} {seen[body.name]}"
        children.append(Occurrence(Part(f"{link} {name}", _one_solid(body, link), body.color), name))
    return Assembly(link, children)


def robot_name(folder: Path) -> str:
    """The name of the robot in a folder ``<maker>_<robot>``: the name of its only sidecar.

    Raises:
        SystemExit: The folder has no sidecar, several, or another name.
    """
    names = [path.name.removesuffix(".robot.yaml") for path in folder.glob("*.robot.yaml")]
    if len(names) != 1 or not re.fullmatch(rf"[a-z0-9_]+_{re.escape(names[0])}", folder.name):
        raise SystemExit(f"{folder}: a robot's folder <maker>_<robot> has one sidecar, <robot>.robot.yaml")
    return names[0]


def _one_solid(body: Body, link: str) -> Any:
    """The kernel's shape of a body.

    Raises:
        SystemExit: The shape is not one solid, is invalid, or is inside out.
    """
    solids = body.shape.solids()
    if len(solids) != 1:
        raise SystemExit(f"{link}: '{body.name}' is {len(solids)} solids, not one")
    if not solids[0].is_valid:
        raise SystemExit(f"{link}: '{body.name}' is not a valid solid")
    if solids[0].volume <= 0.0:
        raise SystemExit(f"{link}: '{body.name}' is inside out")
    return solids[0].wrapped


def _in_millimetres(X_AB: Array) -> Array:
    return np.vstack((np.hstack((X_AB[:3, :3], 1000.0 * X_AB[:3, 3:])), X_AB[3:]))
