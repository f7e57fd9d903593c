"""The result of inference: links, joints and closures as plain data, each with its evidence and a score.

Lengths are in metres and angles in radians, points and directions in the frame of the assembly. Paths are canonical
component paths, as `inspect` prints them.
"""

from collections.abc import Mapping
from enum import StrEnum

from msgspec import Struct, field

from stepbot.geometry.inertia import MassProperties
from stepbot.geometry.spatial import ZERO3, Vector3
from stepbot.robot.model import Base, Frame, JointDynamics, JointKind, Limit, Mimic
from stepbot.sidecar.contact import ContactMaterial
from stepbot.step.features.ground import Standing

SURE = 0.8
"""Score from which a joint needs no review."""
CHOSEN = 0.5
"""Score from which a joint is drafted; below it, it is written as a comment."""


class Confidence(Struct, frozen=True):
    """The strength of the evidence."""

    score: float
    """From 0 to 1; a rank calibrated on known assemblies, not a probability."""
    evidence: tuple[str, ...] = ()
    """One fact each: ``shaft of r 4 mm in a bore of r 4.05 mm, 12 mm engaged``."""

    @property
    def is_sure(self) -> bool:
        """Whether it needs no review."""
        return self.score >= SURE

    @property
    def is_chosen(self) -> bool:
        """Whether it is strong enough to be drafted."""
        return self.score >= CHOSEN


class OriginForm(StrEnum):
    """The keys under ``origin`` that inference writes."""

    MATE = "mate"
    AXIS_OF = "axis_of"
    XYZ = "xyz"


class OriginSnippet(Struct, frozen=True):
    """The value of ``origin``."""

    form: OriginForm
    paths: tuple[str, ...] = ()
    """Two components for ``mate``, one for ``axis_of``, none for ``xyz``."""
    radius: float | None = None
    """Selects the line by its radius [m]; None if not needed."""
    near: Vector3 | None = None
    """Selects the line by a point near it [m]; None if not needed."""
    xyz: Vector3 = ZERO3
    """Position [m], if ``form`` is ``xyz``."""
    rpy: Vector3 = ZERO3
    """Roll, pitch and yaw [rad], if ``form`` is ``xyz``."""


class FoundStop(Struct, frozen=True):
    """A position of a joint at which parts of its two links meet; it need not be the limit."""

    position: float
    """[rad] or [m]."""
    parts: tuple[str, str]
    """Paths of a component of the parent link and of one of the child link."""


class Models(Struct, frozen=True):
    """Motors of the catalogue that a part may be."""

    names: tuple[str, ...]
    """One, or the members of a family."""
    family: str
    """The name that several of them share; empty for one."""
    why: str
    """The evidence: its name, its box."""


class Alternative(Struct, frozen=True):
    """An alternative at the same place: a line that `init` writes as a comment."""

    type: JointKind
    a: str
    """Path of one component."""
    b: str
    """Path of the other."""
    confidence: Confidence
    point: Vector3 | None = None
    """On the axis [m], or the centre of a ball; None if there is none."""
    direction: Vector3 | None = None
    """Unit direction of the axis; None for a ball."""
    link: str = ""
    """Name of the link that holds both parts; empty if they are in two links."""
    moving: str = ""
    """Path of the part that would move, if ``link`` holds both."""
    held: str = ""
    """Why both were drafted as one."""
    freed: str = ""
    """Name of the link of the part that would move."""


class DraftLink(Struct, frozen=True):
    """A link and the components that move as one with it."""

    name: str
    parts: tuple[str, ...]
    """Paths that claim its components; the nearest claim wins, so it may be only part of a subassembly."""
    confidence: Confidence
    rest: bool = False
    """Whether it takes everything that no other link claims; ``parts`` may then be empty."""
    components: tuple[int, ...] = ()
    """Indices of all its components with a body."""
    inertial: MassProperties | None = None
    """In the link's frame, where they are given and not computed from densities."""
    drawn: str = ""
    """The CAD's name, if it differs from ``name``."""


class DraftConnection(Struct, frozen=True):
    """The fields that a joint and a closure share."""

    name: str
    type: JointKind
    origin: OriginSnippet
    axis: str | Vector3
    """In the frame of ``origin``: ``z``, ``-z``, or a unit vector; ``z`` if the type has no axis."""
    point: Vector3
    """On the axis [m]; the centre of a ball or a universal joint."""
    direction: Vector3 | None
    """Unit direction of the axis in the assembly; None for a ball or a fixed joint."""
    confidence: Confidence
    parts: tuple[str, str]
    """Paths of the two components with the strongest evidence."""
    alternatives: tuple[Alternative, ...] = ()
    review: str = ""
    """What to review; empty if the draft needs no review."""
    doubt: str = ""
    """Why the faces on its axis are weak evidence, as `check` reports it (SB407); empty if they are strong."""

    @property
    def written(self) -> JointKind:
        """The type that the sidecar states: below the score for drafting, its type is a guess in a comment."""
        return self.type if self.confidence.is_chosen else JointKind.FIXED

    @property
    def is_reviewed(self) -> bool:
        """Whether its line has a REVIEW mark."""
        return self.is_open or bool(self.doubt)

    @property
    def is_open(self) -> bool:
        """Whether its type or its links are uncertain."""
        return bool(self.review) or not self.confidence.is_sure


class DraftJoint(DraftConnection, frozen=True):
    """A joint of the tree."""

    parent: str = ""
    """Name of a link."""
    child: str = ""
    """Name of a link."""
    axis2: str | Vector3 | None = None
    """Second axis of a universal joint, as ``axis``."""
    direction2: Vector3 | None = None
    """The same in the assembly."""
    limits: Limit | None = None
    limits_from: str = ""
    """Where the limits are stated; empty where the joint itself is."""
    zero: float = 0.0
    """Position [rad] or [m] as drawn, if the file states it."""
    pitch: float | None = None
    """Pitch of a screw [m per turn]; None if the file does not give it."""
    dynamics: JointDynamics | None = None
    stops: tuple[FoundStop, ...] = ()
    """Found by collision, at most one in either direction."""
    stops_skipped: int = 0
    """Pairs of parts that were not compared for stops."""
    mimic: Mimic | None = None
    """By the leading joint's name in the draft."""
    motor: str = ""
    """Path of the motor that turns it; empty if no part named as a motor does."""
    models: Models | None = None
    """The motors of the catalogue that it may be; None if it is like none."""


class DraftClosure(DraftConnection, frozen=True):
    """A joint that closes a loop."""

    link_a: str = ""
    link_b: str = ""


class DraftContact(Struct, frozen=True):
    """The material of a link, or of one part of it, that touches what is around the robot."""

    link: str
    part: str
    """Path of the part; empty for the whole link."""
    material: ContactMaterial
    why: str
    rolls: bool = False
    """Whether the link is a wheel without rollers."""


class Option(Struct, frozen=True):
    """An answer to a question."""

    value: str
    """What the sidecar keeps: a type of joint, or the path of a part."""
    text: str
    """What the user sees."""
    is_drafted: bool


class Question(Struct, frozen=True):
    """A decision that several joints depend on."""

    name: str
    """By which the sidecar keeps the answer."""
    text: str
    options: tuple[Option, ...]
    decides: int
    """Number of joints that depend on it."""

    @property
    def drafted(self) -> Option:
        """The option that the draft has taken."""
        return next(option for option in self.options if option.is_drafted)


class Draft(Struct, frozen=True):
    """A drafted robot."""

    robot: str
    root: str
    """Name of the root link."""
    links: tuple[DraftLink, ...]
    """The root first."""
    joints: tuple[DraftJoint, ...] = ()
    """In tree order: a parent's joint before those of its children."""
    closures: tuple[DraftClosure, ...] = ()
    offered: tuple[Alternative, ...] = ()
    """Axes that were found but not drafted, the strongest first."""
    without_density: tuple[str, ...] = ()
    """Materials (or ``""`` for parts without one) whose parts have no density in the STEP."""
    equal_density: float = 0.0
    """Density [kg/m^3] shared by all of several parts, probably a CAD program's default; 0 if they differ."""
    standing: Standing | None = None
    """Evidence that an axis other than z is up; None if there is none."""
    notes: tuple[str, ...] = ()
    """Further notes for the user: parts in no link, open questions."""
    source: str = ""
    """Name of the description that joints and masses are taken from; empty where there is none."""
    root_frame: OriginSnippet | None = None
    """The frame of the root; None for that of the assembly."""
    base: Base = Base.FIXED
    frames: tuple[Frame, ...] = ()
    markers: tuple[str, ...] = ()
    """Paths of what is drawn, but no part of the robot: frames of joints."""
    contacts: tuple[DraftContact, ...] = ()
    """Wheels, casters, feet and fingers, in the order of the links."""
    answers: Mapping[str, str] = field(default_factory=dict)
    """Answers to questions that were used, by the names of the questions."""
    questions: tuple[Question, ...] = ()
    """What is left to ask, the question first that most joints depend on."""

    @property
    def fused(self) -> tuple[Alternative, ...]:
        """Joints within a link that were not drafted: its parts look movable, but were fused."""
        still = (JointKind.FIXED, JointKind.UNIVERSAL)
        freed: dict[str, Alternative] = {}
        for one in self.offered:
            if one.moving and one.type not in still:
                freed.setdefault(one.moving, one)
        return tuple(freed.values())
