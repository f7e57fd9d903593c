"""A URDF, SDFormat or MJCF converted to other formats, through the same model as a STEP file and its sidecar.

What of the file does not reach the model is reported; the engines compare the written files with the model, and with
the file that they came from.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import ExitStack, nullcontext
from pathlib import Path

from msgspec.structs import replace

from stepbot.compose.pruning import elements
from stepbot.described.assumed import check_inertials, lacking, lumped, with_assumed
from stepbot.described.finding import ASSUMED, ASSUMED_CONTACTS, UNSUPPORTED, Finding
from stepbot.described.robot import DescribedRobot, robot_of_description
from stepbot.diagnostics import Diagnostics, Ignore, Span
from stepbot.engines.description import Description
from stepbot.engines.observation import Quantity
from stepbot.engines.workers import check_required
from stepbot.formats import format_named
from stepbot.robot.gains import tuned
from stepbot.robot.mesh_names import portable_name
from stepbot.robot.model import Actuator, ActuatorKind, Base, Robot
from stepbot.robot.validity import check_robot
from stepbot.runtime.file import resolved
from stepbot.runtime.fork_server import ForkServer
from stepbot.sidecar.references import not_portable
from stepbot.sidecar.settings import SelfCollisionSection
from stepbot.verification.joint_rows import joint_rows_of

from .conversion import Checked, Conversion, Options, is_description
from .describing import Places, read_description
from .loading import input_hashes, input_names
from .self_collisions import with_self_collision
from .verdict import robot_words
from .writing import Rendered, all_files, judged_by_files, proven, rendered, report_unused, started_provers

__all__ = ["check_description", "is_description", "produce_translation"]

_JUDGED = ("SB129", "SB4", "SB5", "SB86", "SB87")
"""Codes that are checked whenever a description becomes a robot."""
_ASSUMED = {
    "urdf": "0 taken, as URDF defines; MuJoCo computes a mass from the collisions, PyBullet takes 1 kg",
    "sdf": "1 kg and 1 kg m^2 taken, as SDFormat defines",
    "mjcf": "computed from the geoms, as MJCF defines",
}
"""Mass properties that a format defines where a file gives none."""


def produce_translation(
    path: Path, options: Options, diagnostics: Diagnostics, progress: Callable[[str], None], server: ForkServer | None
) -> Conversion:
    """Convert a description, and verify the files; writes nothing.

    Raises:
        StepbotError: There are errors.
    """
    progress("read")
    formats = [format_named(name) for name in dict.fromkeys(options.formats)]
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    if options.verify:
        check_required(options.require, diagnostics)
    with ExitStack() as running:
        provers = started_provers(formats, options, server)
        if provers is not None:
            running.enter_context(provers)
        description = _read(path, options, diagnostics)
        progress("build")
        robot, described = _robot(path, description, options, diagnostics)
        if options.ros2:
            progress("self-collision")
            robot = with_self_collision(robot, SelfCollisionSection(), options, diagnostics)
        progress("write")
        written = rendered(robot, formats, options, diagnostics)
        _check_overwritten(written, (path, *description.files), options, diagnostics)
        if options.strict:
            diagnostics.make_strict()
        diagnostics.raise_if_errors()
        progress("verify")
        report = proven(written, provers, options, proof := Diagnostics())
        if report.initial_penetrations and description.observation.format != "mjcf":
            described = _without_contacts(described, report.initial_penetrations)
            diagnostics.add(described.findings[-1].code, described.findings[-1].text, Span(path.as_posix()))
            pairs = described.robot.excluded_contacts
            robot = replace(robot, excluded_contacts=pairs)
            written = rendered(robot, formats, options, diagnostics)
            again = running.enter_context(started_provers(formats, options, None) or nullcontext())
            report = proven(written, again, options, proof := Diagnostics())
        diagnostics.extend(proof)
    if options.verify:
        from .source_proof import compared_with_source

        report = compared_with_source(path, description, described, written, report, options, diagnostics)
    report_unused(diagnostics, _JUDGED + judged_by_files(options))
    inputs = input_hashes(input_names(path, description.files))
    report = replace(report, inputs=inputs, joint_table=joint_rows_of(robot))
    if options.strict:
        diagnostics.make_strict()
    return Conversion(diagnostics, robot, all_files(written, report, options, diagnostics), report)


def _without_contacts(described: DescribedRobot, pairs: Sequence[tuple[str, str]]) -> DescribedRobot:
    """The robot of a file that does not state which of its links touch, without contacts of these.

    By default, Gazebo and PyBullet have no contacts within a robot; MuJoCo has.
    """
    links = ", ".join(f"'{a}' and '{b}'" for a, b in pairs)
    text = f"contacts excluded of links that overlap in the initial pose, with which a simulation diverges: {links}"
    excluded = tuple(sorted({*described.robot.excluded_contacts, *pairs}))
    robot = replace(described.robot, excluded_contacts=excluded)
    finding = Finding(ASSUMED_CONTACTS, text, (Quantity.CONTACTS,))
    return replace(described, robot=robot, findings=(*described.findings, finding))


def check_description(path: Path, options: Options, diagnostics: Diagnostics) -> Checked:
    """Check that a description can be converted; writes nothing.

    Raises:
        StepbotError: There are errors.
    """
    diagnostics.ignore(Ignore(code, Span("stepbot")) for code in options.ignore)
    robot, _ = _robot(path, _read(path, options, diagnostics), options, diagnostics)
    report_unused(diagnostics, _JUDGED)
    joints = len(robot.joints) + len(robot.closures)
    return Checked("", len(robot.links), joints, joint_rows_of(robot), robot_words(robot))


def robot_of_file(
    path: Path, options: Options, diagnostics: Diagnostics, replaced: Collection[str] = ()
) -> tuple[Robot, tuple[Path, ...]]:
    """The checked robot of a description, and the further files that it refers to.

    Args:
        replaced: Links whose mass properties are replaced, so that those of the file are not judged.

    Raises:
        StepbotError: There are errors.
    """
    description = _read(path, options, diagnostics)
    return _robot(path, description, options, diagnostics, replaced)[0], description.files


def _read(path: Path, options: Options, diagnostics: Diagnostics) -> Description:
    description = read_description(path, options, diagnostics)
    diagnostics.raise_if_errors()
    assert description is not None  # otherwise there is an error with the reason
    return description


def _robot(
    path: Path, description: Description, options: Options, diagnostics: Diagnostics, replaced: Collection[str] = ()
) -> tuple[Robot, DescribedRobot]:
    """The checked robot of a description; all differences from its file are reported."""
    span = Span(path.as_posix())
    base = Base(options.base) if options.base else None
    described = robot_of_description(description, path.stem, path.name, base)
    for lost in description.lost:
        place = description.place((path.parent / lost.file).as_posix() if lost.file else span.file, lost.line)
        times = f" ({lost.count} times)" if lost.count > 1 else ""
        notes = [lost.effect] if lost.effect else ()
        diagnostics.add("SB860", f"{lost.what}: not converted{times}", place, notes=notes, help=lost.help)
    if description.plain_meshes:
        meshes = ", ".join(f"'{uri}'" for uri in description.plain_meshes)
        diagnostics.add("SB872", f"textures or further colours of meshes not converted: {meshes}", span)
    described = _with_possible_masses(described, options)
    lacking_inertia = () if options.assume_inertia else description.without_inertia
    without_inertia = [link for link in lacking_inertia if link not in replaced]
    places = Places(path, description)
    for finding in (*map(_without_inertia, without_inertia), *described.findings):
        diagnostics.add(finding.code, finding.text, places.of(finding.text), help=finding.help)
    computed = {finding.text.split("'")[1] for finding in described.findings if finding.code == ASSUMED}
    known = computed | described.surroundings | set(replaced)
    links = ", ".join(f"'{link}'" for link in description.assumed if link not in known)
    if links:
        taken = _ASSUMED[description.observation.format]
        diagnostics.add("SB867", f"mass properties not given in the file: {links}", span, notes=[taken])
    for limit in description.open_limits:
        missing = " and ".join(f"'{bound}'" for bound in limit.missing)
        lacks = f"no {missing} in <limit>" if limit.has_element else "no <limit>"
        is_open = len(limit.missing) == 2
        ros = ("takes 0 for both: the joint cannot move" if limit.has_element else "rejects the file",)
        diagnostics.add(
            "SB874:limit",
            f"joint '{limit.joint}': {lacks}: {'read as unlimited' if is_open else '0 taken'}",
            description.place(span.file, limit.line),
            help=['state `lower` and `upper`, or `type="continuous"` for a hinge without limits'] if is_open else (),
            notes=[f"ROS (urdfdom) {one}" for one in ros if is_open],
        )
    _report_names(described.robot, span, diagnostics)
    for newer in description.newer:
        text = f"{newer.what} is of URDF {newer.needs:g}, which the file does not state: read as such"
        remedy = f'state it: `<robot version="{newer.needs:g}">`'
        diagnostics.add("SB876", text, description.place(span.file, newer.line), help=[remedy])
    if not (described.is_base_known or base or diagnostics.has_errors):
        message = f"link '{described.robot.root.name}': taken as fixed to the world"
        help = ["`--base floating` for a robot that moves freely, `--base fixed` to confirm"]
        diagnostics.add("SB874:base", message, span, help=help)
    judged = Diagnostics()
    check_robot(described.robot, judged, span, massless_between=True)
    if not judged.has_errors:
        check_inertials(described.robot, judged, span)
    subjects = tuple(f"link '{link}': " for link in (*replaced, *without_inertia))
    diagnostics.extend(one for one in judged if not one.message.startswith(subjects))
    diagnostics.raise_if_errors()
    robot = _tuned(described.robot, span, diagnostics)
    return robot, replace(described, robot=robot)


def _without_inertia(link: str) -> Finding:
    remedy = "state it, or `--assume-inertia DENSITY` computes it from the geometry"
    return Finding(UNSUPPORTED, f"link '{link}': <inertial> has a mass and no <inertia>", help=(remedy,))


def _with_possible_masses(described: DescribedRobot, options: Options) -> DescribedRobot:
    """The robot with mass properties from its geometry where the file states none that are possible, if requested.

    Otherwise with impossible inertias of slight links on what they are fixed to.
    """
    robot, findings = described.robot, list[Finding]()
    if options.assume_inertia:
        solids = options.workers.call("stepbot.described.assumed:solids_of", lacking(robot))
        robot = with_assumed(robot, solids, options.assume_inertia, findings)
    else:
        robot = lumped(robot, findings)
    return replace(described, robot=robot, findings=(*described.findings, *findings))


def computed_gains(actuator: Actuator) -> str:
    """What SB874:gains reports of an actuator without gains in its file."""
    gains = f"kp = {actuator.kp:g}, kv = {actuator.kv:g}"
    if actuator.kind is ActuatorKind.VELOCITY:
        gains = f"kv = {actuator.kv:g}"
    return f"actuator '{actuator.name}' on '{actuator.joint}': no gains in the file: {gains} computed"


def _tuned(robot: Robot, span: Span, diagnostics: Diagnostics) -> Robot:
    """The robot with computed gains for actuators of which the file gives none (SB874:gains)."""
    weak: dict[str, str] = {}

    def too_weak(actuator: Actuator, effort: float, weight: float) -> None:
        weak[actuator.name] = f"its effort limit of {effort:g} does not hold the joint, whose weight is {weight:.3g}"

    tuned_robot = tuned(robot, too_weak)
    for one in tuned_robot.actuators:
        if one.tuning is not None and one.tuning.assumed:
            notes = [weak[one.name]] if one.name in weak else ()
            diagnostics.add("SB874:gains", computed_gains(one), span, notes=notes)
    return tuned_robot


def _report_names(robot: Robot, span: Span, diagnostics: Diagnostics) -> None:
    """Report names that not every reader takes (SB129), as in a sidecar."""
    named = {
        section.removesuffix("s"): [member.name for member in members] for section, members in elements(robot).items()
    }
    for kind, names in {"robot": [robot.name], **named}.items():
        for name in names:
            if (portable := portable_name(name, kind)) != name:
                help = [f"rename it to '{portable}' in the source, or in a sidecar: `stepbot view --edit`"]
                diagnostics.add("SB129", f"{kind} '{name}': {not_portable(name)}", span, help=help)


def _check_overwritten(written: Rendered, sources: Iterable[Path], options: Options, diagnostics: Diagnostics) -> None:
    """Report files that the conversion would write over its own source (SB012)."""
    read = {resolved(source) for source in sources}
    for path in (path for files in written.by_format.values() for path in files):
        if resolved(options.output / path) in read:
            diagnostics.add(
                "SB012",
                f"the conversion would overwrite '{path}', which it reads",
                Span((options.output / path).as_posix()),
                help=["convert into another folder: `-o FOLDER`"],
            )
    diagnostics.raise_if_errors()
