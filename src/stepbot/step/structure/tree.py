"""The tree of components: every occurrence of every definition, with its pose, names, colour and material.

An occurrence may mirror its definition, or scale it. A frame can do neither, so it keeps the rigid part of the motion,
and the rest becomes part of the shape: a mirrored body is a separate body, made once for all its occurrences.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.model import Rgba

from ..assembly import Component
from .naming import NamedComponent, assign_paths
from .source import NONE, Child, Definition, StepMaterial

MAX_COMPONENTS = 1_000_000
"""Maximum number of components in a tree."""

_EVEN = 1e-6
"""Relative deviation from uniform scaling up to which a transformation counts as uniform."""
_UNSCALED = 1e-9
_MIRROR = np.diag([1.0, 1.0, -1.0])


@dataclass(frozen=True)
class Variant:
    """A body in some occurrences."""

    definition: int
    body: int
    """Number of the body in the definition."""
    is_mirrored: bool = False
    """Through the plane z = 0 of the definition's frame."""
    scale: float = 1.0


@dataclass(frozen=True)
class Tree:
    """All components of a file."""

    components: tuple[Component, ...]
    variants: tuple[Variant, ...]
    """The bodies that :attr:`Component.body` refers to."""
    shapes: tuple[Variant, ...]
    """The definitions that :attr:`Component.definition` refers to; without a body for a definition as a whole."""
    definition_count: int
    """Product definitions that occur."""


@dataclass(frozen=True)
class _Node:
    """A component without its path."""

    parent: int
    child: Child
    matrix: Array
    """Shape (4, 4): its definition in the assembly [m], possibly mirrored and scaled."""
    body: int = NONE
    """Number of its single body, if its definition has several."""


@dataclass
class _Growing:
    nodes: list[_Node] = field(default_factory=list)
    components: list[Component] = field(default_factory=list)
    variants: dict[Variant, int] = field(default_factory=dict)
    shapes: dict[Variant, int] = field(default_factory=dict)
    """Definitions in components, in order of appearance."""
    skewed: list[int] = field(default_factory=list)
    empty: list[int] = field(default_factory=list)


def grow(
    definitions: Sequence[Definition],
    roots: Sequence[int],
    materials: Sequence[StepMaterial],
    place: str,
    found: Diagnostics,
) -> Tree | None:
    """Expand definitions into the tree of their occurrences; None, with the reason in ``found``, on failure.

    Args:
        definitions: Every definition once.
        roots: Those that occur nowhere else; several become children of an unnamed root.
        materials: For each definition the material of its product.
        place: Name of the file in diagnostics.
        found: Receives faults of occurrences.
    """
    growing = _Growing()
    if not _follow(definitions, roots, growing, place, found):
        return None
    for node in growing.nodes:
        _add(node, definitions, materials, growing)
    named = [NamedComponent(c.parent, c.product, c.occurrence) for c in growing.components]
    components = tuple(
        replace(c, segment=n.segment, path=n.path, ordinal=n.ordinal, by_ordinal_only=n.by_ordinal_only)
        for c, n in zip(growing.components, assign_paths(named), strict=True)
    )
    _report(components, growing, place, found)
    occurring = {node.child.definition for node in growing.nodes if node.child.definition != NONE}
    products = sum(definitions[index].product != NONE for index in occurring)
    return None if growing.skewed else Tree(components, tuple(growing.variants), tuple(growing.shapes), products)


def _follow(
    definitions: Sequence[Definition], roots: Sequence[int], growing: _Growing, place: str, found: Diagnostics
) -> bool:
    """List all components, depth first in file order."""
    nodes = growing.nodes
    pending: list[_Node] = [_Node(NONE, Child(index, "", np.eye(4), None), np.eye(4)) for index in roots]
    if len(roots) != 1:
        nodes.append(_Node(NONE, Child(NONE, "", np.eye(4), None), np.eye(4)))
        pending = [replace(node, parent=0) for node in pending]
    pending.reverse()
    while pending:
        node = pending.pop()
        index = len(nodes)
        if index >= MAX_COMPONENTS:
            report_too_large(index + 1, place, found)
            return False
        nodes.append(node)
        definition = definitions[node.child.definition]
        if node.body != NONE:
            continue
        below = [_Node(index, child, node.matrix @ child.matrix) for child in definition.children]
        if len(definition.bodies) > 1:
            below += [_Node(index, node.child, node.matrix, number) for number in range(len(definition.bodies))]
        pending += reversed(below)
    return True


def report_too_large(count: int, place: str, found: Diagnostics) -> None:
    """Report an assembly of at least ``count`` components, more than the maximum."""
    message = f"the assembly has {count:,} components or more; the limit is {MAX_COMPONENTS:,}"
    found.add("SB215", message, Span(place), help=["export a smaller assembly"])


def _add(node: _Node, definitions: Sequence[Definition], materials: Sequence[StepMaterial], growing: _Growing) -> None:
    index = len(growing.components)
    above = growing.components[node.parent] if node.parent != NONE else None
    if node.child.definition == NONE:
        growing.components.append(Component(index, NONE, "", "", "", "", 1))
        return
    definition = definitions[node.child.definition]
    rigid = _rigid(node.matrix)
    if rigid is None:
        growing.skewed.append(index)
        rigid = (Pose.of(position=node.matrix[:3, 3]), False, 1.0)
    X_WC, is_mirrored, scale = rigid
    number = 0 if len(definition.bodies) == 1 else node.body
    shape = Variant(node.child.definition, number, is_mirrored, scale)
    is_body = node.body != NONE
    material = materials[node.child.definition]
    if definition.product == NONE and above is not None:
        material = StepMaterial(above.material, above.density)
    growing.components.append(
        Component(
            index,
            node.parent,
            "",
            "",
            "" if is_body else definition.name,
            "" if is_body else node.child.occurrence,
            1,
            X_WC,
            body=growing.variants.setdefault(shape, len(growing.variants)) if number != NONE else NONE,
            definition=growing.shapes.setdefault(replace(shape, body=node.body), len(growing.shapes)),
            color=_color(node, definition, number, above),
            material=material.name,
            density=material.density,
            missing="" if is_body else definition.missing,
        )
    )
    if not definition.bodies and not definition.children and not definition.missing:
        growing.empty.append(index)


def _color(node: _Node, definition: Definition, number: int, above: Component | None) -> Rgba | None:
    """The occurrence's, else the body's, else the part's, else the inherited one."""
    body = definition.bodies[number].color if number != NONE else None
    own = (node.child.color, body, definition.color, above.color if above is not None else None)
    return next((color for color in own if color is not None), None)


def _rigid(matrix: Array) -> tuple[Pose, bool, float] | None:
    """A transformation as a pose after a mirroring through z = 0 and a uniform scaling; None for others."""
    A = matrix[:3, :3]
    determinant = float(np.linalg.det(A))
    scale = abs(determinant) ** (1.0 / 3.0)
    if scale == 0.0 or not np.isfinite(matrix).all() or np.abs(A.T @ A / scale**2 - np.eye(3)).max() > _EVEN:
        return None
    if abs(scale - 1.0) < _UNSCALED:
        scale = 1.0
    R = (A if scale == 1.0 else A / scale) @ (_MIRROR if determinant < 0.0 else np.eye(3))
    return Pose.of(R + 0.0, matrix[:3, 3] + 0.0), determinant < 0.0, float(f"{scale:.12g}")


def _report(components: Sequence[Component], growing: _Growing, place: str, found: Diagnostics) -> None:
    for index in growing.skewed:
        found.add(
            "SB214",
            f"'{components[index].path}': placement is not a rigid transform: shear or non-uniform scaling",
            Span(place),
            help=["make it a separate part in CAD, with its true shape"],
        )
    if growing.empty:
        paths = [components[index].path for index in growing.empty]
        shown = ", ".join(f"'{path}'" for path in paths[:3]) + (f" and {len(paths) - 3} more" if len(paths) > 3 else "")
        count = f"{len(paths)} components have" if len(paths) > 1 else "one component has"
        found.add("SB216", f"{count} no geometry: {shown}", Span(place))
