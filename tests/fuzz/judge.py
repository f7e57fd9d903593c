"""Required outcome of reading a damaged STEP file: a valid assembly, or an error that states the reason."""

import math
import re
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct, field

from stepbot.assemble import build_robot
from stepbot.diagnostics import Diagnostic, Diagnostics
from stepbot.diagnostics.codes import CODES
from stepbot.formats import FORMATS
from stepbot.formats.rendering import render
from stepbot.geometry.mass_properties import measured
from stepbot.geometry.volume import VolumeProperties
from stepbot.robot.mesh_files import share_meshes
from stepbot.robot.validity import check_robot
from stepbot.sidecar.load import parse_sidecar
from stepbot.sidecar.located import Sidecar
from stepbot.step.assembly import Assembly, AxisFace, Body, Component

Read = Callable[[Path, Diagnostics], Assembly | None]
"""Reads a STEP file; None after errors."""

FAILED = "FAILED"
OUT_OF_TIME = "out of time"
OUTCOMES = ("robot", "no robot", "refused", "body failed", "kernel died", OUT_OF_TIME, FAILED)
"""Files written; read, but not valid as a robot; not read; read except for a body; kernel died; a bug."""

_SIDECAR = """\
version: 1
robot: mutant
step: mutant.step
defaults: {density: 1000 kg/m^3}
links:
  body: {rest: true}
"""
_INTERNAL = "SB901"
_DIED = "SB902"
_BODY_FAILED = "SB213"


class Verdict(Struct, frozen=True):
    """The outcome for a damaged file."""

    outcome: str
    """One of :data:`OUTCOMES`."""
    codes: tuple[str, ...] = ()
    """Codes of the errors."""
    message: str = ""
    """Message of the first error."""
    notes: tuple[str, ...] = ()
    """Its notes and help."""
    faults: tuple[str, ...] = ()
    """Forbidden results; empty if there are none."""


class _Trial(Struct):
    found: Diagnostics = field(default_factory=Diagnostics)
    faults: list[str] = field(default_factory=list)
    outcome: str = FAILED


def judge(step: Path, read: Read) -> Verdict:
    """Read a STEP file, convert it as far as possible, and return the outcome."""
    trial = _Trial()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # on a terminal they would be between the command's lines
            _convert(step, read, trial)
    except Exception:  # noqa: BLE001 - to find those is what this is for
        trial.faults.append(traceback.format_exc())
    trial.faults += [*unsound_diagnostics(trial.found), *_without_remedy(trial.found)]
    errors = [diagnostic for diagnostic in trial.found if diagnostic.severity == "error"]
    message, notes = (str(errors[0]), errors[0].notes) if errors else ("", ())
    outcome = FAILED if trial.faults else trial.outcome
    return Verdict(outcome, tuple(error.code for error in errors), message, notes, tuple(trial.faults))


def _convert(step: Path, read: Read, trial: _Trial) -> None:
    assembly = read(step, trial.found)
    if assembly is None:
        trial.outcome = _refusal(trial)
        return
    trial.faults += unsound(assembly)
    if _has_errors(trial):
        trial.outcome = "refused"
        return
    measures = tuple(measured(body.mesh) for body in assembly.bodies)
    made = make_robot(assembly, measures, _sidecar(), trial.found, trial.faults)
    trial.outcome = "robot" if made else "body failed" if _has(trial, _BODY_FAILED) else "no robot"


def make_robot(
    assembly: Assembly,
    measures: Sequence[VolumeProperties | None],
    sidecar: Sidecar,
    diagnostics: Diagnostics,
    faults: list[str],
) -> bool:
    """Build a robot and render it in all formats, as a conversion does; returns whether there was no error.

    Args:
        assembly: A valid assembly.
        measures: trimesh's measures of its bodies.
        sidecar: A valid sidecar.
        found: Receives the diagnostics.
        faults: Receives forbidden results.
    """
    built = build_robot(assembly, sidecar, lambda: measures, diagnostics)
    if built is None:
        faults += [] if diagnostics.has_errors else ["no robot, and no error that says why"]
        return False
    robot = share_meshes(built.robot)
    check_robot(robot, diagnostics)
    if diagnostics.has_errors:
        return False
    built.double_counting.report()
    for name in FORMATS:
        faults += _unsound_files(name, render(robot, name, diagnostics), diagnostics)
    return not diagnostics.has_errors


def _refusal(trial: _Trial) -> str:
    if not _has_errors(trial):
        trial.faults.append("no assembly, and no error that says why")
    died = [diagnostic for diagnostic in trial.found if diagnostic.code == _DIED]
    if not died:
        return "refused"
    return OUT_OF_TIME if "no result after" in died[0].message else "kernel died"


def _has_errors(trial: _Trial) -> bool:
    return trial.found.has_errors


def _has(trial: _Trial, code: str) -> bool:
    return any(diagnostic.code == code for diagnostic in trial.found)


def _sidecar() -> Sidecar:
    diagnostics = Diagnostics()
    sidecar = parse_sidecar(_SIDECAR, Path("mutant.robot.yaml"), diagnostics)
    assert sidecar is not None, list(map(str, diagnostics))
    return sidecar


OF_PYDANTIC = re.compile(r"\binput (should|tag)\b|found using|\w_form\(\)|expected tags", re.IGNORECASE)
"""Words of pydantic's messages, which are no diagnostics."""


def unsound_diagnostics(diagnostics: Iterable[Diagnostic]) -> Iterator[str]:
    """Defects of diagnostics: an internal error, no place, more than one printable line."""
    for diagnostic in diagnostics:
        if diagnostic.code == _INTERNAL:
            yield f"internal error: {diagnostic}"
        if "\n" in diagnostic.message or not diagnostic.message.isprintable():
            yield f"{diagnostic.code}: not one printable line: {diagnostic.message!r}"
        if not diagnostic.span.file:
            yield f"{diagnostic.code}: no place"
        if diagnostic.code not in CODES:
            yield f"no such code: {diagnostic}"
        if any("Traceback" in text for text in (diagnostic.message, *diagnostic.notes)):
            yield f"{diagnostic.code}: a traceback: {diagnostic.message} {diagnostic.notes}"
        if OF_PYDANTIC.search(diagnostic.message):
            yield f"{diagnostic.code}: a message of pydantic's: {diagnostic.message}"


def _without_remedy(diagnostics: Iterable[Diagnostic]) -> Iterator[str]:
    for diagnostic in diagnostics:
        if diagnostic.severity == "error" and not any(diagnostic.help):
            yield f"{diagnostic.code}: no remedy: {diagnostic.message}"


def _unsound_files(name: str, files: dict[str, bytes], diagnostics: Diagnostics) -> Iterator[str]:
    from lxml import etree

    if not files and not diagnostics.has_errors:
        yield f"{name}: no file, and no error that says why"
    for path, content in files.items():
        if path.endswith(".obj"):
            words = content.decode("ascii").split()
            numbers = [word for word in words[2:] if word not in ("v", "f")]
            sound = bool(np.isfinite(np.array(numbers, dtype=np.float64)).all())
        elif path.endswith((".usda", ".proto", ".wbt")):
            sound = not {b"nan", b"inf", b"-inf"} & set(re.split(rb"[\s(),\[\]]+", content))
        elif path.endswith(".usdc"):  # its writer raises for numbers that are none; USD's library reads it elsewhere
            sound = content.startswith(b"PXR-USDC")
        else:
            attributes = [one for element in etree.fromstring(content).iter() for one in element.attrib.items()]
            sound = not any(_is_unsound(name, key, word) for key, value in attributes for word in value.split())
        if not sound:
            yield f"{name}: {path}: a number that is none"


def _is_unsound(name: str, attribute: str, word: str) -> bool:
    """Whether a word is not a number; in MJCF a range with one open end may be infinite."""
    return word == "nan" or (word in ("inf", "-inf") and (name, attribute) != ("mjcf", "range"))


def unsound(assembly: Assembly) -> Iterator[str]:
    """Defects of an assembly: NaN, invalid indices, inconsistent meshes."""
    components, bodies = assembly.components, assembly.bodies
    if not 0.0 < assembly.unit_scale < math.inf:
        yield f"a length unit of {assembly.unit_scale} m"
    if not components or components[0].parent != -1:
        yield "no root"
    if len({component.path for component in components}) != len(components):
        yield "two components with one path"
    for index, component in enumerate(components):
        for fault in _unsound_component(component, index, len(bodies)):
            yield f"component {index} {component.path!r}: {fault}"
    for index, body in enumerate(bodies):
        for fault in _unsound_body(body):
            yield f"body {index}: {fault}"
    if not any(component.body >= 0 or component.missing for component in components):
        yield "no component has a body"


def _unsound_component(component: Component, index: int, bodies: int) -> Iterator[str]:
    if component.index != index or not (component.parent < index and (component.parent >= 0 or index == 0)):
        yield f"its index is {component.index}, its parent {component.parent}"
    if not -1 <= component.body < bodies:
        yield f"there is no body {component.body}"
    if not np.isfinite(component.X_WC.matrix).all():
        yield f"its pose is {component.X_WC}"
    elif abs(component.X_WC.R @ component.X_WC.R.T - np.eye(3)).max() > 1e-5 or np.linalg.det(component.X_WC.R) < 0.0:
        yield f"its rotation is none: {component.X_WC.R.tolist()}"
    if component.density is not None and not (math.isfinite(component.density) and component.density > 0.0):
        yield f"its density is {component.density}"
    if component.color is not None and not all(0.0 <= value <= 1.0 for value in component.color):
        yield f"its colour is {component.color}"
    for text in (component.product, component.occurrence, component.path, component.material):
        try:
            text.encode("utf-8")
        except UnicodeEncodeError:
            yield f"a text that is none: {text!r}"


def _unsound_body(body: Body) -> Iterator[str]:
    from trimesh import Trimesh

    mesh = body.mesh
    if not np.isfinite(mesh.vertices).all():
        yield "a vertex is not finite"
    if len(mesh.faces) and not (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices)):
        yield "a face refers to a vertex that does not exist"
    if len(body.face_colors) != len(mesh.faces):
        yield f"{len(body.face_colors)} colours for {len(mesh.faces)} faces"
    if len(body.face_colors) and not 0 <= body.face_colors.min() <= body.face_colors.max() < len(body.colors):
        yield "a face has a colour that is not there"
    if any(not all(0.0 <= value <= 1.0 for value in color) for color in body.colors if color is not None):
        yield f"its colours are {body.colors}"
    if len(mesh.faces):
        seen = Trimesh(mesh.vertices, mesh.faces, process=False)
        if body.watertight != bool(seen.is_watertight and seen.is_winding_consistent):
            yield f"says watertight={body.watertight}, which trimesh denies"
    elif body.watertight:
        yield "says that it is watertight, and has no faces"
    for name, properties in (("exact", body.exact), ("refined", body.refined)):
        if properties is not None and not _is_sound(properties):
            yield f"its {name} mass properties are {properties}"
    yield from (f"an axis of {face}" for face in body.axis_faces if not _is_sound_axis(face))


def _is_sound_axis(face: AxisFace) -> bool:
    numbers = (*face.point, *face.direction, face.radius, face.low, face.high)
    is_line = all(map(math.isfinite, numbers)) and abs(math.hypot(*face.direction) - 1.0) < 1e-9
    return is_line and face.radius > 0.0 and face.low <= face.high


def _is_sound(properties: VolumeProperties) -> bool:
    body = properties.unit_density
    numbers = (properties.volume, body.mass, *body.com, *(value for row in body.inertia for value in row))
    return all(map(math.isfinite, numbers)) and properties.volume > 0.0
