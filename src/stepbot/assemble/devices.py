"""Devices mounted on the robot: named frames, actuators and sensors; settings for simulations, and metadata."""

from math import inf, pi

from stepbot.diagnostics import Diagnostics, Span
from stepbot.geometry.spatial import IDENTITY, Pose, tidy
from stepbot.robot.gains import tuned
from stepbot.robot.metadata import Metadata
from stepbot.robot.model import Actuator, FormatVersions, Frame, JointKind, Limit, MeshFormat, MeshFormats, Robot
from stepbot.robot.sensors import SEEING, Sensor, SensorKind, View
from stepbot.robot.tuning import Simulation, Tuning
from stepbot.sidecar.devices import ActuatorSection, SensorSection
from stepbot.sidecar.document import Document
from stepbot.sidecar.located import Sidecar
from stepbot.sidecar.motion import LimitsSection
from stepbot.sidecar.shapes import is_for_mjx

from .binder import Binder
from .frames import Frames, OriginRequest

CAMERA_FOV = pi / 3.0
LIDAR_FOV = 2.0 * pi
RESOLUTION = (640, 480)
SAMPLES = 360
"""Defaults for the optional settings of a camera or a lidar."""


def build_frames(binder: Binder, frames: Frames) -> tuple[Frame, ...] | None:
    """The named frames, in the sidecar's order; None if one cannot be resolved."""
    built = [_frame(binder.document, frames, name) for name in binder.document.frames]
    named = tuple(frame for frame in built if frame is not None)
    return named if len(named) == len(built) else None


def build_actuators(sidecar: Sidecar) -> tuple[Actuator, ...]:
    """The actuators, in the sidecar's order."""
    return tuple(
        Actuator(
            name,
            drive.joint,
            drive.kind,
            drive.kp.value,
            drive.kv.value,
            drive.gear.value,
            limit=_limit(drive.limits),
            tuning=_tuning(drive),
            motor=sidecar.motors.get(name),
        )
        for name, drive in sidecar.document.actuators.items()
    )


def _tuning(drive: ActuatorSection) -> Tuning | None:
    """How to compute the gains; None if they are given."""
    if drive.gains is None or isinstance(drive.gains, str):
        return None if drive.gains is None else Tuning(at_least=True)
    return Tuning(drive.gains.bandwidth, drive.gains.damping_ratio)


def tune_actuators(robot: Robot, sidecar: Sidecar, diagnostics: Diagnostics) -> Robot:
    """The robot with its computed gains.

    Reports SB464, actuators that are too weak for the weight of their joint, and SB466, those that cannot move theirs.
    """

    def too_weak(actuator: Actuator, effort: float, weight: float) -> None:
        unit = "N" if robot.joint_by_name[actuator.joint].kind is JointKind.PRISMATIC else "N m"
        message = f"actuator '{actuator.name}': its effort limit of {effort:g} {unit} does not hold the joint"
        help = (
            f"correct the effort limit or the masses: holding takes more than {weight:.3g} {unit}",
            "or set `kp` and `kv` if a spring or a counterweight carries the joint",
        )
        message += f", whose weight is {weight:.3g} {unit} in the drawn pose"
        diagnostics.add("SB464", message, place_of(actuator, robot, sidecar), help=help)

    result = tuned(robot, too_weak)
    for actuator in result.actuators:
        if actuator.tuning is not None and actuator.kp == actuator.kv == 0.0:
            message = f"actuator '{actuator.name}': no gains can be computed: its joint cannot move in the drawn pose"
            help = ("let the loop move, or set `kp` and `kv`",)
            diagnostics.add("SB466", message, place_of(actuator, robot, sidecar), help=help)
    return result


def place_of(actuator: Actuator, robot: Robot, sidecar: Sidecar) -> Span:
    """Where a sidecar states an actuator, or names the module that has it."""
    child = robot.joint_by_name[actuator.joint].child
    modules = [] if actuator.name in sidecar.document.actuators else robot.modules
    module_name = next((module.name for module in modules if child in module.links), None)
    return sidecar.span("actuators", actuator.name) if module_name is None else sidecar.key_span("modules", module_name)


def build_simulation(document: Document) -> Simulation:
    """The settings for simulations."""
    given = document.simulation
    return Simulation(given.timestep, given.integrator, given.closure_stiffness)


def build_metadata(document: Document) -> Metadata:
    """Maintainer and licence; the sidecar has checked that the address is in angle brackets."""
    given = document.metadata
    metadata = Metadata(version=given.version or "", description=given.description or "")
    return metadata.stating(given.maintainer or "", given.license or "")


def build_mesh_formats(document: Document) -> MeshFormats:
    """The formats of mesh files."""
    given = document.mesh
    both = given.format or MeshFormat.OBJ
    return MeshFormats(given.visual or both, given.collision or both, bool(given.visual or given.format))


def build_versions(document: Document) -> FormatVersions:
    """The versions of formats to write; MJX reads what MuJoCo 3.3 does."""
    mjcf = 3.3 if is_for_mjx(document.defaults.collision) else document.mjcf.version
    return FormatVersions(urdf=document.urdf.version, mjcf=mjcf)


def build_sensors(binder: Binder, frames: Frames) -> tuple[Sensor, ...] | None:
    """The sensors, in the sidecar's order; None if a frame cannot be resolved."""
    built = [_sensor(binder.document, frames, name) for name in binder.document.sensors]
    sensors = tuple(sensor for sensor in built if sensor is not None)
    return sensors if len(sensors) == len(built) else None


def _frame(document: Document, frames: Frames, name: str) -> Frame | None:
    section = document.frames[name]
    X_WF, X_WL = frames.resolve(section.origin, OriginRequest(("frames", name, "origin"))), frames.link(section.link)
    if X_WF is None or X_WL is None:
        return None
    return Frame(name, section.link, tidy(X_WL.inverse() @ X_WF), frames.evidence("frames", name, "origin").text)


def _limit(section: LimitsSection) -> Limit:
    def value(field: str, none: float) -> float:
        bound = getattr(section, field)
        return none if bound is None else float(bound.value)

    return Limit(value("lower", -inf), value("upper", inf), value("velocity", inf), value("effort", inf))


def _sensor(document: Document, frames: Frames, name: str) -> Sensor | None:
    section = document.sensors[name]
    joint = section.joint or ""
    if section.type is SensorKind.FORCE_TORQUE and section.link is not None:
        # Between a link and its parent: the joint above the link.
        joint = next(key for key, above in document.joints.items() if above.child == section.link)
    link = document.joints[joint].child if joint else section.link
    assert link is not None  # the sidecar's own check requires a sensor to name a link or a joint
    X_LS: Pose | None = IDENTITY
    if section.origin is not None:
        X_WS, X_WL = frames.resolve(section.origin, OriginRequest(("sensors", name, "origin"))), frames.link(link)
        X_LS = None if X_WS is None or X_WL is None else tidy(X_WL.inverse() @ X_WS)
    if X_LS is None:
        return None
    view = sensor_view(section) if section.type in SEEING else View()
    source = frames.evidence("sensors", name, "origin").text
    return Sensor(name, section.type, link, X_LS, joint, section.rate, view, source=source)


def sensor_view(section: SensorSection) -> View:
    """The field of view of a camera or a lidar, defaults applied."""
    nearest, farthest = section.range or (0.0, inf)
    if section.type is SensorKind.CAMERA:
        width, height = section.resolution or RESOLUTION
        return View(section.fov or CAMERA_FOV, width, height, nearest, farthest)
    samples = SAMPLES if section.samples is None else section.samples
    return View(LIDAR_FOV if section.fov is None else section.fov, samples, 1, nearest, farthest)
