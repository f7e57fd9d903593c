r"""The conversion pipeline: sidecar and STEP file to verified robot files.

    sidecar -> Document \
                         assemble -> Robot -> lower -> writers -> files -> engines -> observations -> verification
    STEP    -> Assembly /

This module prints nothing. The result contains the diagnostics, which the command line shows. It imports what every
conversion of a sidecar needs; the rest is imported where it is used.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from pathlib import Path

from msgspec import Struct, field
from msgspec.structs import replace

from stepbot.assemble import BuiltRobot, link_components
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.formats import format_named
from stepbot.geometry.volume import VolumeProperties
from stepbot.runtime.fork_server import ForkServer
from stepbot.runtime.worker import Worker
from stepbot.sidecar.document import Document
from stepbot.sidecar.own_part import own_part
from stepbot.sidecar.settings import ExcludedPairs, SelfCollisionSection
from stepbot.sidecar.shapes import is_for_mjx
from stepbot.step.assembly import Assembly, MeshTolerance

from .building import build
from .conversion import REPORT, Checked, Conversion, Options, is_description, write
from .loading import Loading, input_hashes, input_names
from .sidecars import SIDECAR_SUFFIXES, load, named_step, what_to_read
from .verdict import robot_words
from .writing import all_files, judged_by_files, proven, rendered, report_unused, started_provers

__all__ = ["REPORT", "Conversion", "Inspection", "Options", "check", "convert", "inspect", "produce", "step_of"]


class Inspection(Struct, frozen=True):
    """The content of a STEP file."""

    diagnostics: Diagnostics
    assembly: Assembly | None
    """After errors what could be read, with missing parts marked; None if that is nothing."""
    measures: tuple[VolumeProperties | None, ...] = ()
    """trimesh's mass properties of each body of the assembly; None for a mesh that encloses no volume."""
    links: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """For each link of the sidecar, the indices of its components; empty if a STEP was inspected without a sidecar."""
    tolerance: MeshTolerance = field(default_factory=MeshTolerance)
    """That of the meshes."""


def convert(sidecar: Path, options: Options, progress: Callable[[str], None] = lambda stage: None) -> Conversion:
    """Convert one sidecar and its STEP file, verify the files, and write them."""
    conversion = produce(sidecar, options, progress)
    progress("save")
    return write(conversion, options.output, sidecar)


def produce(
    sidecar: Path,
    options: Options,
    progress: Callable[[str], None] = lambda stage: None,
    kernel: Worker | None = None,
    server: ForkServer | None = None,
) -> Conversion:
    """Convert one sidecar and its STEP file, or a URDF, SDFormat or MJCF, and verify the files; writes nothing.

    Args:
        sidecar: The sidecar, or the description.
        kernel: A process started in advance; None to start one if needed.
        server: A process started in advance to start the engines; None to start one if needed.
    """
    diagnostics = Diagnostics()
    try:
        if is_description(sidecar):
            from .translating import produce_translation

            return produce_translation(sidecar, options, diagnostics, progress, server)
        return _produce(sidecar, options, diagnostics, progress, kernel, server)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return Conversion(diagnostics)


def _produce(
    path: Path,
    options: Options,
    diagnostics: Diagnostics,
    progress: Callable[[str], None],
    kernel: Worker | None,
    server: ForkServer | None,
) -> Conversion:
    progress("read")
    formats = [format_named(name) for name in dict.fromkeys(options.formats)]
    if options.verify:
        from stepbot.engines.workers import check_required

        check_required(options.require, diagnostics)
    sidecar = load(path, options, diagnostics)
    with ExitStack() as running:
        built: BuiltRobot | None = None
        loading: Loading | None = None
        if not sidecar.document.modules:
            step = options.step or named_step(sidecar, diagnostics)
            loading = Loading(step, what_to_read(sidecar, options), options, diagnostics, kernel)
            running.enter_context(closing(loading))
        provers = started_provers(formats, options, server)
        if provers is not None:
            running.enter_context(provers)
        if loading is None:
            from .composing import compose

            composed = compose(sidecar, options, diagnostics)
            robot, inputs = composed.robot, input_hashes(input_names(composed.files[0], composed.files[1:]))
        else:
            assembly = loading.assembly(diagnostics)
            progress("build")
            built = build(sidecar, assembly, loading, options, diagnostics)
            diagnostics.raise_if_errors()
            assert built is not None  # a missing robot always has an error
            robot, inputs = built.robot, loading.inputs()
        given = sidecar.document.self_collision
        wanted = given or _search_unasked(sidecar.document, options)
        if wanted is not None:
            from .self_collisions import with_self_collision

            progress("self-collision")
            robot = with_self_collision(robot, wanted, options, diagnostics, keep_some=given is None)

        progress("write")
        written = rendered(robot, formats, options, diagnostics)
        if built is not None:
            built.double_counting.report(options.timeout)
        shapes = built.collisions.result(options.timeout) if built is not None else ()
        if options.strict:
            diagnostics.make_strict()
        diagnostics.raise_if_errors()

        progress("verify")
        report = proven(written, provers, options, diagnostics, composed.modules if loading is None else ())
    report_unused(diagnostics, _JUDGED_BY_BUILD + judged_by_files(options))
    motors = {actuator.name: actuator.motor for actuator in robot.actuators if actuator.motor is not None}
    report = replace(
        report,
        variant=options.variant,
        inputs=inputs,
        collision_shapes=shapes,
        masses={link.name: link.mass_properties.mass for link in robot.links},
        motors=motors,
    )
    if built is not None:
        report = replace(
            report, bodies=built.bodies, joint_table=built.joint_table, simplified_visuals=built.simplified
        )
    else:
        of_modules = composed.checks if options.verify else ()
        report = replace(report, joint_table=composed.joint_table, checks=(*report.checks, *of_modules))
    if options.strict:
        diagnostics.make_strict()
    files = all_files(written, report, options, diagnostics)
    if loading is None:
        return Conversion(diagnostics, robot, files, report, geometry=composed.content, read=composed.sought)
    return Conversion(diagnostics, robot, files, report, sidecar.document.step, loading.content)


def _search_unasked(document: Document, options: Options) -> SelfCollisionSection | None:
    """The search for links that can overlap, for a sidecar without one: for MJX, which lists all pairs, and for ROS."""
    if is_for_mjx(document.defaults.collision):
        return SelfCollisionSection(exclude=(ExcludedPairs.ALWAYS, ExcludedPairs.NEVER))
    return SelfCollisionSection() if options.ros2 else None


def check(sidecar: Path, options: Options, diagnostics: Diagnostics, *, open_step: bool = False) -> Checked:
    """Check a sidecar on its own or, with ``open_step``, against the STEP file; writes nothing.

    A URDF, SDFormat or MJCF is read with its meshes.
    """
    checked = Checked(is_loaded=False)
    try:
        if is_description(sidecar):
            from .translating import check_description

            return check_description(sidecar, options, diagnostics)
        loaded = load(sidecar, options, diagnostics)
        document = loaded.document
        checked = Checked(document.step, len(document.links), len(document.joints) + len(document.closures))
        if open_step and document.modules:
            from .composing import compose

            composed = compose(loaded, options, diagnostics)
            whole = composed.robot
            joints = len(whole.joints) + len(whole.closures)
            checked = Checked("", len(whole.links), joints, composed.joint_table, robot_words(whole))
        elif open_step:
            from .expectations import report_passed_stops

            source = options.step or named_step(loaded, diagnostics)
            with closing(Loading(source, what_to_read(loaded, options), options, diagnostics)) as loading:
                assembly = loading.assembly(diagnostics)
                built = build(loaded, assembly, loading, options, diagnostics)
                if built is not None:
                    checked = checked._replace(joint_table=built.joint_table, robot=robot_words(built.robot))
                    report_passed_stops(loaded, built, assembly, diagnostics)
                    built.double_counting.report(options.timeout)
        if not diagnostics.has_errors:
            report_unused(diagnostics, _JUDGED_BY_BUILD if open_step else _JUDGED_BY_TEXT)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
    return checked


def step_of(sidecar: Path, options: Options, diagnostics: Diagnostics) -> Path | None:
    """The STEP file of a conversion; None after errors."""
    try:
        return options.step or named_step(load(sidecar, options, diagnostics), diagnostics)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return None


def inspect(path: Path, options: Options) -> Inspection:
    """Read a STEP file and measure its bodies; for a sidecar, read its STEP, with its links' components."""
    diagnostics = Diagnostics()
    try:
        sidecar = load(path, options, diagnostics) if path.suffix.lower() in SIDECAR_SUFFIXES else None
        step = path if sidecar is None else options.step or named_step(sidecar, diagnostics)
        sidecar = None if sidecar is None else own_part(sidecar)
        what = what_to_read(sidecar, options)
        with closing(Loading(step, what, options, diagnostics)) as loading:
            assembly = loading.incomplete_assembly(diagnostics)
            measures = () if assembly is None else loading.measures(diagnostics)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return Inspection(diagnostics, None)
    if assembly is not None:
        from .building import report_size

        report_size(assembly, diagnostics)
    links = (
        {}
        if sidecar is None or diagnostics.has_errors or assembly is None
        else link_components(assembly, sidecar, diagnostics)
    )
    return Inspection(diagnostics, assembly, measures, links, what.tolerance)


_JUDGED_BY_TEXT = ("SB1",)
_JUDGED_BY_BUILD = ("SB1", "SB2", "SB3", "SB4", "SB5", "SB6")
"""Codes checked when only the sidecar was read, and when the robot was built."""
