"""A robot as the bytes of its files in all formats, with the report: the end of every conversion."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from stepbot.diagnostics import Diagnostics, source_lines
from stepbot.formats import default_formats, format_named
from stepbot.formats.features import Feature, Level
from stepbot.formats.format import Format
from stepbot.formats.lowering import lower
from stepbot.formats.lowering.joints import joints_in_loops, with_moved_zeros
from stepbot.formats.rendering import files_of, joined, main_file
from stepbot.formats.sdformat import FORMAT as SDFORMAT
from stepbot.formats.sdformat.gazebo_model import MODEL, gazebo_model
from stepbot.formats.urdf import FORMAT as URDF
from stepbot.formats.urdf.package import with_package
from stepbot.formats.urdf.srdf import report_guesses
from stepbot.report.document import report_bytes
from stepbot.report.robot import Content, Report, WrittenFile
from stepbot.robot.closures import degrees_of_freedom, driven_joints
from stepbot.robot.mesh_files import MeshFiles
from stepbot.robot.model import Robot
from stepbot.runtime.cache import content_digest
from stepbot.runtime.fork_server import ForkServer
from stepbot.runtime.output import write_atomically
from stepbot.runtime.temporary import run_folder

from .conversion import REPORT, REPORT_PAGE, Options
from .prestart import started_server

if TYPE_CHECKING:
    from stepbot.verification.conversion import Provers
    from stepbot.verification.modules import ModuleAlone

_NEVER_UNUSED = ("SB31", "SB465")
"""Codes of CAD changes, which come with a change and go with the next lock file, and one of `check --step` alone."""


class Rendered(Struct, frozen=True, eq=False):
    """A robot in several formats."""

    robot: Robot
    lowered: Mapping[str, Robot]
    """For each format, the robot as that format expresses it."""
    by_format: Mapping[str, Mapping[str, bytes]]
    """For each format, the bytes of its files, the main one first."""
    listed: tuple[WrittenFile, ...]
    """The written files, for the report."""
    losses: Mapping[str, frozenset[str]]
    """For each format, the codes of what it rewrites or lacks."""


def rendered(robot: Robot, formats: Sequence[Format], options: Options, diagnostics: Diagnostics) -> Rendered:
    """The files of a robot in each format.

    Raises:
        StepbotError: A format cannot express the robot.
    """
    robot = replace(robot, metadata=robot.metadata.stating(options.maintainer, options.license))
    names = {SDFORMAT.name: MODEL} if options.gazebo else {}
    lowered, losses = dict[str, Robot](), dict[str, frozenset[str]]()
    for written in formats:
        declared, source = Diagnostics(), robot
        if options.ros2 and written.name == URDF.name:
            from stepbot.formats.urdf.ros2.package import shown_in_rviz

            source = shown_in_rviz(robot)
        lowered[written.name] = lower(source, written, declared, names.get(written.name))
        losses[written.name] = frozenset(one.code for one in diagnostics.extend(declared))
    diagnostics.raise_if_errors()
    by_format = {written.name: files_of(lowered[written.name], written) for written in formats}
    listed = tuple(
        replace(file, path=names[file.format]) if file.content is Content.ROBOT and file.format in names else file
        for file in _listed(by_format)
    )
    if options.package and URDF.name in by_format:
        urdf = main_file(lowered[URDF.name], URDF)
        by_format[URDF.name][urdf] = with_package(by_format[URDF.name][urdf], options.package)
        if options.ros2:
            from stepbot.formats.urdf.ros2.package import report_gaps, ros2_package
            from stepbot.robot.datasheet import accelerations

            by_format[URDF.name].update(ros2_package(lowered[URDF.name], options.package, accelerations(robot)))
            report_gaps(lowered[URDF.name], diagnostics)
    if any(path.endswith(".srdf") for path in by_format.get(URDF.name, ())):
        report_guesses(lowered[URDF.name], diagnostics)
    if options.programs:
        from stepbot.formats.learning import MENAGERIE, program_files
        from stepbot.formats.mjcf.menagerie import report_missing_license

        if MENAGERIE in options.programs:
            report_missing_license(robot, diagnostics)
        for name, files in program_files(options.programs, lowered, diagnostics).items():
            by_format[name] |= files
    if options.gazebo and SDFORMAT.name in by_format:
        by_format[SDFORMAT.name] = gazebo_model(lowered[SDFORMAT.name], by_format[SDFORMAT.name], options.gazebo)
    return Rendered(robot, lowered, by_format, listed, losses)


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


def started_provers(formats: Sequence[Format], options: Options, server: ForkServer | None) -> "Provers | None":
    """The engines that will verify the files, which import while the kernel works; None if none is to.

    Args:
        server: A process started in advance to start them; None to start one.
    """
    if not options.verify:
        return None
    from stepbot.verification.conversion import Provers

    names = [written.name for written in formats]
    return Provers(names, memory_limit=options.memory_limit, server=server or started_server(options))


def proven(
    written: Rendered,
    provers: "Provers | None",
    options: Options,
    diagnostics: Diagnostics,
    modules: "Sequence[ModuleAlone]" = (),
) -> Report:
    """The report on the files; without engines, on the robot alone.

    Args:
        modules: What the robot is composed of.
    """
    robot = written.robot
    if provers is not None:
        report = _verified(written, provers, options, diagnostics, modules)
    else:
        driven = driven_joints(robot) if robot.closures else ()
        report = Report(robot=robot, degrees_of_freedom=degrees_of_freedom(robot), driven=driven)
    return replace(report, files=written.listed, names=_sources(written))


def _verified(
    written: Rendered, provers: "Provers", options: Options, diagnostics: Diagnostics, modules: "Sequence[ModuleAlone]"
) -> Report:
    """Verify the files in a temporary folder, before anything in the output folder is changed."""
    from stepbot.engines.workers import ObservationCache
    from stepbot.verification.conversion import Written, verify

    with TemporaryDirectory(dir=run_folder()) as folder:
        place = Path(folder) / (options.package or options.gazebo)  # where `package://` and `model://` find the meshes
        write_atomically(joined(written.by_format), place)
        files = {
            name: Written(place / next(iter(written.by_format[name])), one, _lowered(modules, name, written.robot))
            for name, one in written.lowered.items()
        }
        contents = {name: content_digest(of_format) for name, of_format in written.by_format.items()}
        for name, one in written.lowered.items():
            for beside in (companion for companion in format_named(name).writer.companions(one) if companion.format):
                files[beside.format] = Written(place / beside.path, beside.robot)
                contents[beside.format] = contents[name]
        observations = ObservationCache(options.cache, contents)
        require, timeout = options.require, options.timeout
        return verify(
            written.robot, files, provers, diagnostics, require=require, timeout=timeout, observations=observations
        )


def _lowered(modules: "Sequence[ModuleAlone]", name: str, whole: Robot) -> "tuple[tuple[ModuleAlone, Robot], ...]":
    """Modules with their robots as a format expresses them; its losses are reported for the whole robot.

    A format that moves the zeros of loops does so for those between modules, too.
    """
    target = format_named(name)
    is_moved = target.expresses[Feature.LOOP_ZERO].level is Level.LOWERED
    in_loops = joints_in_loops(whole) if is_moved else set[str]()
    known: dict[tuple[int, frozenset[str]], Robot] = {}

    def lowered(robot: Robot, prefix: str) -> Robot:
        moved = frozenset(joint.name for joint in robot.joints if prefix + joint.name in in_loops)
        if (id(robot), moved) not in known:
            known[id(robot), moved] = lower(with_moved_zeros(robot, moved), target, Diagnostics())
        return known[id(robot), moved]

    return tuple((module, lowered(module.robot, module.module.prefix)) for module in modules)


def _sources(written: Rendered) -> dict[str, str]:
    """The component or link of each mesh file."""
    with_files = [lowered for name, lowered in written.lowered.items() if format_named(name).mesh_files]
    files = (file for lowered in with_files or [written.robot] for file in MeshFiles(lowered).all)
    return {file.path: file.asset.source for file in files}


def all_files(written: Rendered, report: Report, options: Options, diagnostics: Diagnostics) -> dict[str, bytes]:
    """All files to write, by path: those of the formats, and the report."""
    files = {**joined(written.by_format), REPORT: report_bytes(report, diagnostics)}
    if options.programs:
        from stepbot.formats.learning import FOLDERS, MENAGERIE, SIMREADY, simready_folder

        if MENAGERIE in options.programs:
            from .menagerie import menagerie_folder

            name = FOLDERS[MENAGERIE]
            files |= menagerie_folder(written.lowered[name], written.by_format[name], report)
        if SIMREADY in options.programs:
            files |= simready_folder(written.lowered[FOLDERS[SIMREADY]])
    if options.html:
        from stepbot.viewing.report.page import report_page

        files[REPORT_PAGE] = report_page(written.robot, report, tuple(diagnostics), source_lines(diagnostics))
    return files


def judged_by_files(options: Options) -> tuple[str, ...]:
    """Codes checked when all formats were written, or the files verified."""
    losses = ("SB7",) if set(options.formats) >= set(default_formats()) else ()
    return (*losses, *(("SB8",) if options.verify else ()))


def report_unused(diagnostics: Diagnostics, judged: tuple[str, ...]) -> None:
    """Report ignore rules that match nothing (SB142), among the checked codes."""
    for rule in diagnostics.unused_ignores:
        if rule.code.startswith(judged) and not rule.code.startswith(_NEVER_UNUSED):
            about = f"{rule.subject}: " if rule.subject else ""
            diagnostics.add("SB142", f"{about}unused ignore of {rule.code}", rule.span, help=["remove the entry"])
