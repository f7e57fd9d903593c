"""Features that a robot may have and a format may lack, and how a format declares its support."""

from collections.abc import Mapping
from enum import StrEnum
from math import inf

from msgspec import Struct


class Feature(StrEnum):
    """A feature that a robot may have, as worded in ``docs/mapping.md``."""

    FIXED_BASE = "base fixed to the world"
    FLOATING_BASE = "floating base"
    INERTIA = "mass, centre of mass, full inertia"
    MASSLESS = "link without mass or inertia"
    MASSLESS_BODY = "moving body without mass"
    MESH = "mesh"
    STL_VISUAL = "visual mesh as STL"
    DAE_VISUAL = "visual mesh as COLLADA"
    GLB_VISUAL = "visual mesh as glTF"
    STL_COLLISION = "collision mesh as STL"
    OTHER_COLLISION = "collision mesh as COLLADA or glTF"
    SHAPE = "box, cylinder, sphere"
    CAPSULE = "capsule"
    FLAT_COLLISION = "flat collision mesh"
    CONCAVE_COLLISION = "non-convex collision mesh"
    COLOR = "colour and opacity"
    NEIGHBOURS = "no contact between adjacent links"
    EXCLUDED_CONTACT = "no contact between excluded pairs of links"
    SURFACE = "friction of a shape"
    SPIN = "torsional or rolling friction"
    BOUNCE = "restitution"
    DEAD_BOUNCE = "restitution below 0.14"
    SOFTNESS = "softness of a contact"
    MIXED_SURFACE = "shapes of one link with different contact properties"
    FIXED = "fixed joint"
    REVOLUTE = "revolute joint"
    CONTINUOUS = "continuous joint"
    PRISMATIC = "prismatic joint"
    BALL = "ball joint"
    UNIVERSAL = "universal joint"
    CYLINDRICAL = "cylindrical joint"
    SCREW = "screw joint"
    PLANAR = "planar joint"
    FLOATING = "floating joint"
    BALL_LIMIT = "effort or velocity limit of a ball joint"
    BALL_FORCE = "damping, friction, spring of a ball joint"
    FAR_LIMIT = "revolute joint whose limits exceed ±180° or exclude 0"
    PASSIVE_LIMIT = "effort or velocity limit of a joint without actuator"
    OPEN_POSITION = "joint without lower or upper limit"
    OPEN_EFFORT = "joint without effort or velocity limit"
    EFFORT = "effort limit"
    VELOCITY = "velocity limit"
    ACCELERATION = "limit of acceleration, deceleration or jerk"
    FRICTION = "damping, friction"
    SPRING = "spring"
    ARMATURE = "armature"
    STIFF_DAMPING = "damping beyond 2 x inertia / time step"
    MIMIC = "mimic"
    MIMIC_CHAIN = "mimic of a mimic"
    MIXED_MIMIC = "mimic between an angle and a distance"
    CLOSURE = "revolute, ball or fixed closure"
    SLIDING_CLOSURE = "prismatic closure"
    STUCK_CLOSURE = "prismatic closure of a loop without an unlimited passive pin"
    FOLLOWER = "joint that a loop makes follow another one linearly"
    LOOP_ZERO = "loop closed at a pose other than q = 0"
    INITIAL_POSE = "drawn pose other than q = 0"
    FRAME = "frame"
    ACTUATOR = "actuator"
    SECOND_ACTUATOR = "several actuators on one joint"
    GEAR = "actuator gear"
    ACTUATOR_INPUT = "input bounds of an actuator in addition to its joint's limits"
    UNLIMITED_ACTUATOR = "position or velocity actuator without effort limit"
    JOINT_SENSOR = "joint sensor"
    IMU = "IMU"
    FORCE_TORQUE = "force-torque sensor"
    OFF_JOINT = "force-torque sensor not at its joint's origin"
    CAMERA = "camera"
    OPTICAL = "optical frame of a camera, as REP 103 defines it"
    LIDAR = "lidar"
    CONTACT = "contact sensor"
    SENSOR_PLACE = "IMU, camera or lidar not at its link's frame"
    SENSOR_RATE = "rate of a sensor"
    ENCODER_RATE = "rate of a joint sensor"
    CAMERA_EXTRAS = "rate or range of a camera"
    LIDAR_NEAREST = "minimum range of a lidar"
    OPEN_VIEW = "camera or lidar without minimum or maximum range"
    TIMESTEP = "time step"
    SOLVER = "integrator, closure stiffness"
    JOINT_NAME = "joint or closure with the name of a link"
    FRAME_NAME = "frame with the name of a link or joint"
    RESERVED_NAME = "reserved name"

    @property
    def word(self) -> str:
        """The feature in codes: ``armature`` in ``SB760:armature``."""
        return self.name.lower().replace("_", "-")


class Level(StrEnum):
    """How well a format supports a feature."""

    EXACT = "exact"
    LOWERED = "lowered"
    """Expressed by other means, with a note."""
    REPORTED = "reported"
    """Left out, and reported."""
    REFUSED = "refused"
    """An error: nothing is written."""


class Support(Struct, frozen=True):
    """A format's support of a feature."""

    level: Level
    how: str
    """For the table and for messages: a clause, no full stop."""
    code: str = ""
    """Code of the diagnostic if a robot has the feature; empty for exact support."""
    exact_from: float = inf
    """The version of the format from which support is exact."""
    exactly: str = ""
    """How that version has it."""


def exact(how: str) -> Support:
    """The format expresses all of it."""
    return Support(Level.EXACT, how)


def lowered(how: str, exact_from: float = inf, exactly: str = "") -> Support:
    """The format expresses it by other means, in versions before ``exact_from``: a note."""
    return Support(Level.LOWERED, how, "SB763", exact_from, exactly)


def altered(how: str) -> Support:
    """The format expresses something close to it: a warning."""
    return Support(Level.LOWERED, how, "SB761")


def reported(how: str, exact_from: float = inf, exactly: str = "") -> Support:
    """The format cannot express it, in versions before ``exact_from``: a warning."""
    return Support(Level.REPORTED, how, "SB760", exact_from, exactly)


def deferred(how: str) -> Support:
    """The program that loads the file decides: a note."""
    return Support(Level.REPORTED, how, "SB762")


def refused(how: str) -> Support:
    """A robot that has it cannot be written: an error."""
    return Support(Level.REFUSED, how, "SB764")


USUAL: Mapping[Feature, Support] = {
    Feature.MASSLESS: altered("links without mass get 1e-6 kg, those without inertia 1e-9 kg m^2"),
    Feature.OTHER_COLLISION: lowered("simulators agree on OBJ and STL; collision meshes are OBJ"),
    Feature.SPIN: reported("torsional and rolling friction are omitted"),
    Feature.SOFTNESS: reported("softness of contacts is omitted"),
    Feature.MIXED_SURFACE: altered("a link has the contact properties of its shape with most friction"),
    Feature.UNIVERSAL: altered("a universal joint is written as two continuous joints"),
    Feature.CYLINDRICAL: altered("a cylindrical joint is written as a prismatic and a continuous joint"),
    Feature.SCREW: altered("a screw joint is written as a revolute joint and a prismatic one that mimics it"),
    Feature.PLANAR: altered("a planar joint is written as two prismatic joints and a continuous one"),
    Feature.FLOATING: altered("a floating joint is written as three prismatic joints and a ball joint"),
    Feature.BALL_LIMIT: reported("effort and velocity limits of ball joints are omitted"),
    Feature.BALL_FORCE: reported("damping, friction and springs of ball joints are omitted"),
    Feature.ACCELERATION: reported("limits of acceleration, deceleration and jerk are omitted"),
    Feature.ARMATURE: reported("armatures are omitted"),
    Feature.MIMIC_CHAIN: lowered("every mimic refers to the first joint of its chain"),
    Feature.MIXED_MIMIC: reported("mimics between angles and distances are omitted"),
    Feature.GEAR: lowered("gears are folded into gains and inputs, which apply at the joint"),
    Feature.ACTUATOR_INPUT: reported("input bounds are the limits of the joints"),
    Feature.OFF_JOINT: reported("torques are about the joint's origin"),
    Feature.OPEN_VIEW: lowered("missing sensor ranges are written as 0.1 m and 100 m"),
    Feature.FRAME_NAME: altered("links, joints and frames share one namespace"),
}
"""What becomes of a feature in most of the formats that lack it."""
