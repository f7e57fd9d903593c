"""A Drake plant of one file, with its state; passive motion, and loops closed by its constraint solver."""

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from stepbot.geometry.spatial import Array, Pose
from stepbot.robot.closures import closure_gap
from stepbot.robot.dynamics import GRAVITY

from ..observation import EngineCannotRead, EngineRefused, ObservedClosure, Request
from ..resources import resolve
from ..xml import xml_root
from .coordinates import Coordinates, pose

STEP = 1e-3
"""Step [s] of the plant."""
_LOOP = "form one or more loops"
_NO_HULL = "MakeConvexHull only applies to"
_SPRING = re.compile(rb"<spring_(stiffness|reference)>[^<]*</spring_\1>")
"""A spring: it would hold a loop open, since the solver's constraints give way to a load that does not cease."""
_NEAR = 1e-12, 1e-7
"""Second component of an axis that Drake may take to be the coordinate axis next to it, if that matters. Drake does so
where the first component is 1 to within 2.2e-16, and the second thus up to 1.8e-8."""
_URI = re.compile(r"""(?:package|model)://([^/"'<>]+)/([^"'<>]+)""")


class BuiltPlant(Struct, frozen=True, eq=False, dict=True):
    """A plant, the geometry of its links, and a state."""

    plant: Any
    scene: Any
    diagram: Any
    whole: Any
    """Context of the diagram."""
    context: Any
    """The plant's context in it."""
    root: Any
    """Body of the root link."""
    request: Request
    frames: tuple[str, ...]
    """Names of the frames in the file, as far as Drake keeps them."""
    name: str
    rounded: tuple[str, ...]
    """Joints whose axis Drake may take to be a coordinate axis."""

    @cached_property
    def names(self) -> frozenset[str]:
        """All names in the file; Drake makes others for shapes without one, or with one that is taken."""
        return frozenset(map(str, xml_root(Path(self.request.file)).xpath("//@name")))

    @cached_property
    def hulls(self) -> dict[tuple[Any, ...], Array]:
        """Corners (n, 3) [m] of the hulls that were asked for, by mesh file and scale or by geometry."""
        return {}

    @cached_property
    def bodies(self) -> list[Any]:
        """The links: every body but the world."""
        from pydrake.multibody.tree import BodyIndex

        return [self.plant.get_body(BodyIndex(index)) for index in range(1, self.plant.num_bodies())]

    @cached_property
    def joints(self) -> list[Any]:
        """All joints, except those that Drake adds for floating bodies."""
        joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]
        return [joint for joint in joints if not joint.is_ephemeral()]

    @cached_property
    def coordinates(self) -> Coordinates:
        """The coordinates of the joints."""
        return Coordinates(self.plant, self.joints, self.request)

    def place(self, q: Mapping[str, float]) -> None:
        """Set the joints to ``q``, at rest."""
        positions = np.array(self.plant.GetPositions(self.context))
        self.coordinates.place(positions, q)
        self.plant.SetPositions(self.context, positions)
        self.plant.SetVelocities(self.context, np.zeros(self.plant.num_velocities()))

    def X_WB(self, body: Any) -> Pose:
        """Pose of a body in the world."""
        return pose(self.plant.EvalBodyPoseInWorld(self.context, body))


def build(
    request: Request, gravity: tuple[float, float, float] = GRAVITY, *, bare: bool = False, exact: bool = False
) -> BuiltPlant:
    """The plant of a file; the root is fixed unless it may float.

    Args:
        request: The file, and whether its root may float.
        gravity: Acceleration of gravity [m/s^2].
        bare: Leave out shapes and springs.
        exact: Leave out constraints and motors, too, and put all axes where the file has them.

    Raises:
        EngineRefused: Drake does not read it.
        EngineCannotRead: A joint closes a loop.
    """
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation, MultibodyPlant
    from pydrake.systems.framework import DiagramBuilder

    path, builder, scene = Path(request.file), DiagramBuilder(), None
    if bare:
        plant = builder.AddSystem(MultibodyPlant(STEP))
    else:
        plant, scene = AddMultibodyPlantSceneGraph(builder, STEP)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)  # required by ball constraints
    try:
        parser = Parser(plant)
        for name, folder in _packages(path).items():
            parser.package_map().Add(name, folder)
        if bare and request.format.endswith("sdf"):
            models = parser.AddModelsFromString(_SPRING.sub(b"", path.read_bytes()).decode(), "sdf")
        else:
            models = parser.AddModels(path)
        plant.mutable_gravity_field().set_gravity_vector(list(gravity))  # the parser takes that of the file
        if len(models) != 1:
            raise EngineRefused(f"{len(models)} models in the file, one expected")
        root, name = _root(plant, models[0]), plant.GetModelInstanceName(models[0])
        if request.format == "urdf" and not request.floating and not _is_held(plant, root):
            plant.WeldFrames(plant.world_frame(), root.body_frame())
        rounded = [joint for joint in _joints_of(plant) if _is_near_a_coordinate_axis(joint)]
        names = tuple(joint.name() for joint in rounded)
        if exact:
            _turn_frames(plant, rounded)
        plant.Finalize()
        diagram = builder.Build()
    except (RuntimeError, UnicodeDecodeError) as error:
        # Drake's bindings do not decode a message that has a name in another encoding than UTF-8.
        raw = error.object.decode("utf-8", "surrogateescape") if isinstance(error, UnicodeDecodeError) else str(error)
        text = raw.replace(f"{path.parent.as_posix()}/", "").strip()
        if _LOOP in text:
            raise EngineCannotRead("Drake does not support a joint that closes a loop") from error
        if _NO_HULL in text:
            raise EngineCannotRead("Drake reads collision meshes as OBJ, VTK and glTF only") from error
        raise EngineRefused(text) from error
    whole = diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(whole)
    for index in plant.GetJointActuatorIndices():  # armature is compared separately, if the engine reports it
        plant.get_joint_actuator(index).SetRotorInertia(context, 0.0)
    return BuiltPlant(plant, scene, diagram, whole, context, root, request, _frame_names(plant), name, names)


def _packages(path: Path) -> dict[str, Path]:
    """Folders of the packages that a description refers to, as :func:`resolve` finds them."""
    packages: dict[str, Path] = {}
    for name, rest in _URI.findall(path.read_text(encoding="utf-8", errors="replace")):
        file = None if name in packages else resolve(f"package://{name}/{rest}", path)
        if file is not None:
            packages[name] = file.absolute().parents[len(Path(rest).parts) - 1]
    return packages


def _joints_of(plant: Any) -> list[Any]:
    return [plant.get_joint(index) for index in plant.GetJointIndices()]


def _root(plant: Any, model: Any) -> Any:
    """The link without a parent.

    Raises:
        EngineRefused: There is none, or there are several.
    """
    held = {int(joint.child_body().index()) for joint in _joints_of(plant) if int(joint.parent_body().index()) != 0}
    roots = [index for index in plant.GetBodyIndices(model) if int(index) not in held and int(index) != 0]
    if len(roots) != 1:
        raise EngineRefused(f"{len(roots)} root links, one expected")
    return plant.get_body(roots[0])


def _is_held(plant: Any, root: Any) -> bool:
    """Whether a joint of the file fixes the root to the world."""
    return any(joint.child_body().index() == root.index() for joint in _joints_of(plant))


def axis_of(joint: Any) -> Array | None:
    """Axis of a hinge or slide in the joint's frames; None for other joints."""
    getter = {"revolute": "revolute_axis", "prismatic": "translation_axis"}.get(joint.type_name())
    return np.array(getattr(joint, getter)()) if getter else None


def _is_near_a_coordinate_axis(joint: Any) -> bool:
    axis = axis_of(joint)
    return axis is not None and _NEAR[0] < sorted(np.abs(axis).tolist())[1] < _NEAR[1]


def _turn_frames(plant: Any, joints: Sequence[Any]) -> None:
    """Turn the frames of joints until no axis is near a coordinate axis; the joints move the links as before."""
    from pydrake.common.eigen_geometry import AngleAxis
    from pydrake.math import RigidTransform, RotationMatrix
    from pydrake.multibody.tree import FixedOffsetFrame

    R = RotationMatrix(AngleAxis(1.0, np.ones(3) / np.sqrt(3.0)))
    for index in plant.GetJointActuatorIndices():
        plant.RemoveJointActuator(plant.get_joint_actuator(index))
    for constraint in plant.GetConstraintIds():
        plant.RemoveConstraint(constraint)
    for joint in joints:
        F, M = (
            plant.AddFrame(FixedOffsetFrame(f"{joint.name()} {side}", frame, RigidTransform(R)))
            for side, frame in (("inboard", joint.frame_on_parent()), ("outboard", joint.frame_on_child()))
        )
        replacement = type(joint)(joint.name(), F, M, R.matrix().T @ axis_of(joint))
        plant.RemoveJoint(joint)
        plant.AddJoint(replacement)


def _frame_names(plant: Any) -> tuple[str, ...]:
    """Frames other than those of bodies and those that Drake adds for joints and the model."""
    from pydrake.multibody.tree import FrameIndex

    joints = [joint.name() for joint in _joints_of(plant)]
    made = {"", "__model__", "world"} | {f"{name}_{side}" for name in joints for side in ("parent", "child")}
    frames = [plant.get_frame(FrameIndex(index)) for index in range(plant.num_frames())]
    named = [frame.name() for frame in frames if not frame.is_body_frame() and frame.name() not in made]
    return tuple(
        name for name in named if not (name.endswith(("_F", "_M")) and name.startswith(tuple(f"{j}_" for j in joints)))
    )


def _without_frames_of_sensors(top: Any) -> str:
    """Leave out Gazebo's names of the frames of sensors, which libsdformat ignores with a warning."""
    named = list(top.iter("gz_frame_id"))
    for one in named:
        one.getparent().remove(one)
    return "no <gz_frame_id>, which this engine rejects" if named else ""


def _with_one_friction(top: Any) -> str:
    """State the friction of the first direction in both: Drake takes the second, 1 by default, for that of sliding.

    It rejects more than the first, which is compared.
    """
    from lxml import etree

    changed = False
    for ode in top.iterfind(".//surface/friction/ode"):
        first, second = (ode.find(name) for name in ("mu", "mu2"))
        if first is None and second is not None:
            ode.remove(second)
        elif first is not None and (second is None or second.text != first.text):
            second = etree.SubElement(ode, "mu2") if second is None else second
            second.text = first.text
        else:
            continue
        changed = True
    return "<mu2> equal to <mu>, since this engine takes it for the friction of sliding" if changed else ""


CHANGES = {"sdf": (_without_frames_of_sensors, _with_one_friction)}
"""By format, what :func:`.readable` changes before Drake reads a file."""


NUDGES = (0.02, -0.02, 0.002, -0.002)
"""Offsets [rad], [m] of the following joints from the reference's solution, from which Drake's solver starts."""
BACK = 1e-6
"""Distance [rad], [m] from the reference's solution at which no further offset is tried."""
SETTLED = 1e-12
"""Motion [rad], [m] per step below which the plant is at rest."""
MOST_STEPS = 4000
"""Next to a dead centre each step takes a hundredth of what is left, elsewhere a half and more."""


def simulate(built: BuiltPlant, request: Request) -> bool:
    """Simulate from the initial pose, without actuation; returns whether all values stayed finite."""
    from pydrake.systems.analysis import Simulator

    simulator = Simulator(built.diagram)
    context = built.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    built = replace(built, context=context)
    built.place(request.initial)
    try:
        simulator.AdvanceTo(request.simulate)
    except RuntimeError:  # the solver throws on NaN
        return False
    return bool(np.isfinite(built.plant.GetPositionsAndVelocities(context)).all())


def closures_in(_built: BuiltPlant, request: Request) -> tuple[ObservedClosure, ...]:
    """How well Drake's constraints close each loop of the reference.

    Drake starts near each closed configuration, without gravity and springs, with the driven joints locked, and its
    solver closes the loops step by step. Next to a dead centre another configuration that closes them may be as near,
    so there it starts from several sides, and nearer. The residual is the remaining gap between the reference's frames.
    """
    plain = build(request, (0.0, 0.0, 0.0), bare=True)
    residual = {closure.name: 0.0 for closure in request.closures}
    deviation = 0.0
    for q in request.closed:
        deviation = max(deviation, _back_at(plain, request, q))
        X_W = {body.name(): plain.X_WB(body) for body in plain.bodies}
        for closure in request.closures:
            gap = closure_gap(closure, X_W[closure.link_a], X_W[closure.link_b])[0]
            residual[closure.name] = max(residual[closure.name], gap)
    return tuple(
        ObservedClosure(
            closure.name,
            closure.kind.value,
            closure.link_a,
            closure.link_b,
            residual=residual[closure.name],
            angle_error=deviation,
        )
        for closure in request.closures
    )


def _back_at(built: BuiltPlant, request: Request, q: Mapping[str, float]) -> float:
    """The least distance [rad] or [m] from a solution at which Drake's solver comes to rest next to it."""
    distances: list[float] = []
    for nudge in NUDGES:
        q_closed = _closed(built, request, q, nudge)
        distances.append(
            max((abs(q_closed[name] - q[name]) for name in q_closed if name not in request.driven), default=0.0)
        )
        if distances[-1] <= BACK:
            break
    return min(distances)


def _closed(built: BuiltPlant, request: Request, q: Mapping[str, float], nudge: float) -> dict[str, float]:
    """The coordinates at which Drake's solver comes to rest."""
    plant, context = built.plant, built.context
    # Drake reads no mimics of SDFormat: the followers of a driven joint are locked with it.
    held = {*request.driven, *(name for name, mimic in request.mimics.items() if mimic.joint in request.driven)}
    built.place({name: q.get(name, 0.0) + (0.0 if name in held else nudge) for name in built.coordinates.names})
    for joint in built.joints:
        if joint.name() in held:
            joint.Lock(context)
        elif joint.is_locked(context):
            joint.Unlock(context)
    before = np.array(plant.GetPositions(context))
    for _ in range(MOST_STEPS):
        # Every step starts at rest: only the remaining gap moves the links.
        plant.SetVelocities(context, np.zeros(plant.num_velocities()))
        built.diagram.ExecuteForcedEvents(built.whole)
        after = np.array(plant.GetPositions(context))
        moved, before = float(np.abs(after - before).max()), after
        if moved < SETTLED:
            break
    return built.coordinates.read(before)
