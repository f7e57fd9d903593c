"""What the page shows: the robot of a sidecar, or a plain STEP file with the joints that inference finds."""

from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.robot.model import Robot
from stepbot.robot.step_names import is_step_name, step_stem
from stepbot.runtime.file import exists
from stepbot.sidecar.draft_comments import drafted_reviews, drafted_stops
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly
from stepbot.viewing.connections import evidence_of_rows
from stepbot.viewing.scene import scene_document

from .building import build
from .composing import compose
from .conversion import Options
from .describing import described_robot
from .drafted_robot import evidence_of_draft, robot_of_assembly, robot_of_draft
from .drafting import draft_step
from .loading import Loading
from .sidecars import SIDECAR_SUFFIXES, load, named_step, report_missing, what_to_read


@dataclass(frozen=True, eq=False)
class Shown:
    """A scene and what it was made from."""

    diagnostics: Diagnostics
    scene: dict[str, Any] | None = None
    """None if nothing can be drawn."""
    assembly: Assembly | None = None
    """The STEP file, if it could be read."""
    robot: Robot | None = None
    """None where the scene has parts alone."""
    sidecar: Path | None = None
    files: tuple[Path, ...] = ()
    """The files that were read: the sidecar, the STEP and those that it refers to."""


def show(target: Path, options: Options) -> Shown:
    """The scene of a sidecar, a STEP file, or a URDF, SDFormat or MJCF; without verification, writes nothing.

    A sidecar with errors has the scene of its STEP file, if that can be read: all parts, and no joints.
    """
    if target.suffix.lower() in SIDECAR_SUFFIXES:
        return _show_sidecar(target, options)
    found = Diagnostics()
    if not exists(target):
        report_missing(target, found)
        return Shown(found)
    return (_show_step if is_step_name(target.name) else _show_description)(target, options, found)


def show_text(path: Path, text: str, options: Options) -> Shown:
    """The scene of a sidecar with another text than its file has: what a change would give."""
    return _show_sidecar(path, options, text)


def guessed(shown: Shown, step: Path, options: Options) -> Shown:
    """The same STEP file with the links and joints that `stepbot init` would draft."""
    assembly, drafting = shown.assembly, draft_step(step, options)
    if assembly is None or drafting.draft is None:
        return shown
    robot, evidence = robot_of_draft(assembly, drafting.draft), evidence_of_draft(drafting.draft)
    scene = scene_document(robot, evidence=evidence, assembly=assembly, found=shown.diagnostics)
    return replace(shown, scene=scene, robot=robot)


def _show_step(step: Path, options: Options, found: Diagnostics) -> Shown:
    try:
        with closing(Loading(step, what_to_read(None, options), options, found)) as loading:
            assembly = loading.assembly(found)
    except StepbotError as error:
        found.extend(error.diagnostics)
        return Shown(found, files=(step,))
    return _parts_alone(assembly, step_stem(step.name), found, None, _files(step, assembly))


def _show_description(path: Path, options: Options, found: Diagnostics) -> Shown:
    robot = described_robot(path, options, found)
    if robot is None:
        return Shown(found, files=(path,))
    return Shown(found, scene_document(robot, found=found), robot=robot, files=(path,))


def _parts_alone(
    assembly: Assembly, name: str, found: Diagnostics, sidecar: Path | None, files: tuple[Path, ...]
) -> Shown:
    scene = scene_document(robot_of_assembly(assembly, name), assembly=assembly, found=found)
    return Shown(found, scene, assembly, sidecar=sidecar, files=files)


def _files(step: Path, assembly: Assembly) -> tuple[Path, ...]:
    return (step, *(step.parent / name for name in assembly.external_files))


def _show_composed(sidecar: Sidecar, options: Options, found: Diagnostics) -> Shown:
    composed = compose(sidecar, options, found)
    evidence = evidence_of_rows(composed.joint_table)
    scene = scene_document(composed.robot, evidence=evidence, found=found)
    return Shown(found, scene, robot=composed.robot, sidecar=sidecar.path, files=composed.files)


def _show_sidecar(path: Path, options: Options, text: str | None = None) -> Shown:
    found = Diagnostics()
    assembly: Assembly | None = None
    files: tuple[Path, ...] = (path,)
    try:
        sidecar = load(path, options, found, text)
        if sidecar.document.modules:
            return _show_composed(sidecar, options, found)
        step = options.step or named_step(sidecar, found)
        files = (path, step)
        with closing(Loading(step, what_to_read(sidecar, options), options, found)) as loading:
            assembly = loading.assembly(found)
            files = (path, *_files(step, assembly))
            built = build(sidecar, assembly, loading, options, found)
            found.raise_if_errors()
            assert built is not None  # a missing robot always has an error
            built.double_counting.report(options.timeout)
    except StepbotError as error:
        found.extend(error.diagnostics)
        if assembly is None:
            return Shown(found, sidecar=path, files=files)
        return _parts_alone(assembly, step_stem(assembly.source), found, path, files)
    evidence = evidence_of_rows(built.joint_table, drafted_reviews(sidecar.text), drafted_stops(sidecar.text))
    scene = scene_document(built.robot, evidence=evidence, assembly=assembly, found=found)
    return Shown(found, scene, assembly, built.robot, path, files)
