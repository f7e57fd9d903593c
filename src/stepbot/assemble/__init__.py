"""Builds the format-independent robot from an assembly and a sidecar. For ``draft`` and above.

material_assignment  density, colour and collision of each component
claims               the link of each component
measured_bodies      mass properties of each body: exact or from its mesh
masses               mass of each component, the `inertial` of links against their geometry
double_counting      mass that overlapping solids count twice
motor_parts          the parts of motors against the catalogue
bound                links, masses and joints as far as the sidecar binds
frames               origin of each joint and frame, as drawn
axis_evidence        the faces that an origin was found by
far_axes             axes across the line of their origin, or far from the robot
joints               joints, closures, the joint table
devices              named frames, actuators, sensors, settings for simulations, mesh formats, metadata
links                mass properties, visuals, collisions
collisions           collision shapes of each link
fitted_collisions    shapes fitted to the solids of a link
simplified_visuals   visual meshes within triangle budgets
scored_collisions    scores of these shapes for the report
"""

from collections.abc import Callable, Sequence

from msgspec import Struct

from stepbot.diagnostics import Diagnostics
from stepbot.geometry.volume import VolumeProperties
from stepbot.report.robot import MeasuredBody, SimplifiedVisuals
from stepbot.robot.joint_table import JointRow
from stepbot.robot.model import Robot
from stepbot.runtime.cache import Cache
from stepbot.runtime.memory import DEFAULT_TIMEOUT
from stepbot.runtime.worker import Worker
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly

from .binder import UNREVISED, Binder, RevisedComponents
from .bound import Bound, bind
from .claims import Claims, claim
from .collisions import without_contacts_of
from .devices import (
    build_actuators,
    build_frames,
    build_mesh_formats,
    build_metadata,
    build_sensors,
    build_simulation,
    build_versions,
    tune_actuators,
)
from .double_counting import DoubleCounting
from .far_axes import report_axes_off_their_lines, report_far_axes, report_up_axis
from .fitted_collisions import FittedCollisions, ScoredCollisions, wait_for
from .frames import Frames
from .joints import build_closures, build_joints, joint_table, tree_order
from .links import Links, is_complete
from .masses import masses, report_given_inertials
from .material_assignment import assign_materials
from .measured_bodies import measured_bodies, report_choices, report_massless
from .motor_parts import report_unlike_motors
from .simplified_visuals import SimplifiedVisualMeshes


class BuiltRobot(Struct, frozen=True):
    """A robot, and the checks that are still running for it."""

    robot: Robot
    double_counting: DoubleCounting
    """Must report before anything is written."""
    bodies: tuple[MeasuredBody, ...]
    joint_table: tuple[JointRow, ...]
    """The pose of every joint and closure as drawn, and how it was found."""
    collisions: ScoredCollisions
    """The collision shapes of each link, scored on request, after ``double_counting`` has reported."""
    simplified: tuple[SimplifiedVisuals, ...] = ()
    """The visual meshes of each budget that they exceeded."""


def build_robot(
    assembly: Assembly,
    sidecar: Sidecar,
    measures: Callable[[], Sequence[VolumeProperties | None]],
    diagnostics: Diagnostics,
    cache: Cache | None = None,
    process: Worker | None = None,
    revised: RevisedComponents = UNREVISED,
    timeout: float = DEFAULT_TIMEOUT,
) -> BuiltRobot | None:
    """Build the robot that the sidecar describes; None if there are errors, all of which are in ``diagnostics``.

    Args:
        sidecar: A sidecar that passed its own check without errors.
        measures: Called when needed: trimesh's mass properties of the mesh of each of ``assembly.bodies``; None for a
            mesh that encloses no volume.
        diagnostics: Receives SB3xx, SB4xx and SB5xx.
        cache: Cache for collision shapes and overlaps; None to disable it.
        process: Worker that fits collision shapes and searches for overlaps after it has measured the meshes; None to
            do so in this process.
        revised: Components that a revision of the CAD has changed, which is reported elsewhere.
        timeout: Maximum time [s] to wait for collision geometry.
    """
    document = sidecar.document
    binder = Binder(assembly, sidecar, diagnostics, revised)
    root, order = tree_order(document)
    materials = assign_materials(binder)
    claims = claim(binder, materials)
    frames = Frames(binder, claims, root)
    joints = build_joints(binder, frames, order)
    closures = build_closures(binder, frames)
    report_axes_off_their_lines(binder, frames)
    report_far_axes(binder, frames)
    named = build_frames(binder, frames)
    sensors = build_sensors(binder, frames)

    bodies = measured_bodies(assembly, measures(), document.mass)
    fitted = FittedCollisions(binder, claims, materials, bodies, cache, process)
    weighed = masses(binder, materials, bodies)
    report_unlike_motors(binder, weighed)
    links = Links(binder, claims, materials, weighed, bodies, fitted)
    links.report_unknown_masses()
    _report_bodies(binder, claims, bodies)
    binder.report_fragile()
    X_WR = frames.link(root)
    if diagnostics.has_errors or X_WR is None or joints is None or closures is None or named is None or sensors is None:
        return None

    if not wait_for(fitted, binder, timeout):
        return None
    X_WL = {root: X_WR} | {name: pose for name in document.links if (pose := frames.link(name)) is not None}
    built = tuple(links.build(name, X_WL[name]) for name in (root, *(joint.child for joint in joints)))
    links.report_flat()
    report_given_inertials(binder, claims, built, joints, X_WL)
    robot = Robot(
        document.robot,
        built,
        joints,
        closures,
        named,
        build_actuators(sidecar),
        links.assets.all(),
        document.base,
        assembly.source,
        sensors,
        build_simulation(document),
        metadata=build_metadata(document),
        versions=build_versions(document),
        mesh_formats=build_mesh_formats(document),
    )
    robot = without_contacts_of(robot, sidecar, diagnostics)
    robot = tune_actuators(robot, sidecar, diagnostics)
    robot, simplified = SimplifiedVisualMeshes(binder, cache, process, timeout).of(robot)
    double_counting = DoubleCounting(binder, claims, weighed, cache=cache, process=process)
    rows = joint_table(frames, joints, closures)
    report_up_axis(binder, claims, root, rows)
    scored = ScoredCollisions(binder, claims, robot, X_WL, bodies, fitted, cache, process)
    return BuiltRobot(robot, double_counting, bodies, rows, scored, simplified)


def link_components(assembly: Assembly, sidecar: Sidecar, diagnostics: Diagnostics) -> dict[str, tuple[int, ...]]:
    """Indices of the components with bodies of each link; unresolved paths are reported in ``diagnostics``."""
    binder = Binder(assembly, sidecar, diagnostics)
    claims = claim(binder, assign_materials(binder))
    return {link: claims.parts_of(link) for link in sidecar.document.links}


def _report_bodies(binder: Binder, claims: Claims, bodies: Sequence[MeasuredBody]) -> None:
    """Report bodies with unexpected mass properties, except in links whose mass properties are given."""
    links = binder.document.links
    given = {name for name, link in links.items() if link.inertial is not None and is_complete(link.inertial)}
    weighed = [index for index, link in enumerate(claims.link_of) if link and link not in given]
    report_choices(binder, bodies, weighed)
    report_massless(binder, bodies, weighed)


__all__ = ["UNREVISED", "Bound", "Built", "Revised", "bind", "build_robot", "link_components"]
