"""A Drake plant of one file, with its state."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from stepbot.geometry.spatial import Pose
from stepbot.robot.dynamics import GRAVITY

from ..observation import EngineCannotRead, EngineRefused, Request
from ..resources import resolve
from .coordinates import Coordinates, pose

STEP = 1e-3
"""Step [s] of the plant."""
_LOOP = "form one or more loops"
_NO_HULL = "MakeConvexHull only applies to"
_URI = re.compile(r"""(?:package|model)://([^/"'<>]+)/([^"'<>]+)""")


@dataclass(frozen=True, eq=False)
class Built:
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
    """Name of the robot."""

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


def build(request: Request, gravity: tuple[float, float, float] = GRAVITY, *, shapes: bool = True) -> Built:
    """The plant of a file; the root is fixed unless the file or the request lets it float.

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
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)  # required by ball constraints
    try:
        parser = Parser(plant)
        for name, folder in _packages(path).items():
            parser.package_map().Add(name, folder)
        models = parser.AddModels(path)
        plant.mutable_gravity_field().set_gravity_vector(list(gravity))  # the parser takes that of the file
        if len(models) != 1:
            raise EngineRefused(f"{len(models)} models in the file, one expected")
        root, name = _root(plant, models[0]), plant.GetModelInstanceName(models[0])
        if request.format == "urdf" and not request.floating and not _is_held(plant, root):
            plant.WeldFrames(plant.world_frame(), root.body_frame())
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
    return Built(plant, scene, diagram, whole, context, root, request, _frame_names(plant), name)


def _packages(path: Path) -> dict[str, Path]:
    """Folders of the packages that a description refers to, as :func:`resolve` finds them."""
    found: dict[str, Path] = {}
    for name, rest in _URI.findall(path.read_text(encoding="utf-8", errors="replace")):
        file = None if name in found else resolve(f"package://{name}/{rest}", path)
        if file is not None:
            found[name] = file.absolute().parents[len(Path(rest).parts) - 1]
    return found


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
