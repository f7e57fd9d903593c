"""What differs between two STEP files, two sidecars, or two robots."""

from collections.abc import Iterable
from contextlib import closing
from functools import partial
from pathlib import Path

from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble import build_robot
from stepbot.compose.joining import in_tree_order
from stepbot.diagnostics import Diagnostics, Span, StepbotError
from stepbot.engines.observation import Observation, Request
from stepbot.engines.reference import observe_robot
from stepbot.revisions.differences import Difference, not_compared, robot_differences, step_differences
from stepbot.revisions.shapes import Motion, moved_words
from stepbot.revisions.snapshot import Snapshot, snapshot
from stepbot.robot.model import Joint, Robot
from stepbot.runtime.file import exists, is_file, is_folder, read_regular
from stepbot.sidecar.variants import variant_names
from stepbot.step.assembly import ReadOptions
from stepbot.verification.admission import SCENES
from stepbot.verification.compare import compare
from stepbot.verification.files import compare_two

from .composing import compose
from .conversion import Options
from .loading import Loading
from .sidecars import load, named_step, report_missing, what_to_read

_MODEL = "urdf"
"""The format whose conventions both models are described by."""


class Differences(Struct, frozen=True):
    """The differences of two files."""

    old: str
    new: str
    rows: tuple[Difference, ...]
    complete: bool = True
    """Whether everything was compared: otherwise files without differences are not the same."""


def differing_steps(old: Path, new: Path, options: Options, diagnostics: Diagnostics) -> Differences | None:
    """Compare two STEP files component by component; None after errors."""
    taken = [_snapshot(path, options, diagnostics) for path in (old, new)]
    if taken[0] is None or taken[1] is None:
        return None
    return Differences(old.as_posix(), new.as_posix(), step_differences(taken[0], taken[1]))


def differing_sidecars(old: Path, new: Path, options: Options, diagnostics: Diagnostics) -> Differences | None:
    """Compare the robots that two sidecars describe, and their variants: links, joints, limits, masses, frames.

    Returns:
        None after errors.
    """
    rows = _differing(old, new, options, diagnostics)
    if rows is not None and not options.variant:
        named = [_variants(path) for path in (old, new)]
        of_all = [*rows]
        rows += [Difference("variants", f"variant '{name}'", "removed") for name in named[0] if name not in named[1]]
        rows += [Difference("variants", f"variant '{name}'", "added") for name in named[1] if name not in named[0]]
        for name in (one for one in named[0] if one in named[1]):
            of_one = _differing(old, new, options._replace(variant=name), diagnostics)
            if of_one is None:
                return None
            rows += [replace(row, name=f"variant '{name}': {row.name}") for row in of_one if row not in of_all]
    return None if rows is None else Differences(old.as_posix(), new.as_posix(), tuple(rows))


def _variants(sidecar: Path) -> tuple[str, ...]:
    return variant_names(read_regular(sidecar).decode("utf-8")) if is_file(sidecar) else ()


def _differing(old: Path, new: Path, options: Options, diagnostics: Diagnostics) -> list[Difference] | None:
    """The differences of the robots of two sidecars, of one variant each; None after errors."""
    robots = [_described(path, options, diagnostics) for path in (old, new)]
    if robots[0] is None or robots[1] is None:
        return None
    rows, placed = _modules(robots[0], robots[1])
    results = compare(_at_zero(old, robots[0]), _at_zero(new, placed))
    return [*rows, *robot_differences(results)]


def _modules(old: Robot, new: Robot) -> tuple[list[Difference], Robot]:
    """Modules that are new, gone or elsewhere; and the new robot with its modules at their old places.

    So links are compared within their module: a hand that is mounted elsewhere is one difference, and not one of each
    of its links and of all that it carries.
    """
    named = [{module.name: module for module in robot.modules} for robot in (old, new)]
    rows = [Difference("modules", f"module '{name}'", "removed") for name in named[0] if name not in named[1]]
    rows += [Difference("modules", f"module '{name}'", "added") for name in named[1] if name not in named[0]]
    mounts = {joint.child: joint for joint in old.joints}
    joints = {joint.child: joint for joint in new.joints}
    for name, module in named[1].items():
        before, after = mounts.get(module.links[0]), joints.get(module.links[0])
        if name not in named[0] or before is None or after is None:
            continue
        motion = Motion(*before.X_PC.distance_to(after.X_PC))
        if before.parent != after.parent:
            if before.parent not in new.link_by_name or before.parent in _below(joints.values(), after.child):
                continue
            words = f"on link '{after.parent}', formerly on '{before.parent}'"
            rows.append(Difference("modules", f"module '{name}'", words))
        elif not motion.is_none:
            where = f"module '{name}' on link '{after.parent}'"
            words = moved_words(motion)
            rows.append(Difference("modules", where, words, amount=motion.distance, unit="m", angle=motion.angle))
        joints[after.child] = replace(after, parent=before.parent, X_PC=before.X_PC)
    ordered = in_tree_order(new.root.name, (joints[joint.child] for joint in new.joints))
    links = (new.root, *(new.link_by_name[joint.child] for joint in ordered))
    return rows, replace(new, links=links, joints=ordered)


def _below(joints: Iterable[Joint], link: str) -> set[str]:
    """A link, and all links below it."""
    below, waiting = {link}, list(joints)
    while more := {joint.child for joint in waiting if joint.parent in below} - below:
        below |= more
    return below


def differing_robots(old: Path, new: Path, options: Options, diagnostics: Diagnostics) -> Differences | None:
    """Compare two robot files as engines load them; None if either cannot be read at all."""
    results = compare_two(old, new, diagnostics, options.workers, options.package_path, options.xacro)
    if results is None:
        return None
    lacking = not_compared(results)
    if lacking:
        diagnostics.add("SB815", f"not compared: {lacking}", Span(new.as_posix()))
    complete = not (lacking or diagnostics.has_errors)
    return Differences(old.as_posix(), new.as_posix(), robot_differences(results), complete)


def robot_files(old: Path, new: Path, diagnostics: Diagnostics) -> tuple[Path, Path] | None:
    """The two files to compare of two robots, each a file or an output folder; None after an error.

    Of folders the files of one format are taken: URDF where both have one, else SDFormat, else MJCF.
    """
    for path in (old, new):
        if not exists(path):
            report_missing(path, diagnostics)
    if diagnostics.has_errors:
        return None
    choices = [_by_suffix(path) for path in (old, new)]
    for suffix in choices[0]:
        if suffix in choices[1]:
            return choices[0][suffix], choices[1][suffix]
    if not (is_folder(old) or is_folder(new)):
        return old, new
    for path in (old, new):
        if is_folder(path) and not _by_suffix(path):
            diagnostics.add("SB001", "no URDF, SDFormat or MJCF file in this folder", Span(path.as_posix()))
    if not diagnostics.has_errors:
        diagnostics.add("SB001", f"no file of a format that is also in '{old.as_posix()}'", Span(new.as_posix()))
    return None


def _by_suffix(path: Path) -> dict[str, Path]:
    """Robot files by suffix, in the order of preference."""
    if not is_folder(path):
        return {path.suffix: path}
    files = sorted(file for file in path.iterdir() if is_file(file) and not file.name.endswith(SCENES))
    return {suffix: file for suffix in (".urdf", ".sdf", ".xml") for file in reversed(files) if file.suffix == suffix}


def _snapshot(step: Path, options: Options, diagnostics: Diagnostics) -> Snapshot | None:
    reported = Diagnostics()
    try:
        with closing(Loading(step, ReadOptions(encoding=options.encoding), options, reported)) as loading:
            assembly = loading.assembly(reported)
            return snapshot(assembly, loading.content, loading.measures(reported))
    except StepbotError:
        diagnostics.extend(one for one in reported if one.severity == "error")
        return None


def _described(sidecar: Path, options: Options, diagnostics: Diagnostics) -> Robot | None:
    """The robot of a sidecar; None after errors."""
    reported = Diagnostics()
    try:
        loaded = load(sidecar, options, reported)
        if loaded.document.modules:
            return compose(loaded, options, reported).robot
        step = named_step(loaded, reported)
        with closing(Loading(step, what_to_read(loaded, options), options, reported)) as loading:
            assembly, measures = loading.assembly(reported), partial(loading.measures, reported)
            built = build_robot(assembly, loaded, measures, reported, options.cache, loading.mesh_worker)
            reported.raise_if_errors()
    except StepbotError as error:
        diagnostics.extend(diagnostic for diagnostic in error.diagnostics if diagnostic.severity == "error")
        return None
    assert built is not None  # a missing robot always has an error
    return built.robot


def _at_zero(sidecar: Path, robot: Robot) -> Observation:
    """A robot as it is observed with all joints at zero."""
    return observe_robot(robot, Request(sidecar.as_posix(), _MODEL, configurations=({},)))
