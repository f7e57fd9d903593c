"""The tree of components: every occurrence of every definition, with its pose, names, colour and material.

An occurrence may mirror its definition, or scale it. A frame can do neither, so it keeps the rigid part of the motion,
and the rest becomes part of the shape: a mirrored body is a separate body, made once for all its occurrences.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec import Struct

from stepbot.diagnostics import Diagnostics, Span, listed
from stepbot.geometry.poses import Poses
from stepbot.geometry.spatial import Array, Pose, cross, dot, matrix_product
from stepbot.robot.model import Rgba

from ..assembly import Component
from .naming import ComponentName, NamedComponent, assign_paths
from .source import NONE, Child, Definition, StepMaterial

MAX_COMPONENTS = 1_000_000
"""Maximum number of components in a tree."""

_EVEN = 1e-6
"""Relative deviation from uniform scaling up to which a transformation counts as uniform."""
_UNSCALED = 1e-9
_MIRROR = np.diag([1.0, 1.0, -1.0])


class Variant(Struct, frozen=True):
    """A body in some occurrences."""

    definition: int
    body: int
    """Number of the body in the definition."""
    is_mirrored: bool = False
    """Through the plane z = 0 of the definition's frame."""
    scale: float = 1.0


class Tree(Struct, frozen=True):
    """All components of a file."""

    components: tuple[Component, ...]
    variants: tuple[Variant, ...]
    """The bodies that :attr:`Component.body` refers to."""
    shapes: tuple[Variant, ...]
    """The definitions that :attr:`Component.definition` refers to; without a body for a definition as a whole."""
    definition_count: int
    """Product definitions that occur."""


class _Motion(NamedTuple):
    """A transformation as a pose after a mirroring through z = 0 and a uniform scaling."""

    X_WC: Pose
    is_mirrored: bool
    scale: float
    is_rigid: bool
    """Whether it has neither shear nor different scales; else the other fields are meaningless, but the position."""


class _Node(NamedTuple):
    """A component without its path."""

    parent: int
    child: Child
    matrix: Array
    """Shape (4, 4): its definition in the assembly [m], possibly mirrored and scaled."""
    body: int = NONE
    """Number of its single body, if its definition has several."""


def grow(
    definitions: Sequence[Definition],
    roots: Sequence[int],
    materials: Sequence[StepMaterial],
    place: str,
    diagnostics: Diagnostics,
) -> Tree | None:
    """Expand definitions into the tree of their occurrences; None, with the reason in ``diagnostics``, on failure.

    Args:
        roots: Those that occur nowhere else; several become children of an unnamed root.
        materials: For each definition the material of its product.
    """
    nodes = _follow(definitions, roots, place, diagnostics)
    if nodes is None:
        return None
    names = assign_paths([_name(node, definitions) for node in nodes])
    motions = _motions(np.array([node.matrix for node in nodes]))
    growing = _Growing(definitions, materials)
    for index, node in enumerate(nodes):
        growing.add(index, node, names[index], motions[index])
    _report(growing, [index for index, motion in enumerate(motions) if not motion.is_rigid], place, diagnostics)
    if not all(motion.is_rigid for motion in motions):
        return None
    occurring = {node.child.definition for node in nodes if node.child.definition != NONE}
    products = sum(definitions[index].product != NONE for index in occurring)
    return Tree(tuple(growing.components), tuple(growing.variants), tuple(growing.shapes), products)


def _follow(
    definitions: Sequence[Definition], roots: Sequence[int], place: str, diagnostics: Diagnostics
) -> list[_Node] | None:
    """All components, depth first in file order; None, with SB215 in ``diagnostics``, if there are too many."""
    nodes: list[_Node] = []
    pending = [_Node(NONE, Child(index, "", np.eye(4), None), np.eye(4)) for index in roots]
    if len(roots) != 1:
        nodes.append(_Node(NONE, Child(NONE, "", np.eye(4), None), np.eye(4)))
        pending = [node._replace(parent=0) for node in pending]
    pending.reverse()
    stacks: dict[int, Array] = {}
    while pending:
        node = pending.pop()
        index = len(nodes)
        if index >= MAX_COMPONENTS:
            report_too_large(index + 1, place, diagnostics)
            return None
        nodes.append(node)
        number = node.child.definition
        definition = definitions[number]
        if node.body != NONE:
            continue
        below: list[_Node] = []
        if definition.children:
            if number not in stacks:
                stacks[number] = np.array([child.matrix for child in definition.children])
            matrices = matrix_product(node.matrix, stacks[number])
            below = [_Node(index, child, X) for child, X in zip(definition.children, matrices, strict=True)]
        if len(definition.bodies) > 1:
            below += [_Node(index, node.child, node.matrix, number) for number in range(len(definition.bodies))]
        pending += reversed(below)
    return nodes


def report_too_large(count: int, place: str, diagnostics: Diagnostics) -> None:
    """Report an assembly of at least ``count`` components, more than the maximum."""
    message = f"the assembly has {count:,} components or more; the limit is {MAX_COMPONENTS:,}"
    diagnostics.add("SB215", message, Span(place), help=["export a smaller assembly"])


def _name(node: _Node, definitions: Sequence[Definition]) -> NamedComponent:
    """The names of a component in the file; none of a single body."""
    if node.body != NONE or node.child.definition == NONE:
        return NamedComponent(node.parent, "", "")
    return NamedComponent(node.parent, definitions[node.child.definition].name, node.child.occurrence)


class _Growing:
    """The components so far, and what they refer to."""

    def __init__(self, definitions: Sequence[Definition], materials: Sequence[StepMaterial]) -> None:
        self._definitions, self._materials = definitions, materials
        self.components: list[Component] = []
        self.variants: dict[Variant, int] = {}
        """Bodies in components, in order of appearance."""
        self.shapes: dict[Variant, int] = {}
        """Definitions in components, in order of appearance."""
        self.empty: list[int] = []
        self._indices: dict[tuple[int, int, bool, float], tuple[int, int]] = {}

    def add(self, index: int, node: _Node, name: ComponentName, motion: _Motion) -> None:
        """Add the component of a node, whose parent was added before."""
        if node.child.definition == NONE:
            self.components.append(Component(index, NONE, name.segment, name.path, "", "", 1))
            return
        above = self.components[node.parent] if node.parent != NONE else None
        definition = self._definitions[node.child.definition]
        number = 0 if len(definition.bodies) == 1 else node.body
        is_body = node.body != NONE
        material = self._materials[node.child.definition]
        if definition.product == NONE and above is not None:
            material = StepMaterial(above.material, above.density)
        body, shape = self._shape(node, number, motion)
        self.components.append(
            Component(
                index,
                node.parent,
                name.segment,
                name.path,
                "" if is_body else definition.name,
                "" if is_body else node.child.occurrence,
                name.ordinal,
                motion.X_WC,
                body,
                shape,
                _color(node, definition, number, above),
                material.name,
                material.density,
                name.by_ordinal_only,
                "" if is_body else definition.missing,
            )
        )
        if not definition.bodies and not definition.children and not definition.missing:
            self.empty.append(index)

    def _shape(self, node: _Node, number: int, motion: _Motion) -> tuple[int, int]:
        """Indices of a component's body and of its definition, as they are in this component."""
        key = (node.child.definition, node.body, motion.is_mirrored, motion.scale)
        if key not in self._indices:
            body, whole = Variant(key[0], number, *key[2:]), Variant(*key)
            self._indices[key] = (
                self.variants.setdefault(body, len(self.variants)) if number != NONE else NONE,
                self.shapes.setdefault(whole, len(self.shapes)),
            )
        return self._indices[key]


def _color(node: _Node, definition: Definition, number: int, above: Component | None) -> Rgba | None:
    """The occurrence's, else the body's, else the part's, else the inherited one."""
    body = definition.bodies[number].color if number != NONE else None
    own = (node.child.color, body, definition.color, above.color if above is not None else None)
    return next((color for color in own if color is not None), None)


def _motions(matrices: Array) -> list[_Motion]:
    """Transformations (n, 4, 4) [m], taken apart."""
    A, p = matrices[:, :3, :3], matrices[:, :3, 3]
    determinant = dot(A[:, 0], cross(A[:, 1], A[:, 2]))
    scale = np.array([abs(value) ** (1.0 / 3.0) for value in determinant.tolist()])
    with np.errstate(all="ignore"):  # of transformations that are not rigid
        skew = np.abs(A.transpose(0, 2, 1) @ A / (scale**2)[:, None, None] - np.eye(3)).max(axis=(1, 2))
        is_rigid = (scale != 0.0) & np.isfinite(matrices).all(axis=(1, 2)) & ~(skew > _EVEN)
        scale = np.where(is_rigid & ~(np.abs(scale - 1.0) < _UNSCALED), scale, 1.0)
        R = np.where(is_rigid[:, None, None], A / scale[:, None, None], np.eye(3))
    is_mirrored = is_rigid & (determinant < 0.0)
    R[is_mirrored] = matrix_product(R[is_mirrored], _MIRROR)
    poses = Poses(R + 0.0, p + 0.0).listed()
    shown = [float(f"{value:.12g}") if value != 1.0 else 1.0 for value in scale.tolist()]
    return [_Motion(*motion) for motion in zip(poses, is_mirrored.tolist(), shown, is_rigid.tolist(), strict=True)]


def _report(growing: _Growing, skewed: Sequence[int], place: str, diagnostics: Diagnostics) -> None:
    components = growing.components
    for index in skewed:
        diagnostics.add(
            "SB214",
            f"'{components[index].path}': placement is not a rigid transform: shear or non-uniform scaling",
            Span(place),
            help=["make it a separate part in CAD, with its true shape"],
        )
    if growing.empty:
        paths = [components[index].path for index in growing.empty]
        count = f"{len(paths)} components have" if len(paths) > 1 else "one component has"
        diagnostics.add("SB216", f"{count} no geometry: {listed(paths, 3)}", Span(place))
