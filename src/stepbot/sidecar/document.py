"""The sidecar, version 1, as typed data; its JSON Schema is generated from these classes.

A document is valid here if each value has the right type and unit. Contradictions between values (swapped limits, a
mimic of a missing joint) are checked in :mod:`stepbot.sidecar.check`; everything that requires the STEP, in
:mod:`stepbot.assemble`. Editors show the docstring below a field as the description of its key.
"""

from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, field_validator

from stepbot.geometry.inertia import Direction
from stepbot.robot.model import Base, JointKind, MeshFormat

from .contact import Contact
from .devices import ActuatorSection, Bytes, FrameSection, SensorSection
from .expected import ExpectSection
from .ignored import IgnoredFindings
from .modules import ModuleSection
from .motion import DynamicsSection, JointLimits, LimitsSection, MimicSection
from .motor_sections import Motors
from .origins import Origin
from .quantities import (
    Angle,
    AxisVector,
    CodePage,
    Color,
    Density,
    DensityOrTodo,
    Inertia,
    JointPosition,
    JointValue,
    LengthVector,
    Mass,
    Pitch,
    RelativeOrLength,
)
from .section import ComponentPath, MaterialName, Name, Reference, RobotName, Section
from .settings import Line, LinkPair, MetadataSection, MjcfSection, SelfCollisionSection, SimulationSection, UrdfSection
from .shapes import Collision, Derived


class MassMode(StrEnum):
    """Source of volume, centre of mass and inertia."""

    AUTO = "auto"
    MESH = "mesh"
    EXACT = "exact"


class StepDensity(StrEnum):
    """Whether to use densities in the STEP."""

    USE = "use"
    IGNORE = "ignore"


class MaterialSection(Section):
    """A material by name."""

    density: Density | None = None
    """Density [kg/m^3]."""
    color: Color | None = None
    """Colour of parts made of it."""


class Defaults(Section):
    """Defaults for components without a density or colour."""

    material: MaterialName | None = None
    """One of `materials`."""
    density: DensityOrTodo | None = None
    """Density [kg/m^3]; `todo` if it is not known yet: 1000 kg/m^3, with a warning (SB522)."""
    color: Color | None = None
    """Colour of components without a colour in the STEP."""
    collision: Derived | None = None
    """Collision geometry of links without their own: a type, or `{shape, max_hulls, max_vertices}`; by default hull."""
    contact: Contact | None = None
    """Contact properties of links without their own: materials, or `{friction, restitution, ...}`."""


class MeshSection(Section):
    """Tolerance and triangle budget of meshes."""

    tolerance: RelativeOrLength | None = None
    """Maximum distance between mesh and solid: a fraction of each solid's diagonal, or a length [m]."""
    angle: Angle | None = None
    """Maximum angle [rad] between adjacent facets; it determines how smooth curved surfaces look."""
    max_triangles: Annotated[int, Field(ge=4, le=100_000_000)] | None = None
    """Maximum number of triangles of all visual meshes, each as often as it is drawn; they are simplified to fit."""


class RobotMeshSection(MeshSection):
    """Tolerance, budgets and format of meshes."""

    max_bytes: Bytes | None = None
    """Maximum size of the files of visual meshes, `10M`; they are simplified to fit."""
    format: MeshFormat | None = None
    """Format of mesh files: `obj` (the default), `stl`, `dae` (COLLADA) or `glb` (binary glTF)."""
    visual: MeshFormat | None = None
    """Format of visual meshes, if it is another one than `format`."""
    collision: MeshFormat | None = None
    """Format of collision meshes, if it is another one than `format`: `obj` or `stl`; others become `obj`."""


class PartRule(Section):
    """Material, mass, colour and geometry of the matching components."""

    ignore: StrictBool = False
    """Exclude the components: no link, no mass, no geometry. They can still be used in `origin` and `frames`."""
    mass: Mass | None = None
    """Measured mass [kg] of each matching component; for a subassembly, the total of everything below it."""
    density: Density | None = None
    """Density [kg/m^3]."""
    material: MaterialName | None = None
    """One of `materials`."""
    color: Color | None = None
    """Colour, overrides the STEP's."""
    visual: StrictBool | None = None
    """Whether the components have visual geometry."""
    collision: Derived | None = None
    """Type of collision geometry, or `{shape, max_hulls, max_vertices}`; overrides the link's."""
    contact: Contact | None = None
    """Contact properties, which give each component a shape of its own; override the link's."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about these components to suppress."""


class InertiaSection(Section):
    """Inertia about the centre of mass, along the axes of the link."""

    ixx: Inertia
    """Moment of inertia [kg m^2] about x."""
    iyy: Inertia
    """Moment of inertia [kg m^2] about y."""
    izz: Inertia
    """Moment of inertia [kg m^2] about z."""
    ixy: Inertia = 0.0
    """Product of inertia [kg m^2], the entry of the tensor, as in URDF."""
    ixz: Inertia = 0.0
    """Product of inertia [kg m^2], the entry of the tensor, as in URDF."""
    iyz: Inertia = 0.0
    """Product of inertia [kg m^2], the entry of the tensor, as in URDF."""


class InertialSection(Section):
    """Mass properties that override the computed ones; `mass` alone scales the computed inertia."""

    mass: Mass
    """Mass [kg] of the link."""
    com: LengthVector | None = None
    """Centre of mass [m] in the link's frame."""
    inertia: InertiaSection | None = None
    """Inertia [kg m^2] about the centre of mass, along the axes of the link."""


class LinkSection(Section):
    """A link and its components."""

    parts: tuple[ComponentPath, ...] = ()
    """Component paths or globs; a subassembly includes everything below it that no other link claims more closely."""
    rest: StrictBool = False
    """Whether the link takes all components that no link claims; at most one link may."""
    inertial: InertialSection | None = None
    """Mass properties that override the computed ones."""
    collision: Collision | None = None
    """Collision geometry: a type, `{shape, max_hulls, max_vertices}`, `{merge: ...}` for one shape, or a list."""
    contact: Contact | None = None
    """Contact properties: materials such as `rubber-on-floor`, or `{friction, restitution, ...}`."""
    visual: StrictBool | None = None
    """Whether the link has visual geometry."""
    mesh: MeshSection | None = None
    """Tolerance and triangle budget of this link's meshes."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about this link to suppress."""


class RootSection(Section):
    """The root link, and the frame of the robot's base."""

    link: Name | None = None
    """The root link: the link without a parent joint; by default determined by the joints."""
    frame: Origin | None = None
    """Frame of the root link; by default the assembly's frame. With `up` or `forward`, only its position counts."""
    up: Direction | None = None
    """The axis of the assembly that points up; the robot's z. By default z."""
    forward: Direction | None = None
    """The axis of the assembly that points forward; the robot's x. By default x, or y if `up` is x or -x."""

    @property
    def axes(self) -> tuple[Direction, Direction] | None:
        """The axes of the assembly that point up and forward; None if neither is given."""
        if self.up is None and self.forward is None:
            return None
        up: Direction = self.up or "z"
        return up, self.forward or ("y" if up.endswith("x") else "x")


class JointSection(Section):
    """A joint of the tree."""

    type: JointKind
    """Type of the joint."""
    parent: Reference
    """The parent link; with `modules`, also a frame here, or a link or frame of a module."""
    child: Reference
    """The child link; with `modules`, also a module, or a link or frame of one."""
    origin: Origin = "auto"
    """Pose of the joint; `auto` finds the line with cylindrical faces of both links."""
    axis: AxisVector = (0.0, 0.0, 1.0)
    """Axis in the joint's frame, `z` by default; for a planar joint, its normal."""
    axis2: AxisVector | None = None
    """Second axis of a universal joint, in the joint's frame."""
    limits: JointLimits = LimitsSection()
    """Limits of position, velocity and effort; `todo` if they are not known yet: unlimited, with a warning."""
    dynamics: DynamicsSection = DynamicsSection()
    """Damping, friction, spring and armature."""
    mimic: MimicSection | None = None
    """Makes this joint follow another one."""
    zero: JointPosition = JointValue(0.0)
    """Position [rad or m] of the joint as drawn in the CAD."""
    pitch: Pitch | None = None
    """Advance [m/rad] of a screw joint."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about this joint to suppress."""


class JointDefaults(Section):
    """Default limits and dynamics of the joints whose names match the pattern."""

    limits: LimitsSection = LimitsSection()
    """Limits of position, velocity and effort."""
    dynamics: DynamicsSection = DynamicsSection()
    """Damping, friction, spring and armature."""


class ClosureSection(Section):
    """A joint that closes a loop."""

    type: JointKind
    """Type of the closure: revolute, prismatic, ball or fixed."""
    link_a: Reference
    """One link; with `modules`, also a frame here, or a link or frame of a module."""
    link_b: Reference
    """The other link, likewise."""
    origin: Origin = "auto"
    """Pose of the closure; `auto` finds the line with cylindrical faces of both links."""
    axis: AxisVector = (0.0, 0.0, 1.0)
    """Axis in the closure's frame, `z` by default."""


class Document(Section):
    """A stepbot sidecar: the robot data that a STEP file lacks."""

    version: Literal[1]
    """Version of this format."""
    robot: RobotName
    """Name of the robot, and of the written files."""
    step: Annotated[str, Field(min_length=1, max_length=4000)]
    """Path of the STEP file, relative to the sidecar."""
    base: Base = Base.FIXED
    """Whether the root link is fixed to the world or floats."""
    root: RootSection | None = None
    """The root link and its frame; by default determined by the joints."""
    materials: dict[MaterialName, MaterialSection] = Field(default_factory=dict)
    """Materials by name. A part without a density uses the material named in the STEP, if it is listed here."""
    defaults: Defaults = Defaults()
    """Defaults for values that neither `parts` nor the STEP sets."""
    step_encoding: CodePage | None = None
    """Code page of the names in the STEP, such as `cp1251` or `gbk`, if they are neither ASCII nor UTF-8."""
    step_density: StepDensity = StepDensity.USE
    """Whether to use densities in the STEP. A CAD program's default density on every part is not a measurement."""
    mass: MassMode = MassMode.AUTO
    """Source of volume, com and inertia: the mesh if it agrees with the exact solid (auto), or always one."""
    mesh: RobotMeshSection = RobotMeshSection()
    """Tolerance, triangle budget and format of the written meshes."""
    urdf: UrdfSection = UrdfSection()
    """Settings of the written URDF."""
    mjcf: MjcfSection = MjcfSection()
    """Settings of the written MJCF."""
    parts: dict[ComponentPath, PartRule] = Field(default_factory=dict)
    """Material, mass and geometry of components, by path or glob. For each field, the first matching rule applies."""
    links: Annotated[dict[Name, LinkSection], Field(min_length=1)]
    """The links by name, with their components."""
    joint_defaults: dict[Name, JointDefaults] = Field(default_factory=dict)
    """Default limits and dynamics by a pattern of joint names."""
    joints: dict[Name, JointSection] = Field(default_factory=dict)
    """The joints of the tree by name."""
    closures: dict[Name, ClosureSection] = Field(default_factory=dict)
    """The loop-closing joints by name."""
    frames: dict[Name, FrameSection] = Field(default_factory=dict)
    """Named frames, such as tool centre points and flanges."""
    actuators: dict[Name, ActuatorSection] = Field(default_factory=dict)
    """Actuators by name."""
    motors: Motors = Field(default_factory=dict)
    """Motors that the catalogue lacks, by name, or the path of a file of them, relative to the sidecar."""
    sensors: dict[Name, SensorSection] = Field(default_factory=dict)
    """Sensors by name."""
    simulation: SimulationSection = SimulationSection()
    """Time step, integrator and stiffness of closures, for formats and engines that have them."""
    self_collision: SelfCollisionSection | None = None
    """Search for the links that can overlap: MJCF excludes pairs that always do, and an SRDF lists all pairs."""
    excluded_contacts: tuple[LinkPair, ...] = ()
    """Pairs of links, `[link_a, link_b]`, without contacts between them, in addition to adjacent links."""
    metadata: MetadataSection = MetadataSection()
    """Maintainer, licence, version and description, for packages of ROS 2, Gazebo and Webots."""
    answers: dict[Line, Line] = Field(default_factory=dict)
    """Answers to questions of `stepbot init`, which uses them when it drafts this sidecar again."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes to suppress everywhere."""
    expect: ExpectSection | None = None
    """What the robot is expected to be: mass, centre of mass, reach, symmetry, each with a tolerance."""
    modules: dict[Name, ModuleSection] = Field(default_factory=dict)
    """Robots that this one is composed of, by instance name."""
    variants: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    """Changes of this sidecar by name, for `--variant`: any keys of it, `like` (a variant to start from) and `without`
    (elements to leave out)."""

    @field_validator("actuators", mode="after")
    @classmethod
    def _on_joints_of_their_names(cls, actuators: dict[str, ActuatorSection]) -> dict[str, ActuatorSection]:
        return {name: one if one.joint else one.model_copy(update={"joint": name}) for name, one in actuators.items()}


class Composition(Document):
    """A sidecar with modules, which may have no STEP and no links of its own."""

    step: Annotated[str, Field(max_length=4000)] = ""
    """Path of the STEP file of the own links, relative to the sidecar; empty for none."""
    links: dict[Name, LinkSection] = Field(default_factory=dict)
    """The own links by name, with their components."""


def document_class(data: dict[str, Any]) -> type[Document]:
    """The class of a document, by its keys."""
    return Composition if data.get("modules") else Document
