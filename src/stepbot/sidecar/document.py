"""The sidecar, version 1, as typed data; its JSON Schema is generated from these classes.

A document is valid here when each value has the right type and unit. What needs two places of the file (limits that are
swapped, a mimic of a joint that is not there) is checked in :mod:`stepbot.sidecar.check`; what needs the STEP, in
:mod:`stepbot.assemble`. The docstring below a field is what an editor shows for its key.
"""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field, StrictBool

from stepbot.robot.model import Base, JointKind

from .devices import ActuatorSection, FrameSection, SensorSection
from .ignored import IgnoredFinding, IgnoredFindings
from .motion import DynamicsSection, JointLimits, LimitsSection
from .origins import AutoOrigin, AxisOrigin, CenterOrigin, ComponentOrigin, ExplicitOrigin, MateOrigin, Offset, Origin
from .quantities import (
    Angle,
    AxisVector,
    CodePage,
    Color,
    Density,
    Inertia,
    JointPosition,
    JointValue,
    LengthVector,
    Mass,
    Number,
    Pitch,
    RelativeOrLength,
)
from .section import ComponentPath, MaterialName, Name, RobotName, Section
from .shapes import (
    BoxShape,
    CapsuleShape,
    Collision,
    CollisionShape,
    CylinderShape,
    MergedCollision,
    Shape,
    SphereShape,
)


class MassMode(StrEnum):
    """Whose volume, com and inertia become mass properties."""

    AUTO = "auto"
    MESH = "mesh"
    EXACT = "exact"


class StepDensity(StrEnum):
    """Whether densities in the STEP count."""

    USE = "use"
    IGNORE = "ignore"


class MaterialSection(Section):
    """A material by name."""

    density: Density | None = None
    """Density [kg/m^3]."""
    color: Color | None = None
    """Colour of what is made of it."""


class Defaults(Section):
    """What has no density or colour of its own."""

    material: MaterialName | None = None
    """One of `materials`."""
    density: Density | None = None
    """Density [kg/m^3]."""
    color: Color | None = None
    """Colour of what the STEP leaves without one."""


class MeshSection(Section):
    """How closely written meshes follow their solids."""

    tolerance: RelativeOrLength | None = None
    """Distance between mesh and solid: a share of each solid's diagonal, or a length [m]."""
    angle: Angle | None = None
    """Angle [rad] between neighbouring facets; it decides how round things look."""


class PartRule(Section):
    """What the components that match are made of, weigh and look like."""

    ignore: StrictBool = False
    """No link, no mass, no geometry; the component can still be named in `origin` and `frames`."""
    mass: Mass | None = None
    """Measured mass [kg] of each component that matches; of a subassembly, the total of all below it."""
    density: Density | None = None
    """Density [kg/m^3]."""
    material: MaterialName | None = None
    """One of `materials`."""
    color: Color | None = None
    """Colour, in place of the STEP's."""
    visual: StrictBool | None = None
    """Whether it is drawn."""
    collision: CollisionShape | None = None
    """How its collision geometry is made; beats the link's."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about these components that are not reported."""


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
    """Mass properties that overrule the computed ones; `mass` alone scales the computed inertia."""

    mass: Mass
    """Mass [kg] of the link."""
    com: LengthVector | None = None
    """Centre of mass [m] in the link's frame."""
    inertia: InertiaSection | None = None
    """Inertia [kg m^2] about the centre of mass, along the axes of the link."""


class LinkSection(Section):
    """A link and the components that it is made of."""

    parts: tuple[ComponentPath, ...] = ()
    """Component paths or globs; a subassembly brings all below it that no other link claims more closely."""
    rest: StrictBool = False
    """Whether the link takes every component that no link claims; one link may."""
    inertial: InertialSection | None = None
    """Mass properties that overrule the computed ones."""
    collision: Collision | None = None
    """How collision geometry is made: a word for each component, `{merge: ...}` for one shape, or a list of shapes."""
    visual: StrictBool | None = None
    """Whether the link is drawn."""
    mesh: MeshSection | None = None
    """How closely this link's meshes follow their solids."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about this link that are not reported."""


class RootSection(Section):
    """The root link, and the frame of the robot's base."""

    link: Name
    """The link that no joint moves."""
    frame: Origin | None = None
    """Frame of the root link; the assembly's frame when left out."""


class MimicSection(Section):
    """q = multiplier * q of `joint` + offset."""

    joint: Name
    """The joint that leads."""
    multiplier: Number = 1.0
    """How far this joint moves for each unit of the other, in SI."""
    offset: JointPosition = JointValue(0.0)
    """Position [rad or m] of this joint where the other is at zero."""


class JointSection(Section):
    """A joint of the tree."""

    type: JointKind
    """The freedom between the two links."""
    parent: Name
    """The link that it is mounted on."""
    child: Name
    """The link that it moves."""
    origin: Origin = "auto"
    """Where the joint is; `auto` finds the line that carries cylinders of both links."""
    axis: AxisVector = (0.0, 0.0, 1.0)
    """Axis in the joint's frame, `z` when left out; the normal of a planar joint."""
    axis2: AxisVector | None = None
    """Second axis of a universal joint, in the joint's frame."""
    limits: JointLimits = LimitsSection()
    """Bounds of position, speed and effort; `todo` while they are unknown: no bounds, and a warning."""
    dynamics: DynamicsSection = DynamicsSection()
    """Damping, friction, spring and armature."""
    mimic: MimicSection | None = None
    """Makes this joint follow another."""
    zero: JointPosition = JointValue(0.0)
    """Position [rad or m] in which the CAD drew the joint."""
    pitch: Pitch | None = None
    """Advance [m/rad] of a screw joint."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes about this joint that are not reported."""


class JointDefaults(Section):
    """Limits and dynamics of the joints whose name matches, where they say nothing themselves."""

    limits: LimitsSection = LimitsSection()
    """Bounds of position, speed and effort."""
    dynamics: DynamicsSection = DynamicsSection()
    """Damping, friction, spring and armature."""


class ClosureSection(Section):
    """A joint that closes a loop."""

    type: JointKind
    """The freedom between the two links: revolute, prismatic, ball or fixed."""
    link_a: Name
    """One link."""
    link_b: Name
    """The other link."""
    origin: Origin = "auto"
    """Where the two meet; `auto` finds the line that carries cylinders of both links."""
    axis: AxisVector = (0.0, 0.0, 1.0)
    """Axis in the closure's frame, `z` when left out."""


class Document(Section):
    """A robot's sidecar for stepbot: what its STEP file does not say."""

    version: Literal[1]
    """Version of this format."""
    robot: RobotName
    """Name of the robot, and of the files that are written."""
    step: Annotated[str, Field(min_length=1, max_length=4000)]
    """Path of the STEP file, relative to the sidecar."""
    base: Base = Base.FIXED
    """Whether the root link is fixed to the world or floats."""
    root: RootSection | None = None
    """The root link and its frame; found from the joints when left out."""
    materials: dict[MaterialName, MaterialSection] = Field(default_factory=dict)
    """Materials by name; parts without a density have that of the material which the STEP names."""
    defaults: Defaults = Defaults()
    """What counts where neither `parts` nor the STEP says anything."""
    step_encoding: CodePage | None = None
    """Code page of the names in the STEP, such as `cp1251` or `gbk`, where they are neither ASCII nor UTF-8."""
    step_density: StepDensity = StepDensity.USE
    """Whether densities in the STEP count. A CAD program's default density on every part is no measurement."""
    mass: MassMode = MassMode.AUTO
    """Whose volume, com and inertia are written: the mesh's where it agrees with the exact solid, or always one's."""
    mesh: MeshSection = MeshSection()
    """How closely written meshes follow their solids."""
    parts: dict[ComponentPath, PartRule] = Field(default_factory=dict)
    """What components are made of or weigh, by path or glob. The first rule that sets a field counts."""
    links: Annotated[dict[Name, LinkSection], Field(min_length=1)]
    """The links by name, and the components that each is made of."""
    joint_defaults: dict[Name, JointDefaults] = Field(default_factory=dict)
    """Limits and dynamics by a pattern of joint names, for joints that do not set them."""
    joints: dict[Name, JointSection] = Field(default_factory=dict)
    """The joints of the tree by name."""
    closures: dict[Name, ClosureSection] = Field(default_factory=dict)
    """The joints that close loops, by name."""
    frames: dict[Name, FrameSection] = Field(default_factory=dict)
    """Named frames: tool centre points, flanges."""
    actuators: dict[Name, ActuatorSection] = Field(default_factory=dict)
    """Drives by name."""
    sensors: dict[Name, SensorSection] = Field(default_factory=dict)
    """Sensors by name."""
    ignore_findings: IgnoredFindings = ()
    """Codes of warnings and notes that are not reported, wherever they are found."""


__all__ = [
    "AutoOrigin",
    "AxisOrigin",
    "BoxShape",
    "CapsuleShape",
    "CenterOrigin",
    "ClosureSection",
    "Collision",
    "CollisionShape",
    "ComponentOrigin",
    "ComponentPath",
    "CylinderShape",
    "Defaults",
    "Document",
    "DynamicsSection",
    "ExplicitOrigin",
    "IgnoredFinding",
    "InertiaSection",
    "InertialSection",
    "JointDefaults",
    "JointSection",
    "LimitsSection",
    "LinkSection",
    "MassMode",
    "MateOrigin",
    "MaterialSection",
    "MergedCollision",
    "MeshSection",
    "MimicSection",
    "Name",
    "Offset",
    "Origin",
    "PartRule",
    "RobotName",
    "RootSection",
    "Section",
    "Shape",
    "SphereShape",
    "StepDensity",
]
