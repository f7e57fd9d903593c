"""Drake as an observer of SDFormat, URDF and MJCF: libsdformat's reading of poses and frames, and a plant of its own.

Drake takes no joint that closes a loop: a robot with loops has a file of its own for it, with ball constraints. What it
knows it cannot do, such as joint friction, it says while it reads; that is no fault of the file, and noted.
https://drake.mit.edu/pydrake/pydrake.multibody.parsing.html
"""

import importlib.metadata
import importlib.util
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics import GRAVITY, Rates
from ..spatial import Array, Pose, join_bounds, matrix3, shift_inertia, vector3
from ._drake_coordinates import Coordinates
from ._drake_joints import observed_joints
from ._drake_shapes import bounds_of, observed_shape
from ._resources import resolve
from .observation import (
    Dynamics,
    EngineCannotRead,
    EngineRefused,
    Observation,
    ObservedLink,
    Quantity,
    Request,
)

NAME = "drake"
FORMATS = ("urdf", "sdf", "mjcf", "drake.sdf")
OPTIONAL = True
INSTALL = "pip install 'stepbot[verify]'"

STEP = 1e-3
"""Step [s] of the plant."""
_NOT_TOLD = "pydrake does not tell"
_EFFORTS = "Drake keeps an effort limit for each actuator, compared with those of the joints"
_NO_SENSORS = "Drake does not read sensors"
_NOT_RUN: Mapping[str, Mapping[Quantity, str]] = {
    "urdf": {
        Quantity.CLOSURES: "URDF holds no loops",
        Quantity.MIMIC: _NOT_TOLD,
        Quantity.ACTUATORS: _EFFORTS,
        Quantity.SENSORS: _NO_SENSORS,
    },
    "sdf": {
        Quantity.MIMIC: "Drake does not read <mimic> of SDFormat",
        Quantity.ACTUATORS: _EFFORTS,
        Quantity.SENSORS: _NO_SENSORS,
    },
    "mjcf": {
        Quantity.MIMIC: "Drake does not read equalities of joints",
        Quantity.CLOSURES: "Drake does not read equalities of sites",
        Quantity.FRAMES: "Drake does not read sites",
        Quantity.ACTUATORS: "Drake reads motors only",
        Quantity.SENSORS: _NO_SENSORS,
        Quantity.LIMITS: "Drake reads no actuatorfrcrange",
    },
}
_GAP = re.compile(r"not (currently |yet )?support|unsupported|not implemented|(will be|element) ignored", re.IGNORECASE)
"""What Drake says of things that it knows, and does nothing about."""
_LOOP = "form one or more loops"
_URI = re.compile(r"""(?:package|model)://([^/"'<>]+)/([^"'<>]+)""")


def available() -> str | None:
    """Why the engine cannot run here; None where it can."""
    if importlib.util.find_spec("pydrake") is None:
        return "drake is not installed"
    return None


def prepare() -> None:
    """Do the slow import, while there is still time."""
    import pydrake.multibody.parsing
    import pydrake.multibody.plant  # noqa: F401


def observe(request: Request) -> Observation:
    """Parse the file and say what is in it; to be run in a worker, because Drake aborts on some of what it refuses.

    Raises:
        EngineRefused: Drake says that the file is wrong.
        EngineCannotRead: It holds what Drake is known not to read.
    """
    from ._drake_motion import closures_in, simulate

    path = Path(request.file)
    if request.format == "mjcf":
        _check_mjcf(path)
    with _messages(path) as messages:
        built = build(request)
        observation = _static(built, request)
        if request.closures and request.format == "drake.sdf":
            observation = replace(observation, closures=closures_in(built, request))
        if request.simulate:
            observation = replace(observation, simulation_finite=simulate(built, request))
    gaps = [message for message in messages if _GAP.search(message)]
    warnings = [message for message in messages if message not in gaps]
    return replace(observation, warnings=tuple(dict.fromkeys(warnings)), notes=tuple(dict.fromkeys(gaps)))


@contextmanager
def _messages(path: Path) -> Iterator[list[str]]:
    """Collect what Drake logs as a warning or worse, without folders and line numbers."""
    collected: list[str] = []
    place = re.compile(r"^.*?(warning|error): ", re.DOTALL)

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            text = record.getMessage()
            text = place.sub("", text, count=1).replace(f"{path.parent.as_posix()}/", "")
            collected.append(" ".join(text.split()))

    logger, collector = logging.getLogger("drake"), Collector(logging.WARNING)
    handed_on, logger.propagate = logger.propagate, False
    logger.addHandler(collector)
    try:
        yield collected
    finally:
        logger.removeHandler(collector)
        logger.propagate = handed_on


def _check_mjcf(path: Path) -> None:
    """Refuse to ask Drake what it is known to stumble over: several joints in a body, infinite ranges, no mass.

    Raises:
        EngineCannotRead: The file has one of them.
    """
    from lxml import etree

    try:
        top = etree.parse(str(path), etree.XMLParser(resolve_entities=False, remove_comments=True)).getroot()
    except etree.XMLSyntaxError as error:
        raise EngineRefused(f"not XML: {error.msg}") from error
    if any(len(body.findall("joint")) > 1 for body in top.iter("body")):
        raise EngineCannotRead("Drake turns several joints in one body about wrong axes")
    if any("inf" in joint.get("range", "") for joint in top.iter("joint")):
        raise EngineCannotRead("Drake reads no infinite range in MJCF")
    if any(float(inertial.get("mass") or 1.0) == 0.0 for inertial in top.iter("inertial")):
        raise EngineCannotRead("Drake ends the process over a body without mass in MJCF")


@dataclass(frozen=True, eq=False)
class Built:
    """A plant, what shows its shapes, and a state of it."""

    plant: Any
    scene: Any
    diagram: Any
    whole: Any
    """Context of the diagram."""
    context: Any
    """That of the plant in it."""
    root: Any
    """Body of the root link."""
    request: Request
    frames: tuple[str, ...]
    """Names of the frames that the file has, as far as Drake keeps them."""
    name: str
    """What the robot is called."""

    @cached_property
    def bodies(self) -> list[Any]:
        """The links: every body but the world."""
        from pydrake.multibody.tree import BodyIndex

        return [self.plant.get_body(BodyIndex(index)) for index in range(1, self.plant.num_bodies())]

    @cached_property
    def joints(self) -> list[Any]:
        """All joints, but those that Drake adds for floating bodies."""
        joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]
        return [joint for joint in joints if not joint.is_ephemeral()]

    @cached_property
    def coordinates(self) -> Coordinates:
        """What the joints are moved by."""
        return Coordinates(self.plant, self.joints, self.request)

    def place(self, q: Mapping[str, float]) -> None:
        """Put the joints where ``q`` has them, at rest."""
        positions = np.array(self.plant.GetPositions(self.context))
        self.coordinates.place(positions, q)
        self.plant.SetPositions(self.context, positions)
        self.plant.SetVelocities(self.context, np.zeros(self.plant.num_velocities()))

    def X_WB(self, body: Any) -> Pose:
        """Pose of a body in the world."""
        return pose(self.plant.EvalBodyPoseInWorld(self.context, body))


def pose(X: Any) -> Pose:
    """A pose from Drake's."""
    return Pose.of(X.rotation().matrix(), X.translation())


def build(request: Request, gravity: tuple[float, float, float] = GRAVITY, *, shapes: bool = True) -> Built:
    """The plant of a file, with the root held where neither the file nor the request lets it go.

    Raises:
        EngineRefused: Drake does not read it.
        EngineCannotRead: A joint closes a loop.
    """
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation, MultibodyPlant
    from pydrake.systems.framework import DiagramBuilder

    path, builder, scene = Path(request.file), DiagramBuilder(), None
    if shapes:
        plant, scene = AddMultibodyPlantSceneGraph(builder, STEP)
    else:
        plant = builder.AddSystem(MultibodyPlant(STEP))
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)  # ball constraints want it
    plant.mutable_gravity_field().set_gravity_vector(list(gravity))
    try:
        parser = Parser(plant)
        for name, folder in _packages(path).items():
            parser.package_map().Add(name, folder)
        models = parser.AddModels(path)
        if len(models) != 1:
            raise EngineRefused(f"{len(models)} models in the file, one expected")
        root, name = _root(plant, models[0]), plant.GetModelInstanceName(models[0])
        if request.format == "urdf" and not request.floating and not _is_held(plant, root):
            plant.WeldFrames(plant.world_frame(), root.body_frame())
        plant.Finalize()
        diagram = builder.Build()
    except RuntimeError as error:
        text = str(error).replace(f"{path.parent.as_posix()}/", "").strip()
        if _LOOP in text:
            raise EngineCannotRead("Drake takes no joint that closes a loop") from error
        raise EngineRefused(text) from error
    whole = diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(whole)
    for index in plant.GetJointActuatorIndices():  # armature is compared by itself, where an engine tells of it
        plant.get_joint_actuator(index).SetRotorInertia(context, 0.0)
    return Built(plant, scene, diagram, whole, context, root, request, _frame_names(plant), name)


def _packages(path: Path) -> dict[str, Path]:
    """Folders of the packages that a description names, as :func:`resolve` finds them."""
    found: dict[str, Path] = {}
    for name, rest in _URI.findall(path.read_text(encoding="utf-8", errors="replace")):
        file = None if name in found else resolve(f"package://{name}/{rest}", path)
        if file is not None:
            found[name] = file.absolute().parents[len(Path(rest).parts) - 1]
    return found


def _joints_of(plant: Any) -> list[Any]:
    return [plant.get_joint(index) for index in plant.GetJointIndices()]


def _root(plant: Any, model: Any) -> Any:
    """The link that hangs from no other.

    Raises:
        EngineRefused: There is none, or there are several.
    """
    held = {int(joint.child_body().index()) for joint in _joints_of(plant) if int(joint.parent_body().index()) != 0}
    roots = [index for index in plant.GetBodyIndices(model) if int(index) not in held and int(index) != 0]
    if len(roots) != 1:
        raise EngineRefused(f"{len(roots)} root links, one expected")
    return plant.get_body(roots[0])


def _is_held(plant: Any, root: Any) -> bool:
    """Whether a joint of the file holds the root in the world."""
    return any(joint.child_body().index() == root.index() for joint in _joints_of(plant))


def _frame_names(plant: Any) -> tuple[str, ...]:
    """Frames that are neither those of bodies nor those that Drake makes of joints and of the model."""
    from pydrake.multibody.tree import FrameIndex

    joints = [joint.name() for joint in _joints_of(plant)]
    made = {"", "__model__", "world"} | {f"{name}_{side}" for name in joints for side in ("parent", "child")}
    frames = [plant.get_frame(FrameIndex(index)) for index in range(plant.num_frames())]
    named = [frame.name() for frame in frames if not frame.is_body_frame() and frame.name() not in made]
    return tuple(
        name for name in named if not (name.endswith(("_F", "_M")) and name.startswith(tuple(f"{j}_" for j in joints)))
    )


def _static(built: Built, request: Request) -> Observation:
    closed = [q for way in request.ways for q in way]
    format_name = "sdf" if request.format == "drake.sdf" else request.format
    held = any(joint.child_body().index() == built.root.index() for joint in built.joints)
    return Observation(
        engine=NAME,
        version=importlib.metadata.version("drake"),
        format=request.format,
        name=built.name,
        base=None if format_name == "urdf" else "fixed" if held else "floating",
        links=tuple(_link(built, body) for body in built.bodies),
        joints=observed_joints(built),
        coordinates=built.coordinates.names,
        poses=tuple(_poses(built, q) for q in [*request.configurations, *closed]),
        dynamics=tuple(_dynamics(built, *at) for at in request.moments),
        frames=_frames(built) if format_name == "sdf" else None,
        not_run=_NOT_RUN[format_name],
    )


def _link(built: Built, body: Any) -> ObservedLink:
    spatial = body.default_spatial_inertia()
    mass = float(spatial.get_mass())
    inertia, com = np.zeros((3, 3)), np.zeros(3)
    if mass:
        com = np.array(spatial.get_com())
        inertia = shift_inertia(spatial.CalcRotationalInertia().CopyToFullMatrix3(), -mass, com)
    visuals = built.plant.GetVisualGeometriesForBody(body)
    collisions = built.plant.GetCollisionGeometriesForBody(body)
    seen, touched = ([bounds_of(built, shape) for shape in shapes] for shapes in (visuals, collisions))
    named = built.request.format != "mjcf"  # of which Drake keeps no names of shapes
    return ObservedLink(
        body.name(),
        mass,
        vector3(com),
        matrix3(inertia),
        visual_bounds=join_bounds(seen) if seen else None,
        collision_bounds=join_bounds(touched) if touched else None,
        has_visuals=bool(seen),
        has_collisions=bool(touched),
        visuals=tuple(observed_shape(built, shape, seen=True) for shape in visuals) if named else None,
        collisions=tuple(observed_shape(built, shape, seen=False) for shape in collisions) if named else None,
    )


def _poses(built: Built, q: Mapping[str, float]) -> dict[str, Pose]:
    built.place(q)
    X_RW = built.X_WB(built.root).inverse()
    return {body.name(): X_RW @ built.X_WB(body) for body in built.bodies}


def _frames(built: Built) -> dict[str, tuple[str, Pose]]:
    frames = (built.plant.GetFrameByName(name) for name in built.frames)
    return {frame.name(): (frame.body().name(), pose(frame.GetFixedPoseInBodyFrame())) for frame in frames}


def _dynamics(built: Built, q: Mapping[str, float], rates: Rates) -> Dynamics:
    """Mass matrix, gravity forces and inverse dynamics over the coordinates."""
    from pydrake.multibody.tree import MultibodyForces

    plant, context = built.plant, built.context
    built.place(q)
    E = built.coordinates.rates(q)
    M: Array = np.array(plant.CalcMassMatrix(context))
    gravity = -np.array(plant.CalcGravityGeneralizedForces(context))
    speeds, accelerations = built.coordinates.moving(q, rates)
    plant.SetVelocities(context, speeds)
    inverse = np.array(plant.CalcInverseDynamics(context, accelerations, MultibodyForces(plant))) + gravity
    return Dynamics(E.T @ M @ E, E.T @ gravity, E.T @ inverse)
