"""What the page shows: the robot of a sidecar, or a plain STEP file with the joints that inference finds.

The robot of a draft has no masses and no collision shapes. Every drafted joint is a guess, and those below the score of
a sure one are marked for review.
"""

from collections.abc import Mapping
from contextlib import closing
from math import tau
from pathlib import Path
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from stepbot.assemble.assets import MeshAssets
from stepbot.diagnostics import Diagnostics, StepbotError
from stepbot.draft.draft import Draft, DraftConnection, DraftJoint
from stepbot.geometry.spatial import IDENTITY, Pose, perpendicular_frame, unit, vector3
from stepbot.report.words import direction_words, point_words
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.model import GREY, Joint, JointKind, Limit, Link, LoopClosure, Robot, Visual
from stepbot.robot.step_names import is_step_name, step_stem
from stepbot.runtime.file import exists
from stepbot.sidecar.draft_comments import drafted_reviews, drafted_stops
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly, BodyKind
from stepbot.viewing.connections import evidence_of_rows
from stepbot.viewing.scene import scene_document

from .building import build
from .composing import compose
from .conversion import Options
from .describing import described_robot
from .drafting import draft_step
from .loading import Loading
from .sidecars import SIDECAR_SUFFIXES, load, named_step, report_missing, what_to_read

Json = dict[str, Any]


def robot_of_assembly(assembly: Assembly, name: str) -> Robot:
    """All parts in one link, in the frame of the assembly."""
    return _robot(assembly, name, {name: IDENTITY}, {name: _with_bodies(assembly)}, ())


def robot_of_draft(assembly: Assembly, draft: Draft) -> Robot:
    """Links and joints of a draft; parts that it has in no link are in the root."""
    bodies = _with_bodies(assembly)
    parts = {link.name: tuple(i for i in link.components if i in bodies) for link in draft.links}
    taken = {index for indices in parts.values() for index in indices}
    parts[draft.root] = tuple(i for i in bodies if i in parts[draft.root] or i not in taken)
    X_WL = {draft.root: IDENTITY} | {joint.child: _frame(joint) for joint in draft.joints}
    joints = tuple(_joint(joint, X_WL) for joint in draft.joints)
    order = (draft.root, *(joint.child for joint in joints))
    robot = _robot(assembly, draft.robot, {name: X_WL[name] for name in order}, parts, joints)
    closures = tuple(
        LoopClosure(
            closure.name,
            closure.type,
            closure.link_a,
            X_WL[closure.link_a].inverse() @ _frame(closure),
            closure.link_b,
            X_WL[closure.link_b].inverse() @ _frame(closure),
        )
        for closure in draft.closures
    )
    return replace(robot, closures=closures)


def _evidence(connection: DraftConnection) -> Json:
    """The evidence of a drafted joint or closure, and why to review it."""
    weak = connection.doubt or ("weak evidence, to be reviewed" if connection.is_reviewed else "")
    return {
        "evidence": "; ".join((f"a guess, score {connection.confidence.score:.2f}", *connection.confidence.evidence)),
        "doubt": connection.review or weak,
        "at": point_words(connection.point),
        "along": "" if connection.direction is None else direction_words(vector3(unit(connection.direction))),
        "others": [f"{other.type.value} between {other.a} and {other.b}" for other in connection.alternatives],
        "stops": [
            {"position": stop.position, "parts": f"'{stop.parts[0]}' and '{stop.parts[1]}'"}
            for stop in (connection.stops if isinstance(connection, DraftJoint) else ())
        ],
    }


def _with_bodies(assembly: Assembly) -> tuple[int, ...]:
    bodies = assembly.bodies
    return tuple(
        component.index
        for component in assembly.components
        if component.body >= 0 and bodies[component.body].kind is not BodyKind.WIRE
    )


def _frame(connection: DraftConnection) -> Pose:
    """X_WL of a joint's child, with the axis as z."""
    if connection.direction is None:
        return Pose.of(position=connection.point)
    return Pose.of(perpendicular_frame(unit(connection.direction)), connection.point)


def _joint(joint: DraftJoint, X_WL: Mapping[str, Pose]) -> Joint:
    X_WC = X_WL[joint.child]
    limits = joint.limits
    bounded = limits is not None and joint.type not in (JointKind.CONTINUOUS, JointKind.FIXED, JointKind.BALL)
    axis2 = (1.0, 0.0, 0.0)
    if joint.direction2 is not None:
        axis2 = vector3(X_WC.inverse().turn(unit(joint.direction2)))
    return Joint(
        joint.name,
        joint.type,
        joint.parent,
        joint.child,
        X_WL[joint.parent].inverse() @ X_WC,
        axis2=axis2,
        limit=Limit(limits.lower, limits.upper) if bounded and limits is not None else Limit(),
        mimic=joint.mimic,
        pitch=(joint.pitch or 0.0) / tau,
    )


def _robot(
    assembly: Assembly,
    name: str,
    X_WL: Mapping[str, Pose],
    parts: Mapping[str, tuple[int, ...]],
    joints: tuple[Joint, ...],
) -> Robot:
    assets = MeshAssets(assembly)
    links = []
    for link, X in X_WL.items():
        visuals = []
        for index in parts.get(link, ()):
            component = assembly.components[index]
            if len(assembly.bodies[component.body].mesh.faces):
                for group in assets.by_color(component.body, component, None, GREY):
                    X_LC = X.inverse() @ component.X_WC
                    visuals.append(Visual(f"{link}_{index}", group.geometry, X_LC, group.rgba, component.path))
        paths = tuple(assembly.components[index].path for index in parts.get(link, ()))
        links.append(Link(link, visuals=tuple(visuals), components=paths))
    return share_meshes(Robot(name, tuple(links), joints, meshes=assets.all(), source=assembly.source))


class ShownScene(Struct, frozen=True, eq=False):
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


def show(target: Path, options: Options) -> ShownScene:
    """The scene of a sidecar, a STEP file, or a URDF, SDFormat or MJCF; without verification, writes nothing.

    A sidecar with errors has the scene of its STEP file, if that can be read: all parts, and no joints.
    """
    if target.suffix.lower() in SIDECAR_SUFFIXES:
        return _show_sidecar(target, options)
    diagnostics = Diagnostics()
    if not exists(target):
        report_missing(target, diagnostics)
        return ShownScene(diagnostics)
    return (_show_step if is_step_name(target.name) else _show_description)(target, options, diagnostics)


def show_text(path: Path, text: str, options: Options) -> ShownScene:
    """The scene of a sidecar with another text than its file has: what a change would give."""
    return _show_sidecar(path, options, text)


def guessed(shown: ShownScene, step: Path, options: Options) -> ShownScene:
    """The same STEP file with the links and joints that `stepbot init` would draft."""
    assembly, drafting = shown.assembly, draft_step(step, options)
    if assembly is None or drafting.draft is None:
        return shown
    draft = drafting.draft
    robot = robot_of_draft(assembly, draft)
    evidence = {one.name: _evidence(one) for one in (*draft.joints, *draft.closures)}
    scene = scene_document(robot, evidence=evidence, assembly=assembly, diagnostics=shown.diagnostics)
    return replace(shown, scene=scene, robot=robot)


def _show_step(step: Path, options: Options, diagnostics: Diagnostics) -> ShownScene:
    try:
        with closing(Loading(step, what_to_read(None, options), options, diagnostics)) as loading:
            assembly = loading.assembly(diagnostics)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        return ShownScene(diagnostics, files=(step,))
    return _parts_alone(assembly, step_stem(step.name), diagnostics, None, _files(step, assembly))


def _show_description(path: Path, options: Options, diagnostics: Diagnostics) -> ShownScene:
    robot = described_robot(path, options, diagnostics)
    if robot is None:
        return ShownScene(diagnostics, files=(path,))
    return ShownScene(diagnostics, scene_document(robot, diagnostics=diagnostics), robot=robot, files=(path,))


def _parts_alone(
    assembly: Assembly, name: str, diagnostics: Diagnostics, sidecar: Path | None, files: tuple[Path, ...]
) -> ShownScene:
    scene = scene_document(robot_of_assembly(assembly, name), assembly=assembly, diagnostics=diagnostics)
    return ShownScene(diagnostics, scene, assembly, sidecar=sidecar, files=files)


def _files(step: Path, assembly: Assembly) -> tuple[Path, ...]:
    return (step, *(step.parent / name for name in assembly.external_files))


def _show_composed(sidecar: Sidecar, options: Options, diagnostics: Diagnostics) -> ShownScene:
    composed = compose(sidecar, options, diagnostics)
    evidence = evidence_of_rows(composed.joint_table)
    scene = scene_document(composed.robot, evidence=evidence, diagnostics=diagnostics)
    return ShownScene(diagnostics, scene, robot=composed.robot, sidecar=sidecar.path, files=composed.files)


def _show_sidecar(path: Path, options: Options, text: str | None = None) -> ShownScene:
    diagnostics = Diagnostics()
    assembly: Assembly | None = None
    files: tuple[Path, ...] = (path,)
    try:
        sidecar = load(path, options, diagnostics, text)
        if sidecar.document.modules:
            return _show_composed(sidecar, options, diagnostics)
        step = options.step or named_step(sidecar, diagnostics)
        files = (path, step)
        with closing(Loading(step, what_to_read(sidecar, options), options, diagnostics)) as loading:
            assembly = loading.assembly(diagnostics)
            files = (path, *_files(step, assembly))
            built = build(sidecar, assembly, loading, options, diagnostics)
            diagnostics.raise_if_errors()
            assert built is not None  # a missing robot always has an error
            built.double_counting.report(options.timeout)
    except StepbotError as error:
        diagnostics.extend(error.diagnostics)
        if assembly is None:
            return ShownScene(diagnostics, sidecar=path, files=files)
        return _parts_alone(assembly, step_stem(assembly.source), diagnostics, path, files)
    evidence = evidence_of_rows(built.joint_table, drafted_reviews(sidecar.text), drafted_stops(sidecar.text))
    scene = scene_document(built.robot, evidence=evidence, assembly=assembly, diagnostics=diagnostics)
    return ShownScene(diagnostics, scene, assembly, built.robot, path, files)
