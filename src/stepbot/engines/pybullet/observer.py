"""PyBullet as an observer: URDF in full, SDFormat as a tree without inertia, MJCF as a smoke test.

Bullet stores each link in its inertial frame, whose axes are the principal ones: poses, axes and closures are converted
to the link's frame here. A body with a fixed base reports no base mass, so URDF is loaded a second time floating. Link
frames are returned in single precision, inertial frames in double: poses are taken from the latter.
https://docs.google.com/document/d/10sXEhzFRSnvFcl3XxNGhnD4N2SedqwdAvK3dsihxVUA
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import ceil, hypot, inf, log2
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from stepbot.geometry.spatial import Pose, matrix3, turn_inertia, vector3
from stepbot.robot.bounding_boxes import Bounds, mesh_bounds, primitive_bounds
from stepbot.robot.dynamics import GRAVITY
from stepbot.robot.model import Box, Capsule, Cylinder, JointDynamics, Limit, Sphere
from stepbot.robot.surfaces import Surface
from stepbot.runtime.file import is_file

from ..captured_output import printed
from ..distribution import provider
from ..observation import (
    Dynamics,
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedJoint,
    ObservedLink,
    ObservedShape,
    Quantity,
    Request,
)
from ..resources import joined_boxes
from ..sdformat_reader.tree import round_shapes, tree_copy
from ..urdf_versions import readable, without_inertial
from ..xml import xml_root
from . import ENGINE
from .body import Body, body_of, pose

_NO_INERTIA = "loadSDF ignores <inertia> and computes it from the collision shapes"
_NOT_READ = "PyBullet ignores it"
_NOT_RUN: Mapping[str, Mapping[Quantity, str]] = {
    "urdf": {Quantity.MIMIC: _NOT_READ, Quantity.ACTUATORS: _NOT_READ, Quantity.SENSORS: _NOT_READ},
    "sdf": {
        Quantity.INERTIA: _NO_INERTIA,
        Quantity.MASS_MATRIX: _NO_INERTIA,
        Quantity.INVERSE_DYNAMICS: _NO_INERTIA,
        Quantity.SIMULATION: _NO_INERTIA,
        Quantity.MIMIC: _NOT_READ,
        Quantity.CLOSURES: "PyBullet crashes on closed loops in SDFormat; tested on a copy without them",
        Quantity.FRAMES: _NOT_READ,
        Quantity.ACTUATORS: _NOT_READ,
        Quantity.SENSORS: _NOT_READ,
    },
}
_MJCF_REASON = "PyBullet's MJCF reader computes wrong poses; only loading is tested"
_KINDS = {0: "revolute", 1: "prismatic", 2: "ball", 3: "planar", 4: "fixed"}
_TESSELLATED = b"unknown_file"
"""Name of the mesh that loadSDF creates for a cylinder, with 32 sides."""
_IN_VAIN = "Couldn't parse vector3"
"""loadSDF's warning, twice for each cylinder and capsule: it looks for MJCF's two end points first."""
_PLAIN = "?"
"""The line that getMeshData prints for each primitive beside the meshes of a link."""
_ACCEPTED = 1.0 / 64.0
"""Moment of inertia [kg m^2] whose rounding errors Bullet accepts."""
_UNIT_AXIS = re.compile(r"axis of motion not a unit axis \(\[(\S+) (\S+) (\S+)\]\), will use normalized vector")
"""Bullet's warning of an axis that is not exactly of length 1, as after any rotation."""
_PRINTED = 2e-6
"""Largest error of the length of an axis that is printed with six digits."""
_HELD = "base not compared: PyBullet fixes a root link without mass"
_UNSTATED = Surface(0.5, 0.0, 0.0, 0.0)
"""What PyBullet reports for a link without `<contact>`."""
_TOO_DEEP = "XML_ELEMENT_DEPTH_EXCEEDED"
_NO_LIMIT = 1e15
"""SDFormat's value for unlimited is 1e16."""


def prepare() -> None:
    """Import the engine's slow modules."""
    import pybullet  # noqa: F401


def observe(request: Request) -> Observation:
    """Load the file and report its content; to be run in a worker, because PyBullet crashes on unsupported files.

    Raises:
        EngineRefused: PyBullet reports that it cannot load the file.
        EngineCannotRead: The file has more joints, or deeper nested elements, than PyBullet can have.
    """
    import pybullet as engine

    observers = {"urdf": _observe_urdf, "sdf": _observe_sdf, "mjcf": _observe_smoke}
    unstated = _unstated_masses(request)
    try:
        with printed() as lines, readable(request, inertials=False) as (request, replaced), _connected(engine):
            observation = observers[request.format](engine, request)
    except EngineRefused as error:
        if any(_TOO_DEEP in line for line in lines):
            raise EngineCannotRead("PyBullet's parser does not read elements that are nested so deeply") from error
        raise EngineRefused("; ".join([str(error), *_complaints(lines, request)])) from error
    messages = [*_complaints(lines, request), *unstated]
    if request.format == "sdf" and messages.count(_IN_VAIN) == 2 * round_shapes(Path(request.file)):
        messages = [message for message in messages if message != _IN_VAIN]
    return replace(observation, warnings=tuple(dict.fromkeys(messages)), notes=(*replaced, *observation.notes))


def _unstated_masses(request: Request) -> tuple[str, ...]:
    """A warning of links without ``<inertial>``; empty if there are none."""
    path = Path(request.file)
    links = without_inertial(xml_root(path)) if request.format == "urdf" and is_file(path) else ()
    names = ", ".join(link.get("name", "") for link in links)
    return (f"PyBullet takes 1 kg for a link without <inertial>; compared with 0: {names}",) if links else ()


@contextmanager
def _connected(engine: Any) -> Iterator[None]:
    """A server, for all files of a request: another one takes 20 MB of memory and longer than the next world."""
    client = engine.connect(engine.DIRECT)
    try:
        yield
    finally:
        engine.disconnect(client)


@contextmanager
def _loaded(engine: Any, path: Path, written_in: str, *, fixed: bool = False, shapes: bool = True) -> Iterator[Body]:
    """The only body of a file, in a separate world without cached content of previous files."""
    if engine.getNumBodies():
        engine.resetSimulation()
    engine.setPhysicsEngineParameter(enableFileCaching=1)  # each mesh is read once for all the shapes that use it
    engine.setGravity(*GRAVITY)
    try:
        if written_in == "urdf":
            flags = engine.URDF_USE_INERTIA_FROM_FILE | engine.URDF_USE_IMPLICIT_CYLINDER
            if not shapes:
                flags |= engine.URDF_IGNORE_VISUAL_SHAPES | engine.URDF_IGNORE_COLLISION_SHAPES
            bodies = [engine.loadURDF(str(path), useFixedBase=fixed, flags=flags)]
        else:
            bodies = engine.loadSDF(str(path))
        if len(bodies) != 1:
            raise EngineRefused(f"{len(bodies)} models in the file, one expected")
        yield body_of(engine, bodies[0])
    except engine.error as error:
        raise EngineRefused(str(error)) from error
    finally:
        engine.setPhysicsEngineParameter(enableFileCaching=0)  # that also clears the cache of read files


def _observe_smoke(engine: Any, request: Request) -> Observation:
    try:
        engine.loadMJCF(request.file)
    except engine.error as error:
        raise EngineRefused(str(error)) from error
    reasons = dict.fromkeys(Quantity, _MJCF_REASON)
    del reasons[Quantity.LOAD]
    return Observation(ENGINE.name, **provider("pybullet"), format=request.format, not_run=reasons)


def _observe_sdf(engine: Any, request: Request) -> Observation:
    file = Path(request.file)
    with tree_copy(file) as (path, notes), _loaded(engine, path, "sdf") as body:
        observation = replace(_tree(body, request), notes=tuple(notes), not_run=_NOT_RUN["sdf"])
    with tree_copy(file, held=True, shapes=False) as (path, _), _loaded(engine, path, "sdf") as body:
        mass = engine.getDynamicsInfo(body.id, -1)[0]
        # It reads masses, but not inertias: gravity forces alone are compared.
        weights = () if mass else tuple(Dynamics(gravity=dynamics.gravity) for dynamics in _dynamics(body, request))
        observation = replace(observation, dynamics=weights)
    if not observation.links[0].mass:  # fixed, whatever the file states
        return replace(observation, notes=(*observation.notes, _HELD))
    return replace(observation, base="floating" if mass else "fixed")


def _observe_urdf(engine: Any, request: Request) -> Observation:
    from .motion import close_in_simulation, simulate

    path = Path(request.file)
    joints = xml_root(path).iter("joint") if is_file(path) else ()  # PyBullet rejects what is not there
    unmoved = [joint for joint in joints if joint.get("type") in ("planar", "floating")]
    if unmoved:
        names = ", ".join(f"'{joint.get('name')}' ({joint.get('type')})" for joint in unmoved)
        raise EngineCannotRead(f"PyBullet does not move these joints: {names}")
    with _loaded(engine, path, "urdf", fixed=True) as body:
        observation = replace(_tree(body, request), not_run=_NOT_RUN["urdf"])
        single = len(body.coordinates) == sum(info[2] != engine.JOINT_FIXED for info in body.joints)
        finite = simulate(body, request) if request.simulate and not request.floating else None
        if request.closures and request.ways:
            closures, notes = close_in_simulation(body, request)
            observation = replace(observation, closures=closures, notes=notes)
    if single:
        with _loaded(engine, path, "urdf", fixed=True, shapes=False) as body:
            observation = replace(observation, dynamics=_dynamics(body, request))
    # A fixed base reports no mass: its mass is read from a second, floating copy.
    with _loaded(engine, path, "urdf", shapes=False) as body:
        base = _link(body, -1, request)
        first, *others = observation.links
        links = (replace(first, mass=base.mass, com=base.com, inertia=base.inertia), *others)
        finite = simulate(body, request) if request.simulate and request.floating else finite
    return replace(observation, links=links, simulation_finite=finite)


def _tree(body: Body, request: Request) -> Observation:
    """What PyBullet reports for every format: links, joints, poses."""
    return Observation(
        engine=ENGINE.name,
        **provider("pybullet"),
        format=request.format,
        name=body.model,
        links=tuple(_link(body, index, request) for index in range(-1, len(body.joints))),
        joints=tuple(_joint(body, index, request.format) for index in range(len(body.joints))),
        coordinates=tuple(body.coordinates),
        poses=tuple(_poses(body, q) for q in [*request.configurations, *request.closed]),
    )


def _link(body: Body, index: int, request: Request) -> ObservedLink:
    mass, friction, principal, _, _, restitution, rolling, spinning, *_ = body.engine.getDynamicsInfo(body.id, index)
    # loadSDF reads no contact properties.
    surface = Surface(friction, spinning, rolling, restitution) if request.format == "urdf" else None
    X_LI = body.X_LI[index + 1]
    inertia = turn_inertia(X_LI.R, np.diag(principal)) if request.format == "urdf" else None
    visuals = [data for data in body.engine.getVisualShapeData(body.id) if data[1] == index]
    colors = [tuple(data[7]) for data in visuals]
    collisions = body.engine.getCollisionShapeData(body.id, index)
    return ObservedLink(
        body.links[index + 1],
        float(mass),
        X_LI.position,
        None if inertia is None else matrix3(inertia),
        visual_bounds=_visual_bounds(body, visuals),
        collision_bounds=_collision_bounds(body, index, collisions),
        # PyBullet displays the collision shapes of a link without visuals.
        has_visuals=None if collisions else bool(visuals),
        has_collisions=bool(collisions),
        # It displays a visual without a colour in opaque white.
        visuals=tuple(ObservedShape(rgba=rgba, rgba_is_default=rgba == (1.0, 1.0, 1.0, 1.0)) for rgba in colors),
        collisions=tuple(ObservedShape(surface=surface, surface_default=surface and _UNSTATED) for _ in collisions),
    )


def _visual_bounds(body: Body, shapes: Sequence[tuple[Any, ...]]) -> Bounds | None:
    """Bounding box of the visuals, in the link's frame; None with a mesh, whose vertices PyBullet does not return."""
    if any(shape[2] == body.engine.GEOM_MESH for shape in shapes):
        return None
    return joined_boxes(
        [primitive_bounds(_primitive(body.engine, shape[2], shape[3]), pose(*shape[5:7])) for shape in shapes]
    )


def _collision_bounds(body: Body, index: int, shapes: Sequence[tuple[Any, ...]]) -> Bounds | None:
    """Bounding box of the collisions, in the link's frame; the shapes are given in the inertial frame."""
    engine, X_LI = body.engine, body.X_LI[index + 1]
    if any(shape[4] == _TESSELLATED for shape in shapes):
        return None
    boxes = [
        primitive_bounds(_primitive(engine, shape[2], shape[3]), X_LI @ pose(*shape[5:7]))
        for shape in shapes
        if shape[2] != engine.GEOM_MESH
    ]
    if len(boxes) < len(shapes):
        count, vertices = engine.getMeshData(body.id, index)
        if not count:
            return None
        boxes.append(mesh_bounds(vertices, X_LI))
    return joined_boxes(boxes)


def _primitive(engine: Any, kind: int, size: Sequence[float]) -> Box | Cylinder | Sphere | Capsule:
    """A shape from PyBullet's type and dimensions.

    Raises:
        EngineCannotRead: PyBullet reports a type of shape that the format does not have.
    """
    if kind == engine.GEOM_BOX:
        return Box(vector3(size))
    if kind == engine.GEOM_SPHERE:
        return Sphere(size[0])
    if kind == engine.GEOM_CYLINDER:
        return Cylinder(radius=size[1], length=size[0])
    if kind == engine.GEOM_CAPSULE:
        return Capsule(radius=size[1], length=size[0])
    raise EngineCannotRead(f"PyBullet reports a shape of kind {kind}")


def _joint(body: Body, index: int, written_in: str) -> ObservedJoint:
    info = body.joints[index]
    kind = _KINDS.get(info[2], f"PyBullet's joint type {info[2]}")
    parent = body.links[info[16] + 1]
    if kind not in ("revolute", "prismatic"):
        return ObservedJoint(body.name(index), kind, parent, body.links[index + 1])
    lower, upper = info[8:10]
    if lower > upper or (lower <= -_NO_LIMIT and upper >= _NO_LIMIT):
        lower, upper = -inf, inf
        kind = "continuous" if kind == "revolute" else kind
    # loadSDF reads no limits of continuous joints, so their effort and velocity are not reported.
    silent = written_in == "sdf" and not (info[10] or info[11])
    limit = Limit(lower, upper, velocity=info[11] or inf, effort=info[10] or inf).without_beyond(_NO_LIMIT)
    return ObservedJoint(
        body.name(index),
        kind,
        parent,
        body.links[index + 1],
        axis=vector3(body.X_LI[index + 1].turn(info[13])),
        limit=limit,
        limit_fields=("lower", "upper") if silent else ("lower", "upper", "velocity", "effort"),
        dynamics=JointDynamics(damping=info[6], friction=info[7]),
    )


def _poses(body: Body, q: Mapping[str, float]) -> dict[str, Pose]:
    body.set(q)
    X_RW = body.X_WL(-1).inverse()
    return {link: X_RW @ body.X_WL(index) for index, link in enumerate(body.links, start=-1)}


def _dynamics(body: Body, request: Request) -> tuple[Dynamics, ...]:
    """The equations of motion at every configuration; changes the masses of the body."""
    if not body.coordinates:
        return tuple(Dynamics(np.zeros((0, 0)), np.zeros(0), np.zeros(0)) for _ in request.moments)
    try:
        return _equations(body, request, 1.0 / _lightened(body))
    except (ArithmeticError, SystemError, ValueError) as error:  # of masses and inertias that no body has
        raise EngineRefused("masses or inertias with which PyBullet cannot compute the motion") from error


def _equations(body: Body, request: Request, factor: float) -> tuple[Dynamics, ...]:
    """The equations of motion of a body whose masses and inertias are to be multiplied by ``factor``."""
    equations = []
    for q, rates in request.moments:
        positions, *moving = ([float(given.get(name, 0.0)) for name in body.coordinates] for given in (q, *rates))
        rest = [0.0] * len(positions)
        M = body.engine.calculateMassMatrix(body.id, positions)
        gravity = body.engine.calculateInverseDynamics(body.id, positions, rest, rest)
        inverse = body.engine.calculateInverseDynamics(body.id, positions, *moving)
        equations.append(Dynamics(factor * np.array(M), factor * np.array(gravity), factor * np.array(inverse)))
    return tuple(equations)


def _lightened(body: Body) -> float:
    """Scale all masses and inertias by a power of two, and return it.

    Bullet rejects a link if its inertia, turned into the frame of its joint, differs from the transpose by more than
    1.1e-15 kg m^2 (``kIsZero`` in IDMath.cpp), as rounding lets it for moments above about 1 kg m^2. A power of two
    scales everything that Bullet computes from them exactly.
    """
    links = range(len(body.joints))
    known = [(index, *body.engine.getDynamicsInfo(body.id, index)[:3:2]) for index in links]
    largest = max(
        max(moments) + mass * float(np.square(body.X_LI[index + 1].p).sum()) for index, mass, moments in known
    )
    factor = 2.0 ** -max(0, ceil(log2(largest / _ACCEPTED))) if largest else 1.0
    for index, mass, moments in known if factor < 1.0 else ():
        inertia = [factor * moment for moment in moments]
        body.engine.changeDynamics(body.id, index, mass=factor * mass, localInertiaDiagonal=inertia)
    return factor


def _complaints(lines: Sequence[str], request: Request) -> list[str]:
    """The messages among printed lines, without folders and positions in PyBullet's source."""
    # A message ends without a line feed, so what getMeshData prints may follow it on its line.
    own = (line.rstrip().removesuffix(_PLAIN) for line in lines)
    text = "\n".join(own).replace(str(Path(request.file).parent) + os.sep, "")
    parts = re.split(r"b3(?:Warning|Error|Printf)\[[^\[\]]*\]:", text)
    messages = (" ".join(part.split()) for part in parts if part.strip())
    return [message for message in messages if not _is_rounded_axis(message)]


def _is_rounded_axis(message: str) -> bool:
    """Whether a message is about an axis whose length is 1 except for rounding; axes are compared with the file's."""
    axis = _UNIT_AXIS.fullmatch(message)
    return axis is not None and abs(hypot(*map(float, axis.groups())) - 1.0) < _PRINTED
