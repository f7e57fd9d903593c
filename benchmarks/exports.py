"""The same robot as other exports have it: an assembly with its parts moved, mirrored, renamed, in other products.

Random numbers are those of PCG64.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from stepbot.draft.contacts.survey import ALL_SOURCES, Survey
from stepbot.geometry.mesh import TriMesh
from stepbot.geometry.spatial import IDENTITY, Array, Pose, perpendicular_frame, rotation_about, unit, vector3
from stepbot.geometry.volume import VolumeProperties
from stepbot.step.assembly import Assembly, Body
from stepbot.step.faces import Face, FaceKind

_ROUND = (FaceKind.CYLINDER, FaceKind.CONE)

Change = Callable[[Assembly, np.random.Generator], tuple[Assembly, Array]]
"""Gives the changed assembly, and the map (4, 4) that takes the old place of a point to the new one."""


def as_drawn(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Nothing is changed."""
    return assembly, np.eye(4)


def _moved_about(rng: np.random.Generator, middle: Array, far: float) -> Pose:
    """A random motion by ``far`` [m], and by 5 mrad per millimetre of it about a point; normal, for each axis."""
    turn, shift = rng.normal(size=(2, 3)) * far
    R = rotation_about(unit(turn), 5.0 * float(np.linalg.norm(turn)))
    return Pose.of(R, middle - R @ middle + shift)


def turned(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Everything turned alike, and moved by some 0.5 m."""
    q = rng.normal(size=4)
    X = Pose.from_quaternion((q / np.linalg.norm(q)).tolist(), 0.3 * rng.normal(size=3))
    placed = np.block([[X.R, np.array(X.p)[:, None]], [np.zeros(3), 1.0]])
    return _moved(assembly, dict.fromkeys(range(1, len(assembly.components)), X)), placed


def shaken(far: float) -> Change:
    """Each part moved by itself, about its centre of mass; the bodies of a product of several stay in place in it."""

    def change(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
        found: dict[int, Pose] = {}
        of: dict[int, Pose] = {}
        for c in assembly.components:
            exact = assembly.bodies[c.body].exact if c.body >= 0 else None
            if exact is not None:
                part = c.index if c.product or c.parent <= 0 else c.parent
                if part not in of:
                    of[part] = _moved_about(rng, c.X_WC.apply(np.array(exact.unit_density.com)), far)
                found[c.index] = of[part]
        return _moved(assembly, found), np.eye(4)

    return change


def misplaced(far: float, share: float = 0.3) -> Change:
    """A share of the pieces at the top of the tree moved, each as a whole."""

    def change(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
        top = 0
        while len(assembly.children[top]) == 1:
            top = assembly.children[top][0]
        found = {}
        for piece in assembly.children[top]:
            if rng.random() < share:
                below = assembly.subtree(piece)
                middle = np.mean([assembly.components[i].X_WC.p for i in below], axis=0)
                found.update(dict.fromkeys(below, _moved_about(rng, middle, far)))
        return _moved(assembly, found), np.eye(4)

    return change


def _moved(assembly: Assembly, by: Mapping[int, Pose]) -> Assembly:
    """With components moved in the assembly, by their indices."""
    placed = [replace(c, X_WC=by[c.index] @ c.X_WC) if c.index in by else c for c in assembly.components]
    return replace(assembly, components=tuple(placed))


def mirrored(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """The whole mirrored in y, each body in its own y."""
    signs = np.array([1.0, -1.0, 1.0])
    return _reflected(assembly, signs, [signs] * len(assembly.bodies)), np.diag([*signs, 1.0])


def reframed(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Each body drawn in a frame of its own that is turned by half a turn, about x, y or z; all stay in place."""
    half_turns = 2.0 * np.eye(3) - 1.0
    signs = [half_turns[k] for k in rng.integers(3, size=len(assembly.bodies))]
    return _reflected(assembly, np.ones(3), signs), np.eye(4)


def _reflected(assembly: Assembly, whole: Array, bodies: Sequence[Array]) -> Assembly:
    """With the signs of coordinates changed: those of the assembly, and those of each body's frame."""
    changed = []
    for body, signs in zip(assembly.bodies, bodies, strict=True):
        exact = body.exact
        if exact is not None:
            of = exact.unit_density
            exact = VolumeProperties.of(
                of.mass, np.array(of.com) * signs, np.array(of.inertia) * np.outer(signs, signs)
            )
        faces = tuple(face.scaled(signs, 1.0) for face in body.faces)
        turned_out = body.mesh.faces[:, ::-1] if np.prod(signs) < 0.0 else body.mesh.faces
        mesh = TriMesh.of(body.mesh.vertices * signs, turned_out)
        changed.append(replace(body, exact=exact, mesh=mesh, faces=faces))
    placed = []
    for c in assembly.components:
        signs = bodies[c.body] if c.body >= 0 else whole
        placed.append(replace(c, X_WC=Pose.of(whole[:, None] * c.X_WC.R * signs, whole * c.X_WC.p)))
    return replace(assembly, components=tuple(placed), bodies=tuple(changed))


def shuffled(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """The children of each component in another order."""

    def below(index: int) -> Iterator[int]:
        yield index
        for child in rng.permutation(np.array(assembly.children[index], dtype=int)).tolist():
            yield from below(child)

    return _only(assembly, list(below(0))), np.eye(4)


def without_screws(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """What is named or shaped as a fastener left out."""
    small = Survey(assembly, ALL_SOURCES).small
    return _only(assembly, [c.index for c in assembly.components if c.index not in small]), np.eye(4)


def _only(assembly: Assembly, order: Sequence[int]) -> Assembly:
    """With some of the components, in another order."""
    row = {old: new for new, old in enumerate(order)}
    some = [replace(assembly.components[old], index=row[old]) for old in order]
    return replace(assembly, components=tuple(replace(c, parent=row.get(c.parent, -1)) for c in some))


def renamed(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Products named by a number alone, their occurrences not at all."""
    names = [f"Part {c.definition}" if c.product else "" for c in assembly.components]
    some = [replace(c, product=name, occurrence="") for c, name in zip(assembly.components, names, strict=True)]
    return replace(assembly, components=tuple(some)), np.eye(4)


def reexported(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Each occurrence a product of its own with a number in its name, drawn where it is in the assembly."""
    bodies, placed = [], []
    for c in assembly.components:
        name = f"{c.product} {c.index}" if c.product else ""
        one = replace(c, definition=c.index, product=name, X_WC=IDENTITY)
        if c.body >= 0:
            one = replace(one, body=len(bodies))
            bodies.append(_drawn_at(assembly.bodies[c.body], c.X_WC))
        placed.append(one)
    return replace(assembly, components=tuple(placed), bodies=tuple(bodies)), np.eye(4)


def reexported_mirrored(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, Array]:
    """The same, the whole mirrored in y."""
    image, placed = mirrored(assembly, rng)
    return reexported(image, rng)[0], placed


def halved(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Round faces that are closed around their axis in two halves, as many CAD programs write them."""
    bodies = tuple(
        replace(body, faces=tuple(half for face in body.faces for half in _halves(face))) for body in assembly.bodies
    )
    return replace(assembly, bodies=bodies), np.eye(4)


def far_off(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
    """Everything 1 m off the origin along each axis."""
    X = Pose.of(np.eye(3), np.ones(3))
    return _moved(assembly, dict.fromkeys(range(1, len(assembly.components)), X)), X.matrix


def all_named(name: str) -> Change:
    """All products and occurrences with one name."""

    def change(assembly: Assembly, _rng: np.random.Generator) -> tuple[Assembly, Array]:
        some = [replace(c, product=c.product and name, occurrence=c.occurrence and name) for c in assembly.components]
        return replace(assembly, components=tuple(some)), np.eye(4)

    return change


def _halves(face: Face) -> tuple[Face, ...]:
    if face.kind not in _ROUND or face.span < 2.0 * np.pi - 1e-6:
        return (face,)
    x = perpendicular_frame(np.array(face.direction))[:, 0]
    box = np.array(face.box)
    across = int(np.abs(x).argmax())
    middle = float(face.point[across])
    low, high = box.copy(), box.copy()
    low[1, across], high[0, across] = middle, middle
    return tuple(replace(face, span=0.5 * face.span, box=(vector3(one[0]), vector3(one[1]))) for one in (low, high))


def _drawn_at(body: Body, X: Pose) -> Body:
    """A body in another frame."""
    exact = body.exact
    if exact is not None:
        of = exact.unit_density
        exact = VolumeProperties.of(of.mass, X.apply(np.array(of.com)), X.R @ np.array(of.inertia) @ X.R.T)
    mesh = TriMesh.of(X.apply(body.mesh.vertices), body.mesh.faces)
    return replace(body, exact=exact, mesh=mesh, faces=tuple(_face_at(face, X) for face in body.faces))


def _face_at(face: Face, X: Pose) -> Face:
    """A face in another frame, with the box of its outline, or of its cylinder, if that is the smaller one."""
    corners = np.array(face.box)
    middle, half = X.apply(corners.mean(axis=0)), 0.5 * np.abs(X.R) @ np.ptp(corners, axis=0)
    low, high = middle - half, middle + half
    point, direction, rings = X.apply(face.point), X.turn(face.direction), tuple(X.apply(r) for r in face.rings)
    if rings:
        low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    elif face.kind in _ROUND:
        reach = 0.5 * face.length * np.abs(direction) + face.radius * np.sqrt(np.maximum(0.0, 1.0 - direction**2))
        low, high = np.maximum(low, point - reach), np.minimum(high, point + reach)
    box = vector3(low), vector3(high)
    return replace(face, point=vector3(point), direction=vector3(direction), box=box, rings=rings)
