r"""The conversion pipeline: sidecar and STEP file to verified robot files.

    sidecar -> Document \
                         assemble -> Robot -> lower -> writers -> files -> engines -> observations -> verification
    STEP    -> Assembly /

This module prints nothing. The result contains the diagnostics, which the command line shows.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from stepbot.assemble import link_components
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.diagnostics.source_lines import source_lines
from stepbot.engines.workers import check_required
from stepbot.formats import default_formats, format_named
from stepbot.formats.lowering import lower
from stepbot.formats.rendering import files_of, joined, main_file
from stepbot.formats.sdformat import FORMAT as SDFORMAT
from stepbot.formats.sdformat.gazebo_model import gazebo_model
from stepbot.formats.urdf import FORMAT as URDF
from stepbot.formats.urdf.package import with_package
from stepbot.formats.urdf.ros2.package import ros2_package
from stepbot.geometry.volume import VolumeProperties
from stepbot.report.document import report_bytes
from stepbot.report.record import Content, Report, WrittenFile
from stepbot.robot.closures import degrees_of_freedom, driven_joints
from stepbot.robot.model import Robot
from stepbot.runtime.fork_server import ForkServer
from stepbot.runtime.worker import Worker
from stepbot.sidecar.self_collision import SelfCollisionSection
from stepbot.step.assembly import Assembly

from .building import build
from .conversion import REPORT, REPORT_PAGE, Checked, Conversion, Options, write
from .loading import Loading
from .self_collisions import with_self_collision
from .sidecars import SIDECAR_SUFFIXES, load, named_step, what_to_read

if TYPE_CHECKING:
    from .proof import Proof

__all__ = ["REPORT", "Conversion", "Inspection", "Options", "check", "convert", "inspect", "produce", "step_of"]


@dataclass(frozen=True)
class Inspection:
    """The content of a STEP file."""

    diagnostics: Diagnostics
    assembly: Assembly | None
    """After errors what could be read, with missing parts marked; None if that is nothing."""
    measures: tuple[VolumeProperties | None, ...] = ()
    """trimesh's mass properties of each body of the assembly; None for a mesh that encloses no volume."""
    links: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """For each link of the sidecar, the indices of its components; empty if a STEP was inspected without a sidecar."""


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
    """Convert one sidecar and its STEP file, and verify the files; writes nothing.

    Args:
        sidecar: The sidecar.
        options: Conversion options.
        progress: Called at the start of each stage.
        kernel: A process started in advance; None to start one if needed.
        server: A process started in advance to start the engines; None to start one if needed.
    """
    found = Diagnostics()
    try:
        return _produce(sidecar, options, found, progress, kernel, server)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Conversion(found)


def _produce(
    path: Path,
    options: Options,
    found: Diagnostics,
    progress: Callable[[str], None],
    kernel: Worker | None,
    server: ForkServer | None,
) -> Conversion:
    progress("read")
    formats = [format_named(name) for name in dict.fromkeys(options.formats)]
    if options.verify:
        check_required(options.require, found)
    sidecar = load(path, options, found)
    with ExitStack() as running:
        step = options.step or named_step(sidecar, found)
        loading = running.enter_context(closing(Loading(step, what_to_read(sidecar, options), options, found, kernel)))
        proof = _started_proof([written.name for written in formats], options, server)
        if proof is not None:
            running.enter_context(closing(proof))
        assembly = loading.assembly(found)

        progress("build")
        built = build(sidecar, assembly, loading, options, found)
        found.raise_if_errors()
        assert built is not None  # a missing robot always has an error
        robot, inputs = built.robot, loading.inputs()
        wanted = sidecar.document.self_collision or (SelfCollisionSection() if options.ros2 else None)
        if wanted is not None:
            progress("self-collision")
            robot = with_self_collision(robot, wanted, options, found)

        progress("write")
        lowered = {written.name: lower(robot, written, found) for written in formats}
        found.raise_if_errors()
        by_format = {written.name: files_of(lowered[written.name], written) for written in formats}
        listed = _listed(by_format)
        if options.package and URDF.name in by_format:
            urdf = main_file(lowered[URDF.name], URDF)
            by_format[URDF.name][urdf] = with_package(by_format[URDF.name][urdf], options.package)
            if options.ros2:
                by_format[URDF.name].update(ros2_package(lowered[URDF.name], options.package))
        if options.gazebo and SDFORMAT.name in by_format:
            by_format[SDFORMAT.name] = gazebo_model(lowered[SDFORMAT.name], by_format[SDFORMAT.name], options.gazebo)
        built.double_counting.report(options.timeout)
        shapes = built.collisions.result(options.timeout)
        if options.strict:
            found.make_strict()
        found.raise_if_errors()

        progress("verify")
        report = _unproven(robot) if proof is None else proof.report(robot, lowered, by_format, found)
    _report_unused(found, _JUDGED_BY_BUILD + _judged_by_files(options))
    names = {asset.path: asset.source for asset in robot.meshes}
    report = replace(report, files=listed)
    report = replace(report, inputs=inputs, names=names, bodies=built.bodies, joint_table=built.joint_table)
    report = replace(report, collision_shapes=shapes)
    if options.strict:
        found.make_strict()
    files = {**joined(by_format), REPORT: report_bytes(report, found)}
    if options.html:
        from stepbot.viewing.report.page import report_page

        files[REPORT_PAGE] = report_page(robot, report, tuple(found), source_lines(found))
    return Conversion(found, robot, files, report, sidecar.document.step, loading.content)


def _listed(by_format: Mapping[str, Mapping[str, bytes]]) -> tuple[WrittenFile, ...]:
    """The written files, for the report."""
    listed = []
    for name, files in by_format.items():
        main, *others = [path for path in files if "/" not in path]
        scene = format_named(name).scene
        listed.append(WrittenFile(main, name, Content.ROBOT))
        for path in others:
            content = Content.SCENE if scene and path.endswith(scene) else Content.VARIANT
            listed.append(WrittenFile(path, name, content))
    return tuple(listed)


def _started_proof(formats: list[str], options: Options, server: ForkServer | None) -> "Proof | None":
    """The engines that will verify the files; None if verification is disabled."""
    if not options.verify:
        return None
    from .proof import Proof

    return Proof(formats, options, server)


def _unproven(robot: Robot) -> Report:
    driven = driven_joints(robot) if robot.closures else ()
    return Report(robot=robot, degrees_of_freedom=degrees_of_freedom(robot), driven=driven)


def check(sidecar: Path, options: Options, found: Diagnostics, *, open_step: bool = False) -> Checked:
    """Check a sidecar on its own or, with ``open_step``, against the STEP file; writes nothing."""
    checked = Checked()
    try:
        loaded = load(sidecar, options, found)
        document = loaded.document
        checked = Checked(document.step, len(document.links), len(document.joints) + len(document.closures))
        if open_step:
            source = options.step or named_step(loaded, found)
            with closing(Loading(source, what_to_read(loaded, options), options, found)) as loading:
                built = build(loaded, loading.assembly(found), loading, options, found)
                if built is not None:
                    checked = replace(checked, joint_table=built.joint_table)
                    built.double_counting.report(options.timeout)
        if not found.has_errors:
            _report_unused(found, _JUDGED_BY_BUILD if open_step else _JUDGED_BY_TEXT)
    except StepbotError as error:
        found.extend(error.diagnostics)
    return checked


def step_of(sidecar: Path, options: Options, found: Diagnostics) -> Path | None:
    """The STEP file of a conversion; None after errors."""
    try:
        return options.step or named_step(load(sidecar, options, found), found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return None


def inspect(path: Path, options: Options) -> Inspection:
    """Read a STEP file and measure its bodies; for a sidecar, read its STEP, with its links' components."""
    found = Diagnostics()
    try:
        sidecar = load(path, options, found) if path.suffix.lower() in SIDECAR_SUFFIXES else None
        step = path if sidecar is None else options.step or named_step(sidecar, found)
        with closing(Loading(step, what_to_read(sidecar, options), options, found)) as loading:
            assembly = loading.incomplete_assembly(found)
            measures = () if assembly is None else loading.measures(found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Inspection(found, None)
    links = {} if sidecar is None or found.has_errors or assembly is None else link_components(assembly, sidecar, found)
    return Inspection(found, assembly, measures, links)


_JUDGED_BY_TEXT = ("SB1",)
_JUDGED_BY_BUILD = ("SB1", "SB2", "SB3", "SB4", "SB5", "SB6")
"""Codes checked when only the sidecar was read, and when the robot was built."""
_OF_REVISIONS = ("SB31", "SB408", "SB517")
"""Codes of CAD changes: they come with a change and go with the next lock file, so ignoring them is never unused."""


def _judged_by_files(options: Options) -> tuple[str, ...]:
    """Codes checked when all formats were written, or the files verified."""
    losses = ("SB7",) if set(options.formats) >= set(default_formats()) else ()
    return (*losses, *(("SB8",) if options.verify else ()))


def _report_unused(found: Diagnostics, judged: tuple[str, ...]) -> None:
    """Report ignore rules that match nothing (SB142), among the checked codes."""
    for rule in found.unused_ignores:
        if rule.code.startswith(judged) and not rule.code.startswith(_OF_REVISIONS):
            about = f"{rule.subject}: " if rule.subject else ""
            found.add("SB142", f"{about}unused ignore of {rule.code}", rule.span, help=["remove the entry"])
