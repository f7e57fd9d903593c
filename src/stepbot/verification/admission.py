"""Examines files before engines read them, each in a process of its own.

Engines must not read files with entities, includes from other folders, pipes or devices. Each engine searches packages
in its own way, or not at all, so that meshes are found here.
"""

from collections.abc import Iterable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path

from stepbot.diagnostics import Diagnostics, Span, cut, did_you_mean, listed
from stepbot.engines.description.statements import Statement
from stepbot.engines.examination import Examination
from stepbot.engines.file_references import openable
from stepbot.engines.macros.expressions import Expansion
from stepbot.engines.source_copy import MissingMesh
from stepbot.formats import FORMATS
from stepbot.formats.features import Feature, Level
from stepbot.robot.step_names import is_step_name
from stepbot.runtime.file import exists, is_file, is_folder, open_regular, resolved
from stepbot.runtime.worker import WorkerDied, Workers

SCENES = (".drake.sdf", *(written.scene for written in FORMATS.values() if written.scene))
"""Ends of the names of files that contain the robot of a main file once more."""
_BEGINNING = 4096
"""Number of bytes in which the first element of a file is."""
_SHOWN = 5
"""Maximum number of files that a remedy lists."""


def main_files(folder: Path) -> list[Path]:
    """The main files in a folder, URDF first; else those in its folders, as in a ROS 2 package; empty if unreadable."""
    try:
        return _main_files(folder.glob("*")) or _main_files(folder.glob("*/*"))
    except OSError:
        return []


def robot_files(target: Path) -> tuple[Path, ...]:
    """The files of a folder with the files of one robot, as `stepbot convert` writes it; else the target itself."""
    files = main_files(target) if is_folder(target) else []
    return tuple(files) if len({path.stem for path in files}) == 1 else (target,)


def robot_file(target: Path) -> Path:
    """The file to show of a folder with the files of one robot: the first that keeps loops; else the target itself."""
    files = robot_files(target)
    formats = {written.suffix: written for written in FORMATS.values()}
    known = (path for path in files if path.suffix in formats)
    loops = (path for path in known if formats[path.suffix].expresses[Feature.CLOSURE].level is Level.EXACT)
    return next(loops, files[0])


def _main_files(paths: Iterable[Path]) -> list[Path]:
    order = {written.suffix: place for place, written in enumerate(FORMATS.values())}
    named = (path for path in paths if path.suffix in order and not path.name.endswith(SCENES))
    return sorted(filter(_is_robot, named), key=lambda path: (order[path.suffix], path.as_posix()))


def _is_robot(path: Path) -> bool:
    """Whether a file of a robot's suffix may be one; of XML files, such as manifests, those with MJCF's element."""
    if path.suffix != ".xml":
        return is_file(path)
    try:
        with open_regular(path) as file:
            return b"<mujoco" in file.read(_BEGINNING)
    except OSError:
        return False


def is_robot_file(path: Path, diagnostics: Diagnostics) -> bool:
    """Whether a path is a file that may be a robot description.

    Args:
        diagnostics: Receives SB001 with the robot files in the folder, or beside the missing file; SB814 for a sidecar
            or STEP.
    """
    span = Span(path.as_posix())
    if is_file(path):
        if is_step_name(path.name):
            help = [
                f"`stepbot init {span.file}` drafts a sidecar from it; pass that sidecar, or what it is converted to"
            ]
            diagnostics.add("SB814", "a STEP file, not a robot description", span, help=help)
            return False
        if path.suffix in (".yaml", ".yml"):
            help = [f"`stepbot convert {span.file}` writes and verifies the descriptions; name one of these files"]
            diagnostics.add("SB814", "a sidecar, not a robot description", span, help=help)
            return False
        return True
    if is_folder(path):
        inside = listed([file.as_posix() for file in main_files(path)], _SHOWN)
        help = [f"use a file in it: {inside}" if inside else "it contains no robot file; `stepbot convert` writes them"]
        diagnostics.add("SB001", "is a folder, not a file", span, help=help)
        return False
    beside = [file.as_posix() for file in main_files(path.parent)]
    near = did_you_mean(path.name, (Path(one).name for one in beside))
    others = [f"robot files in '{path.parent.as_posix()}': {listed(beside, _SHOWN)}"] if beside else []
    diagnostics.add("SB001", "file not found", span, help=near or others)
    return False


_EXAMINE = "stepbot.engines.examination:examine"
_EXPAND = "stepbot.engines.macros.expansion:expand"
HEAD = 1 << 24
"""Number of bytes in which macros are searched for."""
_MOST_NOTES = 5
_MOST_CALLS = 8


def admitted(
    formats: Mapping[Path, str], diagnostics: Diagnostics, workers: Workers, packages: Iterable[Path] = ()
) -> dict[Path, str]:
    """The files that engines may read, each with its format.

    Args:
        diagnostics: Receives SB820 for rejected files.
    """
    return {
        path: formats[path]
        for path, _ in _examined(formats, dict.fromkeys(formats), tuple(packages), diagnostics, workers)
    }


def located(
    formats: Mapping[Path, str],
    packages: Iterable[Path],
    folder: Path,
    diagnostics: Diagnostics,
    workers: Workers,
    xacro: Iterable[tuple[str, str]] = (),
) -> tuple[dict[Path, Path], dict[Path, tuple[Statement, ...]]]:
    """The files that engines may read, and where they find each: a copy with absolute paths, if it names packages.

    Files that share a format come with what they say. Of a file with macros the copy is its URDF.

    Args:
        packages: Folders of packages, or the folders that contain them; those above a file are searched, too.
        folder: Receives the copies.
        diagnostics: Receives SB820 for rejected files, SB861 for missing meshes, and SB877 for wrong macros.
        xacro: Name and value of arguments of the files with macros.
    """
    packages, xacro = tuple(packages), tuple(xacro)
    sources: dict[Path, tuple[Path, tuple[Span, ...]]] = {}
    for n, (path, written_in) in enumerate(formats.items()):
        if not has_macros(path):
            sources[path] = path, ()
        elif admitted({path: written_in}, diagnostics, workers, packages):
            macros = expanded(path, xacro, packages, diagnostics, workers)
            if macros is not None:
                plain = folder / f"expanded{n}" / f"{path.name.partition('.')[0]}.urdf"
                plain.parent.mkdir()
                plain.write_bytes(macros.text)
                sources[plain] = path, macros.places
    copies: dict[Path, Path | None] = {file: folder / str(n) / file.name for n, file in enumerate(sources)}
    places, texts = {}, {}
    shared = len(set(formats.values())) < len(formats)
    formats = {file: formats[path] for file, (path, _) in sources.items()}
    examined = dict(_examined(formats, copies, packages, diagnostics, workers, stated=shared))
    if len({(formats[file], one.meshes) for file, one in examined.items()}) > len(set(formats.values())):
        sound = {file: formats[file] for file in examined}
        examined = dict(_examined(sound, copies, packages, diagnostics, workers, stated=True, surfaces=True))
    for file, one in examined.items():
        copy, (path, stated_at) = copies[file], sources[file]
        if one.missing:
            line = one.missing[0].line
            _report_missing(stated_at[line] if stated_at else Span(path.as_posix(), line), one.missing, diagnostics)
        else:
            places[path] = copy if copy is not None and exists(copy) else file
            texts[path] = one.stated
    return places, texts


def has_macros(path: Path) -> bool:
    """Whether a file has macros of ROS."""
    with open_regular(path) as file:
        return path.suffix.lower() == ".xacro" or b"<xacro:" in file.read(HEAD)


def expanded(
    path: Path,
    arguments: Iterable[tuple[str, str]],
    packages: Iterable[Path],
    diagnostics: Diagnostics,
    workers: Workers,
) -> Expansion | None:
    """The URDF of a file with macros; None after SB877 or SB902.

    Args:
        arguments: Name and value of each argument that is stated.
    """
    span = Span(path.as_posix())
    if find_spec("xacro") is None:
        diagnostics.add(
            "SB877", "the file has macros, and xacro is not installed", span, help=["pip install 'stepbot[xacro]'"]
        )
        return None
    given = dict(arguments)
    try:
        macros: Expansion = workers.call(_EXPAND, str(openable(path)), given, tuple(map(resolved, packages)))
    except WorkerDied as death:
        diagnostics.add("SB902", f"the process that expands macros died: {death.reason}", span, notes=death.last_lines)
        return None
    shown = {str(resolved(path)): path.as_posix()}
    macros = macros._replace(places=tuple(one._replace(file=shown.get(one.file, one.file)) for one in macros.places))
    if macros.error:
        calls = list(
            dict.fromkeys(f"in the macro called in {Path(call.file).name}:{call.line}" for call in macros.calls)
        )
        place = macros.at._replace(file=shown.get(macros.at.file, macros.at.file))
        diagnostics.add("SB877", macros.error, place, help=_remedies(macros.error), notes=calls[:_MOST_CALLS])
        return None
    for name in given:
        if name not in macros.arguments:
            known = ", ".join(macros.arguments) or "none"
            help = did_you_mean(name, macros.arguments) or (f"arguments: {known}",)
            diagnostics.add("SB877", f"the file has no argument '{name}'", span, help=help)
            return None
    return macros


def _remedies(error: str) -> list[str]:
    """What to do about an error of a macro; nothing beyond what it states for most."""
    if error.startswith("package "):
        return ["name the folder of the package, or of packages: `--package-path DIR`"]
    if error.startswith("Undefined substitution argument"):
        return [f"state it: `--xacro {error.rpartition(' ')[2]}:=VALUE`"]
    return []


def _examined(
    formats: Mapping[Path, str],
    copies: Mapping[Path, Path | None],
    packages: tuple[Path, ...],
    diagnostics: Diagnostics,
    workers: Workers,
    *,
    stated: bool = False,
    surfaces: bool = False,
) -> Iterator[tuple[Path, Examination]]:
    """The files that engines may read, with what was found in each."""
    for path, written_in in formats.items():
        copy = copies[path]
        if copy is not None:
            copy.parent.mkdir(exist_ok=True)
        names = str(path), written_in, str(openable(path)), str(copy or "")
        try:
            examined: Examination = workers.call(_EXAMINE, *names, packages, stated, surfaces)
        except WorkerDied as death:
            message = f"the process that reads the file's references died: {death.reason}"
            diagnostics.add("SB902", message, Span(path.as_posix()), notes=death.last_lines)
            continue
        for refusal in examined.refusals:
            diagnostics.add(refusal.code, refusal.message, Span(Path(refusal.file).as_posix(), refusal.line))
        if not examined.refusals:
            yield path, examined


def _report_missing(span: Span, missing: tuple[MissingMesh, ...], diagnostics: Diagnostics) -> None:
    """Report meshes that a file names and that do not exist (SB861)."""
    first, *others = missing
    more = f" and {len(others)} more" if others else ""
    notes = cut([f"also missing: '{other.uri}'" for other in others], _MOST_NOTES)
    remedy = "put the meshes where the file names them"
    if any("://" in mesh.uri for mesh in missing):
        remedy = "name the folder of the package: `--package-path DIR`"
    message = f"mesh '{first.uri}'{more} not found"
    diagnostics.add("SB861", message, span, help=[remedy], notes=notes)
